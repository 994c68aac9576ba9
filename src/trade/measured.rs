//! The measurements of one rival, and what follows from them.

use super::{COUNT, REAL};
use crate::doubt::Doubt;
use crate::estimate::Estimate;

/// What is known of an estimator in advance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Nature {
    /// Its mean is the truth.
    Unbiased,
    /// Its mean is not the truth.
    Biased,
    /// Its mean is the truth and its variance is infinite: its error bar is meaningless for any number of
    /// draws.
    InfiniteVariance,
}

/// When an error is reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reach {
    /// After so many seconds.
    After(f64),
    /// After so many seconds or later, or never: it is not known whether the bias is smaller than the error.
    AtLeast(f64),
    /// Never: the bias is larger, or the variance is infinite.
    Never,
}

impl Reach {
    /// The seconds, if they are known.
    pub fn seconds(self) -> Option<f64> {
        match self {
            Self::After(seconds) => Some(seconds),
            Self::AtLeast(_) | Self::Never => None,
        }
    }
}

/// The measurements of one rival. Variance, work and time are those of one draw, which may be a whole
/// replicate.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Its name.
    pub name: String,
    /// The series to which it belongs.
    pub series: Option<String>,
    /// What it was declared to be.
    pub nature: Nature,
    /// The estimate from its draws.
    pub estimate: Estimate,
    /// The truth.
    pub truth: f64,
    /// The std error of the truth; 0 if it is exact.
    pub truth_error: f64,
    /// The standard error of the variance, from batches, in the truth's unit squared.
    pub variance_error: f64,
    /// Whether the fraction of the sum of squares Σ (X − X̄)² that comes from one of the n draws exceeds both
    /// ln²(1000 n)/n and 1/√n: then the variance depends on a few draws, it may be infinite, and its error
    /// bar cannot be trusted.
    ///
    /// With tails no heavier than an exponential's, at most one set of draws in a thousand is marked; draws
    /// with a range of less than 11 standard deviations never are. The more draws, the more likely an
    /// infinite variance is found; below 132 draws none is. See `tests/trade.rs` for how often.
    pub heavy_tail: bool,
    /// Evaluations of the integrand (or rays, or vertices) that a draw takes.
    pub evaluations: f64,
    /// Random numbers that a draw takes.
    pub random_numbers: f64,
    /// Seconds that a draw takes: the median of 17 batches, each of which is the median of up to 256 pieces.
    pub seconds: f64,
    /// The quartiles of the batches' times.
    pub seconds_range: [f64; 2],
}

impl Measured {
    /// Why its variance cannot be trusted, if so.
    pub(crate) fn doubt(&self) -> Option<Doubt> {
        match self.nature {
            Nature::InfiniteVariance => Some(Doubt::InfiniteVariance),
            _ if !self.varies() => Some(Doubt::NeverVaried),
            _ => self.heavy_tail.then_some(Doubt::HeavyTail),
        }
    }

    /// The variance σ² of a draw, in the truth's unit squared: s² of the draws, or infinite if declared so.
    pub fn variance(&self) -> f64 {
        match self.nature {
            Nature::InfiniteVariance => f64::INFINITY,
            Nature::Unbiased | Nature::Biased => self.estimate.variance().unwrap_or(f64::NAN),
        }
    }

    /// The bias β, in the truth's unit: the measured mean − truth for a biased rival, with the std error
    /// [`bias_error`](Self::bias_error); 0 for an unbiased one.
    pub fn bias(&self) -> f64 {
        if self.nature == Nature::Biased { self.estimate.mean() - self.truth } else { 0.0 }
    }

    /// The standard error of the bias, √(σ²/n + τ²), where τ is the std error of the truth; 0 for an unbiased
    /// rival.
    pub fn bias_error(&self) -> f64 {
        if self.nature == Nature::Biased {
            self.estimate.std_error().unwrap_or(f64::INFINITY).hypot(self.truth_error)
        } else {
            0.0
        }
    }

    /// Whether the bias is more than three of its std errors, and more than rounding. That happens for 1 in
    /// 370 rivals whose bias is 0. A bias that is not seen counts as 0.
    pub fn bias_seen(&self) -> bool {
        let bias = self.bias().abs();
        bias > REAL * self.bias_error() && bias > 8.0 * f64::EPSILON * self.truth.abs()
    }

    /// The smallest and the largest |bias| within three std errors.
    pub(super) fn bias_range(&self) -> [f64; 2] {
        let (bias, reach) = (self.bias().abs(), REAL * self.bias_error());
        let least = if self.bias_seen() { bias - reach } else { 0.0 };
        [least, bias + reach]
    }

    /// The efficiency 1/(σ² t), in 1/(unit² s), with the truth's unit; infinite if the draws do not vary, 0
    /// if the variance is infinite.
    pub(crate) fn efficiency(&self) -> f64 {
        if self.varies() { (self.variance() * self.seconds).recip() } else { f64::INFINITY }
    }

    /// Whether the draws differ by more than rounding: σ > 8 ε |mean|.
    pub(crate) fn varies(&self) -> bool {
        self.variance().sqrt() > 8.0 * f64::EPSILON * self.estimate.mean().abs()
    }

    /// What errors are relative to: |truth|, or 1 if that is 0.
    pub(crate) fn scale(&self) -> f64 {
        if self.truth == 0.0 { 1.0 } else { self.truth.abs() }
    }

    /// The standard error of ln seconds.
    pub(super) fn time_error(&self) -> f64 {
        let [low, high] = self.seconds_range;
        // that of the median of normal values, from their quartiles
        1.253 * (high - low) / 1.349 / (COUNT as f64).sqrt() / self.seconds
    }

    /// The standard error of ln efficiency, from those of variance and time.
    pub(super) fn efficiency_error(&self) -> f64 {
        let of_variance = if self.variance() > 0.0 { self.variance_error / self.variance() } else { 0.0 };
        self.time_error().hypot(of_variance)
    }

    /// The bias if it is seen, else 0.
    fn counted_bias(&self) -> f64 {
        if self.bias_seen() { self.bias() } else { 0.0 }
    }

    /// The root mean square error √(β² + σ² t/T) after T `seconds` on one core, in the truth's unit.
    pub(crate) fn rmse(&self, seconds: f64) -> f64 {
        if self.nature == Nature::InfiniteVariance {
            return f64::INFINITY;
        }
        (self.variance() * self.seconds / seconds).sqrt().hypot(self.counted_bias())
    }

    /// When the root mean square error falls to `error` > 0, relative to the truth (absolute if the truth is
    /// 0): after T = σ² t/(error² − β²) seconds on one core, but not before the first draw is done.
    pub fn seconds_to(&self, error: f64) -> Reach {
        let aim = error.abs() * self.scale();
        let [least, most] = self.bias_range();
        let with_bias =
            |bias: f64| (self.variance() * self.seconds / ((aim - bias) * (aim + bias))).max(self.seconds);
        if self.nature == Nature::InfiniteVariance || aim <= least || aim.is_nan() {
            Reach::Never
        } else if aim > most {
            Reach::After(with_bias(self.counted_bias().abs()))
        } else {
            Reach::AtLeast(with_bias(least))
        }
    }
}
