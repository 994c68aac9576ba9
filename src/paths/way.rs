//! How a path is followed, with or without a mistake: with next-event estimation at every vertex, while what
//! the faces emit is found by chance.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use crate::lambertian::hemisphere::Hemisphere;
use crate::paths::room::{BoxRoom, Face, Vertex, nearest, visible};
use crate::stream::Stream;

/// The geometry of a light sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    /// cos θ at the vertex.
    pub here: f64,
    /// cos θ at the light.
    pub there: f64,
    pub r: f64,
    /// The light's area.
    pub area: f64,
}

/// Which point of the light is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Spot {
    /// A uniform one.
    Random,
    /// Its middle, always.
    Middle,
    /// A uniform one, from the random numbers that all directions of the path are made of, too.
    Reused,
}

/// What happens to a light sample that is not visible.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Hidden {
    Dark,
    /// It counts as visible.
    Lit,
    /// It is replaced by another one.
    Redrawn,
}

/// How a path is followed, and what is summed along it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    /// The factor cos θ cos θ′ A/r² of a light sample.
    pub sample: fn(Seen) -> f64,
    pub spot: Spot,
    pub hidden: Hidden,
    /// Whether the light is found by chance.
    pub chance: bool,
    /// Whether all bounces but p's are mirror reflections.
    pub mirror: bool,
    pub directions: Hemisphere,
    /// The factor cos θ/(π p(ω)), from cos θ.
    pub weight: fn(f64) -> f64,
    /// The throughput after a bounce, from the one before, the albedo there and p's.
    pub carried: fn(f64, f64, f64) -> f64,
    /// The albedo at a vertex where the light is sampled, from the right one and p's.
    pub last: fn(f64, f64) -> f64,
    /// A path ends when its throughput falls below this.
    pub cutoff: f64,
    /// Roulette, if any: the path goes on with probability [`GOES_ON`], and its throughput is multiplied by
    /// this.
    pub coin: Option<f64>,
}

pub(super) const GOES_ON: f64 = 0.8;

/// After this many samples the search for a visible one ends.
pub(super) const TRIES: u32 = 4000;

pub(super) const RIGHT: Way = Way {
    sample: |s| s.here * s.there * s.area / (s.r * s.r),
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

/// BSDF sampling alone.
pub(super) const BY_CHANCE: Way = Way { sample: |_| 0.0, chance: true, ..RIGHT };

impl Way {
    /// One draw.
    pub fn follow(&self, room: &BoxRoom, [first, last]: [u32; 2], rng: &mut Stream) -> f64 {
        let lit = room.scene().light_half_width > 0.0;
        let of_p = room.albedo(&room.point());
        let reused = if self.spot == Spot::Reused { [rng.uniform(), rng.uniform()] } else { [0.5; 2] };
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

    /// The estimate L_e times `sample` for one light sample.
    fn sampled(&self, room: &BoxRoom, vertex: &Vertex, [u, v]: [f64; 2], rng: &mut Stream) -> f64 {
        // a point of the ceiling never sees the light
        let tries = if self.hidden == Hidden::Redrawn && vertex.face() != Face::Ceiling { TRIES } else { 1 };
        let (half, scene) = (room.scene().light_half_width, room.scene());
        for _ in 0..tries {
            let [u, v] = if self.spot == Spot::Random { [rng.uniform(), rng.uniform()] } else { [u, v] };
            let at = DVec3::new(half * (2.0 * u - 1.0), half * (2.0 * v - 1.0), Face::ROOM_HEIGHT);
            let way = at - vertex.position();
            let r = way.length();
            let seen =
                Seen { here: vertex.normal().dot(way) / r, there: way.z / r, r, area: room.light_area() };
            let above = seen.here > 0.0 && seen.there > 0.0;
            if above && (self.hidden == Hidden::Lit || visible(vertex, at)) {
                return scene.radiance * (self.sample)(seen);
            }
        }
        0.0
    }
}
