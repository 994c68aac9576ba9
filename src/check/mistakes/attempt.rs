//! Estimators to be tried.

use std::fmt;
use std::ops::RangeInclusive;

use super::probe::Setup;
use super::{Probe, Topic, roulette};
use crate::box_room::BoxRoom;
use crate::error::{Error, Result};
use crate::estimator::{Estimator, from_fn};
use crate::hemisphere::Direction;
use crate::rectangle::Rectangle;
use crate::stream::Stream;

/// Someone's estimator, right or wrong, of a given topic.
///
/// ```
/// use unbiased::{Budget, check::{Attempt, Topic}, estimate};
///
/// let attempt = Attempt::exponential(|rate, rng| -(1.0 - rng.uniform()).ln() / rate);
/// for probe in Topic::Exponential.probes() {
///     let estimate = estimate(&attempt.at(probe)?, Budget::Draws(10_000), 1)?;
///     assert!(estimate.z(probe.truth()).unwrap().abs() < 5.0);
/// }
/// # Ok::<(), unbiased::Error>(())
/// ```
pub struct Attempt<'a>(Kind<'a>);

type Sampler<'a> = dyn Fn(f64, &mut Stream) -> f64 + Send + Sync + 'a;
type Integrator<'a> = dyn Fn(&dyn Fn(f64, f64) -> f64, &Rectangle, &mut Stream) -> f64 + Send + Sync + 'a;
type Reflector<'a> = dyn Fn(&dyn Fn(&Direction) -> f64, f64, &mut Stream) -> f64 + Send + Sync + 'a;
type Wrapper<'a> = dyn Fn(&mut dyn FnMut(&mut Stream) -> f64, f64, &mut Stream) -> f64 + Send + Sync + 'a;
type Walker<'a> = dyn Fn(f64, f64, Option<u32>, &mut Stream) -> f64 + Send + Sync + 'a;
type Tracer<'a> = dyn Fn(&BoxRoom, RangeInclusive<u32>, &mut Stream) -> f64 + Send + Sync + 'a;

enum Kind<'a> {
    Exponential(Box<Sampler<'a>>),
    Rectangle(Box<Integrator<'a>>),
    Hemisphere(Box<Reflector<'a>>),
    Roulette(Box<Wrapper<'a>>),
    Bounces(Box<Sampler<'a>>),
    Furnace(Box<Walker<'a>>),
    Paths(Box<Tracer<'a>>),
}

impl<'a> Attempt<'a> {
    /// (λ, random numbers) → one sample of the exponential distribution.
    pub fn exponential(draw: impl Fn(f64, &mut Stream) -> f64 + Send + Sync + 'a) -> Self {
        Self(Kind::Exponential(Box::new(draw)))
    }

    /// (f, rectangle, random numbers) → one draw of an estimate of ∫∫ f.
    pub fn rectangle(
        draw: impl Fn(&dyn Fn(f64, f64) -> f64, &Rectangle, &mut Stream) -> f64 + Send + Sync + 'a,
    ) -> Self {
        Self(Kind::Rectangle(Box::new(draw)))
    }

    /// (incoming radiance, ρ, random numbers) → one draw of an estimate of the reflected radiance.
    pub fn hemisphere(
        draw: impl Fn(&dyn Fn(&Direction) -> f64, f64, &mut Stream) -> f64 + Send + Sync + 'a,
    ) -> Self {
        Self(Kind::Hemisphere(Box::new(draw)))
    }

    /// (X, p_rr, random numbers) → one draw of X_rr, where `X(random numbers)` draws X.
    pub fn roulette(
        draw: impl Fn(&mut dyn FnMut(&mut Stream) -> f64, f64, &mut Stream) -> f64 + Send + Sync + 'a,
    ) -> Self {
        Self(Kind::Roulette(Box::new(draw)))
    }

    /// (p_rr, random numbers) → one draw of the number of bounces N.
    pub fn bounces(draw: impl Fn(f64, &mut Stream) -> f64 + Send + Sync + 'a) -> Self {
        Self(Kind::Bounces(Box::new(draw)))
    }

    /// (ρ, L, bounces, random numbers) → one draw of an estimate of the light after that many bounces, or all of them (`None`).
    pub fn furnace(draw: impl Fn(f64, f64, Option<u32>, &mut Stream) -> f64 + Send + Sync + 'a) -> Self {
        Self(Kind::Furnace(Box::new(draw)))
    }

    /// (room, bounces, random numbers) → one draw of an estimate of the light that leaves the room's point p after so many bounces, the first and the last
    /// counted in: `2..=2` is the light of exactly two, `0..=3` that of up to three. The room says where p is, what emits and what the albedos are.
    ///
    /// ```
    /// use unbiased::check::Attempt;
    /// use unbiased::hemisphere::Hemisphere;
    /// use unbiased::paths::{Bounces, FindLight, Paths};
    ///
    /// let attempt = Attempt::paths(|room, bounces, rng| {
    ///     let (first, last) = bounces.into_inner();
    ///     let bounces = if first == last { Bounces::Exactly(last) } else { Bounces::UpTo(last) };
    ///     Paths::new(*room, bounces, Hemisphere::Cosine, FindLight::BySampling)
    ///         .map_or(f64::NAN, |paths| paths.light_from(&room.point(), rng))
    /// });
    /// # let _ = attempt;
    /// ```
    pub fn paths(
        draw: impl Fn(&BoxRoom, RangeInclusive<u32>, &mut Stream) -> f64 + Send + Sync + 'a,
    ) -> Self {
        Self(Kind::Paths(Box::new(draw)))
    }

    /// The topic it belongs to.
    pub fn topic(&self) -> Topic {
        match self.0 {
            Kind::Exponential(_) => Topic::Exponential,
            Kind::Rectangle(_) => Topic::Rectangle,
            Kind::Hemisphere(_) => Topic::Hemisphere,
            Kind::Roulette(_) => Topic::Roulette,
            Kind::Bounces(_) => Topic::Bounces,
            Kind::Furnace(_) => Topic::Furnace,
            Kind::Paths(_) => Topic::Paths,
        }
    }

    /// The attempt on a probe, as an estimator of [`Probe::truth`].
    ///
    /// # Errors
    /// If the probe belongs to another topic.
    pub fn at<'p>(&'p self, probe: &'p Probe) -> Result<impl Estimator + 'p> {
        if self.topic() == probe.topic() {
            Ok(from_fn(|rng| self.draw(probe, rng)))
        } else {
            let (attempt, probe) = (self.topic(), probe.topic());
            Err(Error::Usage(format!("an attempt at “{attempt}” cannot be tried on a probe of “{probe}”")))
        }
    }

    fn draw(&self, probe: &Probe, rng: &mut Stream) -> f64 {
        match (&self.0, probe.setup) {
            (Kind::Exponential(draw), Setup::Exponential { rate, statistic }) => {
                statistic.of(draw(rate, rng), rate)
            }
            (Kind::Rectangle(draw), Setup::Rectangle { rectangle, surface }) => {
                draw(&|x, y| surface.at(x, y), &rectangle, rng)
            }
            (Kind::Hemisphere(draw), Setup::Hemisphere { sky, albedo }) => {
                draw(&|direction| sky.radiance(direction), albedo, rng)
            }
            (Kind::Roulette(draw), Setup::Roulette { p_rr }) => draw(&mut roulette::x, p_rr, rng),
            (Kind::Bounces(draw), Setup::Bounces { p_rr }) => draw(p_rr, rng),
            (Kind::Furnace(draw), Setup::Furnace { albedo, emission, bounces }) => {
                draw(albedo, emission, bounces, rng)
            }
            (Kind::Paths(draw), Setup::Paths { room, bounces: [first, last] }) => {
                draw(&room, first..=last, rng)
            }
            _ => f64::NAN,
        }
    }
}

impl fmt::Debug for Attempt<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Attempt").field(&self.topic()).finish()
    }
}
