//! The mistakes themselves.

use std::f64::consts::PI;

use super::super::{Mistake, words};
use super::{GOES_ON, Hidden, RIGHT, Sampled, Seen, Spot, Way, counted, followed, found_only};
use crate::hemisphere::Hemisphere;

/// Everything about a light sample.
fn sampled(name: &'static str, formula: &'static str, fix: &'static str, sample: fn(Seen) -> f64) -> Mistake {
    followed(words("4.3", name, formula, fix), Way { sample: Sampled::As(sample), ..RIGHT })
}

pub(in super::super) fn mistakes() -> Vec<Mistake> {
    let area = "a point of the light has density 1/A: divide by it";
    let turn = "dω = cos θ′ dA/r²: sampling an area takes all three";
    let cosine = "cos θ is the surface's, once for every light sample";
    let n = "divide by all n draws: one that finds nothing adds 0";
    let direction = "a bounce weighs f_r cos θ/p(ω), with the p that ω was drawn from";
    let product = "the throughput is the product of all weights so far";
    let count = "k counts the vertices between light and eye";
    let emits = "every vertex that is asked for adds its L_e times the throughput";
    let chance = "end a path by chance, and divide by the chance of going on";
    vec![
        sampled("the light's area forgotten", "f_r L cos θ cos θ′/r²", area, |s| {
            s.here * s.there / (s.r * s.r)
        }),
        sampled("multiplied by the light's density", "f_r L cos θ cos θ′/(r² A)", area, |s| {
            s.here * s.there / (s.r * s.r * s.area)
        }),
        sampled(
            "the light's half-width for its width",
            "A = w²",
            "A is the square of the width, twice the half-width",
            |s| 0.25 * s.area * s.here * s.there / (s.r * s.r),
        ),
        sampled("the light's cosine forgotten", "f_r L cos θ A/r²", turn, |s| {
            s.here * s.area / (s.r * s.r)
        }),
        sampled("r for r²", "f_r L cos θ cos θ′ A/r", turn, |s| s.here * s.there * s.area / s.r),
        sampled("r² forgotten", "f_r L cos θ cos θ′ A", turn, |s| s.here * s.there * s.area),
        sampled("the surface's cosine forgotten at the light sample", "f_r L cos θ′ A/r²", cosine, |s| {
            s.there * s.area / (s.r * s.r)
        }),
        sampled(
            "the surface's cosine twice at the light sample",
            "f_r L cos² θ cos θ′ A/r²",
            cosine,
            |s| s.here * s.here * s.there * s.area / (s.r * s.r),
        ),
        followed(
            words(
                "4.3",
                "the light's middle for every sample",
                "y = (0, 0, 4)",
                "draw a point of the light for every path",
            ),
            Way { spot: Spot::Middle, ..RIGHT },
        ),
        followed(
            words(
                "4.3",
                "the same random numbers for light and directions",
                "one (U, V) a path",
                "directions and light samples take numbers of their own",
            ),
            Way { spot: Spot::Reused, ..RIGHT },
        ),
        followed(
            words("4.3", "occlusion ignored", "V = 1", "a light sample that the cube hides adds 0"),
            Way { hidden: Hidden::Lit, ..RIGHT },
        ),
        followed(
            words("4.3", "hidden light samples left out of n", "divided by the visible ones", n),
            Way { hidden: Hidden::Redrawn, ..RIGHT },
        ),
        found_only(words("4.3", "rays without light left out of n", "divided by those that found it", n)),
        followed(
            words(
                "4.3",
                "the light found by chance and sampled",
                "both added",
                "where the light is sampled, a ray that happens on it adds nothing",
            ),
            Way { chance: true, ..RIGHT },
        ),
        followed(
            words(
                "4.3",
                "1/π of the BRDF forgotten at the light sample",
                "ρ L cos θ cos θ′ A/r²",
                "f_r = ρ/π",
            ),
            Way { last: |albedo, _| PI * albedo, ..RIGHT },
        ),
        followed(
            words("4.3", "1/π of the BRDF forgotten at every bounce", "f_r = ρ", "f_r = ρ/π"),
            Way {
                last: |albedo, _| PI * albedo,
                carried: |throughput, albedo, _| throughput * albedo * PI,
                ..RIGHT
            },
        ),
        followed(
            words(
                "4.3",
                "the last vertex's albedo forgotten",
                "L cos θ cos θ′ A/(π r²)",
                "the vertex that the light falls on reflects ρ of it, too",
            ),
            Way { last: |_, _| 1.0, ..RIGHT },
        ),
        followed(
            words(
                "4.3",
                "p's albedo at every vertex",
                "ρ(p)ᵏ",
                "take each vertex's own albedo: a wall's, or the cube's",
            ),
            Way { last: |_, of_p| of_p, carried: |throughput, _, of_p| throughput * of_p, ..RIGHT },
        ),
        followed(
            words("4.3", "the throughput never multiplied", "Σ L_e", product),
            Way { carried: |throughput, _, _| throughput, ..RIGHT },
        ),
        followed(
            words("4.3", "the throughput replaced, not multiplied", "throughput = ρ", product),
            Way { carried: |_, albedo, _| albedo, ..RIGHT },
        ),
        followed(
            words(
                "4.3",
                "a mirror bounce for a diffuse one",
                "ω = reflected ray at p_j",
                "a diffuse surface sends light everywhere: draw ω anew at every vertex",
            ),
            Way { sample: Sampled::Never, chance: true, mirror: true, ..RIGHT },
        ),
        followed(
            words("4.3", "cos θ forgotten, uniform directions", "f_r 2π a bounce", direction),
            Way { directions: Hemisphere::Uniform, weight: |_| 2.0, ..RIGHT },
        ),
        followed(
            words("4.3", "uniform directions, the cosine weight", "ρ a bounce", direction),
            Way { directions: Hemisphere::Uniform, ..RIGHT },
        ),
        followed(
            words("4.3", "cosine directions, the uniform weight", "2ρ cos θ a bounce", direction),
            Way { weight: |cos| 2.0 * cos, ..RIGHT },
        ),
        followed(
            words("4.3", "cosine directions, cos θ kept", "ρ cos θ a bounce", direction),
            Way { weight: |cos| cos, ..RIGHT },
        ),
        counted(words("4.2", "one bounce too many", "k + 1", count), |[first, last]| {
            if first == last { [last + 1, last + 1] } else { [first, last + 1] }
        }),
        counted(words("4.2", "one bounce too few", "k − 1", count), |[first, last]| {
            let last = last.saturating_sub(1);
            [first.min(last), last]
        }),
        counted(
            words("4.2", "all bounces up to k where exactly k are asked for", "Σ to k", count),
            |[_, last]| [0, last],
        ),
        counted(words("4.3", "the first emission skipped", "Σ from 1", emits), |[first, last]| {
            [first.max(1), last]
        }),
        counted(words("4.3", "only the last vertex's light counted", "L_K alone", emits), |[_, last]| {
            [last, last]
        }),
        followed(
            words("5", "stops where the throughput is small", "ends below 0.3, no compensation", chance),
            Way { cutoff: 0.3, ..RIGHT },
        ),
        followed(
            words("5", "roulette uncompensated", "goes on with chance 4/5, nothing divided", chance),
            Way { coin: Some(1.0), ..RIGHT },
        ),
        followed(
            words(
                "5",
                "roulette compensated twice",
                "ρ/q² a bounce",
                "divide by q once, where the coin falls",
            ),
            Way { coin: Some(1.0 / (GOES_ON * GOES_ON)), ..RIGHT },
        ),
    ]
}
