//! Estimators to be checked.

use std::fmt;

use super::exercise::{Draw, Exercise, Mistake, Probe, Problem, erased};
use super::measure::Measurement;
use crate::error::{Error, Result, require_count};
use crate::estimate::Estimate;
use crate::estimator::{Estimator, from_fn};
use crate::run::{Budget, Outcome, Run};
use crate::stream::{Stream, mix};

/// Someone's estimator, right or wrong, of a given exercise.
///
/// ```
/// use unbiased::{Budget, check::Attempt, estimate, inversion::mistakes::Samples};
///
/// let attempt = Attempt::new(|p: &Samples, rng| -(1.0 - rng.uniform()).ln() / p.rate);
/// for probe in &attempt.exercise.probes {
///     let estimate = estimate(&attempt.on(probe)?, Budget::Draws(10_000), 1)?;
///     assert!(estimate.z(probe.truth).unwrap().abs() < 5.0);
/// }
/// # Ok::<(), unbiased::Error>(())
/// ```
pub struct Attempt<'a> {
    /// The exercise that it belongs to.
    pub exercise: &'static Exercise,
    pub(super) draw: Box<Draw<'a>>,
}

impl<'a> Attempt<'a> {
    /// The estimator whose draw for a problem is `draw(problem, random numbers)`. The problem's type
    /// determines the exercise.
    pub fn new<P: Problem>(draw: impl Fn(&P, &mut Stream) -> f64 + Send + Sync + 'a) -> Self {
        Self { exercise: P::exercise(), draw: erased(draw) }
    }

    /// The attempt on a probe, as an estimator of [`Probe::truth`].
    ///
    /// # Errors
    /// If the probe belongs to another exercise.
    pub fn on(&self, probe: &Probe) -> Result<impl Estimator + use<'_, 'a>> {
        let index = probe.index;
        if std::ptr::eq(probe.exercise(), self.exercise) {
            Ok(from_fn(move |rng| (self.draw)(index, 1.0, rng)))
        } else {
            let mine = self.exercise.name;
            Err(Error::Usage(format!("an attempt at “{mine}” cannot be tried on “{probe}”")))
        }
    }

    /// Draws on one probe until the budget is spent, with the run's threads, limits and progress.
    ///
    /// # Errors
    /// Those of [`Run::estimate`]; the error of a draw that is NaN or infinite names the probe.
    pub(crate) fn measure(
        &self,
        probe: &'static Probe,
        run: &Run<'_>,
        budget: Budget,
    ) -> Result<(Measurement, Outcome)> {
        let mine = self.on(probe)?;
        let with_probe = |error| match error {
            Error::Draw { block, draw, value, .. } => {
                Error::OnProbe { probe: probe.to_string(), first: block == 0 && draw == 0, value }
            }
            other => other,
        };
        let outcome = run.estimate(&mine, budget).map_err(with_probe)?;
        let found = outcome.estimate;
        let mut skewness = f64::NAN;
        if let Some(deviation) = found.variance().map(f64::sqrt).filter(|deviation| *deviation > 0.0) {
            // the same draws again, or FIRST others
            let cubed = from_fn(|rng| ((mine.draw(rng) - found.mean()) / deviation).powi(3));
            let first = Budget::Draws(found.draws().min(FIRST));
            let cubes = run.estimate(&cubed, first).map(|outcome| outcome.estimate);
            let varied = |cubes: &Estimate| cubes.variance().is_some_and(|variance| variance > 0.0);
            skewness = cubes.ok().filter(varied).map_or(f64::NAN, |cubes| cubes.mean());
        }
        Ok((Measurement { probe, estimate: found, skewness }, outcome))
    }
}

impl Exercise {
    /// A mistake with every draw multiplied by a constant, as if it were your own estimator.
    pub fn attempt_of(&'static self, mistake: &'static Mistake, constant: f64) -> Attempt<'static> {
        let draw = move |probe, factor: f64, rng: &mut Stream| (mistake.wrong)(probe, constant * factor, rng);
        Attempt { exercise: self, draw: Box::new(draw) }
    }
}

impl fmt::Debug for Attempt<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Attempt").field(&self.exercise).finish()
    }
}

/// Enough draws to estimate the skewness.
const FIRST: u64 = 1 << 17;

/// The seed of a probe's draws. It differs between probes, since a diagnosis treats their errors as
/// independent.
pub fn seed_of(probe: &Probe, seed: u64) -> u64 {
    mix(seed.wrapping_add(mix(probe.index as u64 + 1)))
}

/// Measures an attempt on all probes of its exercise, with `draws` draws each.
///
/// # Errors
/// If there are fewer than 2 draws, or a draw is not finite.
pub fn measure(attempt: &Attempt<'_>, draws: u64, seed: u64) -> Result<Vec<Measurement>> {
    require_count("the number of draws", draws, draws >= 2, "at least 2")?;
    let on = |probe| {
        let run = Run::new(seed_of(probe, seed));
        attempt.measure(probe, &run, Budget::Draws(draws)).map(|(measurement, _)| measurement)
    };
    attempt.exercise.probes.iter().map(on).collect()
}
