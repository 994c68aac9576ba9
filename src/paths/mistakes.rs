//! Mistakes in following paths through the box room.
//!
//! A wrong estimator is the right one with one change in how a path is followed. One light sample shared by
//! all vertices of a path is no mistake: it is independent of every direction, so the mean stays the same.
//! One that reuses the random numbers of the *directions* is.

use std::f64::consts::PI;
use std::fmt;
use std::ops::RangeInclusive;
use std::sync::LazyLock;

use super::way::{BY_CHANCE, GOES_ON, Hidden, RIGHT, Spot, TRIES, Way};
use crate::check::{About, Exercise, Given, Listed, Problem};
use crate::lambertian::hemisphere::Hemisphere;
use crate::paths::room::{BoxRoom, Scene};
use crate::stream::Stream;

/// The problem of estimating the radiance that leaves a room's point p after given numbers of bounces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightOfPaths {
    /// The room, which says where p is, what emits and what the albedos are.
    pub room: BoxRoom,
    pub(super) first: u32,
    pub(super) last: u32,
}

impl LightOfPaths {
    /// The numbers of bounces that count: `2..=2` is exactly two, `0..=3` is up to three.
    pub fn bounces(&self) -> RangeInclusive<u32> {
        self.first..=self.last
    }

    /// The right estimator for other numbers of bounces.
    fn counting(&self, first: u32, last: u32, rng: &mut Stream) -> f64 {
        RIGHT.draw(&Self { first, last, ..*self }, rng)
    }

    /// The radiance after k bounces, where it is a closed form or an integral of one.
    fn after(&self, k: u32) -> f64 {
        let (room, scene) = (&self.room, self.room.scene());
        match k {
            0 => room.emitted(&room.point()),
            // a furnace: from the cube's top the next vertex is always on a wall
            _ if scene.light_half_width == 0.0 => {
                scene.emission * room.albedo(&room.point()) * scene.wall_albedo.powi(k as i32 - 1)
            }
            1 => room.one_bounce(),
            2 => room.two_bounces().unwrap_or(f64::NAN),
            _ => f64::NAN,
        }
    }
}

impl Way {
    fn draw(&self, p: &LightOfPaths, rng: &mut Stream) -> f64 {
        self.follow(&p.room, [p.first, p.last], rng)
    }
}

static PROBLEMS: LazyLock<Vec<LightOfPaths>> = LazyLock::new(|| {
    // generic numbers, p off the axes: an area of 1 would hide a missing area, equal albedos a wrong one
    let odd = Scene {
        wall_albedo: 0.61,
        cube_albedo: 0.37,
        radiance: 7.0,
        light_half_width: 0.8,
        emission: 0.0,
        point: [0.2, -0.1, 1.0],
    };
    let furnace = Scene { radiance: 0.0, light_half_width: 0.0, emission: 2.5, ..odd };
    let even = |albedo| Scene { wall_albedo: albedo, cube_albedo: albedo, ..furnace };
    [
        (Scene::default(), 2..=2),
        (odd, 1..=1),
        // seen from this p, the cube hides nearly half of the light
        (Scene { point: [0.7, 0.1, 0.0], ..odd }, 1..=1),
        // grazing incidence, high on a wall
        (Scene { point: [2.0, 0.4, 3.7], ..odd }, 1..=1),
        (odd, 2..=2),
        (furnace, 0..=2),
        (Scene { emission: 0.4, ..even(0.7) }, 3..=3),
        (even(0.8), 0..=6),
    ]
    .into_iter()
    .filter_map(|(scene, bounces)| {
        let (first, last) = bounces.into_inner();
        Some(LightOfPaths { room: BoxRoom::new(scene).ok()?, first, last })
    })
    .collect()
});

impl Problem for LightOfPaths {
    fn exercise() -> &'static Exercise {
        static EXERCISE: LazyLock<Exercise> =
            LazyLock::new(|| Exercise::new(ABOUT, &[|p: &LightOfPaths, rng| RIGHT.draw(p, rng)], mistakes()));
        &EXERCISE
    }

    fn all() -> &'static [Self] {
        &PROBLEMS
    }

    fn truth(&self) -> f64 {
        self.bounces().map(|k| self.after(k)).sum()
    }

    fn given(&self) -> Vec<(&'static str, Given)> {
        let (scene, [x, y, z]) = (self.room.scene(), self.room.scene().point);
        [
            ("wall_albedo", scene.wall_albedo),
            ("cube_albedo", scene.cube_albedo),
            ("radiance", scene.radiance),
            ("light_half_width", scene.light_half_width),
            ("emission", scene.emission),
            ("x", x),
            ("y", y),
            ("z", z),
            ("first", self.first.into()),
            ("last", self.last.into()),
        ]
        .map(|(name, number)| (name, Given::Number(number)))
        .into()
    }

    fn factors(&self) -> Vec<(&'static str, f64)> {
        let scene = self.room.scene();
        vec![
            ("ρ_wall", scene.wall_albedo),
            ("ρ_cube", scene.cube_albedo),
            ("1 − ρ_wall", 1.0 - scene.wall_albedo),
        ]
    }
}

/// The bounces and the scene in a few words: p, the albedos, what emits, and the light's half-width.
impl fmt::Display for LightOfPaths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (scene, [x, y, z]) = (self.room.scene(), self.room.scene().point);
        match (self.first, self.last) {
            (first, last) if first == last => write!(f, "k = {last}")?,
            (0, last) => write!(f, "k ≤ {last}")?,
            (first, last) => write!(f, "k = {first}…{last}")?,
        }
        write!(f, ", p at {x}, {y}, {z}, walls {}, cube {}", scene.wall_albedo, scene.cube_albedo)?;
        if scene.light_half_width > 0.0 {
            write!(f, ", light {} over ±{}", scene.radiance, scene.light_half_width)?;
        }
        if scene.emission > 0.0 {
            write!(f, ", all emit {}", scene.emission)?;
        }
        Ok(())
    }
}

const ABOUT: About = About {
    id: "paths",
    name: "paths in the box room",
    questions: &[("4.3", 0)],
    draw: "A draw is one of an estimate of the radiance that leaves p after `first` to `last` bounces, all \
           summed; a\nbounce is a vertex between light and eye, p among them. The room is [−2, 2] × [−2, 2] \
           × [0, 4] metres, z\nup; its walls, floor and ceiling reflect wall_albedo. The cube [−1/2, 1/2] × \
           [−1/2, 1/2] × [0, 1] stands\non the floor and reflects cube_albedo. All is diffuse. The light is \
           the square |x|, |y| ≤ light_half_width\nof the ceiling, faces down, emits radiance and reflects \
           nothing; every other face emits emission.\np = (x, y, z) lies on a face; bounce 0 is what p \
           itself emits.",
};

/// A light found by chance, of paths that find it.
fn some_light(p: &LightOfPaths, rng: &mut Stream) -> f64 {
    let scene = p.room.scene();
    if p.first == p.last && scene.light_half_width > 0.0 {
        // each path that finds the light contributes the same, so none has to be traced
        return scene.radiance * p.room.albedo(&p.room.point()) * scene.wall_albedo.powi(p.last as i32 - 1);
    }
    let mut tries = (0..TRIES).map(|_| BY_CHANCE.draw(p, rng));
    tries.find(|light| *light > 0.0).unwrap_or(0.0)
}

#[rustfmt::skip] // a list to be read
fn mistakes() -> &'static [Listed<LightOfPaths>] { &[
    (["4.3", "no-area", "the light's area forgotten", "f_r L cos θ cos θ′/r²", AREA],
        |p, rng| Way { sample: |s| s.here * s.there / (s.r * s.r), ..RIGHT }.draw(p, rng)),
    (["4.3", "times-density", "multiplied by the light's density", "f_r L cos θ cos θ′/(r² A)", AREA],
        |p, rng| Way { sample: |s| s.here * s.there / (s.r * s.r * s.area), ..RIGHT }.draw(p, rng)),
    (["4.3", "half-width", "the light's half-width for its width", "A = w²",
        "A is the square of the width, twice the half-width"],
        |p, rng| Way { sample: |s| 0.25 * s.area * s.here * s.there / (s.r * s.r), ..RIGHT }.draw(p, rng)),
    (["4.3", "no-light-cos", "the light's cosine forgotten", "f_r L cos θ A/r²", TURN],
        |p, rng| Way { sample: |s| s.here * s.area / (s.r * s.r), ..RIGHT }.draw(p, rng)),
    (["4.3", "r", "r for r²", "f_r L cos θ cos θ′ A/r", TURN],
        |p, rng| Way { sample: |s| s.here * s.there * s.area / s.r, ..RIGHT }.draw(p, rng)),
    (["4.3", "no-r", "r² forgotten", "f_r L cos θ cos θ′ A", TURN],
        |p, rng| Way { sample: |s| s.here * s.there * s.area, ..RIGHT }.draw(p, rng)),
    (["4.3", "no-cos", "the surface's cosine forgotten at the light sample", "f_r L cos θ′ A/r²", COSINE],
        |p, rng| Way { sample: |s| s.there * s.area / (s.r * s.r), ..RIGHT }.draw(p, rng)),
    (["4.3", "cos-twice", "the surface's cosine twice at the light sample", "f_r L cos² θ cos θ′ A/r²",
        COSINE],
        |p, rng| Way { sample: |s| s.here * s.here * s.there * s.area / (s.r * s.r), ..RIGHT }.draw(p, rng)),
    (["4.3", "neither-cos", "both cosines forgotten at the light sample", "f_r L A/r²", TURN],
        |p, rng| Way { sample: |s| s.area / (s.r * s.r), ..RIGHT }.draw(p, rng)),
    (["4.3", "middle", "the light's middle for every sample", "y = (0, 0, 4)",
        "draw a point of the light for every path"],
        |p, rng| Way { spot: Spot::Middle, ..RIGHT }.draw(p, rng)),
    (["4.3", "same-numbers", "the same random numbers for light and directions", "one (U, V) a path",
        "directions and light samples take numbers of their own"],
        |p, rng| Way { spot: Spot::Reused, ..RIGHT }.draw(p, rng)),
    (["4.3", "occlusion", "occlusion ignored", "V = 1", "a light sample that the cube hides adds 0"],
        |p, rng| Way { hidden: Hidden::Lit, ..RIGHT }.draw(p, rng)),
    (["4.3", "hidden-left-out", "hidden light samples left out of n", "divided by the visible ones", N],
        |p, rng| Way { hidden: Hidden::Redrawn, ..RIGHT }.draw(p, rng)),
    (["4.3", "dark-left-out", "rays without light left out of n", "divided by those that found it", N],
        some_light),
    (["4.3", "counted-twice", "the light found by chance and sampled", "both added",
        "where the light is sampled, a ray that hits it adds nothing"],
        |p, rng| Way { chance: true, ..RIGHT }.draw(p, rng)),
    (["4.3", "no-pi-light", "1/π of the BRDF forgotten at the light sample", "ρ L cos θ cos θ′ A/r²", BRDF],
        |p, rng| Way { last: |albedo, _| PI * albedo, ..RIGHT }.draw(p, rng)),
    (["4.3", "no-pi", "1/π of the BRDF forgotten at every bounce", "f_r = ρ", BRDF],
        |p, rng| Way { last: |rho, _| PI * rho, carried: |t, rho, _| t * rho * PI, ..RIGHT }.draw(p, rng)),
    (["4.3", "no-last-albedo", "the last vertex's albedo forgotten", "L cos θ cos θ′ A/(π r²)",
        "the vertex that the light falls on reflects ρ of it, too"],
        |p, rng| Way { last: |_, _| 1.0, ..RIGHT }.draw(p, rng)),
    (["4.3", "one-albedo", "p's albedo at every vertex", "ρ(p)ᵏ",
        "take each vertex's own albedo: a wall's, or the cube's"],
        |p, rng| Way { last: |_, of_p| of_p, carried: |t, _, of_p| t * of_p, ..RIGHT }.draw(p, rng)),
    (["4.3", "no-throughput", "the throughput never multiplied", "Σ L_e", PRODUCT],
        |p, rng| Way { carried: |t, _, _| t, ..RIGHT }.draw(p, rng)),
    (["4.3", "replaced", "the throughput replaced, not multiplied", "throughput = ρ", PRODUCT],
        |p, rng| Way { carried: |_, albedo, _| albedo, ..RIGHT }.draw(p, rng)),
    (["4.3", "mirror", "a mirror bounce for a diffuse one", "ω = reflected ray at p_j",
        "a diffuse surface sends light everywhere: draw ω anew at every vertex"],
        |p, rng| Way { mirror: true, ..BY_CHANCE }.draw(p, rng)),
    (["4.3", "uniform-no-cos", "cos θ forgotten, uniform directions", "f_r 2π a bounce", DIRECTION],
        |p, rng| Way { directions: Hemisphere::Uniform, weight: |_| 2.0, ..RIGHT }.draw(p, rng)),
    (["4.3", "cosine-weight", "uniform directions, the cosine weight", "ρ a bounce", DIRECTION],
        |p, rng| Way { directions: Hemisphere::Uniform, ..RIGHT }.draw(p, rng)),
    (["4.3", "uniform-weight", "cosine directions, the uniform weight", "2ρ cos θ a bounce", DIRECTION],
        |p, rng| Way { weight: |cos| 2.0 * cos, ..RIGHT }.draw(p, rng)),
    (["4.3", "cos-kept", "cosine directions, cos θ kept", "ρ cos θ a bounce", DIRECTION],
        |p, rng| Way { weight: |cos| cos, ..RIGHT }.draw(p, rng)),
    (["4.2", "one-more", "one bounce too many", "k + 1", VERTICES],
        |p, rng| p.counting(if p.first == p.last { p.last + 1 } else { p.first }, p.last + 1, rng)),
    (["4.2", "one-less", "one bounce too few", "k − 1", VERTICES], |p, rng| {
        let last = p.last.saturating_sub(1);
        p.counting(p.first.min(last), last, rng)
    }),
    (["4.2", "up-to", "all bounces up to k where exactly k are asked for", "Σ to k", VERTICES],
        |p, rng| p.counting(0, p.last, rng)),
    (["4.3", "no-first", "the first emission skipped", "Σ from 1", EMITS],
        |p, rng| p.counting(p.first.max(1), p.last, rng)),
    (["4.3", "last-only", "only the last vertex's light counted", "L_K alone", EMITS],
        |p, rng| p.counting(p.last, p.last, rng)),
    (["5", "cutoff", "stops where the throughput is small", "ends below 0.3, no compensation", CHANCE],
        |p, rng| Way { cutoff: 0.3, ..RIGHT }.draw(p, rng)),
    (["5", "roulette-bare", "roulette uncompensated", "goes on with chance 4/5, nothing divided", CHANCE],
        |p, rng| Way { coin: Some(1.0), ..RIGHT }.draw(p, rng)),
    (["5", "roulette-twice", "roulette compensated twice", "ρ/q² a bounce", "divide by q once for each coin"],
        |p, rng| Way { coin: Some(1.0 / (GOES_ON * GOES_ON)), ..RIGHT }.draw(p, rng)),
] }

const AREA: &str = "a point of the light has density 1/A: divide by it";
const TURN: &str = "dω = cos θ′ dA/r²: sampling an area takes all three";
const COSINE: &str = "cos θ is the surface's, once for every light sample";
const N: &str = "divide by all n draws: one that finds nothing adds 0";
const BRDF: &str = "f_r = ρ/π";
const DIRECTION: &str = "a bounce weighs f_r cos θ/p(ω), with the p that ω was drawn from";
const PRODUCT: &str = "the throughput is the product of all weights so far";
const VERTICES: &str = "k counts the vertices between light and eye";
const EMITS: &str = "every vertex that counts adds its L_e times the throughput";
const CHANCE: &str = "end a path at random, and divide by the probability of going on";
