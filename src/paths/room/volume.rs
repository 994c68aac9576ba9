//! On which side of a polygon's plane a point lies, exactly, whatever their sizes.

use std::collections::BTreeMap;

use glam::DVec3;

/// The sign of six times the volume between a point and a polygon, exactly: −1, 0 or 1.
pub(super) fn volume_sign(corners: &[DVec3], point: DVec3) -> f64 {
    let [first, rest @ ..] = corners else { return 0.0 };
    let mut sum = ExactSum::default();
    for (b, c) in rest.iter().zip(rest.iter().skip(1)) {
        // from the determinant of the coordinates themselves, as differences would be rounded
        for (sign, [a, b, c]) in
            [(1, [first, b, c]), (-1, [&point, b, c]), (-1, [first, &point, c]), (-1, [first, b, &point])]
        {
            for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
                sum.add(sign, [a[i], b[j], c[k]]);
                sum.add(-sign, [a[i], b[k], c[j]]);
            }
        }
    }
    sum.sign()
}

/// A sum of products of three numbers, exact: its digits in base 2³² by exponent, with carries still to be
/// propagated.
#[derive(Default)]
struct ExactSum(BTreeMap<i64, i128>);

impl ExactSum {
    fn add(&mut self, sign: i128, factors: [f64; 3]) {
        let [(a, i), (b, j), (c, k)] = factors.map(integer_and_exponent);
        let (pair, exponent) = (a.unsigned_abs() * b.unsigned_abs(), i + j + k);
        let third = (sign * a.signum() * b.signum() * c) << exponent.rem_euclid(32);
        for digit in 0..4 {
            // 32 bits of 106, times 53 bits, shifted by up to 31: 116 bits, of which 84 go on to the next
            // digit
            let part = (pair >> (32 * digit) & 0xffff_ffff) as i128 * third;
            let place = exponent.div_euclid(32) + digit;
            *self.0.entry(place).or_default() += part & 0xffff_ffff;
            *self.0.entry(place + 1).or_default() += part >> 32;
        }
    }

    fn sign(&self) -> f64 {
        let (mut place, mut carried, mut rest) = (0, 0i128, false);
        for (own, digit) in &self.0 {
            let shift = (32 * (own - place)).min(126);
            rest |= carried & ((1 << shift) - 1) != 0;
            (place, carried) = (*own, (carried >> shift) + digit);
        }
        if carried == 0 { f64::from(u8::from(rest)) } else { carried.signum() as f64 }
    }
}

/// x as an integer of at most 53 bits times a power of two.
fn integer_and_exponent(x: f64) -> (i128, i64) {
    let (bits, biased) = (x.to_bits() as i128 & ((1 << 52) - 1), (x.to_bits() >> 52 & 0x7ff) as i64);
    let integer = if biased == 0 { bits } else { bits | 1 << 52 };
    (if x < 0.0 { -integer } else { integer }, biased.max(1))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;
    use proptest::test_runner::{Config, RngSeed};

    use super::volume_sign;

    fn whole(x: i64) -> impl Strategy<Value = [i64; 3]> {
        prop::array::uniform3(prop_oneof![-x..=x, -3i64..=3])
    }

    proptest! {
        #![proptest_config(Config { rng_seed: RngSeed::Fixed(1), failure_persistence: None,
            ..Config::with_cases(2_000) })]

        /// Agrees with integer arithmetic, in any unit, and for a pyramid, whose two tetrahedra may cancel.
        #[test]
        fn the_sign_of_a_volume_is_exact(
            corners in prop::array::uniform4(whole(1 << 40)), point in whole(1 << 40), power in -1074..900,
                one in 0..4usize,
        ) {
            let determinant = |a: [i64; 3], b: [i64; 3], c: [i64; 3]| {
                let [a, b, c] = [a, b, c].map(|v| [0, 1, 2].map(|i| i128::from(v[i] - point[i])));
                let minor = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
                a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1)
            };
            let [a, b, c, d] = corners;
            let volume = determinant(a, b, c) / 2 + determinant(a, c, d) / 2;
            let at = |v: [i64; 3]| DVec3::from_array(v.map(|x|
                x as f64 * 2f64.powi(power / 2) * 2f64.powi(power - power / 2)));
            if volume.abs() > 1 {
                prop_assert_eq!(volume_sign(&corners.map(at), at(point)), volume.signum() as f64);
            }
            let triangle = determinant(a, b, c);
            prop_assert_eq!(volume_sign(&[a, b, c].map(at), at(point)), triangle.signum() as f64);
            // a corner is in the plane
            prop_assert_eq!(volume_sign(&[a, b, c].map(at), at([a, b, c, a][one])), 0.0);
        }
    }

    /// 1 combined with 1e300 and 1e-300, and a difference in the last place of the longest product.
    #[test]
    fn no_digit_is_lost() {
        let flat = |z: f64, far: f64| [[far, far, z], [-far, far, z], [-far, -far, z]].map(DVec3::from_array);
        for far in [1e-300, 1.0, 1e300] {
            for height in [5e-324, 1e-300, 1.0, 1e300] {
                for (z, sign) in [(height, 1.0), (-height, -1.0), (0.0, 0.0)] {
                    assert_eq!(volume_sign(&flat(z, far), DVec3::ZERO), sign, "{far} {z}");
                    assert_eq!(volume_sign(&flat(z, far), DVec3::new(0.3, -0.7, z)), 0.0);
                }
            }
        }
        let e = f64::EPSILON;
        let nearly = [[1.0 + e, 1.0, 0.0], [1.0, 1.0 - e, 0.0], [0.0, 0.0, 1.0]].map(DVec3::from_array);
        // (1 + ε)(1 − ε) − 1 = −ε²
        assert_eq!(volume_sign(&nearly, DVec3::ZERO), -1.0);
        assert_eq!(volume_sign(&[], DVec3::ZERO), 0.0);
    }
}
