//! The estimate from a run's draws: mean, variance, standard error and confidence interval.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result, require};
use crate::float::two_sum;
use crate::numbers::plus_minus;
use crate::quantile::student_t;

mod moments;
mod twofold;

pub(crate) use moments::SLICE;
use moments::{Moments, STEP, is_plain, unscale};
use twofold::{Twofold, fast_two_sum};

/// The mean of some draws, with its standard error.
///
/// With draws X₁ … Xₙ, the mean is X̄ = 1/n Σ Xᵢ, the variance is the unbiased s² = 1/(n−1) Σ (Xᵢ − X̄)²,
/// and the standard error of the mean is s/√n. Units are those of the draws (squared, for the variance).
///
/// ```
/// use unbiased::Estimate;
///
/// let estimate = Estimate::from_draws(&[1.0, 2.0, 3.0, 4.0]);
/// assert_eq!(estimate.mean(), 2.5);
/// assert_eq!(estimate.variance(), Some(5.0 / 3.0));
/// assert_eq!(Estimate::from_draws(&[7.0]).variance(), None); // one draw has no variance
/// ```
///
/// A draw that is NaN or infinite makes the mean NaN or infinite; [`crate::estimate()`] ends with an error
/// instead.
///
/// Its JSON form holds the sums to the last bit; an infinity or NaN is a string.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(from = "Moments", into = "Moments")]
pub struct Estimate {
    moments: Moments,
    /// Where draws are pushed one at a time, squares are taken about this value, the mean of at least the
    /// first half of them. So at most half of the sum of squares is due to its distance from the mean, and a
    /// push needs no division.
    pivot: Option<f64>,
}

impl From<Moments> for Estimate {
    fn from(moments: Moments) -> Self {
        Self { moments, pivot: None }
    }
}

impl From<Estimate> for Moments {
    fn from(estimate: Estimate) -> Self {
        estimate.settled()
    }
}

impl PartialEq for Estimate {
    fn eq(&self, other: &Self) -> bool {
        self.settled() == other.settled()
    }
}

impl Default for Estimate {
    fn default() -> Self {
        Self::new()
    }
}

impl Estimate {
    /// No draws yet; the mean of none is NaN.
    pub const fn new() -> Self {
        Self { moments: Moments::NONE, pivot: None }
    }

    /// The estimate from these draws.
    pub fn from_draws(draws: &[f64]) -> Self {
        let mut estimate = Self::new();
        estimate.extend_from_slice(draws);
        estimate
    }

    /// Adds one draw.
    #[inline]
    pub fn push(&mut self, draw: f64) {
        if let Some(pivot) = self.pivot {
            let off = draw - pivot;
            let square = off * off;
            if is_plain(square) || off == 0.0 {
                let moments = &mut self.moments;
                moments.draws += 1;
                moments.sum = moments.sum.loosely_plus(draw, two_sum);
                moments.squares = moments.squares.loosely_plus(square, fast_two_sum);
                if !moments.draws.is_power_of_two() {
                    return;
                }
            } else {
                self.join(draw);
            }
        } else {
            self.join(draw);
        }
        self.move_pivot();
    }

    /// Adds many draws, faster than one at a time and equally accurate.
    pub(crate) fn extend_from_slice(&mut self, draws: &[f64]) {
        for slice in draws.chunks(SLICE) {
            *self = self.settled().merged(&Moments::of_slice(slice)).into();
        }
    }

    /// Adds all draws of another estimate of the same quantity.
    ///
    /// With δ = mean_b − mean_a: Σ² = Σ²_a + Σ²_b + δ² n_a n_b / n. The number of draws saturates at the
    /// largest `u64`.
    pub fn merge(&mut self, other: &Self) {
        *self = self.settled().merged(&other.settled()).into();
    }

    /// The number of draws.
    pub fn draws(&self) -> u64 {
        self.moments.draws
    }

    /// The mean X̄ = 1/n Σ Xᵢ; NaN if there are no draws.
    pub fn mean(&self) -> f64 {
        let Moments { draws, sum, sum_exponent, .. } = self.moments;
        if draws == 0 { f64::NAN } else { unscale(sum.over(draws as f64).hi, sum_exponent) }
    }

    /// The unbiased variance of one draw, s² = 1/(n−1) Σ (Xᵢ − X̄)²; `None` for fewer than two draws.
    pub fn variance(&self) -> Option<f64> {
        let Moments { squares, exponent, .. } = self.settled();
        let mean_square = (squares.hi + squares.lo) / self.degrees_of_freedom()?;
        Some(unscale(unscale(mean_square, exponent), exponent))
    }

    /// The standard error of the mean, s/√n; `None` for fewer than two draws.
    pub fn std_error(&self) -> Option<f64> {
        let Moments { squares, exponent, draws, .. } = self.settled();
        let mean_square = (squares.hi + squares.lo) / self.degrees_of_freedom()?;
        Some(unscale((mean_square / draws as f64).sqrt(), exponent))
    }

    /// The interval mean ± t·s/√n, which contains the truth with probability `level`, for the quantile t of
    /// Student's distribution with n − 1 degrees of freedom. It is exact for normal draws, and a good
    /// approximation for others once n is large enough for their mean to be near normal.
    ///
    /// ```
    /// let estimate = unbiased::Estimate::from_draws(&[1.0, 2.0, 3.0, 4.0]);
    /// let [low, high] = estimate.confidence_interval(0.95)?;
    /// assert!(low < 2.5 && 2.5 < high);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    ///
    /// # Errors
    /// If `level` is not strictly between 0 and 1, or there are fewer than two draws.
    pub fn confidence_interval(&self, level: f64) -> Result<[f64; 2]> {
        require("a confidence level", level, level > 0.0 && level < 1.0, "strictly between 0 and 1")?;
        let (Some(std_error), Some(freedom)) = (self.std_error(), self.degrees_of_freedom()) else {
            return Err(Error::TooFewDraws {
                statistic: "a confidence interval",
                needed: 2,
                draws: self.draws(),
            });
        };
        let reach = student_t(freedom, level) * std_error;
        Ok([self.mean() - reach, self.mean() + reach])
    }

    /// Half the width of the 95 % confidence interval.
    pub(crate) fn reach(&self) -> Option<f64> {
        let [low, high] = self.confidence_interval(0.95).ok()?;
        Some(0.5 * high - 0.5 * low)
    }

    /// (mean − truth)/(standard error); ±∞ for an infinite truth; `None` for fewer than two draws, a truth
    /// that is NaN, or draws that are not finite.
    ///
    /// A difference of at most 8 units in the last place of `truth` is rounding and counts as 0, so that an
    /// estimator without variance has z = 0 if it is right. This does not work for a truth of 0: an estimator
    /// of it should itself return 0 where its value is only a rounding error.
    pub fn z(&self, truth: f64) -> Option<f64> {
        let std_error = self.std_error()?;
        let off = self.mean() - truth;
        let rounding = truth.is_finite() && off.abs() <= 8.0 * f64::EPSILON * truth.abs();
        let z = if rounding { 0.0 } else { off / std_error };
        (!z.is_nan()).then_some(z)
    }

    fn degrees_of_freedom(&self) -> Option<f64> {
        (self.draws() >= 2).then(|| (self.draws() - 1) as f64)
    }

    /// Adds one draw of any size.
    #[cold]
    #[inline(never)]
    fn join(&mut self, draw: f64) {
        *self = self.settled().merged(&Moments::of_equal(draw, 1)).into();
    }

    #[cold]
    #[inline(never)]
    fn move_pivot(&mut self) {
        *self = self.settled().about_mean();
    }

    /// The moments with the squares taken about the mean, not the pivot.
    fn settled(&self) -> Moments {
        let moments = self.moments;
        let Some(pivot) = self.pivot else { return moments };
        let n = moments.draws as f64;
        let off = moments.sum.over(n).plus(-pivot);
        let squares = moments.squares.join(off.squared().by(-n));
        if squares.hi > 0.0 {
            Moments { squares, ..moments }
        } else {
            // without variance there is no scale to choose yet
            Moments { squares: Twofold::ZERO, exponent: -STEP, ..moments }
        }
    }
}

/// The mean and its 95 % confidence interval, to their significant digits: `0.31276 ± 0.00024 (95 %)`.
impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.reach() {
            Some(reach) => write!(f, "{} (95 %)", plus_minus(self.mean(), reach)),
            None => write!(f, "{} (too few draws for an error)", self.mean()),
        }
    }
}
