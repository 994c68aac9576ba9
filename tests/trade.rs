//! Speed against accuracy: what is measured, and what follows from it; Genz's families.

mod common;

use approx::assert_relative_eq;
use proptest::prelude::*;
use unbiased::rectangle::{Family, Genz, Rectangle};
use unbiased::trade::{Comparison, Crossing, Measured, Nature, Reach, Rival, Trade};
use unbiased::{Budget, Error, Estimate, from_fn};

fn compare(rivals: &[Rival<'_>], truth: f64) -> Comparison {
    Trade::new(common::seed(1), truth).unwrap().seconds_each(0.02).unwrap().compare(rivals).unwrap()
}

/// Draws of the rivals below: the std error of their mean is 1 % of σ.
const DRAWS: usize = 10_000;

/// A rival with these numbers.
fn measured(nature: Nature, mean: f64, variance: f64, seconds: f64) -> Measured {
    // draws with this mean and variance
    let apart = (variance * (DRAWS - 1) as f64 / DRAWS as f64).sqrt();
    let draws: Vec<f64> = (0..DRAWS).map(|i| if i % 2 == 0 { mean - apart } else { mean + apart }).collect();
    Measured {
        name: "rival".into(),
        series: None,
        nature,
        estimate: Estimate::from_draws(&draws),
        truth: 2.0,
        truth_error: 0.0,
        variance_error: 0.01 * variance,
        heavy_tail: false,
        evaluations: 1.0,
        random_numbers: 1.0,
        seconds,
        seconds_range: [seconds, seconds],
    }
}

fn named(name: &str, rival: Measured) -> Measured {
    Measured { name: name.into(), ..rival }
}

fn comparison(rivals: impl IntoIterator<Item = Measured>) -> Comparison {
    Comparison { seed: 1, truth: 2.0, truth_error: 0.0, rivals: rivals.into_iter().collect() }
}

/// The names in their order, with their ranks and whether the one before is really better.
fn order(comparison: &Comparison) -> Vec<(&str, usize, bool)> {
    comparison
        .ranking()
        .iter()
        .map(|place| (place.rival.name.as_str(), place.rank, place.set_apart))
        .collect()
}

/// False alarms: each z-test 7σ, 2.6e-12 (the draws, some 10⁵ of them, have bounded kurtosis). A variance
/// that is wrong by 5 % is seen.
#[test]
fn variances_costs_and_means_are_those_of_the_rivals() {
    let uniform = from_fn(|rng| {
        rng.count_evaluations(3);
        rng.uniform()
    });
    let mean_of_two = from_fn(|rng| 0.5 * (rng.uniform() + rng.uniform()));
    let found = compare(&[Rival::new("one", uniform), Rival::new("two", mean_of_two)], 0.5);
    let [one, two] = &found.rivals[..] else { panic!("two rivals") };
    for (rival, variance) in [(one, 1.0 / 12.0), (two, 1.0 / 24.0)] {
        assert!(
            (rival.variance() - variance).abs() <= common::deviations(7.0) * rival.variance_error,
            "{rival:?}"
        );
        assert!(rival.variance_error <= 0.05 * variance, "too few draws to tell: {rival:?}");
        assert!(
            (rival.estimate.mean() - 0.5).abs()
                <= common::deviations(7.0) * (variance / rival.estimate.draws() as f64).sqrt(),
            "{rival:?}"
        );
        let [low, high] = rival.seconds_range;
        assert!(0.0 < low && low <= rival.seconds && rival.seconds <= high);
        assert!(!rival.heavy_tail && rival.varies());
    }
    assert_eq!([one.evaluations, one.random_numbers], [3.0, 1.0]);
    assert_eq!([two.evaluations, two.random_numbers], [0.0, 2.0]);
}

#[test]
fn more_work_for_the_same_draw_is_less_efficient() {
    let plain = from_fn(|rng| rng.uniform());
    let wasteful = from_fn(|rng| {
        for _ in 0..400 {
            std::hint::black_box(rng.uniform());
        }
        rng.uniform()
    });
    let found = compare(&[Rival::new("wasteful", wasteful), Rival::new("plain", plain)], 0.5);
    let places = found.ranking();
    assert_eq!(places[0].rival.name, "plain");
    assert_eq!(places[0].of_the_best, 1.0);
    // 400 random numbers more: on any machine, however loaded, far more than twice the time
    assert!(places[1].of_the_best < 0.5, "{places:?}");
}

/// The sum of squares of 1/(1 − U) is a stable law of index ½, whose largest term holds less than t of it
/// with a probability of about e^(−0.85/t) (Darling 1952): at 10⁵ draws t = 0.0034, and at 10⁴ 0.026,
/// e^(−32). A bounded draw never holds more than 12/n of it, to 7σ of the variance. More of it, for fixed
/// numbers of draws, beside the code.
#[test]
fn a_heavy_tail_is_marked() {
    let heavy = from_fn(|rng| (1.0 - rng.uniform()).recip());
    let light = from_fn(|rng| rng.uniform());
    let found = compare(&[Rival::new("heavy", heavy), Rival::new("light", light)], 1.0);
    assert!(found.rivals[0].heavy_tail);
    assert!(!found.rivals[1].heavy_tail);
    assert!(found.to_string().contains("a few draws make up most of the variance, which may be infinite"));
    // the light one may be told apart or not: what looks best may have an infinite variance
    assert!(found.ranking().iter().all(|place| place.rank == 1 || place.rival.name == "heavy"));
}

/// However slow the draws are beside the time asked for, there are two of them in each of 17 batches, and so
/// few never have a heavy tail.
#[test]
fn slow_draws_are_few() {
    for seed in 1..=20 {
        let exponential = from_fn(|rng| -(1.0 - rng.uniform()).ln());
        let trade = Trade::new(common::seed(seed), 1.0).unwrap().seconds_each(1e-12).unwrap();
        let found = trade.compare(&[Rival::new("slow", exponential)]).unwrap();
        assert_eq!(found.rivals[0].estimate.draws(), 34);
        assert!(!found.rivals[0].heavy_tail);
        let [low, high] = found.rivals[0].seconds_range;
        assert!(low <= found.rivals[0].seconds && found.rivals[0].seconds <= high);
    }
}

#[test]
fn errors_times_and_crossings_follow_from_variance_and_bias() {
    let unbiased = measured(Nature::Unbiased, 2.1, 4.0, 0.5);
    // √(4 · 0.5/T)
    assert_relative_eq!(unbiased.rmse(8.0), 0.5, epsilon = 0.0, max_relative = 1e-13);
    assert_eq!((unbiased.bias(), unbiased.bias_error(), unbiased.bias_seen()), (0.0, 0.0, false));
    // an error of 1 % of 2 takes T = 2/0.02²
    let seconds = |reach: Reach| reach.seconds().unwrap();
    assert_relative_eq!(seconds(unbiased.seconds_to(0.01)), 5000.0, epsilon = 0.0, max_relative = 1e-13);
    assert_relative_eq!(unbiased.efficiency(), 0.5, epsilon = 0.0, max_relative = 1e-13);
    // never less than one draw
    assert_eq!(unbiased.seconds_to(100.0), Reach::After(0.5));
    assert_eq!(unbiased.seconds_to(0.0), Reach::Never);
    assert_eq!(unbiased.seconds_to(f64::NAN), Reach::Never);

    // a bias of 0.1 ± 0.01
    let biased = measured(Nature::Biased, 2.1, 1.0, 0.5);
    assert!(biased.bias_seen());
    assert_relative_eq!(biased.bias_error(), 0.01, epsilon = 0.0, max_relative = 1e-13);
    assert_relative_eq!(biased.rmse(f64::INFINITY), 0.1, epsilon = 0.0, max_relative = 1e-13);
    // 0.02 is below 0.1 − 0.03, 0.2 above 0.1 + 0.03
    assert_eq!(biased.seconds_to(0.01), Reach::Never);
    // (0.2² − 0.1²) T = 0.5
    assert_relative_eq!(seconds(biased.seconds_to(0.1)), 0.5 / 0.03, epsilon = 0.0, max_relative = 1e-12);
    // in between: at least as long as with the smallest bias
    let Reach::AtLeast(least) = biased.seconds_to(0.05) else { panic!("{:?}", biased.seconds_to(0.05)) };
    assert_relative_eq!(least, 0.5 / (0.1 * 0.1 - 0.07 * 0.07), epsilon = 0.0, max_relative = 1e-11);
    // 2/T = 0.01 + 0.5/T at T = 150
    let Crossing::At { seconds, rmse } = biased.overtaken_at(&unbiased) else { panic!("no crossing") };
    assert_relative_eq!(seconds, 150.0, epsilon = 0.0, max_relative = 1e-12);
    assert_relative_eq!(rmse, (2.0f64 / 150.0).sqrt(), epsilon = 0.0, max_relative = 1e-12);
    assert_relative_eq!(biased.rmse(seconds), rmse, epsilon = 0.0, max_relative = 1e-12);
    assert_eq!(unbiased.overtaken_at(&biased), Crossing::Unknown);
    // one that is cheaper without bias has overtaken from the start, with and without a bias that is seen
    for mean in [2.1, 3.0] {
        let slow = measured(Nature::Biased, mean, 8.0, 0.5);
        assert_eq!(slow.overtaken_at(&unbiased), Crossing::FromTheStart);
    }
    let cheap = measured(Nature::Unbiased, 2.0, 4.0, 0.1);
    assert_eq!(cheap.overtaken_at(&unbiased), Crossing::Never);
    assert_eq!(unbiased.overtaken_at(&cheap), Crossing::FromTheStart);

    let infinite = measured(Nature::InfiniteVariance, 2.0, 1e3, 0.5);
    assert_eq!((infinite.efficiency(), infinite.variance()), (0.0, f64::INFINITY));
    assert!([1.0, 1e9, f64::INFINITY].iter().all(|seconds| infinite.rmse(*seconds) == f64::INFINITY));
    assert_eq!(infinite.seconds_to(0.5), Reach::Never);
    assert_eq!(biased.overtaken_at(&infinite), Crossing::Never);
    assert_eq!(infinite.overtaken_at(&unbiased), Crossing::FromTheStart);

    let constant = measured(Nature::Unbiased, 2.0, 1e-32, 0.5);
    assert_eq!(constant.efficiency(), f64::INFINITY);
    assert!(!constant.varies());
}

/// A bias of less than three of its std errors (0.01, or with the truth's own √(0.01² + 0.01²)) may be none.
#[test]
fn a_bias_of_pure_noise_is_not_seen() {
    let unbiased = measured(Nature::Unbiased, 2.0, 4.0, 0.5);
    for (mean, truth_error, seen) in [
        (2.0 + 0.0299, 0.0, false),
        (2.0 + 0.0301, 0.0, true),
        (2.0 - 0.0301, 0.0, true),
        (2.0 + 0.0301, 0.01, false),
        (2.0 - 0.0425, 0.01, true),
    ] {
        let rival = Measured { truth_error, ..measured(Nature::Biased, mean, 1.0, 0.5) };
        assert_eq!(rival.bias_seen(), seen, "{mean} ± {truth_error}");
        let crossing = rival.overtaken_at(&unbiased);
        assert_eq!(matches!(crossing, Crossing::At { .. }), seen);
        assert_eq!(crossing == Crossing::Unknown, !seen);
        let remark = comparison([unbiased.clone(), rival.clone()]).rows().pop().unwrap().pop().unwrap();
        assert_eq!(remark.starts_with("no bias seen: "), !seen, "{remark}");
        assert_eq!(remark.contains("overtaken"), seen, "{remark}");
        if !seen {
            // 0.002 is within what three std errors allow: not known, but at least as long as without a bias
            let Reach::AtLeast(least) = rival.seconds_to(1e-3) else {
                panic!("{:?}", rival.seconds_to(1e-3))
            };
            assert_relative_eq!(least, 0.5 / 4e-6, epsilon = 0.0, max_relative = 1e-12);
            assert_eq!(rival.rmse(f64::INFINITY), 0.0);
        }
        // 0.4 is far above it
        assert!(matches!(rival.seconds_to(0.2), Reach::After(_)));
    }
    // without variance what is left is rounding
    let exact = measured(Nature::Biased, 2.0 + f64::EPSILON, 0.0, 0.5);
    assert!(!exact.bias_seen());
    assert!(measured(Nature::Biased, 2.0 + 1e-12, 0.0, 0.5).bias_seen());
}

#[test]
fn a_ranking_says_which_differences_are_real() {
    let rivals = [(1.0, "b"), (0.5, "a"), (1.01, "c")]
        .map(|(variance, name)| named(name, measured(Nature::Unbiased, 2.0, variance, 1.0)));
    let biased = measured(Nature::Biased, 2.5, 0.1, 1.0);
    let comparison = comparison(rivals.into_iter().chain([biased]));
    // variances known to 1 %: 0.5 and 1 are apart, 1 and 1.01 are not; the biased one has no place
    assert_eq!(order(&comparison), [("a", 1, true), ("b", 2, true), ("c", 2, false)]);
    assert_relative_eq!(comparison.ranking()[1].of_the_best, 0.5, epsilon = 0.0, max_relative = 1e-13);
    assert!(comparison.to_string().contains("not told apart from the one above"));
}

/// A median's std error is 1.253 σ/√17, σ the distance of the quartiles over 1.349; two of them make √2 times
/// that.
#[test]
fn the_spread_of_the_times_decides_what_is_real() {
    let width = 0.1;
    let reach = 3.0 * 2f64.sqrt() * 1.253 * width / 1.349 / 17f64.sqrt();
    for (lead, apart) in [(0.99 * reach, false), (1.01 * reach, true)] {
        let with_time = |seconds: f64| Measured {
            variance_error: 0.0,
            seconds_range: [0.96 * seconds, (0.96 + width) * seconds],
            ..measured(Nature::Unbiased, 2.0, 1.0, seconds)
        };
        for variance in [1.0, 0.0] {
            // without variance the time alone counts
            let rivals = [("fast", 1.0), ("slow", lead.exp())].map(|(name, seconds)| Measured {
                estimate: measured(Nature::Unbiased, 2.0, variance, 1.0).estimate,
                ..named(name, with_time(seconds))
            });
            let comparison = comparison(rivals.into_iter().rev());
            assert_eq!(order(&comparison), [("fast", 1, true), ("slow", if apart { 2 } else { 1 }, apart)]);
            let part = comparison.ranking()[1].of_the_best;
            assert_relative_eq!(part, (-lead).exp(), epsilon = 0.0, max_relative = 1e-12);
        }
    }
}

#[test]
fn the_truths_error_reaches_every_rival() {
    let trade = Trade::new(1, 0.5).unwrap().known_to(0.25).unwrap().seconds_each(1e-9).unwrap();
    let uniform = || from_fn(|rng| rng.uniform());
    let rivals = [Rival::new("a", uniform()), Rival::new("b", uniform()).nature(Nature::Biased)];
    let found = trade.compare(&rivals).unwrap();
    assert_eq!((found.truth_error, found.rivals[1].truth_error), (0.25, 0.25));
    assert!(found.rivals[1].bias_error() > 0.25 && found.rivals[0].bias_error() == 0.0);
}

/// Of a chain in which no one is told apart from its neighbour the ends are.
#[test]
fn ranks_see_through_chains() {
    // each 4 % behind the one before; three std errors of the difference are 4.2 %
    let rivals = (0..4).map(|k| named(&k.to_string(), measured(Nature::Unbiased, 2.0, 1.04f64.powi(k), 1.0)));
    let comparison = comparison(rivals);
    assert_eq!(order(&comparison), [("0", 1, true), ("1", 1, false), ("2", 2, false), ("3", 3, false)]);
}

#[test]
fn no_variance_leads_and_infinite_variance_comes_last() {
    let comparison = comparison([
        named("infinite", measured(Nature::InfiniteVariance, 2.0, 1.0, 1e-9)),
        named("another", measured(Nature::InfiniteVariance, 2.0, 2.0, 1e-9)),
        named("varies", measured(Nature::Unbiased, 2.0, 1.0, 1e-6)),
        named("slow", measured(Nature::Unbiased, 2.0, 0.0, 2.0)),
        named("fast", measured(Nature::Unbiased, 2.0, 0.0, 1.0)),
    ]);
    let expected = [
        ("fast", 1, true),
        ("slow", 2, true),
        ("varies", 3, true),
        ("infinite", 4, true),
        ("another", 4, false),
    ];
    assert_eq!(order(&comparison), expected);
    let parts: Vec<f64> = comparison.ranking().iter().map(|place| place.of_the_best).collect();
    assert_eq!(parts, [1.0, 0.5, 0.0, 0.0, 0.0]);
    let rows = comparison.rows();
    assert_eq!([&rows[3][1], &rows[3][5], &rows[3][6]], ["∞", "0", "never"]);
    assert_eq!(rows[3].last().unwrap(), "infinite variance");
    assert_eq!(rows[1].last().unwrap(), "no variance");
    // alone, it is not efficient either
    let alone = self::comparison([measured(Nature::InfiniteVariance, 2.0, 1.0, 1.0)]);
    assert_eq!(alone.ranking()[0].of_the_best, 0.0);

    // what looks best may have an infinite variance; what looks worse is worse, and may be more so
    let heavy = Measured { heavy_tail: true, ..measured(Nature::Unbiased, 2.0, 0.1, 1.0) };
    let light = measured(Nature::Unbiased, 2.0, 1.0, 1.0);
    let above = self::comparison([named("heavy", heavy.clone()), named("light", light.clone())]);
    assert_eq!(order(&above), [("heavy", 1, true), ("light", 1, false)]);
    let best = named("best", measured(Nature::Unbiased, 2.0, 0.01, 1.0));
    let below = self::comparison([named("heavy", heavy), best]);
    assert_eq!(order(&below), [("best", 1, true), ("heavy", 2, true)]);
}

#[test]
fn slopes_are_those_of_a_series() {
    let of = |series: &str, points: f64, variance: f64| Measured {
        series: Some(series.into()),
        evaluations: points,
        ..measured(Nature::Unbiased, 2.0, variance, 1.0)
    };
    let found = comparison([
        of("jittered", 64.0, 1.0),
        of("jittered", 4096.0, 1.0 / 4096.0),
        of("Sobol", 4096.0, 1.0 / 64f64.powi(3)),
        of("Sobol", 64.0, 1.0),
        of("alone", 64.0, 1.0),
        measured(Nature::Unbiased, 2.0, 1.0, 1.0),
        Measured { nature: Nature::InfiniteVariance, ..of("jittered", 128.0, 1.0) },
    ]);
    let slopes: Vec<Option<f64>> = found.rivals.iter().map(|rival| found.slope(rival)).collect();
    assert_relative_eq!(slopes[1].unwrap(), -1.0, epsilon = 0.0, max_relative = 1e-12);
    assert_relative_eq!(slopes[2].unwrap(), -1.5, epsilon = 0.0, max_relative = 1e-12);
    assert!([0, 3, 4, 5, 6].iter().all(|index| slopes[*index].is_none()), "{slopes:?}");

    // z ≤ 7. In a cell of width h = 1/s about (x, y) the variance of XY is (x² + y²) v + v² with v = h²/12;
    // summed over the cells, (2v(s²/3 − 1/12) + s² v²)/s⁴
    let exact = |s: f64| {
        let v = 1.0 / (12.0 * s * s);
        (2.0 * v * (s * s / 3.0 - 1.0 / 12.0) + s * s * v * v) / s.powi(4)
    };
    let square = Rectangle::new([0.0, 1.0], [0.0, 1.0]).unwrap();
    let rivals =
        [2, 8].map(|side| Rival::new("", square.jittered(|x, y| x * y, side).unwrap()).series("jittered"));
    let found = compare(&rivals, 0.25);
    assert_eq!(found.rivals.iter().map(|rival| rival.evaluations).collect::<Vec<_>>(), [4.0, 64.0]);
    let slope = found.slope(&found.rivals[1]).unwrap();
    let expected = 0.5 * (exact(8.0) / exact(2.0)).ln() / 16f64.ln();
    let [a, b] = [0, 1].map(|index| found.rivals[index].variance_error / found.rivals[index].variance());
    assert!(
        (slope - expected).abs() <= common::deviations(7.0) * 0.5 * a.hypot(b) / 16f64.ln(),
        "{slope}, not {expected}"
    );
}

#[test]
fn every_number_stands_in_its_own_column() {
    let rival = Measured {
        truth_error: 0.001,
        evaluations: 3.0,
        random_numbers: 7.0,
        seconds_range: [0.9e-6, 1.2e-6],
        series: Some("cut".into()),
        ..named("biased", measured(Nature::Biased, 2.5, 0.25, 1e-6))
    };
    let best = Measured {
        seconds_range: [0.9e-6, 1.2e-6],
        ..named("best", measured(Nature::Unbiased, 2.0, 4.0, 1e-6))
    };
    let found = comparison([best.clone(), rival.clone()]);
    let record = serde_json::to_value(&found).unwrap()["rivals"][1].clone();
    let Some(Crossing::At { seconds, rmse }) = found.crossing(&rival) else { panic!("no crossing") };
    for (name, expected) in [
        ("draws", DRAWS as f64),
        ("mean", 2.5),
        ("std_error", 0.005),
        ("truth", 2.0),
        ("truth_error", 0.001),
        ("bias", 0.5),
        ("bias_error", 0.005f64.hypot(0.001)),
        ("variance", 0.25),
        ("variance_error", 0.0025),
        ("evaluations", 3.0),
        ("random_numbers", 7.0),
        ("seconds", 1e-6),
        ("seconds_low", 0.9e-6),
        ("seconds_high", 1.2e-6),
        ("efficiency", 4e6),
        ("crossing_seconds", seconds),
        ("crossing_error", rmse),
    ] {
        let value = record[name].as_f64().unwrap_or_else(|| panic!("{name}: {}", record[name]));
        assert_relative_eq!(value, expected, epsilon = 0.0, max_relative = 1e-12);
    }
    for (name, expected) in [("name", "biased"), ("series", "cut"), ("nature", "biased"), ("crossing", "at")]
    {
        assert_eq!(record[name], expected);
    }
    assert_eq!((&record["bias_seen"], &record["heavy_tail"]), (&true.into(), &false.into()));
    let of_best = serde_json::to_value(&found).unwrap()["rivals"][0].clone();
    assert_eq!((&of_best["rank"], &of_best["set_apart"]), (&1.into(), &true.into()));
    for (name, error) in [
        ("seconds_to_1e-2", 1e-2),
        ("seconds_to_1e-3", 1e-3),
        ("seconds_to_1e-4", 1e-4),
        ("seconds_to_1e-5", 1e-5),
    ] {
        // σ² t = 4e-6, and a truth of 2
        let value = of_best[name].as_f64().unwrap();
        assert_relative_eq!(value, 1e-6 / (error * error), epsilon = 0.0, max_relative = 1e-12);
    }
}

/// Relative errors of 0 mean nothing: they are absolute.
#[test]
fn a_truth_of_0_makes_errors_absolute() {
    let zero = |rival: Measured| Measured { truth: 0.0, ..rival };
    let unbiased = zero(measured(Nature::Unbiased, 0.0, 4.0, 0.5));
    assert_relative_eq!(
        unbiased.seconds_to(0.1).seconds().unwrap(),
        200.0,
        epsilon = 0.0,
        max_relative = 1e-12
    );
    let biased = zero(measured(Nature::Biased, 0.1, 1.0, 0.5));
    let comparison = Comparison { truth: 0.0, ..comparison([unbiased, biased]) };
    let (columns, rows) = (comparison.columns(), comparison.rows());
    assert_eq!([columns[1], columns[6]], ["σ", "to 10⁻² (absolute)"]);
    assert_eq!([rows[0][1].as_str(), &rows[0][6]], ["2.0", "20000 s"]);
    let remark = rows[1].last().unwrap();
    assert_eq!(remark, "bias 0.100 ± 0.020 (95 %); overtaken by the best after 150 s, at 0.12");
}

/// CSV, by the rules of RFC 4180.
fn fields(line: &str) -> Vec<String> {
    let (mut fields, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            _ => fields.last_mut().unwrap().push(c),
        }
    }
    fields
}

#[test]
fn the_table_json_and_csv_agree() {
    let comparison = comparison([
        named("plain", measured(Nature::Unbiased, 2.0, 1.0, 1e-6)),
        named("with, comma", measured(Nature::Unbiased, 2.0, 1.0, 3e-6)),
        named("biased", measured(Nature::Biased, 2.5, 0.1, 1e-6)),
        named("not seen", measured(Nature::Biased, 2.001, 0.1, 1e-6)),
        named("infinite", measured(Nature::InfiniteVariance, 2.0, 1.0, 1e-6)),
        named("exact", measured(Nature::Unbiased, 2.0, 0.0, 1e-3)),
        named("heavy", Measured { heavy_tail: true, ..measured(Nature::Unbiased, 2.0, 9.0, 1e-6) }),
    ]);
    let csv = comparison.csv();
    let mut lines = csv.lines().map(fields);
    let names = lines.next().unwrap();
    let json = serde_json::to_value(&comparison).unwrap();
    assert_eq!((&json["seed"], &json["truth"], &json["truth_error"]), (&1.into(), &2.0.into(), &0.0.into()));
    let records = json["rivals"].as_array().unwrap();
    assert_eq!(records.len(), 7);
    for (line, record) in lines.zip(records) {
        assert_eq!((line.len(), record.as_object().unwrap().len()), (names.len(), names.len()));
        for (name, cell) in names.iter().zip(&line) {
            let value = &record[name.as_str()];
            let same = match value {
                serde_json::Value::Null => cell.is_empty() || cell == "inf",
                serde_json::Value::String(text) => cell == text,
                serde_json::Value::Number(number) => cell.parse() == Ok(number.as_f64().unwrap()),
                serde_json::Value::Bool(flag) => cell.parse() == Ok(*flag),
                other => panic!("{name}: {other}"),
            };
            assert!(same, "{name}: {cell} and {value}");
        }
    }
    let table = comparison.to_string();
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines[0].starts_with("estimator ") && lines[0].ends_with("remark"));
    for (row, line) in comparison.rows().iter().zip(&lines[1..]) {
        assert_eq!(row.len(), comparison.columns().len());
        let record = records.iter().find(|record| record["name"] == row[0].as_str()).unwrap();
        assert_eq!(record["rank"].as_u64().map_or(String::new(), |rank| rank.to_string()), row[4]);
        assert!(line.starts_with(&row[0]) && line.ends_with(row.last().unwrap()), "{line}");
        assert_eq!(record["heavy_tail"] == true, row.last().unwrap().contains("a few draws"));
    }
    let rows = comparison.rows();
    assert_eq!(
        rows.iter().map(|row| row[0].as_str()).collect::<Vec<_>>(),
        ["exact", "plain", "with, comma", "heavy", "infinite", "biased", "not seen"]
    );
    let plain = &rows[1];
    // σ = 1, a truth of 2: 1 % is 0.02, after 1e-6/0.0004 s
    assert_eq!(
        plain[1..],
        ["0.50", "1.0", "1.00 ± 0.00 µs", "2", "0", "2.5 ms", "250 ms", "25 s", "2500 s", ""]
    );
    let record = |name: &str| records.iter().find(|record| record["name"] == name).unwrap();
    assert_eq!(record("biased")["crossing"], "from_the_start");
    assert_eq!(
        [&record("not seen")["bias_seen"], &record("not seen")["seconds_to_1e-5"]],
        [&false.into(), &serde_json::Value::Null]
    );
    assert_eq!(record("plain")["bias"], serde_json::Value::Null);
    // nothing but the columns' names of none
    assert_eq!(self::comparison([]).csv().lines().count(), 1);
    assert_eq!(self::comparison([]).rows().len(), 0);
}

/// Where rivals count different work, all are given in random numbers.
#[test]
fn work_has_one_unit() {
    let counts = |evaluations: f64| Measured {
        evaluations,
        random_numbers: 7.0,
        ..measured(Nature::Unbiased, 2.0, 1.0, 1.0)
    };
    let both = comparison([counts(3.0), counts(4.0)]);
    assert_eq!((both.unit_of_work(), both.work(&both.rivals[1])), ("evaluations", 4.0));
    let one = comparison([counts(3.0), counts(0.0)]);
    assert_eq!((one.unit_of_work(), one.work(&one.rivals[0])), ("random numbers", 7.0));
}

#[cfg(feature = "workbook")]
#[test]
fn figures_leave_nothing_out_in_silence() {
    let many = (0..18)
        .map(|k| named(&format!("rival {k:02}"), measured(Nature::Unbiased, 2.0, 1.5f64.powi(k), 1e-8)));
    let drawn = unbiased::trade::figures::comparison("trade_test", "Many", &comparison(many)).unwrap();
    assert!(drawn.svg().contains("Not drawn, as there are only sixteen kinds of lines: rival 16, rival 17."));
    assert!((0..16).all(|k| drawn.csv().contains(&format!("Efficiency,rival {k:02},"))));
    // 1.5¹⁷ = 985
    assert!(drawn.svg().contains("× 985"));

    let pair = |variance: f64, evaluations: f64| {
        let best = measured(Nature::Unbiased, 2.0, 1.0, 1e-8);
        let other = Measured { evaluations, ..measured(Nature::Unbiased, 2.0, variance, 1e-8) };
        unbiased::trade::figures::comparison("trade_test", "Two", &comparison([best, other]))
            .unwrap()
            .svg()
            .to_owned()
    };
    // within the axes; beyond them, a round number below; not told apart: none
    assert!(pair(3.0, 1.0).contains("× 3.0") && !pair(3.0, 1.0).contains("&gt; ×"));
    assert!(pair(1e9, 1.0).contains("&gt; × 10000"));
    assert!(
        !pair(1.03, 1.0).contains('×') && !pair(1.9, 1.0).contains('×') && pair(2.1, 1.0).contains("× 2.1")
    );
    assert!(pair(3.0, 1.0).contains("evaluations or rays") && pair(3.0, 0.0).contains("random numbers"));

    // nothing to draw, and things that cannot be
    let odd = [
        measured(Nature::InfiniteVariance, 2.0, 1.0, 1e-8),
        measured(Nature::Unbiased, 2.0, 0.0, 1e-8),
        Measured { random_numbers: 0.0, evaluations: 0.0, ..measured(Nature::Unbiased, 2.0, 1.0, 1e-8) },
        measured(Nature::Biased, 2.001, 1.0, 1e-8),
    ];
    for rivals in [
        vec![],
        odd[..1].to_vec(),
        odd[1..2].to_vec(),
        odd[..2].to_vec(),
        odd[2..3].to_vec(),
        odd[3..].to_vec(),
        odd.to_vec(),
    ] {
        let found =
            unbiased::trade::figures::comparison("trade_test", "Odd", &comparison(rivals.clone())).unwrap();
        assert!(!found.svg().contains("NaN") && !found.csv().contains("NaN"), "{rivals:?}");
        assert_eq!(
            found.svg().contains(">infinite variance<") || found.svg().contains("infinite variance\n"),
            rivals.iter().any(|rival| rival.nature == Nature::InfiniteVariance)
        );
    }
}

/// The reference in `examples/trade.rs` for all bounces in the sheet's scene: z ≤ 7, a false alarm in 4e11;
/// at 2·10⁵ paths it sees what is wrong by 0.3 %.
#[test]
fn the_reference_for_all_bounces_is_right() {
    use unbiased::paths::room::{BoxRoom, Scene};
    use unbiased::paths::{Bounces, FindLight, Paths};
    let source = include_str!("../examples/trade.rs");
    let given = source.split_once("const ALL_LIGHT: [f64; 2] = [").unwrap().1.split_once(']').unwrap().0;
    let [light, error] = given.split(", ").map(|number| number.parse().unwrap()).collect::<Vec<f64>>()[..]
    else {
        panic!("{given}")
    };
    let room = BoxRoom::new(Scene::default()).unwrap();
    let paths = Paths::new(
        room,
        Bounces::All(0.9),
        unbiased::lambertian::hemisphere::Hemisphere::Cosine,
        FindLight::BySampling,
    )
    .unwrap();
    let found = unbiased::estimate(&paths, Budget::Draws(common::draws(200_000)), common::seed(9)).unwrap();
    let tolerance = common::deviations(7.0) * found.std_error().unwrap().hypot(error);
    assert!((found.mean() - light).abs() <= tolerance, "{found} and {light}");
    assert!(error <= 1e-5 * light);
}

#[test]
fn bad_input_is_an_error() {
    assert_eq!(Trade::new(1, f64::NAN).unwrap_err().to_string(), "the truth must be finite, not NaN");
    let error = Trade::new(1, 1.0).unwrap().seconds_each(0.0).unwrap_err();
    assert_eq!(error.to_string(), "the time in seconds must be positive and finite, not 0");
    let error = Trade::new(1, 1.0).unwrap().known_to(-1.0).unwrap_err();
    assert_eq!(error.to_string(), "the truth's std error must be finite and ≥ 0, not -1");
    let nan = Rival::new("NaN", from_fn(|_| f64::NAN));
    assert!(matches!(Trade::new(1, 1.0).unwrap().compare(&[nan]), Err(Error::Draw { .. })));
    assert!(Genz::new(Family::Gaussian, [0.0, 1.0], [0.5; 2]).is_err());
    assert!(Genz::new(Family::Gaussian, [1.0, 1.0], [0.5, 1.5]).is_err());
}

/// ∫ f over [0, 1]² by the Gauss–Legendre rule of five points on 40 × 40 parts of each of the four rectangles
/// that w divides the square into.
fn quadrature(f: impl Fn(f64, f64) -> f64, w: [f64; 2]) -> f64 {
    let (inner, outer) =
        ((245.0 - 14.0 * 70f64.sqrt()).sqrt() / 21.0, (245.0 + 14.0 * 70f64.sqrt()).sqrt() / 21.0);
    let (near, far) = ((322.0 + 13.0 * 70f64.sqrt()) / 900.0, (322.0 - 13.0 * 70f64.sqrt()) / 900.0);
    let rule = [(0.0, 128.0 / 225.0), (inner, near), (-inner, near), (outer, far), (-outer, far)];
    let nodes = |w: f64| -> Vec<(f64, f64)> {
        let mut nodes = Vec::new();
        for (low, high) in [(0.0, w), (w, 1.0)] {
            let half = 0.5 * (high - low) / 40.0;
            for part in 0..40 {
                let middle = low + (2.0 * f64::from(part) + 1.0) * half;
                nodes.extend(rule.map(|(x, weight)| (middle + half * x, half * weight)));
            }
        }
        nodes
    };
    let (xs, ys) = (nodes(w[0]), nodes(w[1]));
    xs.iter().map(|(x, a)| ys.iter().map(|(y, b)| a * b * f(*x, *y)).sum::<f64>()).sum()
}

proptest! {
    #![proptest_config(common::config(24))]

    #[test]
    fn genz_families_have_their_integrals(
        a in 0.5..12.0, b in 0.5..12.0, u in 0.05..0.95, v in 0.05..0.95, family in 0usize..6,
    ) {
        let genz = Genz::new(Family::ALL[family], [a, b], [u, v]).unwrap();
        let size = quadrature(|x, y| genz.at(x, y).abs(), [u, v]);
        let off = (genz.integral() - quadrature(|x, y| genz.at(x, y), [u, v])).abs();
        // the rule's own error is below 1e-12 of the integrand's size for a ≤ 12
        prop_assert!(off <= 1e-11 * size, "{:?}: off by {off}", genz);
    }
}
