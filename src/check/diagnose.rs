//! Which classic mistakes does an estimator look like?

use std::fmt;

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::mistakes::{Attempt, Mistake, Probe, Topic};
use crate::error::{Error, Result, require_count};
use crate::estimate::Estimate;
use crate::run::{Budget, estimate};
use crate::stream::mix;

/// What an attempt's draws on one probe came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    /// The probe.
    pub probe: Probe,
    /// The mean found.
    pub estimate: Estimate,
}

impl Measurement {
    /// The mean found divided by [`Probe::unit`], with its std error.
    pub fn ratio(&self) -> (f64, f64) {
        let unit = self.probe.unit();
        (self.estimate.mean() / unit, self.estimate.std_error().unwrap_or(f64::INFINITY) / unit.abs())
    }

    /// ((measured − predicted)/error)², the error not below rounding.
    ///
    /// Draws without a mean have no ratio to compare with, but show themselves all the same: the largest draw is then a good part of their sum, so that
    /// the std error is, too. The misfit grows as the std error falls below 5 % of the mean.
    fn misfit(&self, predicted: f64) -> f64 {
        let (ratio, error) = self.ratio();
        if predicted.is_nan() {
            return f64::INFINITY;
        }
        if predicted.is_infinite() {
            return (0.05 * ratio / error.max(ROUNDING * ratio.abs())).powi(2);
        }
        let floor = ROUNDING * predicted.abs().max(1.0);
        let misfit = (ratio - predicted) / error.hypot(floor);
        misfit * misfit
    }
}

/// Estimators in f32 are right to about this, relative to the truth, however small their std error.
const ROUNDING: f64 = 1e-6;

/// The probability with which the right mistake may fall outside the region.
const REGION: f64 = 1e-4;

/// The probability with which a right estimator may be taken for a wrong one.
const FALSE_ALARM: f64 = 1e-9;

/// With a larger std error than this, relative to the truth, being consistent with it means nothing.
const COARSE: f64 = 0.1;

/// Tries an attempt on all probes of its topic, `draws` draws each.
///
/// # Errors
/// If there are fewer than 2 draws, or a draw is not finite.
pub fn measure(attempt: &Attempt<'_>, draws: u64, seed: u64) -> Result<Vec<Measurement>> {
    measure_on(attempt, attempt.topic().probes(), draws, seed)
}

/// The same on these probes alone.
///
/// # Errors
/// Those of [`measure`], and if a probe belongs to another topic.
pub fn measure_on(
    attempt: &Attempt<'_>,
    probes: &[Probe],
    draws: u64,
    seed: u64,
) -> Result<Vec<Measurement>> {
    require_count("the number of draws", draws, draws >= 2, "at least 2")?;
    let on = |(index, probe): (usize, &Probe)| {
        // the errors are added up as independent ones, so each probe has numbers of its own
        let seed = mix(seed.wrapping_add(mix(index as u64 + 1)));
        Ok(Measurement {
            probe: *probe,
            estimate: estimate(&attempt.at(probe)?, Budget::Draws(draws), seed)?,
        })
    };
    probes.iter().enumerate().map(on).collect()
}

/// Names the classic mistakes whose signature the measurements show.
///
/// Every mistake of the [gallery](Topic::mistakes) predicts a ratio to the truth on each probe. Those with Σ((measured − predicted)/error)² inside the joint
/// confidence region of 1 − 1e-4 (χ², one degree of freedom a probe) are listed, the best first, and those that no probe can tell apart together, in
/// the order in which their draws' spread fits. A right estimator is diagnosed with probability 1e-9 at most, as far as means are normal: use 1e5 draws a probe or so.
///
/// # Errors
/// If there are no measurements, or they are of several topics, or of fewer than 2 draws.
///
/// ```
/// use unbiased::check::{self, Attempt, Finding};
///
/// let mine = Attempt::exponential(|rate, rng| -rate * (1.0 - rng.uniform()).ln());
/// let diagnosis = check::diagnose(&check::measure(&mine, 100_000, 1)?)?;
/// assert_eq!(diagnosis.finding(), Finding::Known);
/// assert_eq!(diagnosis.candidates().next().unwrap().name(), "multiplied by λ");
/// # Ok::<(), unbiased::Error>(())
/// ```
pub fn diagnose(measurements: &[Measurement]) -> Result<Diagnosis> {
    let [first, ..] = measurements else {
        return Err(Error::TooFewDraws { statistic: "a diagnosis", needed: 2, draws: 0 });
    };
    let topic = first.probe.topic();
    for measurement in measurements {
        if measurement.probe.topic() != topic {
            let other = measurement.probe.topic();
            return Err(Error::Usage(format!(
                "probes of “{topic}” and of “{other}” cannot be diagnosed together"
            )));
        }
        if measurement.estimate.draws() < 2 {
            let draws = measurement.estimate.draws();
            return Err(Error::TooFewDraws { statistic: "a diagnosis", needed: 2, draws });
        }
    }
    let chi_square = |predicted: &dyn Fn(&Probe) -> f64| -> f64 {
        measurements.iter().map(|measurement| measurement.misfit(predicted(&measurement.probe))).sum()
    };
    let probes = || measurements.iter().map(|measurement| &measurement.probe);
    let tried = measurements.len();

    let right = chi_square(&Probe::right_ratio);
    let mut groups: Vec<Group> = Vec::new();
    for mistake in topic.mistakes() {
        let chi_square = chi_square(&|probe| mistake.ratio(probe));
        if !within(tried, chi_square, REGION) {
            continue;
        }
        match groups
            .iter_mut()
            .find(|group| group.mistakes.iter().all(|other| !other.told_apart(mistake, probes())))
        {
            Some(group) => group.mistakes.push(mistake),
            None => groups.push(Group { mistakes: vec![mistake], chi_square }),
        }
    }
    groups.sort_by(|a, b| a.chi_square.total_cmp(&b.chi_square));
    for group in &mut groups {
        if group.mistakes.len() > 1 {
            group
                .mistakes
                .sort_by(|a, b| strangeness(a, measurements).total_cmp(&strangeness(b, measurements)));
        }
    }
    let precise = measurements.iter().all(|measurement| measurement.ratio().1 <= COARSE);
    let finding = if within(tried, right, FALSE_ALARM) {
        if precise { Finding::NothingWrong } else { Finding::Unclear }
    } else if groups.is_empty() {
        Finding::Unknown
    } else {
        Finding::Known
    };
    Ok(Diagnosis { topic, measurements: measurements.to_vec(), right, finding, groups })
}

/// Whether χ² is below what all but a share `outside` of measurements stay below; NaN is not.
fn within(probes: usize, chi_square: f64, outside: f64) -> bool {
    // not by a quantile at 1 − outside, which has lost the last digits of `outside`
    ChiSquared::new(probes as f64).is_ok_and(|law| law.sf(chi_square) >= outside)
}

/// How far the measured std deviations are from those predicted: Σ ln².
fn strangeness(mistake: &Mistake, measurements: &[Measurement]) -> f64 {
    let of = |measurement: &Measurement| {
        let unit = measurement.probe.unit().abs();
        let measured = measurement.estimate.variance()?.sqrt() / unit;
        let predicted = mistake.spread(&measurement.probe)? / unit;
        let ratio = (measured + ROUNDING) / (predicted + ROUNDING);
        Some(ratio.ln().powi(2))
    };
    // a spread that is not known is taken for a factor of 1.1 off: worse than one that fits, better than one that does not
    measurements.iter().map(|measurement| of(measurement).unwrap_or(0.01)).sum()
}

/// What a diagnosis comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Finding {
    /// All ratios are consistent with a right estimator's.
    NothingWrong,
    /// The same, but some std error is above a tenth of the truth: too few draws, or draws of infinite variance.
    Unclear,
    /// Wrong, and consistent with at least one classic mistake.
    Known,
    /// Wrong, and consistent with none of the classic mistakes.
    Unknown,
}

/// Mistakes that the probes tried cannot tell apart.
#[derive(Debug, Clone)]
pub struct Group {
    /// They, the one whose spread fits best first.
    pub mistakes: Vec<&'static Mistake>,
    /// Σ((measured − predicted)/error)² over the probes.
    pub chi_square: f64,
}

/// The classic mistakes that measurements are consistent with; see [`diagnose`].
#[derive(Debug, Clone)]
pub struct Diagnosis {
    topic: Topic,
    measurements: Vec<Measurement>,
    right: f64,
    finding: Finding,
    groups: Vec<Group>,
}

impl Diagnosis {
    /// What was diagnosed.
    pub fn topic(&self) -> Topic {
        self.topic
    }

    /// What the diagnosis comes to.
    pub fn finding(&self) -> Finding {
        self.finding
    }

    /// What it rests on.
    pub fn measurements(&self) -> &[Measurement] {
        &self.measurements
    }

    /// Σ((measured − right)/error)² over the probes.
    pub fn chi_square_of_right(&self) -> f64 {
        self.right
    }

    /// Where something is wrong: the mistakes it is consistent with, the best first. None where nothing seems wrong.
    pub fn groups(&self) -> &[Group] {
        if self.finding == Finding::Known { &self.groups } else { &[] }
    }

    /// The same, one after the other.
    pub fn candidates(&self) -> impl Iterator<Item = &'static Mistake> + '_ {
        self.groups().iter().flat_map(|group| group.mistakes.iter().copied())
    }

    /// Where nothing seems wrong, or all is unclear: the mistakes that these probes and this many draws could not see.
    pub fn hidden(&self) -> impl Iterator<Item = &'static Mistake> + '_ {
        let unseen = matches!(self.finding, Finding::NothingWrong | Finding::Unclear);
        let groups = if unseen { &self.groups[..] } else { &[] };
        groups.iter().flat_map(|group| group.mistakes.iter().copied())
    }
}

/// The diagnosis in sentences, one a line.
impl fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.finding {
            Finding::NothingWrong => {
                write!(f, "Nothing wrong seen: all ratios to the truth are consistent with 1.")?
            }
            Finding::Unclear => write!(
                f,
                "Too uncertain to say: a std error is above a tenth of the truth. Take more draws; if it does not fall, the variance is infinite."
            )?,
            Finding::Known => write!(f, "Not right. The ratios to the truth are consistent with:")?,
            Finding::Unknown => write!(f, "Not right, and none of the known mistakes.")?,
        }
        for (index, group) in self.groups().iter().enumerate() {
            for (member, mistake) in group.mistakes.iter().enumerate() {
                let number = if member == 0 { format!("{}.", index + 1) } else { "   or".into() };
                let (name, formula, fix) = (mistake.name(), mistake.formula(), mistake.fix());
                write!(f, "\n{number} {name} ({formula}). To mend it: {fix}.")?;
            }
            if group.mistakes.len() > 1 {
                write!(
                    f,
                    "\n   (No probe tells these apart; they are in the order in which their spread fits.)"
                )?;
            }
        }
        let hidden: Vec<_> = self.hidden().map(Mistake::name).collect();
        if !hidden.is_empty() {
            write!(f, "\nNot to be seen with these probes and draws: {}.", hidden.join("; "))?;
        }
        write!(f, "\nRatios:")?;
        for measurement in &self.measurements {
            let (ratio, error) = measurement.ratio();
            let right = measurement.probe.right_ratio();
            let note = if right == 1.0 { "" } else { " (of ∫|f|; right is 0)" };
            write!(f, "\n  {}: {ratio:.4} ± {error:.4}{note}", measurement.probe)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles at both probabilities for 1 to 20 probes, by mpmath. statrs has P(χ² > x) to 3e-13, so x to
    /// 5e-14: its relative error is P's by x times the hazard rate, which is 7 or more here.
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
