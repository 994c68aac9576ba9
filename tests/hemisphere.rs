//! Section 3 and 4: directions have unit length, are distributed as their densities say, and come back to the
//! numbers they were drawn from.
//!
//! Tests of a distribution have α = 1e-12, for every n and every continuous cdf. All else is arithmetic.

mod common;

use std::f64::consts::{FRAC_1_PI, FRAC_1_SQRT_2, PI, TAU};

use approx::assert_relative_eq;
use proptest::prelude::*;
use rand::distr::Distribution;
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::{Density, Stream};

/// ∫ f over [low, high] by Gauss and Legendre's rule with 5 nodes on 64 panels.
fn integral(f: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let (near, far) = (
        (5.0 - 2.0 * (10.0f64 / 7.0).sqrt()).sqrt() / 3.0,
        (5.0 + 2.0 * (10.0f64 / 7.0).sqrt()).sqrt() / 3.0,
    );
    let (heavy, light) = ((322.0 + 13.0 * 70f64.sqrt()) / 900.0, (322.0 - 13.0 * 70f64.sqrt()) / 900.0);
    let rule = [(0.0, 128.0 / 225.0), (near, heavy), (-near, heavy), (far, light), (-far, light)];
    let half = (high - low) / 128.0;
    let panel = |i: usize| {
        let middle = low + half * (2 * i + 1) as f64;
        rule.iter().map(|(x, weight)| weight * f(middle + half * x)).sum::<f64>() * half
    };
    (0..64).map(panel).sum()
}

const DRAWS: usize = 1_000_000;

/// cos θ and φ, alone and together: a cdf off by 0.004 is seen.
#[test]
fn directions_have_their_distributions() {
    for (hemisphere, seed) in Hemisphere::ALL.into_iter().zip(301..) {
        common::alarm(1e-12);
        let deviation = if common::mutation() { 0.02 } else { 0.004 };
        let found =
            common::directions(&hemisphere, hemisphere, deviation, 1e-12, common::seed(seed)).unwrap();
        assert!(found.agrees, "{hemisphere:?}: {found}");
    }
}

#[test]
fn the_other_samplers_are_rejected() {
    // what is off by how much, by pencil: sup |F_wrong − F_claimed|
    type Wrong = fn(f64) -> f64;
    let wrong: [(&str, Wrong, Hemisphere, f64); 6] = [
        ("uniform taken for cosine", |u| 1.0 - u, Hemisphere::Cosine, 0.25),
        ("cosine taken for uniform", |u| (1.0 - u).sqrt(), Hemisphere::Uniform, 0.25),
        ("θ uniform", |u| (0.5 * PI * u).cos(), Hemisphere::Uniform, 0.210_514),
        ("disc without its root", |u| (1.0 - u * u).sqrt(), Hemisphere::Cosine, 0.25),
        ("cos θ = U²", |u| u * u, Hemisphere::Cosine, 0.472_470),
        ("the whole sphere, mirrored up", |u| (1.0 - 2.0 * u).abs(), Hemisphere::Cosine, 0.25),
    ];
    for (name, cos_theta, claimed, predicted) in wrong {
        let mut rng = Stream::new(common::seed(303), 0);
        let cos_thetas = (0..DRAWS).map(|_| cos_theta(rng.uniform())).collect();
        let (off, band) = common::dkw(cos_thetas, |c| claimed.cdf_of_cos_theta(c));
        assert!(off > band, "{name} passed");
        assert!((off - predicted).abs() <= band, "{name}: {off}, not {predicted}");
    }
    // one U for both angles: each alone is right, together they are not
    let mut rng = Stream::new(common::seed(304), 0);
    let us: Vec<f64> = (0..DRAWS).map(|_| rng.uniform()).collect();
    let cos_theta = |u: &f64| (1.0 - u).sqrt();
    let cosine = |c: f64| Hemisphere::Cosine.cdf_of_cos_theta(c);
    let (off, band) = common::dkw(us.iter().map(cos_theta).collect(), cosine);
    assert!(off <= band);
    let first_eighth = us.iter().filter(|u| **u < 0.125).map(cos_theta).collect();
    let (off, band) = common::dkw(first_eighth, cosine);
    assert!((off - 0.875).abs() <= band, "{off}");
}

#[test]
fn densities_integrate_to_one_and_to_the_cdf() {
    for hemisphere in Hemisphere::ALL {
        // ∫₀²π ∫₀^c p dc dφ up to a few c; dω = d(cos θ) dφ
        for c in [0.1, 0.37, 0.83, 1.0] {
            let around =
                |phi: f64| integral(|cos| hemisphere.pdf(&Direction::polar(cos, phi).unwrap()), 0.0, c);
            let reached = integral(around, 0.0, TAU);
            assert_relative_eq!(reached, hemisphere.cdf_of_cos_theta(c), epsilon = 0.0, max_relative = 1e-13);
        }
        let below = Direction::polar(-0.2, 1.0).unwrap();
        assert_eq!(hemisphere.pdf(&below), 0.0);
        assert_eq!([-1.0, 0.0, 1.0, 2.0].map(|c| hemisphere.cdf_of_cos_theta(c)), [0.0, 0.0, 1.0, 1.0]);
    }
    let up = Direction::new(0.0, 0.0, 1.0).unwrap();
    assert_eq!(Hemisphere::Uniform.pdf(&up), 1.0 / TAU);
    assert_eq!(Hemisphere::Cosine.pdf(&up), FRAC_1_PI);
}

/// u, then \[sin θ, cos θ\] of both densities to the last digit (mpmath, 200 bits).
const AT_THE_ENDS: [(f64, [f64; 2], [f64; 2]); 10] = [
    (0.0, [0.0, 1.0], [0.0, 1.0]),
    (5e-324, [3.1434555694052576e-162, 1.0], [2.2227587494850775e-162, 1.0]),
    (1e-300, [1.4142135623730952e-150, 1.0], [1e-150, 1.0]),
    (1.1102230246251565e-16, [1.4901161193847656e-08, 1.0], [1.0536712127723509e-08, 1.0]),
    (
        5.960464477539063e-08,
        [0.0003452669778563649, 0.9999999403953552],
        [0.000244140625, 0.9999999701976772],
    ),
    (0.25, [0.6614378277661477, 0.75], [0.5, 0.8660254037844386]),
    (0.5, [0.8660254037844386, 0.5], [FRAC_1_SQRT_2, FRAC_1_SQRT_2]),
    (0.9999999403953552, [0.9999999999999982, 5.960464477539063e-08], [0.9999999701976772, 0.000244140625]),
    (0.9999999999999999, [1.0, 1.1102230246251565e-16], [0.9999999999999999, 1.0536712127723509e-08]),
    (1.0, [1.0, 0.0], [1.0, 0.0]),
];

#[test]
fn both_ends_keep_their_digits() {
    for (u, uniform, cosine) in AT_THE_ENDS {
        for (hemisphere, [sin, cos]) in [(Hemisphere::Uniform, uniform), (Hemisphere::Cosine, cosine)] {
            for v in [0.0, 0.1, 0.61, 1.0] {
                let direction = hemisphere.direction_of(u, v).unwrap();
                let close = 3.0 * f64::EPSILON; // two roundings of sin φ and cos φ, one of the root
                assert_relative_eq!(direction.sin_theta(), sin, epsilon = 0.0, max_relative = close);
                assert_relative_eq!(direction.cos_theta(), cos, epsilon = 0.0, max_relative = f64::EPSILON);
                assert_relative_eq!(
                    direction.theta(),
                    sin.atan2(cos),
                    epsilon = 0.0,
                    max_relative = 4.0 * f64::EPSILON
                );
            }
        }
    }
}

#[test]
fn no_drawn_direction_lies_on_the_horizon() {
    // the largest number that a stream gives is 1 − 2⁻⁵³
    let last = 1.0 - 0.5 * f64::EPSILON;
    let uniform = Hemisphere::Uniform.direction_of(last, 0.3).unwrap();
    assert_eq!(uniform.cos_theta(), 2f64.powi(-53));
    let cosine = Hemisphere::Cosine.direction_of(last, 0.3).unwrap();
    assert_relative_eq!(cosine.cos_theta(), 2f64.powf(-26.5), epsilon = 0.0, max_relative = f64::EPSILON);
    for (hemisphere, direction) in [(Hemisphere::Uniform, uniform), (Hemisphere::Cosine, cosine)] {
        assert!(hemisphere.pdf(&direction) > 0.0);
    }
}

#[test]
fn the_circle_is_exact_at_quarter_turns() {
    for (v, sin, cos) in [
        (0.0, 0.0, 1.0),
        (1.1102230246251565e-16, 6.975736996017264e-16, 1.0),
        (0.1, 0.5877852522924731, 0.8090169943749475),
        (0.125, FRAC_1_SQRT_2, FRAC_1_SQRT_2),
        (0.25, 1.0, 0.0),
        (0.3333333333333333, 0.8660254037844387, -0.4999999999999999),
        (0.375, FRAC_1_SQRT_2, -FRAC_1_SQRT_2),
        (0.5, 0.0, -1.0),
        (0.61, -0.6374239897486896, -0.7705132427757893),
        (0.75, -1.0, 0.0),
        (0.9, -0.587785252292473, 0.8090169943749475),
        (0.9999999999999999, -6.975736996017264e-16, 1.0),
        (1.0, 0.0, 1.0),
    ] {
        let horizon = Hemisphere::Cosine.direction_of(1.0, v).unwrap().vector();
        assert_relative_eq!(horizon.x, cos, epsilon = 0.0, max_relative = 2.0 * f64::EPSILON);
        assert_relative_eq!(horizon.y, sin, epsilon = 0.0, max_relative = 2.0 * f64::EPSILON);
    }
}

#[test]
fn drawing_is_the_same_as_inverting_two_uniform_numbers() {
    for hemisphere in Hemisphere::ALL {
        let mut rng = Stream::new(common::seed(305), 0);
        let mut same = rng.clone();
        for _ in 0..1000 {
            let drawn = hemisphere.sample(&mut rng);
            let (u, v) = (same.uniform(), same.uniform());
            assert_eq!(drawn, hemisphere.direction_of(u, v).unwrap());
        }
        assert_eq!(rng.random_numbers(), 2000);
    }
}

#[test]
fn a_seed_keeps_its_bits() {
    // sums, products and roots only: the same on every machine
    let mut rng = Stream::new(1, 0);
    let bits = [Hemisphere::Uniform, Hemisphere::Cosine, Hemisphere::Uniform, Hemisphere::Cosine]
        .map(|hemisphere| hemisphere.sample(&mut rng).vector().to_array().map(f64::to_bits));
    assert_eq!(bits, GOLDEN, "{bits:#x?}");
}

const GOLDEN: [[u64; 3]; 4] = [
    [0x3feeecb8a434c644, 0x3fcd90eccdf3b5c8, 0x3fbce051633df6d0],
    [0x3fdb6383843d8f49, 0x3fb3b83000bbacab, 0x3fecd103b303e101],
    [0x3fb9d4f8c11f7ef1, 0xbfeb6fc92be65556, 0x3fe0263f16b29197],
    [0xbfe19d3740cc4727, 0x3fb67ab5ca509fe5, 0x3fea915a193fd7fc],
];

#[test]
fn directions_say_what_they_are() {
    let direction = Direction::new(0.0, -3.0, -4.0).unwrap();
    assert_eq!(direction.vector().to_array(), [0.0, -0.6, -0.8]);
    assert_eq!(glam::DVec3::from(direction), direction.vector());
    assert_eq!(direction.phi(), 1.5 * PI);
    assert_relative_eq!(direction.theta(), PI - 0.75f64.atan(), epsilon = 0.0, max_relative = f64::EPSILON);
    // −0 is no angle of its own, and an angle just below a turn stays below it
    assert_eq!(Direction::new(1.0, -0.0, 0.0).unwrap().phi().to_bits(), 0);
    assert!(Direction::new(1.0, -1e-300, 0.0).unwrap().phi() < TAU);
    // near the normal 1 − cos² θ has half its digits; and squares below the smallest number
    let cos: f64 = 1.0 - 1.1e-8;
    let exact = ((1.0 - cos) * (2.0 - (1.0 - cos))).sqrt();
    let near = Direction::polar(cos, 0.0).unwrap();
    assert_relative_eq!(near.sin_theta(), exact, epsilon = 0.0, max_relative = 2.0 * f64::EPSILON);
    assert_eq!(Direction::new(3e-200, 4e-200, 1.0).unwrap().sin_theta(), 5e-200);
    // any length, from the smallest number to the largest
    for length in [5e-324, 1e-320, 1e-300, 1e-150, 1.0, 1e150, 1e300, f64::MAX] {
        let diagonal = Direction::new(length, -length, length).unwrap().vector();
        for component in diagonal.abs().to_array() {
            assert_relative_eq!(component, 1.0 / 3f64.sqrt(), epsilon = 0.0, max_relative = f64::EPSILON);
        }
    }
}

#[test]
fn bad_directions_are_errors() {
    for (error, message) in [
        (
            Direction::new(0.0, 0.0, 0.0).unwrap_err(),
            "a direction's largest component must be other than 0, not 0",
        ),
        (Direction::new(0.0, f64::NAN, 1.0).unwrap_err(), "a direction's component must be finite, not NaN"),
        (
            Direction::new(0.0, 0.0, f64::INFINITY).unwrap_err(),
            "a direction's component must be finite, not inf",
        ),
        (Direction::polar(1.1, 0.0).unwrap_err(), "cos θ must be in [-1, 1], not 1.1"),
        (Direction::polar(0.5, f64::INFINITY).unwrap_err(), "the angle φ must be finite, not inf"),
        (
            Hemisphere::Uniform.direction_of(1.5, 0.0).unwrap_err(),
            "the uniform number u must be in [0, 1], not 1.5",
        ),
        (
            Hemisphere::Uniform.direction_of(0.5, -1e-300).unwrap_err(),
            "the uniform number v must be in [0, 1], not -1e-300",
        ),
        (
            Hemisphere::Cosine.uniforms_of(&Direction::new(0.0, 0.0, -1.0).unwrap()).unwrap_err(),
            "cos θ must be 0 or more: nothing is drawn below the horizon, not -1",
        ),
    ] {
        assert!(error.to_string().starts_with(message), "{error}");
    }
}

proptest! {
    #![proptest_config(common::config(2048))]

    #[test]
    fn every_direction_has_unit_length(u in 0.0..=1.0f64, v in 0.0..=1.0f64, cos in -1.0..=1.0f64,
        phi in -1e6..1e6f64) {
        for direction in [
            Hemisphere::Uniform.direction_of(u, v).unwrap(),
            Hemisphere::Cosine.direction_of(u, v).unwrap(),
            Direction::polar(cos, phi).unwrap(),
        ] {
            prop_assert!(common::ulps_off_unit(&direction) <= 2.0);
        }
    }

    #[test]
    fn uniform_numbers_come_back(u in 0.0..=1.0f64, v in 0.0..=1.0f64, power in 0..900i32) {
        for hemisphere in Hemisphere::ALL {
            let tiny = u * 2f64.powi(-power);
            for u in [u, tiny, 1.0 - tiny] {
                let [u_back, v_back] = hemisphere.uniforms_of(&hemisphere.direction_of(u,
                    v).unwrap()).unwrap();
                // sin θ is good to 3 ulp, its square to 7; near the horizon u's last digit is cos² θ's
                let close = if u < 0.5 { 8.0 * u } else { 1.0 };
                prop_assert!((u_back - u).abs() <= close * f64::EPSILON, "{u} {u_back}");
                // the normal itself has no φ
                prop_assert!(u == 0.0 || (v_back - v).abs() <= 2.0 * f64::EPSILON, "{v} {v_back}");
                prop_assert!((0.0..=1.0).contains(&u_back) && (0.0..=1.0).contains(&v_back));
            }
        }
    }

    #[test]
    fn angles_come_back(cos in -1.0..=1.0f64, turns in 0.0..1.0f64) {
        let direction = Direction::polar(cos, TAU * turns).unwrap();
        prop_assert_eq!(direction.cos_theta(), cos);
        prop_assert!((direction.theta() - cos.acos()).abs() <= 1e-15 / (1.0 - cos * cos).sqrt().max(1e-8));
        prop_assert!((direction.phi() - TAU * turns).abs() <= 4.0 * f64::EPSILON * PI);
    }

    #[test]
    fn any_bits_make_a_direction_or_an_error(bits in any::<[u64; 3]>()) {
        let [x, y, z] = bits.map(f64::from_bits);
        if let Ok(direction) = Direction::new(x, y, z) {
            prop_assert!(common::ulps_off_unit(&direction) <= 2.0);
            prop_assert_eq!(direction.cos_theta().is_sign_negative(), z.is_sign_negative());
            prop_assert!((0.0..TAU).contains(&direction.phi()) && (0.0..=PI).contains(&direction.theta()));
            for hemisphere in Hemisphere::ALL {
                prop_assert!((0.0..=FRAC_1_PI).contains(&hemisphere.pdf(&direction)));
                prop_assert_eq!(hemisphere.uniforms_of(&direction).is_ok(), direction.cos_theta() >= 0.0);
            }
        } else {
            prop_assert!(!(x.is_finite() && y.is_finite() && z.is_finite()) || (x == 0.0 && y == 0.0
                && z == 0.0));
        }
        if let Ok(direction) = Direction::polar(x, y) {
            prop_assert!(common::ulps_off_unit(&direction) <= 2.0);
        }
        for hemisphere in Hemisphere::ALL {
            prop_assert_eq!(
                hemisphere.direction_of(x, y).is_ok(),
                (0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y)
            );
            prop_assert_eq!(hemisphere.cdf_of_cos_theta(x).is_nan(), x.is_nan());
        }
    }
}
