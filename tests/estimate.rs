//! What `Estimate` says of draws whose moments are known exactly; the hard cases for rounding are in
//! `nist.rs`.

mod common;

use approx::assert_relative_eq;
use proptest::prelude::*;
use unbiased::{Error, Estimate};

#[test]
fn huge_and_tiny_draws_neither_overflow_nor_vanish() {
    let std_error = |draws: &[f64]| Estimate::from_draws(draws).std_error().unwrap();
    // ±a, ±a, …: Σ(x − 0)² = n a², so s² = a² n/(n−1) and the std error is a/√(n−1)
    for a in [1e300, 1e160, 1.0, 1e-170, 1e-300] {
        let draws: Vec<f64> = (0..1000).map(|i| if i % 2 == 0 { a } else { -a }).collect();
        assert_relative_eq!(std_error(&draws), a / 999f64.sqrt(), epsilon = 0.0, max_relative = 1e-14);
    }
    // the variance overflows exactly where it is too large for f64
    let variance = |a: f64| Estimate::from_draws(&[a, -a]).variance().unwrap();
    assert_relative_eq!(variance(1e153), 2e306, epsilon = 0.0, max_relative = 1e-15);
    assert_eq!(variance(1e155), f64::INFINITY);
    // sums that overflow on the way
    let overflowing = Estimate::from_draws(&[1e308, 1e308, -1e308]).mean();
    assert_relative_eq!(overflowing, 1e308 / 3.0, epsilon = 0.0, max_relative = 4e-16);
    assert_eq!(Estimate::from_draws(&[f64::MAX; 1000]).mean(), f64::MAX);
    assert_eq!(Estimate::from_draws(&[f64::MAX, -f64::MAX]).mean(), 0.0);
}

#[test]
fn too_few_draws_have_no_error_bar() {
    let none = Estimate::new();
    assert!(none.mean().is_nan());
    assert_eq!(none.variance(), None);
    let one = Estimate::from_draws(&[3.0]);
    assert_eq!((one.mean(), one.variance(), one.std_error(), one.z(3.0)), (3.0, None, None, None));
    assert_eq!(
        one.confidence_interval(0.95),
        Err(Error::TooFewDraws { statistic: "a confidence interval", needed: 2, draws: 1 })
    );
    let two = Estimate::from_draws(&[3.0, 3.0]);
    assert_eq!((two.variance(), two.std_error(), two.z(3.0)), (Some(0.0), Some(0.0), Some(0.0)));
    for level in [0.0, 1.0, -0.5, 2.0, f64::NAN] {
        assert!(two.confidence_interval(level).is_err(), "{level}");
    }
}

/// An estimate of 0 from n ≥ 2 draws ±1 (and one 0, if n is odd), by doubling.
fn of_signs(n: u64) -> Estimate {
    let mut signs =
        if n.is_multiple_of(2) { Estimate::new() } else { Estimate::from_draws(&[1.0, 0.0, -1.0]) };
    let mut power = Estimate::from_draws(&[1.0, -1.0]);
    let mut pairs = (n - signs.draws()) / 2;
    while pairs > 0 {
        if pairs % 2 == 1 {
            signs.merge(&power);
        }
        pairs /= 2;
        if pairs > 0 {
            power.merge(&power.clone());
        }
    }
    assert_eq!((signs.draws(), signs.mean()), (n, 0.0));
    signs
}

/// How many std errors the confidence interval reaches to either side.
fn reach(nu: u64, level: f64) -> f64 {
    let estimate = of_signs(nu + 1);
    let [low, high] = estimate.confidence_interval(level).unwrap();
    assert_eq!(low, -high, "{nu}, {level:?}");
    high / estimate.std_error().unwrap()
}

/// What `src/quantile.rs` may be wrong by, relative to t.
///
/// Below 1000 degrees of freedom statrs' ln Γ, up to 2600, loses 4.5e-13 with each rounding, and P and Q with
/// it: 1e-11. From there on the first term left out is 3/40960 (z²/ν)⁵, made about twice as much by its lower
/// powers of z, and the rest is rounding, a few 1e-16.
fn tolerance(nu: f64, t: f64) -> f64 {
    if nu < 1000.0 { 1e-11 } else { 1e-14 + 2e-4 * (t * t / nu).powi(5) }
}

/// A level whose t times the std error, 2⁻³² or more, is a normal number: 1e-290, as bits.
const LEAST: u64 = 1e-290f64.to_bits();

/// Every row of `data/student.csv`, or of another table that `data/student.py` has made: up to 2⁶⁴ − 1 draws.
#[test]
fn confidence_intervals_use_students_quantiles() {
    let table = match std::env::var("UNBIASED_STUDENT") {
        Ok(path) => std::fs::read_to_string(path).unwrap(),
        Err(_) => include_str!("data/student.csv").to_owned(),
    };
    let (mut worst, mut rows) = ((0.0, ""), 0);
    for row in table.lines().skip(1) {
        let fields: Vec<&str> = row.split(',').collect();
        let [nu, level, t] = fields[..] else { panic!("{row}") };
        let truth: f64 = t.parse().unwrap();
        let nu: u64 = nu.parse().unwrap();
        let ours = reach(nu, level.parse().unwrap());
        let error = (ours / truth - 1.0).abs();
        assert!(error <= tolerance(nu as f64, truth), "{row}: {ours:?}");
        worst = if error > worst.0 { (error, row) } else { worst };
        rows += 1;
    }
    println!("{rows} rows, worst: {:.1e} at {}", worst.0, worst.1);
    assert!(rows > 0);
}

/// With statrs' quantile of 0.097 the interval covered the truth in 8 of 100 cases. The half width is as well
/// known as s, whose relative std error is √(0.8/n)/2 for uniform draws: 10 of them (less than 1e-20).
#[test]
fn an_interval_of_109811_uniform_draws_is_as_wide_as_its_neighbours() {
    let mut rng = unbiased::Stream::new(common::seed(2), 0);
    let n = 109_811;
    let draws: Vec<f64> = (0..n).map(|_| rng.uniform()).collect();
    let estimate = Estimate::from_draws(&draws);
    let [low, high] = estimate.confidence_interval(0.95).unwrap();
    let expected = 1.959_985_588 / (12.0 * f64::from(n)).sqrt(); // 0.001707
    let off = ((high - low) / 2.0 / expected - 1.0).abs();
    assert!(off <= 5.0 * (0.8 / f64::from(n)).sqrt(), "{low} to {high}");
    assert_relative_eq!(0.5 * (high + low), estimate.mean(), epsilon = 0.0, max_relative = 1e-15);
}

/// With three normal draws Student's 95 % interval covers exactly 95 %; the normal's would cover 81 %. 20,000
/// trials: a binomial std error of 0.154 %, 7 of them 1.08 % (false alarm 2.6e-12).
#[test]
fn intervals_cover_what_they_claim_even_for_three_draws() {
    use rand_distr::{Distribution, StandardNormal};
    let mut rng = unbiased::Stream::new(common::seed(3), 0);
    let trials = 20_000;
    let covered = (0..trials).filter(|_| {
        let draws: [f64; 3] = std::array::from_fn(|_| StandardNormal.sample(&mut rng));
        let [low, high] = Estimate::from_draws(&draws).confidence_interval(0.95).unwrap();
        low <= 0.0 && 0.0 <= high
    });
    let share = covered.count() as f64 / f64::from(trials);
    assert!(
        (share - 0.95).abs() <= common::deviations(7.0) * (0.95f64 * 0.05 / f64::from(trials)).sqrt(),
        "{share}"
    );
}

#[test]
fn it_shows_as_many_digits_as_its_error_leaves() {
    let show = |draws: &[f64]| Estimate::from_draws(draws).to_string();
    // t = 3.182 for three degrees of freedom, 12.706 for one
    assert_eq!(show(&[1.0, 2.0, 3.0, 4.0]), "2.5 ± 2.1 (95 %)");
    assert_eq!(show(&[1.0, 1.0]), "1 ± 0 (95 %)");
    assert_eq!(show(&[5.0]), "5 (too few draws for an error)");
    assert_eq!(show(&[1e300, 3e300]), "2e300 ± 1.3e301 (95 %)");
    assert_eq!(show(&[1000.0, 3000.0]), "2000 ± 12706 (95 %)");
}

#[test]
fn serde_keeps_every_bit() {
    let mut pushed = Estimate::new();
    (0..1000).for_each(|i| pushed.push(1.0 / f64::from(i + 3)));
    let draws: Vec<f64> = (0..1000).map(|i| 1.0 / f64::from(i + 3)).collect();
    let sliced = Estimate::from_draws(&draws);
    for estimate in [sliced, pushed, Estimate::new(), Estimate::from_draws(&[f64::MAX, -1e-320])] {
        let json = serde_json::to_string(&estimate).unwrap();
        let back = serde_json::from_str::<Estimate>(&json).unwrap();
        assert_eq!(back, estimate);
        assert_eq!(serde_json::to_string(&back).unwrap(), json);
    }
}

/// JSON has no infinity and no NaN, and an estimate may hold both.
#[test]
fn draws_that_are_not_finite_come_back_from_json() {
    for draws in
        [vec![f64::INFINITY], vec![1.0, f64::NEG_INFINITY, 2.0], vec![f64::NAN; 3], vec![0.5, f64::NAN]]
    {
        let estimate = Estimate::from_draws(&draws);
        let json = serde_json::to_string(&estimate).unwrap();
        let back: Estimate = serde_json::from_str(&json).unwrap();
        assert_eq!(serde_json::to_string(&back).unwrap(), json);
        assert_eq!(back.mean().to_string(), estimate.mean().to_string(), "{draws:?}");
    }
    let json = serde_json::to_string(&Estimate::from_draws(&[1.0])).unwrap();
    let wrong = json.replace("1.0", "\"one\"");
    assert!(json != wrong && serde_json::from_str::<Estimate>(&wrong).is_err());
}

/// Merged with itself 64 times, an estimate of one draw has more draws than a `u64` holds: as many as it
/// holds, not 0.
#[test]
fn more_draws_than_can_be_counted_stay_the_most() {
    let mut estimate = Estimate::from_draws(&[1.0, 3.0]);
    for doubling in 1..=70u32 {
        estimate.merge(&estimate.clone());
        assert_eq!(estimate.draws(), 2u64.checked_shl(doubling).filter(|n| *n > 0).unwrap_or(u64::MAX));
        assert_eq!(estimate.mean(), 2.0);
        let spread = estimate.variance().unwrap();
        assert!((1.0..=2.0).contains(&spread), "{spread}");
    }
    let [low, high] = estimate.confidence_interval(0.95).unwrap();
    assert!(low < 2.0 && 2.0 < high);
    // one more, and one more
    for _ in 0..3 {
        estimate.push(2.0);
        assert_eq!((estimate.draws(), estimate.mean()), (u64::MAX, 2.0));
    }
}

#[test]
fn a_draw_that_is_not_finite_shows() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for draws in [vec![bad], vec![1.0, bad, 2.0], vec![bad; 600]] {
            assert!(!Estimate::from_draws(&draws).mean().is_finite(), "{bad}");
        }
    }
}

proptest! {
    #![proptest_config(common::config(2000))]

    /// Any finite draws, of any size, in any order of merging: mean inside their range, error bar not NaN.
    #[test]
    fn any_finite_bits_give_a_mean_in_range(bits in prop::collection::vec(any::<u64>(), 2..40),
        split in 0usize..40) {
        let draws: Vec<f64> = bits.into_iter().map(f64::from_bits).filter(|x| x.is_finite()).collect();
        prop_assume!(draws.len() >= 2);
        let (left, right) = draws.split_at(split.min(draws.len()));
        let mut merged = Estimate::from_draws(left);
        merged.merge(&Estimate::from_draws(right));
        let low = draws.iter().copied().fold(f64::INFINITY, f64::min);
        let high = draws.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // the mean of opposite draws is rounding away from 0 by their size
        let slack = 1e-15 * low.abs().max(high.abs());
        prop_assert!(low - slack <= merged.mean() && merged.mean() <= high + slack, "{} not in \
            {low}..{high}", merged.mean());
        prop_assert!(merged.std_error().unwrap() >= 0.0);
        prop_assert!(merged.variance().unwrap() >= 0.0);
    }

    /// Intervals grow with the level and shrink with the degrees of freedom, to the normal's.
    #[test]
    fn intervals_are_monotone(
        (nu, bits) in (any::<[u64; 2]>(), [0u32..64, 0u32..64]),
        any_level in [LEAST..1.0f64.to_bits(), LEAST..1.0f64.to_bits()],
        usual in prop::option::of((1e-12..1.0f64, 1e-12..16.0f64)),
    ) {
        const MOST: u64 = u64::MAX - 1;
        let mut nu = [nu[0] >> bits[0], nu[1] >> bits[1]].map(|nu| nu.clamp(1, MOST));
        let mut level = match usual {
            Some((level, nines)) => [level, (1.0 - 10f64.powf(-nines)).min(1.0f64.next_down())],
            None => any_level.map(f64::from_bits),
        };
        nu.sort_unstable();
        level.sort_by(f64::total_cmp);
        // where the truths are nearer to each other than the digits, either may be the larger; the worst t is
        // 8.44, at 1000 degrees of freedom and the level next to 1
        let up = 1.0 + 2.0 * tolerance(1000.0, 8.44);
        for nu in nu {
            prop_assert!(reach(nu, level[0]) <= up * reach(nu, level[1]), "{nu} {level:?}");
        }
        for level in level {
            let [wide, narrow, normal] = [nu[0], nu[1], MOST].map(|nu| reach(nu, level));
            prop_assert!(0.0 < normal && normal <= up * narrow, "{nu:?} {level:?}");
            prop_assert!(narrow <= up * wide && wide < 1e16, "{nu:?} {level:?}");
        }
    }
}

/// z = (mean − truth)/std error, and 0 for a difference that is rounding: up to 8 units of the truth's last
/// place, whatever its size.
#[test]
fn z_counts_std_errors_beyond_rounding() {
    let estimate = Estimate::from_draws(&[1.0, 2.0, 3.0, 4.0]);
    let std_error = (5.0_f64 / 12.0).sqrt();
    for truth in [2.0, 3.25, -7.0] {
        let z = estimate.z(truth).unwrap();
        assert!((z * std_error - (2.5 - truth)).abs() <= 1e-14, "{z}");
    }
    for truth in [1e-200, 1e-3, 1.0, 1e3, -1e200] {
        let off =
            |ulps: f64| Estimate::from_draws(&[truth * (1.0 + ulps * f64::EPSILON); 3]).z(truth).unwrap();
        assert_eq!(off(0.0), 0.0);
        assert_eq!(off(7.0), 0.0, "{truth:e}");
        assert_eq!(off(9.0), f64::INFINITY.copysign(truth), "{truth:e}");
        assert_eq!(off(-9.0), f64::INFINITY.copysign(-truth), "{truth:e}");
    }
    // an infinite truth is infinitely far away, and one that is no number nowhere
    for (truth, z) in
        [(f64::INFINITY, Some(f64::NEG_INFINITY)), (f64::NEG_INFINITY, Some(f64::INFINITY)), (f64::NAN, None)]
    {
        assert_eq!(estimate.z(truth), z);
        assert_eq!(Estimate::from_draws(&[1.0; 3]).z(truth), z);
    }
    assert_eq!(Estimate::from_draws(&[f64::INFINITY, 1.0]).z(f64::INFINITY), None);
    assert_eq!(Estimate::from_draws(&[0.0; 3]).z(0.0), Some(0.0));
}

proptest! {
    #![proptest_config(common::config(500))]

    /// Draws taken one at a time give the moments of the slice. Each square is rounded to 2⁻⁵² of itself and
    /// at most twice what is left of it at the end: 8 units in the last place in all, where none is out of
    /// range.
    #[test]
    fn one_at_a_time_is_as_good_as_a_slice(
        words in prop::collection::vec(any::<u32>(), 2..3000),
        offset in prop::sample::select(vec![0.0, 1.0, -1e6, 1e10, 1e15]),
        size in prop::sample::select(vec![1.0, 1e-150, 1e-300, 1e250, 1e300]),
        first in prop::sample::select(vec![0.0, 1e3, -1e9]),
    ) {
        let mut draws: Vec<f64> = words.iter().map(|word|
            (offset + f64::from(*word) / 4294967296.0) * size).collect();
        draws[0] += first * size;
        prop_assume!(draws.iter().all(|draw| draw.is_finite()));
        let mut pushed = Estimate::new();
        draws.iter().for_each(|draw| pushed.push(*draw));
        let sliced = Estimate::from_draws(&draws);
        prop_assert_eq!(pushed.draws(), sliced.draws());
        prop_assert_eq!(pushed.mean(), sliced.mean());
        let [a, b] = [pushed, sliced].map(|estimate| estimate.std_error().unwrap());
        prop_assert!((a - b).abs() <= 8.0 * f64::EPSILON * b, "{} {}", a, b);
    }

    /// One after the other, draws of any size, equal ones too: as merged one by one.
    #[test]
    fn any_draws_can_be_taken_one_at_a_time(bits in prop::collection::vec(any::<u64>(), 2..60),
        repeat in 1usize..5) {
        let draws = bits.into_iter().map(f64::from_bits).filter(|x| x.is_finite());
        let draws: Vec<f64> = draws.flat_map(|x| std::iter::repeat_n(x, repeat)).collect();
        prop_assume!(draws.len() >= 2);
        let (mut pushed, mut merged) = (Estimate::new(), Estimate::new());
        for draw in &draws {
            pushed.push(*draw);
            merged.merge(&Estimate::from_draws(&[*draw]));
        }
        prop_assert_eq!(pushed.draws(), merged.draws());
        let [a, b] = [pushed, merged].map(|estimate| (estimate.mean(), estimate.std_error().unwrap()));
        let size = draws.iter().fold(0.0f64, |size, x| size.max(x.abs()));
        prop_assert!((a.0 / size - b.0 / size).abs() <= 4.0 * f64::EPSILON, "{:?} {:?}", a, b);
        prop_assert!((a.1 - b.1).abs() <= 1e-14 * b.1 || a.1 == b.1, "{:?} {:?}", a, b);
    }
}
