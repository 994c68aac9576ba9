//! What a run of draws says: mean, variance, standard error and confidence interval.
//!
//! Moments are kept so that no digit is lost that `f64` draws allow: each slice of draws is summed
//! about its own mean in two passes, slices are merged pairwise (Chan, Golub & LeVeque 1983), and the
//! running mean and sum of squares are each held as an unevaluated sum of two `f64`. Merging adds
//! positive terms only, so nothing cancels, however large the mean is beside the spread. The squares
//! carry an exponent of their own: the std error is right whenever *it* is representable, even where
//! the variance is not.

use std::fmt;

use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use crate::error::{Error, Result, require};

/// Draws summed in one two-pass sweep: they stay in the first-level cache between the passes.
pub(crate) const SLICE: usize = 512;

/// Squares are kept about one of three exponents, −600, 0 and 600, so that none over- or underflows.
const STEP: i32 = 600;
const UP: f64 = f64::from_bits((1023 + STEP as u64) << 52);
const DOWN: f64 = f64::from_bits((1023 - STEP as u64) << 52);

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
/// A draw that is NaN or infinite makes the mean NaN or infinite; [`crate::estimate()`] ends with an error instead.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    draws: u64,
    mean: Twofold,
    /// Σ (Xᵢ − X̄)² / 4^exponent
    squares: Twofold,
    exponent: i32,
}

impl Default for Estimate {
    fn default() -> Self {
        Self::new()
    }
}

impl Estimate {
    /// No draws yet; the mean of none is NaN.
    pub const fn new() -> Self {
        Self { draws: 0, mean: Twofold::ZERO, squares: Twofold::ZERO, exponent: -STEP }
    }

    /// The estimate that these draws give.
    pub fn from_draws(draws: &[f64]) -> Self {
        let mut estimate = Self::new();
        estimate.extend_from_slice(draws);
        estimate
    }

    /// Takes in one draw.
    pub fn push(&mut self, draw: f64) {
        self.merge(&Self { draws: 1, mean: Twofold { hi: draw, lo: 0.0 }, ..Self::new() });
    }

    /// Takes in many draws, faster than one at a time and equally exact.
    pub fn extend_from_slice(&mut self, draws: &[f64]) {
        for slice in draws.chunks(SLICE) {
            self.merge(&Self::of_slice(slice));
        }
    }

    /// Takes in all that another estimate of the same quantity has seen.
    ///
    /// With δ = mean_b − mean_a: Σ² = Σ²_a + Σ²_b + δ² n_a n_b / n and mean = mean_a + δ n_b / n.
    pub fn merge(&mut self, other: &Self) {
        // the larger side is the base: the mean then moves by at most half of δ and cannot overflow
        let (a, b) = if self.draws >= other.draws { (*self, other) } else { (*other, &*self) };
        if b.draws == 0 {
            *self = a;
            return;
        }
        let (n_a, n_b) = (a.draws as f64, b.draws as f64);
        let n = n_a + n_b;
        let delta = b.mean.minus(a.mean);
        let step = exponent_of(delta);
        let scaled = match step {
            STEP => b.mean.times(DOWN).minus(a.mean.times(DOWN)),
            0 => delta,
            _ => delta * UP,
        };
        let exponent = a.exponent.max(b.exponent).max(step);
        let moved = Twofold { hi: scaled * scaled * (n_a / n) * n_b, lo: 0.0 };
        *self = Self {
            draws: a.draws + b.draws,
            mean: a.mean.plus(unscale(scaled * (n_b / n), step)),
            squares: lower(a.squares, a.exponent, exponent)
                .join(lower(b.squares, b.exponent, exponent))
                .join(lower(moved, step, exponent)),
            exponent,
        };
    }

    /// How many draws were taken in.
    pub fn draws(&self) -> u64 {
        self.draws
    }

    /// The mean X̄ = 1/n Σ Xᵢ; NaN if there are no draws.
    pub fn mean(&self) -> f64 {
        if self.draws == 0 { f64::NAN } else { self.mean.hi + self.mean.lo }
    }

    /// The unbiased variance of one draw, s² = 1/(n−1) Σ (Xᵢ − X̄)²; `None` for fewer than two draws.
    pub fn variance(&self) -> Option<f64> {
        let mean_square = (self.squares.hi + self.squares.lo) / self.degrees_of_freedom()?;
        Some(unscale(unscale(mean_square, self.exponent), self.exponent))
    }

    /// The standard error of the mean, s/√n; `None` for fewer than two draws.
    pub fn std_error(&self) -> Option<f64> {
        let mean_square = (self.squares.hi + self.squares.lo) / self.degrees_of_freedom()?;
        Some(unscale((mean_square / self.draws as f64).sqrt(), self.exponent))
    }

    /// The interval mean ± t·s/√n that covers the truth with probability `level`, t being Student's with
    /// n − 1 degrees of freedom. It is exact for normal draws, and holds for others once n is large enough
    /// for their mean to be near normal.
    ///
    /// # Errors
    /// If `level` is not strictly between 0 and 1, or there are fewer than two draws.
    ///
    /// ```
    /// let estimate = unbiased::Estimate::from_draws(&[1.0, 2.0, 3.0, 4.0]);
    /// let [low, high] = estimate.confidence_interval(0.95)?;
    /// assert!(low < 2.5 && 2.5 < high);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    pub fn confidence_interval(&self, level: f64) -> Result<[f64; 2]> {
        require("a confidence level", level, level > 0.0 && level < 1.0, "strictly between 0 and 1")?;
        let (Some(std_error), Some(freedom)) = (self.std_error(), self.degrees_of_freedom()) else {
            return Err(Error::TooFewDraws {
                statistic: "a confidence interval",
                needed: 2,
                draws: self.draws,
            });
        };
        let reach = student_t(freedom, 0.5 * (1.0 - level)) * std_error;
        Ok([self.mean() - reach, self.mean() + reach])
    }

    /// How many standard errors the mean lies from `truth`; `None` for fewer than two draws.
    ///
    /// A difference of at most 8 units in the last place of `truth` is rounding and counts as none, so that an
    /// estimator without variance has z = 0 where it is right.
    pub fn z(&self, truth: f64) -> Option<f64> {
        let std_error = self.std_error()?;
        let off = self.mean() - truth;
        Some(if off.abs() <= 8.0 * f64::EPSILON * truth.abs() { 0.0 } else { off / std_error })
    }

    fn degrees_of_freedom(&self) -> Option<f64> {
        (self.draws >= 2).then(|| (self.draws - 1) as f64)
    }

    /// The moments of up to [`SLICE`] draws, in two passes: any shift near the mean will do in the second.
    fn of_slice(draws: &[f64]) -> Self {
        if draws.iter().all(|draw| *draw == draws[0]) {
            let mean = Twofold { hi: draws[0], lo: 0.0 };
            return Self { draws: draws.len() as u64, mean, ..Self::new() };
        }
        let n = draws.len() as f64;
        let shift = lanes(draws, |x| [x, 0.0])[0] / n;
        let [sum, sum_of_squares] = lanes(draws, |x| {
            let d = x - shift;
            [d, d * d]
        });
        let squares = sum_of_squares - sum * (sum / n);
        // 2⁻⁹⁰⁰ and 2⁹⁰⁰: far enough inside f64 that no square in the sum was rounded away or overflowed
        if (DOWN * DOWN.sqrt()..=UP * UP.sqrt()).contains(&squares) {
            Self {
                draws: draws.len() as u64,
                mean: Twofold { hi: shift, lo: 0.0 }.plus(sum / n),
                squares: Twofold { hi: squares, lo: 0.0 },
                exponent: 0,
            }
        } else {
            Self::of_extreme_slice(draws)
        }
    }

    /// Tiny, huge or non-finite draws: one at a time, which is exact for every exponent.
    #[cold]
    fn of_extreme_slice(draws: &[f64]) -> Self {
        let mut estimate = Self::new();
        for &draw in draws {
            estimate.push(draw);
        }
        estimate
    }
}

impl Extend<f64> for Estimate {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, draws: I) {
        for draw in draws {
            self.push(draw);
        }
    }
}

impl FromIterator<f64> for Estimate {
    fn from_iter<I: IntoIterator<Item = f64>>(draws: I) -> Self {
        let mut estimate = Self::new();
        estimate.extend(draws);
        estimate
    }
}

/// `mean ± std error`, both to the digits that the error leaves meaningful: `0.31276 ± 0.00012`.
/// A precision given in the format string, `{:.3}`, is used instead.
impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(std_error) = self.std_error() else {
            return write!(f, "{} (too few draws for an error)", self.mean());
        };
        let places = f.precision().unwrap_or_else(|| places(std_error));
        let mean = self.mean();
        if std_error == 0.0 {
            write!(f, "{mean} ± 0")
        } else if (1e-12..1e12).contains(&std_error) && mean.abs() < 1e15 {
            write!(f, "{mean:.places$} ± {std_error:.places$}")
        } else {
            write!(f, "{mean:e} ± {std_error:.1e}")
        }
    }
}

/// Decimal places that show two digits of `std_error`.
fn places(std_error: f64) -> usize {
    let leading = std_error.log10().floor();
    if leading.is_finite() { (1.0 - leading).clamp(0.0, 17.0) as usize } else { 6 }
}

/// The t with P(T > t) = `tail` for Student's T with `freedom` degrees of freedom.
fn student_t(freedom: f64, tail: f64) -> f64 {
    // beyond 10⁷ degrees t and z agree to 1e-6, and statrs' quantile starts to lose digits
    if freedom <= 1e7
        && let Ok(t) = StudentsT::new(0.0, 1.0, freedom)
    {
        -t.inverse_cdf(tail)
    } else {
        -Normal::standard().inverse_cdf(tail)
    }
}

/// Sums of both components of `f` over the draws, in eight interleaved lanes.
#[inline(always)]
fn lanes(draws: &[f64], f: impl Fn(f64) -> [f64; 2]) -> [f64; 2] {
    let (mut first, mut second) = ([0.0; 8], [0.0; 8]);
    let (eights, rest) = draws.as_chunks::<8>();
    for eight in eights {
        for lane in 0..8 {
            let [x, y] = f(eight[lane]);
            first[lane] += x;
            second[lane] += y;
        }
    }
    for (lane, &draw) in rest.iter().enumerate() {
        let [x, y] = f(draw);
        first[lane] += x;
        second[lane] += y;
    }
    [first.iter().sum(), second.iter().sum()]
}

/// The exponent about which `delta`² is kept.
fn exponent_of(delta: f64) -> i32 {
    let size = delta.abs();
    if size < DOWN.sqrt() {
        -STEP
    } else if size <= UP.sqrt() {
        0
    } else {
        STEP
    }
}

/// x · 2^exponent
fn unscale(x: f64, exponent: i32) -> f64 {
    match exponent {
        0 => x,
        STEP => x * UP,
        _ => x * DOWN,
    }
}

/// Squares kept about `from`, expressed about `to` ≥ `from`; what underflows is below any rounding.
fn lower(squares: Twofold, from: i32, to: i32) -> Twofold {
    (from..to).step_by(STEP as usize).fold(squares, |kept, _| kept.times(DOWN).times(DOWN))
}

/// An unevaluated sum `hi + lo` with |lo| ≤ ½ ulp(hi): twice the digits of `f64` (Knuth's two-sum).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Twofold {
    hi: f64,
    lo: f64,
}

impl Twofold {
    const ZERO: Self = Self { hi: 0.0, lo: 0.0 };

    fn plus(self, x: f64) -> Self {
        let sum = self.hi + x;
        let added = sum - self.hi;
        let lost = (self.hi - (sum - added)) + (x - added);
        let low = self.lo + lost;
        let hi = sum + low;
        Self { hi, lo: if hi.is_finite() { low - (hi - sum) } else { 0.0 } }
    }

    fn join(self, other: Self) -> Self {
        self.plus(other.lo).plus(other.hi)
    }

    fn minus(self, other: Self) -> f64 {
        (self.hi - other.hi) + (self.lo - other.lo)
    }

    /// Exact for powers of two.
    fn times(self, power: f64) -> Self {
        Self { hi: self.hi * power, lo: self.lo * power }
    }
}
