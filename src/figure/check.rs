//! Figures of the checks: betting against a mean, and what each classic mistake does to each probe.

use std::f64::consts::LN_10;

use rand::distr::Distribution;

use super::plot::{Axis, Ink, Marker, Panel, Plot, Side, Width};
use super::{Edition, Figure};
use crate::check::{Exercise, Look, Mistake, Probe, Problem, Unbiased};
use crate::error::Result;
use crate::estimator::from_fn;
use crate::hemisphere::Hemisphere;
use crate::numbers::power_of_ten;

/// The relative difference taken for none: half of the smaller bias shown.
const DELTA: f64 = 5e-3;

/// The wealth of those who bet against an estimator's mean, while it is drawn from: a right estimator of the light reflected under L = cos θ,
/// one that is 1 % off, and the classic mistake, uniform directions with the cosine weight. Beside it the bets that certify the right one.
///
/// # Errors
/// If it cannot be drawn.
pub fn wealth(seed: u64) -> Result<Figure> {
    let (truth, range) = (2.0 / 3.0, [0.0, 2.1]);
    let weighted = |factor: f64, power: i32| {
        from_fn(move |rng| factor * Hemisphere::Uniform.sample(rng).cos_theta().powi(power))
    };
    let check = Unbiased::new(truth, range)?.within(DELTA)?.seed(seed);
    // ρ = 1: 2 L cos θ is right, L alone is what cosine directions would need
    let (right, right_looks) = check.trace(&weighted(2.0, 2))?;
    let (off, off_looks) = check.trace(&weighted(2.02, 2))?;
    let (classic, classic_looks) = check.trace(&weighted(1.0, 1))?;
    let [right_draws, off_draws, classic_draws] =
        [right, off, classic].map(|report| report.estimate.draws() as f64);

    let most = right_draws.max(off_draws);
    let end = 10f64.powf(most.log10().ceil()).max(1e6);
    let along = || Axis::log("draws", 100.0, end);
    let wealth_axis = || {
        let powers = (-3..=21).step_by(3).map(|power| (f64::from(power), power_of_ten(power)));
        Axis::linear("wealth (1 at the start)", -4.0, 21.0).with_ticks(powers)
    };

    let mut against = Panel::new("Bets against the truth", along(), wealth_axis());
    against.level("1/α", Ink::Black, 12.0);
    let path = |looks: &[Look], wealth: fn(&Look) -> f64| {
        thinned(looks).map(|look| [look.draws as f64, wealth(look) / LN_10]).collect::<Vec<_>>()
    };
    let truth_bets: fn(&Look) -> f64 = |look| look.against_truth;
    for (series, ink, looks) in [
        ("right", Ink::Blue, &right_looks),
        ("1 % too large", Ink::Green, &off_looks),
        ("uniform directions, cosine weight", Ink::Vermilion, &classic_looks),
    ] {
        let points = path(looks, truth_bets);
        let last = points.last().copied();
        against.line(series, ink, points).marks(&format!("{series}: verdict"), ink, Marker::Disc, last);
    }
    let classic_label = 1.4 * classic_draws;
    against
        .text(Ink::Black, [classic_label, 14.3], Side::Right, "1/α: biased, wrong with")
        .text(Ink::Black, [classic_label, 13.0], Side::Right, "probability 10⁻¹² at most")
        .text(Ink::Vermilion, [classic_label, 10.6], Side::Right, "uniform directions,")
        .text(Ink::Vermilion, [classic_label, 9.3], Side::Right, "cosine weight: refuted")
        .text(Ink::Vermilion, [classic_label, 8.0], Side::Right, &format!("after {classic_draws} draws"))
        .text(Ink::Green, [0.2 * off_draws, 5.2], Side::Left, "1 % too large: refuted")
        .text(Ink::Green, [0.2 * off_draws, 3.9], Side::Left, &format!("after {off_draws} draws"))
        .text(Ink::Blue, [220.0, -1.9], Side::Right, "right: never refuted");

    let mut certificate = Panel::new("Certifying the right estimator", along(), wealth_axis());
    certificate
        .level("1/β", Ink::Black, 6.0)
        .line("bets against 0.5 % less", Ink::Blue, path(&right_looks, |look| look.against_too_low))
        .line("bets against 0.5 % more", Ink::Purple, path(&right_looks, |look| look.against_too_high))
        .text(Ink::Black, [100.0, 11.4], Side::Right, "1/β: unbiased within 0.5 %")
        .text(Ink::Black, [100.0, 10.1], Side::Right, "once both have passed it; each")
        .text(Ink::Black, [100.0, 8.8], Side::Right, "wrong with probability 10⁻⁶")
        .text(Ink::Black, [100.0, 7.5], Side::Right, &format!("at most; here {right_draws} draws"))
        .text(Ink::Blue, [220.0, 4.2], Side::Right, "solid: against 0.5 % less")
        .text(Ink::Purple, [220.0, 2.9], Side::Right, "dotted: against 0.5 % more");

    Plot {
        name: "check_wealth",
        title: format!(
            "Betting against a mean: the classic mistake is refuted after {classic_draws} draws, a bias of 1 % after {off_draws}, and the right \
             estimator certified within 0.5 % after {right_draws}"
        ),
        description: format!(
            "Two panels, wealth against draws, both logarithmic, seed {seed}. Left, bets against the mean 2/3: those on uniform directions \
             with the cosine weight reach 10¹² after {classic_draws} draws, those on an estimator 1 % too large after {off_draws}, those on \
             a right one never. Right, for the right estimator: bets against means 0.5 % less and 0.5 % more both pass \
             10⁶ by {right_draws} draws."
        ),
        edition: Edition::Solution,
        width: Width::Page,
        height_mm: 76.0,
        columns: 2,
        panels: vec![against, certificate],
    }
    .draw()
}

/// Looks at least 2 % apart, and the last.
fn thinned(looks: &[Look]) -> impl Iterator<Item = &Look> {
    let last = looks.last().map_or(0, |look| look.draws);
    let mut next = 0.0;
    looks.iter().filter(move |look| {
        let draws = look.draws as f64;
        let kept = draws >= next || look.draws == last;
        if kept {
            next = 1.02 * draws;
        }
        kept
    })
}

/// The height of a cell of [`mistakes`], and of a line of its heads, in mm.
const CELL: f64 = 4.7;
const LINE: f64 = 3.5;

/// What each classic mistake of an exercise makes of each probe: the ratio of its mean to the truth, in numbers and colours.
///
/// A 1 in full is a mistake that the probe cannot see. Where the truth is 0 the ratio is taken to ∫ |f|, and 0 is right.
///
/// # Errors
/// If it cannot be drawn.
pub fn mistakes<P: Problem>() -> Result<Figure> {
    of(P::exercise())
}

fn of(exercise: &Exercise) -> Result<Figure> {
    let (probes, mistakes) = (exercise.probes(), exercise.mistakes());
    // what all the probes have in common need not stand over each
    let names: Vec<String> = probes.iter().map(ToString::to_string).collect();
    let tail = names.first().and_then(|name| name.rsplit_once(", ")).map(|(_, tail)| format!(", {tail}"));
    let tail = tail.filter(|tail| names.iter().all(|name| name.ends_with(tail.as_str()))).unwrap_or_default();
    let most = 50 / probes.len().max(1);
    let heads: Vec<Vec<String>> =
        names.iter().map(|name| wrapped(name.strip_suffix(tail.as_str()).unwrap_or(name), most)).collect();
    let lines = heads.iter().map(Vec::len).max().unwrap_or(0);

    let rows = mistakes.len() as f64;
    let head = (lines as f64 * LINE + 1.0) / CELL;
    let bottom_up = |index: usize| rows - 1.0 - index as f64;
    let down = mistakes.iter().enumerate().map(|(index, mistake)| (bottom_up(index), mistake.name()));
    let across = Axis::linear("blue: too little, vermilion: too much", 0.5, probes.len() as f64 + 0.5);
    let mut panel = Panel::new(
        &format!("Mean ÷ truth{tail}"),
        across.with_ticks::<&str>([]),
        Axis::linear("mistake", -0.5, rows - 0.5 + head).with_ticks(down),
    );
    for (index, mistake) in mistakes.iter().enumerate() {
        let cells = (1u32..).zip(probes).map(|(column, probe)| {
            let ratio = exercise.ratio(mistake, probe).mean;
            ([f64::from(column), ratio, shade(ratio, probe.right_ratio())], told(exercise, mistake, probe))
        });
        panel.cells(mistake.name(), bottom_up(index), cells);
    }
    for (column, lines_of_head) in (1u32..).zip(&heads) {
        for (line, text) in lines_of_head.iter().rev().enumerate() {
            let y = rows - 0.5 + ((line as f64 + 0.5) * LINE + 0.5) / CELL;
            panel.text(Ink::Black, [f64::from(column), y], Side::Centre, text);
        }
    }
    Plot {
        name: match exercise.id() {
            "samples" => "check_mistakes_exponential",
            "integral" => "check_mistakes_rectangle",
            "reflection" => "check_mistakes_hemisphere",
            "roulette" => "check_mistakes_roulette",
            "bounces" => "check_mistakes_bounces",
            _ => "check_mistakes_paths",
        },
        title: format!(
            "{} classic mistakes ({}) and what each probe shows of them: a plain 1 is a mistake it cannot see",
            mistakes.len(),
            exercise.name()
        ),
        description: format!(
            "A table. Each row is a mistake, each column a probe ({}), each cell the mean of the mistaken draws over the truth, on blue where \
             that is too little and on vermilion where it is too much, in full from a factor of 4. Rows that agree in every column \
             cannot be told apart by their means.",
            names.join("; ")
        ),
        edition: Edition::Solution,
        width: Width::Page,
        // the axis's heading and name take 50 pt
        height_mm: 50.0 * 25.4 / 72.0 + CELL * (rows + head),
        columns: 1,
        panels: vec![panel],
    }
    .draw()
}

/// −1 for far too little, 0 for right, 1 for far too much: by factors up to 4, or about 0 by differences up to 1.
fn shade(ratio: f64, right: f64) -> f64 {
    let shade = if right == 0.0 { ratio } else { 0.5 * (ratio / right).max(0.0).log2() };
    if ratio.is_nan() { 0.0 } else { shade.clamp(-1.0, 1.0) }
}

/// The ratio to two or three digits; in full, 1 or 0, where the probe does not see the mistake.
fn told(exercise: &Exercise, mistake: &Mistake, probe: &Probe) -> String {
    let found = exercise.ratio(mistake, probe);
    let ratio = found.mean;
    let text = match ratio.abs() {
        _ if !probe.sees(found) => format!("{}", probe.right_ratio()),
        size if size.is_nan() => "–".into(),
        0.0 => "0".into(),
        // what would look right shows how far it is off
        _ if (ratio - 1.0).abs() < 5e-3 && probe.right_ratio() == 1.0 => format!("1{:+.0e}", ratio - 1.0),
        size => {
            let most = if size < 0.1 { 3 } else { usize::from(size < 10.0) + 1 };
            let known = |places: &usize| 2.0 * found.error <= 0.5 * 0.1f64.powi(*places as i32);
            format!("{size:.0$}", (0..=most).rev().find(known).unwrap_or(0))
        }
    };
    let minus = if ratio < 0.0 { "−" } else { "" };
    format!("{minus}{}", text.trim_start_matches('-').replace('-', "−"))
}

/// A probe's name in lines of up to `most` characters where that is possible: broken at commas and, if need be, at spaces and after a ×,
/// but never within brackets.
fn wrapped(name: &str, most: usize) -> Vec<String> {
    let mut depth = 0i32;
    let mut parts = vec![vec![String::new()]];
    for c in name.chars() {
        depth += match c {
            '[' | '(' => 1,
            ']' | ')' => -1,
            _ => 0,
        };
        match (c, parts.last_mut()) {
            (',', _) if depth == 0 => parts.push(Vec::new()),
            (' ', Some(words)) if depth == 0 => words.push(String::new()),
            (' ', _) => {}
            (_, Some(words)) => {
                if let Some(word) = words.last_mut() {
                    word.push(if c == '-' { '−' } else { c });
                }
                if c == '×' {
                    words.push(String::new());
                }
            }
            (_, None) => {}
        }
    }
    let mut lines: Vec<String> = Vec::new();
    for words in parts {
        let begun = lines.len();
        for word in words {
            let fits = |line: &&mut String| line.chars().count() + 1 + word.chars().count() <= most;
            match lines.get_mut(begun..).and_then(<[String]>::last_mut).filter(fits) {
                Some(line) => {
                    line.push(' ');
                    line.push_str(&word);
                }
                None => lines.push(word),
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_broken_between_words() {
        assert_eq!(wrapped("L = 2 in half the sky", 7), ["L = 2", "in half", "the sky"]);
        assert_eq!(wrapped("f = xy on [-2, 2]×[0.3, 2]", 9), ["f = xy on", "[−2,2]×", "[0.3,2]"]);
        assert_eq!(wrapped("mean of min(X, 2/λ), λ = 2.5", 10), ["mean of", "min(X,2/λ)", "λ = 2.5"]);
    }

    #[test]
    fn shades_are_signed_and_full_at_a_factor_of_four() {
        for (ratio, right, expected) in [
            (1.0, 1.0, 0.0),
            (2.0, 1.0, 0.5),
            (0.5, 1.0, -0.5),
            (9.0, 1.0, 1.0),
            (0.0, 1.0, -1.0),
            (-1.0, 1.0, -1.0),
            (f64::INFINITY, 1.0, 1.0),
            (f64::NAN, 1.0, 0.0),
            (0.0, 0.0, 0.0),
            (-1.3, 0.0, -1.0),
        ] {
            assert_eq!(shade(ratio, right), expected, "{ratio}, {right}");
        }
    }

    #[test]
    fn every_topic_has_its_matrix_the_same_bytes_each_time() {
        for exercise in crate::workbook::exercises() {
            let figure = of(exercise).unwrap();
            assert_eq!(figure, of(exercise).unwrap());
            assert_eq!(figure.csv().lines().count(), 1 + exercise.mistakes().len() * exercise.probes().len());
            assert!(!figure.svg().contains("NaN"));
        }
    }

    #[test]
    fn thinned_looks_keep_the_first_and_the_last() {
        let looks: Vec<_> = (1..=1000u16)
            .map(|i| Look {
                draws: 256 * u64::from(i),
                against_truth: 0.0,
                against_too_low: 0.0,
                against_too_high: 0.0,
            })
            .collect();
        let kept: Vec<_> = thinned(&looks).map(|look| look.draws / 256).collect();
        assert_eq!(kept.first().copied(), Some(1));
        assert_eq!(kept.last().copied(), Some(1000));
        assert!((150..250).contains(&kept.len()), "{}", kept.len());
    }
}
