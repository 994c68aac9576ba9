//! Problems of known truth.

use std::fmt;
use std::ops::RangeInclusive;

use super::{Sky, Statistic, Surface, Topic, furnace, paths};
use crate::box_room::BoxRoom;
use crate::error::{Error, Result, require, require_count};
use crate::inversion::Exponential;
use crate::lambertian::Lambertian;
use crate::paths::MOST_BOUNCES;
use crate::rectangle::Rectangle;
use crate::roulette::Roulette;

/// A problem of known truth, on which an [`Attempt`](super::Attempt) is tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Probe {
    pub(super) setup: Setup,
    truth: f64,
    unit: f64,
}

/// What the attempt is given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Setup {
    Exponential { rate: f64, statistic: Statistic },
    Rectangle { rectangle: Rectangle, surface: Surface },
    Hemisphere { sky: Sky, albedo: f64 },
    Roulette { p_rr: f64 },
    Bounces { p_rr: f64 },
    Furnace { albedo: f64, emission: f64, bounces: Option<u32> },
    Paths { room: BoxRoom, bounces: [u32; 2] },
}

impl Probe {
    /// The mean of `statistic` of exponential samples with rate λ.
    ///
    /// # Errors
    /// If λ is not positive and finite.
    pub fn exponential(rate: f64, statistic: Statistic) -> Result<Self> {
        let truth = statistic.mean(Exponential::new(rate)?);
        Ok(Self { setup: Setup::Exponential { rate, statistic }, truth, unit: truth })
    }

    /// ∫∫ `surface` over the rectangle.
    pub fn rectangle(rectangle: Rectangle, surface: Surface) -> Self {
        let truth = surface.integral(&rectangle);
        // about the origin xy and x + 2y integrate to 0: there errors are measured against ∫∫ |f|
        let unit = if truth == 0.0 { surface.absolute_integral(&rectangle) } else { truth };
        Self { setup: Setup::Rectangle { rectangle, surface }, truth, unit }
    }

    /// The radiance that a surface of this albedo reflects under `sky`.
    ///
    /// # Errors
    /// If ρ is not above 0 and at most 1.
    pub fn hemisphere(sky: Sky, albedo: f64) -> Result<Self> {
        require("the albedo ρ of a probe", albedo, albedo > 0.0, "above 0 and at most 1")?;
        let truth = sky.reflected(Lambertian::new(albedo)?);
        Ok(Self { setup: Setup::Hemisphere { sky, albedo }, truth, unit: truth })
    }

    /// Roulette around X = ½ + U, whose mean is 1.
    ///
    /// # Errors
    /// If p_rr is not strictly between 0 and 1.
    pub fn roulette(p_rr: f64) -> Result<Self> {
        require_chance(p_rr)?;
        Ok(Self { setup: Setup::Roulette { p_rr }, truth: 1.0, unit: 1.0 })
    }

    /// The mean number of bounces.
    ///
    /// # Errors
    /// If p_rr is not strictly between 0 and 1.
    pub fn bounces(p_rr: f64) -> Result<Self> {
        require_chance(p_rr)?;
        let truth = Roulette::new(p_rr)?.bounces().mean();
        Ok(Self { setup: Setup::Bounces { p_rr }, truth, unit: truth })
    }

    /// Light in a furnace whose faces all emit L and reflect ρ, after at most `bounces`, or all (`None`): Σ ρᵏ L.
    ///
    /// # Errors
    /// If ρ is not strictly between 0 and 1, L not positive and finite, or there are more than 1000 bounces.
    pub fn furnace(albedo: f64, emission: f64, bounces: Option<u32>) -> Result<Self> {
        require(
            "the albedo ρ of a furnace",
            albedo,
            albedo > 0.0 && albedo < 1.0,
            "strictly between 0 and 1",
        )?;
        let ok = emission > 0.0 && emission.is_finite();
        require("the emission L", emission, ok, "positive and finite")?;
        let count = u64::from(bounces.unwrap_or(0));
        require_count("the number of bounces", count, count <= 1000, "at most 1000")?;
        let truth = emission * furnace::sum(albedo, bounces);
        Ok(Self { setup: Setup::Furnace { albedo, emission, bounces }, truth, unit: truth })
    }

    /// The light that leaves a room's point p after so many bounces, the first and the last counted in, where it is known without following paths:
    /// - in a furnace (faces that emit, no light): any bounces if all albedos are the same, up to 2 from the cube's top, up to 1 from elsewhere
    /// - from the light alone: up to 1, or 2 from the cube's top if the light's half-width is at most 1. One bounce is a closed form, the cube's shadow taken off; two are
    ///   its integral over the walls, to 1e-10.
    ///
    /// # Errors
    /// Elsewhere, where there is no light at all, and for more than [`MOST_BOUNCES`].
    ///
    /// ```
    /// use unbiased::box_room::{BoxRoom, Scene};
    /// use unbiased::check::Probe;
    ///
    /// let room = BoxRoom::new(Scene::default())?;
    /// assert!((Probe::paths(room, 1..=1)?.truth() - 0.2728543591976926).abs() < 1e-15);
    /// assert!((Probe::paths(room, 2..=2)?.truth() - 0.039903921548169116).abs() < 1e-11);
    /// assert!(Probe::paths(room, 1..=3).is_err());
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    pub fn paths(room: BoxRoom, bounces: RangeInclusive<u32>) -> Result<Self> {
        let (first, last) = (*bounces.start(), *bounces.end());
        require_count("the last bounce", last.into(), last <= MOST_BOUNCES, "at most 64")?;
        require_count("the first bounce", first.into(), first <= last, "at most the last one")?;
        let bounces = [first, last];
        let unknown =
            || Error::Usage("what this room's p gets after these bounces has no exact value".into());
        let truth = paths::truth(&room, bounces).ok_or_else(unknown)?;
        require("the light at p", truth, truth > 0.0 && truth.is_finite(), "positive and finite")?;
        Ok(Self { setup: Setup::Paths { room, bounces }, truth, unit: truth })
    }

    /// What a right estimator's draws average to.
    pub fn truth(&self) -> f64 {
        self.truth
    }

    /// What ratios are taken to: the truth, or where that is 0 the integral of |f|.
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// What a right estimator's ratio is: 1, or 0 where the truth is 0.
    pub fn right_ratio(&self) -> f64 {
        self.truth / self.unit
    }

    /// The topic it belongs to.
    pub fn topic(&self) -> Topic {
        match self.setup {
            Setup::Exponential { .. } => Topic::Exponential,
            Setup::Rectangle { .. } => Topic::Rectangle,
            Setup::Hemisphere { .. } => Topic::Hemisphere,
            Setup::Roulette { .. } => Topic::Roulette,
            Setup::Bounces { .. } => Topic::Bounces,
            Setup::Furnace { .. } => Topic::Furnace,
            Setup::Paths { .. } => Topic::Paths,
        }
    }
}

/// The probe in a few words: `mean, λ = 0.37`.
impl fmt::Display for Probe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.setup {
            Setup::Exponential { rate, statistic } => write!(f, "{}, λ = {rate}", statistic.name()),
            Setup::Rectangle { rectangle, surface } => {
                let ([a, b], [c, d]) = (rectangle.x_range(), rectangle.y_range());
                write!(f, "f = {} on [{a}, {b}]×[{c}, {d}]", surface.formula())
            }
            Setup::Hemisphere { sky, albedo } => write!(f, "{}, ρ = {albedo}", sky.name()),
            Setup::Roulette { p_rr } => write!(f, "X = ½ + U, p_rr = {p_rr}"),
            Setup::Bounces { p_rr } => write!(f, "p_rr = {p_rr}"),
            Setup::Furnace { albedo, emission, bounces: Some(bounces) } => {
                write!(f, "ρ = {albedo}, L = {emission}, {bounces} bounces")
            }
            Setup::Furnace { albedo, emission, bounces: None } => {
                write!(f, "ρ = {albedo}, L = {emission}, all bounces")
            }
            Setup::Paths { room, bounces } => paths::describe(f, room.scene(), bounces),
        }
    }
}

fn require_chance(p_rr: f64) -> Result<f64> {
    let ok = p_rr > 0.0 && p_rr < 1.0;
    require("the continuation probability p_rr", p_rr, ok, "strictly between 0 and 1")
}
