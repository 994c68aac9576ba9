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
    let edge = region(measurements.len(), REGION);

    let right = chi_square(&Probe::right_ratio);
    let mut groups: Vec<Group> = Vec::new();
    for mistake in topic.mistakes() {
        let chi_square = chi_square(&|probe| mistake.ratio(probe));
        let inside = chi_square <= edge; // NaN is not
        if !inside {
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
    let finding = if right <= region(measurements.len(), FALSE_ALARM) {
        if precise { Finding::NothingWrong } else { Finding::Unclear }
    } else if groups.is_empty() {
        Finding::Unknown
    } else {
        Finding::Known
    };
    Ok(Diagnosis { topic, measurements: measurements.to_vec(), right, finding, groups })
}

/// χ² below which all but a share `outside` of measurements stay.
fn region(probes: usize, outside: f64) -> f64 {
    match ChiSquared::new(probes as f64) {
        Ok(chi_square) => chi_square.inverse_cdf(1.0 - outside),
        Err(_) => f64::NEG_INFINITY, // no probes
    }
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

    /// With two degrees of freedom P(χ² > x) = e^(−x/2).
    #[test]
    fn the_region_has_its_probability() {
        for outside in [REGION, FALSE_ALARM] {
            let off = region(2, outside) / (-2.0 * outside.ln()) - 1.0;
            assert!(off.abs() <= 1e-6, "{outside}: {off}");
        }
    }
}
