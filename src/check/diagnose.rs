//! Which classic mistakes does an estimator look like?

use std::fmt;

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::attempt::Attempt;
use super::counterexample::{Counterexample, counterexample};
use super::exercise::{Exercise, Mistake};
use super::measure::Measurement;
use super::ratio::Ratio;
use crate::error::{Error, Result};
use crate::numbers::plus_minus;

/// The probability that the confidence region excludes the mistake that was made.
const REGION: f64 = 1e-4;

/// The probability that a right estimator is called wrong.
const FALSE_ALARM: f64 = 1e-9;

/// With a std error larger than this, relative to the truth, there is no verdict "right".
const COARSE: f64 = 0.1;

/// With fewer draws, all of them 0, there is no verdict, as rare hits may not have occurred yet: hits in 0.3
/// % of draws are all missed by this many draws with probability 1e-12.
const ZEROS: u64 = 10_000;

/// With fewer draws on a probe there is no verdict.
const FEWEST: u64 = 30;

/// Finds the classic mistakes that the measurements are consistent with.
///
/// Every [mistake](Exercise::mistakes) has a known ratio to the truth on each probe. Those for which
/// Σ((measured − ratio)/error)² lies in the joint confidence region of level 1 − 1e-4 (χ², one degree of
/// freedom per probe, corrected for few or skewed draws) are listed, the best fit first. Mistakes that no
/// probe can tell apart are ordered by how well their variance fits. If no single mistake fits, constant
/// multiples of mistakes are tried. A right estimator is called wrong with a probability of about 1e-9.
///
/// There is no verdict from fewer than 30 draws per probe. Draws that are all equal are evidence for a
/// mistake whose draws are constant, or for a right estimator if they equal the truth; otherwise they are no
/// evidence.
///
/// ```
/// use unbiased::check::{self, Attempt, Finding};
/// use unbiased::inversion::mistakes::Samples;
///
/// let mine = Attempt::new(|p: &Samples, rng| -p.rate * (1.0 - rng.uniform()).ln());
/// let diagnosis = check::diagnose(&check::measure(&mine, 100_000, 1)?)?;
/// assert_eq!(diagnosis.finding, Finding::Known);
/// assert_eq!(diagnosis.candidates[0].name(), "multiplied by λ");
/// # Ok::<(), unbiased::Error>(())
/// ```
///
/// # Errors
/// If there are no measurements, or they are from several exercises.
pub fn diagnose(measurements: &[Measurement]) -> Result<Diagnosis> {
    let [first, ..] = measurements else {
        return Err(Error::TooFewDraws { statistic: "a diagnosis", needed: FEWEST, draws: 0 });
    };
    let exercise = first.probe.exercise();
    if let Some(other) = measurements.iter().find(|of| !std::ptr::eq(of.probe.exercise(), exercise)) {
        let (name, other) = (exercise.name, other.probe.exercise().name);
        return Err(Error::Usage(format!(
            "probes of “{name}” and of “{other}” cannot be diagnosed together"
        )));
    }
    let mut diagnosis = Diagnosis {
        exercise,
        measurements: measurements.to_vec(),
        finding: Finding::Unclear,
        candidates: Vec::new(),
        hidden: Vec::new(),
        compared: exercise.mistakes.len(),
        counterexample: None,
    };
    if measurements.iter().any(|measurement| measurement.estimate.draws() < FEWEST) {
        return Ok(diagnosis);
    }
    let varied: Vec<_> = measurements.iter().filter(|measurement| !measurement.never_varied()).collect();
    let off: f64 = varied.iter().map(|of| of.misfit(Ratio::exact(of.probe.right_ratio()))).sum();
    let wrong = !varied.is_empty() && !within(varied.len(), off, FALSE_ALARM);
    let fixed = |of: &&Measurement| of.never_varied() && !of.is_the_truth();
    let stuck = measurements.iter().any(|of| fixed(&of));
    // few draws that are all 0 may just have missed rare hits
    let enough = |of: &Measurement| of.estimate.mean() != 0.0 || of.estimate.draws() >= ZEROS;
    let constant = stuck && measurements.iter().filter(fixed).all(enough);

    let singles = exercise.mistakes.iter().map(|mistake| {
        let ratios = measurements.iter().map(|of| exercise.ratio(mistake, of.probe)).collect();
        Candidate { factor: None, mistake: Some(mistake), rank: 0, ratios }
    });
    let mut fitting = ranked(measurements, singles);
    if fitting.is_empty() && (wrong || constant) {
        let found: Vec<_> = measurements.iter().map(|of| exercise.compound_ratios(of.probe)).collect();
        let compounds = exercise.compounds().enumerate().map(|(index, (which, mistake))| Candidate {
            factor: first.probe.factors.get(which).map(|(name, _)| name.as_str()),
            mistake,
            rank: 0,
            ratios: found.iter().filter_map(|ratios| ratios.get(index).copied()).collect(),
        });
        diagnosis.compared += exercise.compounds().count();
        fitting = ranked(measurements, compounds);
    }
    if !fitting.is_empty() && (wrong || constant) {
        sort_by_spread(&mut fitting, measurements);
        (diagnosis.finding, diagnosis.candidates) = (Finding::Known, fitting);
    } else if wrong {
        diagnosis.finding = Finding::Unknown;
    } else {
        if !stuck && varied.iter().all(|of| of.ratio().error <= COARSE) {
            diagnosis.finding = Finding::NothingWrong;
        }
        diagnosis.hidden = fitting.iter().filter_map(|candidate| candidate.mistake).collect();
    }
    Ok(diagnosis)
}

impl Measurement {
    /// Whether the draws are consistent with the truth, and enough to say so.
    pub(crate) fn is_right(&self) -> bool {
        if self.estimate.draws() < FEWEST || self.never_varied() {
            return self.estimate.draws() >= FEWEST && self.is_the_truth();
        }
        let known = self.ratio().error <= COARSE;
        known && within(1, self.misfit(Ratio::exact(self.probe.right_ratio())), REGION)
    }
}

/// The candidates that fit, the best first; those that no probe tells apart have the same rank.
fn ranked(measurements: &[Measurement], candidates: impl Iterator<Item = Candidate>) -> Vec<Candidate> {
    let mut groups: Vec<(f64, Vec<Candidate>)> = Vec::new();
    for candidate in candidates {
        let fits = measurements.iter().zip(&candidate.ratios);
        let chi_square = fits.map(|(measurement, ratio)| measurement.misfit(*ratio)).sum();
        if !within(measurements.len(), chi_square, REGION) {
            continue;
        }
        let alike = |(_, group): &&mut (_, Vec<_>)| group.iter().all(|other| !candidate.differs(other));
        match groups.iter_mut().find(alike) {
            Some((_, group)) => group.push(candidate),
            None => groups.push((chi_square, vec![candidate])),
        }
    }
    groups.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let ranked = groups.into_iter().enumerate().flat_map(|(rank, (_, group))| {
        group.into_iter().map(move |candidate| Candidate { rank, ..candidate })
    });
    ranked.collect()
}

/// Sorts candidates of the same rank by how well their variance fits.
fn sort_by_spread(candidates: &mut [Candidate], measurements: &[Measurement]) {
    for alike in candidates.chunk_by_mut(|a, b| a.rank == b.rank).filter(|alike| alike.len() > 1) {
        alike.sort_by_cached_key(|candidate| {
            let single = candidate.mistake.filter(|_| candidate.factor.is_none());
            // for numbers ≥ 0 the order of bits is that of the numbers
            single.map_or(0.0, |mistake| spread_misfit(mistake, measurements)).to_bits()
        });
    }
}

/// Whether χ² is below its quantile at 1 − `outside`; NaN is not.
fn within(probes: usize, chi_square: f64, outside: f64) -> bool {
    // by the survival function: 1 − outside would lose the last digits of `outside`
    ChiSquared::new(probes as f64).is_ok_and(|law| law.sf(chi_square) >= outside)
}

/// How far the measured mean squares are from the mistake's: Σ ln²(measured/expected).
fn spread_misfit(mistake: &Mistake, measurements: &[Measurement]) -> f64 {
    let of = |measurement: &Measurement| {
        let mean = measurement.ratio().mean;
        let spread = measurement.estimate.variance()? / measurement.probe.scale.powi(2);
        let ratio = (spread + mean * mean) / mistake.square(measurement.probe);
        let off = ratio.ln().powi(2);
        off.is_finite().then_some(off)
    };
    measurements.iter().filter_map(of).sum()
}

/// The result of a diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Finding {
    /// All ratios are consistent with a right estimator's.
    NothingWrong,
    /// No verdict: too few draws, draws that are all equal, or a std error above a tenth of the truth.
    Unclear,
    /// Wrong, and consistent with at least one classic mistake, or a constant times a mistake.
    Known,
    /// Wrong, and consistent with none of the classic mistakes.
    Unknown,
}

/// What may be wrong: a mistake, a constant factor, or both.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// The constant factor by which the draws are too large, in addition to the mistake: `2`, `1/π`, `λ`.
    pub factor: Option<&'static str>,
    /// The mistake; none if only the constant factor is wrong.
    pub mistake: Option<&'static Mistake>,
    /// Its place by how well it fits, from 0; the same for candidates that the probes tried cannot tell
    /// apart.
    pub rank: usize,
    ratios: Vec<Ratio>,
}

impl Candidate {
    /// A stable name for programs: `log10`, `2*log10`, `2*right`.
    pub fn id(&self) -> String {
        let mistake = self.mistake.map_or("right", |mistake| mistake.id);
        self.factor.map_or_else(|| mistake.into(), |factor| format!("{factor}*{mistake}"))
    }

    /// A name for people.
    pub fn name(&self) -> String {
        match (self.factor, self.mistake) {
            (None, None) => "nothing".into(),
            (None, Some(mistake)) => mistake.name.into(),
            (Some(factor), None) => format!("a factor of {factor} too much"),
            (Some(factor), Some(mistake)) => format!("a factor of {factor} too much, and {}", mistake.name),
        }
    }

    fn differs(&self, other: &Self) -> bool {
        self.ratios.iter().zip(&other.ratios).any(|(here, there)| here.differs(*there))
    }
}

/// The classic mistakes that measurements are consistent with; see [`diagnose`].
#[derive(Debug, Clone)]
pub struct Diagnosis {
    /// The exercise.
    pub exercise: &'static Exercise,
    /// The measurements diagnosed.
    pub measurements: Vec<Measurement>,
    /// The result.
    pub finding: Finding,
    /// If something is wrong: what the measurements are consistent with, the best fit first.
    pub candidates: Vec<Candidate>,
    /// If nothing seems wrong, or there is no verdict: the mistakes that these probes and draws cannot
    /// exclude.
    pub hidden: Vec<&'static Mistake>,
    /// How many mistakes, and constant multiples of mistakes, were compared.
    pub compared: usize,
    /// Random numbers at which the attempt is wrong, for checking by hand. Found only if its draws are
    /// functions of one or two uniform numbers, used in the same way as in the worksheet's estimator.
    pub counterexample: Option<Counterexample>,
}

impl Diagnosis {
    /// Adds a [counterexample](Self::counterexample), if the attempt is wrong and there is one.
    pub fn shown_by(mut self, attempt: &Attempt<'_>) -> Self {
        if matches!(self.finding, Finding::Known | Finding::Unknown) {
            self.counterexample = counterexample(self.exercise, attempt);
        }
        self
    }

    /// Why there is no verdict, and how many draws would be needed.
    fn too_little(&self) -> String {
        let fewest = self.measurements.iter().map(|of| of.estimate.draws()).min().unwrap_or(0);
        if fewest < FEWEST {
            return format!("Too few draws to judge: {fewest}. Take 1000 a probe or more.");
        }
        let stuck = self.measurements.iter().find(|of| of.never_varied() && !of.is_the_truth());
        if let Some(stuck) = stuck {
            let (value, probe, draws) = (stuck.estimate.mean(), stuck.probe, stuck.estimate.draws());
            let more = 100 * draws;
            return format!(
                "No verdict: all {draws} draws for “{probe}” are {value}, which is not the truth, but draws \
                 of rare large values could begin so. Take {more}, or look at your program."
            );
        }
        let needed = self.measurements.iter().map(|of| {
            let short = of.ratio().error / COARSE;
            of.estimate.draws() as f64 * (short * short).max(1.0)
        });
        let needed = needed.fold(0.0, f64::max);
        format!(
            "Too uncertain to say: a std error is above a tenth of the truth. It takes some {needed:.1e} \
             draws a probe; if the error does not fall then, the variance is infinite."
        )
    }
}

/// The diagnosis in sentences, one per line.
impl fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.finding {
            Finding::NothingWrong => {
                write!(f, "Nothing wrong seen: all ratios to the truth are consistent with 1.")?
            }
            Finding::Unclear => write!(f, "{}", self.too_little())?,
            Finding::Known => write!(f, "Not right. The ratios to the truth are consistent with:")?,
            Finding::Unknown => write!(
                f,
                "Not right, and none of the {} mistakes compared, of which most are a constant times \
                 another.",
                self.compared
            )?,
        }
        for alike in self.candidates.chunk_by(|a, b| a.rank == b.rank) {
            for (member, candidate) in alike.iter().enumerate() {
                let number = if member == 0 { format!("{}.", candidate.rank + 1) } else { "   or".into() };
                write!(f, "\n{number} {}", candidate.name())?;
                if let Some(Mistake { formula, mend, .. }) = candidate.mistake {
                    write!(f, " ({formula}). To mend it: {mend}")?;
                }
                write!(f, ".")?;
            }
            if alike.len() > 1 {
                write!(
                    f,
                    "\n   (No probe tells these apart; they are in the order in which their spread fits.)"
                )?;
            }
        }
        if self.candidates.iter().any(|candidate| candidate.factor.is_some()) {
            write!(f, "\n   (No single mistake fits; {} were compared, these among them.)", self.compared)?;
        }
        if let Some(counterexample) = &self.counterexample {
            write!(f, "\n{counterexample}")?;
        }
        if matches!(self.finding, Finding::Known | Finding::Unknown) {
            let right = self.measurements.iter().filter(|of| of.is_right());
            let right: Vec<_> = right.map(|of| of.probe.to_string()).collect();
            if !right.is_empty() {
                write!(f, "\nRight on: {}.", right.join("; "))?;
            }
        }
        let hidden: Vec<_> = self.hidden.iter().map(|mistake| mistake.name).collect();
        if !hidden.is_empty() {
            write!(f, "\nNot to be seen with these probes and draws: {}.", hidden.join("; "))?;
        }
        write!(f, "\nRatios to the truth (± 95 %):")?;
        for measurement in &self.measurements {
            let (ratio, scale) = (measurement.ratio().mean, measurement.probe.scale);
            let reach = measurement.estimate.reach().unwrap_or(f64::INFINITY) / scale;
            let note = if measurement.probe.right_ratio() == 0.0 { " (of ∫|f|; right is 0)" } else { "" };
            write!(f, "\n  {}: {}{note}", measurement.probe, plus_minus(ratio, reach))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::{Problem, measure};
    use crate::lambertian::mistakes::Reflection;

    /// Quantiles at both probabilities for 1 to 10 probes, by mpmath. statrs has P(χ² > x) to 3e-13, so x to
    /// 5e-14: the relative error of x is that of P divided by x times the hazard rate, which is 7 or more
    /// here.
    #[test]
    fn the_region_has_its_probability() {
        let edges = [
            [15.136705226623397, 37.324893051362329],
            [18.420680743952365, 41.446531673892822],
            [21.107513466160214, 44.841275330562401],
            [23.512742444990839, 47.879455731147947],
            [25.744831959055875, 50.692193701543032],
            [27.856341236013917, 53.344573117300227],
            [29.877503909224907, 55.874781012829018],
            [31.827628001262319, 58.307613127485629],
            [33.719948438964634, 60.660308373772402],
            [35.564013941952112, 62.945457420558571],
        ];
        for (probes, edges) in (1..).zip(edges) {
            for (outside, edge) in [REGION, FALSE_ALARM].into_iter().zip(edges) {
                assert!(within(probes, edge * (1.0 - 1e-12), outside), "{probes}, {outside}");
                assert!(!within(probes, edge * (1.0 + 1e-12), outside), "{probes}, {outside}");
            }
        }
        for outside in [REGION, FALSE_ALARM] {
            assert!(within(1, 0.0, outside) && !within(0, 0.0, outside));
            assert!(!within(1, f64::NAN, outside) && !within(1, f64::INFINITY, outside));
        }
    }

    /// Few draws leave several ranks: the best is first, and each is inside the region.
    #[test]
    fn candidates_come_best_first() {
        let exercise = Reflection::exercise();
        let mut several = 0;
        for (mistake, seed) in exercise.mistakes.iter().zip(6000..) {
            let measured = measure(&exercise.attempt_of(mistake, 1.0), 200, seed).unwrap();
            let misfits =
                |of: &Candidate| measured.iter().zip(&of.ratios).map(|(of, at)| of.misfit(*at)).sum();
            let candidates = diagnose(&measured).unwrap().candidates;
            let chi_squares: Vec<f64> = candidates.iter().map(misfits).collect();
            assert!(chi_squares.iter().all(|of| within(measured.len(), *of, REGION)), "{chi_squares:?}");
            let best = |alike: &[Candidate]| alike.iter().map(misfits).fold(f64::INFINITY, f64::min);
            let ranks: Vec<f64> = candidates.chunk_by(|a, b| a.rank == b.rank).map(best).collect();
            assert!(ranks.is_sorted() && candidates.is_sorted_by_key(|of| of.rank), "{ranks:?}");
            several += usize::from(ranks.len() > 1);
        }
        assert!(several >= 5, "{several}");
    }
}
