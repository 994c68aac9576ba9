//! The gallery in words, and the truths and ratios that are known from elsewhere.

use unbiased::check::{Exercise, Problem};
use unbiased::inversion::mistakes::Samples;
use unbiased::lambertian::hemisphere::Direction;
use unbiased::lambertian::mistakes::Reflection;
use unbiased::paths::mistakes::LightOfPaths;
use unbiased::rectangle::mistakes::Integral;
use unbiased::roulette::mistakes::{NumberOfBounces, Wrapped};

use crate::{exercise, exercises, gallery, is_faint};

#[test]
fn the_gallery_is_complete_and_in_words() {
    println!("{} mistakes", gallery().count());
    assert!(gallery().count() >= 136, "{}", gallery().count());
    let mut ids = std::collections::BTreeSet::new();
    let mut faint = Vec::new();
    for exercise in exercises() {
        let mistakes = &exercise.mistakes;
        println!("{}: {} mistakes, {} probes", exercise.name, mistakes.len(), exercise.probes.len());
        for mistake in mistakes {
            assert_eq!(mistakes.iter().filter(|other| other.name == mistake.name).count(), 1);
            assert!(ids.insert((exercise.id, mistake.id)), "{}", mistake.id);
            let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
            assert!(mistake.id.chars().all(plain), "{}", mistake.id);
            for text in [mistake.name, mistake.formula, mistake.mend] {
                assert!(!text.is_empty() && !text.ends_with('.') && text.chars().count() < 90, "{text}");
            }
            let seen = exercise.probes.iter().any(|probe| probe.sees(exercise.ratio(mistake, probe)));
            assert!(seen || is_faint(exercise, mistake), "no probe sees “{}”", mistake.name);
            faint.extend(is_faint(exercise, mistake).then_some(mistake.id));
        }
        for (index, probe) in exercise.probes.iter().enumerate() {
            assert!(probe.index == index && std::ptr::eq(probe.exercise(), exercise));
            assert!(probe.scale > 0.0 && !probe.to_string().is_empty() && !probe.given.is_empty());
        }
    }
    // a mistake that were not committed any more would be faint, too
    assert_eq!(faint, ["floor", "levels"]);
}

/// The sheet's own numbers, the first that a student tries.
#[test]
fn the_sheets_own_case_is_the_first_probe_of_every_question() {
    for (question, case, truth) in [
        ("1.1", "mean of X, λ = 1", 1.0),
        ("2.1", "f = 1 on [-2, 2]×[-2, 2]", 16.0),
        ("3.2", "L = 1, ρ = 0.8", 0.8),
        ("3.4", "L = cos θ, ρ = 0.8", 1.6 / 3.0),
        ("3.5", "L = cos θ, ρ = 0.8", 1.6 / 3.0),
        ("4.3", "k = 2, p at 0, 0, 1, walls 0.5, cube 0.8, light 10 over ±0.5", 0.039903921548169116),
        ("5", "X = ½ + U, p_rr = 0.8", 1.0),
        ("5.1", "p_rr = 0.8", 4.0),
        ("5.2", "p_rr = 0.2", 0.25),
    ] {
        let probes = exercise(question).unwrap().probes_of(question);
        assert_eq!(probes[0].to_string(), case);
        assert!((probes[0].truth / truth - 1.0).abs() <= 1e-12, "{question}: {}", probes[0].truth);
        // none is lost
        let mut places: Vec<_> = probes.iter().map(|probe| probe.index).collect();
        places.sort_unstable();
        assert!(places.iter().copied().eq(0..probes.len()));
    }
    assert!(exercise("1.3").is_none());
}

/// Light comes from the sky alone: a direction below the horizon brings none, whatever the sky.
#[test]
fn no_light_comes_from_below() {
    for problem in Reflection::all() {
        for cos in [-1.0, -0.5, -1e-300] {
            assert_eq!(problem.light(&Direction::polar(cos, 1.0).unwrap()), 0.0, "{problem}");
        }
        assert!((1..100).any(|k| problem.light(&Direction::polar(0.01 * f64::from(k), 1.0).unwrap()) > 0.0));
    }
}

/// The probes' truths, by pencil.
#[test]
fn probes_have_the_right_truths() {
    let truths =
        |exercise: &'static Exercise| exercise.probes.iter().map(|probe| probe.truth).collect::<Vec<_>>();
    let close = |exercise: &'static Exercise, known: &[f64]| {
        let found = truths(exercise);
        assert_eq!(found.len(), known.len());
        for (found, known) in found.iter().zip(known) {
            let off = (found - known).abs();
            assert!(off <= 1e-10 * known.abs().max(1e-3), "{exercise:?}: {found} {known}");
        }
    };
    let capped = (1.0 - (-2f64).exp()) / 2.5;
    close(Samples::exercise(), &[1.0, 1.0 / 0.37, 0.4, 0.5, capped, 0.5]);
    let squares = (8.0 - 0.027) / 3.0 * 4.1 + (27.0 + 1.331) / 3.0 * 1.7;
    let [product, plane] = [6.97 * 1.15 * 0.95, 6.97 * (1.15 + 1.9)];
    close(Integral::exercise(), &[16.0, 128.0 / 3.0, 0.0, 6.97, squares, product, plane, 0.04 * 40.0005]);
    assert_eq!(Integral::exercise().probes[2].scale, 16.0); // (2 · 2²/2)²
    close(Reflection::exercise(), &[1.6 / 3.0, 0.8, 0.61, 0.305, 0.61, 0.61, 0.61]);
    close(Wrapped::exercise(), &[1.0; 4]);
    close(NumberOfBounces::exercise(), &[4.0, 0.25, 0.83 / 0.17, 99.0]);
    // the light of one and of two bounces by pencil and by quadrature: tests/scene.rs
    let paths = truths(LightOfPaths::exercise());
    let powers = |range: std::ops::RangeInclusive<i32>| range.map(|k| 0.8f64.powi(k)).sum::<f64>();
    for (found, known) in [
        (paths[0], 0.039903921548169116),
        (paths[5], 2.5 * (1.0 + 0.37 + 0.37 * 0.61)),
        (paths[6], 0.4 * 0.343),
        (paths[7], 2.5 * powers(0..=6)),
    ] {
        assert!((found / known - 1.0).abs() <= 1e-12, "{found} {known}");
    }
}

/// The table of known ratios, worked out independently, to the digits that it gives.
#[allow(clippy::approx_constant)] // copied from a table
#[test]
fn ratios_agree_with_the_known_table() {
    let mut compared = 0;
    let mut known = |exercise: &'static Exercise, id: &str, probes: &[usize], ratios: &[f64]| {
        let mistake = exercise.mistakes.iter().find(|mistake| mistake.id == id);
        let mistake = mistake.unwrap_or_else(|| panic!("{} has no “{id}”", exercise.name));
        for (probe, ratio) in probes.iter().zip(ratios) {
            let found = exercise.ratio(mistake, &exercise.probes[*probe]);
            let off = (found.mean - ratio).abs();
            let allowed = 6.0 * found.error + 5.1e-4f64.min(0.01 * ratio.abs());
            assert!(off <= allowed, "“{id}” at {probe}: {found:?}, {ratio}");
            // a light found by chance is known to 4 % only
            let known = if id == "counted-twice" { 0.05 } else { 3e-3 };
            assert!(found.error <= known * ratio.abs().max(1.0), "“{id}” at {probe}: {found:?}");
            compared += 1;
        }
    };
    // L = 1, cos θ, cos² θ, half the sky, the lobe
    let skies = [1, 0, 3, 4, 5];
    for (id, ratios) in [
        ("pdf-pi", [0.5; 5]),
        ("clamped-sphere", [0.5; 5]),
        ("pdf-sphere", [2.0; 5]),
        ("no-cos", [2.0, 1.5, 1.3333, 2.0, 1.1716]),
        ("no-brdf-pi", [3.1416; 5]),
        ("pi-twice", [0.3183; 5]),
        ("cosine-pdf-no-pi", [0.3183; 5]),
        ("no-pdf", [0.1592; 5]),
        ("times-pdf", [0.02533; 5]),
        ("cos-twice", [0.6667, 0.75, 0.8, 0.6667, 0.8619]),
        ("cos-kept", [0.6667, 0.75, 0.8, 0.6667, 0.8619]),
        ("uniform-weight", [1.3333, 1.5, 1.6, 1.3333, 1.7239]),
        ("cosine-weight", [1.0, 0.75, 0.6667, 1.0, 0.5858]),
        ("theta-uniform", [1.2732, 1.5, 1.6977, 1.2732, 1.8006]),
        ("no-sin", [2.0, 2.3562, 2.6667, 2.0, 2.8284]),
        ("disc-radius", [1.0, 1.1781, 1.3333, 1.0, 1.4142]),
        ("doubled", [1.0, 0.709, 0.566, 1.0, 0.4]),
        ("half-turn", [1.0, 1.0, 1.0, 2.0, 2.0]),
        ("same-u", [1.0, 1.0, 1.0, 1.0, 2.0]),
        ("u-squared", [1.0, 0.5, 0.4, 1.0, 0.3182]),
        // ∫ 4 cos³ θ L d(cos θ): 1, 6/5 · 2/3 …: the density in proportion to cos³ θ
        ("in-the-ball", [1.0, 1.2, 1.3333, 1.0, 1.5]),
    ] {
        known(Reflection::exercise(), id, &skies, &ratios);
    }
    // grazing light, cos θ < ¼: 16 ∫ w dc over a right 1
    known(Reflection::exercise(), "no-cos", &[6], &[8.0]);
    known(Reflection::exercise(), "cosine-weight", &[6], &[4.0]);

    let rate = 0.37f64;
    for (id, ratio) in [
        ("times-rate", rate * rate),
        ("sign", -1.0),
        ("log10", 0.4343),
        ("log2", 1.4427),
        ("median", 0.6931),
        ("pdf-read", rate * (1.0 - (-rate).exp())),
        ("floor", 1.0 - 1e-3),
        ("levels", 1.0 - 1.9e-4),
    ] {
        known(Samples::exercise(), id, &[1], &[ratio]);
    }
    let (w, h, area) = (1.7, 4.1, 6.97f64);
    for (id, ratio) in [
        ("no-area", 1.0 / area),
        ("times-p", 1.0 / area / area),
        ("width-squared", w / h),
        ("sides-added", (w + h) / area),
        ("perimeter", 2.0 * (w + h) / area),
        ("root-area", 1.0 / area.sqrt()),
        ("half", 0.5),
    ] {
        known(Integral::exercise(), id, &[3], &[ratio]);
    }
    known(Integral::exercise(), "width-only", &[0], &[0.25]);
    known(Integral::exercise(), "perimeter", &[0], &[1.0]);
    known(Integral::exercise(), "same-u", &[2], &[64.0 / 3.0 / 16.0]); // 64/3, in units of ∫∫ |xy| = 16
    known(Integral::exercise(), "same-u", &[6], &[1.0]);
    for (index, p) in [0.8, 0.2, 0.83, 0.99].into_iter().enumerate() {
        for (id, ratio) in [
            ("no-compensation", p),
            ("over-end", p / (1.0 - p)),
            ("times-p", p * p),
            ("twice", 1.0 / p),
            ("flipped", (1.0 - p) / p),
            ("same-u", 0.5 + 0.5 * p),
            ("at-most-95", f64::min(1.0, 0.95 / p)),
        ] {
            known(Wrapped::exercise(), id, &[index], &[ratio]);
        }
        known(NumberOfBounces::exercise(), "coins", &[index], &[1.0 / p]);
        known(NumberOfBounces::exercise(), "exchanged", &[index], &[((1.0 - p) / p).powi(2)]);
    }
    known(NumberOfBounces::exercise(), "exchanged-coins", &[0], &[1.25 / 4.0]);
    known(NumberOfBounces::exercise(), "at-most-95", &[3], &[19.0 / 99.0]);
    // one and two bounces in the odd room, two on the sheet, three in a furnace of 0.7
    for (id, once, twice) in [
        ("no-area", 0.3906, 0.3906), // 1/2.56
        ("times-density", 0.1526, 0.1526),
        ("half-width", 0.25, 0.25),
        ("counted-twice", 2.0, 2.0),
        ("no-pi-light", 3.1416, 3.1416),
        ("no-pi", 3.1416, 9.8696),
        ("no-last-albedo", 2.7027, 1.6393), // 1/0.37, 1/0.61
        ("one-albedo", 1.0, 0.6066),
        ("no-throughput", 1.0, 2.7027),
        ("roulette-bare", 1.0, 0.8),
        ("roulette-twice", 1.0, 1.25),
    ] {
        known(LightOfPaths::exercise(), id, &[1, 4], &[once, twice]);
    }
    for (id, ratio) in [
        ("one-less", 6.8378),
        ("one-more", 0.5578), // 0.33502 − 0.31276, over 0.039904: by two other programs, to 3e-4
    ] {
        known(LightOfPaths::exercise(), id, &[0], &[ratio]);
    }
    for (id, ratio) in [
        ("uniform-no-cos", 8.0),
        ("uniform-weight", 2.3704),
        ("cos-kept", 0.2963),
        ("roulette-bare", 0.512),
        ("up-to", 7.3848), // (1 + 0.7 + 0.49 + 0.343)/0.343
        ("replaced", 2.0408),
    ] {
        known(LightOfPaths::exercise(), id, &[6], &[ratio]);
    }
    println!("{compared} known ratios");
    assert!(compared >= 194, "{compared}");
}
