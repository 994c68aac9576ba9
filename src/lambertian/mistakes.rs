//! Mistakes in estimating the radiance that a diffuse surface reflects.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI, TAU};
use std::fmt;
use std::sync::LazyLock;

use super::Lambertian;
use crate::check::{About, Exercise, Given, Listed, Problem};
use crate::error::Result;
use crate::lambertian::hemisphere::Direction;
use crate::stream::Stream;

/// The problem of estimating the radiance L_r that a surface reflects. A draw is f_r L_i cos θ/p, or any
/// other whose mean is L_r.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflection {
    /// The albedo ρ.
    pub albedo: f64,
    /// The incoming radiance.
    pub sky: Sky,
}

/// Incoming radiance as a function of direction, 0 below the horizon. The different ones tell apart mistakes
/// that look the same under a constant one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sky {
    /// L_i = 1, a furnace test: many mistakes pass it.
    Even,
    /// L_i = cos θ
    Cosine,
    /// L_i = cos² θ
    CosineSquared,
    /// L_i = 2 where φ < π: reveals azimuths that are not uniform.
    HalfLit,
    /// L_i = 4 where cos² θ > ½ and φ < π: a lobe off the axis, which reveals whether θ and φ are
    /// independent.
    Lobe,
    /// L_i = 16 where cos θ < ¼: grazing incidence, where cosine directions are rare.
    Grazing,
}

impl Sky {
    /// Its name for programs, and its name for people.
    fn names(self) -> [&'static str; 2] {
        match self {
            Self::Even => ["one", "1"],
            Self::Cosine => ["cos", "cos θ"],
            Self::CosineSquared => ["cos2", "cos² θ"],
            Self::HalfLit => ["half", "2 in half the sky"],
            Self::Lobe => ["lobe", "4 in a lobe"],
            Self::Grazing => ["grazing", "16 at grazing angles"],
        }
    }
}

impl Reflection {
    /// L_i from this direction.
    pub fn light(&self, direction: &Direction) -> f64 {
        let cos = direction.cos_theta();
        let lit = |yes: bool, radiance: f64| if yes { radiance } else { 0.0 };
        let half = direction.vector().y >= 0.0; // φ < π
        match self.sky {
            _ if cos < 0.0 => 0.0,
            Sky::Even => 1.0,
            Sky::Cosine => cos,
            Sky::CosineSquared => cos * cos,
            Sky::HalfLit => lit(half, 2.0),
            Sky::Lobe => lit(half && cos * cos > 0.5, 4.0),
            Sky::Grazing => lit(cos < 0.25, 16.0),
        }
    }

    /// A draw ρ w(cos θ) L_i, with cos θ a function of U and φ = 2πV.
    fn weighed(&self, rng: &mut Stream, cos_theta: fn(f64) -> f64, weight: fn(f64) -> f64) -> f64 {
        self.turned(rng, cos_theta, |_, v| v, weight)
    }

    /// The same with φ/2π a function of U and V.
    fn turned(
        &self,
        rng: &mut Stream,
        cos_theta: fn(f64) -> f64,
        turns: fn(f64, f64) -> f64,
        weight: fn(f64) -> f64,
    ) -> f64 {
        let (u, v) = (rng.uniform(), rng.uniform());
        let cos = cos_theta(u);
        let direction = Direction::polar(cos, TAU * turns(u, v));
        direction.map_or(f64::NAN, |w| self.albedo * weight(cos) * self.light(&w))
    }

    /// A draw from three uniform numbers.
    fn spatial(
        &self,
        rng: &mut Stream,
        way: fn([f64; 3]) -> Result<Direction>,
        weight: fn(f64) -> f64,
    ) -> f64 {
        let direction = way([rng.uniform(), rng.uniform(), rng.uniform()]);
        // the origin itself, drawn once in 2¹⁵⁹ times, has no direction
        direction.map_or(0.0, |w| self.albedo * weight(w.cos_theta()) * self.light(&w))
    }
}

/// The draw from uniform directions, 2ρ L_i cos θ.
fn by_uniform(p: &Reflection, rng: &mut Stream) -> f64 {
    p.weighed(rng, uniform, |cos| 2.0 * cos)
}

/// cos θ for uniform directions.
fn uniform(u: f64) -> f64 {
    1.0 - u
}

/// cos θ for directions in proportion to it.
fn cosine(u: f64) -> f64 {
    (1.0 - u).sqrt()
}

/// cos θ with θ uniform in [0, π/2].
fn uniform_angle(u: f64) -> f64 {
    (FRAC_PI_2 * u).cos().max(0.0)
}

static PROBLEMS: [Reflection; 7] = [
    // the sheet's own questions, 3.4 and 3.5, then 3.2
    Reflection { albedo: 0.8, sky: Sky::Cosine },
    Reflection { albedo: 0.8, sky: Sky::Even },
    Reflection { albedo: 0.61, sky: Sky::Even },
    Reflection { albedo: 0.61, sky: Sky::CosineSquared },
    Reflection { albedo: 0.61, sky: Sky::HalfLit },
    Reflection { albedo: 0.61, sky: Sky::Lobe },
    Reflection { albedo: 0.61, sky: Sky::Grazing },
];

impl Problem for Reflection {
    fn exercise() -> &'static Exercise {
        static EXERCISE: LazyLock<Exercise> = LazyLock::new(|| {
            let by_cosine = |p: &Reflection, rng: &mut Stream| p.weighed(rng, cosine, |_| 1.0);
            Exercise::new(ABOUT, &[by_uniform, by_cosine], mistakes())
        });
        &EXERCISE
    }

    fn all() -> &'static [Self] {
        &PROBLEMS
    }

    fn truth(&self) -> f64 {
        // ∫ L 2 cos θ d(cos θ)
        let over_the_sky = match self.sky {
            Sky::Even | Sky::HalfLit | Sky::Lobe | Sky::Grazing => 1.0,
            Sky::Cosine => 2.0 / 3.0,
            Sky::CosineSquared => 0.5,
        };
        Lambertian::new(self.albedo).map_or(f64::NAN, |surface| surface.albedo() * over_the_sky)
    }

    fn given(&self) -> Vec<(&'static str, Given)> {
        let [sky, _] = self.sky.names();
        vec![("albedo", Given::Number(self.albedo)), ("light", Given::Word(sky))]
    }

    fn factors(&self) -> Vec<(&'static str, f64)> {
        vec![("ρ", self.albedo)]
    }
}

impl fmt::Display for Reflection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [_, sky] = self.sky.names();
        write!(f, "L = {sky}, ρ = {}", self.albedo)
    }
}

const ABOUT: About = About {
    id: "reflection",
    name: "reflected light",
    questions: &[("3.2", 1), ("3.4", 0), ("3.5", 0)],
    draw: "A draw is one of an estimate of the radiance L_r that a diffuse surface of this albedo reflects \
           under\nthe light L_i(ω), ω = (x, y, z) a unit vector and z = cos θ the height above the \
           surface:\none: 1; cos: z; cos2: z²; half: 2 where y ≥ 0, else 0; lobe: 4 where y ≥ 0 and z² > \
           1/2, else 0;\ngrazing: 16 where z < 1/4, else 0. All are 0 where z < 0.",
};

#[rustfmt::skip] // a list to be read
fn mistakes() -> &'static [Listed<Reflection>] { &[
    (["3.4", "pdf-pi", "pdf 1/π for uniform directions", "ρ L cos θ", PDF],
        |p, rng| p.weighed(rng, uniform, |c| c)),
    (["3.4", "pdf-sphere", "pdf of the whole sphere, 1/4π", "4ρ L cos θ", PDF],
        |p, rng| p.weighed(rng, uniform, |c| 4.0 * c)),
    (["3.4", "no-cos", "cos θ forgotten, uniform directions", "2ρ L", COS],
        |p, rng| p.weighed(rng, uniform, |_| 2.0)),
    (["3.5", "no-cos-cosine", "cos θ forgotten, cosine directions", "ρ L/cos θ", COS],
        |p, rng| p.weighed(rng, cosine, |c| 1.0 / c)),
    (["3.4", "no-brdf-pi", "1/π of the BRDF forgotten, uniform directions", "2πρ L cos θ", BRDF],
        |p, rng| p.weighed(rng, uniform, |c| TAU * c)),
    (["3.5", "no-brdf-pi-cosine", "1/π of the BRDF forgotten, cosine directions", "πρ L", BRDF],
        |p, rng| p.weighed(rng, cosine, |_| PI)),
    (["3.4", "pi-twice", "1/π twice", "2ρ/π L cos θ", BRDF],
        |p, rng| p.weighed(rng, uniform, |c| 2.0 * FRAC_1_PI * c)),
    (["3.5", "cosine-pdf-no-pi", "the cosine pdf without its 1/π", "ρ/π L", DRAWN_COSINE],
        |p, rng| p.weighed(rng, cosine, |_| FRAC_1_PI)),
    (["3.4", "no-pdf", "no division by the pdf, uniform directions", "ρ/π L cos θ", PDF],
        |p, rng| p.weighed(rng, uniform, |c| FRAC_1_PI * c)),
    (["3.5", "no-pdf-cosine", "no division by the pdf, cosine directions", "ρ/π L cos θ", DRAWN_COSINE],
        |p, rng| p.weighed(rng, cosine, |c| FRAC_1_PI * c)),
    (["3.4", "times-pdf", "multiplied by the pdf, uniform directions", "ρ/(2π²) L cos θ", PDF],
        |p, rng| p.weighed(rng, uniform, |c| 0.5 * FRAC_1_PI * FRAC_1_PI * c)),
    (["3.5", "times-pdf-cosine", "multiplied by the pdf, cosine directions", "ρ/π² L cos² θ", DRAWN_COSINE],
        |p, rng| p.weighed(rng, cosine, |c| FRAC_1_PI * FRAC_1_PI * c * c)),
    (["3.4", "cos-twice", "cos θ twice", "2ρ L cos² θ", COS],
        |p, rng| p.weighed(rng, uniform, |c| 2.0 * c * c)),
    (["3.5", "cos-kept", "cosine directions, cos θ kept", "ρ L cos θ", DRAWN_COSINE],
        |p, rng| p.weighed(rng, cosine, |c| c)),
    (["3.5", "uniform-weight", "cosine directions, the uniform weight", "2ρ L cos θ",
        "divide by the density that the directions were drawn from"],
        |p, rng| p.weighed(rng, cosine, |c| 2.0 * c)),
    (["3.5", "cosine-weight", "uniform directions, the cosine weight", "ρ L",
        "draw the directions from cos θ/π: cos θ = √(1 − U)"], |p, rng| p.weighed(rng, uniform, |_| 1.0)),
    (["3.4", "sin-for-cos", "sin θ for cos θ", "2ρ L sin θ",
        "θ is the angle to the normal, not to the surface"],
        |p, rng| p.weighed(rng, uniform, |c| 2.0 * (1.0 - c * c).sqrt())),
    (["3.4", "theta-uniform", "θ uniform in [0, π/2]", "θ = πU/2, 2ρ L cos θ", THETA],
        |p, rng| p.weighed(rng, uniform_angle, |c| 2.0 * c)),
    (["3.2", "no-sin", "sin θ forgotten in the measure", "θ = πU/2, πρ L cos θ", THETA],
        |p, rng| p.weighed(rng, uniform_angle, |c| PI * c)),
    (["3.5", "disc-radius", "a disc's radius without the root", "sin θ = U, ρ L", DISC],
        |p, rng| p.weighed(rng, |u| (1.0 - u * u).sqrt(), |_| 1.0)),
    (["3.5", "doubled", "x and y doubled before normalising", "(2x, 2y, z)/|…|, ρ L",
        "the disc has radius 1, and lifting needs no normalising"],
        |p, rng| p.weighed(rng, |u| ((1.0 - u) / (1.0 + 3.0 * u)).sqrt(), |_| 1.0)),
    (["3.5", "u-squared", "cos θ = U²", "cos θ = U², ρ L", DISC],
        |p, rng| p.weighed(rng, |u| (1.0 - u) * (1.0 - u), |_| 1.0)),
    (["3.4", "clamped-sphere", "directions of the whole sphere, clamped at the horizon",
        "cos θ in [−1, 1], 2ρ L max(cos θ, 0)", "draw from the hemisphere, or divide by 1/(4π)"],
        |p, rng| p.weighed(rng, |u| 1.0 - 2.0 * u, |c| 2.0 * c.max(0.0))),
    (["4.1", "reversed", "ω_i reversed", "ρ L(−ω)", "ω_i points towards the light"],
        |p, rng| p.weighed(rng, |u| -cosine(u), |_| 1.0)),
    (["3.5", "half-turn", "φ over half a turn", "φ = πV", PHI],
        |p, rng| p.turned(rng, cosine, |_, v| 0.5 * v, |_| 1.0)),
    (["3.5", "no-turn", "φ = V, without 2π", "φ = V", PHI],
        |p, rng| p.turned(rng, cosine, |_, v| v / TAU, |_| 1.0)),
    (["3.5", "same-u", "the same U for θ and φ", "cos θ = √(1 − U), φ = 2πU", PHI],
        |p, rng| p.turned(rng, cosine, |u, _| u, |_| 1.0)),
    (["3.3", "no-albedo", "ρ forgotten", "L", "L_r is in proportion to ρ: f_r = ρ/π"],
        |p, rng| Reflection { albedo: 1.0, ..*p }.weighed(rng, cosine, |_| 1.0)),
    (["3.3", "albedo-squared", "ρ squared", "ρ² L", "the BRDF holds ρ once"],
        |p, rng| p.albedo * p.weighed(rng, cosine, |_| 1.0)),
    (["3.3", "absorbed", "1 − ρ for ρ", "(1 − ρ) L", "ρ is what is reflected, 1 − ρ what is absorbed"],
        |p, rng| Reflection { albedo: 1.0 - p.albedo, ..*p }.weighed(rng, cosine, |_| 1.0)),
    (["3.4", "clamped", "each draw clamped to 1", "min(2ρ L cos θ, 1)",
        "clamp the final picture, not the draws"],
        |p, rng| by_uniform(p, rng).min(1.0)),
    (["4.3", "dark-left-out", "dark directions left out of n", "1/(lit directions) Σ 2ρ L cos θ",
        "a direction without light is a draw too: it adds 0 and counts in n"],
        |p, rng| (0..1000).map(|_| by_uniform(p, rng)).find(|draw| *draw > 0.0).unwrap_or(0.0)),
    (["3.4", "cube", "points of a cube, normalised", "(x, y, z)/|…| in the cube, 2ρ L cos θ",
        "reject points outside the ball: a cube's corners get too many directions"],
        |p, rng| p.spatial(rng, |[u, v, w]| Direction::new(2.0 * u - 1.0, 2.0 * v - 1.0, w), |c| 2.0 * c)),
    (["3.5", "in-the-ball", "normal + a point in the unit ball", "p in proportion to cos³ θ, ρ L", BALL],
        |p, rng| p.spatial(rng, above_the_ball, |_| 1.0)),
    (["3.5", "in-the-cube", "normal + a point of the cube around it", "ρ L", BALL],
        |p, rng| p.spatial(rng, |[u, v, w]| Direction::new(2.0 * u - 1.0, 2.0 * v - 1.0, 2.0 * w), |_| 1.0)),
] }

/// The direction of the normal plus a uniform point in the unit ball.
fn above_the_ball([u, v, w]: [f64; 3]) -> Result<Direction> {
    let (r, z) = (w.cbrt(), 1.0 - 2.0 * u);
    let (sin, (y, x)) = ((1.0 - z * z).sqrt(), (TAU * v).sin_cos());
    Direction::new(r * sin * x, r * sin * y, r * z + 1.0)
}

const PDF: &str = "uniform directions have p = 1/(2π): 2ρ L_i cos θ";
const DRAWN_COSINE: &str = "with p = cos θ/π all but ρ L_i cancels";
const COS: &str = "the integrand is f_r L_i cos θ: one cos θ";
const BRDF: &str = "f_r = ρ/π, once";
const THETA: &str = "uniform over the hemisphere is cos θ uniform in [0, 1], since dω = sin θ dθ dφ";
const DISC: &str = "a uniform point of the disc has the radius √U: cos θ = √(1 − U)";
const PHI: &str = "φ = 2πV, with V independent of U";
const BALL: &str = "add a point *on* the unit sphere to the normal: the sum is in proportion to cos θ";
