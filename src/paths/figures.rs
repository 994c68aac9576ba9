//! Plots of section 4: convergence, occlusion, number of bounces, and the cost of the ways of sampling.

pub use super::side_view::paths_drawn;

use rand::distr::Distribution;

use crate::error::Result;
use crate::estimate::Estimate;
use crate::estimator::{Estimator, from_fn};
use crate::lambertian::hemisphere::Hemisphere::{Cosine, Uniform};
use crate::numbers::typeset;
use crate::paths::room::{BoxRoom, Vertex, exact};
use crate::paths::{Bounces, FindLight, Paths, reflected};
use crate::plot::{Axis, Figure, Ink, Marker, Panel, Plot, Side, extent};
use crate::run::{Budget, Run, estimate};
use crate::stream::Stream;

/// Figure for 4.3: running means of three estimators of the two-bounce radiance, with the exact value if
/// known.
///
/// # Errors
/// If it cannot be drawn.
pub fn two_bounces_converging(room: &BoxRoom, seed: u64) -> Result<Figure> {
    const LAST: u64 = 100_000;
    let room = *room;
    let reflected_once = |p_j: &Vertex| room.albedo(p_j) * room.scene().radiance * exact::seen(&room, p_j);
    let known = reflected(room, Cosine, |p_j, _| reflected_once(p_j));
    let sampled = Paths::new(room, Bounces::Exactly(2), Uniform, FindLight::BySampling)?;
    let chance = Paths::new(room, Bounces::Exactly(2), Cosine, FindLight::ByChance)?;
    let reference = estimate(&sampled, Budget::Draws(LAST), seed)?;
    let truth = room.two_bounces();
    let middle = truth.unwrap_or(reference.mean());
    // if no light reaches p the axes still need a height
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
        panel.note(Ink::Black, [1.0, 0.31], Side::Left, &format!("truth {}", typeset(truth, 5)));
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
    Plot::of("4_3_convergence", 66.0, vec![panel]).draw(
        "Three estimators of the light after two bounces, and the value they converge to",
        format!(
            "Running means against the number of paths n from 10 to {LAST}, logarithmic (seed {seed}). With \
             the exact Lₒ(pⱼ) and cosine directions the mean settles first; with the light sampled at pⱼ and \
             uniform directions it settles next, within its 95 % band; where the light is found by chance, \
             most paths find nothing and the mean jumps."
        ),
    )
}

/// The means of the first n draws, for 25 n per decade from 10 on.
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

/// Figure for 4.3: how an estimate changes if occluded directions are left out of n. Radiance 1 comes from
/// cos θ > 0.8, and a black occluder covers the directions with cos θ < c.
///
/// # Errors
/// If it cannot be drawn.
pub fn occluded_fraction(draws: u64, seed: u64) -> Result<Figure> {
    const ABOVE: f64 = 0.8;
    let truth = 1.0 - ABOVE * ABOVE; // radiance 1 from cos θ > 0.8, ρ = 1
    let mut panel = Panel::new(
        "What an occluded direction counts",
        Axis::linear("occluded fraction c of directions", 0.0, 0.85),
        Axis::linear("estimate/ρ (W m⁻² sr⁻¹)", 0.0, 2.0),
    );
    panel.level("divided by n", Ink::Blue, truth);
    panel.curve_between("divided by the visible", Ink::Vermilion, [0.0, ABOVE], |c| truth / (1.0 - c));
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
    Plot::of("4_3_occlusion", 62.0, vec![panel]).draw(
        "An occluded direction counts: it adds 0 to the sum and 1 to n",
        format!(
            "L̂/ρ with uniform directions against the fraction c that is occluded, from 0 to 0.8; the light \
             itself stays. The sum divided by all n is flat at {truth:.2}; divided by the number of visible \
             directions it rises as {truth:.2}/(1 − c), to five times that. Points: {draws} directions each \
             (seed {seed})."
        ),
    )
}

/// A way to find the light with finite variance: by chance if the light touches the walls, where the weights
/// of light samples are unbounded, else by sampling it.
fn find_light(room: &BoxRoom) -> Result<FindLight> {
    let sampled = Paths::new(*room, Bounces::UpTo(2), Cosine, FindLight::BySampling)?;
    Ok(if sampled.doubt().is_none() { FindLight::BySampling } else { FindLight::ByChance })
}

/// Figure for 4.3: radiance by the number of bounces, exact where known, else from ten million paths each.
///
/// # Errors
/// If it cannot be drawn.
pub fn radiance_by_bounces(room: &BoxRoom, seed: u64) -> Result<Figure> {
    const PATHS: u64 = 10_000_000;
    const MOST: u32 = 8;
    let (mut exact, mut found) = (Vec::new(), Vec::new());
    let light = find_light(room)?;
    for k in 1..=MOST {
        let known = match k {
            1 => Some(room.one_bounce()),
            2 => room.two_bounces(),
            _ => None,
        };
        let at = f64::from(k);
        if let Some(known) = known {
            exact.push([at, 1e3 * known]);
        } else {
            let paths = Paths::new(*room, Bounces::Exactly(k), Cosine, light)?;
            let light = estimate(&paths, Budget::Draws(PATHS), seed)?;
            let (mean, error) = (1e3 * light.mean(), 1.96e3 * light.std_error().unwrap_or(0.0));
            found.push([at, mean, mean - error, mean + error]);
        }
    }
    // k, the value, and the ends of its interval
    let all: Vec<_> = exact.iter().map(|&[k, y]| [k, y, y, y]).chain(found.iter().copied()).collect();
    // if no light reaches p the axes still need a height
    let [least, most] = extent(all.iter().map(|[_, y, ..]| *y)).unwrap_or([1.0; 2]);
    let (low, high) = (10f64.powf((0.8 * least).log10().floor()), 10f64.powf((2.0 * most).log10().ceil()));
    let mut panel = Panel::new(
        "Light by the number of bounces",
        Axis::linear("bounces k", 0.4, 8.6).with_ticks((1..=MOST).map(|k| (f64::from(k), k.to_string()))),
        Axis::log("Lₖ (mW m⁻² sr⁻¹)", low, high),
    );
    let above_0 = || found.iter().copied().filter(|[_, y, ..]| *y > 0.0);
    panel
        .bars("exact", Ink::Blue, 0.7, exact.iter().copied().filter(|[_, y]| *y > 0.0))
        .bars("estimated", Ink::Vermilion, 0.7, above_0().map(|[k, y, ..]| [k, y]))
        .error_bars("estimated", Ink::Black, Marker::Dot, above_0());
    for &[k, y, ..] in &all {
        // the label of a bar of no height stands at the foot of the axis
        panel.text(Ink::Black, [k, y.max(low)], Side::Above, &typeset(y, 3));
    }
    let known = exact.iter().map(|[k, _]| k.to_string()).collect::<Vec<_>>().join(", ");
    let [first, second] = [0.93, 0.84].map(|up| [8.4, panel.y.value(up)]);
    panel.text(Ink::Blue, first, Side::Left, &format!("k = {known}: exact")).text(
        Ink::Vermilion,
        second,
        Side::Left,
        "others: estimated",
    );
    let less = all.iter().zip(all.iter().skip(1)).all(|([.., low, _], [.., next])| next < low);
    Plot::of("4_3_bounces", 66.0, vec![panel]).draw(
        if less { "Each bounce adds less" } else { "The light after one bounce, after two, and so on" },
        format!(
            "Bars, on a logarithmic scale: the light that leaves p after k = 1 to 8 bounces. For k = {known} \
             it is exact; the others are means of {PATHS} paths each with 95 % intervals, most too short to \
             be seen (seed {seed})."
        ),
    )
}

/// One estimator: the cost of a path, and the error of means of n paths.
struct Series {
    label: &'static str,
    ink: Ink,
    marker: Marker,
    /// a path's standard deviation, and its bias if that is significant; both relative to the truth
    spread: f64,
    bias: f64,
    rays: f64,
    seconds: f64,
    /// n and RMSE
    measured: Vec<[f64; 2]>,
}

impl Series {
    fn measure(
        (label, ink, marker): (&'static str, Ink, Marker),
        paths: &Paths,
        truth: f64,
        seed: u64,
    ) -> Result<Self> {
        const PATHS: u64 = 100_000;
        const REPLICATES: u64 = 100;
        let run = Run::new(seed).threads(1).estimate(paths, Budget::Draws(PATHS))?;
        let measured = [16u64, 128, 1024].map(|n| {
            // one stream per replicate
            let means = (0..REPLICATES).map(|replicate| {
                let mut rng = Stream::new(seed, (n << 32) + replicate);
                (0..n).map(|_| paths.draw(&mut rng)).sum::<f64>() / n as f64
            });
            let square: f64 = means.map(|mean| (mean - truth).powi(2) / REPLICATES as f64).sum();
            [n as f64, square.sqrt() / truth]
        });
        Ok(Self {
            label,
            ink,
            marker,
            spread: run.estimate.variance().unwrap_or(0.0).sqrt() / truth,
            bias: 0.0,
            rays: run.cost.evaluations as f64 / PATHS as f64,
            seconds: run.elapsed.as_secs_f64() / PATHS as f64,
            measured: measured.into(),
        })
    }

    fn rmse(&self, paths: f64) -> f64 {
        (self.bias * self.bias + self.spread * self.spread / paths).sqrt()
    }
}

/// The radiance of `paths` with its standard error, from two million paths if they are short, fewer if they
/// are long, and at least a hundred thousand.
fn reference(paths: &Paths, seed: u64) -> Result<[f64; 2]> {
    const FEWEST: u64 = 100_000;
    // a different seed, so that the reference's error is independent of what is measured against it
    let run = Run::new(seed ^ 0x5eed);
    let rays = run.estimate(paths, Budget::Draws(1000))?.cost.evaluations as f64 / 1000.0;
    let draws = ((2e7 / rays.max(1.0)) as u64).clamp(FEWEST, 2_000_000);
    let found = run.estimate(paths, Budget::Draws(draws))?.estimate;
    Ok([found.mean(), found.std_error().unwrap_or(0.0)])
}

/// Figures for 4.3: RMSE relative to the truth, for the four ways of sampling and for roulette against
/// truncation. One figure is against rays, which are the same on every machine, the other against seconds on
/// this machine. Empty if p gets no light.
///
/// Ways whose variance may be infinite, [`Estimator::doubt`], are left out. So are all estimates of all
/// bounces if an albedo is too large for absorption to end a path.
///
/// # Errors
/// If they cannot be drawn.
pub fn path_errors(room: &BoxRoom, seed: u64) -> Result<Vec<Figure>> {
    let by = find_light(room)?;
    let paths = |bounces| Paths::new(*room, bounces, Cosine, by);
    let two = match room.two_bounces() {
        Some(two) => room.one_bounce() + two,
        None => reference(&paths(Bounces::UpTo(2))?, seed)?[0],
    };
    if two <= 0.0 {
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
        if paths.doubt().is_none() {
            ways.push(Series::measure((label, ink, marker), &paths, two, seed)?);
        }
    }
    let mut endings = Vec::new();
    // fails if an albedo is too large for absorption to end paths; there is no other reference then
    if let Ok(by_throughput) = paths(Bounces::AllByThroughput) {
        let [all, all_error] = reference(&by_throughput, seed)?;
        for (label, ink, marker, bounces) in [
            ("k ≤ 2", Ink::Purple, Marker::Cross, Bounces::UpTo(2)),
            ("k ≤ 4", Ink::Green, Marker::Triangle, Bounces::UpTo(4)),
            ("roulette q = 0.8", Ink::Vermilion, Marker::Square, Bounces::All(0.8)),
            ("roulette by throughput", Ink::Blue, Marker::Disc, Bounces::AllByThroughput),
        ] {
            let paths = paths(bounces)?;
            if paths.doubt().is_some() {
                continue;
            }
            let mut series = Series::measure((label, ink, marker), &paths, all, seed)?;
            if let Bounces::UpTo(_) = bounces {
                let [mean, error] = reference(&paths, seed)?;
                if (mean - all).abs() > 4.0 * error.hypot(all_error) {
                    series.bias = (mean - all) / all;
                }
            }
            endings.push(series);
        }
    }
    let drawn = |name, unit, range, cost: fn(&Series) -> f64| {
        error_figure(name, unit, range, cost, [&ways, &endings], seed)
    };
    Ok(vec![
        drawn("4_3_error", "rays", [10.0, 1e6], |series| series.rays)?,
        drawn("4_3_error_seconds", "seconds on one core", [1e-6, 0.06], |series| series.seconds)?,
    ])
}

fn error_figure(
    name: &'static str,
    unit: &str,
    [low, high]: [f64; 2],
    cost: fn(&Series) -> f64,
    [ways, endings]: [&[Series]; 2],
    seed: u64,
) -> Result<Figure> {
    let mut panels = Vec::new();
    for (heading, all, bottom, top) in
        [("Four ways of sampling, k ≤ 2", ways, 2e-4, 20.0), ("Roulette and truncation", endings, 5e-4, 1.0)]
    {
        if all.is_empty() {
            continue;
        }
        // if the light is hard to find, errors are larger
        let highest =
            all.iter().flat_map(|series| &series.measured).fold(0.0, |most: f64, [_, rmse]| most.max(*rmse));
        let shift = (1.6 * highest / top).max(1.0);
        let (bottom, top) = (bottom * shift, top * shift);
        let ticks = [(1e-3, "0.1 %"), (1e-2, "1 %"), (0.1, "10 %"), (1.0, "100 %"), (10.0, "1000 %")];
        let y = Axis::log("RMSE/truth", bottom, top);
        let y = if shift < 10.0 { y.with_ticks(ticks) } else { y };
        let mut panel = Panel::new(heading, Axis::log(unit, low, high), y);
        for series in all {
            let Series { label, ink, marker, .. } = *series;
            let work = cost(series);
            panel.marks(label, ink, marker, series.measured.iter().map(|[n, rmse]| [n * work, *rmse]));
            // where none of the paths found the light there is no line
            if series.spread > 0.0 {
                panel.curve(label, ink, |c| if c >= work { series.rmse(c / work) } else { f64::NAN });
            }
            panel.named(&format!("{} {label}", marker.sign()));
        }
        panels.push(panel);
    }
    let all_light = if endings.is_empty() {
        "All light is left out: an albedo is too large for absorption to end a path."
    } else {
        "All light: the errors of paths of at most two or four bounces level off at the light that they \
         leave out, those of paths ended by roulette keep falling."
    };
    let left_out = ways.len() < 4 || (1..4).contains(&endings.len());
    Plot::of(name, 78.0, panels).draw(
        format!("What the ways of sampling cost: error against {unit}"),
        format!(
            "Root mean square error relative to the truth against {unit}, both logarithmic. Light after at \
             most two bounces, by four ways of sampling: the lower a line, the fewer {unit} are needed for \
             the same error. {all_light} Lines: from a path's variance, bias and cost; points: 100 runs each \
             (seed {seed}).{}",
            if left_out { " Ways whose variance may be infinite are left out." } else { "" }
        ),
    )
}
