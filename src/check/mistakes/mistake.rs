//! A wrong estimator, and what it comes to.

use std::fmt;
use std::sync::OnceLock;

use super::probe::Setup;
use super::{Attempt, Probe, Topic};
use crate::check::exactly::{Exact, moments};
use crate::error::Result;

/// A classic mistake: what it is, how to mend it, and the estimator that commits it.
#[derive(Debug)]
pub struct Mistake {
    words: Words,
    wrong: Attempt<'static>,
    expected: Expected,
    random_numbers: usize,
    means: OnceLock<Vec<f64>>,
    spreads: OnceLock<Vec<Option<f64>>>,
}

/// What a mistake is, in words.
#[derive(Debug, Clone, Copy)]
pub(super) struct Words {
    question: &'static str,
    name: &'static str,
    formula: &'static str,
    fix: &'static str,
}

pub(super) const fn words(
    question: &'static str,
    name: &'static str,
    formula: &'static str,
    fix: &'static str,
) -> Words {
    Words { question, name, formula, fix }
}

/// What the mistake's draws average to.
enum Expected {
    Closed(Box<dyn Fn(&Setup) -> f64 + Send + Sync>),
    /// By quadrature of the wrong estimator.
    Quadrature,
}

impl fmt::Debug for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Closed(_) => "Closed",
            Self::Quadrature => "Quadrature",
        })
    }
}

impl Mistake {
    pub(super) fn new(
        words: Words,
        random_numbers: usize,
        wrong: Attempt<'static>,
        expected: impl Fn(&Setup) -> f64 + Send + Sync + 'static,
    ) -> Self {
        let expected = Expected::Closed(Box::new(expected));
        Self::of(words, random_numbers, wrong, expected)
    }

    pub(super) fn by_quadrature(words: Words, random_numbers: usize, wrong: Attempt<'static>) -> Self {
        Self::of(words, random_numbers, wrong, Expected::Quadrature)
    }

    fn of(words: Words, random_numbers: usize, wrong: Attempt<'static>, expected: Expected) -> Self {
        let (means, spreads) = (OnceLock::new(), OnceLock::new());
        Self { words, wrong, expected, random_numbers, means, spreads }
    }

    /// What it is called.
    pub fn name(&self) -> &'static str {
        self.words.name
    }

    /// The worksheet's question in which it is made.
    pub fn question(&self) -> &'static str {
        self.words.question
    }

    /// The formula that commits it.
    pub fn formula(&self) -> &'static str {
        self.words.formula
    }

    /// How to mend it.
    pub fn fix(&self) -> &'static str {
        self.words.fix
    }

    /// The topic it belongs to.
    pub fn topic(&self) -> Topic {
        self.wrong.topic()
    }

    /// The wrong estimator itself.
    pub fn wrong(&self) -> &Attempt<'static> {
        &self.wrong
    }

    /// How many random numbers a draw takes at most, where that is fixed.
    pub fn random_numbers(&self) -> Option<usize> {
        (self.random_numbers > 0).then_some(self.random_numbers)
    }

    /// What its draws average to on a probe; infinite where they have no mean, NaN on a probe of another topic.
    pub fn expected(&self, probe: &Probe) -> f64 {
        if probe.topic() != self.topic() {
            return f64::NAN;
        }
        let mean = |probe: &Probe| match &self.expected {
            Expected::Closed(expected) => expected(&probe.setup),
            Expected::Quadrature => self.moments(probe).map_or(f64::NAN, |(mean, _)| mean),
        };
        let probes = self.topic().probes();
        let known = probes.iter().position(|other| other == probe);
        known
            .and_then(|index| {
                self.means.get_or_init(|| probes.iter().map(mean).collect()).get(index).copied()
            })
            .unwrap_or_else(|| mean(probe))
    }

    /// The same divided by [`Probe::unit`]: the truth, where that is not 0.
    pub fn ratio(&self, probe: &Probe) -> f64 {
        self.expected(probe) / probe.unit()
    }

    /// The std deviation of its draws on a probe by quadrature, where a draw takes at most 3 random numbers.
    ///
    /// Mistakes with equal means are told apart by it. None where the variance is infinite.
    pub fn spread(&self, probe: &Probe) -> Option<f64> {
        let spread = |probe: &Probe| self.exactly(probe).map(|exact| exact.variance.sqrt());
        let probes = self.topic().probes();
        match probes.iter().position(|other| other == probe) {
            Some(index) => *self.spreads.get_or_init(|| probes.iter().map(spread).collect()).get(index)?,
            None => spread(probe),
        }
    }

    /// Whether the probes tell it from `other` by their means: some ratio differs.
    pub fn told_apart<'p>(&self, other: &Self, probes: impl IntoIterator<Item = &'p Probe>) -> bool {
        probes.into_iter().any(|probe| {
            let (here, there) = (self.ratio(probe), other.ratio(probe));
            // equality covers infinite ratios
            let same = here == there || (here - there).abs() <= SAME * here.abs().min(there.abs()).max(1.0);
            !same
        })
    }

    /// Whether the probes see it at all, given unlimited draws: some ratio is not a right estimator's.
    pub fn is_seen_by(&self, probe: &Probe) -> bool {
        let invisible = (self.ratio(probe) - probe.right_ratio()).abs() <= SAME;
        !invisible
    }

    /// Whether the probes tell it from `other` by the std deviation of the draws, to one part in ten.
    pub fn told_apart_by_spread<'p>(
        &self,
        other: &Self,
        probes: impl IntoIterator<Item = &'p Probe>,
    ) -> bool {
        probes.into_iter().any(|probe| match (self.spread(probe), other.spread(probe)) {
            (Some(here), Some(there)) => (here - there).abs() > 0.1 * here.max(there),
            _ => false,
        })
    }

    /// The mean and variance of its draws on a probe by quadrature of the wrong estimator itself, where a draw
    /// takes at most 3 random numbers and both can be known.
    pub fn exactly(&self, probe: &Probe) -> Option<Exact> {
        let (mean, variance) = self.moments(probe)?;
        Some(Exact { mean, variance: variance.ok()? })
    }

    fn moments(&self, probe: &Probe) -> Option<(f64, Result<f64>)> {
        let estimator = self.wrong.at(probe).ok()?;
        moments(&estimator, self.random_numbers()?, LOOKS).ok()
    }
}

/// Looks of the quadrature's second rule: what jumps in the gallery is known, and is no narrower than this.
const LOOKS: f64 = 4096.0;

/// Ratios closer than this are the same but for rounding.
const SAME: f64 = 1e-8;
