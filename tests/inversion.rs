//! Section 1: closed forms, samplers against their cdf, and the inversion of any cdf.

mod common;

use approx::assert_relative_eq;
use common::Stuck;
use proptest::prelude::*;
use rand::distr::Distribution;
use statrs::distribution::{
    Beta, Binomial, ContinuousCDF, DiscreteCDF, Exp, Gamma, Normal, Poisson, Weibull,
};
use unbiased::inversion::{Exponential, Inversion};
use unbiased::{Budget, Error, Estimate, Estimator, Stream, estimate, from_fn};

const RATES: [f64; 4] = [0.37, 1.0, 2.5, 41.0];

fn exponential(rate: f64) -> Exponential {
    Exponential::new(rate).unwrap()
}

#[test]
fn a_rate_is_kept() {
    for rate in [0.37, 1e-300, 1e300] {
        let exponential = Exponential::new(rate).unwrap();
        assert_eq!((exponential.rate(), exponential.mean()), (rate, 1.0 / rate));
        assert_relative_eq!(exponential.variance(), 1.0 / rate / rate, max_relative = 1e-15);
    }
}

#[test]
fn closed_forms_agree_with_another_library() {
    for rate in RATES {
        let (ours, theirs) = (exponential(rate), Exp::new(rate).unwrap());
        for i in 0..400 {
            let x = f64::from(i) / 20.0;
            use statrs::distribution::Continuous;
            assert_relative_eq!(ours.pdf(x), theirs.pdf(x), epsilon = 1e-300, max_relative = 1e-13);
            assert_relative_eq!(ours.survival(x), theirs.sf(x), epsilon = 1e-300, max_relative = 1e-13);
            // theirs cancels: its relative error grows as 1/F
            assert_relative_eq!(ours.cdf(x), theirs.cdf(x), epsilon = 3e-16, max_relative = 1e-13);
        }
        assert_eq!((ours.pdf(-1.0), ours.cdf(-1.0), ours.survival(-1.0)), (0.0, 0.0, 1.0));
    }
}

/// Values to 17 digits from arbitrary-precision arithmetic, where the obvious formulas fail.
#[test]
fn closed_forms_hold_at_the_extremes() {
    let one = exponential(1.0);
    let close =
        |value: f64, truth: f64| assert_relative_eq!(value, truth, epsilon = 0.0, max_relative = 4e-16);
    assert_eq!(one.cdf(1e-17), 1e-17); // 1 − e^(−x) is 0 here
    close(one.cdf(1e-8), 9.99999995000000038e-9);
    close(one.survival(700.0), 9.85967654375977086e-305);
    close(exponential(0.7).survival(1000.0), 9.85967654376020871e-305);
    close(one.inverse_cdf(1e-20).unwrap(), 1e-20); // 1 − u rounds to 1 here
    close(one.inverse_cdf(0.75).unwrap(), 1.386_294_361_119_890_6);
    close(one.inverse_cdf(1.0 - f64::EPSILON / 2.0).unwrap(), 36.7368005696771014);
    assert_eq!(one.inverse_cdf(0.0).unwrap().to_bits(), 0);
    assert_eq!(one.inverse_cdf(1.0).unwrap(), f64::INFINITY);
    // e^(−750) is no f64, but 1e300 times it is
    close(exponential(1e300).pdf(7.5e-298), 1.90168496347495581e-26);
    for u in [-1e-300, 1.0 + f64::EPSILON, f64::NAN, f64::INFINITY] {
        assert!(matches!(one.inverse_cdf(u), Err(Error::Parameter { .. })), "{u}");
    }
}

#[test]
fn a_rate_that_is_not_positive_and_finite_is_an_error() {
    for rate in [0.0, -0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let error = Exponential::new(rate).unwrap_err();
        assert!(error.to_string().starts_with("the rate λ must be positive and finite, not "), "{error}");
    }
}

#[test]
fn the_tail_ends_where_the_grid_of_uniform_numbers_ends() {
    let one = exponential(1.0);
    let last: f64 = one.sample(&mut Stuck(u64::MAX));
    let first: f64 = one.sample(&mut Stuck(0));
    assert_relative_eq!(last, 53.0 * 2f64.ln(), epsilon = 0.0, max_relative = 1e-15);
    assert_eq!(first.to_bits(), 0);
    let last: f32 = one.sample(&mut Stuck(u64::MAX));
    let first: f32 = one.sample(&mut Stuck(0));
    assert_relative_eq!(last, 24.0 * 2f32.ln(), epsilon = 0.0, max_relative = 1e-6);
    assert_eq!(first.to_bits(), 0);
}

/// Drawing's −ln(1 − u) and the closed form's −ln_1p(−u) agree on the whole grid.
#[test]
fn drawing_is_the_inverse_cdf_of_the_streams_uniform_number() {
    for rate in RATES {
        let exponential = exponential(rate);
        let mut rng = Stream::new(common::seed(13), 0);
        for _ in 0..10_000 {
            let u = rng.clone().uniform();
            let drawn: f64 = exponential.sample(&mut rng);
            assert_relative_eq!(
                drawn,
                exponential.inverse_cdf(u).unwrap(),
                epsilon = 0.0,
                max_relative = 4e-16
            );
        }
    }
}

/// Against the library's logarithm, at most 3 ulp apart (1 of the logarithm, ½ each of 1/λ, product, quotient
/// and library).
#[test]
fn filling_is_the_formula_to_rounding() {
    for rate in [0.37, 1.0, 1e-300, 1e300, 5e-308, 1e308, f64::MIN_POSITIVE, f64::MAX] {
        let [mut uniforms, mut filled] = [[0.0f64; 1003]; 2];
        common::fill_uniform(&mut Stream::new(common::seed(18), 0), &mut uniforms);
        exponential(rate).fill(&mut Stream::new(common::seed(18), 0), &mut filled);
        for (draw, u) in filled.into_iter().zip(uniforms) {
            let plain = (1.0 - u).ln().abs() / rate;
            let ulp = plain.next_up() - plain;
            // the smallest rates overflow, in both
            let same = draw == plain || (draw - plain).abs() <= 3.0 * ulp;
            assert!(same, "{draw:?} and {plain:?} at rate {rate:?}");
        }
    }
    // at both ends of the grid
    let mut ends = [0.0; 2];
    exponential(1.0).fill(&mut Stream::scripted(&[0.0, 1.0]), &mut ends);
    assert_eq!(ends[0].to_bits(), 0);
    assert!((ends[1] - 53.0 * std::f64::consts::LN_2).abs() <= 1e-14);
}

#[test]
fn a_seeds_samples_are_pinned() {
    let exponential = exponential(0.37);
    let mut rng = Stream::new(1, 0);
    // xoshiro256++ by a separate program, then −ln(1 − u)/0.37 in arbitrary precision
    for expected in PINNED {
        let drawn: f64 = exponential.sample(&mut rng);
        assert_relative_eq!(drawn, expected, epsilon = 0.0, max_relative = 4.5e-16);
    }
    let mut filled = [0.0; 4];
    exponential.fill(&mut Stream::new(1, 0), &mut filled);
    for (drawn, expected) in filled.into_iter().zip(PINNED_SIDE_BY_SIDE) {
        assert_relative_eq!(drawn, expected, epsilon = 0.0, max_relative = 4.5e-16);
    }
}

/// By the separate program of tests/run.rs, in arbitrary precision.
const PINNED_SIDE_BY_SIDE: [f64; 4] =
    [5.89772504818437529, 1.98036020057545329, 1.53693399974574011, 0.00256353937746083979];

const PINNED: [f64; 4] =
    [5.89772504818437529, 0.102851870941505049, 0.5664273381881057, 0.0777114858129562474];

/// F⁻(u) is the smallest number at which the cdf reaches u: F there, but not just below.
fn is_generalised_inverse(cdf: impl Fn(f64) -> f64, x: f64, u: f64) -> bool {
    cdf(x) >= u && cdf(x.next_down()) < u
}

const PROBABILITIES: [f64; 11] = [1e-12, 1e-6, 0.001, 0.05, 0.2, 0.5, 0.7, 0.9, 0.99, 0.999_999, 1.0 - 1e-12];

/// Against the definition at every probability, and against statrs' own quantiles where those are good: in
/// the far tail its Gamma stops at 1e-9 where the quantile is 1e-20, elsewhere they hold to about 1e-9.
#[test]
fn any_smooth_cdf_is_inverted() {
    let normal = Normal::new(-1.3, 2.5).unwrap();
    let gamma = Gamma::new(0.61, 0.37).unwrap();
    let beta = Beta::new(0.83, 4.1).unwrap();
    let weibull = Weibull::new(1.7, 4.1).unwrap();
    let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
    check_smooth("Normal", |x| normal.cdf(x), |u| normal.inverse_cdf(u), everywhere);
    check_smooth("Gamma", |x| gamma.cdf(x), |u| gamma.inverse_cdf(u), [0.0, f64::INFINITY]);
    check_smooth("Beta", |x| beta.cdf(x), |u| beta.inverse_cdf(u), [0.0, 1.0]);
    check_smooth("Weibull", |x| weibull.cdf(x), |u| weibull.inverse_cdf(u), [0.0, f64::INFINITY]);
}

fn check_smooth(name: &str, cdf: impl Fn(f64) -> f64, quantile: impl Fn(f64) -> f64, support: [f64; 2]) {
    let inversion = Inversion::new(&cdf, support).unwrap();
    for u in PROBABILITIES {
        let x = inversion.inverse_cdf(u).unwrap();
        assert!(is_generalised_inverse(&cdf, x, u), "{name}: F⁻({u}) = {x}, F there is {}", cdf(x));
        if (0.001..=0.999).contains(&u) {
            assert_relative_eq!(x, quantile(u), epsilon = 0.0, max_relative = 1e-8);
        }
    }
}

#[test]
fn jumps_and_flats_are_nothing_special() {
    let binomial = Binomial::new(0.83, 20).unwrap();
    let poisson = Poisson::new(4.1).unwrap();
    let of_binomial = |x: f64| if x < 0.0 { 0.0 } else { binomial.cdf(x as u64) };
    let of_poisson = |x: f64| if x < 0.0 { 0.0 } else { poisson.cdf(x as u64) };
    let binomial_inverse = Inversion::new(of_binomial, [0.0, 20.0]).unwrap();
    let poisson_inverse = Inversion::new(of_poisson, [0.0, 1e6]).unwrap();
    let mut rng = Stream::new(common::seed(14), 0);
    for u in PROBABILITIES.into_iter().chain((0..500).map(|_| rng.uniform())) {
        assert_eq!(binomial_inverse.inverse_cdf(u).unwrap(), binomial.inverse_cdf(u) as f64, "{u}");
        assert_eq!(poisson_inverse.inverse_cdf(u).unwrap(), poisson.inverse_cdf(u) as f64, "{u}");
    }
    // exactly at a step the lower value is the answer, and just above it the next one
    let at_step = of_binomial(15.0);
    assert_eq!(binomial_inverse.inverse_cdf(at_step).unwrap(), 15.0);
    assert_eq!(binomial_inverse.inverse_cdf(at_step.next_up()).unwrap(), 16.0);

    // half an atom at 0, a gap, then uniform on [2, 3]
    let mixed = |x: f64| match x {
        x if x < 0.0 => 0.0,
        x if x < 2.0 => 0.5,
        x => (0.5 + 0.5 * (x - 2.0)).min(1.0),
    };
    let inversion = Inversion::new(mixed, [-5.0, 5.0]).unwrap();
    for (u, x) in [(1e-9, 0.0), (0.5, 0.0), (0.75, 2.5), (1.0, 3.0), (0.0, -5.0)] {
        assert_eq!(inversion.inverse_cdf(u).unwrap(), x, "{u}");
    }
    let above = inversion.inverse_cdf(0.5f64.next_up()).unwrap();
    assert!((2.0..2.0 + 1e-15).contains(&above), "{above}");
}

/// The cdf of weights w₁, w₂, … at 1, 2, …, as one sums them.
fn cumulated(mut weights: Vec<f64>) -> impl Fn(f64) -> f64 {
    for i in 1..weights.len() {
        weights[i] += weights[i - 1];
    }
    move |x: f64| if x < 1.0 { 0.0 } else { weights[(x as usize).min(weights.len()) - 1] }
}

/// The first k at which summed weights reach u, or their last value where they end an ulp or two below u.
fn first_to_reach(cdf: impl Fn(f64) -> f64, n: usize, u: f64) -> f64 {
    let u = u.min(cdf(n as f64));
    (1..=n).map(|k| k as f64).find(|k| cdf(*k) >= u).unwrap()
}

/// n times 1/n is 1 - 2⁻⁵³, 1 or 1 + 2⁻⁵², or further off: no less a cdf for it.
#[test]
fn summed_weights_are_a_cdf() {
    let mut ends = [0, 0, 0];
    for n in 2..200 {
        let cdf = cumulated(vec![1.0 / n as f64; n]);
        let last = cdf(n as f64);
        ends[if last < 1.0 { 0 } else { 1 + usize::from(last > 1.0) }] += 1;
        for support in [[1.0, n as f64], [0.0, 300.0], [f64::NEG_INFINITY, f64::INFINITY]] {
            let inversion = Inversion::new(&cdf, support).unwrap();
            let grid = (1..2 * n).map(|i| i as f64 / (2 * n) as f64);
            for u in grid.chain([0.5f64.powi(54), 1.0 - 0.5f64.powi(53), 1.0]) {
                assert_eq!(
                    inversion.inverse_cdf(u).unwrap(),
                    first_to_reach(&cdf, n, u),
                    "{n} {support:?} {u}"
                );
            }
            assert_eq!(inversion.inverse_cdf(0.0).unwrap(), support[0]);
            let last: f64 = inversion.sample(&mut Stuck(u64::MAX));
            assert_eq!(last, n as f64);
        }
    }
    assert!(ends.iter().all(|count| *count > 0), "{ends:?}");
}

/// A shortfall, an excursion or a fall is rounding up to 2⁻⁴⁰, and a fault beyond.
#[test]
fn rounding_is_forgiven_to_one_part_in_two_to_the_forty() {
    let share = 0.5f64.powi(40);
    // uniform on [0, 10], but for an end below or above 1, a start below 0, or a fall at the end
    let faults: [fn(f64, f64) -> f64; 4] = [
        |x, off| 0.1 * x * (1.0 - off),
        |x, off| if x < 9.0 { 0.1 * x } else { 1.0 + off },
        |x, off| if x < 1.0 { -off } else { 0.1 * x },
        |x, off| if x < 9.0 { 0.1 * x } else { 1.0 - if x < 10.0 { 0.0 } else { off } },
    ];
    for (i, fault) in faults.into_iter().enumerate() {
        for u in [0.5, 1.0 - 0.5f64.powi(53), 1.0] {
            let invert = |off| Inversion::new(|x| fault(x, off), [0.0, 10.0])?.inverse_cdf(u);
            assert!((0.0..=10.0).contains(&invert(0.9 * share).unwrap()), "{i} {u}");
        }
        let nearly = Inversion::new(|x| fault(x, 0.9 * share), [0.0, 10.0]).unwrap();
        assert_eq!(nearly.inverse_cdf(0.0).unwrap(), 0.0, "{i}");
        let (reason, u) =
            [("never reaches 1", 1.0), ("outside [0, 1]", 0.5), ("outside [0, 1]", 0.5), ("falls", 0.95)][i];
        let invert = |off| Inversion::new(|x| fault(x, off), [0.0, 10.0])?.inverse_cdf(u);
        let error = invert(1.1 * share).unwrap_err().to_string();
        assert!(error.contains(reason), "{i}: {error}");
    }
}

const EVERYWHERE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

type Law = (fn(f64) -> f64, [f64; 2]);

/// Laws as one writes them down, which are ∞·0 or ∞/∞ at the largest numbers: Gamma of shape 2 and 3, the
/// logistic one twice, and a Gamma to the left.
const NAN_FAR_OUT: [Law; 5] = [
    (|x| 1.0 - (1.0 + x) * (-x).exp(), [0.0, f64::INFINITY]),
    (|x| 1.0 - (1.0 + x + 0.5 * x * x) * (-x).exp(), [0.0, f64::INFINITY]),
    (|x| x.exp() / (1.0 + x.exp()), EVERYWHERE),
    (|x| 0.5 + 0.5 * (0.5 * x).sinh() / (0.5 * x).cosh(), EVERYWHERE),
    (|x| (1.0 - x + 0.5 * x * x) * x.exp(), [f64::NEG_INFINITY, 0.0]),
];

/// What is asked for at the ends of the unit interval, too.
fn probabilities() -> impl Iterator<Item = f64> {
    PROBABILITIES.into_iter().chain([0.5f64.powi(54), 1.0 - 0.5f64.powi(53), 1.0])
}

#[test]
fn a_cdf_is_not_asked_at_infinity_nor_where_it_is_nan_beyond_the_last_sample() {
    for (i, (cdf, support)) in NAN_FAR_OUT.into_iter().enumerate() {
        let asked = |x: f64| {
            assert!(x.is_finite(), "law {i} is asked at {x}");
            cdf(x)
        };
        let inversion = Inversion::new(asked, support).unwrap();
        for u in probabilities() {
            let x = inversion.inverse_cdf(u).unwrap();
            assert!(is_generalised_inverse(cdf, x, u), "law {i}: F⁻({u}) = {x}, F there is {}", cdf(x));
        }
        assert_eq!(inversion.inverse_cdf(0.0).unwrap(), support[0]);
        let found = estimate(&from_fn(|rng| inversion.sample(rng)), Budget::Draws(1000), 1).unwrap();
        assert!(found.mean().is_finite());
    }
    // median of (1 + x) e^(−x) = 1/2, by bisection in arbitrary precision
    let (cdf, support) = NAN_FAR_OUT[0];
    let median = Inversion::new(cdf, support).unwrap().inverse_cdf(0.5).unwrap();
    assert_relative_eq!(median, 1.678_346_990_016_660_7, epsilon = 0.0, max_relative = 1e-15);
}

/// A tail so heavy that it leaves f64: its far quantiles are +∞, the nearer ones what they are.
#[test]
fn the_heaviest_tails_end_at_infinity() {
    // NaN at both infinities
    let right = |x: f64| 1.0 - (x / x) / x.ln();
    let inversion = Inversion::new(right, [std::f64::consts::E, f64::INFINITY]).unwrap();
    // F⁻(0.9) = e¹⁰, to the slope's share of F's rounding
    assert_relative_eq!(inversion.inverse_cdf(0.9).unwrap(), 10f64.exp(), max_relative = 1e-13);
    for u in [0.9999, 1.0] {
        assert_eq!(inversion.inverse_cdf(u).unwrap(), f64::INFINITY);
    }
    // nearly all of it out there: F(1.8e308) = 8.9e-16
    let slow = exponential(5e-324);
    let inversion = Inversion::new(|x| slow.cdf(x), [0.0, f64::INFINITY]).unwrap();
    assert_eq!(inversion.inverse_cdf(0.5).unwrap(), f64::INFINITY);
    assert_relative_eq!(inversion.inverse_cdf(1e-16).unwrap(), 1e-16 / 5e-324, max_relative = 1e-15);
    let left = |x: f64| (x / x) / (-x).ln();
    let inversion = Inversion::new(left, [f64::NEG_INFINITY, -std::f64::consts::E]).unwrap();
    assert_relative_eq!(inversion.inverse_cdf(0.1).unwrap(), -10f64.exp(), max_relative = 1e-13);
    assert_eq!(inversion.inverse_cdf(1e-4).unwrap(), -f64::MAX);
}

/// A jump at 0 is one at 0 and not at −0, which prints as "-0", whichever of the two the support ends at.
#[test]
fn zero_has_no_sign() {
    let jump = |x: f64| f64::from(u8::from(x >= 0.0));
    let line = |x: f64| 0.1 * x.max(0.0);
    for support in
        [[-5.0, 5.0], [-0.0, 5.0], [0.0, 5.0], [-5.0, -0.0], [-5.0, 0.0], [-0.0, f64::INFINITY], EVERYWHERE]
    {
        let inversion = Inversion::new(jump, support).unwrap();
        for u in probabilities() {
            assert_eq!(inversion.inverse_cdf(u).unwrap().to_bits(), 0, "{support:?} {u}");
        }
    }
    assert_eq!(Inversion::new(line, [-0.0, 10.0]).unwrap().inverse_cdf(0.0).unwrap().to_bits(), 0);
}

#[test]
fn constant_cdfs_are_atoms_or_refused() {
    // an atom at the lower end, all of the mass or half of it
    for (share, support) in [(1.0, [-3.0, 10.0]), (1.0, [-3.0, f64::INFINITY]), (0.5, [-3.0, 10.0])] {
        let inversion = Inversion::new(|_| share, support).unwrap();
        for u in probabilities().filter(|u| *u <= share) {
            assert_eq!(inversion.inverse_cdf(u).unwrap(), -3.0, "{share} {u}");
        }
    }
    let never = |share: f64| Inversion::new(move |_| share, [-3.0, 10.0])?.inverse_cdf(0.7);
    for share in [0.0, 0.5] {
        let error = never(share).unwrap_err().to_string();
        assert!(
            error.contains("at the support's upper end 10.0") && error.contains("never reaches 0.7"),
            "{error}"
        );
    }
    let refused = |cdf: &dyn Fn(f64) -> f64, support, reason: &str| {
        let error = Inversion::new(cdf, support).map(|_| ()).unwrap_err().to_string();
        assert!(error.starts_with("the function given is not a cdf: ") && error.contains(reason), "{error}");
    };
    for (share, support, end) in [
        (0.0, [-3.0, f64::INFINITY], "towards inf it stays at 0"),
        (0.5, [-3.0, f64::INFINITY], "towards inf it stays at 0.5"),
        (0.5, [f64::NEG_INFINITY, 10.0], "towards -inf it stays at 0.5"),
        (0.5, EVERYWHERE, "towards -inf it stays at 0.5"),
        (1.0, EVERYWHERE, "towards -inf it stays at 1"),
        (0.0, EVERYWHERE, "towards inf it stays at 0"),
    ] {
        refused(&|_| share, support, end);
    }
    // not constant, but with mass at infinity
    refused(&|x| 0.4 * x.clamp(0.0, 1.0), [0.0, f64::INFINITY], "towards inf it stays at 0.4");
    // NaN elsewhere than beyond the last sample
    let nan = f64::NAN;
    refused(&|_| nan, [0.0, 10.0], "F(0.0) is NaN");
    refused(&|_| nan, [0.0, f64::INFINITY], "F(0.0) is NaN");
    refused(&|_| nan, EVERYWHERE, "F(0.0) is NaN");
    refused(&|x| if x == 0.0 { nan } else { 1.0 }, [0.0, f64::INFINITY], "F(0.0) is NaN");
    refused(&|x| if x == 10.0 { nan } else { 0.1 * x }, [0.0, 10.0], "F(10.0) is NaN");
    refused(&|x| if x > 3.0 { nan } else { 0.1 * x }, [0.0, f64::INFINITY], "beyond F(3.0) = 0.3");
    refused(
        &|x| if x < -3.0 { nan } else { 1.0 + 0.1 * x },
        [f64::NEG_INFINITY, 0.0],
        "beyond F(-3.0) = 0.7",
    );
}

#[test]
fn a_function_that_is_no_cdf_is_refused() {
    let refused = |result: Result<f64, Error>, reason: &str| {
        let error = result.unwrap_err().to_string();
        assert!(error.starts_with("the function given is not a cdf: ") && error.contains(reason), "{error}");
    };
    let through = |cdf: fn(f64) -> f64, u| Inversion::new(cdf, [0.0, 10.0]).and_then(|i| i.inverse_cdf(u));
    refused(through(|x| 1.0 - x / 10.0, 0.5), "falls");
    refused(through(|x| 0.1 * x.min(4.0), 0.5), "never reaches 0.5");
    refused(through(|x| x, 0.5), "outside [0, 1]");
    refused(through(|_| f64::NAN, 0.5), "NaN");
    refused(through(|x| -x / 10.0, 0.5), "outside [0, 1]");
    for support in [[1.0, 1.0], [2.0, 1.0], [f64::NAN, 1.0], [0.0, f64::NAN], [f64::INFINITY, f64::INFINITY]]
    {
        assert!(Inversion::new(|_| 0.5, support).is_err(), "{support:?}");
    }
    // where it shows only when drawing, the run ends with an error
    let never = Inversion::new(|x: f64| 0.05 * x, [0.0, 10.0]).unwrap();
    let error = estimate(&from_fn(|rng| never.sample(rng)), Budget::Draws(1000), 1).unwrap_err();
    assert!(matches!(error, Error::Draw { value, .. } if value.is_nan()));
}

#[test]
fn an_inversion_takes_few_evaluations() {
    let count = std::cell::Cell::new(0);
    let cdf = |x: f64| {
        count.set(count.get() + 1);
        Normal::standard().cdf(x)
    };
    let inversion = Inversion::new(cdf, [f64::NEG_INFINITY, f64::INFINITY]).unwrap();
    for u in PROBABILITIES {
        count.set(0);
        inversion.inverse_cdf(u).unwrap();
        assert!(count.get() <= 66, "{} at {u}", count.get());
    }
}

// ---- the classic mistakes, written out and refused ----

/// An estimator of the mean 1/λ that makes a mistake, the ratio of its mean to 1/λ, and a bound on its std
/// deviation in units of 1/λ.
fn mistakes(rate: f64) -> Vec<(&'static str, Box<dyn Estimator>, f64, f64)> {
    let of = |f: fn(f64, f64) -> f64| -> Box<dyn Estimator> {
        Box::new(from_fn(move |rng| f(rng.uniform(), rate)))
    };
    let ln10 = 10f64.ln();
    vec![
        ("multiplied by λ", of(|u, rate| -rate * (1.0 - u).ln()), rate * rate, rate * rate),
        ("sign forgotten", of(|u, rate| (1.0 - u).ln() / rate), -1.0, 1.0),
        ("log base 10", of(|u, rate| -(1.0 - u).log10() / rate), 1.0 / ln10, 1.0 / ln10),
        ("log base 2", of(|u, rate| -(1.0 - u).log2() / rate), 1.0 / 2f64.ln(), 1.0 / 2f64.ln()),
        ("median returned", of(|_, rate| 2f64.ln() / rate), 2f64.ln(), 0.0),
        // E[p(U)] = 1 − e^(−λ)
        ("p(U) returned", of(|u, rate| rate * (-rate * u).exp()), rate * -(-rate).exp_m1(), rate * rate),
        // E[max(1 − U, ε)'s −ln] = 1 − ε
        ("1 − U kept off 0 by 0.1", of(|u, rate| -(1.0 - u).max(0.1).ln() / rate), 0.9, 1.0),
        ("F(U) returned", of(|u, rate| -(-rate * u).exp_m1()), rate - -(-rate).exp_m1(), rate),
    ]
}

/// n = 10⁶: 7 std errors are 0.7 % of 1/λ, and the nearest mistake at λ = 0.37 is 10 % off. Each one's mean
/// is where theory puts it.
#[test]
fn classic_mistakes_are_refused_and_have_the_ratio_that_theory_predicts() {
    let (rate, n) = (0.37, 1_000_000);
    let refused = |found: &Estimate| {
        (found.mean() - 1.0 / rate).abs() > common::deviations(7.0) / rate / (n as f64).sqrt()
    };
    let right = estimate(&exponential(rate), Budget::Draws(n), common::seed(16)).unwrap();
    assert!(!refused(&right));
    for (name, mistake, predicted, spread) in mistakes(rate) {
        let found = estimate(&mistake, Budget::Draws(n), common::seed(16)).unwrap();
        assert!(refused(&found), "{name} passes: {found}");
        let (ratio, room) =
            (found.mean() * rate, common::deviations(7.0) * spread / (n as f64).sqrt() + 1e-12);
        assert!((ratio - predicted).abs() <= room, "{name}: {ratio}, predicted {predicted}");
    }
}

/// λ = 1 hides the multiplication: the reason why other rates are tested.
#[test]
fn at_rate_1_multiplying_by_lambda_cannot_be_seen() {
    let [(_, multiplied, ..), ..] = &mistakes(1.0)[..] else { panic!("there are mistakes") };
    let found = estimate(multiplied, Budget::Draws(1_000_000), common::seed(17)).unwrap();
    assert!(found.z(1.0).unwrap().abs() <= common::deviations(7.0));
}

proptest! {
    #![proptest_config(common::config(5000))]

    #[test]
    fn any_bits_make_an_exponential_or_an_error(rate in any::<u64>(), x in any::<u64>(), u in any::<u64>()) {
        let (rate, x, u) = (f64::from_bits(rate), f64::from_bits(x), f64::from_bits(u));
        let Ok(exponential) = Exponential::new(rate) else {
            prop_assert!(!(rate > 0.0 && rate.is_finite()));
            return Ok(());
        };
        prop_assert!(rate > 0.0 && rate.is_finite());
        if !x.is_nan() {
            prop_assert!((0.0..=1.0).contains(&exponential.cdf(x)));
            prop_assert!((0.0..=1.0).contains(&exponential.survival(x)));
            prop_assert!((0.0..=rate).contains(&exponential.pdf(x)));
        }
        prop_assert!(exponential.mean() > 0.0 && exponential.variance() >= 0.0);
        match exponential.inverse_cdf(u) {
            Ok(x) => prop_assert!((0.0..=1.0).contains(&u) && x >= 0.0),
            Err(_) => prop_assert!(!(0.0..=1.0).contains(&u)),
        }
    }

    /// F is monotone, and F(F⁻¹(u)) = u to within rounding of x times the condition number λx p(x)/…: a few
    /// ulp of u.
    #[test]
    fn the_inverse_inverts(rate in 1e-3..1e3f64, u in 0.0..1.0f64, v in 0.0..1.0f64) {
        let exponential = exponential(rate);
        let x = exponential.inverse_cdf(u).unwrap();
        // dF/F = λx e^(−λx)/(1 − e^(−λx)) · dx/x, a condition number of at most 1
        prop_assert!((exponential.cdf(x) - u).abs() <= 4.0 * f64::EPSILON * u);
        let y = exponential.inverse_cdf(v).unwrap();
        prop_assert_eq!(u <= v, x <= y || (u > v && x == y));
        prop_assert!((exponential.cdf(x) + exponential.survival(x) - 1.0).abs() <= 3e-16);
    }

    /// The rest of the density above x is its survival, by quadrature: ∫ p over [x, x + 1/λ] (Gauss–Legendre,
    /// 5 points on 4 pieces).
    #[test]
    fn the_density_integrates_to_the_cdf(rate in 0.01..100.0f64, x in 0.0..3.0f64) {
        let exponential = exponential(rate);
        let (from, to) = (x / rate, (x + 1.0) / rate);
        const NODES: [(f64, f64); 5] = [
            (-0.906_179_845_938_664, 0.236_926_885_056_189_08), (-0.538_469_310_105_683_1,
                0.478_628_670_499_366_47),
            (0.0, 0.568_888_888_888_888_9),
            (0.538_469_310_105_683_1, 0.478_628_670_499_366_47), (0.906_179_845_938_664,
                0.236_926_885_056_189_08),
        ];
        let h = (to - from) / 8.0;
        let integral: f64 = (0..4).flat_map(|piece| NODES.map(|(node, weight)| {
            weight * h * exponential.pdf(from + h * (f64::from(2 * piece + 1) + node))
        })).sum();
        prop_assert!((exponential.cdf(to) - exponential.cdf(from) - integral).abs() <= 1e-12);
    }

    /// At every place and scale at which they are written down.
    #[test]
    fn laws_that_are_nan_far_out_are_inverted(
        i in 0..NAN_FAR_OUT.len(), shift in -3.0..3.0f64, power in -100..100, u in 0.0..=1.0f64,
    ) {
        let ((cdf, support), scale) = (NAN_FAR_OUT[i], 2f64.powi(power));
        let cdf = |x: f64| cdf((x - shift * scale) / scale);
        let [low, high] = support.map(|end| (end + shift) * scale);
        let x = Inversion::new(cdf, [low, high]).unwrap().inverse_cdf(u).unwrap();
        prop_assert!(x == low || is_generalised_inverse(cdf, x, u), "{x}");
        prop_assert!(if u > 0.0 { x.is_finite() } else { x == low }, "{x}");
    }

    /// Any weights, divided by their sum and summed again.
    #[test]
    fn any_summed_weights_are_a_cdf(
        weights in prop::collection::vec(1e-3..1.0f64, 1..300), u in 0.0..=1.0f64, top in any::<bool>(),
    ) {
        let (n, total) = (weights.len(), weights.iter().sum::<f64>());
        let cdf = cumulated(weights.iter().map(|w| w / total).collect());
        let u = if top { 1.0 - 0.5f64.powi(53) } else { u };
        let x = Inversion::new(&cdf, [0.0, f64::INFINITY]).unwrap().inverse_cdf(u).unwrap();
        let first = if u > 0.0 { first_to_reach(&cdf, n, u) } else { 0.0 };
        prop_assert_eq!(x, first);
    }

    /// Any table of jumps makes a cdf; its inverse finds the jump, whatever the support.
    #[test]
    fn any_staircase_is_inverted(
        mut steps in prop::collection::vec((-1e3..1e3f64, 0.01..1.0f64), 1..12),
        u in 0.0..1.0f64,
    ) {
            steps.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = steps.iter().map(|(_, weight)| weight).sum();
        let cdf = |x: f64| (steps.iter().filter(|(at, _)| *at <= x).map(|(_,
            weight)| weight).sum::<f64>() / total).min(1.0);
        let inversion = Inversion::new(cdf, [f64::NEG_INFINITY, f64::INFINITY]).unwrap();
        let x = inversion.inverse_cdf(u).unwrap();
        if u > 0.0 {
            let expected = steps.iter().map(|(at, _)| *at).find(|at| cdf(*at) >= u).unwrap();
            prop_assert_eq!(x, expected);
        } else {
            prop_assert_eq!(x, f64::NEG_INFINITY);
        }
    }

    #[test]
    fn any_support_and_probability_give_a_value_or_an_error(low in any::<u64>(), high in any::<u64>(),
        u in any::<u64>()) {
        let (low, high, u) = (f64::from_bits(low), f64::from_bits(high), f64::from_bits(u));
        let normal = Normal::standard();
        if let Ok(inversion) = Inversion::new(|x| normal.cdf(x), [low, high])
            && let Ok(x) = inversion.inverse_cdf(u)
        {
            prop_assert!(low <= x && x <= high && (0.0..=1.0).contains(&u));
        }
    }
}

/// statrs' Gamma law panics where βx overflows, as it does at the largest `f64`: no cdf is asked that far
/// out, but where the support begins there.
#[test]
fn a_cdf_that_panics_far_out_is_inverted() {
    let gamma = Gamma::new(2.5, 3.0).unwrap();
    assert!(std::panic::catch_unwind(|| gamma.cdf(f64::MAX)).is_err());
    let inversion = Inversion::new(|x| gamma.cdf(x), [0.0, f64::INFINITY]).unwrap();
    for u in [1e-9, 0.5, 0.999, 1.0 - f64::EPSILON / 2.0, 1.0] {
        let x = inversion.inverse_cdf(u).unwrap();
        assert!(gamma.cdf(x) >= u - 1e-12 && x < 1e3, "{u}: {x}");
    }
    let late = |x: f64| if x < 1.5e308 { 0.0 } else { 1.0 };
    let inversion = Inversion::new(late, [1e300, f64::INFINITY]).unwrap();
    assert_eq!(inversion.inverse_cdf(0.5).unwrap(), 1.5e308);
}
