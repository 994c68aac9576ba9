//! The estimate from a run's draws: mean, variance, standard error and confidence interval.
//!
//! Moments are accurate to the last digits of `f64`: Σ Xᵢ and Σ (Xᵢ − X̄)² are each a double-double, an
//! unevaluated sum of two `f64`. Each slice of draws is summed in two passes, the squares about the slice's
//! own mean, and slices are merged (Chan, Golub & LeVeque 1983): that adds positive terms only, so there is
//! no cancellation, however large the mean is compared with the standard deviation. Sums and squares have
//! separate exponents: the mean and the std error are right whenever *they* are representable, even where the
//! sum or the variance is not.

use std::fmt;

use pulp::NullaryFnOnce;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result, require};
use crate::fast::widest;
use crate::float::two_sum;
use crate::numbers::plus_minus;
use crate::quantile::student_t;

/// Draws summed at a time: they stay in the first-level cache between the two passes.
pub(crate) const SLICE: usize = 1024;

/// Sums are scaled by one of two exponents, 0 and 600, and squares by one of three, −600, 0 and 600, so that
/// none over- or underflows.
const STEP: i32 = 600;
const UP: f64 = f64::from_bits((1023 + STEP as u64) << 52);
const DOWN: f64 = f64::from_bits((1023 - STEP as u64) << 52);

/// Whether a square can be summed without scaling: DOWN ≤ square < UP, in one comparison of bits, which have
/// the same order as positive numbers.
#[inline(always)]
fn is_plain(square: f64) -> bool {
    square.to_bits().wrapping_sub(DOWN.to_bits()) < UP.to_bits() - DOWN.to_bits()
}

/// 2⁹⁰⁰: the sum of up to 2⁶⁴ draws below it does not overflow.
const HUGE: f64 = f64::from_bits((1023 + 900) << 52);

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

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Moments {
    draws: u64,
    /// Σ Xᵢ / 2^sum_exponent
    sum: Twofold,
    sum_exponent: i32,
    /// Σ (Xᵢ − X̄)² / 4^exponent
    squares: Twofold,
    exponent: i32,
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
    pub fn extend_from_slice(&mut self, draws: &[f64]) {
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

impl Moments {
    const NONE: Self =
        Self { draws: 0, sum: Twofold::ZERO, sum_exponent: 0, squares: Twofold::ZERO, exponent: -STEP };

    /// The estimate with a pivot for further pushes, if its sums need no scaling.
    fn about_mean(self) -> Estimate {
        let n = self.draws as f64;
        let mean = self.sum.over(n);
        let plain = self.sum_exponent == 0 && (self.exponent == 0 || self.squares == Twofold::ZERO);
        // `merged` saturates the count; pushing does not
        if !plain || mean.hi.abs() >= UP || self.draws >= 1 << 63 {
            return self.into();
        }
        let off = Twofold { hi: mean.lo, lo: 0.0 }.squared().by(n);
        let moments = Self { squares: self.squares.join(off), exponent: 0, ..self };
        Estimate { moments, pivot: Some(mean.hi) }
    }

    /// The moments of these draws and `other`'s together.
    fn merged(&self, other: &Self) -> Self {
        if self.draws == 0 || other.draws == 0 {
            return if self.draws == 0 { *other } else { *self };
        }
        let (n_a, n_b) = (self.draws as f64, other.draws as f64);
        let sum_exponent = self.sum_exponent.max(other.sum_exponent);
        let [a, b] = [*self, *other]
            .map(|side| if side.sum_exponent == sum_exponent { side.sum } else { side.sum.times(DOWN) });
        let delta = b.over(n_b).join(a.over(n_a).times(-1.0));
        let (step, scaled) = match exponent_of(delta.hi) {
            step if sum_exponent == 0 => {
                (step, Twofold { hi: scale(delta.hi, step), lo: scale(delta.lo, step) })
            }
            _ => (STEP, delta),
        };
        let exponent = self.exponent.max(other.exponent).max(step);
        let moved = scaled.squared().by(n_a).by(n_b).over(n_a + n_b);
        let squares = lower(self.squares, self.exponent, exponent)
            .join(lower(other.squares, other.exponent, exponent))
            .join(lower(moved, step, exponent));
        let (draws, sum) = (self.draws.checked_add(other.draws), a.join(b));
        // where the count saturates, scale the sums to match
        let share = if draws.is_some() { 1.0 } else { u64::MAX as f64 / (n_a + n_b) };
        let [sum, squares] = if share == 1.0 { [sum, squares] } else { [sum.by(share), squares.by(share)] };
        Self { draws: draws.unwrap_or(u64::MAX), sum, sum_exponent, squares, exponent }
    }

    /// The moments of equal draws.
    fn of_equal(draw: f64, draws: u64) -> Self {
        let sum_exponent = if draw.abs() < HUGE { 0 } else { STEP };
        let sum = Twofold { hi: scale(draw, sum_exponent), lo: 0.0 }.by(draws as f64);
        Self { draws, sum, sum_exponent, ..Self::NONE }
    }

    /// The moments of up to [`SLICE`] draws, in two passes; the second needs the mean only approximately.
    fn of_slice(draws: &[f64]) -> Self {
        let count = draws.len() as u64;
        if draws.iter().all(|draw| *draw == draws[0]) {
            return Self::of_equal(draws[0], count);
        }
        let [sum, squares] = widest(TwoPasses { draws });
        // between 2⁻⁹⁰⁰ and 2⁹⁰⁰ no square can have underflowed or overflowed
        if (1.0 / HUGE..=HUGE).contains(&squares.hi) {
            Self { draws: count, sum, sum_exponent: 0, squares, exponent: 0 }
        } else {
            Self::of_extreme_slice(draws)
        }
    }

    /// Tiny, huge or non-finite draws: merged one at a time, which works for every exponent.
    #[cold]
    fn of_extreme_slice(draws: &[f64]) -> Self {
        draws.iter().fold(Self::NONE, |moments, &draw| moments.merged(&Self::of_equal(draw, 1)))
    }
}

impl Extend<f64> for Estimate {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, draws: I) {
        let mut slice = Vec::with_capacity(SLICE);
        for draw in draws {
            slice.push(draw);
            if slice.len() == SLICE {
                self.extend_from_slice(&slice);
                slice.clear();
            }
        }
        self.extend_from_slice(&slice);
    }
}

impl FromIterator<f64> for Estimate {
    fn from_iter<I: IntoIterator<Item = f64>>(draws: I) -> Self {
        let mut estimate = Self::new();
        estimate.extend(draws);
        estimate
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

/// The sum of the draws, and the sum of squares about their mean.
struct TwoPasses<'a> {
    draws: &'a [f64],
}

impl NullaryFnOnce for TwoPasses<'_> {
    type Output = [Twofold; 2];

    #[inline(always)]
    fn call(self) -> [Twofold; 2] {
        let n = self.draws.len() as f64;
        let sum = total(self.draws, |x| x, two_sum);
        let mean = sum.over(n);
        let square = |x: f64| (x - mean.hi) * (x - mean.hi);
        let squares = total(self.draws, square, fast_two_sum).plus(-n * mean.lo * mean.lo);
        [sum, squares]
    }
}

/// Independent partial sums: twice as many as the widest vectors hold.
const LANES: usize = 16;

/// The sum of `f` over the draws, in interleaved lanes, each with its accumulated rounding error from
/// `two_sum`.
#[inline(always)]
fn total(draws: &[f64], f: impl Fn(f64) -> f64, two_sum: impl Fn(f64, f64) -> (f64, f64)) -> Twofold {
    let (mut sums, mut lost) = ([0.0; LANES], [0.0; LANES]);
    let (rows, rest) = draws.as_chunks::<LANES>();
    for row in rows {
        for lane in 0..LANES {
            let (sum, error) = two_sum(sums[lane], f(row[lane]));
            sums[lane] = sum;
            lost[lane] += error;
        }
    }
    for (lane, &draw) in rest.iter().enumerate() {
        let (sum, error) = two_sum(sums[lane % LANES], f(draw));
        sums[lane % LANES] = sum;
        lost[lane % LANES] += error;
    }
    in_pairs(sums, lost)
}

/// The sum of all lanes, in pairs and pairs of pairs. Not inlined: otherwise the compiler reorders the lanes
/// of the loop before it.
#[inline(never)]
fn in_pairs(mut sums: [f64; LANES], mut lost: [f64; LANES]) -> Twofold {
    for half in [8, 4, 2, 1] {
        for lane in 0..half {
            let (sum, error) = two_sum(sums[lane], sums[lane + half]);
            sums[lane] = sum;
            lost[lane] += lost[lane + half] + error;
        }
    }
    Twofold::normal(sums[0], lost[0])
}

/// [`two_sum`] in half the time if |a| ≥ |b|, and no worse than a plain sum otherwise (Dekker).
#[inline(always)]
fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// The exponent by which `delta`² is scaled.
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

/// x / 2^exponent
fn scale(x: f64, exponent: i32) -> f64 {
    unscale(x, -exponent)
}

/// Rescales squares from exponent `from` to `to` ≥ `from`; what underflows is smaller than the rounding
/// error.
fn lower(squares: Twofold, from: i32, to: i32) -> Twofold {
    (from..to).step_by(STEP as usize).fold(squares, |kept, _| kept.times(DOWN).times(DOWN))
}

/// A double-double: the unevaluated sum `hi + lo` with |lo| ≤ ½ ulp(hi) (Dekker 1971).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Twofold {
    #[serde(with = "any_number")]
    hi: f64,
    #[serde(with = "any_number")]
    lo: f64,
}

/// JSON has no infinity or NaN: they are written as the strings `inf`, `-inf` and `NaN`.
mod any_number {
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

    pub fn serialize<S: Serializer>(number: &f64, to: S) -> Result<S::Ok, S::Error> {
        if number.is_finite() || !to.is_human_readable() {
            number.serialize(to)
        } else {
            to.collect_str(number)
        }
    }

    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Number {
        Finite(f64),
        Text(String),
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        if !from.is_human_readable() {
            return f64::deserialize(from);
        }
        match Number::deserialize(from)? {
            Number::Finite(number) => Ok(number),
            Number::Text(text) => text.parse().map_err(D::Error::custom),
        }
    }
}

impl Twofold {
    const ZERO: Self = Self { hi: 0.0, lo: 0.0 };

    fn normal(hi: f64, lo: f64) -> Self {
        let (hi, lo) = two_sum(hi, lo);
        Self { hi, lo: if hi.is_finite() { lo } else { 0.0 } }
    }

    fn plus(self, x: f64) -> Self {
        let (sum, lost) = two_sum(self.hi, x);
        if sum.is_finite() { Self::normal(sum, self.lo + lost) } else { Self { hi: sum, lo: 0.0 } }
    }

    /// The same without renormalizing, for which the next addition would have to wait.
    #[inline(always)]
    fn loosely_plus(self, x: f64, two_sum: impl Fn(f64, f64) -> (f64, f64)) -> Self {
        let (hi, lost) = two_sum(self.hi, x);
        Self { hi, lo: self.lo + lost }
    }

    fn join(self, other: Self) -> Self {
        self.plus(other.lo).plus(other.hi)
    }

    /// Exact for powers of two.
    fn times(self, power: f64) -> Self {
        Self { hi: self.hi * power, lo: self.lo * power }
    }

    fn by(self, n: f64) -> Self {
        let hi = self.hi * n;
        Self::normal(hi, self.hi.mul_add(n, -hi) + self.lo * n)
    }

    fn over(self, n: f64) -> Self {
        let hi = self.hi / n;
        Self::normal(hi, ((-hi).mul_add(n, self.hi) + self.lo) / n)
    }

    fn squared(self) -> Self {
        let hi = self.hi * self.hi;
        Self::normal(hi, self.hi.mul_add(self.hi, -hi) + 2.0 * self.hi * self.lo)
    }
}
