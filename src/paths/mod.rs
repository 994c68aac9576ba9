//! Section 4: light along paths in the [box room](room).
//!
//! # From one bounce to all
//! Light leaves p towards the eye in the direction ω_o as (*the rendering equation*, Kajiya 1986)
//!
//! > L_o(p, ω_o) = L_e(p) + ∫ f_r L_i(p, ω) cos θ dω.
//!
//! - **3.4** draws ω_i and averages f_r L_i cos θ_i/p(ω_i), where L_i is a light that is known.
//! - **4.3** In a room, what comes from ω_i left another point: L_i(p, ω_i) = L_o(p_j, −ω_i), p_j being the
//!   first point that a ray from p meets. So
//!
//!   > L̂_o(p, ω_o) = 1/n Σ f_r L_o(p_j, −ω_ij) cos θ_ij/p(ω_ij).
//!
//!   If L_o(p_j) is the light reflected *once* at p_j, this is the part of two bounces. What matters is its
//!   mean: an unbiased estimate L̂_o(p_j) in its place, drawn afresh for each ω_ij, leaves the whole
//!   unbiased. [`reflected`] is this estimator, with any L̂_o plugged in.
//! - **5** If L̂_o(p_j) is this very estimator, the path goes on from p_j to p_j′ and for ever; written out,
//!   without recursion, it is a loop along one path with the product of its throughputs f_r cos θ/p. Roulette
//!   ends it: it goes on with probability q, its throughput divided by q, so the mean stays. [`Paths`] is
//!   that loop.
//!
//! # What a bounce is
//! A bounce is a vertex of the path between the light and the eye. L_o(p) = Σ L_k, with L_k the light after k
//! bounces: k = 0 is what p itself emits, k = 1 what comes from the light to p at once, k = 2 what comes by
//! way of one other point p_j.
//!
//! # How the light is found
//! By chance, when a path happens on it, or by a sample of its area at every vertex (*next-event estimation*,
//! Coveyou et al. 1967): with y uniform on the light of area A, and V = 1 where the cube leaves the view
//! free, f_r L_e V cos θ cos θ_y A/r² in place of a ray. Both are unbiased. What is found in one way must not
//! be found in the other, too: where the light is sampled, a path that happens on it adds nothing, and what
//! the faces emit is found by chance always.

use glam::DVec3;
use rand::distr::Distribution;

use crate::doubt::Doubt;
use crate::error::{Result, require, require_count};
use crate::estimator::{Density, Estimator, from_fn};
use crate::fast::Real;
use crate::lambertian::hemisphere::{Direction, Hemisphere};
use crate::paths::room::{BoxRoom, Face, Vertex, nearest};
use crate::stream::Stream;

#[cfg(feature = "workbook")]
pub mod figures;
pub mod mistakes;
#[cfg(feature = "workbook")]
pub(crate) mod questions;
pub mod room;
mod side_by_side;
#[cfg(feature = "workbook")]
mod side_view;
mod way;

/// How a path finds the light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FindLight {
    /// When a ray happens on it.
    ByChance,
    /// By a point drawn uniformly on it, at every vertex.
    BySampling,
}

impl FindLight {
    /// Both, to loop over.
    pub const ALL: [Self; 2] = [Self::ByChance, Self::BySampling];
}

/// Which bounces are counted, and what ends a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bounces {
    /// The light after exactly this many.
    Exactly(u32),
    /// The light after 0, 1, … up to this many.
    UpTo(u32),
    /// All light. A path goes on with this probability q after every vertex.
    All(f64),
    /// All light. A path goes on with probability min(1, w), w being its throughput: it becomes 1 if the path
    /// goes on.
    AllByThroughput,
}

/// The most bounces that can be counted one by one.
pub const MOST_BOUNCES: u32 = 64;

/// The largest probability of going on: the mean number of bounces is q/(1 − q).
const MOST_Q: f64 = 0.9999;

/// The largest albedo that ends paths by itself, in a thousand bounces or so.
const MOST_ALBEDO: f64 = 0.999;

/// The light that leaves p, estimated along one random path a draw, in W m⁻² sr⁻¹.
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
    /// The fewest and the most bounces that count.
    counted: [u32; 2],
    ending: Ending,
    directions: Hemisphere,
    light: FindLight,
    /// What [`numbers_of_each`](Self::numbers_of_each) found.
    numbers: u64,
}

/// What ends a path before its bounces do.
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
    /// If there are more than [`MOST_BOUNCES`] to be counted; if q is not in (0, 0.9999\], for at 1 a path
    /// would never end; or if paths end by their throughput and an albedo is above 0.999, where they hardly
    /// would.
    pub fn new(room: BoxRoom, bounces: Bounces, directions: Hemisphere, light: FindLight) -> Result<Self> {
        let count = |k: u32| {
            require_count(
                "the number of bounces",
                k.into(),
                k <= MOST_BOUNCES,
                "at most 64 (without a limit, roulette ends the paths)",
            )
        };
        let (counted, ending) = match bounces {
            Bounces::Exactly(k) => {
                count(k)?;
                ([k, k], Ending::Never)
            }
            Bounces::UpTo(k) => {
                count(k)?;
                ([0, k], Ending::Never)
            }
            Bounces::All(q) => {
                require(
                    Q,
                    q,
                    q > 0.0 && q <= MOST_Q,
                    "above 0 and at most 0.9999, where a path has ten thousand bounces",
                )?;
                ([0, u32::MAX], Ending::Roulette(q))
            }
            Bounces::AllByThroughput => {
                let albedo = most_albedo(&room);
                let allowed = "at most 0.999 where nothing but absorption ends a path (or choose a q or a \
                               number of bounces)";
                require("the largest albedo", albedo, albedo <= MOST_ALBEDO, allowed)?;
                ([0, u32::MAX], Ending::ByThroughput)
            }
        };
        let paths = Self { room, counted, ending, directions, light, numbers: 0 };
        Ok(Self { numbers: paths.numbers_of_each(), ..paths })
    }

    /// The same paths computed in `f32`, in about half the time, along the same paths from the same numbers:
    /// speed against accuracy. Draws are summed in `f64` all the same.
    ///
    /// Its mean is off by rounding, and by the coarser grid k·2⁻²⁴ of its uniform numbers. In the sheet's
    /// scene no such bias was seen: with cosine directions and the light sampled it is 0 ± 7e-7 of the light
    /// of one bounce in 10⁹ paths, and 0 ± 1.6e-5 of that of up to fifteen in 1.5·10⁸.
    ///
    /// Radiances of any size that a scene allows are scaled on the way. What cannot be scaled is what lies
    /// between the strongest part of the light and the weakest.
    ///
    /// # Errors
    /// If a path's throughput would leave `f32`: if the smallest albedo but 0 is below 1e-25 to the power of
    /// the fewest bounces that count (two, if fewer do and so many may); or if the faces emit less than 1e-10
    /// of L_e A/π, or of L_e where light is found by chance.
    ///
    /// ```
    /// use unbiased::paths::room::{BoxRoom, Scene};
    /// use unbiased::lambertian::hemisphere::Hemisphere;
    /// use unbiased::paths::{Bounces, FindLight, Paths};
    /// use unbiased::{Budget, estimate};
    ///
    /// let room = BoxRoom::new(Scene::default())?;
    /// let once = Paths::new(room, Bounces::Exactly(1), Hemisphere::Cosine, FindLight::BySampling)?;
    /// let found = estimate(&once.in_f32()?, Budget::Draws(100_000), 1)?;
    /// assert!(found.z(0.2728543591976926).unwrap().abs() < 5.0);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    pub fn in_f32(self) -> Result<PathsF32> {
        let scene = self.room.scene();
        let albedos = [scene.wall_albedo, scene.cube_albedo].into_iter().filter(|albedo| *albedo > 0.0);
        let [fewest, most] = self.counted;
        // at most 64
        let bounces = fewest.max(most.min(2)) as i32;
        let throughput = albedos.fold(1.0, f64::min).powi(bounces);
        let allowed = "at least 1e-25 in single precision";
        require("the least albedo, to the power of the bounces,", throughput, throughput >= 1e-25, allowed)?;
        let part = scene.emission / self.light();
        let ok = part == 0.0 || part.is_nan() || part >= 1e-10;
        let allowed = "0 or at least 1e-10 in single precision";
        require("the faces' emission, in parts of the light's,", part, ok, allowed)?;
        Ok(PathsF32(self))
    }

    /// Whether the light is found by sampling it.
    fn samples_light(&self) -> bool {
        self.light == FindLight::BySampling && self.room.scene().light_half_width > 0.0
    }

    /// What a path of throughput 1 finds where it finds the light, but for the geometry of a sample.
    fn light(&self) -> f64 {
        match self.light {
            FindLight::BySampling => power(&self.room),
            FindLight::ByChance if self.room.scene().light_half_width > 0.0 => self.room.scene().radiance,
            FindLight::ByChance => 0.0,
        }
    }

    /// A power of two of the size of the light and of what the faces emit: divided by it, both are in reach
    /// of `f32`, and no bit is lost.
    fn scale(&self) -> f64 {
        let exponent = self.light().max(self.room.scene().emission).to_bits() & (0x7ff << 52);
        if exponent == 0 { 1.0 } else { f64::from_bits(exponent) }
    }

    /// The scene.
    ///
    /// ```
    /// # use unbiased::paths::room::{BoxRoom, Scene};
    /// # use unbiased::lambertian::hemisphere::Hemisphere;
    /// # use unbiased::paths::{Bounces, FindLight, Paths};
    /// let room = BoxRoom::new(Scene::default())?;
    /// let paths = Paths::new(room, Bounces::UpTo(3), Hemisphere::Cosine, FindLight::BySampling)?;
    /// assert_eq!((*paths.room(), paths.most_bounces()), (room, 3));
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    pub fn room(&self) -> &BoxRoom {
        &self.room
    }

    /// The most bounces that are counted, `u32::MAX` without a limit.
    pub fn most_bounces(&self) -> u32 {
        self.counted[1]
    }

    /// What [`doubt`](Estimator::doubt) says.
    fn reason(&self) -> Option<String> {
        let albedo = most_albedo(&self.room);
        let (spread, shown) = match self.directions {
            Hemisphere::Cosine => (1.0, "ρ²"),
            Hemisphere::Uniform => (4.0 / 3.0, "(4/3)ρ²"),
        };
        let growth = spread * albedo * albedo;
        let infinite = "the variance may be infinite, and the error bar too short:";
        let touches = self.room.scene().light_half_width >= 2.0 && self.light == FindLight::BySampling;
        match self.ending {
            Ending::Roulette(q) if q <= growth => {
                return Some(format!(
                    "{infinite} q = {q} is not above {shown} = {growth:.4} for the largest albedo"
                ));
            }
            // cosine's throughputs never exceed 1 then, and uniform ones grow while they do
            Ending::ByThroughput if self.directions == Hemisphere::Uniform && growth >= 1.0 => {
                return Some(format!(
                    "{infinite} the squared throughput of a path grows by {shown} = {growth:.4} a bounce for \
                     the largest albedo, and nothing ends a path of throughput 1 or more"
                ));
            }
            _ => {}
        }
        if touches && self.counted[1] > 1 {
            return Some(format!(
                "{infinite} the light touches the walls, where its samples weigh without bound"
            ));
        }
        let reasons = [
            (
                self.kurtosis_of_throughputs(),
                "uniform directions make most throughputs far too small and a few very large",
            ),
            (1.0 / self.found_by_chance(), "few paths find the light"),
            (
                self.kurtosis_of_samples(),
                "the light is so near the walls that a few of its samples outweigh all others",
            ),
        ];
        let draws: f64 = reasons.iter().map(|(kurtosis, _)| kurtosis).product();
        // what adds no digit is no reason
        let told: Vec<&str> =
            reasons.iter().filter(|(kurtosis, _)| *kurtosis >= 10.0).map(|(_, reason)| *reason).collect();
        (draws >= A_MILLION).then(|| {
            let why = told.join(", and ");
            format!("{why}, so that the error bar of fewer than about {draws:.0e} draws means nothing")
        })
    }

    /// E X⁴/(E X²)² of a light sample at a vertex of a wall, roughly, where the light comes near it.
    fn kurtosis_of_samples(&self) -> f64 {
        let beside = Face::ROOM_HALF_WIDTH - self.room.scene().light_half_width;
        // farther away it is the whole of the light that counts, not its edge
        let near = self.light == FindLight::BySampling && self.counted[1] > 1 && beside < 0.5;
        if near { 8.0 / beside.powi(3) } else { 1.0 }
    }

    /// E X⁴/(E X²)² of what a path that is never ended finds, or more, in a room where every vertex sees the
    /// same light.
    fn kurtosis_of_throughputs(&self) -> f64 {
        if self.ending != Ending::Never || self.directions == Hemisphere::Cosine {
            return 1.0;
        }
        let albedo = most_albedo(&self.room);
        // light that is sampled needs a direction less
        let less = u32::from(self.samples_light() && self.room.scene().emission == 0.0);
        let [fewest, most] = self.counted.map(|bounces| bounces.saturating_sub(less) as i32);
        // relative to the term of the fewest, as only their ratios count
        let sum = |factor: f64| {
            let terms = (fewest..=most).map(|k| albedo.powi(k - fewest) * factor.powf(f64::from(k)));
            terms.fold([0.0, 0.0], |[sum, squares], term| [sum + term, squares + term * term])
        };
        // ‖ΣX‖₄ ≤ Σ ‖X‖₄; E (ΣX)² is at least Σ E X² and at least (Σ E X)²
        let ([fourth, _], [mean, _], [_, square]) =
            (sum(3.2f64.powf(0.25)), sum(1.0), sum((4.0f64 / 3.0).sqrt()));
        let ratio = fourth * fourth / square.max(mean * mean);
        ratio * ratio
    }

    /// The part of the paths that find the light by chance, roughly: a bounce after the other, the light's
    /// part of all faces.
    fn found_by_chance(&self) -> f64 {
        let scene = self.room.scene();
        let dark = scene.light_half_width == 0.0 || scene.emission > 0.0 || self.counted[1] == 0;
        if self.light == FindLight::BySampling || dark {
            return 1.0;
        }
        let [fewest, most] = self.counted;
        let area: f64 = Face::ALL.iter().map(|face| face.area()).sum();
        let bounces = f64::from(most - fewest.max(1).min(most)) + 1.0;
        (self.room.light_area() / area * bounces).min(1.0)
    }

    /// An unbiased estimate of the radiance that leaves `vertex`, in W m⁻² sr⁻¹, along one random path:
    /// L̂_o(p_j) to plug in for [`reflected`], which has an example.
    #[inline]
    pub fn light_from(&self, vertex: &Vertex, rng: &mut Stream) -> f64 {
        self.walk(vertex, rng, |_| ())
    }

    /// One path with its vertices, for drawing: the same that [`draw`](Estimator::draw) takes from the same
    /// stream.
    ///
    /// ```
    /// # use unbiased::paths::room::{BoxRoom, Scene};
    /// # use unbiased::lambertian::hemisphere::Hemisphere;
    /// # use unbiased::paths::{Bounces, FindLight, Paths};
    /// # use unbiased::{Estimator, Stream};
    /// let room = BoxRoom::new(Scene::default())?;
    /// let twice = Paths::new(room, Bounces::Exactly(2), Hemisphere::Cosine, FindLight::BySampling)?;
    /// let path = twice.trace(&mut Stream::new(1, 0));
    /// // p and p_j; from p_j a point of the light is looked for
    /// assert_eq!((path.vertices[0], path.vertices.len(), path.samples[0].from), (room.point(), 2, 1));
    /// assert_eq!(path.light, twice.draw(&mut Stream::new(1, 0)));
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    pub fn trace(&self, rng: &mut Stream) -> Path {
        let mut path = Path { vertices: Vec::new(), samples: Vec::new(), light: 0.0 };
        path.light = self.walk(&self.room.point(), rng, |event| match event {
            Event::Vertex(vertex) => path.vertices.push(*vertex),
            Event::Light { point, visible } => {
                path.samples.push(Sample { from: path.vertices.len().saturating_sub(1), point, visible });
            }
        });
        path
    }

    /// Follows one path from `start`, and adds up the light that it finds.
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

    /// With what probability a path of this throughput goes on: rounded up to the grid of the uniform
    /// numbers, on which it is kept exactly.
    #[inline(always)]
    fn goes_on<T: Real>(&self, throughput: T) -> T {
        match self.ending {
            Ending::Never => T::of(1.0),
            Ending::Roulette(q) => on_the_grid(T::of(q).most(T::STEP)),
            Ending::ByThroughput => by_throughput(throughput),
        }
    }

    /// The numbers that every path takes, whether it needs them or not, where roulette does not end it.
    fn numbers_of_each(&self) -> u64 {
        let [fewest, most] = self.counted;
        if self.ending != Ending::Never || most == 0 {
            return 0;
        }
        let last = self.last();
        let samples = (last + 1).min(most) - fewest.saturating_sub(1);
        2 * u64::from(last + if self.samples_light() { samples } else { 0 })
    }

    /// The most rays of a path: once the light was sampled for the last time, only what the faces emit is
    /// left to be found.
    fn last(&self) -> u32 {
        let most = self.counted[1];
        if self.samples_light() && self.room.scene().emission == 0.0 { most.saturating_sub(1) } else { most }
    }

    /// cos θ/(π p(ω)), what is left of f_r cos θ/p(ω) beside the albedo: 1 for cosine directions, 2 cos θ for
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
        // paths side by side all take as many numbers
        let end = rng.random_numbers() + self.numbers;
        let light = self.light_from(&self.room.point(), rng);
        rng.skip_to(end);
        light
    }

    /// Paths side by side: the same as one after the other but for rounding, 1e-12 of each.
    fn fill(&self, rng: &mut Stream, draws: &mut [f64]) {
        side_by_side::fill::<f64>(self, rng, draws);
    }

    /// Why error bars are not to be trusted, if they are not: the variance may be infinite, or so few paths
    /// hold most of it that a run of a million does not meet them.
    ///
    /// A path's squared throughput grows by E\[(ρ cos θ/(π p(ω)))²\]/q a bounce, times the q of going on:
    /// ρ²/q with cosine directions, (4/3)ρ²/q with uniform ones. It must stay below 1 for the largest albedo
    /// ρ to be safe. And light samples near the light's edge have an infinite variance where the light
    /// touches a wall.
    ///
    /// An error bar from n draws has itself a relative error of about √(κ/4n), with κ = E X⁴/(E X²)². A
    /// throughput made of k uniform directions has κ = ((16/5)/(4/3)²)ᵏ = (9/5)ᵏ, whatever the albedo, and
    /// light that one path in m finds by chance m times that. From κ = 10⁶ on it is told; in so many draws or
    /// fewer, error bars are mostly too short. For a sum up to K bounces κ is at most (Σ (16/5)^(k/4) ρᵏ)⁴/(E
    /// X²)², and by chance m is estimated from the light's part of all faces. Samples of a light at the
    /// distance a from the walls, taken from there, have κ of about 8/a³: with c, d and y the way down,
    /// across and along, E Xⁿ is in proportion to ∫ (cd)ⁿ/(c² + d² + y²)²ⁿ over d > a, 0.131/a for n = 2 and
    /// 0.00112/a⁵ for n = 4.
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

/// [`Paths`] in single precision; see [`Paths::in_f32`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathsF32(Paths);

impl Estimator for PathsF32 {
    fn draw(&self, rng: &mut Stream) -> f64 {
        side_by_side::draw::<f32>(&self.0, rng)
    }

    fn fill(&self, rng: &mut Stream, draws: &mut [f64]) {
        side_by_side::fill::<f32>(&self.0, rng, draws);
    }

    fn doubt(&self) -> Option<Doubt> {
        self.0.doubt()
    }
}

const Q: &str = "the continuation probability q";

/// Draws that a run has, or that one has time for.
const A_MILLION: f64 = 1e6;

/// L_e A/π, what a sample of the light weighs but for cos θ cos θ′/r² and the albedo.
fn power(room: &BoxRoom) -> f64 {
    room.scene().radiance * room.light_area() * std::f64::consts::FRAC_1_PI
}

fn most_albedo(room: &BoxRoom) -> f64 {
    room.scene().wall_albedo.max(room.scene().cube_albedo)
}

/// The probability min(1, w) of going on.
#[inline(always)]
fn by_throughput<T: Real>(throughput: T) -> T {
    on_the_grid(throughput.least(T::of(1.0)))
}

/// A probability rounded up to the grid of the uniform numbers.
#[inline(always)]
fn on_the_grid<T: Real>(p: T) -> T {
    (p / T::STEP).ceil() * T::STEP
}

/// What a path meets on its way.
enum Event<'a> {
    Vertex(&'a Vertex),
    Light { point: DVec3, visible: bool },
}

/// A path that was followed.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    /// Its vertices, from p on; the last one may be on the light.
    pub vertices: Vec<Vertex>,
    /// The points of the light that were drawn on the way.
    pub samples: Vec<Sample>,
    /// The light that it found, weighted: the draw.
    pub light: f64,
}

/// A point drawn on the light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The index of the vertex that it was drawn for.
    pub from: usize,
    /// Where it is.
    pub point: DVec3,
    /// Whether that vertex sees it.
    pub visible: bool,
}

/// The estimator of 4.3, f_r L̂_o(p_j) cos θ/p(ω): light that comes to p from the points p_j it sees, in
/// directions drawn from `directions`.
///
/// `outgoing` is L_o(p_j, −ω), or any unbiased estimate of it that takes its random numbers from the stream.
/// With [`BoxRoom::direct`] it is the part of two bounces, without any variance from p_j on.
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
