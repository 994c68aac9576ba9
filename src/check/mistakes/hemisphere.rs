//! Mistakes in estimating the light that a diffuse surface reflects.

use std::f64::consts::{FRAC_1_PI, FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4, PI, SQRT_2, TAU};
use std::sync::LazyLock;

use super::{Attempt, Mistake, Probe, Setup, Words, words};
use crate::check::exactly;
use crate::estimator::from_fn;
use crate::hemisphere::Direction;
use crate::lambertian::Lambertian;

/// A light of the probes, by which mistakes that look alike under a constant one are told apart. Nothing comes from below the horizon.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Sky {
    /// L_i = 1, as in a furnace: many mistakes pass it.
    Even,
    /// L_i = cos θ
    Cosine,
    /// L_i = cos² θ
    CosineSquared,
    /// L_i = 2 where φ < π: it sees azimuths that are not uniform.
    HalfLit,
    /// L_i = 4 where cos² θ > ½ and φ < π: a lobe off the axis, which sees whether θ and φ are independent.
    Lobe,
}

impl Sky {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Even, Self::Cosine, Self::CosineSquared, Self::HalfLit, Self::Lobe];

    /// The light as a formula.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Even => "L = 1",
            Self::Cosine => "L = cos θ",
            Self::CosineSquared => "L = cos² θ",
            Self::HalfLit => "L = 2 in half the sky",
            Self::Lobe => "L = 4 in a lobe",
        }
    }

    /// L_i from `direction`.
    pub fn radiance(self, direction: &Direction) -> f64 {
        let cos = direction.cos_theta();
        let lit = |yes: bool, radiance: f64| if yes { radiance } else { 0.0 };
        let half = direction.vector().y >= 0.0; // φ < π
        match self {
            _ if cos < 0.0 => 0.0,
            Self::Even => 1.0,
            Self::Cosine => cos,
            Self::CosineSquared => cos * cos,
            Self::HalfLit => lit(half, 2.0),
            Self::Lobe => lit(half && cos * cos > 0.5, 4.0),
        }
    }

    /// L_r: ρ times 1, 2/3, 1/2, 1 and 1.
    pub(super) fn reflected(self, surface: Lambertian) -> f64 {
        Signature::power(Law::Cosine, 1.0, 0.0).under(self, surface.albedo())
    }
}

pub(super) fn probes() -> Vec<Probe> {
    Sky::ALL.into_iter().filter_map(|sky| Probe::hemisphere(sky, 0.61).ok()).collect()
}

/// What an estimator's draws ρ w L_i average to: the means of w, w cos θ, w cos² θ and of w where cos² θ > ½, and which share of each comes
/// from φ < π, in all and where cos² θ > ½.
#[derive(Debug, Clone, Copy)]
struct Signature {
    moments: [f64; 4],
    shares: [f64; 2],
}

/// How cos θ is drawn.
#[derive(Debug, Clone, Copy)]
enum Law {
    Uniform,
    Cosine,
}

impl Signature {
    const fn new(moments: [f64; 4]) -> Self {
        Self { moments, shares: [0.5, 0.5] }
    }

    /// w = c cosᵏ θ.
    fn power(law: Law, c: f64, k: f64) -> Self {
        // ∫ cosᵏ⁺ʲ θ p(cos θ), with p = 1 or 2 cos θ
        let (c, k) = match law {
            Law::Uniform => (c, k + 1.0),
            Law::Cosine => (2.0 * c, k + 2.0),
        };
        let lobe = 1.0 - FRAC_1_SQRT_2.powf(k);
        Self::new([c / k, c / (k + 1.0), c / (k + 2.0), c * lobe / k])
    }

    fn times(self, factor: f64) -> Self {
        Self { moments: self.moments.map(|moment| factor * moment), ..self }
    }

    fn under(&self, sky: Sky, albedo: f64) -> f64 {
        let ([even, cosine, squared, lobe], [share, share_of_lobe]) = (self.moments, self.shares);
        albedo
            * match sky {
                Sky::Even => even,
                Sky::Cosine => cosine,
                Sky::CosineSquared => squared,
                Sky::HalfLit => 2.0 * share * even,
                Sky::Lobe => 4.0 * share_of_lobe * lobe,
            }
    }
}

/// A mistake whose draw is ρ w(cos θ) L_i, with cos θ and φ/2π functions of (U, V).
fn way(
    words: Words,
    cos_theta: fn(f64) -> f64,
    turns: fn(f64, f64) -> f64,
    weight: fn(f64) -> f64,
    signature: Signature,
) -> Mistake {
    let wrong = Attempt::hemisphere(move |light, albedo, rng| {
        let (u, v) = (rng.uniform(), rng.uniform());
        let cos = cos_theta(u);
        Direction::polar(cos, TAU * turns(u, v)).map_or(f64::NAN, |at| albedo * weight(cos) * light(&at))
    });
    Mistake::new(words, 2, wrong, move |setup| match *setup {
        Setup::Hemisphere { sky, albedo } => signature.under(sky, albedo),
        _ => f64::NAN,
    })
}

/// cos θ for uniform directions.
fn uniform(u: f64) -> f64 {
    1.0 - u
}

/// cos θ for directions in proportion to it.
fn cosine(u: f64) -> f64 {
    (1.0 - u).sqrt()
}

fn around(_: f64, v: f64) -> f64 {
    v
}

/// Directions drawn uniformly, weight c cosᵏ θ, with c and k constants of the fn.
macro_rules! drawn {
    (uniform, $c:expr, $k:literal, $words:expr) => {
        way(
            $words,
            uniform,
            around,
            |cos| $c * cos.powi($k),
            Signature::power(Law::Uniform, $c, f64::from($k)),
        )
    };
    (cosine, $c:expr, $k:literal, $words:expr) => {
        way($words, cosine, around, |cos| $c * cos.powi($k), Signature::power(Law::Cosine, $c, f64::from($k)))
    };
}

pub(super) fn mistakes() -> Vec<Mistake> {
    let pdf = "uniform directions have p = 1/(2π): 2ρ L_i cos θ";
    let drawn_cosine = "with p = cos θ/π all but ρ L_i cancels";
    let cos = "the integrand is f_r L_i cos θ: one cos θ";
    let brdf = "f_r = ρ/π, once";
    let match_p = "divide by the density that the directions were drawn from";
    let theta = "uniform over the hemisphere is cos θ uniform in [0, 1], since dω = sin θ dθ dφ";
    let disc = "a uniform point of the disc has the radius √U: cos θ = √(1 − U)";
    let phi = "φ = 2πV, with V independent of U";
    let mut mistakes = vec![
        drawn!(uniform, 1.0, 1, words("3.4", "pdf 1/π for uniform directions", "ρ L cos θ", pdf)),
        drawn!(uniform, 4.0, 1, words("3.4", "pdf of the whole sphere, 1/4π", "4ρ L cos θ", pdf)),
        drawn!(uniform, 2.0, 0, words("3.4", "cos θ forgotten, uniform directions", "2ρ L", cos)),
        drawn!(cosine, 1.0, -1, words("3.5", "cos θ forgotten, cosine directions", "ρ L/cos θ", cos)),
        drawn!(
            uniform,
            TAU,
            1,
            words("3.4", "1/π of the BRDF forgotten, uniform directions", "2πρ L cos θ", brdf)
        ),
        drawn!(cosine, PI, 0, words("3.5", "1/π of the BRDF forgotten, cosine directions", "πρ L", brdf)),
        drawn!(uniform, 2.0 * FRAC_1_PI, 1, words("3.4", "1/π twice", "2ρ/π L cos θ", brdf)),
        drawn!(cosine, FRAC_1_PI, 0, words("3.5", "the cosine pdf without its 1/π", "ρ/π L", drawn_cosine)),
        drawn!(
            uniform,
            FRAC_1_PI,
            1,
            words("3.4", "no division by the pdf, uniform directions", "ρ/π L cos θ", pdf)
        ),
        drawn!(
            cosine,
            FRAC_1_PI,
            1,
            words("3.5", "no division by the pdf, cosine directions", "ρ/π L cos θ", drawn_cosine)
        ),
        drawn!(
            uniform,
            0.5 * FRAC_1_PI * FRAC_1_PI,
            1,
            words("3.4", "multiplied by the pdf, uniform directions", "ρ/(2π²) L cos θ", pdf)
        ),
        drawn!(
            cosine,
            FRAC_1_PI * FRAC_1_PI,
            2,
            words("3.5", "multiplied by the pdf, cosine directions", "ρ/π² L cos² θ", drawn_cosine)
        ),
        drawn!(uniform, 2.0, 2, words("3.4", "cos θ twice", "2ρ L cos² θ", cos)),
        drawn!(cosine, 1.0, 1, words("3.5", "cosine directions, cos θ kept", "ρ L cos θ", drawn_cosine)),
        drawn!(cosine, 2.0, 1, words("3.5", "cosine directions, the uniform weight", "2ρ L cos θ", match_p)),
        drawn!(
            uniform,
            1.0,
            0,
            words(
                "3.5",
                "uniform directions, the cosine weight",
                "ρ L",
                "draw the directions from cos θ/π: cos θ = √(1 − U)"
            )
        ),
        way(
            words("3.4", "sin θ for cos θ", "2ρ L sin θ", "θ is the angle to the normal, not to the surface"),
            uniform,
            around,
            |cos| 2.0 * (1.0 - cos * cos).sqrt(),
            Signature::new([FRAC_PI_2, 2.0 / 3.0, PI / 8.0, FRAC_PI_4 - 0.5]),
        ),
        way(
            words("3.4", "θ uniform in [0, π/2]", "θ = πU/2, 2ρ L cos θ", theta),
            uniform_angle,
            around,
            |cos| 2.0 * cos,
            UNIFORM_ANGLE,
        ),
        way(
            words("3.2", "sin θ forgotten in the measure", "θ = πU/2, πρ L cos θ", "dω = sin θ dθ dφ"),
            uniform_angle,
            around,
            |cos| PI * cos,
            UNIFORM_ANGLE.times(FRAC_PI_2),
        ),
        way(
            words("3.5", "a disc's radius without the root", "sin θ = U, ρ L", disc),
            |u| (1.0 - u * u).sqrt(),
            around,
            |_| 1.0,
            Signature::new([1.0, FRAC_PI_4, 2.0 / 3.0, FRAC_1_SQRT_2]),
        ),
        way(
            words(
                "3.5",
                "x and y doubled before normalising",
                "(2x, 2y, z)/|…|, ρ L",
                "the disc has radius 1, and lifting needs no normalising",
            ),
            |u| ((1.0 - u) / (1.0 + 3.0 * u)).sqrt(),
            around,
            |_| 1.0,
            Signature::new([
                1.0,
                4.0 * PI / 3.0f64.powf(2.5) - 1.0 / 3.0,
                4.0 / 9.0 * 4.0f64.ln() - 1.0 / 3.0,
                0.2,
            ]),
        ),
        way(
            words("3.5", "cos θ = U²", "cos θ = U², ρ L", disc),
            |u| (1.0 - u) * (1.0 - u),
            around,
            |_| 1.0,
            Signature::new([1.0, 1.0 / 3.0, 0.2, 1.0 - 0.5f64.powf(0.25)]),
        ),
    ];
    let even = Signature::power(Law::Cosine, 1.0, 0.0);
    mistakes.extend([
        way(
            words("3.5", "φ over half a turn", "φ = πV", phi),
            cosine,
            |_, v| 0.5 * v,
            |_| 1.0,
            Signature { shares: [1.0, 1.0], ..even },
        ),
        way(
            words("3.5", "φ = V, without 2π", "φ = V", phi),
            cosine,
            |_, v| v / TAU,
            |_| 1.0,
            Signature { shares: [1.0, 1.0], ..even },
        ),
        way(
            words("3.5", "the same U for θ and φ", "cos θ = √(1 − U), φ = 2πU", phi),
            cosine,
            |u, _| u,
            |_| 1.0,
            Signature { shares: [0.5, 1.0], ..even },
        ),
        whole_sphere(),
        albedo(words("3.3", "ρ forgotten", "L", "L_r is in proportion to ρ: f_r = ρ/π"), |_| 1.0),
        albedo(words("3.3", "ρ squared", "ρ² L", "the BRDF holds ρ once"), |albedo| albedo * albedo),
        albedo(
            words("3.3", "1 − ρ for ρ", "(1 − ρ) L", "ρ is what is reflected, 1 − ρ what is absorbed"),
            |albedo| 1.0 - albedo,
        ),
        reversed(),
        clamped(),
        dark_left_out(),
        cube(),
    ]);
    mistakes
}

/// cos θ with θ uniform in [0, π/2].
fn uniform_angle(u: f64) -> f64 {
    (FRAC_PI_2 * u).cos().max(0.0)
}

/// 2/π ∫ 2 cosʲ θ dθ for j = 1, 2, 3, and j = 1 up to π/4.
const UNIFORM_ANGLE: Signature = Signature::new([4.0 / PI, 1.0, 8.0 / (3.0 * PI), 4.0 / PI * FRAC_1_SQRT_2]);

fn whole_sphere() -> Mistake {
    let words = words(
        "3.4",
        "directions of the whole sphere, clamped at the horizon",
        "cos θ in [−1, 1], 2ρ L max(cos θ, 0)",
        "draw from the hemisphere, or divide by 1/(4π)",
    );
    let below_is_dark = |cos: f64| 2.0 * cos.max(0.0);
    way(words, |u| 1.0 - 2.0 * u, around, below_is_dark, Signature::power(Law::Uniform, 1.0, 1.0))
}

/// Cosine directions, and another factor than ρ.
fn albedo(words: Words, factor: fn(f64) -> f64) -> Mistake {
    let wrong = Attempt::hemisphere(move |light, albedo, rng| {
        let (u, v) = (rng.uniform(), rng.uniform());
        Direction::polar(cosine(u), TAU * v).map_or(f64::NAN, |at| factor(albedo) * light(&at))
    });
    Mistake::new(words, 2, wrong, move |setup| match *setup {
        Setup::Hemisphere { sky, albedo } => {
            Signature::power(Law::Cosine, 1.0, 0.0).under(sky, factor(albedo))
        }
        _ => f64::NAN,
    })
}

fn reversed() -> Mistake {
    let words = words("4.1", "ω_i reversed", "ρ L(−ω)", "ω_i points towards the light");
    let wrong = Attempt::hemisphere(|light, albedo, rng| {
        let (u, v) = (rng.uniform(), rng.uniform());
        Direction::polar(-cosine(u), TAU * v).map_or(f64::NAN, |at| albedo * light(&at))
    });
    Mistake::new(words, 2, wrong, |_| 0.0)
}

fn clamped() -> Mistake {
    let words = words(
        "3.4",
        "each draw clamped to 1",
        "min(2ρ L cos θ, 1)",
        "clamp the picture, if you must, not the draws",
    );
    let wrong = Attempt::hemisphere(|light, albedo, rng| {
        let (u, v) = (rng.uniform(), rng.uniform());
        let cos = uniform(u);
        Direction::polar(cos, TAU * v).map_or(f64::NAN, |at| (2.0 * albedo * light(&at) * cos).min(1.0))
    });
    // ∫ min(g cᵏ, 1) dc from `low` to 1; both meet at g^(−1/k)
    let capped = |g: f64, k: i32, low: f64| {
        let meet = g.powf(-1.0 / f64::from(k)).clamp(low, 1.0);
        g * (meet.powi(k + 1) - low.powi(k + 1)) / f64::from(k + 1) + 1.0 - meet
    };
    Mistake::new(words, 2, wrong, move |setup| match *setup {
        Setup::Hemisphere { sky, albedo } => match sky {
            Sky::Even => capped(2.0 * albedo, 1, 0.0),
            Sky::Cosine => capped(2.0 * albedo, 2, 0.0),
            Sky::CosineSquared => capped(2.0 * albedo, 3, 0.0),
            Sky::HalfLit => 0.5 * capped(4.0 * albedo, 1, 0.0),
            Sky::Lobe => 0.5 * capped(8.0 * albedo, 1, FRAC_1_SQRT_2),
        },
        _ => f64::NAN,
    })
}

fn dark_left_out() -> Mistake {
    let words = words(
        "4.3",
        "dark directions left out of n",
        "1/(lit directions) Σ 2ρ L cos θ",
        "a direction without light is a draw too: it adds 0 and counts in n",
    );
    let wrong = Attempt::hemisphere(|light, albedo, rng| {
        for _ in 0..1000 {
            let (u, v) = (rng.uniform(), rng.uniform());
            let cos = uniform(u);
            let Ok(at) = Direction::polar(cos, TAU * v) else { break };
            let radiance = light(&at);
            if radiance > 0.0 {
                return 2.0 * albedo * radiance * cos;
            }
        }
        0.0
    });
    Mistake::new(words, 0, wrong, |setup| match *setup {
        Setup::Hemisphere { sky, albedo } => {
            let right = Signature::power(Law::Cosine, 1.0, 0.0).under(sky, albedo);
            match sky {
                Sky::Even | Sky::Cosine | Sky::CosineSquared => right,
                Sky::HalfLit => right / 0.5,
                Sky::Lobe => right / (0.5 * (1.0 - FRAC_1_SQRT_2)),
            }
        }
        _ => f64::NAN,
    })
}

fn cube() -> Mistake {
    let words = words(
        "3.4",
        "points of a cube, normalised",
        "(x, y, z)/|…| in the cube, 2ρ L cos θ",
        "reject points outside the ball: a cube's corners get too many directions",
    );
    let wrong = Attempt::hemisphere(|light, albedo, rng| {
        let [x, y, z] = [2.0 * rng.uniform() - 1.0, 2.0 * rng.uniform() - 1.0, rng.uniform()];
        // the origin itself, once in 2¹⁵⁹ draws, is no direction
        Direction::new(x, y, z).map_or(0.0, |at| 2.0 * albedo * light(&at) * at.cos_theta())
    });
    // A third of the half cube lies below its top face, the rest beside its walls; along its direction each point can be moved onto the
    // face, where it is uniform.
    static MOMENTS: LazyLock<[f64; 4]> = LazyLock::new(|| {
        let mean = |weight: fn(f64) -> f64| {
            let of_face = |height: fn(f64) -> f64, across: fn(f64) -> f64| {
                let draw = from_fn(move |rng| {
                    let (u, v) = (rng.uniform(), rng.uniform());
                    let (z, x) = (height(v), across(v));
                    weight(z / (1.0 + u * u + x * x).sqrt())
                });
                exactly(&draw, 2).map_or(f64::NAN, |exact| exact.mean)
            };
            of_face(|_| 1.0, |v| v) / 3.0 + 2.0 / 3.0 * of_face(|v| v, |v| v)
        };
        [
            mean(|cos| 2.0 * cos),
            mean(|cos| 2.0 * cos * cos),
            mean(|cos| 2.0 * cos.powi(3)),
            // cos² θ > ½ is a disc on the top face, and nothing on the others
            PI * (SQRT_2 - 1.0) / 3.0,
        ]
    });
    Mistake::new(words, 0, wrong, |setup| match *setup {
        Setup::Hemisphere { sky, albedo } => Signature::new(*MOMENTS).under(sky, albedo),
        _ => f64::NAN,
    })
}
