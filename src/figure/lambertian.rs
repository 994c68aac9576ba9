//! Figures of section 3.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use rand::distr::Distribution;

use super::plot::{Axis, Ink, Marker, Panel, Plot, Side, Width};
use super::{Edition, Figure};
use crate::error::Result;
use crate::hemisphere::Hemisphere::{self, Cosine, Uniform};
use crate::lambertian::{CosinePower, Lambertian, Light, RingLight};
use crate::run::{Budget, estimate};
use crate::stream::Stream;

/// 3.2: the integrand cos θ sin θ with its area ½, and what is integrated when a factor is forgotten.
///
/// # Errors
/// If it cannot be drawn.
pub fn integrand() -> Result<Figure> {
    let ticks = [(0.0, "0"), (FRAC_PI_4, "π/4"), (FRAC_PI_2, "π/2")];
    let mut panel = Panel::new(
        "What is integrated over θ",
        Axis::linear("θ (radians)", 0.0, FRAC_PI_2).with_ticks(ticks),
        Axis::linear("integrand (dimensionless)", 0.0, 1.0),
    );
    let filled = (0..=120).map(|i| FRAC_PI_2 * f64::from(i) / 120.0).map(|t| [t, 0.0, t.cos() * t.sin()]);
    panel
        .band("area of cos θ sin θ", Ink::Blue, filled)
        .curve("cos θ sin θ", Ink::Blue, |t| t.cos() * t.sin())
        .curve("cos θ", Ink::Vermilion, f64::cos)
        .curve("sin θ", Ink::Green, f64::sin)
        .text(Ink::Blue, [FRAC_PI_4, 0.28], Side::Centre, "cos θ sin θ: area ½")
        .text(Ink::Vermilion, [0.03, 0.76], Side::Right, "cos θ: area 1")
        .text(Ink::Vermilion, [0.03, 0.67], Side::Right, "(sin θ forgotten)")
        .text(Ink::Green, [1.54, 0.76], Side::Left, "sin θ: area 1")
        .text(Ink::Green, [1.54, 0.67], Side::Left, "(cos θ forgotten)");
    Plot {
        name: "3_2_integrand",
        title: "cos θ sin θ has area ½; with a factor forgotten the area is 1".into(),
        description: "Three curves over θ from 0 to π/2: cos θ sin θ, filled, with area ½; cos θ, which is left when sin θ of the solid \
                      angle is forgotten, and sin θ, which is left when cos θ is, each with area 1."
            .into(),
        edition: Edition::Solution,
        width: Width::Column,
        height_mm: 62.0,
        columns: 1,
        panels: vec![panel],
    }
    .draw()
}

/// 3.4 and 3.5: sampled directions from above and from the side.
///
/// # Errors
/// If it cannot be drawn.
pub fn directions(hemisphere: Hemisphere, count: usize, seed: u64) -> Result<Figure> {
    let (name, word, ink, rule) = match hemisphere {
        Uniform => ("3_4_directions", "uniform", Ink::Blue, "cos θ = 1 − U"),
        Cosine => ("3_5_directions", "cosine-weighted", Ink::Vermilion, "cos θ = √(1 − U)"),
    };
    let mut rng = Stream::new(seed, 0);
    let vectors: Vec<_> = (0..count).map(|_| hemisphere.sample(&mut rng).vector()).collect();
    let ticks = || [(-1.0, "−1"), (0.0, "0"), (1.0, "1")];
    let across = |name: &str| Axis::linear(name, -1.6, 1.6).with_ticks(ticks());
    let arc = |from: f64, to: f64| {
        (0..=120).map(move |i| from + (to - from) * f64::from(i) / 120.0).map(|t| [t.cos(), t.sin()])
    };

    let mut top = Panel::new(
        "From above",
        across("x (dimensionless)"),
        Axis::linear("y (dimensionless)", -1.0, 1.0).with_ticks(ticks()),
    );
    top.line("horizon", Ink::Grey, arc(0.0, TAU));
    top.marks(word, ink, Marker::Dot, vectors.iter().map(|v| [v.x, v.y]));

    let mut side = Panel::new(
        "From the side",
        across("x (dimensionless)"),
        Axis::linear("z (dimensionless)", -0.5, 1.5).with_ticks([(0.0, "0"), (1.0, "1")]),
    );
    side.line("hemisphere", Ink::Grey, arc(0.0, TAU / 2.0));
    side.line("surface", Ink::Black, [[-1.6, 0.0], [1.6, 0.0]]);
    side.marks(word, ink, Marker::Dot, vectors.iter().map(|v| [v.x, v.z]));
    side.arrow(Ink::Black, [0.0, 1.0], [0.0, 1.4]);
    side.text(Ink::Black, [0.03, 1.3], Side::Right, "normal");
    side.text(Ink::Black, [0.0, -0.25], Side::Centre, &format!("{rule}, φ = 2πV"));
    Plot {
        name,
        title: format!("{count} {word} directions, from above and from the side"),
        description: format!(
            "{count} points on the unit hemisphere drawn with {rule} and φ = 2πV (seed {seed}), seen from above, inside the circle of the horizon, \
             and from the side, above the surface. {}",
            match hemisphere {
                Uniform => "From the side they fill all heights alike; from above they crowd towards the rim.",
                Cosine => "From above they fill the disc evenly; few are near the horizon.",
            }
        ),
        edition: Edition::Solution,
        width: Width::Page,
        height_mm: 62.2,
        columns: 2,
        panels: vec![top, side],
    }
    .draw()
}

/// f/p of a white surface under a uniform light of radiance 1, against θ: what varies from draw to draw.
fn reason() -> Panel {
    let ticks = [(0.0, "0"), (FRAC_PI_4, "π/4"), (FRAC_PI_2, "π/2")];
    let mut panel = Panel::new(
        "Why, for the uniform light (a = 0)",
        Axis::linear("θ (radians)", 0.0, FRAC_PI_2).with_ticks(ticks),
        Axis::linear("f/p (W m⁻² sr⁻¹)", 0.0, 2.2),
    );
    panel
        .curve("uniform: f/p = 2 cos θ", Ink::Blue, |t| 2.0 * t.cos())
        .level("cosine: f/p = 1", Ink::Vermilion, 1.0)
        .note(Ink::Blue, [0.42, 0.88], Side::Right, "uniform directions: 2 cos θ,")
        .note(Ink::Blue, [0.42, 0.79], Side::Right, "varies from draw to draw")
        .note(Ink::Vermilion, [0.02, 0.35], Side::Right, "cosine directions: 1,")
        .note(Ink::Vermilion, [0.02, 0.26], Side::Right, "the mean itself in every draw")
        .note(Ink::Vermilion, [0.02, 0.17], Side::Right, "p is proportional to f");
    panel
}

/// 3.6: f/p against θ for both densities, which is the reason, and the variance of both against the exponent a of
/// the light cos^a θ, exact and measured.
///
/// # Errors
/// If it cannot be drawn.
pub fn variance_against_exponent(draws: u64, seed: u64) -> Result<Figure> {
    let white = Lambertian::new(1.0)?;
    let exact =
        |hemisphere, a| CosinePower::new(a).map_or(f64::NAN, |light| light.variance(white, hemisphere));
    let measured = |hemisphere, exponents: &[f64]| -> Result<Vec<[f64; 2]>> {
        let of = |&a: &f64| {
            let light = CosinePower::new(a)?;
            let estimator = white.estimator(move |w| light.incoming(w), hemisphere);
            let found = estimate(&estimator, Budget::Draws(draws), seed)?;
            Ok([a, found.variance().unwrap_or(f64::NAN)])
        };
        exponents.iter().map(of).collect()
    };
    let mut panel = Panel::new(
        "Light cosᵃ θ, ρ = 1",
        Axis::linear("exponent a (dimensionless)", -1.5, 4.0).with_ticks(
            [-1.0, -0.5, 0.0, 1.0, 2.0, 3.0, 4.0]
                .map(|a| (a, if a == -0.5 { "−½".to_owned() } else { format!("{a}").replace('-', "−") })),
        ),
        Axis::linear("variance of a draw", 0.0, 0.6),
    );
    panel
        .curve_between("uniform", Ink::Blue, -1.4999, 4.0, |a| exact(Uniform, a))
        .curve_between("cosine", Ink::Vermilion, -0.9999, 4.0, |a| exact(Cosine, a))
        .marks(
            "uniform, measured",
            Ink::Blue,
            Marker::Disc,
            measured(Uniform, &[-1.0, -0.75, 0.5, 1.0, 2.0, 3.0])?,
        )
        .marks(
            "cosine, measured",
            Ink::Vermilion,
            Marker::Square,
            measured(Cosine, &[-0.25, 0.5, 1.0, 2.0, 3.0])?,
        )
        .marks("equal", Ink::Black, Marker::Ring, [[-0.5, 2.0 / 9.0]])
        .marks("at a = 0 and −1", Ink::Black, Marker::Ring, [[0.0, 1.0 / 3.0], [0.0, 0.0], [-1.0, 0.0]])
        .text(Ink::Black, [-0.45, 0.215], Side::Right, "equal, 2/9")
        .text(Ink::Black, [0.02, 0.375], Side::Left, "1/3")
        .text(Ink::Black, [0.02, 0.12], Side::Right, "cosine: 0")
        .text(Ink::Blue, [2.3, 0.4], Side::Centre, "uniform")
        .text(Ink::Vermilion, [2.5, 0.045], Side::Centre, "cosine")
        .text(Ink::Vermilion, [-0.6, 0.56], Side::Right, "cosine: ∞ as a → −1");
    Plot {
        name: "3_6_variance",
        title: "Cosine-weighted directions win for a > −½, uniform ones below".into(),
        description: format!(
            "Left: f/p against θ under a uniform light; 2 cos θ for uniform directions, 1 everywhere for cosine-weighted ones, whose p is proportional to f. Right: variance of one draw against the exponent a of the light cos^a θ. Uniform: 0 at a = −1, 1/3 at a = 0. Cosine: infinite as a → −1, 0 at a = 0. Both are 2/9 at \
             a = −½. Points: variances of {draws} draws, seed {seed}."
        ),
        edition: Edition::Solution,
        width: Width::Page,
        height_mm: 66.0,
        columns: 2,
        panels: vec![reason(), panel],
    }
    .draw()
}

/// 3.6: cosine's variance over the uniform one against the width of a ring of light along the horizon.
///
/// # Errors
/// If it cannot be drawn.
pub fn variance_against_ring(draws: u64, seed: u64) -> Result<Figure> {
    let white = Lambertian::new(1.0)?;
    let exact = |width| {
        RingLight::new(width)
            .map_or(f64::NAN, |ring| ring.variance(white, Cosine) / ring.variance(white, Uniform))
    };
    let mut measured = Vec::new();
    for width in [0.02, 0.05, 0.1, 0.2, 0.4, 0.6, 0.75, 0.9] {
        let ring = RingLight::new(width)?;
        let of = |hemisphere| {
            let estimator = white.estimator(move |w| ring.incoming(w), hemisphere);
            Ok(estimate(&estimator, Budget::Draws(draws), seed)?.variance().unwrap_or(f64::NAN))
        };
        measured.push([width, of(Cosine)? / of(Uniform)?]);
    }
    let mut panel = Panel::new(
        "Light only where cos θ < ε",
        Axis::linear("width ε of the ring (dimensionless)", 0.0, 1.0)
            .with_ticks([0.0, 0.25, 0.5, 0.75, 1.0].map(|w| (w, format!("{w}")))),
        Axis::log("Var cosine / Var uniform", 0.05, 100.0),
    );
    panel
        .level("equal", Ink::Grey, 1.0)
        .curve_between("ratio", Ink::Vermilion, 0.008, 0.999, exact)
        .marks("measured", Ink::Vermilion, Marker::Square, measured)
        .marks("crossing", Ink::Black, Marker::Ring, [[0.75, 1.0], [0.1, 297.0 / 37.0]])
        .text(Ink::Black, [0.12, 9.0], Side::Right, "8.03 at ε = 0.1")
        .text(Ink::Black, [0.79, 2.6], Side::Centre, "equal at ε = ¾")
        .text(Ink::Grey, [0.02, 0.72], Side::Right, "above: uniform is better")
        .text(Ink::Grey, [0.02, 0.4], Side::Right, "below: cosine is better");
    Plot {
        name: "3_6_ring",
        title: "Light from near the horizon: cosine-weighted directions lose for ε < ¾".into(),
        description: format!(
            "The ratio of cosine's variance to the uniform one against the width ε of the ring of light cos θ < ε, falling from 8.03 at ε = 0.1 to 1 at \
             ε = ¾ and below. Points: variances of {draws} draws, seed {seed}."
        ),
        edition: Edition::Solution,
        width: Width::Column,
        height_mm: 66.0,
        columns: 1,
        panels: vec![panel],
    }
    .draw()
}
