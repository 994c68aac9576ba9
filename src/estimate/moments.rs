//! Sums of draws and of their squares, which are merged without losing a digit.
//!
//! Moments are accurate to the last digits of `f64`: Σ Xᵢ and Σ (Xᵢ − X̄)² are each a double-double, an
//! unevaluated sum of two `f64`. Each slice of draws is summed in two passes, the squares about the slice's
//! own mean, and slices are merged (Chan, Golub & LeVeque 1983): that adds positive terms only, so there is
//! no cancellation, however large the mean is compared with the standard deviation. Sums and squares have
//! separate exponents: the mean and the std error are right whenever *they* are representable, even where the
//! sum or the variance is not.

use pulp::NullaryFnOnce;
use serde::{Deserialize, Serialize};

use super::Estimate;
use super::twofold::{Twofold, fast_two_sum};
use crate::fast::widest;
use crate::float::two_sum;

/// Draws summed at a time: they stay in the first-level cache between the two passes.
pub const SLICE: usize = 1024;

/// Sums are scaled by one of two exponents, 0 and 600, and squares by one of three, −600, 0 and 600, so that
/// none over- or underflows.
pub const STEP: i32 = 600;
const UP: f64 = f64::from_bits((1023 + STEP as u64) << 52);
const DOWN: f64 = f64::from_bits((1023 - STEP as u64) << 52);

/// Whether a square can be summed without scaling: DOWN ≤ square < UP, in one comparison of bits, which have
/// the same order as positive numbers.
#[inline(always)]
pub fn is_plain(square: f64) -> bool {
    square.to_bits().wrapping_sub(DOWN.to_bits()) < UP.to_bits() - DOWN.to_bits()
}

/// 2⁹⁰⁰: the sum of up to 2⁶⁴ draws below it does not overflow.
const HUGE: f64 = f64::from_bits((1023 + 900) << 52);

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Moments {
    pub draws: u64,
    /// Σ Xᵢ / 2^sum_exponent
    pub sum: Twofold,
    pub sum_exponent: i32,
    /// Σ (Xᵢ − X̄)² / 4^exponent
    pub squares: Twofold,
    pub exponent: i32,
}

impl Moments {
    pub const NONE: Self =
        Self { draws: 0, sum: Twofold::ZERO, sum_exponent: 0, squares: Twofold::ZERO, exponent: -STEP };

    /// The estimate with a pivot for further pushes, if its sums need no scaling.
    pub fn about_mean(self) -> Estimate {
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
    pub fn merged(&self, other: &Self) -> Self {
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
    pub fn of_equal(draw: f64, draws: u64) -> Self {
        let sum_exponent = if draw.abs() < HUGE { 0 } else { STEP };
        let sum = Twofold { hi: scale(draw, sum_exponent), lo: 0.0 }.by(draws as f64);
        Self { draws, sum, sum_exponent, ..Self::NONE }
    }

    /// The moments of up to [`SLICE`] draws, in two passes; the second needs the mean only approximately.
    pub fn of_slice(draws: &[f64]) -> Self {
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
pub fn unscale(x: f64, exponent: i32) -> f64 {
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
