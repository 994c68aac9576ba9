//! Section 3: a diffuse surface under lights with a known answer, both estimators held against it, and the
//! classic mistakes with the ratios that give them away.
//!
//! Means and variances of bounded draws use Bernstein's inequality with the exact variance (α = 1e-13), valid
//! for every n; the means of the mistakes 7.5 std errors (6.4e-14, their draws being bounded and n = 4e5).
//! What holds for any light is in tests/estimators.rs.

mod common;

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI, TAU};

use approx::assert_relative_eq;
use proptest::prelude::*;
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::lambertian::{CosinePower, Lambertian, Light, RingLight};
use unbiased::{Budget, Density, Error, Estimate, Estimator, Stream, estimate, from_fn};

/// How far the mean of n draws with this variance, none further than `reach` from their mean, may lie from
/// it: with probability 1 − 1e-13, no further (Bernstein). About 7.8 σ/√n.
fn band(draws: u64, variance: f64, reach: f64) -> f64 {
    common::alarm(1e-13);
    let (n, l) = (draws as f64, (2.0f64 / 1e-13).ln());
    let bounded = l * reach / 3.0;
    (bounded + (bounded * bounded + 2.0 * n * l * variance).sqrt()) / n
}

/// ∫ f over [0, high] by the tanh-sinh rule: it takes singular and steep ends.
fn integral(f: impl Fn(f64) -> f64, high: f64) -> f64 {
    const STEP: f64 = 1.0 / 64.0;
    let node = |i: i32| {
        let t = STEP * f64::from(i);
        let (below, above) = (1.0 / (1.0 + (-PI * t.sinh()).exp()), 1.0 / (1.0 + (PI * t.sinh()).exp()));
        PI * t.cosh() * below * above * f(high * below)
    };
    (-384..=384).map(node).sum::<f64>() * STEP * high
}

/// E (X − centre)^j of one draw X under cos^a θ, by quadrature over y = −ln cos θ, in which nothing is
/// singular: X = k e^(−by), and y has the density m e^(−dy).
fn power_moment(hemisphere: Hemisphere, a: f64, albedo: f64, centre: f64, j: i32) -> f64 {
    let (k, b, m, d) = match hemisphere {
        Hemisphere::Uniform => (2.0 * albedo, a + 1.0, 1.0, 1.0),
        Hemisphere::Cosine => (albedo, a, 2.0, 2.0),
    };
    let part = d / f64::from(j);
    let slowest = d.min(f64::from(j) * b + d);
    integral(|y| m * (k * (-(b + part) * y).exp() - centre * (-part * y).exp()).powi(j), 42.0 / slowest)
}

/// The same under the ring: over c = cos θ, lit up to ε and dark beyond.
fn ring_moment(hemisphere: Hemisphere, width: f64, albedo: f64, centre: f64, j: i32) -> f64 {
    let dark = match hemisphere {
        Hemisphere::Uniform => 1.0 - width,
        Hemisphere::Cosine => (1.0 - width) * (1.0 + width),
    };
    let lit = |c: f64| match hemisphere {
        Hemisphere::Uniform => (2.0 * albedo * c - centre).powi(j),
        Hemisphere::Cosine => (albedo - centre).powi(j) * 2.0 * c,
    };
    integral(lit, width) + dark * (-centre).powi(j)
}

/// ρ and x, then \[L_r, variance of uniform, variance of cosine\], from exact rational arithmetic.
type Row = (f64, f64, [f64; 3]);

const INF: f64 = f64::INFINITY;

const POWERS: [Row; 26] = [
    (0.0, 1.0, [1.0, 0.3333333333333333, 0.0]),
    (1.0, 1.0, [0.6666666666666666, 0.35555555555555557, 0.05555555555555555]),
    (-0.5, 0.61, [0.8133333333333334, 0.08268888888888888, 0.08268888888888888]),
    (0.37, 0.83, [0.70042194092827, 0.24620054851654236, 0.012255819994742144]),
    (-1.0, 0.61, [1.22, 0.0, INF]),
    (-0.9999999999999998, 0.61, [1.2199999999999998, 7.338378570818455e-32, 1675789421344560.0]),
    (-1.0000000000000002, 0.61, [1.2200000000000002, 7.338378570818469e-32, INF]),
    (-0.999999999, 1.0, [1.999999998, 3.9999997577445526e-18, 1000000024.2819322]),
    (-1.5, 0.61, [2.44, INF, INF]),
    (-1.4999999999999996, 0.61, [2.4399999999999977, 1675789421344555.5, INF]),
    (-1.05, 0.61, [1.2842105263157895, 0.004581101877500778, INF]),
    (-1.55, 0.61, [2.7111111111111112, INF, INF]),
    (-1.9, 0.61, [12.199999999999989, INF, INF]),
    (-1.9999999999999996, 0.61, [2747195772696002.5, INF, INF]),
    (1e-09, 0.61, [0.609999999695, 0.12403333337467777, 9.302499981395001e-20]),
    (-1e-09, 0.61, [0.610000000305, 0.12403333329198889, 9.302500018605e-20]),
    (5e-324, 1.0, [1.0, 0.3333333333333333, 0.0]),
    (1e6, 0.61, [1.21999756000488e-06, 7.44197395307628e-07, 3.7209813950632567e-07]),
    (1e17, 0.61, [1.22e-17, 7.442e-18, 3.721e-18]),
    (1e300, 1.0, [2e-300, 2e-300, 1e-300]),
    (f64::MAX, 1.0, [1.1125369292536007e-308, 1.1125369292536007e-308, 5.562684646268003e-309]),
    (0.37, 1e-150, [8.438818565400844e-151, 3.5738212878000052e-301, 1.7790419501730504e-302]),
    (2.5, 1e-300, [4.4444444444444446e-301, 0.0, 0.0]),
    (-1.7, 0.0, [0.0, 0.0, 0.0]),
    (0.37, 0.0, [0.0, 0.0, 0.0]),
    (-1.2, 0.0, [0.0, 0.0, 0.0]),
];

const RINGS: [Row; 13] = [
    (1.0, 1.0, [1.0, 0.3333333333333333, 0.0]),
    (0.9999999999999999, 1.0, [0.9999999999999998, 0.3333333333333333, 2.2204460492503126e-16]),
    (0.9999999999999999, 0.61, [0.6099999999999999, 0.12403333333333333, 8.262279749260412e-17]),
    (0.9999999891234567, 0.61, [0.6099999867306172, 0.12403333333333325, 8.094323328062216e-09]),
    (0.75, 1.0, [0.5625, 0.24609375, 0.24609375]),
    (0.1, 1.0, [0.010000000000000002, 0.0012333333333333335, 0.0099]),
    (0.37, 0.83, [0.11362699999999999, 0.033615373804333326, 0.081399314871]),
    (1e-09, 0.61, [6.1e-19, 4.961333329612334e-28, 3.7210000000000003e-19]),
    (1e-100, 1.0, [1e-200, 1.3333333333333334e-300, 1e-200]),
    (1e-160, 1.0, [1e-320, 0.0, 1e-320]),
    (5e-324, 1.0, [0.0, 0.0, 0.0]),
    (0.5, 0.0, [0.0, 0.0, 0.0]),
    (0.3, 1e-150, [8.999999999999999e-152, 2.7899999999999997e-302, 8.189999999999999e-302]),
];

fn holds(light: &impl Light, (x, albedo, exact): Row) {
    let surface = Lambertian::new(albedo).unwrap();
    let given = [
        light.reflected(surface),
        light.variance(surface, Hemisphere::Uniform),
        light.variance(surface, Hemisphere::Cosine),
    ];
    for (given, exact) in given.into_iter().zip(exact) {
        // at most 11 roundings of half an ulp each, and the least number there is
        let close = (given - exact).abs() <= 5.5 * f64::EPSILON * exact + 5e-324;
        assert!(given == exact || close, "{given} for {exact} at {x}, ρ = {albedo}");
    }
}

#[test]
fn closed_forms_keep_their_digits_at_the_ends() {
    for row in POWERS {
        holds(&CosinePower::new(row.0).unwrap(), row);
    }
    for row in RINGS {
        holds(&RingLight::new(row.0).unwrap(), row);
    }
}

#[test]
fn neither_density_always_wins() {
    use Hemisphere::{Cosine, Uniform};
    let white = Lambertian::new(1.0).unwrap();
    let power = |a: f64| CosinePower::new(a).unwrap();
    let times = |light: &dyn Light| light.variance(white, Cosine) / light.variance(white, Uniform);
    assert_eq!((power(0.0).variance(white, Uniform), power(0.0).variance(white, Cosine)), (1.0 / 3.0, 0.0));
    assert_relative_eq!(times(&power(-0.5)), 1.0, epsilon = 0.0, max_relative = 2.0 * f64::EPSILON);
    assert!(times(&power(-0.501)) > 1.0 && times(&power(-0.499)) < 1.0);
    assert_eq!((power(-1.0).variance(white, Uniform), power(-1.0).variance(white, Cosine)), (0.0, INF));
    let ring = |width: f64| RingLight::new(width).unwrap();
    assert_relative_eq!(times(&ring(0.1)), 297.0 / 37.0, epsilon = 0.0, max_relative = 4.0 * f64::EPSILON);
    assert_relative_eq!(times(&ring(0.75)), 1.0, epsilon = 0.0, max_relative = 2.0 * f64::EPSILON);
    assert!(times(&ring(0.749)) > 1.0 && times(&ring(0.751)) < 1.0);
}

#[test]
fn a_surface_says_what_it_is() {
    let surface = Lambertian::new(0.61).unwrap();
    assert_eq!((surface.albedo(), surface.emitted(), surface.reflected(2.0)), (0.61, 0.0, 1.22));
    // ∫ f_r cos θ dω = ρ: what leaves is the part ρ of what arrives
    let cos_sin = integral(|theta| theta.cos() * theta.sin(), FRAC_PI_2);
    assert_relative_eq!(surface.brdf() * TAU * cos_sin, 0.61, epsilon = 0.0, max_relative = 1e-14);
    assert_eq!(CosinePower::new(-1.3).unwrap().a(), -1.3);
    assert_eq!(RingLight::new(0.1).unwrap().width(), 0.1);
}

#[test]
fn bad_parameters_are_errors() {
    for (albedo, shown) in
        [(1.0000000000000002, "1.0000000000000002"), (-0.1, "-0.1"), (f64::NAN, "NaN"), (INF, "inf")]
    {
        let message =
            format!("the albedo ρ must be between 0 and 1 (above 1 it would create energy), not {shown}");
        assert_eq!(Lambertian::new(albedo).unwrap_err().to_string(), message);
    }
    for a in [-2.0, -3.0, INF, f64::NAN] {
        let message = format!("the exponent a must be above -2 and finite, not {a}");
        assert_eq!(CosinePower::new(a).unwrap_err().to_string(), message);
    }
    for width in [0.0, -0.5, 1.0000000000000002, f64::NAN] {
        let message = format!("the ring's width ε must be above 0 and at most 1, not {width}");
        assert_eq!(RingLight::new(width).unwrap_err().to_string(), message);
    }
    let surface = Lambertian::new(0.5).unwrap();
    for broken in [f64::NAN, INF] {
        let run = estimate(&surface.cosine_estimator(|_| broken), Budget::Draws(10), common::seed(310));
        assert!(matches!(run, Err(Error::Draw { block: 0, draw: 0, .. })));
    }
}

#[test]
fn a_constant_light_has_no_variance_under_cosine() {
    for albedo in [0.0, 0.61, 1.0] {
        let surface = Lambertian::new(albedo).unwrap();
        let furnace =
            estimate(&surface.cosine_estimator(|_| 7.0), Budget::Draws(10_000), common::seed(311)).unwrap();
        assert_eq!((furnace.mean(), furnace.std_error()), (7.0 * albedo, Some(0.0)));
        // the ring that is the whole sky, the normal and all
        let sky = RingLight::new(1.0).unwrap();
        let up = Direction::new(0.0, 0.0, 1.0).unwrap();
        assert_eq!(surface.albedo() * sky.incoming(&up), sky.reflected(surface));
    }
}

#[test]
fn lights_of_1e300_keep_their_error_bar() {
    // 1e300 cos θ: the variance 0.3556e600 overflows, the std error may not
    let surface = Lambertian::new(1.0).unwrap();
    let light = CosinePower::new(1.0).unwrap();
    for hemisphere in Hemisphere::ALL {
        let draws = 1 << 18;
        let general = surface.estimator(|w| 1e300 * light.incoming(w), hemisphere);
        let run = estimate(&general, Budget::Draws(draws), common::seed(312)).unwrap();
        assert_eq!(run.variance(), Some(INF));
        // sees 1.3 % of it
        assert!(run.z(1e300 * light.reflected(surface)).unwrap().abs() <= common::deviations(7.5));
        let (mean, variance) = (light.reflected(surface), light.variance(surface, hemisphere));
        let fourth = power_moment(hemisphere, 1.0, 1.0, mean, 4);
        let spread = band(draws, fourth - variance * variance, 4.0);
        let square = (run.std_error().unwrap() / 1e300).powi(2) * draws as f64;
        assert!((square - variance).abs() <= spread + band(draws, variance, 2.0).powi(2));
    }
}

#[test]
fn lights_are_alike_to_whoever_uses_them() {
    let surface = Lambertian::new(0.61).unwrap();
    let lights: [Box<dyn Light>; 3] = [
        Box::new(CosinePower::new(0.0).unwrap()),
        Box::new(CosinePower::new(2.5).unwrap()),
        Box::new(RingLight::new(0.37).unwrap()),
    ];
    for light in lights {
        let incoming = |direction: &Direction| light.incoming(direction);
        assert_eq!(incoming(&Direction::new(1.0, 0.0, -0.1).unwrap()), 0.0);
        let uniform: Box<dyn Estimator> = Box::new(surface.uniform_estimator(incoming));
        let cosine: Box<dyn Estimator> = Box::new(surface.cosine_estimator(incoming));
        for (estimator, hemisphere) in [uniform, cosine].iter().zip(Hemisphere::ALL) {
            let draws = 1 << 16;
            let run = estimate(estimator, Budget::Draws(draws), common::seed(314)).unwrap();
            let allowed = band(draws, light.variance(surface, hemisphere), 2.0 * 0.61); // sees 3 %
            assert!((run.mean() - light.reflected(surface)).abs() <= allowed);
        }
    }
}

#[test]
fn a_seed_keeps_its_draws() {
    let surface = Lambertian::new(0.61).unwrap();
    let sideways = |direction: &Direction| direction.vector().x;
    let mut rng = Stream::new(1, 0);
    let bits = [
        surface.uniform_estimator(sideways).draw(&mut rng).to_bits(),
        surface.cosine_estimator(sideways).draw(&mut rng).to_bits(),
        surface.estimator(sideways, Hemisphere::Uniform).draw(&mut rng).to_bits(),
        surface.estimator(sideways, Hemisphere::Cosine).draw(&mut rng).to_bits(),
    ];
    assert_eq!(bits, GOLDEN, "{bits:#x?}");
    assert_eq!((rng.random_numbers(), rng.evaluations()), (8, 4));
}

const GOLDEN: [u64; 4] = [0x3fc105c92b99882a, 0x3fd0b505fc2fca9b, 0x3fafcf28abaa6ab1, 0xbfd57d3e49eefaa5];

/// Where a light shines: cos θ, and φ/2π.
type Sky = fn(f64, f64) -> f64;

/// The five lights, each with ∫ f_r L_i cos θ dω for ρ = 1. The last two tell one side of the sky from the
/// other.
const SKIES: [(&str, Sky, f64); 5] = [
    ("1", |_, _| 1.0, 1.0),
    ("cos θ", |c, _| c, 2.0 / 3.0),
    ("cos² θ", |c, _| c * c, 0.5),
    ("2[φ < π]", |_, v| if v < 0.5 { 2.0 } else { 0.0 }, 1.0),
    ("4[cos² θ > ½][φ < π]", |c, v| if c * c > 0.5 && v < 0.5 { 4.0 } else { 0.0 }, 1.0),
];

/// A way to draw: from (u, v) to (cos θ, φ/2π, what the light is multiplied by besides ρ).
type Way = fn(f64, f64) -> (f64, f64, f64);

const S: f64 = FRAC_1_SQRT_2;

/// The classic mistakes, and E\[estimate\]/truth under each of the five lights, by pencil.
fn mistakes() -> Vec<(&'static str, Way, [f64; 5])> {
    let root3 = 3f64.sqrt();
    vec![
        ("uniform, pdf 1/π", |u, v| (1.0 - u, v, 1.0 - u), [0.5; 5]),
        (
            "the whole sphere, pdf 1/2π, clamped",
            |u, v| (1.0 - 2.0 * u, v, 2.0 * (1.0 - 2.0 * u).max(0.0)),
            [0.5; 5],
        ),
        ("uniform, pdf 1/4π", |u, v| (1.0 - u, v, 4.0 * (1.0 - u)), [2.0; 5]),
        ("cos θ forgotten", |u, v| (1.0 - u, v, 2.0), [2.0, 1.5, 4.0 / 3.0, 2.0, 4.0 * (1.0 - S)]),
        ("1/π of the BRDF forgotten", |u, v| (1.0 - u, v, 2.0 * PI * (1.0 - u)), [PI; 5]),
        ("cosine's pdf without 1/π", |u, v| ((1.0 - u).sqrt(), v, 1.0 / PI), [1.0 / PI; 5]),
        ("no division by the pdf", |u, v| (1.0 - u, v, (1.0 - u) / PI), [1.0 / TAU; 5]),
        ("multiplied by the pdf", |u, v| (1.0 - u, v, (1.0 - u) / PI / TAU), [1.0 / TAU / TAU; 5]),
        (
            "cos θ twice",
            |u, v| (1.0 - u, v, 2.0 * (1.0 - u) * (1.0 - u)),
            [2.0 / 3.0, 0.75, 0.8, 2.0 / 3.0, 4.0 / 3.0 * (1.0 - S * S * S)],
        ),
        (
            "cosine drawn, weight cos θ",
            |u, v| ((1.0 - u).sqrt(), v, (1.0 - u).sqrt()),
            [2.0 / 3.0, 0.75, 0.8, 2.0 / 3.0, 4.0 / 3.0 * (1.0 - S * S * S)],
        ),
        (
            "cosine drawn, uniform's weight",
            |u, v| ((1.0 - u).sqrt(), v, 2.0 * (1.0 - u).sqrt()),
            [4.0 / 3.0, 1.5, 1.6, 4.0 / 3.0, 8.0 / 3.0 * (1.0 - S * S * S)],
        ),
        (
            "uniform drawn, cosine's weight",
            |u, v| (1.0 - u, v, 1.0),
            [1.0, 0.75, 2.0 / 3.0, 1.0, 2.0 * (1.0 - S)],
        ),
        (
            "θ uniform, uniform's weight",
            |u, v| {
                let c = (FRAC_PI_2 * u).cos();
                (c, v, 2.0 * c)
            },
            [4.0 / PI, 1.5, 16.0 / (3.0 * PI), 4.0 / PI, 8.0 / PI * S],
        ),
        (
            "θ uniform, sin θ forgotten in the measure",
            |u, v| {
                let c = (FRAC_PI_2 * u).cos();
                (c, v, PI * c)
            },
            [2.0, 0.75 * PI, 8.0 / 3.0, 2.0, 4.0 * S],
        ),
        (
            "the disc's radius without its root",
            |u, v| ((1.0 - u * u).sqrt(), v, 1.0),
            [1.0, 0.375 * PI, 4.0 / 3.0, 1.0, 2.0 * S],
        ),
        (
            "cosine's x and y doubled, then normalised",
            |u, v| (((1.0 - u) / (1.0 + 3.0 * u)).sqrt(), v, 1.0),
            [
                1.0,
                1.5 * (4.0 * PI / (9.0 * root3) - 1.0 / 3.0),
                2.0 * (4.0 / 9.0 * 4f64.ln() - 1.0 / 3.0),
                1.0,
                0.4,
            ],
        ),
        ("φ = πV", |u, v| ((1.0 - u).sqrt(), 0.5 * v, 1.0), [1.0, 1.0, 1.0, 2.0, 2.0]),
        ("one U for both angles", |u, _| ((1.0 - u).sqrt(), u, 1.0), [1.0, 1.0, 1.0, 1.0, 2.0]),
        ("cos θ = U²", |u, v| (u * u, v, 1.0), [1.0, 0.5, 0.4, 1.0, 2.0 * (1.0 - S.sqrt())]),
    ]
}

const MISTAKE_DRAWS: u64 = 400_000;

fn measured(seed: u64, draw: impl Fn(f64, f64) -> f64 + Sync) -> Estimate {
    let estimator = from_fn(move |rng| {
        let (u, v) = (rng.uniform(), rng.uniform());
        draw(u, v)
    });
    estimate(&estimator, Budget::Draws(MISTAKE_DRAWS), common::seed(seed)).unwrap()
}

/// Asserts the ratio to the truth, and that it gives the mistake away wherever it is not 1.
fn caught(name: &str, sky: &str, run: &Estimate, truth: f64, ratio: f64) {
    let reach = common::deviations(7.5) * run.std_error().unwrap() + 1e-12 * truth;
    let off = run.mean() - ratio * truth;
    assert!(off.abs() <= reach, "{name} under {sky}: {} for {ratio}", run.mean() / truth);
    let passes = (run.mean() - truth).abs() <= reach;
    let invisible = ratio == 1.0;
    assert!(passes == invisible, "{name} under {sky}: {} ± {reach}", run.mean() / truth);
}

#[test]
fn classic_mistakes_are_caught() {
    // a light with few lit directions has std errors to 0.3 % of its truth: ratios are known to 2 %, and the
    // nearest is 0.75
    let albedo = 0.61;
    for (name, way, ratios) in mistakes() {
        for ((sky, light, truth), ratio) in SKIES.into_iter().zip(ratios) {
            let run = measured(320, move |u, v| {
                let (c, turns, weight) = way(u, v);
                albedo * weight * light(c, turns)
            });
            caught(name, sky, &run, albedo * truth, ratio);
        }
        assert!(ratios.iter().any(|ratio| *ratio != 1.0));
    }
    // each draw cut off at ρ, which no bright light survives
    let m = 0.5f64.cbrt();
    let cut = [
        0.75,
        1.5 * (2.0 / 3.0 * S * S * S + 1.0 - S),
        2.0 * (0.5 * m.powi(4) + 1.0 - m),
        0.4375,
        0.5 * (1.0 - S),
    ];
    for ((sky, light, truth), ratio) in SKIES.into_iter().zip(cut) {
        let run = measured(321, move |u, v| albedo * (2.0 * (1.0 - u) * light(1.0 - u, v)).min(1.0));
        caught("each draw clamped to 1", sky, &run, albedo * truth, ratio);
    }
}

#[test]
fn a_furnace_alone_misses_six_of_them() {
    let blind: Vec<_> =
        mistakes().into_iter().filter(|(_, _, ratios)| ratios[0] == 1.0).map(|row| row.0).collect();
    assert_eq!(blind.len(), 6, "{blind:?}");
}

#[test]
fn second_moments_tell_mistakes_of_equal_means_apart() {
    // E[X²] at L = 1: as by pencil, within 7.5 std errors; pairs are 2 and 1.6 times apart
    let square = |way: Way| measured(323, move |u, v| way(u, v).2.powi(2));
    let all = mistakes();
    let of = |name: &str| square(all.iter().find(|row| row.0 == name).unwrap().1);
    for (name, second) in [
        ("uniform, pdf 1/π", 1.0 / 3.0),
        ("the whole sphere, pdf 1/2π, clamped", 2.0 / 3.0),
        ("cos θ twice", 0.8),
        ("cosine drawn, weight cos θ", 0.5),
    ] {
        assert!(of(name).z(second).unwrap().abs() <= common::deviations(7.5), "{name}");
    }
}

proptest! {
    #![proptest_config(common::config(512))]

    #[test]
    fn closed_forms_are_the_integrals(a in -1.9..20.0f64, albedo in 0.01..=1.0f64, width in 0.001..=1.0f64) {
        let surface = Lambertian::new(albedo).unwrap();
        let (power, ring) = (CosinePower::new(a).unwrap(), RingLight::new(width).unwrap());
        // ∫∫ ρ/π cos^a θ cos θ sin θ dθ dφ, with θ counted from the horizon, where cos^(a+1) θ may be
        // singular
        let reflected = integral(|t| TAU * albedo / PI * t.sin().powf(a + 1.0) * t.cos(), FRAC_PI_2);
        prop_assert!((power.reflected(surface) - reflected).abs() <= 1e-11 * reflected);
        let reflected = integral(|c| TAU * albedo / PI * c, width);
        prop_assert!((ring.reflected(surface) - reflected).abs() <= 1e-13 * reflected);
        for (hemisphere, least) in [(Hemisphere::Uniform, -1.5), (Hemisphere::Cosine, -1.0)] {
            let (mean, variance) = (power.reflected(surface), power.variance(surface, hemisphere));
            prop_assert_eq!(variance.is_finite(), a > least);
            if a > least + 1e-3 {
                let quadrature = power_moment(hemisphere, a, albedo, mean, 2);
                let close = 1e-12 * variance + 1e-14 * mean * variance.sqrt();
                prop_assert!((variance - quadrature).abs() <= close, "{hemisphere:?} {a}: {variance} \
                    {quadrature}");
            }
            let (mean, variance) = (ring.reflected(surface), ring.variance(surface, hemisphere));
            let quadrature = ring_moment(hemisphere, width, albedo, mean, 2);
            prop_assert!((variance - quadrature).abs() <= 1e-12 * variance);
        }
    }

    #[test]
    fn the_short_forms_are_the_general_one(seed: u64, a in -1.9..20.0f64, albedo in 0.0..=1.0f64) {
        let surface = Lambertian::new(albedo).unwrap();
        let power = CosinePower::new(a).unwrap();
        let light = |direction: &Direction| power.incoming(direction) * (2.0 + direction.vector().x);
        let mut general = Stream::new(seed, 0);
        let mut short = general.clone();
        for _ in 0..20 {
            // eight roundings between them
            let of = surface.estimator(light, Hemisphere::Uniform).draw(&mut general);
            let is = surface.uniform_estimator(light).draw(&mut short);
            prop_assert!((of - is).abs() <= 4.0 * f64::EPSILON * is);
            let of = surface.estimator(light, Hemisphere::Cosine).draw(&mut general);
            let is = surface.cosine_estimator(light).draw(&mut short);
            prop_assert!((of - is).abs() <= 4.0 * f64::EPSILON * is);
        }
        prop_assert_eq!(general.random_numbers(), short.random_numbers());
        prop_assert_eq!(general.evaluations(), short.evaluations());
    }

    #[test]
    fn any_bits_make_a_light_or_an_error(bits in any::<[u64; 4]>()) {
        let [albedo, x, y, z] = bits.map(f64::from_bits);
        prop_assert_eq!(Lambertian::new(albedo).is_ok(), (0.0..=1.0).contains(&albedo));
        prop_assert_eq!(CosinePower::new(x).is_ok(), x > -2.0 && x < INF);
        prop_assert_eq!(RingLight::new(x).is_ok(), x > 0.0 && x <= 1.0);
        // most bits are no albedo and no width: these are
        for albedo in [albedo, f64::from_bits(bits[0] % 1f64.to_bits()), 0.0, 1.0] {
            let Ok(surface) = Lambertian::new(albedo) else { continue };
            let mut lights: Vec<Box<dyn Light>> = Vec::new();
            for x in [x, f64::from_bits(bits[1] % 1f64.to_bits()),
                -2.0 + f64::from_bits(bits[1] % 2f64.to_bits())] {
                lights.extend(CosinePower::new(x).map(|light| Box::new(light) as Box<dyn Light>));
                lights.extend(RingLight::new(x).map(|light| Box::new(light) as Box<dyn Light>));
            }
            for light in lights {
                prop_assert!(light.reflected(surface) >= 0.0 && light.reflected(surface) < INF);
                for hemisphere in Hemisphere::ALL {
                    prop_assert!(light.variance(surface, hemisphere) >= 0.0);
                }
                if let Ok(direction) = Direction::new(x, y, z) {
                    prop_assert!(light.incoming(&direction) >= 0.0);
                }
            }
            if y.is_finite() {
                prop_assert!(!surface.reflected(y).is_nan() && surface.brdf() >= 0.0);
            }
        }
    }
}

/// A direction along the surface carries no light to it, not even where the light grows beyond all bounds
/// there.
#[test]
fn along_the_surface_nothing_arrives() {
    struct Along;
    impl Density<0> for Along {
        type Point = Direction;
        fn warp(&self, []: [f64; 0]) -> Direction {
            Direction::polar(0.0, 0.3).unwrap()
        }
        fn pdf(&self, _: &Direction) -> f64 {
            1.0
        }
    }
    let surface = Lambertian::new(0.61).unwrap();
    let estimator = surface.estimator(|direction| direction.cos_theta().powf(-0.5), Along);
    assert_eq!(estimator.draw(&mut Stream::new(1, 0)), 0.0);
}
