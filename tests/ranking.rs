//! What follows from measured variances, times and biases: ranks, crossings, slopes, and how they are shown.

mod common;

use std::collections::BTreeMap;

use approx::assert_relative_eq;
use common::rivals::{comparison, measured, named};
use unbiased::trade::{Comparison, Measured, Nature, Reach};

/// Alike but for the rounding of a few operations.
fn assert_close(found: f64, expected: f64) {
    assert_relative_eq!(found, expected, epsilon = 0.0, max_relative = 1e-12);
}

/// The CSV by its columns' names, a line after the other, by the rules of RFC 4180.
fn records(comparison: &Comparison) -> Vec<BTreeMap<String, String>> {
    let csv = comparison.csv();
    let mut lines = csv.lines().map(|line| {
        let (mut fields, mut quoted) = (vec![String::new()], false);
        for c in line.chars() {
            match c {
                '"' => quoted = !quoted,
                ',' if !quoted => fields.push(String::new()),
                _ => fields.last_mut().unwrap().push(c),
            }
        }
        fields
    });
    let names = lines.next().unwrap();
    let record = |line: Vec<String>| {
        assert_eq!(line.len(), names.len());
        names.iter().cloned().zip(line).collect()
    };
    lines.map(record).collect()
}

/// What the CSV says of a biased rival beside an unbiased one: how, when and where that one overtakes.
fn crossing(biased: &Measured, unbiased: &Measured) -> [String; 3] {
    let record = records(&comparison([unbiased.clone(), biased.clone()])).pop().unwrap();
    ["crossing", "crossing_seconds", "crossing_error"].map(|name| record[name].clone())
}

/// The names in their order, with their ranks and whether the one before is really better.
fn order(comparison: &Comparison) -> Vec<(&str, usize, bool)> {
    comparison
        .ranking()
        .iter()
        .map(|place| (place.rival.name.as_str(), place.rank, place.set_apart))
        .collect()
}

#[test]
fn errors_times_and_crossings_follow_from_variance_and_bias() {
    let unbiased = measured(Nature::Unbiased, 2.1, 4.0, 0.5);
    assert_eq!((unbiased.bias(), unbiased.bias_error(), unbiased.bias_seen()), (0.0, 0.0, false));
    // √(4 · 0.5/T) is 1 % of 2 at T = 2/0.02²
    let seconds = |reach: Reach| reach.seconds().unwrap();
    assert_close(seconds(unbiased.seconds_to(0.01)), 5000.0);
    // never less than one draw
    assert_eq!(unbiased.seconds_to(100.0), Reach::After(0.5));
    assert_eq!(unbiased.seconds_to(0.0), Reach::Never);
    assert_eq!(unbiased.seconds_to(f64::NAN), Reach::Never);

    // a bias of 0.1 ± 0.01
    let biased = measured(Nature::Biased, 2.1, 1.0, 0.5);
    assert!(biased.bias_seen());
    assert_close(biased.bias_error(), 0.01);
    // 0.02 is below 0.1 − 0.03, 0.2 above 0.1 + 0.03
    assert_eq!(biased.seconds_to(0.01), Reach::Never);
    // (0.2² − 0.1²) T = 0.5
    assert_close(seconds(biased.seconds_to(0.1)), 0.5 / 0.03);
    // in between: at least as long as with the smallest bias
    let Reach::AtLeast(least) = biased.seconds_to(0.05) else { panic!("{:?}", biased.seconds_to(0.05)) };
    assert_relative_eq!(least, 0.5 / (0.1 * 0.1 - 0.07 * 0.07), epsilon = 0.0, max_relative = 1e-11);
    // 2/T = 0.01 + 0.5/T at T = 150
    let [how, when, error] = crossing(&biased, &unbiased);
    assert_eq!(how, "at");
    assert_close(when.parse().unwrap(), 150.0);
    assert_close(error.parse().unwrap(), (2.0f64 / 150.0).sqrt());
    // one that is cheaper without bias has overtaken from the start, with and without a bias that is seen
    for mean in [2.1, 3.0] {
        assert_eq!(
            crossing(&measured(Nature::Biased, mean, 8.0, 0.5), &unbiased),
            ["from_the_start", "", ""]
        );
    }

    let infinite = measured(Nature::InfiniteVariance, 2.0, 1e3, 0.5);
    assert_eq!((infinite.variance(), infinite.seconds_to(0.5)), (f64::INFINITY, Reach::Never));
    // without a rival of finite variance nothing overtakes
    assert_eq!(crossing(&biased, &infinite), ["", "", ""]);
    let all = comparison([infinite, unbiased, measured(Nature::Unbiased, 2.0, 1e-32, 0.5)]);
    let found = records(&all);
    let [none, some, endless] = [0, 1, 2].map(|rival| found[rival]["efficiency"].as_str());
    assert_eq!([none, endless], ["0", "inf"]);
    assert_close(some.parse().unwrap(), 0.5);
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
        assert_eq!(crossing(&rival, &unbiased)[0], if seen { "at" } else { "unknown" });
        let remark = comparison([unbiased.clone(), rival.clone()]).rows().pop().unwrap().pop().unwrap();
        assert_eq!(remark.starts_with("no bias seen: "), !seen, "{remark}");
        assert_eq!(remark.contains("overtaken"), seen, "{remark}");
        if !seen {
            // 0.002 is within what three std errors allow: not known, but at least as long as without a bias
            let Reach::AtLeast(least) = rival.seconds_to(1e-3) else {
                panic!("{:?}", rival.seconds_to(1e-3))
            };
            assert_close(least, 0.5 / 4e-6);
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
    assert_close(comparison.ranking()[1].of_the_best, 0.5);
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
            assert_close(part, (-lead).exp());
        }
    }
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
    assert_close(slopes[1].unwrap(), -1.0);
    assert_close(slopes[2].unwrap(), -1.5);
    assert!([0, 3, 4, 5, 6].iter().all(|index| slopes[*index].is_none()), "{slopes:?}");
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
    // the bias's error is √(0.005² + 0.001²); the best one overtakes after (4 − 0.25) 1e-6/0.5² s, at √(4/15)
    let of_rival = "name biased, series cut, nature biased, draws 10000, mean 2.5, std_error 0.005, truth 2, \
                    truth_error 0.001, bias 0.5, bias_error 0.005099019513592785, bias_seen true, variance \
                    0.25, variance_error 0.0025, heavy_tail false, evaluations 3, random_numbers 7, seconds \
                    1e-6, seconds_low 0.9e-6, seconds_high 1.2e-6, efficiency 4e6, rank , crossing at, \
                    crossing_seconds 15e-6, crossing_error 0.5163977794943222";
    // σ² t = 4e-6, and a truth of 2
    let of_best = "bias , rank 1, set_apart true, of_the_best 1, seconds_to_1e-2 0.01, seconds_to_1e-3 1, \
                   seconds_to_1e-4 100, seconds_to_1e-5 1e4";
    for (record, cells) in records(&comparison([best, rival])).iter().zip([of_best, of_rival]) {
        for (name, expected) in cells.split(", ").map(|cell| cell.split_once(' ').unwrap()) {
            match expected.parse() {
                Ok(number) => assert_close(record[name].parse().unwrap(), number),
                Err(_) => assert_eq!(record[name], expected, "{name}"),
            }
        }
    }
}

/// Relative errors of 0 mean nothing: they are absolute.
#[test]
fn a_truth_of_0_makes_errors_absolute() {
    let zero = |rival: Measured| Measured { truth: 0.0, ..rival };
    let unbiased = zero(measured(Nature::Unbiased, 0.0, 4.0, 0.5));
    assert_close(unbiased.seconds_to(0.1).seconds().unwrap(), 200.0);
    let biased = zero(measured(Nature::Biased, 0.1, 1.0, 0.5));
    let comparison = Comparison { truth: 0.0, ..comparison([unbiased, biased]) };
    let (columns, rows) = (comparison.columns(), comparison.rows());
    assert_eq!([columns[1], columns[6]], ["σ", "to 10⁻² (absolute)"]);
    assert_eq!([rows[0][1].as_str(), &rows[0][6]], ["2.0", "20000 s"]);
    let remark = rows[1].last().unwrap();
    assert_eq!(remark, "bias 0.100 ± 0.020 (95 %); overtaken by the best after 150 s, at 0.12");
}

#[test]
fn the_table_and_csv_agree() {
    let comparison = comparison([
        named("plain", measured(Nature::Unbiased, 2.0, 1.0, 1e-6)),
        named("with, comma", measured(Nature::Unbiased, 2.0, 1.0, 3e-6)),
        named("biased", measured(Nature::Biased, 2.5, 0.1, 1e-6)),
        named("not seen", measured(Nature::Biased, 2.001, 0.1, 1e-6)),
        named("infinite", measured(Nature::InfiniteVariance, 2.0, 1.0, 1e-6)),
        named("exact", measured(Nature::Unbiased, 2.0, 0.0, 1e-3)),
        named("heavy", Measured { heavy_tail: true, ..measured(Nature::Unbiased, 2.0, 9.0, 1e-6) }),
    ]);
    let records = records(&comparison);
    assert_eq!(records.len(), 7);
    let table = comparison.to_string();
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines[0].starts_with("estimator ") && lines[0].ends_with("remark"));
    for (row, line) in comparison.rows().iter().zip(&lines[1..]) {
        assert_eq!(row.len(), comparison.columns().len());
        let record = records.iter().find(|record| record["name"] == row[0]).unwrap();
        assert_eq!(record["rank"], row[4]);
        assert!(line.starts_with(&row[0]) && line.ends_with(row.last().unwrap()), "{line}");
        assert_eq!(record["heavy_tail"] == "true", row.last().unwrap().contains("a few draws"));
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
    assert_eq!([&record("not seen")["bias_seen"], &record("not seen")["seconds_to_1e-5"]], ["false", ""]);
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
