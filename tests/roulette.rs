//! Section 5: laws at the ends of what `f64` holds, coins, costs, and where light paths are degenerate.
//! Means, variances and laws are those of tests/estimators.rs, closed forms of every size those of
//! tests/vectors.rs.

mod common;

use approx::assert_relative_eq;
use common::{NEARLY_ONE, config, seed, ulps};
use proptest::prelude::*;
use unbiased::roulette::{LightModel, Roulette};
use unbiased::{Budget, Estimator, Run, Stream, from_fn};

/// Std errors for a comparison that a right estimator passes: a false alarm has probability 2.6e-12.
fn z() -> f64 {
    common::deviations(7.0)
}

fn roulette(p_rr: f64) -> Roulette {
    Roulette::new(p_rr).unwrap()
}

fn light(albedo: f64, visibility: f64) -> LightModel {
    LightModel::new(albedo, visibility).unwrap()
}

// p, k, P(N = k), P(N ≤ k), P(N > k): by mpmath, from the exact value of the f64 p, where k has more digits
// than f64 or p hardly any way to 1
#[rustfmt::skip]
const LAWS: &[(f64, u64, f64, f64, f64)] = &[
    (1e-300, 0, 1.0, 1.0, 1e-300),
    (1e-300, 1, 1e-300, 1.0, 0.0),
    (NEARLY_ONE, 0, 1.1102230246251565e-16, 1.1102230246251565e-16, NEARLY_ONE),
    (NEARLY_ONE, 1_000_000, 1.110223024501897e-16, 1.1102241347865513e-10, 0.9999999998889776),
    (NEARLY_ONE, (1 << 53) - 1, 4.0842822587477105e-17, 0.6321205588285577, 0.3678794411714423),
    (NEARLY_ONE, (1 << 53) + 1, 4.08428225874771e-17, 0.6321205588285578, 0.3678794411714422),
    (NEARLY_ONE, 999_999_999_999_999_999, 6.745853450008784e-65, 1.0, 6.076124616751106e-49),
    (NEARLY_ONE, 6_000_000_000_000_000_001, 5.5868918419223014e-306, 1.0, 5.0322248034881075e-290),
    (1.0 - 4.0 * f64::EPSILON, 10_000_000_000_000_003, 1.233645419596688e-19, 0.9998611038737,
        0.00013889612630007395),
    // no roulette: the path never ends, at whichever k one looks
    (1.0, 0, 0.0, 0.0, 1.0),
    (1.0, u64::MAX, 0.0, 0.0, 1.0),
];

#[test]
fn laws_are_right_to_the_last_places_up_to_k_of_1e18_and_beyond() {
    for &(p, k, pmf, cdf, survival) in LAWS {
        let law = roulette(p).bounces();
        for (name, found, exact) in
            [("pmf", law.pmf(k), pmf), ("cdf", law.cdf(k), cdf), ("survival", law.survival(k), survival)]
        {
            assert!(ulps(found, exact) <= 2, "{name}({k}) at p = {p:?}: {found:?}, not {exact:?}");
        }
    }
    let law = roulette(NEARLY_ONE).bounces();
    assert_eq!((law.cdf(u64::MAX), law.survival(u64::MAX)), (1.0, 0.0));
    let never = roulette(1.0).bounces();
    assert_eq!((never.mean(), never.variance()), (f64::INFINITY, f64::INFINITY));
    for (p, u, k) in [
        (0.8, 0.0, 0),
        (0.8, 1.0, u64::MAX),
        (1.0, 0.0, 0),
        (1.0, f64::from_bits(1), u64::MAX),
        (1e-300, NEARLY_ONE, 0),
    ] {
        assert_eq!(roulette(p).bounces().quantile(u), Ok(k), "{p} {u}");
    }
    // the median of 1 − 2⁻⁵³ by mpmath; cdf there is flat to the rounding of 1/2 over about one k
    let median = law.quantile(0.5).unwrap();
    assert!(median.abs_diff(6_243_314_768_165_358) <= 2, "{median}");
}

/// U < p alone is true with probability ⌈p·2⁵³⌉/2⁵³, which for p = 1e-300 is 1e284 times too often.
#[test]
fn a_coin_is_exact_below_the_grid_of_the_uniform_numbers() {
    // on the grid one number decides; each is U = k·2⁻⁵³
    let continues = |p: f64, k: &[u64]| {
        let uniforms: Vec<f64> = k.iter().map(|k| *k as f64 * 2f64.powi(-53)).collect();
        let mut rng = Stream::scripted(&uniforms);
        let result = roulette(p).continues(&mut rng);
        assert_eq!(rng.random_numbers(), k.len() as u64, "numbers taken at p = {p:?}, {k:?}");
        result
    };
    const TOP: u64 = (1 << 53) - 1;
    assert!(continues(1.0, &[TOP]) && continues(NEARLY_ONE, &[TOP - 1]) && !continues(NEARLY_ONE, &[TOP]));
    assert!(continues(0.5, &[(1 << 52) - 1]) && !continues(0.5, &[1 << 52]));
    // p = 2⁻⁵³·(3 + 5/8): k = 0, 1, 2 continue, 3 asks again with 5/8, 4 ends
    let p = 3.625 / 2f64.powi(53);
    assert!(continues(p, &[2]) && !continues(p, &[4]));
    assert!(continues(p, &[3, (5 << 50) - 1]) && !continues(p, &[3, 5 << 50]));
    // p = 2⁻¹⁰⁷⁴ = 2⁻⁵³·²⁰ · 2⁻¹⁴: twenty zeros, and 14 more bits
    let zeros = |last| [vec![0; 20], vec![last]].concat();
    let smallest = f64::from_bits(1);
    assert!(continues(smallest, &zeros((1 << 39) - 1)) && !continues(smallest, &zeros(1 << 39)));
    assert!(!continues(1e-300, &[1]));
}

/// One coin a bounce and one to end; one for X_rr, and X is drawn only if it counts; vertices of light paths.
#[test]
fn draws_cost_what_they_are_said_to() {
    let n = 100_000;
    let run = |estimator: &dyn Estimator| Run::new(seed(31)).estimate(estimator, Budget::Draws(n)).unwrap();
    let near = |found: f64, mean: f64, deviation: f64| {
        assert!((found - mean).abs() <= z() * deviation / (n as f64).sqrt(), "{found} for {mean}");
    };
    let simulated = run(&roulette(0.83).bounces().by_simulation().unwrap());
    let coins = simulated.cost.random_numbers as f64 / n as f64;
    assert_relative_eq!(coins, 1.0 + simulated.estimate.mean(), epsilon = 0.0, max_relative = 1e-12);
    // a coin that was flipped for X is not X's: as many numbers are taken as coins and X drawn
    let counted = from_fn(|rng| {
        rng.count_evaluations(1);
        rng.uniform()
    });
    let wrapped = run(&roulette(0.83).wrap(counted)).cost;
    assert_eq!(wrapped.random_numbers, n + wrapped.evaluations);
    near(wrapped.evaluations as f64 / n as f64, 0.83, (0.83f64 * 0.17).sqrt());
    for (rho, v, q) in
        [(0.8, 0.5, 0.8), (0.61, 0.3, 0.59), (0.9, 0.05, 0.95), (0.0, 0.3, 0.6), (0.5, 1.0, 0.6)]
    {
        let paths = light(rho, v).roulette(q).unwrap();
        near(run(&paths).cost.evaluations as f64 / n as f64, paths.cost(), q.sqrt() / (1.0 - q));
        assert_eq!(paths.q(), q);
    }
    for (rho, v, max_k) in [(0.8, 0.5, 8), (0.9, 0.05, 0), (0.5, 1.0, 4)] {
        let paths = light(rho, v).truncated(max_k).unwrap();
        assert_eq!(run(&paths).cost.evaluations, n * (max_k + 1));
        assert_eq!((paths.max_k(), paths.cost()), (max_k, max_k as f64 + 1.0));
    }
}

/// ρ = 0, v = 0, v = 1 and A = B: each has its own answer.
#[test]
fn degenerate_models_have_their_documented_answers() {
    let black = light(0.0, 0.3); // only the first vertex counts
    assert_eq!(black.optimum(), 0.0);
    let first = black.roulette(0.0).unwrap();
    assert_relative_eq!(first.variance(), 0.21, epsilon = 0.0, max_relative = 1e-15);
    assert_eq!(first.cost(), 1.0);
    assert_relative_eq!(black.roulette(0.7).unwrap().variance(), 0.21, epsilon = 0.0, max_relative = 1e-15);
    assert_eq!(black.crossing(0.7, 0), Ok(f64::INFINITY)); // nothing is cut off
    assert_eq!(black.truncated(0).unwrap().bias().to_bits(), 0); // and not −0
    assert_eq!(light(0.0, 1.0).optimum(), 0.0);

    let dark = light(0.8, 0.0);
    assert_eq!((dark.mean(), dark.optimum()), (0.0, 0.8));
    assert_eq!((dark.crossing(0.5, 3), dark.crossing(0.9, 0)), (Ok(0.0), Ok(0.0)));
    for q in [0.0, 0.1, 0.9] {
        assert_eq!(dark.roulette(q).unwrap().variance(), 0.0); // for q ≤ ρ², too
    }

    // every vertex sees the light: variance × cost = A/(q − ρ²) falls up to q = 1
    let bright = light(0.8, 1.0);
    assert_eq!(bright.optimum(), 1.0);
    assert!(bright.roulette(1.0).is_err());
    let at = |q| bright.roulette(q).map(|paths| paths.variance() * paths.cost()).unwrap();
    for q in [0.7, 0.8, 0.95, 0.9999] {
        assert_relative_eq!(at(q), 16.0 / (q - 0.64), epsilon = 0.0, max_relative = 1e-12);
    }
    assert_eq!(bright.truncated(5).unwrap().variance(), 0.0);

    // A = B: v ρ²/(1 − ρ)² = 1 − v, where the quadratic is linear: q* = (1 + ρ²)/2
    let rho: f64 = 0.61;
    let a = (rho / (1.0 - rho)).powi(2);
    assert_relative_eq!(
        light(rho, 1.0 / (1.0 + a)).optimum(),
        (1.0 + rho * rho) / 2.0,
        epsilon = 0.0,
        max_relative = 1e-15
    );

    let unsigned = light(-0.0, -0.0);
    assert_eq!((unsigned.albedo().to_bits(), unsigned.visibility().to_bits()), (0, 0));
    // q = ρ² and just above: infinite, and finite again
    let half = light(0.5, 0.5);
    assert_eq!(half.roulette(0.25).unwrap().variance(), f64::INFINITY);
    assert!(half.roulette(0.25 + f64::EPSILON).unwrap().variance().is_finite());
    // by mpmath: q − ρ² has digits that q − fl(ρ²) has not; and ρ² may underflow where its ratio to q does
    // not
    for (rho, q, variance) in [(0.7, 0.49, 1.53247487320246e16), (1e-160, 4e-320, 0.4166691406627938)] {
        let found = light(rho, 0.5).roulette(q).unwrap().variance();
        assert_relative_eq!(found, variance, epsilon = 0.0, max_relative = 2e-15);
    }
}

proptest! {
    #![proptest_config(config(300))]

    /// No q does better than q*, and the quadratic vanishes there.
    #[test]
    fn the_optimum_is_the_least_and_the_root(rho in 0.01..0.99, v in 0.01..0.99, other in 0.0..1.0) {
        let model = light(rho, v);
        let best = model.optimum();
        let at = |q: f64| model.roulette(q).map(|paths|
            paths.variance() * paths.cost()).unwrap_or(f64::INFINITY);
        prop_assert!(at(best) <= at(other) * (1.0 + 1e-14));
        prop_assert!(at(best) <= at(best * (1.0 + 1e-3)) && at(best) <= at(best * (1.0 - 1e-3)));
        let (a, b) = ((v * rho / (1.0 - rho)).powi(2), v * (1.0 - v));
        let terms = [(b - a) * best * best, 2.0 * a * best, -(a + b * rho * rho)];
        let size: f64 = terms.iter().map(|term| term.abs()).sum();
        prop_assert!(terms.iter().sum::<f64>().abs() <= 1e-14 * size);
    }

    /// At the crossing both errors are equal; a crossing of 0 means that roulette is the better one from the
    /// start.
    #[test]
    fn errors_are_equal_at_the_crossing(rho in 0.01..0.95, v in 0.01..0.99, room in 0.01..0.99,
        max_k in 0u64..60) {
        let model = light(rho, v);
        let q = rho * rho + room * (1.0 - rho * rho);
        let (paths, truncated) = (model.roulette(q)?, model.truncated(max_k)?);
        let crossing = model.crossing(q, max_k)?;
        if crossing > 0.0 {
            let (a, b) = (paths.mean_square_error(crossing)?, truncated.mean_square_error(crossing)?);
            prop_assert!((a - b).abs() <= 1e-12 * (a + b), "{} and {} at {}", a, b, crossing);
        } else {
            prop_assert!(paths.mean_square_error(1.0)? <= truncated.mean_square_error(1.0)?);
        }
    }
}
