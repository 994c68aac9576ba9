//! Double-doubles: numbers of 106 bits, for sums.

use serde::{Deserialize, Serialize};

use crate::float::two_sum;

/// [`two_sum`] in half the time if |a| ≥ |b|, and no worse than a plain sum otherwise (Dekker).
#[inline(always)]
pub fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// A double-double: the unevaluated sum `hi + lo` with |lo| ≤ ½ ulp(hi) (Dekker 1971).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Twofold {
    #[serde(with = "any_number")]
    pub hi: f64,
    #[serde(with = "any_number")]
    pub lo: f64,
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
    pub const ZERO: Self = Self { hi: 0.0, lo: 0.0 };

    pub fn normal(hi: f64, lo: f64) -> Self {
        let (hi, lo) = two_sum(hi, lo);
        Self { hi, lo: if hi.is_finite() { lo } else { 0.0 } }
    }

    pub fn plus(self, x: f64) -> Self {
        let (sum, lost) = two_sum(self.hi, x);
        if sum.is_finite() { Self::normal(sum, self.lo + lost) } else { Self { hi: sum, lo: 0.0 } }
    }

    /// The same without renormalizing, for which the next addition would have to wait.
    #[inline(always)]
    pub fn loosely_plus(self, x: f64, two_sum: impl Fn(f64, f64) -> (f64, f64)) -> Self {
        let (hi, lost) = two_sum(self.hi, x);
        Self { hi, lo: self.lo + lost }
    }

    pub fn join(self, other: Self) -> Self {
        self.plus(other.lo).plus(other.hi)
    }

    /// Exact for powers of two.
    pub fn times(self, power: f64) -> Self {
        Self { hi: self.hi * power, lo: self.lo * power }
    }

    pub fn by(self, n: f64) -> Self {
        let hi = self.hi * n;
        Self::normal(hi, self.hi.mul_add(n, -hi) + self.lo * n)
    }

    pub fn over(self, n: f64) -> Self {
        let hi = self.hi / n;
        Self::normal(hi, ((-hi).mul_add(n, self.hi) + self.lo) / n)
    }

    pub fn squared(self) -> Self {
        let hi = self.hi * self.hi;
        Self::normal(hi, self.hi.mul_add(self.hi, -hi) + 2.0 * self.hi * self.lo)
    }
}
