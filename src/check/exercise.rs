//! Exercises: what an estimator should compute, the probes on which it is tried, and the classic mistakes.
//!
//! A topic defines an exercise once: its problems, a right estimator, and the wrong ones, each as code. A
//! mistake's ratio on a probe is not derived by hand: it is the mean of the wrong estimator over scrambled
//! Sobol points, computed when it is first needed. With 16 sets of 1,024 points this gives a ratio to about
//! 1e-4, with its std error, in a fraction of a millisecond. ([`exactly`](super::exactly()) takes up to a
//! second for an integrand with a jump.)

use std::fmt;
use std::sync::OnceLock;

use rayon::prelude::*;

use super::ratio::Ratio;
use crate::estimator::from_fn;
use crate::placement::sobol;
use crate::run::{Budget, estimate};
use crate::stream::Stream;

/// A problem with known truth, for which an estimator is to be written.
///
/// Your own estimator is a closure of the problem and the random numbers: see
/// [`Attempt::new`](super::Attempt::new).
pub trait Problem: fmt::Display + Sync + Sized + 'static {
    /// The exercise that it belongs to.
    fn exercise() -> &'static Exercise;

    /// The problems that an estimator is tried on, in the order of the exercise's probes.
    fn all() -> &'static [Self];

    /// What a right estimator's draws average to.
    fn truth(&self) -> f64;

    /// What means are divided by to give ratios, above 0: |truth|, or a typical size where the truth is 0.
    fn scale(&self) -> f64 {
        self.truth().abs()
    }

    /// What is averaged: the draw itself, or a function of it.
    fn value(&self, draw: f64) -> f64 {
        draw
    }

    /// Whether the draw itself is averaged.
    fn averages_draws(&self) -> bool {
        true
    }

    /// Its parameters by name, for a program in another language.
    fn given(&self) -> Vec<(&'static str, Given)>;

    /// Its parameters by symbol, as possible wrong factors of a draw.
    fn factors(&self) -> Vec<(&'static str, f64)> {
        Vec::new()
    }
}

/// A parameter of a problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Given {
    /// A number.
    Number(f64),
    /// One of a few words.
    Word(&'static str),
}

/// As one word.
impl fmt::Display for Given {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Word(word) => f.write_str(word),
        }
    }
}

/// One draw for the probe with this index, times a factor, from these random numbers.
pub(super) type Draw<'a> = dyn Fn(usize, f64, &mut Stream) -> f64 + Send + Sync + 'a;

pub(super) fn erased<'a, P: Problem>(
    draw: impl Fn(&P, &mut Stream) -> f64 + Send + Sync + 'a,
) -> Box<Draw<'a>> {
    Box::new(move |probe, factor, rng| match P::all().get(probe) {
        Some(problem) => problem.value(factor * draw(problem, rng)),
        None => f64::NAN,
    })
}

/// A problem of an exercise, in words and numbers.
#[derive(Debug)]
pub struct Probe {
    /// What a right estimator's draws average to.
    pub truth: f64,
    /// What means are divided by to give ratios: |truth|, or a typical size where the truth is 0.
    pub scale: f64,
    /// Its parameters by name.
    pub given: Vec<(&'static str, Given)>,
    /// Its index among the exercise's probes, from 0.
    pub index: usize,
    exercise: fn() -> &'static Exercise,
    text: String,
    pub(super) averages_draws: bool,
    /// Constants by which draws may be wrong: those of mathematics, the parameters and their inverses.
    pub(super) factors: Vec<(String, f64)>,
}

impl Probe {
    /// The exercise that it belongs to.
    pub fn exercise(&self) -> &'static Exercise {
        (self.exercise)()
    }

    /// The ratio of a right estimator: 1, or 0 where the truth is 0.
    pub(crate) fn right_ratio(&self) -> f64 {
        self.truth / self.scale
    }

    /// Whether draws on this probe can tell this ratio from a right estimator's.
    pub fn sees(&self, ratio: Ratio) -> bool {
        ratio.differs(Ratio::exact(self.right_ratio()))
    }
}

/// The probe in a few words: `mean of X, λ = 0.37`.
impl fmt::Display for Probe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// A wrong estimator and what is wrong with it.
pub struct Mistake {
    /// The worksheet's question in which it is made.
    pub question: &'static str,
    /// A stable name for programs: `log10`.
    pub id: &'static str,
    /// What it is called.
    pub name: &'static str,
    /// The wrong formula.
    pub formula: &'static str,
    /// How to correct it.
    pub mend: &'static str,
    index: usize,
    pub(super) wrong: Box<Draw<'static>>,
}

impl Mistake {
    /// The mean square of its draws on a probe, divided by the scale squared, to a few per cent.
    pub(super) fn square(&self, probe: &Probe) -> f64 {
        let squared = from_fn(|rng| ((self.wrong)(probe.index, 1.0, rng) / probe.scale).powi(2));
        estimate(&squared, Budget::Draws(4 * POINTS), 1).map_or(f64::NAN, |square| square.mean())
    }
}

impl fmt::Debug for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Mistake").field(&self.id).finish()
    }
}

/// An estimator of a topic's problem, as code.
pub(crate) type Code<P> = fn(&P, &mut Stream) -> f64;

/// A mistake as a topic lists it: the question, the id, the name, the formula, how to mend it; and the wrong
/// estimator.
pub(crate) type Listed<P> = ([&'static str; 5], Code<P>);

/// What an exercise is, in words.
#[derive(Debug, Clone, Copy)]
pub(crate) struct About {
    pub id: &'static str,
    pub name: &'static str,
    /// Worksheet questions, each with the index of the probe that has the question's parameters.
    pub questions: &'static [(&'static str, usize)],
    /// What one draw is, and what the words in the problems mean: lines of text.
    pub draw: &'static str,
}

/// An estimator to be written: the probes on which it is tried, right estimators, and the classic mistakes.
pub struct Exercise {
    /// A name for programs: `reflected`.
    pub id: &'static str,
    /// What it is called: `reflected light`.
    pub name: &'static str,
    /// What one draw is, and what the words of the probes mean.
    pub draw: &'static str,
    /// Its probes, the worksheet's own case first.
    pub probes: Vec<Probe>,
    /// Its classic mistakes.
    pub mistakes: Vec<Mistake>,
    questions: &'static [(&'static str, usize)],
    /// Right estimators, which use their random numbers as the worksheet does.
    pub(super) right: Vec<Box<Draw<'static>>>,
    /// For each probe, once needed: the ratios of all mistakes, and of all compounds.
    found: Vec<[OnceLock<Vec<Ratio>>; 2]>,
}

impl Exercise {
    pub(crate) fn new<P: Problem>(about: About, right: &[Code<P>], mistakes: &[Listed<P>]) -> Self {
        let probe = |(index, problem): (usize, &P)| Probe {
            exercise: P::exercise,
            index,
            text: problem.to_string(),
            truth: problem.truth(),
            scale: problem.scale(),
            averages_draws: problem.averages_draws(),
            given: problem.given(),
            factors: factors(&problem.factors()),
        };
        let mistake = |(index, (words, wrong)): (usize, &Listed<P>)| {
            let [question, id, name, formula, mend] = *words;
            Mistake { question, id, name, formula, mend, index, wrong: erased(*wrong) }
        };
        let probes: Vec<_> = P::all().iter().enumerate().map(probe).collect();
        let mistakes: Vec<_> = mistakes.iter().enumerate().map(mistake).collect();
        let About { id, name, questions, draw } = about;
        Self {
            id,
            name,
            draw,
            questions,
            found: probes.iter().map(|_| Default::default()).collect(),
            probes,
            right: right.iter().map(|right| erased::<P>(*right)).collect(),
            mistakes,
        }
    }

    /// The worksheet's questions that ask for it.
    pub fn questions(&self) -> impl Iterator<Item = &'static str> + use<> {
        self.questions.iter().map(|(question, _)| *question)
    }

    /// Its probes, with this question's own case first.
    pub fn probes_of(&self, question: &str) -> Vec<&Probe> {
        let own = self.questions.iter().find(|(asked, _)| *asked == question);
        let own = own.map_or(0, |(_, own)| *own);
        let mut probes: Vec<_> = self.probes.iter().collect();
        if let Some(first) = probes.get_mut(..=own) {
            first.rotate_right(1);
        }
        probes
    }

    /// The mean of a mistake's draws on a probe, divided by [`Probe::scale`].
    pub fn ratio(&self, mistake: &Mistake, probe: &Probe) -> Ratio {
        let Some([found, _]) = self.found.get(probe.index) else { return Ratio::UNKNOWN };
        let of = |mistake: &Mistake| ratio_of(&*mistake.wrong, probe, 1.0);
        let all = found.get_or_init(|| self.mistakes.par_iter().map(of).collect());
        all.get(mistake.index).copied().unwrap_or(Ratio::UNKNOWN)
    }

    /// Constants times the right estimator, and times each mistake: which constant, and the mistake.
    pub(super) fn compounds(&self) -> impl Iterator<Item = (usize, Option<&Mistake>)> {
        let constants = 0..self.probes.first().map_or(0, |probe| probe.factors.len());
        let bases = || std::iter::once(None).chain(self.mistakes.iter().map(Some));
        constants.flat_map(move |which| bases().map(move |base| (which, base)))
    }

    /// The ratio of each compound on a probe.
    pub(super) fn compound_ratios(&self, probe: &Probe) -> &[Ratio] {
        let Some([_, found]) = self.found.get(probe.index) else { return &[] };
        // first the mistakes' ratios, so that the parallel loop does not wait for their initialisation
        self.mistakes.first().map(|mistake| self.ratio(mistake, probe));
        let compounds = || self.compounds().collect::<Vec<_>>().into_par_iter();
        found.get_or_init(|| compounds().map(|compound| self.multiplied(compound, probe)).collect())
    }

    fn multiplied(&self, (which, mistake): (usize, Option<&Mistake>), probe: &Probe) -> Ratio {
        let factor = probe.factors.get(which).map_or(f64::NAN, |(_, factor)| *factor);
        if probe.averages_draws {
            let right = Ratio::exact(probe.right_ratio());
            return mistake.map_or(right, |mistake| self.ratio(mistake, probe)).times(factor);
        }
        let draw = mistake.map(|mistake| &mistake.wrong).or(self.right.first());
        draw.map_or(Ratio::UNKNOWN, |draw| ratio_of(&**draw, probe, factor))
    }
}

impl fmt::Debug for Exercise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Exercise").field(&self.name).finish()
    }
}

/// The constants, a problem's parameters and their inverses.
fn factors(parameters: &[(&str, f64)]) -> Vec<(String, f64)> {
    let own = parameters.iter().flat_map(|(symbol, value)| {
        let inverse = if symbol.contains(' ') { format!("1/({symbol})") } else { format!("1/{symbol}") };
        [((*symbol).to_owned(), *value), (inverse, 1.0 / value)]
    });
    CONSTANTS.iter().map(|(name, value)| ((*name).to_owned(), *value)).chain(own).collect()
}

/// The constants by which draws are usually wrong.
const CONSTANTS: [(&str, f64); 8] = {
    use std::f64::consts::{FRAC_1_PI, PI, TAU};
    [
        ("2", 2.0),
        ("½", 0.5),
        ("π", PI),
        ("1/π", FRAC_1_PI),
        ("4", 4.0),
        ("¼", 0.25),
        ("2π", TAU),
        ("1/(2π)", 0.5 * FRAC_1_PI),
    ]
};

/// Sobol points per set, and number of sets: their spread gives the std error of the mean.
const POINTS: u64 = 1 << 10;
const SETS: u64 = 16;

fn ratio_of(draw: &Draw<'_>, probe: &Probe, factor: f64) -> Ratio {
    let draws = from_fn(|rng| draw(probe.index, factor, rng));
    let mean = sobol(&draws, POINTS).and_then(|sets| estimate(&sets, Budget::Draws(SETS), 1));
    mean.map_or(Ratio::UNKNOWN, |mean| Ratio::of(&mean, probe.scale))
}
