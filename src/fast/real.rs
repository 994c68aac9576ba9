//! The operations of `f64` and `f32` that generic loops need.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::sin_cos_of_turns;

/// `f64` or `f32`.
pub(crate) trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Uniform numbers are multiples of this: 2⁻⁵³ or 2⁻²⁴.
    const STEP: Self;

    /// The smallest component of a direction: the reciprocal of the product of three does not overflow.
    const FLAT: Self;

    /// The nearest number.
    fn of(x: f64) -> Self;

    fn to_f64(self) -> f64;

    fn sqrt(self) -> Self;

    fn abs(self) -> Self;

    fn ceil(self) -> Self;

    fn sin_cos_of_turns(self) -> (Self, Self);

    /// The uniform number made from a random word, and a word for a uniform number.
    fn of_word(word: u64) -> Self;
    fn word(self) -> u64;

    #[inline(always)]
    fn least(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn most(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
}

impl Real for f64 {
    const STEP: Self = 1.0 / (1u64 << 53) as Self;
    const FLAT: Self = 1e-100;

    #[inline(always)]
    fn of(x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }

    #[inline(always)]
    fn ceil(self) -> Self {
        f64::ceil(self)
    }

    #[inline(always)]
    fn sin_cos_of_turns(self) -> (Self, Self) {
        sin_cos_of_turns(self)
    }

    #[inline(always)]
    fn of_word(word: u64) -> Self {
        (word >> 11) as Self * Self::STEP
    }

    #[inline(always)]
    fn word(self) -> u64 {
        ((self / Self::STEP) as u64) << 11
    }
}

impl Real for f32 {
    const STEP: Self = 1.0 / (1u32 << 24) as Self;
    const FLAT: Self = 1e-12;

    #[inline(always)]
    fn of(x: f64) -> Self {
        x as Self
    }

    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        f32::abs(self)
    }

    #[inline(always)]
    fn ceil(self) -> Self {
        f32::ceil(self)
    }

    /// The series of [`sin_cos_of_turns`](super::sin_cos_of_turns) with four terms each: the first omitted
    /// one is below 2⁻²⁴.
    #[inline(always)]
    fn sin_cos_of_turns(self) -> (Self, Self) {
        const MAGIC: f32 = 12_582_912.0; // 1.5·2²³
        let rounded = 4.0 * self + MAGIC;
        let quarters = rounded.to_bits();
        let t = std::f32::consts::TAU * (self - 0.25 * (rounded - MAGIC));
        let t2 = t * t;
        let sin =
            t + t * t2 * (-1.0 / 6.0 + t2 * (1.0 / 120.0 + t2 * (-1.0 / 5_040.0 + t2 * (1.0 / 362_880.0))));
        let cos = 1.0 + t2 * (-0.5 + t2 * (1.0 / 24.0 + t2 * (-1.0 / 720.0 + t2 * (1.0 / 40_320.0))));
        let (sin, cos) = if quarters & 1 == 0 { (sin, cos) } else { (cos, sin) };
        let sign = |negative: u32, x: f32| f32::from_bits(x.to_bits() ^ ((negative & 2) << 30));
        (sign(quarters, sin), sign(quarters.wrapping_add(1), cos))
    }

    #[inline(always)]
    fn of_word(word: u64) -> Self {
        (word >> 40) as i32 as Self * Self::STEP
    }

    #[inline(always)]
    fn word(self) -> u64 {
        ((self / Self::STEP) as u64) << 40
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    use crate::stream::Stream;

    /// Compares with f64 at every 256th uniform number, and at all near multiples of an eighth of a turn,
    /// where sine and cosine are swapped. With |t| ≤ π/4: t is rounded three times and 2π once, 2⁻²² of t or
    /// less in all; the first omitted terms are 2.4e-8 or less; a result has three more roundings of at most
    /// 2⁻²⁵ each: below 3.5e-7.
    #[test]
    fn single_sines_of_turns_are_the_double_ones() {
        let near_eighths =
            (0..=8u32).flat_map(|eighth| (0..64).map(move |k| (eighth << 21).saturating_sub(32) + k));
        let mut worst: f64 = 0.0;
        for k in (0..1 << 24).step_by(256).chain(near_eighths) {
            let u = k as f32 * f32::STEP;
            let (sin, cos) = u.sin_cos_of_turns();
            let exact = (std::f64::consts::TAU * f64::from(u)).sin_cos();
            worst = worst.max((f64::from(sin) - exact.0).abs()).max((f64::from(cos) - exact.1).abs());
        }
        assert!(worst <= 3.5e-7, "{worst:e}");
    }

    #[test]
    fn uniform_numbers_lie_on_their_grid() {
        fn on_the_grid<T: Real>() {
            let mut rng = Stream::new(1, 0);
            let uniforms: [T; 1000] = std::array::from_fn(|_| T::of_word(rng.next_u64()));
            let odd = uniforms.iter().filter(|u| {
                let steps = (**u / T::STEP).to_f64();
                assert!(**u >= T::of(0.0) && **u < T::of(1.0) && steps == steps.floor());
                steps % 2.0 == 1.0
            });
            // half of them use the last bit: 500 ± 16 of 1000; 8 std deviations are 128
            assert!((372..=628).contains(&odd.count()));
        }
        on_the_grid::<f64>();
        on_the_grid::<f32>();
        assert_eq!((f64::STEP, f32::STEP), (2_f64.powi(-53), 2_f32.powi(-24)));
    }
}
