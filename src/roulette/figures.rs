//! Figures of section 5.

use crate::error::Result;
use crate::estimator::Estimator;
use crate::numbers::{equals, typeset};
use crate::plot::{Axis, Edition, Figure, Ink, Marker, Panel, Plot, Side, Width};
use crate::roulette::{LightModel, Roulette};
use crate::run::{Budget, estimate};
use crate::stream::Stream;

/// Figure for 5.1: P(N = k) for two continuation probabilities, exact as bars, and measured as points with 95
/// % intervals.
///
/// # Errors
/// If a continuation probability is not in (0, 1).
pub fn bounces(p_rr: [f64; 2], draws: usize, seed: u64) -> Result<Figure> {
    let mut panels = Vec::new();
    for p in p_rr {
        let roulette = Roulette::new(p)?;
        // up to the number of bounces that 99 % of the rays do not exceed
        let last = roulette.bounces().quantile(0.99)?.clamp(5, 60);
        let mean = roulette.bounces().mean();
        let mut counts = vec![0u32; last as usize + 1];
        let mut rng = Stream::new(seed, 0);
        let mut count = |n: f64| {
            if let Some(count) = counts.get_mut(n as usize) {
                *count += 1;
            }
        };
        // paths that are too long are not simulated
        if mean < 1000.0 {
            let sampler = roulette.bounces().by_simulation()?;
            (0..draws).for_each(|_| count(sampler.draw(&mut rng)));
        } else {
            let sampler = roulette.bounces().by_inversion()?;
            (0..draws).for_each(|_| count(sampler.draw(&mut rng)));
        }
        let n = draws.max(1) as f64;
        let measured: Vec<_> = (0..=last)
            .zip(counts)
            .map(|(k, count)| {
                let share = f64::from(count) / n;
                let reach = 1.96 * (share * (1.0 - share) / n).sqrt();
                [k as f64, share, share - reach, share + reach]
            })
            .collect();
        let tallest = measured.iter().fold(1.0 - p, |tallest, [.., high]| tallest.max(*high / 1.1));
        let every = (last / 6).max(1) as usize;
        let ticks = (0..=last).step_by(every).map(|k| (k as f64, k.to_string()));
        let mut panel = Panel::new(
            &format!("p_rr = {}", typeset(p, 12)),
            Axis::linear("number of bounces k", -0.7, last as f64 + 0.7).with_ticks(ticks),
            Axis::linear("P(N = k)", 0.0, 1.15 * tallest),
        );
        panel
            .bars("exact", Ink::Blue, 0.8, (0..=last).map(|k| [k as f64, roulette.bounces().pmf(k)]))
            .error_bars("measured", Ink::Black, Marker::Disc, measured)
            .text(Ink::Blue, [last as f64, 1.02 * tallest], Side::Left, "bars: pᵏ(1 − p)")
            .text(
                Ink::Black,
                [last as f64, 0.9 * tallest],
                Side::Left,
                &format!("points: {draws} rays, 95 %"),
            )
            .text(
                Ink::Black,
                [last as f64, 0.78 * tallest],
                Side::Left,
                &format!("E[N] {}", equals(mean, 6)),
            );
        panels.push(panel);
    }
    let [a, b] = p_rr.map(|p| typeset(p, 12));
    Plot {
        name: "5_1_bounces",
        title: format!("The number of bounces at p_rr = {a} and {b}"),
        description: format!(
            "Two bar charts of P(N = k) = pᵏ(1 − p), for p = {a} and p = {b}, falling geometrically; points \
             with 95 % intervals are the shares of {draws} simulated rays (seed {seed})."
        ),
        edition: Edition::Solution,
        width: Width::Page,
        height_mm: 62.0,
        columns: 2,
        panels,
    }
    .draw()
}

/// Figure for 5.3: E\[N\] and its standard deviation against p_rr.
///
/// # Errors
/// If it cannot be drawn.
pub fn mean_bounces(draws: u64, seed: u64) -> Result<Figure> {
    let of = |p: f64| {
        Roulette::new(p).map(|roulette| (roulette.bounces().mean(), roulette.bounces().variance().sqrt()))
    };
    let mut measured = Vec::new();
    for p in [0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9] {
        let found = estimate(&Roulette::new(p)?.bounces().by_inversion()?, Budget::Draws(draws), seed)?;
        measured.push([p, found.mean()]);
    }
    let curve = (1..=990).map(|i| f64::from(i) / 1000.0);
    let band = curve.filter_map(|p| {
        of(p).ok().map(|(mean, deviation)| [p, (mean - deviation).max(0.0), mean + deviation])
    });
    let mut panel = Panel::new(
        "E[N] ± one standard deviation",
        Axis::linear("continuation probability p_rr", 0.0, 1.0),
        Axis::linear("number of bounces", 0.0, 20.0),
    );
    panel
        .band("± standard deviation", Ink::Blue, band)
        .curve_between("E[N]", Ink::Blue, 0.001, 0.96, |p| of(p).map_or(f64::NAN, |(mean, _)| mean))
        .marks("measured", Ink::Black, Marker::Disc, measured)
        .text(Ink::Blue, [0.03, 18.0], Side::Right, "E[N] = p/(1 − p)")
        .text(Ink::Blue, [0.03, 15.8], Side::Right, "band: ±√p/(1 − p)")
        .text(Ink::Black, [0.2, 2.2], Side::Above, "1/5: ¼")
        .text(Ink::Black, [0.79, 4.6], Side::Left, "4/5: 4");
    Plot {
        name: "5_3_mean_bounces",
        title: "E[N] grows with p_rr, without bound".into(),
        description: format!(
            "E[N] = p/(1 − p) against p, rising from 0 slowly and then steeply towards p = 1, in a band of \
             one standard deviation √p/(1 − p) to both sides. Points: means of {draws} draws (seed {seed})."
        ),
        edition: Edition::Solution,
        width: Width::Column,
        height_mm: 62.0,
        columns: 1,
        panels: vec![panel],
    }
    .draw()
}

/// Figure for 5.3: variance, cost and their product against the continuation probability q. The range q ≤ ρ²,
/// where the variance is infinite, is shaded.
///
/// # Errors
/// If it cannot be drawn.
pub fn roulette_trade(model: &LightModel, q: f64) -> Result<Figure> {
    let (albedo, best) = (model.albedo(), model.optimum());
    let edge = albedo * albedo;
    let paths = |q: f64| model.roulette(q);
    let variance = |q: f64| paths(q).map_or(f64::NAN, |paths| paths.variance());
    let cost = |q: f64| paths(q).map_or(f64::NAN, |paths| paths.cost());
    let product = |q: f64| variance(q) * cost(q);
    let low = (edge - 0.25).max(0.0);
    // where all three are finite, without the ends, where they grow without bound
    let values: Vec<f64> = (4..98)
        .map(|percent| edge + 0.01 * f64::from(percent) * (1.0 - edge))
        .flat_map(|q| [variance(q), cost(q), product(q)])
        .filter(|value| value.is_finite() && *value > 0.0)
        .collect();
    let least = values.iter().copied().fold(f64::INFINITY, f64::min).min(1.0);
    let most = values.iter().copied().fold(4.0, f64::max);
    // room below for the text about the marks
    let bottom = least * (least / most).powf(0.2);
    let (albedo, v) = (typeset(albedo, 12), typeset(model.visibility(), 12));
    let mut panel = Panel::new(
        &format!("ρ = {albedo}, v = {v}"),
        Axis::linear("continuation probability q", low, 1.0),
        Axis::log("value (dimensionless)", bottom, 2.0 * most),
    );
    panel.shade(low, edge);
    // the labels stand above and below their lines, in rows of their own
    let row = |panel: &Panel, value: f64| panel.y.place(value).clamp(0.25, 0.95);
    let mut rows = [row(&panel, 2.0 * cost(low + 0.1)), row(&panel, 0.55 * variance(0.93))];
    if let [costs, varies] = &mut rows
        && (*costs - *varies).abs() < 0.09
    {
        *varies = if *costs > 0.5 { *costs - 0.09 } else { *costs + 0.09 };
    }
    let [costs_at, varies_at] = rows.map(|row| panel.y.value(row));
    let shaded = 0.5 * (edge - low) / (1.0 - low);
    panel
        .curve_between("variance", Ink::Blue, edge + 1e-6, 0.9995, variance)
        .curve_between("cost", Ink::Vermilion, low, 0.9995, cost)
        .curve_between("variance × cost", Ink::Green, edge + 1e-6, 0.9995, product)
        .note(Ink::Black, [shaded.max(0.12), 0.83], Side::Centre, "q ≤ ρ²:")
        .note(Ink::Black, [shaded.max(0.12), 0.74], Side::Centre, "infinite")
        .note(Ink::Black, [shaded.max(0.12), 0.65], Side::Centre, "variance")
        .text(Ink::Vermilion, [low + 0.02, costs_at], Side::Right, "cost 1/(1 − q)")
        .text(Ink::Blue, [0.98, varies_at], Side::Left, "variance")
        .text(Ink::Green, [edge + 0.06, 300.0], Side::Right, "variance × cost");
    let mut marked = vec![(q, "● q", Marker::Disc, 0.14)];
    if best > 0.0 && best < 1.0 {
        marked.push((best, "○ q*", Marker::Ring, 0.05));
    }
    for (at, word, marker, row) in marked {
        if product(at).is_finite() {
            panel.marks(word, Ink::Black, marker, [[at, product(at)]]);
            let label = format!("{word} {}: {}", equals(at, 3), typeset(product(at), 3));
            panel.note(Ink::Black, [0.0, row], Side::Right, &label);
        }
    }
    Plot {
        name: "5_3_roulette_trade",
        title: format!("What roulette costs and buys: the product is least at q* {}", equals(best, 3)),
        description: format!(
            "Variance, cost 1/(1 − q) and their product against q, logarithmic, for ρ = {albedo} and v = \
             {v}. The variance is infinite up to q = ρ² {}, shaded, and falls; the cost rises; the \
             product is least at q* {}. Marked: q = {} and q*.",
            equals(edge, 4),
            equals(best, 4),
            typeset(q, 12)
        ),
        edition: Edition::Solution,
        width: Width::Column,
        height_mm: 68.0,
        columns: 1,
        panels: vec![panel],
    }
    .draw()
}

/// Figure for 5.3: RMSE against the number of vertices, for roulette and for paths truncated after k ≤
/// `max_k` and k ≤ 2 `max_k`.
///
/// # Errors
/// If q is not in (0, 1), or `max_k` is too large.
pub fn truncation(model: &LightModel, q: f64, max_k: u64, replicates: u64, seed: u64) -> Result<Figure> {
    let [short, long] = [max_k, max_k.saturating_mul(2)];
    let roulette = model.roulette(q)?;
    let root = |square: Result<f64>| square.map_or(f64::NAN, f64::sqrt);
    // at least two paths
    let first = 10f64.powf(((2.0 * roulette.cost()).log10() - 1e-9).ceil().max(1.0));
    let last = 1e4 * first;
    let errors = [root(roulette.mean_square_error(first)), root(roulette.mean_square_error(last))];
    let biases = [model.truncated(short)?.bias().abs(), model.truncated(long)?.bias().abs()];
    let sizes = || errors.into_iter().chain(biases).filter(|size| size.is_finite() && *size > 0.0);
    let most = sizes().fold(0.0, f64::max);
    let least = sizes().fold(f64::INFINITY, f64::min).max(1e-6 * most);
    let (least, most) = if most > 0.0 { (least, most) } else { (0.1, 1.0) };
    let [albedo, v, kept] = [model.albedo(), model.visibility(), q].map(|value| typeset(value, 12));
    let mut panel = Panel::new(
        &format!("ρ = {albedo}, v = {v}, q = {kept}"),
        Axis::log("vertices C", first, last),
        Axis::log("RMSE (units of the light)", 0.6 * least, 2.0 * most),
    );
    panel.curve("roulette", Ink::Blue, |c| root(roulette.mean_square_error(c)));
    let early = 6.0 * first;
    panel.text(Ink::Blue, [early, 1.7 * root(roulette.mean_square_error(early))], Side::Right, "roulette");
    for (max_k, ink) in [(short, Ink::Vermilion), (long, Ink::Green)] {
        let truncated = model.truncated(max_k)?;
        panel.curve(&format!("k ≤ {max_k}"), ink, |c| root(truncated.mean_square_error(c)));
        let plateau = truncated.bias().abs();
        let (at, side) = if max_k == short {
            ([0.9 * last, 1.22 * plateau], Side::Left)
        } else {
            ([1.1 * first, plateau], Side::Right)
        };
        panel.text(ink, at, side, &format!("k ≤ {max_k}: bias {}", typeset(plateau, 3)));
        let crossing = model.crossing(q, max_k)?;
        if (first..last).contains(&crossing) {
            let at = [crossing, root(roulette.mean_square_error(crossing))];
            panel.marks("crossing", Ink::Black, Marker::Ring, [at]);
            panel.text(
                Ink::Black,
                [1.2 * crossing, 1.45 * at[1]],
                Side::Right,
                &format!("C = {}", typeset(crossing, 4)),
            );
        }
    }
    // each point: the RMSE of `replicates` means of as many paths as take about C vertices
    for (ink, marker, estimator, cost) in [
        (Ink::Blue, Marker::Disc, Box::new(roulette) as Box<dyn Estimator>, roulette.cost()),
        (Ink::Vermilion, Marker::Square, Box::new(model.truncated(short)?), model.truncated(short)?.cost()),
        (Ink::Green, Marker::Triangle, Box::new(model.truncated(long)?), model.truncated(long)?.cost()),
    ] {
        let mut points = Vec::new();
        for vertices in [2.0, 20.0, 200.0, 2000.0].map(|part| part * first) {
            // leave out points that would take too long
            if vertices * replicates as f64 > 2e7 {
                continue;
            }
            let paths = (vertices / cost).round().max(1.0) as u64;
            let mut square = 0.0;
            for replicate in 0..replicates {
                let found = estimate(&estimator, Budget::Draws(paths), seed.wrapping_add(replicate))?;
                square += (found.mean() - model.mean()).powi(2) / replicates as f64;
            }
            points.push([paths as f64 * cost, square.sqrt()]);
        }
        panel.marks("measured", ink, marker, points);
    }
    Plot {
        name: "5_3_truncation",
        title: "Truncated paths stop improving; roulette overtakes them".into(),
        description: format!(
            "Root mean square error against the number of vertices C, both logarithmic, for ρ = {albedo}, v \
             = {v}. Roulette with q = {kept} falls as 1/√C. Paths cut after k ≤ {short} and k ≤ {long} level \
             off at \
             their bias; the crossings are marked. Points: {replicates} runs each, seeds from {seed}."
        ),
        edition: Edition::Solution,
        width: Width::Column,
        height_mm: 68.0,
        columns: 1,
        panels: vec![panel],
    }
    .draw()
}
