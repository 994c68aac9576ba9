//! Section 1: the formula to rounding, and the inversion of any cdf. Closed forms are those of
//! tests/vectors.rs, means, variances and laws those of tests/estimators.rs.

mod common;

use approx::assert_relative_eq;
use common::{NEARLY_ONE, Stuck, probability};
use proptest::prelude::*;
use rand::distr::Distribution;
use statrs::distribution::{Beta, Binomial, ContinuousCDF, DiscreteCDF, Gamma, Normal, Poisson, Weibull};
use unbiased::inversion::{Exponential, Inversion};
use unbiased::{Estimator, Stream};

/// Against the library's logarithm, at most 3 ulp apart (1 of the logarithm, ½ each of 1/λ, product, quotient
/// and library).
#[test]
fn filling_is_the_formula_to_rounding() {
    for rate in [0.37, 1.0, 1e-300, 1e300, 5e-308, 1e308, f64::MIN_POSITIVE, f64::MAX] {
        let exponential = Exponential::new(rate).unwrap();
        let [mut uniforms, mut filled] = [[0.0f64; 1003]; 2];
        common::fill_uniform(&mut Stream::new(common::seed(18), 0), &mut uniforms);
        exponential.fill(&mut Stream::new(common::seed(18), 0), &mut filled);
        // and at both ends of the grid, where a draw is 0, not −0, and the longest
        let mut ends = [0.0; 2];
        exponential.fill(&mut Stream::scripted(&[0.0, 1.0]), &mut ends);
        assert_eq!(ends[0].to_bits(), 0);
        for (draw, u) in filled.into_iter().chain(ends).zip(uniforms.into_iter().chain([0.0, NEARLY_ONE])) {
            let plain = (1.0 - u).ln().abs() / rate;
            let ulp = plain.next_up() - plain;
            // the smallest rates overflow, in both
            let same = draw == plain || (draw - plain).abs() <= 3.0 * ulp;
            assert!(same, "{draw:?} and {plain:?} at rate {rate:?}");
        }
    }
}

/// F⁻(u) is the smallest number at which the cdf reaches u: F there, but not just below.
fn is_generalised_inverse(cdf: impl Fn(f64) -> f64, x: f64, u: f64) -> bool {
    cdf(x) >= u && cdf(x.next_down()) < u
}

const PROBABILITIES: [f64; 11] = [1e-12, 1e-6, 0.001, 0.05, 0.2, 0.5, 0.7, 0.9, 0.99, 0.999_999, 1.0 - 1e-12];
const EVERYWHERE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
const POSITIVE: [f64; 2] = [0.0, f64::INFINITY];

/// What is asked for at the ends of the unit interval, too.
fn probabilities() -> impl Iterator<Item = f64> {
    PROBABILITIES.into_iter().chain([0.5f64.powi(54), NEARLY_ONE, 1.0])
}

/// Against the definition at every probability, and against statrs' own quantiles where those are good: in
/// the far tail its Gamma stops at 1e-9 where the quantile is 1e-20, elsewhere they hold to about 1e-9.
#[test]
fn any_smooth_cdf_is_inverted() {
    let laws: [(&dyn ContinuousCDF<f64, f64>, [f64; 2]); 4] = [
        (&Normal::new(-1.3, 2.5).unwrap(), EVERYWHERE),
        (&Gamma::new(0.61, 0.37).unwrap(), POSITIVE),
        (&Beta::new(0.83, 4.1).unwrap(), [0.0, 1.0]),
        (&Weibull::new(1.7, 4.1).unwrap(), POSITIVE),
    ];
    for (i, (law, support)) in laws.into_iter().enumerate() {
        let count = std::cell::Cell::new(0);
        let cdf = |x: f64| {
            count.set(count.get() + 1);
            law.cdf(x)
        };
        let inversion = Inversion::new(cdf, support).unwrap();
        for u in PROBABILITIES {
            count.set(0);
            let x = inversion.inverse_cdf(u).unwrap();
            assert!(count.get() <= 66, "law {i}: {} evaluations at {u}", count.get());
            let there = law.cdf(x);
            assert!(
                is_generalised_inverse(|x| law.cdf(x), x, u),
                "law {i}: F⁻({u}) = {x}, F there is {there}"
            );
            if (0.001..=0.999).contains(&u) {
                assert_relative_eq!(x, law.inverse_cdf(u), epsilon = 0.0, max_relative = 1e-8);
            }
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
    // an atom at the lower end, all of the mass or half of it
    for (share, support) in [(1.0, [-3.0, 10.0]), (1.0, [-3.0, f64::INFINITY]), (0.5, [-3.0, 10.0])] {
        let inversion = Inversion::new(|_| share, support).unwrap();
        for u in probabilities().filter(|u| *u <= share) {
            assert_eq!(inversion.inverse_cdf(u).unwrap(), -3.0, "{share} {u}");
        }
    }
}

/// n times 1/n, summed, is 1 − 2⁻⁵³, 1 or 1 + 2⁻⁵², or further off: no less a cdf for it. F⁻(u) is the first
/// k at which the sum reaches u, or its last value where it ends an ulp or two below.
#[test]
fn summed_weights_are_a_cdf() {
    let mut ends = [0, 0, 0];
    for n in 2..200 {
        let sums: Vec<f64> = (0..n)
            .scan(0.0, |sum, _| {
                *sum += 1.0 / n as f64;
                Some(*sum)
            })
            .collect();
        let cdf = |x: f64| if x < 1.0 { 0.0 } else { sums[(x as usize).min(n) - 1] };
        let last = sums[n - 1];
        ends[if last < 1.0 { 0 } else { 1 + usize::from(last > 1.0) }] += 1;
        for support in [[1.0, n as f64], [0.0, 300.0], EVERYWHERE] {
            let inversion = Inversion::new(cdf, support).unwrap();
            let grid = (1..2 * n).map(|i| i as f64 / (2 * n) as f64);
            for u in grid.chain([0.5f64.powi(54), NEARLY_ONE, 1.0]) {
                let first = 1 + sums.iter().position(|sum| *sum >= u.min(last)).unwrap();
                assert_eq!(inversion.inverse_cdf(u).unwrap(), first as f64, "{n} {support:?} {u}");
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
    // uniform on [0, 10], but for an end below or above 1, a start below 0, or a fall at the end; and where
    // that shows
    type Fault = fn(f64, f64) -> f64;
    let faults: [(Fault, &str, f64); 4] = [
        (|x, off| 0.1 * x * (1.0 - off), "never reaches 1", 1.0),
        (|x, off| if x < 9.0 { 0.1 * x } else { 1.0 + off }, "outside [0, 1]", 0.5),
        (|x, off| if x < 1.0 { -off } else { 0.1 * x }, "outside [0, 1]", 0.5),
        (|x, off| if x < 9.0 { 0.1 * x } else { 1.0 - if x < 10.0 { 0.0 } else { off } }, "falls", 0.95),
    ];
    for (fault, reason, at) in faults {
        let invert = |off, u| Inversion::new(|x| fault(x, off), [0.0, 10.0])?.inverse_cdf(u);
        for u in [0.5, NEARLY_ONE, 1.0] {
            assert!((0.0..=10.0).contains(&invert(0.9 * share, u).unwrap()), "{reason} {u}");
        }
        assert_eq!(invert(0.9 * share, 0.0).unwrap(), 0.0, "{reason}");
        let error = invert(1.1 * share, at).unwrap_err().to_string();
        assert!(error.contains(reason), "{error}");
    }
}

/// What is no cdf, and how it is told: when it is looked at, or when it is asked for the inverse of 0.7.
#[test]
fn what_is_no_cdf_is_refused() {
    let (right, left) = (POSITIVE, [f64::NEG_INFINITY, 10.0]);
    let (ten, far) = ([0.0, 10.0], [-3.0, f64::INFINITY]);
    type Row = (fn(f64) -> f64, [f64; 2], &'static str);
    let rows: [Row; 20] = [
        (|x| 1.0 - x / 10.0, ten, "falls"),
        (|x| 0.1 * x.min(4.0), ten, "at the support's upper end 10.0 it is 0.4, and never reaches 0.7"),
        (|_| 0.0, ten, "at the support's upper end 10.0 it is 0, and never reaches 0.7"),
        (|_| 0.5, ten, "at the support's upper end 10.0 it is 0.5, and never reaches 0.7"),
        (|x| x, ten, "outside [0, 1]"),
        (|x| -x / 10.0, ten, "outside [0, 1]"),
        // mass at infinity
        (|_| 0.0, far, "towards inf it stays at 0"),
        (|_| 0.5, far, "towards inf it stays at 0.5"),
        (|_| 0.5, left, "towards -inf it stays at 0.5"),
        (|_| 0.5, EVERYWHERE, "towards -inf it stays at 0.5"),
        (|_| 1.0, EVERYWHERE, "towards -inf it stays at 1"),
        (|_| 0.0, EVERYWHERE, "towards inf it stays at 0"),
        (|x| 0.4 * x.clamp(0.0, 1.0), right, "towards inf it stays at 0.4"),
        // NaN elsewhere than beyond the last sample
        (|_| f64::NAN, ten, "F(0.0) is NaN"),
        (|_| f64::NAN, right, "F(0.0) is NaN"),
        (|_| f64::NAN, EVERYWHERE, "F(0.0) is NaN"),
        (|x| if x == 0.0 { f64::NAN } else { 1.0 }, right, "F(0.0) is NaN"),
        (|x| if x == 10.0 { f64::NAN } else { 0.1 * x }, ten, "F(10.0) is NaN"),
        (|x| if x > 3.0 { f64::NAN } else { 0.1 * x }, right, "beyond F(3.0) = 0.3"),
        (
            |x| if x < -3.0 { f64::NAN } else { 1.0 + 0.1 * x },
            [f64::NEG_INFINITY, 0.0],
            "beyond F(-3.0) = 0.7",
        ),
    ];
    for (cdf, support, reason) in rows {
        let refused = Inversion::new(cdf, support).and_then(|inversion| inversion.inverse_cdf(0.7));
        let error = refused.unwrap_err().to_string();
        assert!(error.starts_with("the function given is not a cdf: ") && error.contains(reason), "{error}");
    }
}

type Law = (fn(f64) -> f64, [f64; 2]);

/// Laws as one writes them down, which are ∞·0 or ∞/∞ at the largest numbers: Gamma of shape 2 and 3, the
/// logistic one twice, and a Gamma to the left.
const NAN_FAR_OUT: [Law; 5] = [
    (|x| 1.0 - (1.0 + x) * (-x).exp(), POSITIVE),
    (|x| 1.0 - (1.0 + x + 0.5 * x * x) * (-x).exp(), POSITIVE),
    (|x| x.exp() / (1.0 + x.exp()), EVERYWHERE),
    (|x| 0.5 + 0.5 * (0.5 * x).sinh() / (0.5 * x).cosh(), EVERYWHERE),
    (|x| (1.0 - x + 0.5 * x * x) * x.exp(), [f64::NEG_INFINITY, 0.0]),
];

#[test]
fn what_is_nan_or_panics_far_out_is_inverted() {
    // median of (1 + x) e^(−x) = 1/2, by bisection in arbitrary precision
    let (cdf, support) = NAN_FAR_OUT[0];
    let median = Inversion::new(cdf, support).unwrap().inverse_cdf(0.5).unwrap();
    assert_relative_eq!(median, 1.678_346_990_016_660_7, epsilon = 0.0, max_relative = 1e-15);
    // statrs' Gamma law panics where βx overflows, as it does at the largest f64: no cdf is asked that far
    // out, but where the support begins there
    let gamma = Gamma::new(2.5, 3.0).unwrap();
    assert!(std::panic::catch_unwind(|| gamma.cdf(f64::MAX)).is_err());
    let inversion = Inversion::new(|x| gamma.cdf(x), POSITIVE).unwrap();
    for u in [1e-9, 0.5, 0.999, NEARLY_ONE, 1.0] {
        let x = inversion.inverse_cdf(u).unwrap();
        assert!(gamma.cdf(x) >= u - 1e-12 && x < 1e3, "{u}: {x}");
    }
    let late = |x: f64| if x < 1.5e308 { 0.0 } else { 1.0 };
    let inversion = Inversion::new(late, [1e300, f64::INFINITY]).unwrap();
    assert_eq!(inversion.inverse_cdf(0.5).unwrap(), 1.5e308);
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
    let slow = Exponential::new(5e-324).unwrap();
    let inversion = Inversion::new(|x| slow.cdf(x), POSITIVE).unwrap();
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
    for support in
        [[-5.0, 5.0], [-0.0, 5.0], [0.0, 5.0], [-5.0, -0.0], [-5.0, 0.0], [-0.0, f64::INFINITY], EVERYWHERE]
    {
        let inversion = Inversion::new(jump, support).unwrap();
        for u in probabilities() {
            assert_eq!(inversion.inverse_cdf(u).unwrap().to_bits(), 0, "{support:?} {u}");
        }
    }
    let line = Inversion::new(|x: f64| 0.1 * x.max(0.0), [-0.0, 10.0]).unwrap();
    assert_eq!(line.inverse_cdf(0.0).unwrap().to_bits(), 0);
}

proptest! {
    #![proptest_config(common::config(5000))]

    /// At every place and scale at which they are written down, and never asked at infinity.
    #[test]
    fn laws_that_are_nan_far_out_are_inverted(
        i in 0..NAN_FAR_OUT.len(), shift in -3.0..3.0f64, power in -100..100, u in probability(),
    ) {
        let ((cdf, support), scale) = (NAN_FAR_OUT[i], 2f64.powi(power));
        let cdf = |x: f64| {
            assert!(x.is_finite(), "law {i} is asked at {x}");
            cdf((x - shift * scale) / scale)
        };
        let [low, high] = support.map(|end| (end + shift) * scale);
        let x = Inversion::new(cdf, [low, high]).unwrap().inverse_cdf(u).unwrap();
        prop_assert!(x == low || is_generalised_inverse(cdf, x, u), "{x}");
        prop_assert!(if u > 0.0 { x.is_finite() } else { x == low }, "{x}");
    }

    /// Any table of jumps makes a cdf; its inverse finds the jump, whatever the support.
    #[test]
    fn any_staircase_is_inverted(
        mut steps in prop::collection::vec((-1e3..1e3f64, 0.01..1.0f64), 1..12),
        u in 0.0..1.0f64,
    ) {
        steps.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = steps.iter().map(|(_, weight)| weight).sum();
        let up_to = |x: f64| steps.iter().filter(|(at, _)| *at <= x).map(|(_, weight)| weight).sum::<f64>();
        let cdf = |x: f64| (up_to(x) / total).min(1.0);
        let x = Inversion::new(cdf, EVERYWHERE).unwrap().inverse_cdf(u).unwrap();
        let first = steps.iter().map(|(at, _)| *at).find(|at| cdf(*at) >= u).unwrap();
        prop_assert_eq!(x, if u > 0.0 { first } else { f64::NEG_INFINITY });
    }

    #[test]
    fn any_support_and_probability_give_a_value_or_an_error(
        low in common::any_bits(), high in common::any_bits(), u in common::any_bits(),
    ) {
        let normal = Normal::standard();
        if let Ok(inversion) = Inversion::new(|x| normal.cdf(x), [low, high])
            && let Ok(x) = inversion.inverse_cdf(u)
        {
            prop_assert!(low <= x && x <= high && (0.0..=1.0).contains(&u));
        }
    }
}
