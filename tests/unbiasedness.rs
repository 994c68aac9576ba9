//! Every estimator of the crate is unbiased: by section, with parameters and integrands that proptest
//! chooses.
//!
//! A test is a row of [`TABLE`]: so many cases certified to within a thousandth, so many to within a
//! hundredth, each by the sequential test of `check::Unbiased`, which must say *unbiased*; *undecided* fails.
//! A relative bias of 1e-3 (1e-2 where only coarse cases stand) is caught in every run but for two in 10⁶.
//! Estimators of at most two random numbers are integrated as well, by `check::exactly`: to 1e-9, over far
//! more parameters, with no noise and no false alarm.
//!
//! Draws must be bounded to be certified. X ≥ 0 without a bound is tested through F(X) and min(X, c), whose
//! means are known; roulette's paths are bounded for q > ρ, by q/(q − ρ), go through min(X, c) at q = ρ, and
//! for q < ρ through \[X > 0\], which sees the coins but not the weights: a bounded function that sees them
//! has no closed form there, and the weights are computed by the same line as for q > ρ.
//!
//! # False alarms
//! Each case and each comparison of distributions has [`ALPHA`]; [`OTHERS`] lists what the other test files
//! state of themselves, and a test adds everything up. α is small because it is nearly free: a certificate
//! takes 40 CV²/δ² draws whatever α is. That a right estimator stays undecided takes its sum to lie 8 std
//! deviations off: less than 1e-14 a case, and counted with α.
//!
//! `UNBIASED_SEED=n` runs everything with fresh parameters and fresh draws.

mod common;

use common::furnace;
use std::f64::consts::PI;
use std::fmt::Debug;

use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use rand::distr::Distribution;
use statrs::distribution::{Beta, ContinuousCDF, DiscreteCDF, Gamma, Normal, Poisson, Weibull};
use unbiased::check::{Unbiased, Verdict, distributed_as, exactly};
use unbiased::inversion::{Exponential, Inversion};
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::lambertian::{CosinePower, Lambertian, Light, RingLight};
use unbiased::paths::room::{BoxRoom, Scene};
use unbiased::paths::{Bounces, FindLight, Paths, reflected};
use unbiased::rectangle::Rectangle;
use unbiased::roulette::{LightModel, Roulette};
use unbiased::{Density, Estimator, Stream, f_over_p, from_fn};

// ---- what each test costs and certifies
// --------------------------------------------------------------------------

/// The probability that one case calls a right estimator biased, or cannot decide.
const ALPHA: f64 = 1e-14;

/// The bias that a fine case certifies, relative to the truth.
const FINE: f64 = 1e-3;

/// The bias that a coarse case certifies.
const COARSE: f64 = 1e-2;

/// A test's name, its cases at [`FINE`] and at [`COARSE`], and its comparisons of distributions, each at
/// [`ALPHA`].
type Row = (&'static str, u32, u32, u32);

const TABLE: [Row; 35] = [
    // section 1
    ("exponential_through_its_cdf", 1, 24, 0),
    ("exponential_in_single_precision", 1, 24, 0),
    ("exponential_cut_off", 1, 24, 0),
    ("inversion_of_a_formula", 0, 12, 0),
    ("inversion_of_library_cdfs", 0, 4, 0),
    ("inversion_of_discrete_cdfs", 0, 4, 0),
    ("samplers_of_section_1", 0, 0, 4 * 3),
    // section 2
    ("rectangle_independent", 1, 24, 0),
    ("rectangle_ratio", 1, 24, 0),
    ("rectangle_all_pairs", 1, 12, 0),
    ("rectangle_jittered", 1, 12, 0),
    ("rectangle_sobol", 1, 12, 0),
    ("samplers_of_section_2", 0, 0, 4 * 2),
    // section 3
    ("lambertian_uniform", 1, 24, 0),
    ("lambertian_cosine", 1, 24, 0),
    ("lambertian_general", 1, 24, 0),
    ("lambertian_over_the_whole_sphere", 0, 12, 0),
    ("lambertian_in_a_ring", 0, 12, 0), // light found by chance: CV² up to 24
    ("samplers_of_section_3", 0, 0, 2),
    // section 4
    ("paths_of_one_bounce", 1, 16, 0),
    ("paths_of_two_bounces", 1, 8, 0),
    ("paths_of_two_bounces_by_chance", 0, 4, 0), // CV² around 20
    ("paths_in_a_furnace", 1, 16, 0),
    ("furnaces_by_roulette", 1, 16, 0),
    ("furnaces_by_weight", 1, 16, 0),
    ("reflected_light", 1, 8, 0),
    // section 5
    ("roulette_on_an_estimator", 1, 24, 0),
    ("roulette_that_seldom_goes_on", 0, 8, 0), // CV² up to 20
    ("bounces_by_simulation", 1, 16, 0),
    ("bounces_by_inversion", 1, 16, 0),
    ("samplers_of_section_5", 0, 0, 4 * 2),
    ("truncated_paths", 1, 16, 0),
    ("roulette_paths_with_falling_weights", 1, 16, 0),
    ("roulette_paths_with_constant_weights", 0, 12, 0),
    ("roulette_paths_with_growing_weights", 0, 8, 0),
];

/// False alarms of the other files with random tests, by their own account or, where they give only α, by the
/// number of their tests.
const OTHERS: [(&str, f64); 13] = [
    ("inversion", 6e-11),
    ("rectangle", 3.6e-10),
    ("hemisphere", 3e-11),
    ("lambertian", 1e-10),
    ("roulette", 3e-10),
    ("box room", 3e-15),
    ("paths", 5.2e-13),        // 400 at 8 std errors
    ("many at a time", 8e-14), // 64 at 8
    ("estimate and run", 1.5e-11),
    ("diagnose, predictions", 5e-11),
    ("check, at its own α", 4e-11),
    ("trade", 1.1e-11), // four at 7
    // rounding and bits only, whatever the seed; examples and notebooks run with fixed ones
    ("edges, fast, nist, vectors, examples, figures, notebooks", 0.0),
];

#[test]
fn false_alarms_of_the_whole_suite_stay_below_1e_9() {
    let source = include_str!("unbiasedness.rs");
    let mut own = 0.0;
    for (test, fine, coarse, bands) in TABLE {
        // 2α a case: called biased, and undecided
        let alpha = ALPHA * f64::from(2 * (fine + coarse) + bands);
        let smallest = match (fine, coarse) {
            (0, 0) => "a distribution".into(),
            (0, _) => format!("bias {COARSE:e}"),
            _ => format!("bias {FINE:e}"),
        };
        println!("{test:40} {fine:2} + {coarse:2} cases, {bands:2} bands: α = {alpha:.1e}, {smallest}");
        assert!(source.contains(&format!("fn {test}()")), "no test is called {test}");
        own += alpha;
    }
    let others: f64 = OTHERS.iter().map(|(_, alpha)| alpha).sum();
    println!("here {own:.2e}, elsewhere {others:.2e}, in all {:.3e}", own + others);
    assert!(own + others <= 1e-9);
}

/// An estimator, its mean by another route, and the range of its draws.
struct Case {
    estimator: Box<dyn Estimator>,
    truth: f64,
    range: [f64; 2],
}

/// Draws from 0 to `most`, with room for a truth at the end and for a bias.
fn case(estimator: impl Estimator + 'static, truth: f64, most: f64) -> Case {
    Case { estimator: Box::new(estimator), truth, range: [0.0, 1.05 * most] }
}

fn row(test: &str) -> Row {
    TABLE.into_iter().find(|row| row.0 == test).unwrap()
}

/// Runs as many cases as the test's row in the table says.
fn certify<P: Debug>(test: &str, parameters: impl Strategy<Value = P>, build: impl Fn(P) -> Case) {
    let (_, fine, coarse, _) = row(test);
    let parameters = (parameters, any::<u64>().no_shrink());
    // under mutation a wrong line is worth no more than a hundredth
    for (cases, delta) in [(fine, if common::mutation() { COARSE } else { FINE }), (coarse, COARSE)] {
        let config = Config { max_shrink_iters: 16, ..common::config(cases) };
        let result = TestRunner::new(config).run(&parameters, |(parameters, salt)| {
            let Case { estimator, truth, range } = build(parameters);
            let check = Unbiased::new(truth, range).unwrap().within(delta).unwrap().alpha(ALPHA).unwrap();
            let report = check.seed(common::seed(salt)).run(&estimator).unwrap();
            prop_assert_eq!(report.verdict, Verdict::Unbiased, "{}", report);
            Ok(())
        });
        result.unwrap_or_else(|error| panic!("{test}, δ = {delta}: {error}"));
    }
}

/// Mean and, where given, variance by quadrature, to 1e-9 of `scale` and of its square.
fn assert_exactly(estimator: &impl Estimator, numbers: usize, mean: f64, variance: Option<f64>, scale: f64) {
    let exact = exactly(estimator, numbers).unwrap();
    assert!((exact.mean - mean).abs() <= 1e-9 * scale, "mean {} for {mean}", exact.mean);
    if let Some(variance) = variance {
        let off = (exact.variance - variance).abs();
        assert!(off <= 1e-9 * scale * scale, "variance {} for {variance}", exact.variance);
    }
}

/// As many bands as the table says of this test.
fn compared(test: &str, count: u32) {
    assert_eq!(row(test).3, count, "the table is out of date");
}

/// From `low` to `high`, evenly in the logarithm.
fn log_range(low: f64, high: f64) -> impl Strategy<Value = f64> + Clone {
    (low.ln()..high.ln()).prop_map(f64::exp)
}

// ---- section 1
// -----------------------------------------------------------------------------------------------------

fn rates() -> impl Strategy<Value = f64> + Clone {
    log_range(1e-3, 1e3)
}

/// F(X) is uniform; F is written out here.
#[test]
fn exponential_through_its_cdf() {
    certify("exponential_through_its_cdf", rates(), |rate| {
        let x = Exponential::new(rate).unwrap();
        case(from_fn(move |rng| -(-rate * x.draw(rng)).exp_m1()), 0.5, 1.0)
    });
}

#[test]
fn exponential_in_single_precision() {
    certify("exponential_in_single_precision", rates(), |rate| {
        let x = Exponential::new(rate).unwrap();
        let single = move |rng: &mut _| f64::from(Distribution::<f32>::sample(&x, rng));
        case(from_fn(move |rng| -(-rate * single(rng)).exp_m1()), 0.5, 1.0)
    });
}

/// E min(X, c) = (1 − e^(−λc))/λ.
#[test]
fn exponential_cut_off() {
    certify("exponential_cut_off", (rates(), 0.3..4.0), |(rate, c)| {
        let (x, c) = (Exponential::new(rate).unwrap(), c / rate);
        // by `fill`, which has a loop of its own
        let fill = move |rng: &mut _| {
            let mut draws = [0.0; 1];
            x.fill(rng, &mut draws);
            draws[0].min(c)
        };
        case(from_fn(fill), -(-rate * c).exp_m1() / rate, c)
    });
}

/// A Lomax law with a scale s and any exponent, F(x) = 1 − (1 + x/s)^(−k), on an infinite support.
#[test]
fn inversion_of_a_formula() {
    certify("inversion_of_a_formula", (log_range(1e-3, 1e3), 1..4), |(scale, k): (f64, i32)| {
        let cdf = move |x: f64| 1.0 - (1.0 + x / scale).powi(-k);
        let x = Inversion::new(cdf, [0.0, f64::INFINITY]).unwrap();
        case(from_fn(move |rng| cdf(x.sample(rng))), 0.5, 1.0)
    });
}

/// A continuous law of another library, its support, mean and variance.
type Law = (Box<dyn Fn(f64) -> f64 + Sync>, [f64; 2], f64, f64);

fn law(which: usize, a: f64, b: f64) -> Law {
    const ALL: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
    const POSITIVE: [f64; 2] = [0.0, f64::INFINITY];
    match which {
        0 => {
            let law = Normal::new(a - 2.0, b).unwrap();
            (Box::new(move |x| law.cdf(x)), ALL, a - 2.0, b * b)
        }
        1 => {
            let law = Gamma::new(a, b).unwrap();
            (Box::new(move |x| law.cdf(x)), POSITIVE, a / b, a / b / b)
        }
        2 => {
            let (law, sum) = (Beta::new(a, b).unwrap(), a + b);
            (Box::new(move |x| law.cdf(x)), [0.0, 1.0], a / sum, a * b / (sum * sum * (sum + 1.0)))
        }
        _ => {
            let gamma = |x| statrs::function::gamma::gamma(x);
            let (law, first, second) =
                (Weibull::new(a, b).unwrap(), gamma(1.0 + 1.0 / a), gamma(1.0 + 2.0 / a));
            (Box::new(move |x| law.cdf(x)), POSITIVE, b * first, b * b * (second - first * first))
        }
    }
}

#[test]
fn inversion_of_library_cdfs() {
    certify("inversion_of_library_cdfs", (0..4usize, 1.0..4.0, 0.5..3.0), |(which, a, b)| {
        let (cdf, support, ..) = law(which, a, b);
        let sampler = Inversion::new(cdf, support).unwrap();
        let (again, ..) = law(which, a, b);
        case(from_fn(move |rng| again(sampler.sample(rng))), 0.5, 1.0)
    });
}

/// \[X ≤ k\] has the mean F(k), and \[X ≥ k\] 1 − F(k − 1).
#[test]
fn inversion_of_discrete_cdfs() {
    certify("inversion_of_discrete_cdfs", (1.0..9.0, any::<bool>()), |(mean, up): (f64, bool)| {
        let law = Poisson::new(mean).unwrap();
        let cdf = move |x: f64| if x < 0.0 { 0.0 } else { law.cdf(x as u64) };
        let sampler = Inversion::new(cdf, [0.0, f64::INFINITY]).unwrap();
        let k = mean.floor();
        let hit = move |x: f64| f64::from(u8::from(if up { x >= k } else { x <= k }));
        let truth = if up { 1.0 - cdf(k - 1.0) } else { cdf(k) };
        case(from_fn(move |rng| hit(sampler.sample(rng))), truth, 1.0)
    });
}

/// The exponential in both precisions and the inversion of its cdf: a deviation of the cdf of 0.01 is seen.
#[test]
fn samplers_of_section_1() {
    let mut bands = 0;
    for (i, rate) in [1e-3, 0.37, 2.5, 1e3].into_iter().enumerate() {
        let double = Exponential::new(rate).unwrap();
        let single = from_fn(move |rng| Distribution::<f32>::sample(&double, rng).into());
        let cdf = move |x: f64| if x < 0.0 { 0.0 } else { -(-rate * x).exp_m1() };
        let inverse = Inversion::new(cdf, [0.0, f64::INFINITY]).unwrap();
        let inverse = from_fn(move |rng| inverse.sample(rng));
        let samplers: [&dyn Estimator; 3] = [&double, &single, &inverse];
        for (j, sampler) in samplers.into_iter().enumerate() {
            let seed = common::seed(700 + 10 * i as u64 + j as u64);
            let agreement = distributed_as(sampler, cdf, 0.01, ALPHA, seed).unwrap();
            assert!(agreement.agrees, "λ = {rate}, {j}: {agreement}");
            bands += 1;
        }
    }
    compared("samplers_of_section_1", bands);
}

proptest! {
    #![proptest_config(common::config(128))]

    #[test]
    fn exponential_exactly(rate in log_range(1e-300, 1e300)) {
        let exponential = Exponential::new(rate).unwrap();
        // moments of λX, since those of X leave f64
        let scaled = from_fn(|rng| rate * exponential.draw(rng));
        assert_exactly(&scaled, 1, 1.0, Some(1.0), 1.0);
    }
}

proptest! {
    #![proptest_config(common::config(24))]

    #[test]
    fn inversion_exactly(which in 0..4usize, a in 1.0..4.0, b in 0.5..3.0) {
        let (cdf, support, mean, variance) = law(which, a, b);
        let sampler = Inversion::new(cdf, support).unwrap();
        let x = from_fn(|rng| sampler.sample(rng));
        assert_exactly(&x, 1, mean, Some(variance), mean.abs().max(variance.sqrt()));
    }
}

// ---- section 2
// -----------------------------------------------------------------------------------------------------

/// A polynomial Σ c_ij sⁱ tʲ in s = (x − a)/(b − a) and t = (y − c)/(d − c), its coefficients 0 or more.
#[derive(Debug, Clone, Copy)]
struct Polynomial {
    rectangle: Rectangle,
    coefficients: [[f64; 3]; 3],
}

impl Polynomial {
    fn at(&self, x: f64, y: f64) -> f64 {
        let ([a, b], [c, d]) = (self.rectangle.x_range(), self.rectangle.y_range());
        let (s, t) = ((x - a) / (b - a), (y - c) / (d - c));
        let along = |row: [f64; 3]| (row[2] * t + row[1]) * t + row[0];
        let [low, middle, high] = self.coefficients.map(along);
        (high * s + middle) * s + low
    }

    /// ∫∫ f: sⁱ tʲ has the mean 1/((i + 1)(j + 1)).
    fn integral(&self) -> f64 {
        let ([a, b], [c, d]) = (self.rectangle.x_range(), self.rectangle.y_range());
        let row = |row: [f64; 3]| row[0] + row[1] / 2.0 + row[2] / 3.0;
        let [low, middle, high] = self.coefficients.map(row);
        (b - a) * (d - c) * (low + middle / 2.0 + high / 3.0)
    }

    /// The largest draw of A f.
    fn most(&self) -> f64 {
        let ([a, b], [c, d]) = (self.rectangle.x_range(), self.rectangle.y_range());
        (b - a) * (d - c) * self.coefficients.as_flattened().iter().sum::<f64>()
    }
}

fn rectangles() -> impl Strategy<Value = Rectangle> + Clone {
    let side = || (-5.0..5.0, log_range(1e-2, 1e2)).prop_map(|(low, length)| [low, low + length]);
    (side(), side()).prop_map(|(x, y)| Rectangle::new(x, y).unwrap())
}

fn polynomials() -> impl Strategy<Value = Polynomial> + Clone {
    // a constant part, so that no polynomial is nearly 0 nearly everywhere
    (rectangles(), prop::array::uniform3(prop::array::uniform3(0.0..1.0)), 0.1..1.0).prop_map(
        |(rectangle, mut coefficients, constant)| {
            coefficients[0][0] = constant;
            Polynomial { rectangle, coefficients }
        },
    )
}

#[test]
fn rectangle_independent() {
    certify("rectangle_independent", polynomials(), |f| {
        case(f.rectangle.independent(move |x, y| f.at(x, y)), f.integral(), f.most())
    });
}

#[test]
fn rectangle_ratio() {
    certify("rectangle_ratio", polynomials(), |f| {
        case(f_over_p(move |[x, y]: &[f64; 2]| f.at(*x, *y), f.rectangle), f.integral(), f.most())
    });
}

#[test]
fn rectangle_all_pairs() {
    certify("rectangle_all_pairs", (polynomials(), 1..6u64), |(f, n)| {
        case(f.rectangle.all_pairs(move |x, y| f.at(x, y), n).unwrap(), f.integral(), f.most())
    });
}

#[test]
fn rectangle_jittered() {
    certify("rectangle_jittered", (polynomials(), 1..5u64), |(f, side)| {
        case(f.rectangle.jittered(move |x, y| f.at(x, y), side).unwrap(), f.integral(), f.most())
    });
}

#[test]
fn rectangle_sobol() {
    certify("rectangle_sobol", (polynomials(), 1..20u64), |(f, points)| {
        case(f.rectangle.sobol(move |x, y| f.at(x, y), points).unwrap(), f.integral(), f.most())
    });
}

/// x and y of a rectangle's points are uniform between its ends.
#[test]
fn samplers_of_section_2() {
    let mut bands = 0;
    for (i, [a, b]) in [[-2.0, 2.0], [0.3, 2.0], [-1.1, 3.0], [1e6, 1e6 + 1.0]].into_iter().enumerate() {
        let rectangle = Rectangle::new([a, b], [a, b]).unwrap();
        let cdf = |x: f64| ((x - a) / (b - a)).clamp(0.0, 1.0);
        for axis in 0..2 {
            let sampler = from_fn(|rng| rectangle.sample(rng)[axis]);
            let seed = common::seed(800 + 10 * i as u64 + axis as u64);
            let agreement = distributed_as(&sampler, cdf, 0.01, ALPHA, seed).unwrap();
            assert!(agreement.agrees, "[{a}, {b}], {axis}: {agreement}");
            bands += 1;
        }
    }
    compared("samplers_of_section_2", bands);
}

/// ∫ xⁱ dx from a to b.
fn power_integral([a, b]: [f64; 2], i: i32) -> f64 {
    (b.powi(i + 1) - a.powi(i + 1)) / f64::from(i + 1)
}

proptest! {
    #![proptest_config(common::config(128))]

    /// Any polynomial in x and y themselves, of either sign, its integral 0 or not.
    #[test]
    fn rectangle_exactly(
        rectangle in rectangles(),
        coefficients in prop::collection::vec((-1.0..1.0, 0..4i32, 0..4i32), 1..5),
    ) {
        let terms = coefficients.clone();
        let f = move |x: f64, y: f64| terms.iter().map(|(c, i, j)| c * x.powi(*i) * y.powi(*j)).sum::<f64>();
        let (x, y) = (rectangle.x_range(), rectangle.y_range());
        let term = |&(c, i, j): &(f64, i32, i32)| c * power_integral(x, i) * power_integral(y, j);
        let integral: f64 = coefficients.iter().map(term).sum();
        // E[(A f)²], by products of the terms
        let mut square = 0.0;
        for (c, i, j) in &coefficients {
            for (d, k, l) in &coefficients {
                square += c * d * power_integral(x, i + k) * power_integral(y, j + l);
            }
        }
        let variance = rectangle.area() * square - integral * integral;
        let [far_x, far_y] = [x, y].map(|[low, high]| low.abs().max(high.abs()));
        let most = |&(c, i, j): &(f64, i32, i32)| c.abs() * far_x.powi(i) * far_y.powi(j);
        let scale = rectangle.area() * coefficients.iter().map(most).sum::<f64>();
        let g = f.clone();
        assert_exactly(&rectangle.independent(&g), 2, integral, Some(variance), scale);
        assert_exactly(&f_over_p(move |[x, y]: &[f64; 2]| f(*x, *y), rectangle), 2, integral, Some(variance),
            scale);
        let one = exactly(&rectangle.all_pairs(&g, 1).unwrap(), 2);
        prop_assert!((one.unwrap().mean - integral).abs() <= 1e-9 * scale);
    }
}

// ---- section 3
// -----------------------------------------------------------------------------------------------------

/// A sky that depends on the direction in every way: c₀ + c₁ cos θ + c₂ cos^a θ + c₃ x² + c₄ (1 + y) + c₅
/// \[the half towards φ is lit\].
#[derive(Debug, Clone, Copy)]
struct Sky {
    parts: [f64; 6],
    a: f64,
    phi: f64,
}

impl Sky {
    fn at(&self, direction: &Direction) -> f64 {
        let [c0, c1, c2, c3, c4, c5] = self.parts;
        let [x, y, z] = direction.vector().to_array();
        let lit = x * self.phi.cos() + y * self.phi.sin() > 0.0;
        let power = CosinePower::new(self.a).unwrap().incoming(direction);
        c0 + c1 * z + c2 * power + c3 * x * x + c4 * (1.0 + y) + if lit { c5 } else { 0.0 }
    }

    /// ∫ L cos θ/π dω = ∫ L̄ 2z dz with L̄ the mean over φ: z gives 2/3, zᵃ 2/(a + 2), x² 1/4, y 0, a half
    /// 1/2.
    fn mean(&self) -> f64 {
        let [c0, c1, c2, c3, c4, c5] = self.parts;
        c0 + c1 * 2.0 / 3.0 + c2 * 2.0 / (self.a + 2.0) + c3 / 4.0 + c4 + c5 / 2.0
    }

    fn most(&self) -> f64 {
        let [c0, c1, c2, c3, c4, c5] = self.parts;
        c0 + c1 + c2 + c3 + 2.0 * c4 + c5
    }
}

/// Sixty-fourths of a turn.
fn turns() -> impl Strategy<Value = f64> + Clone {
    (0..64u32).prop_map(|turn| f64::from(turn) / 32.0 * PI)
}

fn skies() -> impl Strategy<Value = Sky> + Clone {
    let parts = prop_oneof![
        3 => prop::array::uniform6(0.0..1.0),
        // one alone
        2 => (0..6usize, 0.1..10.0).prop_map(|(only,
            c)| std::array::from_fn(|i| if i == only { c } else { 0.0 })),
    ];
    (parts, 0.0..6.0, turns()).prop_map(|(parts, a, phi)| Sky { parts, a, phi })
}

/// Skies with all of their parts, which vary little.
fn even_skies() -> impl Strategy<Value = Sky> + Clone {
    (prop::array::uniform6(0.2..1.0), 0.0..6.0, turns()).prop_map(|(parts, a, phi)| Sky { parts, a, phi })
}

fn albedos() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![4 => 0.01..1.0, 1 => Just(1.0)]
}

#[test]
fn lambertian_uniform() {
    certify("lambertian_uniform", (even_skies(), albedos()), |(sky, albedo)| {
        let cube = Lambertian::new(albedo).unwrap();
        case(cube.uniform_estimator(move |w| sky.at(w)), albedo * sky.mean(), 2.0 * albedo * sky.most())
    });
}

#[test]
fn lambertian_cosine() {
    certify("lambertian_cosine", (skies(), albedos()), |(sky, albedo)| {
        let cube = Lambertian::new(albedo).unwrap();
        case(cube.cosine_estimator(move |w| sky.at(w)), albedo * sky.mean(), albedo * sky.most())
    });
}

#[test]
fn lambertian_general() {
    certify("lambertian_general", (even_skies(), albedos(), any::<bool>()), |(sky, albedo, cosine)| {
        let cube = Lambertian::new(albedo).unwrap();
        let (density, times) = if cosine { (Hemisphere::Cosine, 1.0) } else { (Hemisphere::Uniform, 2.0) };
        let most = times * albedo * sky.most();
        case(cube.estimator(move |w: &Direction| sky.at(w), density), albedo * sky.mean(), most)
    });
}

/// All directions alike, those below the horizon too: p = 1/(4π).
#[derive(Debug, Clone, Copy)]
struct Sphere;

impl Density<2> for Sphere {
    type Point = Direction;

    fn warp(&self, [u, v]: [f64; 2]) -> Direction {
        Direction::polar(1.0 - 2.0 * u, 2.0 * PI * v).unwrap()
    }

    fn pdf(&self, _: &Direction) -> f64 {
        0.25 / PI
    }
}

#[test]
fn lambertian_over_the_whole_sphere() {
    certify("lambertian_over_the_whole_sphere", (even_skies(), albedos()), |(sky, albedo)| {
        let cube = Lambertian::new(albedo).unwrap();
        let most = 4.0 * albedo * sky.most();
        case(cube.estimator(move |w: &Direction| sky.at(w), Sphere), albedo * sky.mean(), most)
    });
}

/// Light that is found by chance: cosine directions hit the ring with probability ε² ≥ 0.04.
#[test]
fn lambertian_in_a_ring() {
    let rings = (0.2..1.0, albedos(), any::<bool>());
    certify("lambertian_in_a_ring", rings, |(width, albedo, cosine): (f64, f64, bool)| {
        let (cube, ring) = (Lambertian::new(albedo).unwrap(), RingLight::new(width).unwrap());
        let truth = albedo * width * width;
        if cosine {
            case(cube.cosine_estimator(move |w| ring.incoming(w)), truth, albedo)
        } else {
            case(cube.uniform_estimator(move |w| ring.incoming(w)), truth, 2.0 * albedo * width)
        }
    });
}

#[test]
fn samplers_of_section_3() {
    let mut bands = 0;
    for (i, hemisphere) in Hemisphere::ALL.into_iter().enumerate() {
        let seed = common::seed(900 + i as u64);
        let agreement = common::directions(&hemisphere, hemisphere, 0.005, ALPHA, seed).unwrap();
        assert!(agreement.agrees, "{hemisphere:?}: {agreement}");
        bands += 1;
    }
    compared("samplers_of_section_3", bands);
}

proptest! {
    #![proptest_config(common::config(6))]

    #[test]
    fn lambertian_exactly(albedo in albedos(), a in 0..12, width in 1..=64u32) {
        let (a, width) = (f64::from(a), f64::from(width) / 64.0);
        let cube = Lambertian::new(albedo).unwrap();
        // mean and variance of the two lights that have both, from E cos^k θ
        let power = CosinePower::new(a).unwrap();
        let truth = 2.0 * albedo / (a + 2.0);
        let square = albedo * albedo;
        let uniform = 4.0 * square / (2.0 * a + 3.0) - truth * truth;
        let cosine = square / (a + 1.0) - truth * truth;
        assert_exactly(&cube.uniform_estimator(|w| power.incoming(w)), 2, truth, Some(uniform), albedo);
        assert_exactly(&cube.cosine_estimator(|w| power.incoming(w)), 2, truth, Some(cosine), albedo);
        let ring = RingLight::new(width).unwrap();
        let truth = albedo * width * width;
        let uniform = 4.0 / 3.0 * square * width.powi(3) - truth * truth;
        let cosine = albedo * truth - truth * truth;
        assert_exactly(&cube.uniform_estimator(|w| ring.incoming(w)), 2, truth, Some(uniform), albedo);
        assert_exactly(&cube.cosine_estimator(|w| ring.incoming(w)), 2, truth, Some(cosine), albedo);
    }
}

// ---- section 4
// -----------------------------------------------------------------------------------------------------

/// Directions drawn uniformly or by cosine, and the light by chance or sampled.
fn ways() -> impl Strategy<Value = (Hemisphere, FindLight)> + Clone {
    (prop::sample::select(Hemisphere::ALL.to_vec()), prop::sample::select(FindLight::ALL.to_vec()))
}

/// The largest cos θ/(π p(ω)).
fn most_weight(directions: Hemisphere) -> f64 {
    if directions == Hemisphere::Cosine { 1.0 } else { 2.0 }
}

/// The worksheet's room with other albedos and another radiance.
fn rooms() -> impl Strategy<Value = Scene> + Clone {
    (0.05..1.0, 0.05..1.0, log_range(1e-2, 1e2)).prop_map(|(wall_albedo, cube_albedo, radiance)| Scene {
        wall_albedo,
        cube_albedo,
        radiance,
        ..Scene::default()
    })
}

fn paths(scene: Scene, bounces: Bounces, (directions, light): (Hemisphere, FindLight)) -> Paths {
    Paths::new(BoxRoom::new(scene).unwrap(), bounces, directions, light).unwrap()
}

/// From anywhere on the cube's top, 3 m below the light: f_r L_e A cos θ cos θ′/r² ≤ ρ L_e A/9π. The truth is
/// a sum of four rectangles that have a corner above p (Howell's B-3).
#[test]
fn paths_of_one_bounce() {
    let places = (-0.5..0.5, -0.5..0.5, 0.8..2.0);
    let corner = |a: f64, b: f64| {
        let (a, b) = (a / 3.0, b / 3.0);
        let (sa, sb) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
        (a / sa * (b / sa).atan() + b / sb * (a / sb).atan()) / (2.0 * PI)
    };
    certify(
        "paths_of_one_bounce",
        (rooms(), places, ways(), any::<bool>()),
        |(room, (x, y, h), way, up_to)| {
            let (x, y, h): (f64, f64, f64) = (x, y, h);
            let scene = Scene { light_half_width: h, point: [x, y, 1.0], ..room };
            let part =
                corner(h - x, h - y) + corner(h + x, h - y) + corner(h - x, h + y) + corner(h + x, h + y);
            let scale = scene.cube_albedo * scene.radiance;
            let most = match way.1 {
                FindLight::ByChance => most_weight(way.0),
                FindLight::BySampling => 4.0 * h * h / (9.0 * PI),
            };
            // p itself emits nothing
            let bounces = if up_to { Bounces::UpTo(1) } else { Bounces::Exactly(1) };
            case(paths(scene, bounces, way), scale * part, scale * most)
        },
    );
}

/// Anywhere on the cube's top, with a light of half-width `h`.
fn any_room(h: std::ops::Range<f64>) -> impl Strategy<Value = Scene> + Clone {
    (rooms(), -0.5..0.5, -0.5..0.5, h).prop_map(|(scene, x, y, light_half_width)| Scene {
        light_half_width,
        point: [x, y, 1.0],
        ..scene
    })
}

/// By the quadrature of the closed form, which tests/box_room.rs holds to another's.
fn two_bounces(scene: Scene) -> f64 {
    BoxRoom::new(scene).unwrap().two_bounces().unwrap()
}

/// f_r L_e A cos θ cos θ′/r² at a wall, a = 2 − h or more from the light, where cos θ cos θ′/r² is az/(a² +
/// z²)² at most, and that at most 0.325/a². With ρ L_e for the cube's.
fn most_of_two_bounces(scene: Scene, directions: Hemisphere) -> f64 {
    let (h, scale) = (scene.light_half_width, scene.cube_albedo * scene.wall_albedo * scene.radiance);
    scale * most_weight(directions) * 4.0 * h * h / PI * 0.325 / (2.0 - h).powi(2)
}

#[test]
fn paths_of_two_bounces() {
    certify("paths_of_two_bounces", (any_room(0.3..1.3), ways()), |(scene, (directions, _))| {
        let twice = paths(scene, Bounces::Exactly(2), (directions, FindLight::BySampling));
        case(twice, two_bounces(scene), most_of_two_bounces(scene, directions))
    });
}

/// Lights that are found often enough.
#[test]
fn paths_of_two_bounces_by_chance() {
    certify("paths_of_two_bounces_by_chance", (any_room(1.4..2.0), ways()), |(scene, (directions, _))| {
        let scale = scene.cube_albedo * scene.wall_albedo * scene.radiance;
        let twice = paths(scene, Bounces::Exactly(2), (directions, FindLight::ByChance));
        case(twice, two_bounces(scene), scale * most_weight(directions).powi(2))
    });
}

/// ρᵏ after k bounces; up to K of them X ≤ Σ (2ρ)ᵏ, and q/(q − ρ) for all with cosine directions.
#[test]
fn paths_in_a_furnace() {
    let parameters = (0.05..0.9, 0..5u32, ways(), 0.3..0.9, 0..3u32);
    certify("paths_in_a_furnace", parameters, |(albedo, k, way, part, which): (f64, u32, _, f64, u32)| {
        let scene = Scene {
            wall_albedo: albedo,
            cube_albedo: albedo,
            light_half_width: 0.0,
            emission: 1.0,
            ..Scene::default()
        };
        let most = albedo * most_weight(way.0);
        match which {
            0 => case(paths(scene, Bounces::Exactly(k), way), albedo.powi(k as i32), most.powi(k as i32)),
            1 => {
                let sum = |x: f64| (0..=k as i32).map(|j| x.powi(j)).sum();
                case(paths(scene, Bounces::UpTo(k), way), sum(albedo), sum(most))
            }
            _ => {
                let q = (albedo + part * (1.0 - albedo)).min(0.99);
                let all = paths(scene, Bounces::All(q), (Hemisphere::Cosine, way.1));
                case(all, 1.0 / (1.0 - albedo), q / (q - albedo))
            }
        }
    });
}

/// Draws cut off at `most`, drawn one by one or filled many at a time.
struct CutOff {
    paths: Paths,
    most: f64,
    filled: bool,
}

impl Estimator for CutOff {
    fn draw(&self, rng: &mut Stream) -> f64 {
        self.paths.draw(rng).min(self.most)
    }

    fn fill(&self, rng: &mut Stream, draws: &mut [f64]) {
        if self.filled {
            self.paths.fill(rng, draws);
        } else {
            draws.iter_mut().for_each(|draw| *draw = self.paths.draw(rng));
        }
        draws.iter_mut().for_each(|draw| *draw = draw.min(self.most));
    }
}

/// The worksheet's, and others.
fn albedos_of_furnaces() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![prop::sample::select(vec![0.2, 0.5, 0.8, 0.99]), 0.05..0.95]
}

/// All light by roulette: X ≤ Σ (wρ/q)ʲ = q/(q − wρ) for q > wρ, w = 1 with cosine directions and 2 with
/// uniform ones, which are taken where that leaves room for q.
#[test]
fn furnaces_by_roulette() {
    let parameters = (albedos_of_furnaces(), ways(), 0.2..0.9, any::<bool>());
    certify("furnaces_by_roulette", parameters, |(albedo, (directions, light), part, filled)| {
        let directions = if albedo < 0.35 { directions } else { Hemisphere::Cosine };
        let largest = albedo * most_weight(directions);
        let q = largest + part * (1.0 - largest);
        let paths = paths(furnace(albedo), Bounces::All(q), (directions, light));
        let most = q / (q - largest);
        case(CutOff { paths, most: f64::INFINITY, filled }, 1.0 / (1.0 - albedo), most)
    });
}

/// All light by weight: with cosine directions a path goes on with probability ρ and weight 1, so a draw is
/// the number of its vertices, P(X > j) = ρʲ, and E min(X, c) = Σ ρʲ for j < c.
#[test]
fn furnaces_by_weight() {
    let parameters = (albedos_of_furnaces(), ways(), 1..9i32, any::<bool>());
    certify("furnaces_by_weight", parameters, |(albedo, (_, light), cut, filled)| {
        let paths = paths(furnace(albedo), Bounces::AllByThroughput, (Hemisphere::Cosine, light));
        let truth = (0..cut).map(|j| albedo.powi(j)).sum();
        case(CutOff { paths, most: cut.into(), filled }, truth, cut.into())
    });
}

/// 4.3 with the direct light at p_j plugged in, known or estimated.
#[test]
fn reflected_light() {
    let parameters = (any_room(0.3..1.3), ways(), any::<bool>());
    certify("reflected_light", parameters, |(scene, (directions, _), known)| {
        let room = BoxRoom::new(scene).unwrap();
        let once = paths(scene, Bounces::Exactly(1), (directions, FindLight::BySampling));
        let outgoing =
            move |p_j: &_, rng: &mut _| if known { room.direct(p_j) } else { once.light_from(p_j, rng) };
        let most = most_of_two_bounces(scene, directions);
        case(reflected(room, directions, outgoing), two_bounces(scene), most)
    });
}

// ---- section 5
// -----------------------------------------------------------------------------------------------------

#[test]
fn roulette_on_an_estimator() {
    certify("roulette_on_an_estimator", (polynomials(), 0.5..1.0), |(f, p)| {
        let x = f.rectangle.independent(move |x, y| f.at(x, y));
        case(Roulette::new(p).unwrap().wrap(x), f.integral(), f.most() / p)
    });
}

#[test]
fn roulette_that_seldom_goes_on() {
    certify("roulette_that_seldom_goes_on", (polynomials(), log_range(0.1, 0.5)), |(f, p)| {
        let x = f.rectangle.independent(move |x, y| f.at(x, y));
        case(Roulette::new(p).unwrap().wrap(x), f.integral(), f.most() / p)
    });
}

/// \[N = k\] for k < 3, of mean pᵏ(1 − p), or min(N, c), of mean p + p² + … + p^c.
fn bounces(n: impl Estimator + 'static, p: f64, k: i32, exact: bool) -> Case {
    if exact {
        let hit = move |n: f64| f64::from(u8::from(n == f64::from(k)));
        case(from_fn(move |rng| hit(n.draw(rng))), p.powi(k) * (1.0 - p), 1.0)
    } else {
        let cut = k + 2;
        let truth = (1..=cut).map(|j| p.powi(j)).sum();
        case(from_fn(move |rng| n.draw(rng).min(cut.into())), truth, cut.into())
    }
}

fn of_bounces() -> impl Strategy<Value = (f64, i32, bool)> + Clone {
    (0.3..0.85, 0..3, any::<bool>())
}

#[test]
fn bounces_by_simulation() {
    certify("bounces_by_simulation", of_bounces(), |(p, k, exact)| {
        bounces(Roulette::new(p).unwrap().bounces().by_simulation().unwrap(), p, k, exact)
    });
}

#[test]
fn bounces_by_inversion() {
    certify("bounces_by_inversion", of_bounces(), |(p, k, exact)| {
        bounces(Roulette::new(p).unwrap().bounces().by_inversion().unwrap(), p, k, exact)
    });
}

#[test]
fn samplers_of_section_5() {
    let mut bands = 0;
    for (i, p) in [0.2, 0.5, 0.83, 0.99].into_iter().enumerate() {
        let roulette = Roulette::new(p).unwrap();
        let cdf = |n: f64| if n < 0.0 { 0.0 } else { 1.0 - p.powf(n.floor() + 1.0) };
        let (one, other) =
            (roulette.bounces().by_simulation().unwrap(), roulette.bounces().by_inversion().unwrap());
        let samplers: [&dyn Estimator; 2] = [&one, &other];
        for (j, sampler) in samplers.into_iter().enumerate() {
            let seed = common::seed(1000 + 10 * i as u64 + j as u64);
            let agreement = distributed_as(sampler, cdf, 0.01, ALPHA, seed).unwrap();
            assert!(agreement.agrees, "p = {p}, {j}: {agreement}");
            bands += 1;
        }
    }
    compared("samplers_of_section_5", bands);
}

/// Vertices that see the light with probability v, the k-th worth ρᵏ. v = 1 is a furnace.
fn visibilities() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![3 => 0.3..1.0, 1 => Just(1.0)]
}

#[test]
fn truncated_paths() {
    certify(
        "truncated_paths",
        (0.05..0.95, visibilities(), 0..8u64),
        |(albedo, visibility, max_k): (f64, f64, u64)| {
            let most: f64 = (0..=max_k as i32).map(|k| albedo.powi(k)).sum();
            let paths = LightModel::new(albedo, visibility).unwrap().truncated(max_k).unwrap();
            case(paths, visibility * most, most)
        },
    );
}

/// q between ρ and 1: X ≤ Σ (ρ/q)ᵏ = q/(q − ρ).
#[test]
fn roulette_paths_with_falling_weights() {
    let parameters = (0.05..0.8, visibilities(), 0.15..0.85);
    certify("roulette_paths_with_falling_weights", parameters, |(albedo, visibility, part)| {
        let q = albedo + part * (1.0 - albedo);
        let paths = LightModel::new(albedo, visibility).unwrap().roulette(q).unwrap();
        case(paths, visibility / (1.0 - albedo), q / (q - albedo))
    });
}

/// The probability that a path of roulette sees any light: v/(1 − q(1 − v)).
fn sees_light(visibility: f64, q: f64) -> f64 {
    visibility / (1.0 - q * (1.0 - visibility))
}

/// q = ρ: X counts the vertices that see the light, P(X ≥ j) = r(qr)^(j−1), and E min(X, c) is the sum of
/// these over j ≤ c.
#[test]
fn roulette_paths_with_constant_weights() {
    let parameters = (0.05..0.9, visibilities(), 1..8i32);
    certify("roulette_paths_with_constant_weights", parameters, |(q, visibility, cut)| {
        let paths = LightModel::new(q, visibility).unwrap().roulette(q).unwrap();
        let r = sees_light(visibility, q);
        let truth = (0..cut).map(|j| r * (q * r).powi(j)).sum();
        case(from_fn(move |rng| paths.draw(rng).min(cut.into())), truth, cut.into())
    });
}

/// q < ρ: draws have no bound, and every weight is 1 or more, so min(X, 1) = \[X > 0\].
#[test]
fn roulette_paths_with_growing_weights() {
    let parameters = (0.1..0.95, visibilities(), 0.1..0.95);
    certify("roulette_paths_with_growing_weights", parameters, |(albedo, visibility, part)| {
        let q = part * albedo;
        let paths = LightModel::new(albedo, visibility).unwrap().roulette(q).unwrap();
        case(from_fn(move |rng| paths.draw(rng).min(1.0)), sees_light(visibility, q), 1.0)
    });
}

proptest! {
    #![proptest_config(common::config(64))]

    /// The coin is one number, X another: E X = 1, E X² = 9/5 for X = 3U².
    #[test]
    fn roulette_exactly(p in 1..=64u32) {
        let p = f64::from(p) / 64.0;
        let x = from_fn(|rng| 3.0 * rng.uniform().powi(2));
        let variance = 9.0 / 5.0 / p - 1.0;
        assert_exactly(&Roulette::new(p).unwrap().wrap(x), 2, 1.0, Some(variance), 1.0 / p);
    }

    /// min(N, c) by inversion is a staircase of one number.
    #[test]
    fn bounces_by_inversion_exactly(m in 1..4i32, cut in 1..8i32) {
        let p = 0.5f64.powi(m);
        let n = Roulette::new(p).unwrap().bounces().by_inversion().unwrap();
        let mean: f64 = (1..=cut).map(|j| p.powi(j)).sum();
        // E min(N, c)² = Σ (2j − 1) P(N ≥ j)
        let square: f64 = (1..=cut).map(|j| f64::from(2 * j - 1) * p.powi(j)).sum();
        let cut_off = from_fn(|rng| n.draw(rng).min(cut.into()));
        assert_exactly(&cut_off, 1, mean, Some(square - mean * mean), f64::from(cut));
    }
}
