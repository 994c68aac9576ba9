//! Figures of section 5.

use crate::error::Result;
use crate::estimator::Estimator;
use crate::numbers::{equals, typeset};
use crate::plot::{Axis, Figure, Ink, Marker, Panel, Plot, Side, extent};
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
        // paths that are too long are not simulated
        let sampler: Box<dyn Estimator> = if mean < 1000.0 {
            Box::new(roulette.bounces().by_simulation()?)
        } else {
            Box::new(roulette.bounces().by_inversion()?)
        };
        for _ in 0..draws {
            if let Some(count) = counts.get_mut(sampler.draw(&mut rng) as usize) {
                *count += 1;
            }
        }
        let n = draws.max(1) as f64;
        let measured: Vec<[f64; 4]> = (0..=last)
            .zip(counts)
            .map(|(k, count)| {
                let share = f64::from(count) / n;
                let reach = 1.96 * (share * (1.0 - share) / n).sqrt();
                [k as f64, share, share - reach, share + reach]
            })
            .collect();
        let exact: Vec<_> = (0..=last).map(|k| [k as f64, roulette.bounces().pmf(k)]).collect();
        let heights = exact.iter().copied().chain(measured.iter().map(|&[k, .., high]| [k, high]));
        // the text is on the right, above all of what is there
        let top = heights.map(|[k, high]| if k < 0.3 * last as f64 { 1.1 * high } else { 1.5 * high });
        let top = top.fold(0.0, f64::max);
        let every = (last / 6).max(1) as usize;
        let ticks = (0..=last).step_by(every).map(|k| (k as f64, k.to_string()));
        let mut panel = Panel::new(
            &format!("p_rr = {}", typeset(p, 12)),
            Axis::linear("number of bounces k", -0.7, last as f64 + 0.7).with_ticks(ticks),
            Axis::linear("P(N = k)", 0.0, top),
        );
        panel
            .bars("exact", Ink::Blue, 0.8, exact)
            .error_bars("measured", Ink::Black, Marker::Disc, measured)
            .note(Ink::Blue, [1.0, 0.95], Side::Left, "bars: pᵏ(1 − p)")
            .note(Ink::Black, [1.0, 0.86], Side::Left, &format!("points: {draws} rays, 95 %"))
            .note(Ink::Black, [1.0, 0.77], Side::Left, &format!("E[N] {}", equals(mean, 6)));
        panels.push(panel);
    }
    let [a, b] = p_rr.map(|p| typeset(p, 12));
    Plot::of("5_1_bounces", 62.0, panels).draw(
        format!("The number of bounces at p_rr = {a} and {b}"),
        format!(
            "Two bar charts of P(N = k) = pᵏ(1 − p), for p = {a} and p = {b}, falling geometrically; points \
             with 95 % intervals are the shares of {draws} simulated rays (seed {seed})."
        ),
    )
}

/// 5.3: E\[N\] and its standard deviation against p_rr, with those of two p_rr marked.
///
/// # Errors
/// If a continuation probability is not in (0, 1), or it cannot be drawn.
pub fn mean_bounces(p_rr: [f64; 2], draws: u64, seed: u64) -> Result<Figure> {
    let of = |p: f64| {
        Roulette::new(p).map(|roulette| (roulette.bounces().mean(), roulette.bounces().variance().sqrt()))
    };
    let mut measured = Vec::new();
    for p in [0.1, 0.35, 0.5, 0.65, 0.9].into_iter().chain(p_rr) {
        let found = estimate(&Roulette::new(p)?.bounces().by_inversion()?, Budget::Draws(draws), seed)?;
        measured.push([p, found.mean()]);
    }
    let marked = p_rr.map(|p| of(p).map_or([p, f64::NAN], |(mean, _)| [p, mean]));
    let high = marked.iter().fold(20.0, |high: f64, [_, mean]| high.max(1.4 * mean));
    let curve = (1..=990).map(|i| f64::from(i) / 1000.0);
    let band = curve.filter_map(|p| {
        of(p).ok().map(|(mean, deviation)| [p, (mean - deviation).max(0.0), mean + deviation])
    });
    let mut panel = Panel::new(
        "E[N] ± one standard deviation",
        Axis::linear("continuation probability p_rr", 0.0, 1.0),
        Axis::linear("number of bounces", 0.0, high),
    );
    panel
        .band("± standard deviation", Ink::Blue, band)
        .curve_between("E[N]", Ink::Blue, [0.001, 0.999], |p| of(p).map_or(f64::NAN, |(mean, _)| mean))
        .marks("measured", Ink::Black, Marker::Disc, measured)
        .note(Ink::Blue, [0.0, 0.93], Side::Right, "E[N] = p/(1 − p)")
        .note(Ink::Blue, [0.0, 0.84], Side::Right, "band: ±√p/(1 − p)");
    // one of each
    for [p, mean] in marked.into_iter().skip(usize::from(p_rr[0] == p_rr[1])) {
        panel.label(Ink::Black, [p, mean], &format!("E[N] {} at {}", equals(mean, 3), typeset(p, 3)));
    }
    let [a, b] = p_rr.map(|p| typeset(p, 12));
    Plot::of("5_3_mean_bounces", 62.0, vec![panel]).draw(
        "E[N] grows with p_rr, without bound",
        format!(
            "E[N] = p/(1 − p) against p, rising from 0 slowly and then steeply towards p = 1, in a band of \
             one standard deviation √p/(1 − p) to both sides. Points: means of {draws} draws (seed {seed}); \
             those at {a} and {b} have their E[N] beside them."
        ),
    )
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
    // of the axis at most 0.3 shaded
    let low = (edge - 0.43 * (1.0 - edge)).max(0.0);
    // from where all three are finite to near 1, without the outermost parts, where they grow without bound
    let values = (4..98)
        .map(|percent| edge + 0.01 * f64::from(percent) * (1.0 - edge))
        .flat_map(|q| [variance(q), cost(q), product(q)]);
    let [least, most] = extent(values).map_or([1.0, 4.0], |[least, most]| [least.min(1.0), most.max(4.0)]);
    let (albedo, v) = (typeset(albedo, 12), typeset(model.visibility(), 12));
    let mut panel = Panel::new(
        &format!("ρ {}, v {}", equals(model.albedo(), 4), equals(model.visibility(), 4)),
        Axis::linear("continuation probability q", low, 1.0),
        Axis::log("value (dimensionless)", least * (least / most).powf(0.12), 2.0 * most),
    );
    let mut marked = vec![(q, "q", Marker::Disc)];
    if best > 0.0 && best < 1.0 {
        marked.push((best, "q*", Marker::Ring));
    }
    panel.shade(low, edge);
    for (name, ink, from, of) in [
        ("variance", Ink::Blue, edge + 1e-6, &variance as &dyn Fn(f64) -> f64),
        ("cost 1/(1 − q)", Ink::Vermilion, low, &cost),
        ("variance × cost", Ink::Green, edge + 1e-6, &product),
    ] {
        panel.curve_between(name, ink, [from, 0.9995], of).named(name);
    }
    for (at, word, marker) in marked {
        let value = product(at);
        if value.is_finite() {
            let label = format!("{} {word} {}: {}", marker.sign(), equals(at, 3), typeset(value, 3));
            panel.marks(word, Ink::Black, marker, [[at, value]]).named(&label);
        }
    }
    if edge > 0.0 {
        let middle = panel.y.value(0.8);
        panel.label(Ink::Black, [0.5 * (low + edge), middle], "q ≤ ρ²:\ninfinite\nvariance");
    }
    Plot::of("5_3_roulette_trade", 68.0, vec![panel]).draw(
        format!("Roulette: variance × cost is least at q* {}", equals(best, 3)),
        format!(
            "Variance, cost 1/(1 − q) and their product against q, logarithmic, for ρ = {albedo} and v = \
             {v}. The variance is infinite up to q = ρ² {}, shaded, and falls from there; the cost rises; \
             the product is least at q* {}. Marked: q = {} and q*.",
            equals(edge, 4),
            equals(best, 4),
            typeset(q, 12)
        ),
    )
}

/// Figure for 5.3: RMSE against the number of vertices, for roulette and for paths truncated after k ≤
/// `max_k` and k ≤ 2 `max_k`.
///
/// # Errors
/// If q is not in (0, 1), or `max_k` is too large.
pub fn truncation(model: &LightModel, q: f64, max_k: u64, replicates: u64, seed: u64) -> Result<Figure> {
    let [short, long] = [max_k, max_k.saturating_mul(2)];
    let roulette = model.roulette(q)?;
    let endless = roulette.variance().is_infinite();
    let root = |square: Result<f64>| square.map_or(f64::NAN, f64::sqrt);
    // at least two paths
    let first = 10f64.powf(((2.0 * roulette.cost()).log10() - 1e-9).ceil().max(1.0));
    let last = 1e4 * first;
    let [short_paths, long_paths] = [model.truncated(short)?, model.truncated(long)?];
    let errors = [first, last].map(|c| {
        let [short, long] = [short_paths, long_paths].map(|paths| root(paths.mean_square_error(c)));
        [root(roulette.mean_square_error(c)), short, long]
    });
    let range = extent(errors.into_iter().flatten());
    let exact = range.is_none();
    let [least, most] = range.map_or([0.1, 1.0], |[least, most]| [least.max(1e-6 * most), most]);
    let [albedo, v, kept] = [model.albedo(), model.visibility(), q].map(|value| typeset(value, 12));
    let mut panel = Panel::new(
        &format!("ρ {}, v {}, q {}", equals(model.albedo(), 4), equals(model.visibility(), 4), equals(q, 4)),
        Axis::log("vertices C", first, last),
        Axis::log("RMSE (units of the light)", 0.6 * least, 2.0 * most),
    );
    if exact {
        panel.note(Ink::Black, [0.5, 0.5], Side::Centre, "no error: every path gives the mean");
    }
    panel.curve("roulette", Ink::Blue, |c| root(roulette.mean_square_error(c)));
    panel.named("● roulette");
    for (paths, ink, marker) in
        [(short_paths, Ink::Vermilion, Marker::Square), (long_paths, Ink::Green, Marker::Triangle)]
    {
        let name = format!("k ≤ {}", paths.max_k());
        let label = format!("{} {name}: bias {}", marker.sign(), typeset(paths.bias().abs(), 3));
        panel.curve(&name, ink, |c| root(paths.mean_square_error(c)));
        if root(paths.mean_square_error(first)) >= panel.y.low {
            panel.named(&label);
        } else if !exact {
            let row = if paths == short_paths { 0.14 } else { 0.05 };
            panel.note(ink, [0.0, row], Side::Right, &format!("{label}, below the axis"));
        }
        let crossing = model.crossing(q, paths.max_k())?;
        if (first..last).contains(&crossing) {
            let at = [crossing, root(roulette.mean_square_error(crossing))];
            let label = format!("○ C = {}", typeset(crossing, 4));
            panel.marks("crossing", Ink::Black, Marker::Ring, [at]).named(&label);
        }
    }
    // each point: the RMSE of `replicates` means of as many paths as take about C vertices
    for (ink, marker, estimator, cost) in [
        (Ink::Blue, Marker::Disc, Box::new(roulette) as Box<dyn Estimator>, roulette.cost()),
        (Ink::Vermilion, Marker::Square, Box::new(short_paths), short_paths.cost()),
        (Ink::Green, Marker::Triangle, Box::new(long_paths), long_paths.cost()),
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
        if ink == Ink::Blue && endless {
            panel.named("● roulette: infinite variance");
        }
    }
    Plot::of("5_3_truncation", 68.0, vec![panel]).draw(
        "Truncated paths stop improving; roulette overtakes them",
        format!(
            "Root mean square error against the number of vertices C, both logarithmic, for ρ = {albedo}, v \
             = {v}. Roulette with q = {kept} falls as 1/√C. Paths cut after k ≤ {short} and k ≤ {long} level \
             off at their bias; the crossings are marked. Points: {replicates} runs each, seeds from \
             {seed}."
        ),
    )
}
