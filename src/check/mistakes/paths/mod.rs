//! Mistakes in following paths through the box room.
//!
//! A wrong estimator is a right one with a [`Way`] of its own: the light is sampled on its area at every vertex, what the faces emit is found by chance. What it
//! comes to is worked out from the same way without random paths. One light sample shared by all vertices of a path is no mistake: it is independent
//! of every direction, so the mean stays; one that shares the *directions'* random numbers is.

use std::f64::consts::{FRAC_1_PI, PI};
use std::fmt;

use glam::DVec3;

use super::{Attempt, Mistake, Probe, Setup, Words};
use crate::box_room::exact::{over_the_light, over_the_unit, over_the_walls, seen};
use crate::box_room::{BoxRoom, Face, Scene, Vertex, nearest, visible};
use crate::estimator::Density;
use crate::hemisphere::{Direction, Hemisphere};
use crate::stream::Stream;

mod exact;
mod gallery;

pub(super) use gallery::mistakes;

/// The light after the first to the last bounce, if that is known exactly.
pub(super) fn truth(room: &BoxRoom, [first, last]: [u32; 2]) -> Option<f64> {
    (first..=last).map(|k| exact::is_known(room, k).then(|| exact::after(room, k))).sum()
}

pub(super) fn probes() -> Vec<Probe> {
    // odd numbers, p off the axes: a light of area 1 hides its area, equal albedos hide which was taken
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
        (odd, 1..=1),
        // the cube hides from this p nearly half of the light
        (Scene { point: [0.7, 0.1, 0.0], ..odd }, 1..=1),
        (Scene::default(), 2..=2),
        (odd, 2..=2),
        (furnace, 0..=2),
        (Scene { emission: 0.4, ..even(0.7) }, 3..=3),
        (even(0.8), 0..=6),
    ]
    .into_iter()
    .filter_map(|(scene, bounces)| Probe::paths(BoxRoom::new(scene).ok()?, bounces).ok())
    .collect()
}

/// The bounces and the scene in a few words: p, the albedos, what emits, and the light's half-width.
pub(super) fn describe(f: &mut fmt::Formatter<'_>, scene: &Scene, [first, last]: [u32; 2]) -> fmt::Result {
    let [x, y, z] = scene.point;
    match (first, last) {
        _ if first == last => write!(f, "k = {last}")?,
        (0, _) => write!(f, "k ≤ {last}")?,
        _ => write!(f, "k = {first}…{last}")?,
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

/// What a light sample is weighed by.
#[derive(Debug, Clone, Copy)]
struct Seen {
    /// cos θ at the vertex.
    here: f64,
    /// cos θ at the light.
    there: f64,
    r: f64,
    /// The light's area.
    area: f64,
}

/// How the light is sampled.
#[derive(Debug, Clone, Copy)]
enum Sampled {
    Never,
    Rightly,
    /// With this for cos θ cos θ′ A/r².
    As(fn(Seen) -> f64),
}

impl Sampled {
    fn value(self, seen: Seen) -> f64 {
        match self {
            Self::Never => 0.0,
            Self::Rightly => seen.here * seen.there * seen.area / (seen.r * seen.r),
            Self::As(value) => value(seen),
        }
    }
}

/// Which point of the light is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Spot {
    /// A uniform one.
    Random,
    /// Its middle, always.
    Middle,
    /// A uniform one, from the random numbers that all directions of the path are made of, too.
    Reused,
}

/// What becomes of a light sample that the cube or the horizon hides.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Hidden {
    Dark,
    /// The cube hides nothing.
    Lit,
    /// Left out: another one is drawn for it.
    Redrawn,
}

/// How a path is followed and what is added up on it.
#[derive(Debug, Clone, Copy)]
struct Way {
    /// The first and the last bounce that count, from those asked for.
    counted: fn([u32; 2]) -> [u32; 2],
    /// What a light sample adds, f_r L_e apart.
    sample: Sampled,
    spot: Spot,
    hidden: Hidden,
    /// Whether the light is found by chance.
    chance: bool,
    /// Whether every bounce but p's is a mirror's.
    mirror: bool,
    directions: Hemisphere,
    /// What stands for cos θ/(π p(ω)), from cos θ.
    weight: fn(f64) -> f64,
    /// The throughput after a bounce, from the one before, the albedo there and p's.
    carried: fn(f64, f64, f64) -> f64,
    /// The albedo at a vertex where the light is sampled, from the right one and p's.
    last: fn(f64, f64) -> f64,
    /// A path whose throughput falls below this ends.
    cutoff: f64,
    /// What the throughput is multiplied by where a coin says go on, as it does with chance [`GOES_ON`].
    coin: Option<f64>,
}

const GOES_ON: f64 = 0.8;

/// No light is looked for longer than this.
const TRIES: u32 = 4000;

const RIGHT: Way = Way {
    counted: |asked| asked,
    sample: Sampled::Rightly,
    spot: Spot::Random,
    hidden: Hidden::Dark,
    chance: false,
    mirror: false,
    directions: Hemisphere::Cosine,
    weight: |_| 1.0,
    carried: |throughput, albedo, _| throughput * albedo,
    last: |albedo, _| albedo,
    cutoff: 0.0,
    coin: None,
};

impl Way {
    /// One draw.
    fn draw(&self, room: &BoxRoom, asked: [u32; 2], rng: &mut Stream) -> f64 {
        let [first, last] = (self.counted)(asked);
        let lit = room.scene().light_half_width > 0.0;
        let of_p = room.albedo(&room.point());
        let reused = [rng.uniform(), rng.uniform()];
        let (mut vertex, mut throughput, mut light) = (room.point(), 1.0, 0.0);
        let mut arrives: Option<DVec3> = None;
        for k in 0..=last {
            let albedo = room.albedo(&vertex);
            if k >= first && (k == 0 || self.chance || !room.is_light(&vertex)) {
                light += throughput * room.emitted(&vertex);
            }
            if k == last || albedo == 0.0 {
                break;
            }
            if lit && k + 1 >= first {
                let sampled = self.sampled(room, &vertex, reused, rng);
                light += throughput * (self.last)(albedo, of_p) * FRAC_1_PI * sampled;
            }
            let [u, v] = if self.spot == Spot::Reused { reused } else { [rng.uniform(), rng.uniform()] };
            let Ok(direction) = self.directions.direction_of(u, v) else { break };
            throughput = (self.carried)(throughput, albedo, of_p) * (self.weight)(direction.cos_theta());
            if throughput < self.cutoff {
                break;
            }
            if let Some(weight) = self.coin {
                if rng.uniform() >= GOES_ON {
                    break;
                }
                throughput *= weight;
            }
            let way = match arrives {
                Some(way) if self.mirror => way - vertex.normal() * (2.0 * way.dot(vertex.normal())),
                _ => vertex.to_room(&direction),
            };
            vertex = nearest(vertex.position(), way);
            arrives = Some(way);
        }
        light
    }

    /// Draws until a path finds light.
    fn draw_until_lit(&self, room: &BoxRoom, asked: [u32; 2], rng: &mut Stream) -> f64 {
        (0..TRIES).map(|_| self.draw(room, asked, rng)).find(|light| *light > 0.0).unwrap_or(0.0)
    }

    /// L_e times what a sample of the light is taken for.
    fn sampled(&self, room: &BoxRoom, vertex: &Vertex, [u, v]: [f64; 2], rng: &mut Stream) -> f64 {
        if matches!(self.sample, Sampled::Never) {
            return 0.0;
        }
        // a point of the ceiling never sees the light
        let tries = if self.hidden == Hidden::Redrawn && vertex.face() != Face::Ceiling { TRIES } else { 1 };
        for _ in 0..tries {
            let at = match self.spot {
                Spot::Random => on_light(room, rng.uniform(), rng.uniform()),
                Spot::Middle => on_light(room, 0.5, 0.5),
                Spot::Reused => on_light(room, u, v),
            };
            let seen = Seen::of(room, vertex, at);
            let above = seen.here > 0.0 && seen.there > 0.0;
            if above && (self.hidden == Hidden::Lit || visible(vertex, at)) {
                return room.scene().radiance * self.sample.value(seen);
            }
        }
        0.0
    }

    /// What the draws average to.
    fn mean(&self, room: &BoxRoom, asked: [u32; 2]) -> f64 {
        let [first, last] = (self.counted)(asked);
        (first..=last).map(|k| self.mean_after(room, k)).sum()
    }

    /// The mean light after k bounces, in rooms whose truth is known.
    fn mean_after(&self, room: &BoxRoom, k: u32) -> f64 {
        let Some(before) = k.checked_sub(1) else { return room.emitted(&room.point()) };
        let of_p = exact::albedo(room, 0);
        let throughput = |bounces: u32| {
            (0..bounces).try_fold(1.0, |throughput, vertex| {
                let next = (self.carried)(throughput, exact::albedo(room, vertex), of_p);
                let played = self.coin.map_or(1.0, |weight| GOES_ON * weight);
                (next >= self.cutoff).then_some(next * played)
            })
        };
        let scene = room.scene();
        if scene.light_half_width == 0.0 {
            let bounce = over_the_unit(|cos| {
                (self.weight)(cos) * if self.directions == Hemisphere::Cosine { 2.0 * cos } else { 1.0 }
            });
            return throughput(k).map_or(0.0, |t| t * bounce.powf(f64::from(k)) * scene.emission);
        }
        let sampled = throughput(before).map_or(0.0, |t| {
            let there = exact::albedo(room, before);
            t * (self.last)(there, of_p) * FRAC_1_PI * scene.radiance * self.mean_of_samples(room, k)
        });
        let seen = match k {
            _ if !self.chance => 0.0,
            2 if self.mirror => exact::seen_in_mirrors(room),
            1 => seen(room, &room.point()),
            _ => over_the_walls(room, |p_j, w| seen(room, p_j) * w.z * FRAC_1_PI),
        };
        sampled + throughput(k).map_or(0.0, |t| t * scene.radiance * seen)
    }

    /// The mean of what the light is taken for at a path's last vertex, directions to get there included: p itself for one bounce, a wall for two.
    fn mean_of_samples(&self, room: &BoxRoom, k: u32) -> f64 {
        if matches!(self.sample, Sampled::Never) {
            return 0.0;
        }
        let at = |vertex: &Vertex, y: DVec3| self.sample.value(Seen::of(room, vertex, y));
        let random = |vertex: &Vertex| {
            if matches!(self.sample, Sampled::Rightly) && self.hidden == Hidden::Dark {
                return PI * seen(room, vertex);
            }
            let over = |f: &dyn Fn(DVec3) -> f64| {
                over_the_light(room, vertex, self.hidden != Hidden::Lit, f) / room.light_area()
            };
            let mean = over(&|y| at(vertex, y));
            if self.hidden == Hidden::Redrawn { mean / over(&|_| 1.0) } else { mean }
        };
        let middle = |vertex: &Vertex| {
            let y = on_light(room, 0.5, 0.5);
            if visible(vertex, y) { at(vertex, y) } else { 0.0 }
        };
        let p = room.point();
        match (k, self.spot) {
            (1, Spot::Middle) => middle(&p),
            (1, _) => random(&p),
            (2, _) => over_the_walls(room, |p_j, w| {
                let Ok(direction) = Direction::new(w.x, w.y, w.z) else { return 0.0 };
                let there = match self.spot {
                    Spot::Random => random(p_j),
                    Spot::Middle => middle(p_j),
                    Spot::Reused => self
                        .directions
                        .uniforms_of(&direction)
                        .map_or(f64::NAN, |[u, v]| at(p_j, on_light(room, u, v))),
                };
                (self.weight)(w.z) * self.directions.pdf(&direction) * there
            }),
            _ => f64::NAN,
        }
    }
}

impl Seen {
    fn of(room: &BoxRoom, vertex: &Vertex, y: DVec3) -> Self {
        let way = y - vertex.position();
        let r = way.length();
        Self { here: vertex.normal().dot(way) / r, there: way.z / r, r, area: room.light_area() }
    }
}

/// The point of the light that two uniform numbers stand for.
fn on_light(room: &BoxRoom, u: f64, v: f64) -> DVec3 {
    let h = room.scene().light_half_width;
    DVec3::new(h * (2.0 * u - 1.0), h * (2.0 * v - 1.0), Face::ROOM_HEIGHT)
}

/// A right estimator followed in a wrong way.
fn followed(words: Words, way: Way) -> Mistake {
    of_expected(
        words,
        Attempt::paths(move |room, bounces, rng| way.draw(room, bounces.into_inner().into(), rng)),
        move |room, bounces| way.mean(room, bounces),
    )
}

/// The wrong bounces counted, each rightly.
fn counted(words: Words, counted: fn([u32; 2]) -> [u32; 2]) -> Mistake {
    let way = Way { counted, ..RIGHT };
    of_expected(
        words,
        Attempt::paths(move |room, bounces, rng| way.draw(room, bounces.into_inner().into(), rng)),
        move |room, bounces| {
            let [first, last] = counted(bounces);
            (first..=last).map(|k| exact::after(room, k)).sum()
        },
    )
}

/// Rays that found no light left out of n.
fn found_only(words: Words) -> Mistake {
    /// What a path brings if it finds the light after k bounces.
    fn brings(room: &BoxRoom, k: u32) -> f64 {
        (0..k).map(|j| exact::albedo(room, j)).product::<f64>() * room.scene().radiance
    }
    let way = Way { sample: Sampled::Never, chance: true, ..RIGHT };
    of_expected(
        words,
        Attempt::paths(move |room, bounces, rng| match bounces.into_inner() {
            // each that finds it brings the same, so that there is no need to look
            (first, last) if first == last && last > 0 && room.scene().light_half_width > 0.0 => {
                brings(room, last)
            }
            bounces => way.draw_until_lit(room, bounces.into(), rng),
        }),
        |room, [first, last]| {
            if room.scene().light_half_width == 0.0 {
                return RIGHT.mean(room, [first, last]);
            }
            let (light, chance) = (first.max(1)..=last).fold((0.0, 0.0), |(light, chance), k| {
                let after = exact::after(room, k);
                (light + after, chance + after / brings(room, k))
            });
            light / chance
        },
    )
}

/// `random_numbers` is 0: a path takes more than quadrature can.
fn of_expected(
    words: Words,
    wrong: Attempt<'static>,
    expected: impl Fn(&BoxRoom, [u32; 2]) -> f64 + Send + Sync + 'static,
) -> Mistake {
    Mistake::new(words, 0, wrong, move |setup| match setup {
        Setup::Paths { room, bounces } => expected(room, *bounces),
        _ => f64::NAN,
    })
}
