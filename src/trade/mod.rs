//! Speed against accuracy: what a second buys.
//!
//! Rival estimators of one quantity differ in the variance of a draw and in the time that it takes. What
//! counts is the product: after T seconds the std error of an estimator whose draws have variance σ² and take
//! t seconds is √(σ² t/T), so its *efficiency* is 1/(σ² t) (Hammersley & Handscomb 1964, section 5.1;
//! *Physically Based Rendering*, 4th ed., section 2.2), and the time to a given error is proportional to σ²
//! t. [`Trade`] measures both for any set of rivals, side by side.
//!
//! Draws that are not independent of each other, such as jittered or Sobol points, come in replicates: there
//! a draw is a whole replicate, and its work is counted. A biased rival has a root mean square error √(β² +
//! σ² t/T), which stops at its bias β: [`Measured::overtaken_at`] says when an unbiased one is better. The
//! bias is measured, too, so it has an error bar: a bias within three of its std errors is *not seen*, and
//! nothing is concluded from it. An infinite variance is never averaged away: an estimator that declares it
//! has no efficiency, and one whose variance hangs on a few draws is marked.

mod batches;
mod comparison;
#[cfg(feature = "workbook")]
pub mod figures;
mod measured;
mod shown;

pub use comparison::{Comparison, Ranked};
pub use measured::{Crossing, Measured, Nature, Reach};

use crate::error::{Result, require};
use crate::estimator::Estimator;
use batches::Batches;

/// Std errors within which a bias, or a difference between two rivals, may be noise: of 370 that are none,
/// one lies beyond.
const REAL: f64 = 3.0;

/// One of the estimators that are compared.
pub struct Rival<'a> {
    name: String,
    series: Option<String>,
    estimator: Box<dyn Estimator + 'a>,
    nature: Nature,
}

impl<'a> Rival<'a> {
    /// An unbiased estimator of finite variance, under the name that tables and figures give it.
    ///
    /// ```
    /// use unbiased::from_fn;
    /// use unbiased::trade::Rival;
    ///
    /// // ∫₀¹ x² dx
    /// let plain = Rival::new("one point", from_fn(|rng| rng.uniform().powi(2)));
    /// ```
    pub fn new(name: impl Into<String>, estimator: impl Estimator + 'a) -> Self {
        Self { name: name.into(), series: None, estimator: Box::new(estimator), nature: Nature::Unbiased }
    }

    /// The same, of which this is known. It decides what can be said of the rival: a
    /// [`Biased`](Nature::Biased) one gets its bias measured and no rank, one of
    /// [`InfiniteVariance`](Nature::InfiniteVariance) no efficiency and no time to any error.
    ///
    /// ```
    /// use unbiased::from_fn;
    /// use unbiased::trade::{Nature, Rival};
    ///
    /// // ∫₀¹ x² dx without its ends
    /// let clamped = from_fn(|rng| rng.uniform().clamp(0.1, 0.9).powi(2));
    /// let rival = Rival::new("clamped", clamped).nature(Nature::Biased);
    /// // ∫₀¹ 1/√x dx: E[1/x] is infinite
    /// let root = from_fn(|rng| (1.0 - rng.uniform()).sqrt().recip());
    /// let rival = Rival::new("1/√x", root).nature(Nature::InfiniteVariance);
    /// ```
    pub fn nature(self, nature: Nature) -> Self {
        Self { nature, ..self }
    }

    /// The same, as one of a series: rivals that differ only in how many points a draw takes, which each must
    /// count as evaluations. [`Comparison::slope`] then says how fast the error falls with the points.
    pub fn series(self, series: impl Into<String>) -> Self {
        Self { series: Some(series.into()), ..self }
    }
}

/// A comparison to be made.
///
/// # Where the truth is not known
/// The truth is needed for biases, and as the unit of relative errors; variance, time, efficiency and rank do
/// not depend on it. In its place take a long run of an estimator that is known to be unbiased, with another
/// seed, and say how well it is known: [`known_to`](Self::known_to) lets its std error count in that of every
/// bias.
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
/// // e^(−x) is convex: without its ends its mean is smaller
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
    /// A comparison of estimators of `truth`, a quarter of a second each. Where the truth is 0, all errors
    /// are absolute.
    ///
    /// # Errors
    /// If the truth is not finite.
    pub fn new(seed: u64, truth: f64) -> Result<Self> {
        require("the truth", truth, truth.is_finite(), "finite")?;
        Ok(Self { seed, truth, truth_error: 0.0, seconds: 0.25 })
    }

    /// The same with a truth that is itself an estimate, with this std error, in the truth's unit.
    ///
    /// # Errors
    /// If it is negative or not finite.
    pub fn known_to(self, std_error: f64) -> Result<Self> {
        let ok = std_error >= 0.0 && std_error.is_finite();
        Ok(Self { truth_error: require("the truth's std error", std_error, ok, "finite and ≥ 0")?, ..self })
    }

    /// Takes about this many seconds for each rival: a fifth to warm up, the rest for 17 batches of equally
    /// many draws. A batch has at least two draws, so that rivals whose draws take more than a fortieth of
    /// these seconds take longer: some 40 draws.
    ///
    /// # Errors
    /// If they are not positive and finite.
    pub fn seconds_each(self, seconds: f64) -> Result<Self> {
        let ok = seconds > 0.0 && seconds.is_finite();
        Ok(Self { seconds: require("the time in seconds", seconds, ok, "positive and finite")?, ..self })
    }

    /// Measures the rivals on one core, in turns, so that what disturbs the machine disturbs all alike. Batch
    /// b of every rival draws from the stream (seed, b): the draws' values do not depend on the machine, only
    /// their number does.
    ///
    /// # Errors
    /// If a draw is NaN or infinite.
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
    /// println!("{found}"); // a table with ranks and remarks; found.csv() and serde are for programs
    ///
    /// // the variance of √U is 1/18, that of the mean with its mirror image 1/36 + π/16 − 2/9 = 0.0019
    /// let [plain, mirrored, _] = &found.rivals[..] else { panic!("three rivals") };
    /// assert!((plain.variance() - 1.0 / 18.0).abs() <= 7.0 * plain.variance_error);
    /// let exact = 1.0 / 36.0 + std::f64::consts::PI / 16.0 - 2.0 / 9.0;
    /// assert!((mirrored.variance() - exact).abs() <= 7.0 * mirrored.variance_error);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    pub fn compare(&self, rivals: &[Rival<'_>]) -> Result<Comparison> {
        let mut runs = Vec::new();
        for rival in rivals {
            runs.push(Batches::warm_up(&*rival.estimator, self.seed, self.seconds)?);
        }
        for batch in 0..batches::COUNT {
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
