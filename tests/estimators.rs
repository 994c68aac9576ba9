//! What holds for every estimator of the crate, from the one table in `common/all.rs`: a row that is added
//! there is held to all of it.
//!
//! Means and variances are certified by the sequential test of `check::Unbiased`, which must say *unbiased*:
//! *undecided* fails. How small a bias it excludes depends on what a draw costs, and is printed. A case calls
//! a right estimator biased with probability [`ALPHA`], and leaves it undecided with less: that takes its sum
//! to lie 8 std deviations off. Laws are held by the band of Dvoretzky, Kiefer and Wolfowitz, and the shares
//! of intervals that cover by Chernoff's bound, which hold for any number of draws.
//!
//! `UNBIASED_SEED=n` runs everything with fresh parameters and fresh draws.

mod common;
#[path = "common/all.rs"]
mod table;

use rayon::prelude::*;
use table::{Row, all};
use unbiased::check::{Unbiased, Verdict, distributed_as, exactly};
use unbiased::placement::{jittered, sobol};
use unbiased::{Budget, Estimate, Estimator, Outcome, Part, Run, Stream, estimate, from_fn, merge};

use common::{NEARLY_ONE, alarm};

/// The probability that one comparison calls a right estimator wrong.
const ALPHA: f64 = 1e-14;

/// Variants with drawn parameters.
const VARIANTS: u64 = 4;

fn seed(variant: u64, n: usize) -> u64 {
    common::seed(1000 * variant + n as u64)
}

/// As many draws as a time in seconds takes, at least so many.
fn draws_in(seconds: f64, cost: f64, least: u64) -> u64 {
    common::draws((seconds * 1e9 / cost) as u64).max(least)
}

// ---- bits

#[test]
fn false_alarms_of_the_whole_suite_stay_below_1e_9() {
    let sum: f64 = common::BUDGETS.iter().map(|(_, budget)| budget).sum();
    println!("{sum:.2e}");
    assert!(sum < 1e-9, "{sum:e}");
}

/// The estimator, and sets of placed points of it.
fn ways(row: &Row) -> [(&'static str, Box<dyn Estimator + '_>, f64); 3] {
    let estimator = &row.estimator;
    [
        ("", Box::new(estimator), row.rounding),
        (" on Sobol points", Box::new(sobol(estimator, 64).unwrap()), 0.0),
        (" in cells", Box::new(jittered(estimator, 8).unwrap()), 0.0),
    ]
}

/// In parts of any size, and one at a time: to the bit, or for paths side by side to rounding, with as many
/// numbers and evaluations.
#[test]
fn filling_is_drawing() {
    let rows: Vec<(u64, Row)> = (0..3).flat_map(|v| all(v).into_iter().map(move |row| (v, row))).collect();
    rows.par_iter().for_each(|(variant, row)| {
        for (placed, estimator, allowed) in ways(row).into_iter().take(if *variant > 0 { 1 } else { 3 }) {
            let name = format!("{}{placed}", row.name);
            let parts = [1, 31, 32, 33, 255, 256, 257, 1000, 5, 300].into_iter().cycle().take(40);
            let most =
                draws_in(0.004, if placed.is_empty() { row.cost } else { 64.0 * row.cost }, 40) as usize;
            let (mut many, mut one) = (Stream::new(seed(7, 0), 3), Stream::new(seed(7, 0), 3));
            let mut done = 0;
            for part in parts {
                let mut filled = vec![f64::NAN; part.min(most)];
                estimator.fill(&mut many, &mut filled);
                for draw in filled {
                    let drawn = estimator.draw(&mut one);
                    one.next_draw();
                    assert!((draw - drawn).abs() <= allowed * drawn.abs(), "{name}: {draw:?} and {drawn:?}");
                }
                done += part;
                if done > most {
                    break;
                }
            }
            let counted = |rng: &Stream| (rng.random_numbers(), rng.evaluations());
            assert_eq!(counted(&many), counted(&one), "{name}");
        }
    });
}

/// In parts of any size a fill is the same fill, to the bit for paths, too.
#[test]
fn filling_in_parts_is_filling() {
    for row in all(0) {
        let mut whole = [0.0; 777];
        row.estimator.fill(&mut Stream::new(seed(8, 0), 1), &mut whole);
        let (mut rng, mut parts) = (Stream::new(seed(8, 0), 1), [0.0; 777]);
        for part in parts.chunks_mut(61) {
            row.estimator.fill(&mut rng, part);
        }
        assert_eq!(whole, parts, "{}", row.name);
    }
}

/// Any number of threads has the bits of one, and any shards, in any order, those of the whole; and every
/// draw has its cost.
#[test]
fn threads_and_shards_have_the_same_bits() {
    let bits = |outcome: &Outcome| (serde_json::to_string(&outcome.estimate).unwrap(), outcome.cost);
    for (n, row) in all(0).into_iter().enumerate() {
        for draws in [1, 100, 16_385, 300_001] {
            if draws as f64 * row.cost > 3e7 {
                continue;
            }
            let run = || Run::new(seed(9, n));
            let whole = run().threads(1).estimate(&row.estimator, Budget::Draws(draws)).unwrap();
            assert_eq!(whole.estimate.draws(), draws);
            if let Some([random_numbers, evaluations]) = row.takes {
                let cost = (whole.cost.random_numbers, whole.cost.evaluations);
                assert_eq!(cost, (draws * random_numbers, draws * evaluations), "{}", row.name);
            }
            for threads in [2, 3, 8] {
                let found = run().threads(threads).estimate(&row.estimator, Budget::Draws(draws)).unwrap();
                assert_eq!(bits(&found), bits(&whole), "{}, {draws} draws on {threads} threads", row.name);
            }
            let free = estimate(&row.estimator, Budget::Draws(draws), seed(9, n)).unwrap();
            assert_eq!(free, whole.estimate, "{}", row.name);
            for of in [2, 5] {
                let part = |k| {
                    let shard = run().shard(k, of).estimate(&row.estimator, Budget::Draws(draws)).unwrap();
                    // as a file holds it
                    let file = serde_json::to_string(&shard.part.unwrap()).unwrap();
                    serde_json::from_str::<Part>(&file).unwrap()
                };
                let mut parts: Vec<Part> = (1..=of).map(part).collect();
                parts.rotate_left(n % of as usize);
                assert_eq!(bits(&merge(&parts).unwrap()), bits(&whole), "{}, {draws} draws", row.name);
            }
        }
    }
}

// ---- the ends

fn is_sound(row: &Row, draw: f64) -> bool {
    let [low, high] = row.range;
    let slack = 1e-12 * (high - low).min(f64::MAX);
    draw.is_finite() && low - slack <= draw && draw <= high + slack
}

/// All zeros, all ones, every single bit, and all but one: the generator is stuck for a hundred numbers, and
/// then gives the one that ends every path.
#[test]
fn stuck_generators_give_draws_in_range() {
    let words: Vec<u64> = (0..64).flat_map(|bit| [1 << bit, !(1 << bit)]).chain([0, u64::MAX]).collect();
    all(0).par_iter().filter(|row| row.cost < 5e3).for_each(|row| {
        for word in &words {
            let u = (word >> 11) as f64 * 2f64.powi(-53);
            let mut script = vec![u; 100];
            script.resize(200, NEARLY_ONE);
            let rng = &mut Stream::scripted(&script);
            let mut draws = vec![row.estimator.draw(rng)];
            assert!(row.takes.is_some() || rng.random_numbers() <= 201, "{}: u = {u:?}", row.name);
            // after the script nothing ends a path
            draws.resize(if row.takes.is_some() { 40 } else { 2 }, f64::NAN);
            row.estimator.fill(&mut Stream::scripted(&script), &mut draws[1..]);
            for draw in draws {
                // a path that never ends leaves its range, which 10²⁴ draws do not
                let sound = if row.takes.is_some() { is_sound(row, draw) } else { draw.is_finite() };
                assert!(sound, "{}: {draw:?} of u = {u:?}", row.name);
            }
        }
    });
}

/// Also where a seed or a block is the least or the largest.
#[test]
fn any_seed_gives_draws_in_range() {
    for row in all(0) {
        for seed in [0, 1, u64::MAX, 1 << 63] {
            for block in [0, u64::MAX] {
                let mut draws = [f64::NAN; 40];
                row.estimator.fill(&mut Stream::new(seed, block), &mut draws);
                let out = draws.into_iter().find(|draw| !is_sound(&row, *draw));
                assert!(out.is_none(), "{}: {out:?} of {:?}", row.name, row.range);
            }
        }
    }
}

// ---- means and variances

/// Certifies a mean in about that time, and gives the smallest bias that is excluded.
fn certify(name: &str, estimator: &dyn Estimator, mean: f64, row: [f64; 2], draws: u64, seed: u64) -> f64 {
    let [low, high] = row;
    let pilot = estimate(estimator, Budget::Draws((draws / 16).clamp(64, 4096)), seed ^ 1 << 40).unwrap();
    // a variance may be beyond f64
    let deviation = pilot.std_error().unwrap() * (pilot.draws() as f64).sqrt();
    let reach = (mean - low).max(high - mean);
    let tolerance =
        (1e-3 * mean.abs()).max(deviation * (60.0 / draws as f64).sqrt()).max(60.0 * reach / draws as f64);
    // with room for a truth at the end and for a bias
    let range = [low.min(mean - 2.0 * tolerance), high.max(mean + 2.0 * tolerance)];
    let check = Unbiased::new(mean, range).and_then(|check| check.within_absolute(tolerance)?.alpha(ALPHA));
    let report = check.and_then(|check| check.seed(seed).run(estimator));
    alarm(2.0 * ALPHA);
    let report = report.unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!(report.verdict, Verdict::Unbiased, "{name}: {report}");
    tolerance
}

fn certified(row: &Row, seconds: f64, seed: u64) {
    if row.mean.is_nan() {
        assert!(row.cdf.is_some() || row.takes.is_none(), "nothing holds {}", row.name);
        return;
    }
    let draws = draws_in(seconds, row.cost, 4096);
    let caught = certify(&row.name, &row.estimator, row.mean, row.range, draws, seed);
    let (mean, reach) = (row.mean, row.reach());
    let mut said = format!("{:60} bias {caught:.1e} of {mean:.4}", row.name);
    if let Some(variance) = row.variance.filter(|variance| *variance > 0.0 && variance.is_finite()) {
        let squares = from_fn(|rng| (row.estimator.draw(rng) - mean).powi(2));
        let most = reach * reach;
        // beyond, the law holds it
        if 60.0 * most / draws as f64 <= 0.1 * variance {
            let name = format!("variance of {}", row.name);
            let caught = certify(&name, &squares, variance, [0.0, most], draws, seed + 500);
            said += &format!(", {:.1e} of the variance", caught / variance);
        } else if row.cdf.is_none() {
            // means of many points, which are near normal
            let found = estimate(&squares, Budget::Draws(draws), seed + 500).unwrap();
            let (off, std_error) = ((found.mean() - variance).abs(), found.std_error().unwrap());
            let allowed = common::deviations(8.0) * std_error;
            assert!(off <= allowed, "variance of {}: {found} for {variance}", row.name);
            said += &format!(", {:.1e} of the variance", 11.0 * std_error / variance);
        }
    } else if row.variance == Some(0.0) {
        let found = estimate(&row.estimator, Budget::Draws(1000), seed).unwrap();
        assert!(found.variance().unwrap() <= 1e-28 * mean * mean, "{}: {found}", row.name);
    }
    println!("{said}");
}

#[test]
fn means_and_variances_are_the_closed_forms() {
    for (n, row) in all(0).iter().enumerate() {
        certified(row, 0.1, seed(20, n));
    }
}

/// The same with parameters that are drawn.
#[test]
fn means_and_variances_are_the_closed_forms_of_any_parameters() {
    for variant in 1..=VARIANTS {
        for (n, row) in all(variant).iter().enumerate() {
            certified(row, 0.015, seed(20 + variant, n));
        }
    }
}

/// Both moments of a function of one or two numbers, without any noise.
#[test]
fn quadrature_knows_the_closed_forms() {
    for variant in 0..5 {
        for row in all(variant) {
            let Some(numbers) = row.smooth else { continue };
            let exact = exactly(&row.estimator, numbers);
            let exact = exact.unwrap_or_else(|error| panic!("{}: {error}", row.name));
            let scale = row.mean.abs().max(row.variance.unwrap_or(0.0).sqrt());
            assert!((exact.mean - row.mean).abs() <= 1e-9 * scale, "{}: {exact:?}", row.name);
            if let Some(variance) = row.variance {
                assert!((exact.variance - variance).abs() <= 1e-9 * scale * scale, "{}: {exact:?}", row.name);
            }
            // as many independent draws would know σ/128; the last of 2¹⁴ parts of an exponential is that far
            // off with probability e⁻³³
            alarm(5e-15);
            let set = sobol(&row.estimator, 1 << 14).unwrap().draw(&mut Stream::new(seed(50, 0), variant));
            assert!((set - row.mean).abs() <= 2e-3 * scale, "{}: {set} for {}", row.name, row.mean);
        }
    }
}

#[test]
fn laws_are_the_closed_forms() {
    for variant in 0..4 {
        for (n, row) in all(variant).iter().enumerate() {
            let Some(cdf) = &row.cdf else { continue };
            let deviation = (45.0 * row.cost / 2e7).sqrt().clamp(if variant > 0 { 0.02 } else { 0.006 }, 0.1);
            let agreement = distributed_as(&row.estimator, cdf, deviation, ALPHA, seed(40 + variant, n));
            alarm(ALPHA);
            let agreement = agreement.unwrap_or_else(|error| panic!("{}: {error}", row.name));
            assert!(agreement.agrees, "{}: {agreement}", row.name);
        }
    }
}

// ---- placed numbers

/// 64 points in place of as many draws: the same mean.
#[test]
fn placed_numbers_keep_the_mean() {
    for (n, row) in all(0).iter().enumerate().filter(|(_, row)| !row.mean.is_nan()) {
        for (i, (placed, estimator, _)) in ways(row).into_iter().enumerate().skip(1) {
            let draws = draws_in(0.05, 64.0 * (row.cost + 20.0), 512);
            let name = format!("{}{placed}", row.name);
            let caught = certify(&name, &estimator, row.mean, row.range, draws, seed(60 + i as u64, n));
            println!("{name:70} bias {caught:.1e} of {:.4}", row.mean);
        }
    }
}

// ---- intervals

/// The 95 % interval holds the mean in 95 % of many runs. Skewness γ costs 0.25 γ²/n of it (Edgeworth), so n
/// is taken to make that 0.25 %, and another 0.25 % is left to the next terms and to the steps of
/// whole-numbered draws. An error bar that is 10 % too short or too long is seen.
#[test]
fn intervals_cover_the_mean() {
    for (n, row) in all(0).iter().enumerate() {
        let varies = row.variance.is_some_and(|variance| variance > 0.0 && variance.is_finite());
        if !varies || row.reach() > 1e3 * row.variance.unwrap().sqrt() {
            continue;
        }
        let mut pilot = vec![0.0; draws_in(0.05, row.cost, 2000).min(100_000) as usize];
        row.estimator.fill(&mut Stream::new(seed(80, n), 0), &mut pilot);
        let third = Estimate::from_draws(&pilot.iter().map(|x| (x - row.mean).powi(3)).collect::<Vec<_>>());
        let skewness = third.mean() / row.variance.unwrap().powf(1.5);
        let draws = 300.max((100.0 * skewness * skewness) as usize);
        let runs = (draws_in(0.2, row.cost * draws as f64, 0)).min(20_000);
        if runs < 1000 {
            continue;
        }
        let covers = |i: &u64| {
            let mut own = vec![0.0; draws];
            row.estimator.fill(&mut Stream::new(seed(81, n), *i), &mut own);
            let [low, high] = Estimate::from_draws(&own).confidence_interval(0.95).unwrap();
            low <= row.mean && row.mean <= high
        };
        let share = (0..runs).into_par_iter().filter(covers).count() as f64 / runs as f64;
        println!("{:60} {share:.4} of {runs} runs of {draws}", row.name);
        common::is_share(&row.name, share, runs, [0.945, 0.955], ALPHA);
    }
}
