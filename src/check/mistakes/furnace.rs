//! Mistakes in following light over several bounces, in a furnace: every face emits L and reflects ρ, so that K bounces give Σ ρᵏ L.

use std::f64::consts::PI;

use super::{Attempt, Mistake, Probe, Setup, Words, words};
use crate::stream::Stream;

/// Σ ρᵏ for k ≤ K, or all k; infinite where it diverges.
pub(super) fn sum(ratio: f64, bounces: Option<u32>) -> f64 {
    match bounces {
        Some(bounces) => (0..=bounces).fold(0.0, |sum, _| 1.0 + ratio * sum),
        None if ratio < 1.0 => 1.0 / (1.0 - ratio),
        None => f64::INFINITY,
    }
}

pub(super) fn probes() -> Vec<Probe> {
    [
        (0.6, 2.5, Some(0)),
        (0.6, 2.5, Some(1)),
        (0.6, 2.5, Some(3)),
        (0.35, 0.4, Some(2)),
        (0.25, 2.5, None),
        (0.65, 0.4, None),
    ]
    .into_iter()
    .filter_map(|(albedo, emission, bounces)| Probe::furnace(albedo, emission, bounces).ok())
    .collect()
}

/// The chance of going on where all bounces are asked for.
const GOES_ON: f64 = 0.8;

/// No path is followed further: (4/5)¹⁰⁰⁰ is 1e-97.
const LONGEST: u32 = 1000;

/// A path on the way: the bounces it has made, and what the light it meets is worth at the eye.
struct Vertex {
    bounce: u32,
    throughput: f64,
}

/// Follows a path and adds up what `light` says at each vertex; `next` gives the throughput after one more bounce from the one before and the
/// bounce's weight, whose mean is 1. Where all bounces are asked for roulette ends the path, and is compensated for in the weight.
fn walk(
    bounces: Option<u32>,
    rng: &mut Stream,
    light: impl Fn(&Vertex) -> f64,
    next: impl Fn(f64, f64) -> f64,
) -> f64 {
    let mut vertex = Vertex { bounce: 0, throughput: 1.0 };
    let mut sum = light(&vertex);
    while vertex.bounce < bounces.unwrap_or(LONGEST) {
        let weight = match bounces {
            Some(_) => 2.0 * rng.uniform(), // cos θ of a uniform direction over its mean
            None if rng.uniform() < GOES_ON => 1.0 / GOES_ON,
            None => break,
        };
        vertex = Vertex { bounce: vertex.bounce + 1, throughput: next(vertex.throughput, weight) };
        sum += light(&vertex);
    }
    sum
}

/// A mistake by what light each vertex adds and how the throughput changes there. `random_numbers` is 0: how many there are depends on the probe.
fn path(
    words: Words,
    light: fn(&Vertex, f64, Option<u32>) -> f64,
    next: fn(f64, f64, f64) -> f64,
    expected: fn(f64, Option<u32>) -> f64,
) -> Mistake {
    let wrong = Attempt::furnace(move |albedo, emission, bounces, rng| {
        let light = |vertex: &Vertex| emission * light(vertex, albedo, bounces);
        walk(bounces, rng, light, |throughput, weight| next(throughput, albedo, weight))
    });
    of_expected(words, wrong, move |albedo, emission, bounces| emission * expected(albedo, bounces))
}

fn of_expected(
    words: Words,
    wrong: Attempt<'static>,
    expected: impl Fn(f64, f64, Option<u32>) -> f64 + Send + Sync + 'static,
) -> Mistake {
    Mistake::new(words, 0, wrong, move |setup| match *setup {
        Setup::Furnace { albedo, emission, bounces } => expected(albedo, emission, bounces),
        _ => f64::NAN,
    })
}

/// The number of bounces changed.
fn length(
    words: Words,
    change: fn(Option<u32>) -> Option<u32>,
    expected: fn(f64, Option<u32>) -> f64,
) -> Mistake {
    let wrong = Attempt::furnace(move |albedo, emission, bounces, rng| match (bounces, change(bounces)) {
        (Some(0), None) => 0.0,
        (_, changed) => walk(changed, rng, |vertex| emission * vertex.throughput, |t, w| t * albedo * w),
    });
    of_expected(words, wrong, move |albedo, emission, bounces| emission * expected(albedo, bounces))
}

pub(super) fn mistakes() -> Vec<Mistake> {
    let count = "K bounces: the light of vertices 0, 1, …, K";
    let every = "every vertex emits: add its L times the throughput so far";
    let order = "add the emission first, then multiply the throughput by f_r cos θ/p";
    let weight = "a bounce multiplies by f_r cos θ/p, whose mean is ρ";
    let roulette = "divide the throughput by p_rr once where roulette goes on";
    let by_throughput = |vertex: &Vertex, _: f64, _: Option<u32>| vertex.throughput;
    let right = |throughput: f64, albedo: f64, weight: f64| throughput * albedo * weight;
    vec![
        length(
            words("4.2", "one bounce too many", "Σ to K + 1", count),
            |bounces| bounces.map(|k| k + 1),
            |albedo, bounces| sum(albedo, bounces.map(|k| k + 1)),
        ),
        length(
            words("4.2", "one bounce too few", "Σ to K − 1", count),
            |bounces| bounces?.checked_sub(1),
            |albedo, bounces| match bounces {
                Some(0) => 0.0,
                _ => sum(albedo, bounces.map(|k| k.saturating_sub(1))),
            },
        ),
        length(
            words(
                "5",
                "stops at ten bounces",
                "Σ to min(K, 10)",
                "end paths by roulette: a cap loses what comes after",
            ),
            |bounces| Some(bounces.unwrap_or(10).min(10)),
            |albedo, bounces| sum(albedo, Some(bounces.unwrap_or(10).min(10))),
        ),
        length(
            words(
                "5",
                "stops at five bounces",
                "Σ to min(K, 5)",
                "end paths by roulette: a cap loses what comes after",
            ),
            |bounces| Some(bounces.unwrap_or(5).min(5)),
            |albedo, bounces| sum(albedo, Some(bounces.unwrap_or(5).min(5))),
        ),
        path(
            words("4.3", "the first emission skipped", "Σ from 1", every),
            |vertex, _, _| if vertex.bounce == 0 { 0.0 } else { vertex.throughput },
            right,
            |albedo, bounces| {
                albedo
                    * bounces.map_or_else(
                        || sum(albedo, None),
                        |k| if k == 0 { 0.0 } else { sum(albedo, Some(k - 1)) },
                    )
            },
        ),
        path(
            words("4.3", "only the last vertex counted", "ρᴷ L", every),
            |vertex, _, bounces| if Some(vertex.bounce) == bounces { vertex.throughput } else { 0.0 },
            right,
            |albedo, bounces| bounces.map_or(0.0, |k| albedo.powf(f64::from(k))),
        ),
        path(
            words("4.3", "only the first vertex counted", "L", every),
            |vertex, _, _| if vertex.bounce == 0 { 1.0 } else { 0.0 },
            right,
            |_, _| 1.0,
        ),
        path(
            words("4.3", "the throughput never multiplied", "Σ L", weight),
            |_, _, _| 1.0,
            right,
            |_, bounces| bounces.map_or(1.0 / (1.0 - GOES_ON), |k| f64::from(k) + 1.0),
        ),
        path(
            words(
                "4.3",
                "the throughput replaced, not multiplied",
                "throughput = ρ",
                "multiply the throughput that is there",
            ),
            by_throughput,
            |_, albedo, weight| albedo * weight,
            |albedo, bounces| 1.0 + albedo * bounces.map_or(1.0 / (1.0 - GOES_ON), f64::from),
        ),
        path(
            words("4.3", "the throughput multiplied before the emission is added", "Σ ρᵏ⁺¹ L", order),
            |vertex, albedo, _| albedo * vertex.throughput,
            right,
            |albedo, bounces| albedo * sum(albedo, bounces),
        ),
        path(
            words(
                "4.3",
                "emission counted twice",
                "Σ ρᵏ 2L",
                "light seen directly and by the walk is the same light",
            ),
            |vertex, _, _| 2.0 * vertex.throughput,
            right,
            |albedo, bounces| 2.0 * sum(albedo, bounces),
        ),
        path(
            words(
                "4.3",
                "emission counted twice from the second vertex on",
                "L + Σ 2ρᵏ L",
                "light sampled at a vertex must not be added again where the path hits it",
            ),
            |vertex, _, _| if vertex.bounce == 0 { 1.0 } else { 2.0 * vertex.throughput },
            right,
            |albedo, bounces| 2.0 * sum(albedo, bounces) - 1.0,
        ),
        path(
            words("4.3", "half of each bounce lost", "ρ/2 a bounce", weight),
            by_throughput,
            |t, albedo, weight| 0.5 * t * albedo * weight,
            |albedo, bounces| sum(0.5 * albedo, bounces),
        ),
        path(
            words("4.3", "each bounce doubled", "2ρ a bounce", weight),
            by_throughput,
            |t, albedo, weight| 2.0 * t * albedo * weight,
            |albedo, bounces| sum(2.0 * albedo, bounces),
        ),
        path(
            words("4.3", "1/π of the BRDF forgotten", "πρ a bounce", weight),
            by_throughput,
            |t, albedo, weight| PI * t * albedo * weight,
            |albedo, bounces| sum(PI * albedo, bounces),
        ),
        path(
            words("4.3", "ρ twice a bounce", "ρ² a bounce", weight),
            by_throughput,
            |t, albedo, weight| t * albedo * albedo * weight,
            |albedo, bounces| sum(albedo * albedo, bounces),
        ),
        path(
            words("4.3", "1 − ρ for ρ", "1 − ρ a bounce", "ρ is what is reflected, 1 − ρ what is absorbed"),
            by_throughput,
            |t, albedo, weight| t * (1.0 - albedo) * weight,
            |albedo, bounces| sum(1.0 - albedo, bounces),
        ),
        path(
            words("4.3", "the albedo forgotten", "1 a bounce", weight),
            by_throughput,
            |t, _, weight| t * weight,
            |_, bounces| sum(1.0, bounces),
        ),
        path(
            words("5", "roulette uncompensated", "each bounce with chance 4/5, nothing divided", roulette),
            by_throughput,
            |t, albedo, weight| t * albedo * weight * GOES_ON,
            |albedo, bounces| sum(GOES_ON * albedo, bounces),
        ),
        path(
            words("5", "roulette compensated twice", "ρ/p_rr² a bounce", roulette),
            by_throughput,
            |t, albedo, weight| t * albedo * weight / GOES_ON,
            |albedo, bounces| sum(albedo / GOES_ON, bounces),
        ),
        of_expected(
            words("4.3", "L forgotten", "Σ ρᵏ", "each vertex adds L"),
            Attempt::furnace(|albedo, _, bounces, rng| {
                walk(bounces, rng, |vertex| vertex.throughput, |t, w| t * albedo * w)
            }),
            |albedo, _, bounces| sum(albedo, bounces),
        ),
        of_expected(
            words(
                "4.3",
                "L multiplied into the throughput",
                "Σ (ρL)ᵏ L",
                "the throughput holds surfaces, not lights",
            ),
            Attempt::furnace(|albedo, emission, bounces, rng| {
                walk(bounces, rng, |vertex| emission * vertex.throughput, |t, w| t * albedo * emission * w)
            }),
            |albedo, emission, bounces| emission * sum(albedo * emission, bounces),
        ),
    ]
}
