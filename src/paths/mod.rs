//! Section 4: radiance along paths in the [box room](room).
//!
//! # From one bounce to all
//! The radiance that leaves p towards the eye, in direction ω_o, is (*the rendering equation*, Kajiya 1986)
//!
//! > L_o(p, ω_o) = L_e(p) + ∫ f_r L_i(p, ω) cos θ dω.
//!
//! - **3.4** draws ω_i and averages f_r L_i cos θ_i/p(ω_i), for a known incoming radiance L_i.
//! - **4.3** In a room, L_i(p, ω_i) is the radiance that leaves another point: L_i(p, ω_i) = L_o(p_j, −ω_i),
//!   where p_j is the first point that a ray from p hits. So
//!
//!   > L̂_o(p, ω_o) = 1/n Σ f_r L_o(p_j, −ω_ij) cos θ_ij/p(ω_ij).
//!
//!   If L_o(p_j) is the radiance reflected *once* at p_j, this is the two-bounce radiance. L_o(p_j) may be
//!   replaced by an unbiased estimate L̂_o(p_j), drawn anew for each ω_ij: the result stays unbiased.
//!   [`reflected`] is this estimator, for any L̂_o.
//! - **5** If L̂_o(p_j) is this same estimator, the path goes on from p_j to p_j′ without end. Written as a
//!   loop, it follows one path and multiplies its throughput by f_r cos θ/p at every vertex. Russian roulette
//!   ends it: the path goes on with probability q, and its throughput is divided by q, so the mean stays the
//!   same. [`Paths`] is that loop.
//!
//! # What a bounce is
//! A bounce is a vertex of the path between the light and the eye. L_o(p) = Σ L_k, where L_k is the radiance
//! after k bounces: k = 0 is what p itself emits, k = 1 comes from the light to p directly, and k = 2 by way
//! of one other point p_j.
//!
//! # How the light is found
//! By chance (*BSDF sampling*), when a path hits the light, or by sampling a point of it at every vertex
//! (*next-event estimation*, Coveyou et al. 1967): f_r L_e V cos θ cos θ_y A/r², with y uniform on the light
//! of area A, and V = 1 if y is visible, else 0. Both are unbiased. Nothing may be counted in both ways:
//! where the light is sampled, a path that hits it adds nothing. What the faces emit is always found by
//! chance.

use rand::distr::Distribution;

use crate::doubt::Doubt;
use crate::error::{Result, require, require_count};
use crate::estimator::{Density, Estimator, from_fn};
use crate::fast::Real;
use crate::lambertian::hemisphere::{Direction, Hemisphere};
use crate::paths::room::{BoxRoom, Vertex, nearest};
use crate::stream::Stream;

mod doubt;
#[cfg(feature = "workbook")]
pub mod figures;
pub mod mistakes;
#[cfg(feature = "workbook")]
pub(crate) mod questions;
pub mod room;
mod side_by_side;
#[cfg(feature = "workbook")]
mod side_view;
mod single;
mod trace;
mod way;

use trace::Event;
pub use trace::{Path, Sample};

/// How a path finds the light: by BSDF sampling alone, or by next-event estimation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FindLight {
    /// When a ray hits it.
    ByChance,
    /// By a point drawn uniformly on it, at every vertex.
    BySampling,
}

impl FindLight {
    /// Both.
    pub const ALL: [Self; 2] = [Self::ByChance, Self::BySampling];
}

/// Which bounces count, and what ends a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bounces {
    /// The radiance after exactly this many bounces.
    Exactly(u32),
    /// The radiance after 0, 1, … up to this many bounces.
    UpTo(u32),
    /// The radiance of all bounces. A path goes on with this probability q after every vertex.
    All(f64),
    /// The radiance of all bounces. A path of throughput w goes on with probability min(1, w). If w < 1 and
    /// it goes on, its throughput becomes 1.
    AllByThroughput,
}

/// The largest number of bounces that can be asked for.
const MOST_BOUNCES: u32 = 64;

/// The largest continuation probability: the mean number of bounces is q/(1 − q).
const MOST_Q: f64 = 0.9999;

/// The largest albedo at which absorption alone ends paths, after a thousand bounces or so.
const MOST_ALBEDO: f64 = 0.999;

/// The radiance that leaves p, in W m⁻² sr⁻¹. A draw is its estimate along one random path.
///
/// ```
/// use unbiased::paths::room::{BoxRoom, Scene};
/// use unbiased::lambertian::hemisphere::Hemisphere;
/// use unbiased::paths::{Bounces, FindLight, Paths};
/// use unbiased::{Budget, estimate};
///
/// let room = BoxRoom::new(Scene::default())?;
/// let two_bounces = Paths::new(room, Bounces::Exactly(2), Hemisphere::Cosine, FindLight::BySampling)?;
/// let found = estimate(&two_bounces, Budget::Draws(100_000), 1)?;
/// assert!(found.z(0.039903921548169116).unwrap().abs() < 5.0);
/// # Ok::<(), unbiased::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paths {
    room: BoxRoom,
    /// The smallest and the largest number of bounces that count.
    counted: [u32; 2],
    ending: Ending,
    directions: Hemisphere,
    light: FindLight,
    /// The result of [`numbers_of_each`](Self::numbers_of_each).
    numbers: u64,
}

/// What ends a path, apart from its largest number of bounces.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Ending {
    Never,
    Roulette(f64),
    ByThroughput,
}

impl Paths {
    /// Paths from the room's point p.
    ///
    /// # Errors
    /// If more than 64 bounces are to be counted; if q is not in (0, 0.9999\], as a path with q = 1
    /// never ends; or if paths end by their throughput and an albedo is above 0.999, as they would be too
    /// long.
    pub fn new(room: BoxRoom, bounces: Bounces, directions: Hemisphere, light: FindLight) -> Result<Self> {
        let (counted, ending) = match bounces {
            Bounces::Exactly(k) => ([k, k], Ending::Never),
            Bounces::UpTo(k) => ([0, k], Ending::Never),
            Bounces::All(q) => ([0, u32::MAX], Ending::Roulette(q)),
            Bounces::AllByThroughput => ([0, u32::MAX], Ending::ByThroughput),
        };
        match ending {
            Ending::Never => {
                let allowed = "at most 64 (without a limit, roulette ends the paths)";
                let most = counted[1];
                require_count("the number of bounces", most.into(), most <= MOST_BOUNCES, allowed)?;
            }
            Ending::Roulette(q) => {
                let allowed = "above 0 and at most 0.9999, where a path has ten thousand bounces";
                require("the continuation probability q", q, q > 0.0 && q <= MOST_Q, allowed)?;
            }
            Ending::ByThroughput => {
                let albedo = most_albedo(&room);
                let allowed = "at most 0.999 where nothing but absorption ends a path (or choose a q or a \
                               number of bounces)";
                require("the largest albedo", albedo, albedo <= MOST_ALBEDO, allowed)?;
            }
        }
        let paths = Self { room, counted, ending, directions, light, numbers: 0 };
        Ok(Self { numbers: paths.numbers_of_each(), ..paths })
    }

    /// Whether the light is found by sampling it.
    fn samples_light(&self) -> bool {
        self.light == FindLight::BySampling && self.room.scene().light_half_width > 0.0
    }

    /// What a path of throughput 1 finds where it finds the light, without the geometry factor of a light
    /// sample.
    fn light(&self) -> f64 {
        match self.light {
            FindLight::BySampling => power(&self.room),
            FindLight::ByChance if self.room.scene().light_half_width > 0.0 => self.room.scene().radiance,
            FindLight::ByChance => 0.0,
        }
    }

    /// A power of two of the size of the light's radiance and the faces' emission. Dividing by it is exact,
    /// and brings both into the range of `f32`.
    fn scale(&self) -> f64 {
        let exponent = self.light().max(self.room.scene().emission).to_bits() & (0x7ff << 52);
        if exponent == 0 { 1.0 } else { f64::from_bits(exponent) }
    }

    /// The scene.
    pub fn room(&self) -> &BoxRoom {
        &self.room
    }

    /// The largest number of bounces that counts, `u32::MAX` without a limit.
    #[cfg(feature = "workbook")]
    fn most_bounces(&self) -> u32 {
        self.counted[1]
    }

    /// An unbiased estimate of the radiance that leaves `vertex`, in W m⁻² sr⁻¹, along one random path. It
    /// can be passed to [`reflected`] as L̂_o(p_j); see the example there.
    #[inline]
    pub fn light_from(&self, vertex: &Vertex, rng: &mut Stream) -> f64 {
        self.walk(vertex, rng, |_| ())
    }

    /// Follows one path from `start`, and returns the radiance that it finds.
    #[inline]
    fn walk(&self, start: &Vertex, rng: &mut Stream, mut see: impl FnMut(Event<'_>)) -> f64 {
        let [fewest, most] = self.counted;
        let sampled = self.samples_light();
        let last = self.last();
        let (mut vertex, mut throughput, mut light, mut bounces) = (*start, 1.0, 0.0, 0);
        loop {
            see(Event::Vertex(&vertex));
            let found_already = sampled && bounces > 0 && self.room.is_light(&vertex);
            if bounces >= fewest && !found_already {
                light += throughput * self.room.emitted(&vertex);
            }
            let albedo = self.room.albedo(&vertex);
            if bounces >= most || albedo == 0.0 {
                break;
            }
            if sampled && bounces + 1 >= fewest {
                let sample = self.room.sample_light(&vertex, rng);
                see(Event::Light { point: sample.point, visible: sample.visible });
                light += throughput * albedo * std::f64::consts::FRAC_1_PI * sample.irradiance;
            }
            if bounces >= last {
                break;
            }
            let direction = self.directions.sample(rng);
            throughput *= albedo * self.cosine_over_pdf(&direction);
            if self.ending != Ending::Never {
                let q = self.goes_on(throughput);
                if rng.uniform() >= q {
                    break;
                }
                throughput /= q;
            }
            rng.count_evaluations(1);
            vertex = nearest(vertex.position(), vertex.to_room(&direction));
            bounces = bounces.saturating_add(1);
            if throughput == 0.0 {
                break; // too small for f64: nothing is added from here on
            }
        }
        light
    }

    /// The probability that a path of this throughput goes on, rounded up to the grid of the uniform numbers
    /// so that it is exact.
    #[inline(always)]
    fn goes_on<T: Real>(&self, throughput: T) -> T {
        match self.ending {
            Ending::Never => T::of(1.0),
            Ending::Roulette(q) => on_the_grid(T::of(q).most(T::STEP)),
            Ending::ByThroughput => by_throughput(throughput),
        }
    }

    /// How many random numbers every path takes, needed or not, if roulette does not end it; else 0.
    fn numbers_of_each(&self) -> u64 {
        let [fewest, most] = self.counted;
        if self.ending != Ending::Never || most == 0 {
            return 0;
        }
        let last = self.last();
        let samples = (last + 1).min(most) - fewest.saturating_sub(1);
        2 * u64::from(last + if self.samples_light() { samples } else { 0 })
    }

    /// The largest number of rays of a path. After the last light sample, a ray is needed only if faces emit.
    fn last(&self) -> u32 {
        let most = self.counted[1];
        if self.samples_light() && self.room.scene().emission == 0.0 { most.saturating_sub(1) } else { most }
    }

    /// cos θ/(π p(ω)), which is f_r cos θ/p(ω) without the albedo: 1 for cosine directions, 2 cos θ for
    /// uniform ones.
    #[inline]
    fn cosine_over_pdf(&self, direction: &Direction) -> f64 {
        match self.directions {
            Hemisphere::Cosine => 1.0,
            Hemisphere::Uniform => 2.0 * direction.cos_theta(),
        }
    }
}

impl Estimator for Paths {
    #[inline]
    fn draw(&self, rng: &mut Stream) -> f64 {
        // paths that are computed side by side all take the same number of random numbers
        let end = rng.random_numbers() + self.numbers;
        let light = self.light_from(&self.room.point(), rng);
        rng.skip_to(end);
        light
    }

    /// Many paths side by side. Draws equal those of one path after the other to about 1e-12.
    fn fill(&self, rng: &mut Stream, draws: &mut [f64]) {
        side_by_side::fill::<f64>(self, rng, draws);
    }

    /// Why the error bar may be wrong: the variance may be infinite, or such a small fraction of paths holds
    /// most of it that a run of a million draws may miss them.
    ///
    /// A path's squared throughput grows by E\[(ρ cos θ/(π p(ω)))²\]/q per bounce: ρ²/q with cosine
    /// directions, (4/3)ρ²/q with uniform ones. For a finite variance this must stay below 1 for the largest
    /// albedo ρ. Light samples have an infinite variance if the light touches a wall.
    ///
    /// An error bar from n draws has a relative error of about √(κ/4n), with κ = E X⁴/(E X²)². With κ ≥ 10⁶
    /// there is a doubt, as error bars from that many draws or fewer are mostly too short. κ is estimated as
    /// follows:
    /// - A throughput of k uniform directions has κ = ((16/5)/(4/3)²)ᵏ = (9/5)ᵏ, whatever the albedo.
    /// - If one path in m finds the light by chance, κ is m times that. m is estimated from the light's share
    ///   of the area of all faces.
    /// - For a sum of up to K bounces κ is at most (Σ (16/5)^(k/4) ρᵏ)⁴/(E X²)².
    /// - Light samples from a wall at distance a from the light have κ of about 8/a³. With c, d and y the
    ///   distances down, across and along, E Xⁿ is proportional to ∫ (cd)ⁿ/(c² + d² + y²)²ⁿ over d > a, which
    ///   is 0.131/a for n = 2 and 0.00112/a⁵ for n = 4.
    ///
    /// ```
    /// # use unbiased::paths::room::{BoxRoom, Scene};
    /// # use unbiased::lambertian::hemisphere::Hemisphere;
    /// # use unbiased::paths::{Bounces, FindLight, Paths};
    /// use unbiased::Estimator;
    ///
    /// let room = BoxRoom::new(Scene::default())?;
    /// let by = |directions| Paths::new(room, Bounces::Exactly(64), directions, FindLight::BySampling);
    /// assert_eq!(by(Hemisphere::Cosine)?.doubt(), None);
    /// let doubt = by(Hemisphere::Uniform)?.doubt().unwrap().to_string();
    /// assert!(doubt.ends_with("of fewer than about 1e16 draws means nothing"));
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    fn doubt(&self) -> Option<Doubt> {
        self.reason().map(Doubt::Reason)
    }
}

/// L_e A/π, the weight of a light sample without cos θ cos θ′/r² and the albedo.
fn power(room: &BoxRoom) -> f64 {
    room.scene().radiance * room.light_area() * std::f64::consts::FRAC_1_PI
}

fn most_albedo(room: &BoxRoom) -> f64 {
    room.scene().wall_albedo.max(room.scene().cube_albedo)
}

/// The probability min(1, w) that a path of throughput w goes on.
#[inline(always)]
fn by_throughput<T: Real>(throughput: T) -> T {
    on_the_grid(throughput.least(T::of(1.0)))
}

/// A probability rounded up to the grid of the uniform numbers.
#[inline(always)]
fn on_the_grid<T: Real>(p: T) -> T {
    (p / T::STEP).ceil() * T::STEP
}

/// The estimator of 4.3, f_r L̂_o(p_j) cos θ/p(ω): radiance that reaches p from the points p_j, in directions
/// drawn from `directions`.
///
/// `outgoing` is L_o(p_j, −ω), or any unbiased estimate of it that takes its random numbers from the stream.
/// With [`BoxRoom::direct`] it is the two-bounce radiance, without variance from p_j on.
///
/// ```
/// use unbiased::paths::room::{BoxRoom, Scene};
/// use unbiased::lambertian::hemisphere::Hemisphere;
/// use unbiased::paths::{Bounces, FindLight, Paths, reflected};
/// use unbiased::{Budget, estimate};
///
/// let room = BoxRoom::new(Scene::default())?;
/// // seen from the cube's top, nothing hides the light from any p_j
/// let exact = reflected(room, Hemisphere::Cosine, |p_j, _| room.direct(p_j));
/// let once = Paths::new(room, Bounces::Exactly(1), Hemisphere::Cosine, FindLight::BySampling)?;
/// let estimated = reflected(room, Hemisphere::Cosine, |p_j, rng| once.light_from(p_j, rng));
/// for estimator in [&exact as &dyn unbiased::Estimator, &estimated] {
///     let found = estimate(estimator, Budget::Draws(100_000), 1)?;
///     assert!(found.z(0.039903921548169116).unwrap().abs() < 5.0);
/// }
/// # Ok::<(), unbiased::Error>(())
/// ```
pub fn reflected<L>(room: BoxRoom, directions: Hemisphere, outgoing: L) -> impl Estimator
where
    L: Fn(&Vertex, &mut Stream) -> f64 + Sync,
{
    let p = room.point();
    let brdf = room.albedo(&p) * std::f64::consts::FRAC_1_PI;
    from_fn(move |rng| {
        let direction = directions.sample(rng);
        rng.count_evaluations(1);
        let p_j = nearest(p.position(), p.to_room(&direction));
        brdf * outgoing(&p_j, rng) * direction.cos_theta() / directions.pdf(&direction)
    })
}
