//! Double-double numbers (106 bits) with a wide exponent range: closed forms are computed in them and rounded
//! once, at the end.
//!
//! In `f64` a formula of ten operations has up to ten rounding errors of half a unit in the last place, and
//! an intermediate square that over- or underflows makes the result useless. (Dekker 1971; Hida, Li & Bailey
//! 2001.)

use std::ops::{Add, Div, Mul, Neg, Sub};

/// (hi + lo)·2^exponent, where 1 ≤ |hi| < 2 and |lo| ≤ ½ ulp(hi); or hi alone where it is 0, infinite or NaN.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extended {
    hi: f64,
    lo: f64,
    exponent: i64,
}

/// 2^n for −1022 ≤ n ≤ 1023.
const fn power_of_two(n: i64) -> f64 {
    f64::from_bits(((1023 + n) as u64) << 52)
}

/// a + b rounded, and the exact rounding error (Knuth).
#[inline(always)]
pub(crate) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let added = sum - a;
    (sum, (a - (sum - added)) + (b - added))
}

impl From<f64> for Extended {
    fn from(x: f64) -> Self {
        const FAR: i64 = 200;
        match x.abs() {
            size if size < power_of_two(-900) => Self::normal(x * power_of_two(FAR), 0.0, -FAR),
            size if size > power_of_two(900) => Self::normal(x * power_of_two(-FAR), 0.0, FAR),
            _ => Self::normal(x, 0.0, 0),
        }
    }
}

impl Extended {
    pub(crate) const ONE: Self = Self { hi: 1.0, lo: 0.0, exponent: 0 };

    /// (hi + lo)·2^exponent, for a hi that is far inside `f64`'s range.
    fn normal(hi: f64, lo: f64, exponent: i64) -> Self {
        let (hi, lo) = two_sum(hi, lo);
        if hi == 0.0 || !hi.is_finite() {
            return Self { hi, lo: 0.0, exponent: 0 };
        }
        let own = (hi.to_bits() >> 52 & 0x7ff) as i64 - 1023;
        let scale = power_of_two(-own);
        Self { hi: hi * scale, lo: lo * scale, exponent: exponent.saturating_add(own) }
    }

    /// The nearest `f64`: subnormal, 0 or infinite where that is nearest.
    pub(crate) fn round(self) -> f64 {
        // in two steps, of which only the second can round
        let exponent = self.exponent.clamp(-1200, 1200);
        let half = exponent / 2;
        self.hi * power_of_two(half) * power_of_two(exponent - half)
    }

    pub(crate) fn is_zero(self) -> bool {
        self.hi == 0.0
    }

    pub(crate) fn is_positive(self) -> bool {
        self.hi > 0.0
    }

    pub(crate) fn squared(self) -> Self {
        self * self
    }

    pub(crate) fn sqrt(self) -> Self {
        if self.hi <= 0.0 || !self.hi.is_finite() {
            return Self { hi: self.hi.sqrt(), lo: 0.0, exponent: 0 };
        }
        let odd = self.exponent.rem_euclid(2);
        let (hi, lo) = (self.hi * power_of_two(odd), self.lo * power_of_two(odd));
        // one Newton step from the root in f64
        let root = hi.sqrt();
        let rest = root.mul_add(-root, hi) + lo;
        Self::normal(root, rest / (2.0 * root), (self.exponent - odd) / 2)
    }

    /// xⁿ and 1 + x + … + xⁿ⁻¹, by doubling n: for x ≥ 0 all terms are positive, so there is no cancellation.
    pub(crate) fn powers(self, n: u64) -> (Self, Self) {
        let (mut power, mut sum) = (Self::ONE, Self::from(0.0));
        for bit in (0..u64::BITS - n.leading_zeros()).rev() {
            sum = sum * (Self::ONE + power);
            power = power.squared();
            if n >> bit & 1 == 1 {
                sum = Self::ONE + self * sum;
                power = power * self;
            }
        }
        (power, sum)
    }
}

impl Neg for Extended {
    type Output = Self;

    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo, ..self }
    }
}

impl Add for Extended {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        if !(self.hi.is_finite() && other.hi.is_finite()) {
            return Self { hi: self.hi + other.hi, lo: 0.0, exponent: 0 };
        }
        if self.hi == 0.0 || other.hi == 0.0 {
            return if self.hi == 0.0 { other } else { self };
        }
        let (a, b) = if self.exponent >= other.exponent { (self, other) } else { (other, self) };
        let shift = a.exponent.saturating_sub(b.exponent);
        if shift > 250 {
            return a;
        }
        let scale = power_of_two(-shift);
        let (hi, lost) = two_sum(a.hi, b.hi * scale);
        let (lo, lost_too) = two_sum(a.lo, b.lo * scale);
        let (hi, lost) = two_sum(hi, lost + lo);
        Self::normal(hi, lost + lost_too, a.exponent)
    }
}

impl Sub for Extended {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Extended {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let hi = self.hi * other.hi;
        let lo = self.hi.mul_add(other.hi, -hi) + (self.hi * other.lo + self.lo * other.hi);
        Self::normal(hi, if hi.is_finite() { lo } else { 0.0 }, self.exponent.saturating_add(other.exponent))
    }
}

impl Div for Extended {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let first = self.hi / other.hi;
        if first == 0.0 || !first.is_finite() || !other.hi.is_finite() {
            return Self { hi: first, lo: 0.0, exponent: 0 };
        }
        let exponent = self.exponent.saturating_sub(other.exponent);
        let first = Self::normal(first, 0.0, exponent);
        let rest = self - first * other;
        first + Self::normal(rest.hi / other.hi, 0.0, rest.exponent.saturating_sub(other.exponent))
    }
}

/// The error allowed in a cdf: sums of weights end an ulp or two from 1, and library cdfs are accurate to
/// 1e-14 only.
pub const ROUNDING: f64 = 1.0 / (1u64 << 40) as f64;

/// Whether a value is in [0, 1] up to rounding. NaN is not.
pub fn is_probability(computed: f64) -> bool {
    (-ROUNDING..=1.0 + ROUNDING).contains(&computed)
}

#[cfg(test)]
mod tests {
    use super::Extended;

    /// The results are exact in f64, so every digit is checked; the tests of the closed forms check the
    /// digits beyond f64.
    #[test]
    fn operations_keep_what_f64_loses() {
        let w = Extended::from;
        let tiny = f64::from_bits(1);
        // 1 + 2⁻¹⁰⁰ − 1, (1 + ε)² − 1 − 2ε, 1/3·3, √2²
        assert_eq!((w(1.0) + w(2f64.powi(-100)) - w(1.0)).round(), 2f64.powi(-100));
        let e = f64::EPSILON;
        assert_eq!((w(1.0 + e).squared() - w(1.0) - w(2.0 * e)).round(), e * e);
        // what the low halves lose
        let [low, lower] = [-60, -120].map(|power| w(2f64.powi(power)));
        assert_eq!(((w(1.0) + low) + (w(-1.0) + lower) - low).round(), 2f64.powi(-120));
        assert!((w(1.0) / w(3.0) * w(3.0) - w(1.0)).round().abs() <= 2f64.powi(-104));
        for x in [2.0, 3.0, 1e-301, 7e300, tiny] {
            assert!(((w(x).sqrt().squared() - w(x)) / w(x)).round().abs() <= 2f64.powi(-102), "{x}");
        }
        // numbers with more digits than f64 has, with an even and an odd exponent
        for x in [w(1.0) / w(3.0), w(2.0) / w(3.0)] {
            assert!(((x.sqrt().squared() - x) / x).round().abs() <= 2f64.powi(-102));
        }
        // intermediate results beyond f64's range, at both ends
        for x in [f64::MAX, -f64::MAX, f64::MIN_POSITIVE, tiny, -3.0 * tiny, 0.1] {
            assert_eq!(w(x).round().to_bits(), x.to_bits());
            assert_eq!((w(x) * w(f64::MAX) * w(f64::MAX) / w(f64::MAX) / w(f64::MAX)).round(), x);
            assert_eq!((w(x) * w(tiny) * w(tiny) / w(tiny) / w(tiny)).round(), x);
            assert_eq!((w(x) + w(-x)).round(), 0.0);
        }
        assert_eq!((w(f64::MAX) + w(f64::MAX)).round(), f64::INFINITY);
        assert_eq!((w(tiny) * w(0.5)).round(), 0.0);
        assert_eq!((w(1.0) / w(0.0)).round(), f64::INFINITY);
        assert_eq!((w(1.0) / w(f64::INFINITY)).round(), 0.0);
        assert_eq!((w(f64::INFINITY) + w(1.0)).round(), f64::INFINITY);
        assert_eq!((w(f64::INFINITY) * w(2.0)).round(), f64::INFINITY);
        assert!((w(0.0) / w(0.0)).round().is_nan() && w(f64::NAN).round().is_nan());
    }

    #[test]
    fn powers_are_powers_and_their_sum() {
        for (x, n, power, sum) in [
            (0.5, 0, 1.0, 0.0),
            (0.5, 1, 0.5, 1.0),
            (0.5, 5, 0.03125, 1.9375),
            (3.0, 7, 2187.0, 1093.0),
            (1.0, 1_000_000_007, 1.0, 1_000_000_007.0),
            (0.0, 3, 0.0, 1.0),
        ] {
            let (a, b) = Extended::from(x).powers(n);
            assert_eq!((a.round(), b.round()), (power, sum), "{x}^{n}");
        }
    }
}
