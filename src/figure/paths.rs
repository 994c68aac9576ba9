//! Figures of section 4 with numbers: convergence, occlusion, bounces, and what the ways of sampling cost.

use rand::distr::Distribution;

use super::plot::{Axis, Ink, Marker, Panel, Plot, Side, Width};
use super::{Edition, Figure};
use crate::box_room::BoxRoom;
use crate::error::Result;
use crate::estimate::Estimate;
use crate::hemisphere::Hemisphere::{Cosine, Uniform};
use crate::paths::{Bounces, FindLight, Paths, reflected};
use crate::run::{Budget, Estimator, Run, estimate, from_fn};
use crate::stream::Stream;

/// 4.3: running means of three estimators of the part of two bounces, with the exact value where it is known.
///
/// # Errors
/// If it cannot be drawn.
pub fn two_bounces_converging(room: &BoxRoom, seed: u64) -> Result<Figure> {
    const LAST: u64 = 100_000;
    let room = *room;
    let known = reflected(room, Cosine, |p_j, _| room.direct(p_j));
    let sampled = Paths::new(room, Bounces::Exactly(2), Uniform, FindLight::BySampling)?;
    let chance = Paths::new(room, Bounces::Exactly(2), Cosine, FindLight::ByChance)?;
    let reference = estimate(&sampled, Budget::Draws(LAST), seed)?;
    let truth = room.two_bounces();
    let middle = truth.unwrap_or(reference.mean());
    // nothing to see in the dark, but axes need a height
    let height = if middle > 0.0 { middle } else { 1.0 };
    let mut panel = Panel::new(
        "Light after two bounces",
        Axis::log("paths n", 10.0, LAST as f64),
        Axis::linear("mean (W m⁻² sr⁻¹)", 0.0, 2.0 * height),
    );
    let spread = reference.variance().unwrap_or(0.0).sqrt();
    let band = |n: f64| 1.96 * spread / n.sqrt();
    panel.band(
        "95 % of the light sampled",
        Ink::Vermilion,
        (0..=60)
            .map(|i| 10f64.powf(1.0 + f64::from(i) / 15.0))
            .map(|n| [n, middle - band(n), middle + band(n)]),
    );
    if let Some(truth) = truth {
        panel.level("truth", Ink::Black, truth);
        panel.text(Ink::Black, [9e4, 0.62 * truth], Side::Left, &format!("truth {truth:.6}"));
    }
    for (series, ink, estimator) in [
        ("light by chance", Ink::Green, &chance as &dyn Estimator),
        ("light sampled", Ink::Vermilion, &sampled),
        ("Lₒ(pⱼ) known", Ink::Blue, &known),
    ] {
        panel.line(series, ink, running_means(estimator, LAST, seed));
    }
    panel
        .text(Ink::Green, [9e4, 1.85 * height], Side::Left, "dash-dot: light by chance")
        .text(Ink::Vermilion, [9e4, 1.69 * height], Side::Left, "dashed: light sampled")
        .text(Ink::Blue, [9e4, 1.53 * height], Side::Left, "solid: Lₒ(pⱼ) known");
    Plot {
        name: "4_3_convergence",
        title: "Three estimators of the light after two bounces, and the value they converge to".into(),
        description: format!(
            "Running means against the number of paths n from 10 to {LAST}, logarithmic (seed {seed}). With the exact Lₒ(pⱼ) and cosine directions the mean settles first; with the light sampled at pⱼ and uniform directions, in its \
             95 % band, next; where the light is found by chance most paths find nothing, and the mean jumps."
        ),
        edition: Edition::Solution,
        width: Width::Column,
        height_mm: 66.0,
        columns: 1,
        panels: vec![panel],
    }
    .draw()
}

/// The means of the first n draws, at 25 n a decade from 10 on.
fn running_means(estimator: &dyn Estimator, last: u64, seed: u64) -> Vec<[f64; 2]> {
    let mut rng = Stream::new(seed, 0);
    let (mut sum, mut points, mut next) = (Estimate::new(), Vec::new(), 10.0);
    for n in 1..=last {
        sum.push(estimator.draw(&mut rng));
        if n as f64 >= next {
            points.push([n as f64, sum.mean()]);
            next = (n as f64 * 10f64.powf(0.04)).max(n as f64 + 1.0);
        }
    }
    points
}

/// 4.3: what becomes of an estimate when occluded directions are left out of n: the light stands where cos θ > 0.8, and something dark fills the directions below cos θ = c.
///
/// # Errors
/// If it cannot be drawn.
pub fn occluded_fraction(draws: u64, seed: u64) -> Result<Figure> {
    const ABOVE: f64 = 0.8;
    let truth = 1.0 - ABOVE * ABOVE; // of a white surface under a light of radiance 1
    let mut panel = Panel::new(
        "What an occluded direction counts",
        Axis::linear("occluded fraction c of directions", 0.0, 0.85),
        Axis::linear("estimate/ρ (W m⁻² sr⁻¹)", 0.0, 2.0),
    );
    panel.level("divided by n", Ink::Blue, truth);
    panel.curve_between("divided by the visible", Ink::Vermilion, 0.0, ABOVE, |c| truth / (1.0 - c));
    let mut measured = [Vec::new(), Vec::new()];
    for tenth in 0..=8 {
        let c = f64::from(tenth) / 10.0;
        let light = from_fn(|rng| {
            let cos = Uniform.sample(rng).cos_theta();
            if cos > ABOVE { 2.0 * cos } else { 0.0 }
        });
        let visible = from_fn(|rng| f64::from(u8::from(Uniform.sample(rng).cos_theta() > c)));
        // the same directions for both
        let light = estimate(&light, Budget::Draws(draws), seed)?.mean();
        let visible = estimate(&visible, Budget::Draws(draws), seed)?.mean();
        let [all, seen] = &mut measured;
        all.push([c, light]);
        seen.push([c, light / visible]);
    }
    let [all, seen] = measured;
    panel
        .marks("measured, divided by n", Ink::Blue, Marker::Disc, all)
        .marks("measured, divided by the visible", Ink::Vermilion, Marker::Square, seen)
        .text(Ink::Blue, [0.02, 0.22], Side::Right, "divided by all n: right")
        .text(Ink::Vermilion, [0.02, 1.2], Side::Right, "divided by the visible")
        .text(Ink::Vermilion, [0.02, 1.04], Side::Right, "ones alone: too bright");
    Plot {
        name: "4_3_occlusion",
        title: "An occluded direction counts: it adds 0 to the sum and 1 to n".into(),
        description: format!(
            "L̂/ρ with uniform directions against the fraction c that is occluded, from 0 to 0.8; the light itself stays. The sum divided by all n is flat at {truth:.2}; divided by the number of visible directions it rises as {truth:.2}/(1 − c), to five times that. \
             Points: {draws} directions each (seed {seed})."
        ),
        edition: Edition::Solution,
        width: Width::Column,
        height_mm: 62.0,
        columns: 1,
        panels: vec![panel],
    }
    .draw()
}

/// 4.3: the light by the number of bounces, exact where it is known.
///
/// # Errors
/// If it cannot be drawn.
pub fn radiance_by_bounces(room: &BoxRoom, seed: u64) -> Result<Figure> {
    const PATHS: u64 = 300_000;
    let (mut exact, mut found) = (Vec::new(), Vec::new());
    for k in 1..=8u32 {
        let known = match k {
            1 => Some(room.one_bounce()),
            2 => room.two_bounces(),
            _ => None,
        };
        let at = f64::from(k);
        if let Some(known) = known {
            exact.push([at, 1e3 * known]);
        } else {
            let paths = Paths::new(*room, Bounces::Exactly(k), Cosine, FindLight::BySampling)?;
            let light = estimate(&paths, Budget::Draws(PATHS), seed)?;
            let (mean, error) = (1e3 * light.mean(), 1.96e3 * light.std_error().unwrap_or(0.0));
            found.push([at, mean, mean - error, mean + error]);
        }
    }
    let values =
        || exact.iter().map(|[_, y]| *y).chain(found.iter().map(|[_, y, ..]| *y)).filter(|y| *y > 0.0);
    // in the dark there is nothing to see, but axes need a height
    let (least, most) = values().fold((1.0, 1.0), |(least, most): (f64, f64), y| (least.min(y), most.max(y)));
    let (low, high) = (10f64.powf(least.log10().floor()), 10f64.powf((2.0 * most).log10().ceil()));
    let mut panel = Panel::new(
        "Light by the number of bounces",
        Axis::linear("bounces k", 0.4, 8.6).with_ticks((1..=8).map(|k| (f64::from(k), k.to_string()))),
        Axis::log("Lₖ (mW m⁻² sr⁻¹)", low, high),
    );
    panel.bars("exact", Ink::Blue, 0.7, exact.iter().copied());
    panel.bars("estimated", Ink::Vermilion, 0.7, found.iter().map(|[k, y, ..]| [*k, *y]));
    panel.error_bars("estimated", Ink::Black, Marker::Dot, found.iter().copied());
    for [k, y] in
        exact.iter().copied().chain(found.iter().map(|[k, y, ..]| [*k, *y])).filter(|[_, y]| *y > 0.0)
    {
        panel.text(
            Ink::Black,
            [k, y],
            Side::Above,
            &format!("{y:.places$}", places = (2.0 - y.log10().floor()).clamp(0.0, 6.0) as usize),
        );
    }
    let top = high / (high / low).powf(0.07);
    panel.text(Ink::Blue, [8.4, top], Side::Left, "k = 1, 2: exact");
    panel.text(Ink::Vermilion, [8.4, top / (high / low).powf(0.09)], Side::Left, "others: estimated");
    Plot {
        name: "4_3_bounces",
        title: "Each bounce adds less".into(),
        description: format!(
            "Bars, on a logarithmic scale: the light that leaves p after k = 1 to 8 bounces. Where the closed form is known, for one and two bounces, it is exact; the others are means of {PATHS} paths each with 95 % intervals (seed {seed})."
        ),
        edition: Edition::Solution,
        width: Width::Column,
        height_mm: 66.0,
        columns: 1,
        panels: vec![panel],
    }
    .draw()
}

/// One estimator, with what a path costs, and how far the means of n paths are from the reference.
struct Series {
    label: &'static str,
    ink: Ink,
    marker: Marker,
    /// a path's standard deviation, and how far its mean is from the reference where that is no noise
    spread: f64,
    bias: f64,
    rays: f64,
    seconds: f64,
    /// n and RMSE
    measured: Vec<[f64; 2]>,
}

impl Series {
    fn measure(
        label: &'static str,
        ink: Ink,
        marker: Marker,
        paths: &Paths,
        truth: f64,
        biased: bool,
        seed: u64,
    ) -> Result<Self> {
        const PATHS: u64 = 100_000;
        const REPLICATES: u64 = 100;
        let run = Run::new(seed).threads(1).estimate(paths, Budget::Draws(PATHS))?;
        let mut measured = Vec::new();
        for n in [16u64, 128, 1024] {
            let mut square = 0.0;
            for replicate in 0..REPLICATES {
                // each replicate a stream of its own
                let mut rng = Stream::new(seed, (n << 32) + replicate);
                let mean = (0..n).map(|_| paths.draw(&mut rng)).sum::<f64>() / n as f64;
                square += (mean - truth).powi(2) / REPLICATES as f64;
            }
            measured.push([n as f64, square.sqrt() / truth]);
        }
        Ok(Self {
            label,
            ink,
            marker,
            spread: run.estimate.variance().unwrap_or(0.0).sqrt() / truth,
            bias: if biased { (run.estimate.mean() - truth) / truth } else { 0.0 },
            rays: run.cost.evaluations as f64 / PATHS as f64,
            seconds: run.elapsed.as_secs_f64() / PATHS as f64,
            measured,
        })
    }

    fn rmse(&self, paths: f64) -> f64 {
        (self.bias * self.bias + self.spread * self.spread / paths).sqrt()
    }
}

/// 4.3: RMSE relative to the truth, for the four ways of sampling and for roulette against truncation: once against rays, which are the same on every machine, and once against this machine's seconds.
/// None where p gets no light.
///
/// # Errors
/// If they cannot be drawn.
pub fn path_errors(room: &BoxRoom, seed: u64) -> Result<Vec<Figure>> {
    let reference = |bounces: u32, paths: u64| -> Result<f64> {
        let paths_of = Paths::new(*room, Bounces::UpTo(bounces), Cosine, FindLight::BySampling)?;
        // a seed of its own, so that no error is shared with what is measured against it
        Ok(estimate(&paths_of, Budget::Draws(paths), seed ^ 0x5eed)?.mean())
    };
    let two = match room.two_bounces() {
        Some(two) => room.one_bounce() + two,
        None => reference(2, 500_000)?,
    };
    let all = reference(32, 300_000)?;
    if !(two > 0.0 && all > 0.0) {
        return Ok(Vec::new());
    }
    let mut ways = Vec::new();
    for (label, ink, marker, directions, light) in [
        ("by chance, uniform", Ink::Purple, Marker::Cross, Uniform, FindLight::ByChance),
        ("by chance, cosine", Ink::Green, Marker::Triangle, Cosine, FindLight::ByChance),
        ("sampled, uniform", Ink::Vermilion, Marker::Square, Uniform, FindLight::BySampling),
        ("sampled, cosine", Ink::Blue, Marker::Disc, Cosine, FindLight::BySampling),
    ] {
        let paths = Paths::new(*room, Bounces::UpTo(2), directions, light)?;
        ways.push(Series::measure(label, ink, marker, &paths, two, false, seed)?);
    }
    let mut endings = Vec::new();
    for (label, ink, marker, bounces) in [
        ("k ≤ 2", Ink::Purple, Marker::Cross, Bounces::UpTo(2)),
        ("k ≤ 4", Ink::Green, Marker::Triangle, Bounces::UpTo(4)),
        ("roulette q = 0.8", Ink::Vermilion, Marker::Square, Bounces::All(0.8)),
        ("roulette by weight", Ink::Blue, Marker::Disc, Bounces::AllByWeight),
    ] {
        // an albedo too large for the weight to end a path: that way is left out
        let Ok(paths) = Paths::new(*room, bounces, Cosine, FindLight::BySampling) else { continue };
        let biased = matches!(bounces, Bounces::UpTo(_));
        endings.push(Series::measure(label, ink, marker, &paths, all, biased, seed)?);
    }
    let by_rays =
        error_figure("4_3_error", "rays", [10.0, 1e6], |series| series.rays, &ways, &endings, seed)?;
    let by_seconds = error_figure(
        "4_3_error_seconds",
        "seconds on one core",
        [1e-6, 0.06],
        |series| series.seconds,
        &ways,
        &endings,
        seed,
    )?;
    Ok(vec![by_rays, by_seconds])
}

fn error_figure(
    name: &'static str,
    unit: &str,
    [low, high]: [f64; 2],
    cost: impl Fn(&Series) -> f64,
    ways: &[Series],
    endings: &[Series],
    seed: u64,
) -> Result<Figure> {
    let mut panels = Vec::new();
    // of two lines close to each other the upper one has its label on the right, where the lines fall away from it
    const SIDES: [Side; 4] = [Side::Right, Side::Left, Side::Right, Side::Left];
    for (heading, all, bottom, top) in
        [("Four ways of sampling, k ≤ 2", ways, 2e-4, 20.0), ("Roulette and truncation", endings, 5e-4, 1.0)]
    {
        let ticks = [(1e-3, "0.1 %"), (1e-2, "1 %"), (0.1, "10 %"), (1.0, "100 %"), (10.0, "1000 %")];
        let mut panel = Panel::new(
            heading,
            Axis::log(unit, low, high),
            Axis::log("RMSE/truth", bottom, top).with_ticks(ticks),
        );
        for (series, side) in all.iter().zip(SIDES) {
            let Series { label, ink, marker, .. } = *series;
            let work = cost(series);
            panel.curve(label, ink, |c| if c >= work { series.rmse(c / work) } else { f64::NAN });
            panel.marks(label, ink, marker, series.measured.iter().map(|[n, rmse]| [n * work, *rmse]));
            if series.bias == 0.0 {
                let past_the_points = low * (high / low).powf(0.55);
                panel.text(ink, [past_the_points, series.rmse(past_the_points / work)], side, label);
            } else {
                panel.text(ink, [high, 1.3 * series.bias.abs()], Side::Left, label);
            }
        }
        panels.push(panel);
    }
    Plot {
        name,
        title: format!("What the ways of sampling cost: error against {unit}"),
        description: format!(
            "Root mean square error relative to the truth against {unit}, both logarithmic. Left, light after at most two bounces: a light sampled at every vertex needs far fewer {unit} than one found by chance, and cosine directions fewer than uniform ones. Right, all light: \
             paths of at most two or four bounces level off at what they leave out, paths ended by roulette fall on. Lines: from a path's variance, bias and cost; points: 100 runs each (seed {seed})."
        ),
        edition: Edition::Solution,
        width: Width::Page,
        height_mm: 78.0,
        columns: 2,
        panels,
    }
    .draw()
}
