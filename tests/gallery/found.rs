//! Every mistake is refuted, and found again, alone or times a constant.

use std::f64::consts::PI;

use rand::distr::Distribution;
use unbiased::check::{self, Attempt, Candidate, Exercise, Finding, Probe, Problem, Unbiased, Verdict};
use unbiased::inversion::mistakes::Samples;
use unbiased::lambertian::hemisphere::Hemisphere;
use unbiased::lambertian::mistakes::Reflection;
use unbiased::paths::mistakes::LightOfPaths;
use unbiased::paths::room::Scene;
use unbiased::rectangle::mistakes::Integral;
use unbiased::roulette::mistakes::{NumberOfBounces, Wrapped};
use unbiased::{Error, Estimator, Stream, from_fn};

use crate::right::shared_sample;
use crate::{DRAWS, diagnosed, gallery, is_faint, names};

fn seeds() -> u64 {
    std::env::var("UNBIASED_GALLERY_SEEDS").ok().and_then(|seeds| seeds.parse().ok()).unwrap_or(2)
}

/// A range in which the draws of right estimators lie, and most of the wrong ones; upwards unbounded where
/// samples are.
fn range(exercise: &Exercise, probe: &Probe) -> [f64; 2] {
    let (size, text) = (probe.scale, probe.to_string());
    match exercise.id {
        "samples" if text.starts_with("mean of F") => [0.0, 1.0],
        // c = 2/λ is 2.31 times the mean
        "samples" if text.starts_with("mean of min") => [0.0, 2.4 * size],
        "samples" => [0.0, f64::INFINITY],
        "bounces" => [0.0, MOST],
        "integral" => [-20.0 * size, 20.0 * size],
        "reflection" => [0.0, 60.0 * size],
        "roulette" => [0.0, 40.0 * size],
        // 1/0.00998 is what a path brings that happens on the light after two bounces on the sheet
        _ => [0.0, 110.0 * size],
    }
}

/// Bounces have no bound: they are tried through min(N, 200), whose mean is known, too.
const MOST: f64 = 200.0;

/// Every mistake is refuted at α = 1e-12 on a probe that sees it, or too faint for it.
#[test]
fn every_mistake_is_refuted() {
    let (mut refuted, mut faint) = (0, Vec::new());
    for (index, (exercise, mistake)) in gallery().enumerate() {
        if is_faint(exercise, mistake) {
            faint.push(mistake.name);
            continue;
        }
        let off = |probe: &&Probe| (exercise.ratio(mistake, probe).mean - (probe.truth / probe.scale)).abs();
        // draws without an upper bound can only be shown to be too large
        let shows = |probe: &&Probe| {
            let ratio = exercise.ratio(mistake, probe).mean;
            range(exercise, probe)[1].is_finite() || ratio > 1.0
        };
        let clearest = exercise.probes.iter().filter(shows).max_by(|a, b| off(a).total_cmp(&off(b)));
        let probe = clearest.unwrap();
        let bounded = exercise.id == "bounces";
        let p = probe.truth / (1.0 + probe.truth);
        let truth = if bounded { probe.truth * (1.0 - p.powf(MOST)) } else { probe.truth };
        let wrong = exercise.attempt_of(mistake, 1.0);
        let wrong = wrong.on(probe).unwrap();
        let wrong = from_fn(|rng| if bounded { wrong.draw(rng).min(MOST) } else { wrong.draw(rng) });
        for round in 0..seeds() {
            let test = Unbiased::new(truth, range(exercise, probe))
                .unwrap()
                .within_absolute(1e-3 * probe.scale)
                .unwrap()
                .seed(5_000_000 + 1000 * index as u64 + round)
                .max_draws(4_000_000);
            let verdict = match test.run(&wrong) {
                Ok(report) => report.verdict == Verdict::Biased,
                // a draw that a right estimator cannot make
                Err(Error::OutOfRange { .. }) => true,
                Err(error) => panic!("“{}” at {probe}: {error}", mistake.name),
            };
            assert!(verdict, "“{}” at {probe} is not refuted", mistake.name);
        }
        refuted += 1;
    }
    println!("{refuted} refuted in {} of {} seeds, too faint: {faint:?}", seeds(), seeds());
    assert!(faint.len() <= 3, "{faint:?}");
}

/// Every mistake that can be seen, diagnosed blindly.
#[test]
fn every_mistake_is_found() {
    let (mut runs, mut first, mut found, mut candidates, mut slowest) = (0, 0, 0, 0, (0.0, ""));
    let mut missed = std::collections::BTreeMap::<_, u32>::new();
    for (index, (exercise, mistake)) in gallery().enumerate().filter(|(_, (of, it))| !is_faint(of, it)) {
        let attempt = exercise.attempt_of(mistake, 1.0);
        for round in 0..seeds() {
            let measured = check::measure(&attempt, DRAWS, 1_000_000 + 1000 * index as u64 + round).unwrap();
            let start = std::time::Instant::now();
            let diagnosis = check::diagnose(&measured).unwrap();
            let seconds = start.elapsed().as_secs_f64();
            if seconds > slowest.0 {
                slowest = (seconds, mistake.name);
            }
            let is_it =
                |candidate: &Candidate| candidate.mistake.is_some_and(|other| std::ptr::eq(other, mistake));
            let rank = diagnosis.candidates.iter().find(|of| is_it(of)).map(|of| of.rank);
            runs += 1;
            found += u32::from(rank.is_some());
            first += u32::from(rank == Some(0));
            candidates += diagnosis.candidates.len();
            assert!(diagnosis.candidates.iter().all(|candidate| candidate.factor.is_none()), "{diagnosis}");
            if rank != Some(0) {
                *missed.entry((exercise.name, mistake.name)).or_default() += 1;
            }
        }
    }
    let share = |count: u32| f64::from(count) / f64::from(runs);
    println!("{runs} runs: first {:.4}, found {:.4}", share(first), share(found));
    println!("candidates {:.3} a run; slowest diagnosis {slowest:?}", candidates as f64 / f64::from(runs));
    println!("not first: {missed:#?}");
    assert!(share(first) >= 0.98, "{}", share(first));
}

/// With all lights there are fewer candidates than with a constant one alone.
#[test]
fn more_probes_leave_fewer_candidates() {
    let exercise = Reflection::exercise();
    let mean_candidates = |few: bool| {
        let (mut candidates, mut passed) = (0, 0);
        for (index, mistake) in exercise.mistakes.iter().enumerate() {
            let attempt = exercise.attempt_of(mistake, 1.0);
            let mut measured = check::measure(&attempt, DRAWS, 2_000_000 + index as u64).unwrap();
            if few {
                measured.retain(|of| of.probe.to_string() == "L = 1, ρ = 0.8");
            }
            let diagnosis = check::diagnose(&measured).unwrap();
            passed += i32::from(diagnosis.finding == Finding::NothingWrong);
            candidates += diagnosis.candidates.len() + diagnosis.hidden.len();
        }
        (candidates as f64 / exercise.mistakes.len() as f64, passed)
    };
    let ((alone, passed_alone), (all, passed)) = (mean_candidates(true), mean_candidates(false));
    println!(
        "candidates: {alone:.2} with a constant light ({passed_alone} pass it), {all:.2} with all lights"
    );
    assert!(passed == 0 && passed_alone >= 6);
    assert!(all <= 2.0 && alone >= 2.0 * all);
}

/// A constant times each mistake. Where the product is what another mistake comes to, or a right estimator,
/// or another product, no draws can tell.
#[test]
fn a_constant_times_a_mistake_is_named() {
    let constants = [2.0, 0.5, PI, 1.0 / PI, 4.0, 0.25, 2.0 * PI, 0.5 / PI];
    let (mut runs, mut named, mut single, mut right) = (0, 0, 0, 0);
    let every = if seeds() > 3 { 1 } else { 7 };
    let mut missed = Vec::new();
    for (index, (exercise, mistake)) in gallery().enumerate().filter(|(_, (of, it))| !is_faint(of, it)) {
        for (which, constant) in constants.into_iter().enumerate() {
            if !(index * constants.len() + which).is_multiple_of(every) {
                continue;
            }
            let attempt = exercise.attempt_of(mistake, constant);
            let diagnosis = diagnosed(&attempt, DRAWS, 3_000_000 + 10 * index as u64 + which as u64);
            runs += 1;
            let is_it = |candidate: &Candidate| {
                let here = candidate.mistake.is_some_and(|other| std::ptr::eq(other, mistake));
                here && candidate.factor == Some(["2", "½", "π", "1/π", "4", "¼", "2π", "1/(2π)"][which])
            };
            let here = diagnosis.candidates.iter().any(|of| of.rank == 0 && is_it(of));
            named += i32::from(here);
            if !here {
                match diagnosis.finding {
                    Finding::NothingWrong => right += 1,
                    _ if diagnosis.candidates.iter().any(|candidate| candidate.factor.is_none()) => {
                        single += 1
                    }
                    _ => missed.push(format!("{constant:.3} × {}: {diagnosis}", mistake.name)),
                }
            }
        }
    }
    println!(
        "{runs} products: {named} named first, {single} are a single mistake, {right} right; others \
         {missed:#?}"
    );
    assert!(f64::from(named) >= 0.9 * f64::from(runs));
    assert!(missed.len() as f64 <= 0.02 * f64::from(runs));
}

/// A parameter too much, alone or beside a mistake: the probes differ in it.
#[test]
fn a_parameter_too_much_is_named() {
    let of_paths = |factor: fn(&Scene) -> f64| {
        Attempt::new(move |p: &LightOfPaths, rng| factor(p.room.scene()) * shared_sample(p, rng))
    };
    let of_area = |factor: fn([f64; 2]) -> f64| {
        Attempt::new(move |p: &Integral, rng| {
            let ([x, y], [[a, b], [c, d]]) = (p.rectangle.sample(rng), p.ends());
            factor([b - a, d - c]) * p.rectangle.area() * p.f(x, y)
        })
    };
    let of_count = |factor: fn(f64) -> f64| {
        Attempt::new(move |p: &NumberOfBounces, rng| {
            factor(p.p_rr) * ((1.0 - rng.uniform()).ln() / p.p_rr.ln()).floor()
        })
    };
    let wrapped = |factor: fn(f64) -> f64| {
        Attempt::new(
            move |p: &Wrapped, rng| {
                if rng.uniform() < p.p_rr { factor(p.p_rr) * p.x(rng) / p.p_rr } else { 0.0 }
            },
        )
    };
    let cosine =
        |p: &Reflection, rng: &mut Stream| p.albedo.powi(3) * p.light(&Hemisphere::Cosine.sample(rng));
    for (symbol, attempt) in [
        ("λ", Attempt::new(|_: &Samples, rng| -(1.0 - rng.uniform()).log10())),
        ("the area", of_area(|[w, h]| (w * h).powi(2))),
        ("the width", of_area(|[w, _]| w)),
        ("the height", of_area(|[_, h]| h)),
        ("ρ", Attempt::new(cosine)),
        ("ρ_wall", of_paths(|scene| scene.wall_albedo)),
        ("ρ_cube", of_paths(|scene| scene.cube_albedo)),
        ("1 − ρ_wall", of_paths(|scene| 1.0 - scene.wall_albedo)),
        ("p_rr", of_count(|p| p * p)),
        ("1 − p_rr", of_count(|p| (1.0 - p).powi(2))),
        ("p_rr", wrapped(|p| p.powi(3))),
        ("1 − p_rr", wrapped(|p| (1.0 - p).powi(2))),
    ] {
        let named = names(&diagnosed(&attempt, DRAWS, 3100));
        let told = format!("a factor of {symbol} too much");
        assert!(named.iter().any(|name| name.starts_with(&told)), "{symbol}: {named:?}");
    }
}

#[test]
fn a_constant_alone_is_named_and_an_unknown_mistake_is_not() {
    let doubled =
        Attempt::new(|p: &NumberOfBounces, rng| 2.0 * ((1.0 - rng.uniform()).ln() / p.p_rr.ln()).floor());
    assert_eq!(names(&diagnosed(&doubled, DRAWS, 3000)), ["a factor of 2 too much"]);
    let attempts = [
        Attempt::new(|p: &Samples, rng| -1.1 * (1.0 - rng.uniform()).ln() / p.rate),
        Attempt::new(|p: &Samples, rng| rng.uniform().powi(3) / p.rate),
        Attempt::new(|p: &Integral, rng| {
            let [x, y] = p.rectangle.sample(rng);
            1.07 * p.rectangle.area() * p.f(x, y)
        }),
        Attempt::new(|p: &Reflection, rng| 0.9 * p.albedo * p.light(&Hemisphere::Cosine.sample(rng))),
        Attempt::new(|p: &Reflection, rng| {
            let direction = Hemisphere::Cosine.sample(rng);
            p.albedo * p.light(&direction) * direction.cos_theta().sqrt()
        }),
        Attempt::new(
            |p: &Wrapped, rng| if rng.uniform() < p.p_rr { p.x(rng) / p.p_rr.powf(0.7) } else { 0.0 },
        ),
        Attempt::new(|p: &LightOfPaths, rng| 0.93 * shared_sample(p, rng)),
    ];
    for (index, attempt) in attempts.iter().enumerate() {
        let diagnosis = diagnosed(attempt, DRAWS, 3000 + index as u64);
        assert_eq!(diagnosis.finding, Finding::Unknown, "{index}: {diagnosis}");
        assert!(diagnosis.candidates.is_empty());
        let text = diagnosis.to_string();
        let compared = format!("none of the {} mistakes compared", diagnosis.compared);
        assert!(text.starts_with("Not right") && text.contains(&compared), "{text}");
        assert!(diagnosis.compared > 9 * attempt.exercise.mistakes.len());
    }
}
