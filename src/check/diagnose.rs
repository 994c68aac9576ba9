//! Which classic mistakes does an estimator look like?

use std::fmt;

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::attempt::Attempt;
use super::counterexample::{Counterexample, counterexample};
use super::exercise::{Compound, Exercise, Mistake, Probe};
use super::measure::{Measurement, Ratio};
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
/// probe can tell apart form a group, ordered by how well their variance fits. If no single mistake fits,
/// constant multiples of mistakes are tried. A right estimator is called wrong with a probability of about
/// 1e-9.
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
/// assert_eq!(diagnosis.finding(), Finding::Known);
/// assert_eq!(diagnosis.candidates().next().unwrap().name(), "multiplied by λ");
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
        let (name, other) = (exercise.name(), other.probe.exercise().name());
        return Err(Error::Usage(format!(
            "probes of “{name}” and of “{other}” cannot be diagnosed together"
        )));
    }
    let mut diagnosis = Diagnosis {
        exercise,
        measurements: measurements.to_vec(),
        finding: Finding::Unclear,
        groups: Vec::new(),
        compared: exercise.mistakes().len(),
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

    let singles = exercise.mistakes().iter().map(|mistake| {
        let ratio = |probe: &Probe| exercise.ratio(mistake, probe);
        Candidate { factor: None, mistake: Some(mistake), ratios: per_probe(measurements, ratio) }
    });
    diagnosis.groups = grouped(measurements, singles);
    if diagnosis.groups.is_empty() && (wrong || constant) {
        let found: Vec<_> = measurements.iter().map(|of| exercise.compound_ratios(of.probe)).collect();
        let of = |(index, compound): (usize, &'static Compound)| Candidate {
            factor: Some(&compound.factor),
            mistake: compound.base.and_then(|base| exercise.mistakes().get(base)),
            ratios: found.iter().filter_map(|ratios| ratios.get(index).copied()).collect(),
        };
        diagnosis.compared += exercise.compounds().len();
        diagnosis.groups = grouped(measurements, exercise.compounds().iter().enumerate().map(of));
    }
    diagnosis.finding = if !diagnosis.groups.is_empty() && (wrong || constant) {
        for group in &mut diagnosis.groups {
            group.sort_by_spread(exercise, measurements);
        }
        Finding::Known
    } else if wrong {
        Finding::Unknown
    } else if !stuck && varied.iter().all(|of| of.ratio().error <= COARSE) {
        Finding::NothingWrong
    } else {
        Finding::Unclear
    };
    Ok(diagnosis)
}

impl Diagnosis {
    /// Adds a [counterexample](Self::counterexample), if the attempt is wrong and there is one.
    pub fn shown_by(mut self, attempt: &Attempt<'_>) -> Self {
        if matches!(self.finding, Finding::Known | Finding::Unknown) {
            self.counterexample = counterexample(self.exercise, attempt);
        }
        self
    }
}

impl Measurement {
    /// Whether the draws are consistent with the truth, and enough to say so.
    pub fn is_right(&self) -> bool {
        if self.estimate.draws() < FEWEST || self.never_varied() {
            return self.estimate.draws() >= FEWEST && self.is_the_truth();
        }
        let known = self.ratio().error <= COARSE;
        known && within(1, self.misfit(Ratio::exact(self.probe.right_ratio())), REGION)
    }
}

fn per_probe(measurements: &[Measurement], ratio: impl Fn(&Probe) -> Ratio) -> Vec<Ratio> {
    measurements.iter().map(|measurement| ratio(measurement.probe)).collect()
}

/// The candidates that fit, the best first, in groups of those that no probe tells apart.
fn grouped(measurements: &[Measurement], candidates: impl Iterator<Item = Candidate>) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for candidate in candidates {
        let fits = measurements.iter().zip(&candidate.ratios);
        let chi_square = fits.map(|(measurement, ratio)| measurement.misfit(*ratio)).sum();
        if !within(measurements.len(), chi_square, REGION) {
            continue;
        }
        let alike = |group: &&mut Group| group.candidates.iter().all(|other| !other.differs(&candidate));
        match groups.iter_mut().find(alike) {
            Some(group) => group.candidates.push(candidate),
            None => groups.push(Group { candidates: vec![candidate], chi_square }),
        }
    }
    groups.sort_by(|a, b| a.chi_square.total_cmp(&b.chi_square));
    groups
}

/// Whether χ² is below its quantile at 1 − `outside`; NaN is not.
fn within(probes: usize, chi_square: f64, outside: f64) -> bool {
    // by the survival function: 1 − outside would lose the last digits of `outside`
    ChiSquared::new(probes as f64).is_ok_and(|law| law.sf(chi_square) >= outside)
}

/// How far the measured mean squares are from the mistake's: Σ ln²(measured/expected).
fn spread_misfit(exercise: &Exercise, mistake: &Mistake, measurements: &[Measurement]) -> f64 {
    let of = |measurement: &Measurement| {
        let mean = measurement.ratio().mean;
        let spread = measurement.estimate.variance()? / measurement.probe.scale().powi(2);
        let ratio = (spread + mean * mean) / exercise.square(mistake, measurement.probe);
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
    factor: Option<&'static str>,
    mistake: Option<&'static Mistake>,
    ratios: Vec<Ratio>,
}

impl Candidate {
    /// The constant factor by which the draws are too large, in addition to the mistake: `2`, `1/π`, `λ`.
    pub fn factor(&self) -> Option<&'static str> {
        self.factor
    }

    /// The mistake; none if only the constant factor is wrong.
    pub fn mistake(&self) -> Option<&'static Mistake> {
        self.mistake
    }

    /// A stable name for programs: `log10`, `2*log10`, `2*right`.
    pub fn id(&self) -> String {
        let mistake = self.mistake.map_or("right", Mistake::id);
        self.factor.map_or_else(|| mistake.into(), |factor| format!("{factor}*{mistake}"))
    }

    /// A name for people.
    pub fn name(&self) -> String {
        match (self.factor, self.mistake.map(Mistake::name)) {
            (None, mistake) => mistake.unwrap_or("nothing").into(),
            (Some(factor), None) => format!("a factor of {factor} too much"),
            (Some(factor), Some(mistake)) => format!("a factor of {factor} too much, and {mistake}"),
        }
    }

    fn differs(&self, other: &Self) -> bool {
        self.ratios.iter().zip(&other.ratios).any(|(here, there)| here.differs(*there))
    }
}

/// Candidates that the probes tried cannot tell apart.
#[derive(Debug, Clone)]
pub struct Group {
    /// The candidates, in the order in which their variance fits.
    pub candidates: Vec<Candidate>,
    /// Σ((measured − its ratio)/error)² over the probes.
    pub chi_square: f64,
}

impl Group {
    fn sort_by_spread(&mut self, exercise: &Exercise, measurements: &[Measurement]) {
        if self.candidates.len() > 1 {
            self.candidates.sort_by_cached_key(|candidate| {
                let single = candidate.mistake.filter(|_| candidate.factor.is_none());
                let spread_misfit = single.map_or(0.0, |of| spread_misfit(exercise, of, measurements));
                // for numbers ≥ 0 the order of bits is that of the numbers
                spread_misfit.to_bits()
            });
        }
    }
}

/// The classic mistakes that measurements are consistent with; see [`diagnose`].
#[derive(Debug, Clone)]
pub struct Diagnosis {
    exercise: &'static Exercise,
    measurements: Vec<Measurement>,
    finding: Finding,
    groups: Vec<Group>,
    compared: usize,
    counterexample: Option<Counterexample>,
}

impl Diagnosis {
    /// The exercise.
    pub fn exercise(&self) -> &'static Exercise {
        self.exercise
    }

    /// The result.
    pub fn finding(&self) -> Finding {
        self.finding
    }

    /// The measurements diagnosed.
    pub fn measurements(&self) -> &[Measurement] {
        &self.measurements
    }

    /// If something is wrong: what the measurements are consistent with, the best fit first; else empty.
    pub fn groups(&self) -> &[Group] {
        if self.finding == Finding::Known { &self.groups } else { &[] }
    }

    /// The candidates of all [groups](Self::groups), in order.
    pub fn candidates(&self) -> impl Iterator<Item = &Candidate> {
        self.groups().iter().flat_map(|group| &group.candidates)
    }

    /// If nothing seems wrong, or there is no verdict: the mistakes that these probes and draws cannot
    /// exclude.
    pub fn hidden(&self) -> impl Iterator<Item = &'static Mistake> + '_ {
        let unseen = matches!(self.finding, Finding::NothingWrong | Finding::Unclear);
        let groups = if unseen { &self.groups[..] } else { &[] };
        groups.iter().flat_map(|group| &group.candidates).filter_map(|candidate| candidate.mistake)
    }

    /// How many mistakes, and constant multiples of mistakes, were compared.
    pub fn compared(&self) -> usize {
        self.compared
    }

    /// Random numbers at which the attempt is wrong, for checking by hand. Found only if its draws are
    /// functions of one or two uniform numbers, used in the same way as in the worksheet's estimator.
    pub fn counterexample(&self) -> Option<&Counterexample> {
        self.counterexample.as_ref()
    }

    /// The probes on which the draws are consistent with the truth.
    pub fn right_on(&self) -> impl Iterator<Item = &'static Probe> + '_ {
        self.measurements.iter().filter(|of| of.is_right()).map(|measurement| measurement.probe)
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
        for (index, group) in self.groups().iter().enumerate() {
            for (member, candidate) in group.candidates.iter().enumerate() {
                let number = if member == 0 { format!("{}.", index + 1) } else { "   or".into() };
                write!(f, "\n{number} {}", candidate.name())?;
                if let Some(mistake) = candidate.mistake {
                    write!(f, " ({}). To mend it: {}", mistake.formula(), mistake.mend())?;
                }
                write!(f, ".")?;
            }
            if group.candidates.len() > 1 {
                write!(
                    f,
                    "\n   (No probe tells these apart; they are in the order in which their spread fits.)"
                )?;
            }
        }
        if self.candidates().any(|candidate| candidate.factor.is_some()) {
            write!(f, "\n   (No single mistake fits; {} were compared, these among them.)", self.compared)?;
        }
        if let Some(counterexample) = &self.counterexample {
            write!(f, "\n{counterexample}")?;
        }
        if matches!(self.finding, Finding::Known | Finding::Unknown) {
            let right: Vec<_> = self.right_on().map(ToString::to_string).collect();
            if !right.is_empty() {
                write!(f, "\nRight on: {}.", right.join("; "))?;
            }
        }
        let hidden: Vec<_> = self.hidden().map(Mistake::name).collect();
        if !hidden.is_empty() {
            write!(f, "\nNot to be seen with these probes and draws: {}.", hidden.join("; "))?;
        }
        write!(f, "\nRatios to the truth (± 95 %):")?;
        for measurement in &self.measurements {
            let (ratio, scale) = (measurement.ratio().mean, measurement.probe.scale());
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

    /// Quantiles at both probabilities for 1 to 20 probes, by mpmath. statrs has P(χ² > x) to 3e-13, so x to
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
            [37.366986437996996, 65.172605428904614],
            [39.134403881949511, 67.349203348101654],
            [40.870655013836, 69.481205946526821],
            [42.579288953112995, 71.573465389968356],
            [44.263224944174978, 73.630000143546638],
            [45.924899051113545, 75.654184508573819],
            [47.566369558144421, 77.648885788841018],
            [49.189394471966512, 79.616565827135583],
            [50.79548966562189, 81.559357655594394],
            [52.385973273052167, 83.479124361693713],
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
}
