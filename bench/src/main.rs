//! Measures everything once, peers too, and prints the table of ratios: `bench/run`.
//!
//! This crate and its peers take turns, and each row keeps the best time of all turns, as others may use the
//! machine at the same time.

use std::collections::BTreeMap;
use std::hint::black_box;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use rand::SeedableRng;
use rand_distr::{Distribution, Exp1};
use rand_xoshiro::Xoshiro256PlusPlus;
use unbiased::fast;
use unbiased::inversion::Exponential;
use unbiased::lambertian::Lambertian;
use unbiased::lambertian::hemisphere::Hemisphere;
use unbiased::paths::room::{BoxRoom, Scene};
use unbiased::paths::{Bounces, FindLight, Paths};
use unbiased::placement::sobol;
use unbiased::rectangle::Rectangle;
use unbiased::roulette::Roulette;
use unbiased::{Budget, Estimator, Run, Stream, from_fn};
use unbiased_bench::{SLICE, sum_of_drawn, sum_of_filled, uniforms};

const SLICES: usize = 64;
const TURNS: usize = 3;
const BOUNCES: [u32; 4] = [1, 2, 3, 15];

/// The best time of each row so far, in ns per draw (or in seconds if it says so).
#[derive(Default)]
struct Best(BTreeMap<String, f64>);

/// The least number of independent replicates of a set of paths; with fewer the error is not known.
const REPLICATES: f64 = 16.0;

/// Paths per set: for Mitsuba's samplers, which need squares, and Sobol points for this crate.
const SETS: [u64; 3] = [1 << 10, 1 << 14, 1 << 18];
const SOBOL: [u64; 6] = [1 << 6, 1 << 8, 1 << 10, 1 << 12, 1 << 14, 1 << 16];

/// A peer's paths: the best time of one path, and all measurements of the variance of one path divided by the
/// square of the mean.
#[derive(Default)]
struct PeerPaths {
    seconds: Option<f64>,
    variances: Vec<f64>,
    /// The number of paths per set that depend on each other.
    set: f64,
}

impl PeerPaths {
    fn take(&mut self, paths_per_second: f64, variance: f64) {
        let seconds = 1.0 / paths_per_second;
        self.seconds = Some(self.seconds.map_or(seconds, |best| best.min(seconds)));
        self.variances.push(variance);
    }

    /// Seconds to a relative std error of 1e-4.
    fn seconds(&self) -> Option<f64> {
        let variance = self.variances.iter().sum::<f64>() / self.variances.len() as f64;
        Some(self.seconds? * (variance / 1e-8).max(REPLICATES * self.set))
    }
}

impl Best {
    fn take(&mut self, row: &str, ns: f64) {
        let best = self.0.entry(row.into()).or_insert(f64::INFINITY);
        *best = best.min(ns);
    }

    fn time(&mut self, row: &str, draws: usize, mut run: impl FnMut() -> f64) {
        for _ in 0..60 {
            let start = Instant::now();
            black_box(run());
            self.take(row, start.elapsed().as_secs_f64() * 1e9 / draws as f64);
        }
    }

    fn ratio(&self, above: &str, below: &str) -> Option<f64> {
        Some(self.0.get(above)? / self.0.get(below)?)
    }
}

fn ours(best: &mut Best) {
    let mut rng = Stream::new(1, 0);
    let draws = SLICES * SLICE;
    let exponential = Exponential::new(black_box(1.0)).unwrap();
    let cube = Lambertian::new(black_box(0.8)).unwrap();
    let bell = Rectangle::WORKSHEET.independent(|x, y| fast::exp(-x * x - y * y));
    let cosine = cube.cosine_estimator(|direction| 1.0 + direction.vector().x);
    let uniform = cube.uniform_estimator(|direction| 1.0 + direction.vector().x);
    let bounces = Roulette::new(black_box(0.8)).unwrap().bounces().by_inversion().unwrap();
    let rows: [(&str, &dyn Estimator); 7] = [
        ("one uniform", &uniforms::<1>()),
        ("two uniforms", &uniforms::<2>()),
        ("exponential", &exponential),
        ("square", &bell),
        ("cosine", &cosine),
        ("uniform directions", &uniform),
        ("bounces", &bounces),
    ];
    for (name, estimator) in rows {
        best.time(&format!("ours: {name}"), draws, || sum_of_filled(estimator, &mut rng, SLICES));
    }
    let mut plain = Xoshiro256PlusPlus::seed_from_u64(1);
    best.time("rand_distr: exponential", draws, || {
        (0..draws).map(|_| -> f64 { Exp1.sample(&mut plain) }).sum()
    });
    // the overhead of a run: against its own draws, filled and summed, and against a loop over draws
    let one_by_one = from_fn(move |rng| exponential.draw(rng));
    let run = |estimator: &dyn Estimator| {
        Run::new(1).threads(1).estimate(estimator, Budget::Draws(draws as u64)).unwrap().estimate.mean()
    };
    best.time("estimate: filled", draws, || run(&exponential));
    best.time("estimate: drawn", draws, || run(&one_by_one));
    best.time("ours: exponential, drawn", draws, || sum_of_drawn(&one_by_one, &mut rng, SLICES));
    for threads in [1, 2] {
        let many = 1 << 24;
        for _ in 0..3 {
            let start = Instant::now();
            black_box(Run::new(1).threads(threads).estimate(&exponential, Budget::Draws(many)).unwrap());
            best.take(&format!("{threads} threads"), start.elapsed().as_secs_f64() * 1e9 / many as f64);
        }
    }
    let room = BoxRoom::new(Scene::default()).unwrap();
    for most in BOUNCES {
        let paths = Paths::new(room, Bounces::UpTo(most), Hemisphere::Cosine, FindLight::BySampling).unwrap();
        let single = paths.in_f32().unwrap();
        let plain = from_fn(|rng| paths.draw(rng));
        let estimators: [(&str, &dyn Estimator, u64); 3] =
            [("f64", &paths, 1 << 20), ("f32", &single, 1 << 20), ("plain", &plain, 1 << 18)];
        for (name, estimator, draws) in estimators {
            for _ in 0..8 {
                let start = Instant::now();
                let found = Run::new(1).estimate(estimator, Budget::Draws(draws)).unwrap().estimate;
                let relative = found.std_error().unwrap() / found.mean() / 1e-4;
                let seconds = start.elapsed().as_secs_f64() * relative * relative;
                best.take(&format!("{name}: {most} bounces"), seconds);
            }
        }
        for points in SOBOL {
            let placed = sobol(paths, points).unwrap();
            // with this many sets, the variance of a set is known to 9 %
            let sets = 256;
            for seed in 0..3 {
                let start = Instant::now();
                let found = Run::new(seed).estimate(&placed, Budget::Draws(sets)).unwrap().estimate;
                let relative = found.std_error().unwrap() / found.mean() / 1e-4;
                let needed = (sets as f64 * relative * relative).max(REPLICATES);
                let seconds = start.elapsed().as_secs_f64() / sets as f64 * needed;
                best.take(&format!("sobol {points}: {most} bounces"), seconds);
            }
        }
    }
}

/// Reads the rows that a peer prints, or says why there are none.
fn peer(
    best: &mut Best,
    script: &str,
    arguments: &[&str],
    mut row: impl FnMut(&mut Best, &serde_json::Value),
) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers").join(script);
    let output = match Command::new("python3").arg(path).args(arguments).output() {
        Ok(output) => output,
        Err(error) => return println!("{script}: python3 could not be started ({error}); skipped"),
    };
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        if let Ok(value) = serde_json::from_str(line) {
            row(best, &value);
        }
    }
    if !output.status.success() {
        let errors = String::from_utf8_lossy(&output.stderr);
        let reason = errors.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("no reason given");
        println!("{script}: not all of it ran; skipped ({reason})");
    }
}

fn main() {
    let mut best = Best::default();
    let mut mitsuba: BTreeMap<String, PeerPaths> = BTreeMap::new();
    let turns = std::env::args().nth(1).and_then(|turns| turns.parse().ok()).unwrap_or(TURNS);
    for turn in 1..=turns {
        eprintln!("turn {turn} of {turns}");
        ours(&mut best);
        peer(&mut best, "numpy_draws.py", &["65536"], |best, value| {
            if let (Some(row), Some(ns)) = (value["row"].as_str(), value["ns"].as_f64()) {
                best.take(&format!("numpy: {row}"), ns);
            }
        });
        let independent = |variant, renders: u64, spp: u64| (variant, "independent", renders, spp);
        let mut rows =
            vec![independent("llvm_ad_mono", 12, 1_000_000), independent("scalar_rgb", 2, 100_000)];
        // only once: a set's variance is known to 18 % from it
        for sampler in ["stratified", "multijitter", "orthogonal"].into_iter().filter(|_| turn == 1) {
            rows.extend(SETS.map(|spp| ("llvm_ad_mono", sampler, 64, spp)));
        }
        for (variant, sampler, renders, spp) in rows {
            let seed = (1000 * turn).to_string();
            let bounces = BOUNCES.map(|most| most.to_string());
            let [renders, spp_text] = [renders, spp].map(|number| number.to_string());
            let mut arguments = vec![variant, sampler, &renders, &spp_text, &seed];
            arguments.extend(bounces.iter().map(String::as_str));
            peer(&mut best, "mitsuba_box.py", &arguments, |_, value| {
                let numbers = [&value["bounces"], &value["paths_per_second"], &value["variance"]]
                    .map(serde_json::Value::as_f64);
                if let [Some(bounces), Some(rate), Some(variance)] = numbers {
                    let row = match sampler {
                        "independent" => format!("{variant}: {bounces} bounces"),
                        _ => format!("{sampler} {spp}: {bounces} bounces"),
                    };
                    let paths = mitsuba.entry(row).or_default();
                    paths.set = if sampler == "independent" { 1.0 } else { spp as f64 };
                    paths.take(rate, variance);
                }
            });
        }
    }
    for (row, paths) in mitsuba {
        if let Some(seconds) = paths.seconds() {
            best.take(&row, seconds);
        }
    }
    for (row, time) in &best.0 {
        let unit = if row.ends_with("bounces") && !row.starts_with("ours") && !row.starts_with("numpy") {
            "s to 1e-4"
        } else {
            "ns a draw"
        };
        println!("{row:32} {time:12.6} {unit}");
    }
    println!("\n| what | required | goal | measured |\n|---|---|---|---|");
    let print = |what: &str, required: &str, goal: &str, ratio: Option<f64>| {
        let ratio = ratio.map_or("no peer".into(), |ratio| format!("{ratio:.2}"));
        println!("| {what} | {required} | {goal} | {ratio} |");
    };
    print(
        "exponential, its time over rand_distr's ziggurat",
        "≤ 1.5",
        "≤ 0.6",
        best.ratio("ours: exponential", "rand_distr: exponential"),
    );
    let numpy = ["numpy: exponential, log1p", "numpy: exponential, log"]
        .into_iter()
        .filter_map(|row| best.ratio(row, "ours: exponential"))
        .reduce(f64::min);
    print("exponential, numpy's better inversion over ours", "≥ 1.5", "≥ 3", numpy);
    for row in ["square", "cosine", "uniform directions", "bounces"] {
        let ratio = best.ratio(&format!("numpy: {row}"), &format!("ours: {row}"));
        print(&format!("{row}, numpy's time over ours"), "≥ 3", "≥ 8", ratio);
    }
    for (row, uniforms) in [
        ("exponential", "one uniform"),
        ("bounces", "one uniform"),
        ("square", "two uniforms"),
        ("cosine", "two uniforms"),
        ("uniform directions", "two uniforms"),
    ] {
        let ratio = best.ratio(&format!("ours: {row}"), &format!("ours: {uniforms}"));
        print(&format!("{row}, its time over its uniforms'"), "≤ 6", "≤ 3", ratio);
    }
    print("two threads against one", "≥ 1.8", "≥ 1.95", best.ratio("1 threads", "2 threads"));
    for (most, plain) in BOUNCES.into_iter().zip(["≥ 1.5", "≥ 1.5", "≥ 1.5", "≥ 1"]) {
        for (ours, variant, required, goal) in [
            ("plain", "scalar_rgb", "≥ 10", ""),
            ("plain", "llvm_ad_mono", plain, ""),
            ("f64", "llvm_ad_mono", "≥ 10", "≥ 25"),
            ("f32", "llvm_ad_mono", "≥ 10", "≥ 25"),
        ] {
            let ratio = best.ratio(&format!("{variant}: {most} bounces"), &format!("{ours}: {most} bounces"));
            let s = if most == 1 { "" } else { "s" };
            let what = format!("{most} bounce{s}, Mitsuba's {variant} over {ours}, seconds to 1e-4");
            print(&what, required, goal, ratio);
        }
    }
    let least = |names: &[&str], most: u32| {
        let rows = best.0.iter().filter(|(row, _)| {
            row.ends_with(&format!(": {most} bounces")) && names.iter().any(|name| row.starts_with(name))
        });
        rows.map(|(_, seconds)| *seconds).reduce(f64::min)
    };
    for (most, [required, goal, required_best, goal_best]) in BOUNCES.into_iter().zip([
        ["≥ 100", "≥ 1000", "≥ 20", "≥ 100"],
        ["≥ 200", "≥ 1000", "≥ 40", "≥ 200"],
        ["≥ 60", "≥ 200", "≥ 20", "≥ 60"],
        ["≥ 40", "≥ 100", "≥ 12", "≥ 40"],
    ]) {
        let s = if most == 1 { "" } else { "s" };
        let over = |peers: &[&str]| Some(least(peers, most)? / least(&["sobol"], most)?);
        let what =
            format!("{most} bounce{s}, Mitsuba's llvm_ad_mono over f64 with Sobol points, seconds to 1e-4");
        print(&what, required, goal, over(&["llvm_ad_mono"]));
        let what = format!("{most} bounce{s}, the best of Mitsuba's samplers over the same");
        print(
            &what,
            required_best,
            goal_best,
            over(&["llvm_ad_mono", "stratified", "multijitter", "orthogonal"]),
        );
    }
    print(
        "estimate, over a loop that draws and sums",
        "≤ 1.1",
        "≤ 1.02",
        best.ratio("estimate: drawn", "ours: exponential, drawn"),
    );
    print(
        "estimate, over a loop that fills and sums",
        "≤ 1.1",
        "≤ 1.02",
        best.ratio("estimate: filled", "ours: exponential"),
    );
}
