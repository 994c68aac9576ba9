//! Speed against accuracy: which estimator has the smallest error for a given computing time.
//!
//! Estimators of the same quantity (rivals) differ in the variance σ² of a draw and in its time t. The
//! product counts: after T seconds the std error is √(σ² t/T), so the *efficiency* is 1/(σ² t), and the time
//! to a given error is proportional to σ² t. [`Trade`] measures both for any set of rivals. (Hammersley &
//! Handscomb 1964, section 5.1; *Physically Based Rendering*, 4th ed., section 2.2.)
//!
//! For jittered or Sobol points a draw is a whole replicate, with all of its work. A biased rival has a root
//! mean square error √(β² + σ² t/T), which does not fall below its bias β: a remark in the table tells when
//! the best unbiased one overtakes it. The bias is measured, too, so it has an error bar: a bias
//! within three of its std errors is *not seen*, and counts as 0. An estimator declared to have infinite
//! variance has no efficiency, and one whose variance comes mostly from a few draws is marked.

mod batches;
mod comparison;
#[cfg(feature = "workbook")]
pub mod figures;
mod measured;
mod shown;

pub use comparison::{Comparison, Ranked};
pub use measured::{Measured, Nature, Reach};

use crate::error::{Result, require};
use crate::estimator::Estimator;
use batches::Batches;

/// A bias, or a difference between two rivals, counts as real if it is more than this many std errors: 1 in
/// 370 that are 0 does.
const REAL: f64 = 3.0;

/// Batches per rival: 4k + 1, so that the median and the quartiles of their times are single batches.
const COUNT: u64 = 17;

/// One of the estimators that are compared.
pub struct Rival<'a> {
    name: String,
    series: Option<String>,
    estimator: Box<dyn Estimator + 'a>,
    nature: Nature,
}

impl<'a> Rival<'a> {
    /// An unbiased estimator of finite variance, with its name for tables and figures.
    pub fn new(name: impl Into<String>, estimator: impl Estimator + 'a) -> Self {
        Self { name: name.into(), series: None, estimator: Box::new(estimator), nature: Nature::Unbiased }
    }

    /// Declares what is known of the estimator. For a [`Biased`](Nature::Biased) rival the bias is measured,
    /// and it has no rank; one of [`InfiniteVariance`](Nature::InfiniteVariance) has no efficiency and
    /// reaches no error.
    ///
    /// ```
    /// use unbiased::from_fn;
    /// use unbiased::trade::{Nature, Rival};
    ///
    /// // ∫₀¹ x² dx with x clamped
    /// let clamped = from_fn(|rng| rng.uniform().clamp(0.1, 0.9).powi(2));
    /// let rival = Rival::new("clamped", clamped).nature(Nature::Biased);
    /// // ∫₀¹ 1/√x dx: E[1/x] is infinite
    /// let root = from_fn(|rng| (1.0 - rng.uniform()).sqrt().recip());
    /// let rival = Rival::new("1/√x", root).nature(Nature::InfiniteVariance);
    /// ```
    pub fn nature(self, nature: Nature) -> Self {
        Self { nature, ..self }
    }

    /// Makes it one of a series: rivals that differ only in the number of points per draw, counted as
    /// evaluations. [`Comparison::slope`] then gives how fast the error falls with the points.
    pub fn series(self, series: impl Into<String>) -> Self {
        Self { series: Some(series.into()), ..self }
    }
}

/// The settings of a comparison.
///
/// # Where the truth is not known
/// The truth is needed for biases, and as the unit of relative errors; variance, time, efficiency and rank do
/// not depend on it. Instead of the truth you can use a long run, with another seed, of an estimator that is
/// known to be unbiased; pass its std error to [`known_to`](Self::known_to), which includes it in that of
/// every bias.
///
/// ```
/// use unbiased::trade::{Nature, Rival, Trade};
/// use unbiased::{Budget, Estimator, Stream, estimate, from_fn};
///
/// let long = from_fn(|rng| (-rng.uniform()).exp());
/// let truth = estimate(&long, Budget::RelativeError(1e-4), 2)?;
/// let middle = from_fn(|rng| (-rng.uniform().clamp(0.25, 0.75)).exp());
/// let found = Trade::new(1, truth.mean())?
///     .known_to(truth.std_error().unwrap_or(0.0))?
///     .seconds_each(0.01)?
///     .compare(&[Rival::new("all", long), Rival::new("the middle", middle).nature(Nature::Biased)])?;
/// // e^(−x) is convex, so clamping x makes the mean smaller
/// assert!(found.rivals[1].bias_seen() && found.rivals[1].bias() < 0.0);
/// # Ok::<(), unbiased::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Trade {
    seed: u64,
    truth: f64,
    truth_error: f64,
    seconds: f64,
}

impl Trade {
    /// A comparison of estimators of `truth`, with 0.25 s for each. If the truth is 0, all errors are
    /// absolute.
    ///
    /// # Errors
    /// If the truth is not finite.
    pub fn new(seed: u64, truth: f64) -> Result<Self> {
        require("the truth", truth, truth.is_finite(), "finite")?;
        Ok(Self { seed, truth, truth_error: 0.0, seconds: 0.25 })
    }

    /// Sets the std error of the truth, if that is itself an estimate, in the truth's unit.
    ///
    /// # Errors
    /// If it is negative or not finite.
    pub fn known_to(self, std_error: f64) -> Result<Self> {
        let ok = std_error >= 0.0 && std_error.is_finite();
        Ok(Self { truth_error: require("the truth's std error", std_error, ok, "finite and ≥ 0")?, ..self })
    }

    /// Takes about this many seconds for each rival: a fifth to warm up, the rest for 17 batches of equally
    /// many draws. A batch has at least two draws, so a rival whose draws take more than 1/40 of this time
    /// takes longer: about 40 draws.
    ///
    /// # Errors
    /// If they are not positive and finite.
    pub fn seconds_each(self, seconds: f64) -> Result<Self> {
        let ok = seconds > 0.0 && seconds.is_finite();
        Ok(Self { seconds: require("the time in seconds", seconds, ok, "positive and finite")?, ..self })
    }

    /// Measures the rivals on one core, in turns, so that other load on the machine affects all alike. Batch
    /// b of every rival draws from the stream (seed, b): only the number of draws depends on the machine, not
    /// their values.
    ///
    /// ```
    /// use unbiased::from_fn;
    /// use unbiased::trade::{Rival, Trade};
    ///
    /// // ∫₀¹ √x dx = 2/3: one point; a point and its mirror image; a point of each half
    /// let plain = from_fn(|rng| rng.uniform().sqrt());
    /// let mirrored = from_fn(|rng| {
    ///     let x = rng.uniform();
    ///     0.5 * (x.sqrt() + (1.0 - x).sqrt())
    /// });
    /// let halves = from_fn(|rng| 0.5 * ((0.5 * rng.uniform()).sqrt() + (0.5 + 0.5 * rng.uniform()).sqrt()));
    ///
    /// let found = Trade::new(1, 2.0 / 3.0)?.seconds_each(0.02)?.compare(&[
    ///     Rival::new("one point", plain),
    ///     Rival::new("mirrored", mirrored),
    ///     Rival::new("halves", halves),
    /// ])?;
    /// println!("{found}"); // a table with ranks and remarks; found.csv() is for programs
    ///
    /// // the variance of √U is 1/18, that of the mean with its mirror image 1/36 + π/16 − 2/9 = 0.0019
    /// let [plain, mirrored, _] = &found.rivals[..] else { panic!("three rivals") };
    /// assert!((plain.variance() - 1.0 / 18.0).abs() <= 7.0 * plain.variance_error);
    /// let exact = 1.0 / 36.0 + std::f64::consts::PI / 16.0 - 2.0 / 9.0;
    /// assert!((mirrored.variance() - exact).abs() <= 7.0 * mirrored.variance_error);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    ///
    /// # Errors
    /// If a draw is NaN or infinite.
    pub fn compare(&self, rivals: &[Rival<'_>]) -> Result<Comparison> {
        let mut runs = Vec::new();
        for rival in rivals {
            runs.push(Batches::warm_up(&*rival.estimator, self.seed, self.seconds)?);
        }
        for batch in 0..COUNT {
            for (rival, run) in rivals.iter().zip(&mut runs) {
                run.take(&*rival.estimator, self.seed, batch)?;
            }
        }
        let measured = rivals.iter().zip(&runs).map(|(rival, run)| run.measured(rival, self));
        Ok(Comparison {
            seed: self.seed,
            truth: self.truth,
            truth_error: self.truth_error,
            rivals: measured.collect(),
        })
    }
}
