//! Section 3: directions above a surface, drawn uniformly or in proportion to cos θ.

use std::f64::consts::{FRAC_1_PI, TAU};

use glam::DVec3;
use rand::Rng;
use rand::distr::{Distribution, StandardUniform};

use crate::error::{Result, require};
use crate::estimator::Density;
use crate::fast::sin_cos_of_turns;

/// A direction: a unit vector (to 2 ulp) in coordinates whose z axis is the surface's normal.
///
/// θ is the angle to the normal, and φ the angle around it, from the x axis towards y. Directions with cos θ
/// < 0 point below the horizon, into the surface.
///
/// ```
/// use unbiased::lambertian::hemisphere::Direction;
///
/// let direction = Direction::new(0.0, 3.0, 4.0)?;
/// assert_eq!((direction.cos_theta(), direction.sin_theta()), (0.8, 0.6));
/// assert_eq!(direction.phi(), std::f64::consts::FRAC_PI_2);
/// # Ok::<(), unbiased::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction(DVec3);

impl Direction {
    /// The direction of the vector (x, y, z), which may have any length but 0.
    ///
    /// # Errors
    /// If a component is NaN or infinite, or all are 0.
    pub fn new(x: f64, y: f64, z: f64) -> Result<Self> {
        for component in [x, y, z] {
            require("a direction's component", component, component.is_finite(), "finite")?;
        }
        let largest = x.abs().max(y.abs()).max(z.abs());
        require("a direction's largest component", largest, largest > 0.0, "other than 0")?;
        // scaling by a power of two is exact, and keeps the squares in f64's range
        let scale = match largest {
            _ if largest > 2f64.powi(500) => 2f64.powi(-600),
            _ if largest < 2f64.powi(-500) => 2f64.powi(600),
            _ => 1.0,
        };
        let vector = DVec3::new(x, y, z) * scale;
        Ok(Self(vector / vector.length()))
    }

    /// The direction with this cos θ and φ (in radians, any number of turns).
    ///
    /// Near the normal, cos θ determines θ to a few digits only; [`Hemisphere::direction_of`] avoids that.
    ///
    /// # Errors
    /// If cos θ is not in \[−1, 1\], or φ not finite.
    pub fn polar(cos_theta: f64, phi: f64) -> Result<Self> {
        require("cos θ", cos_theta, (-1.0..=1.0).contains(&cos_theta), "in [-1, 1]")?;
        require("the angle φ", phi, phi.is_finite(), "finite")?;
        Ok(Self::of(((1.0 - cos_theta) * (1.0 + cos_theta)).sqrt(), cos_theta, phi.sin_cos()))
    }

    #[inline(always)]
    fn of(sin_theta: f64, cos_theta: f64, (sin_phi, cos_phi): (f64, f64)) -> Self {
        Self(DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta))
    }

    /// cos θ, the z component.
    #[inline]
    pub fn cos_theta(&self) -> f64 {
        self.0.z
    }

    /// sin θ = √(x² + y²), accurate near the normal, where √(1 − cos² θ) cancels.
    pub fn sin_theta(&self) -> f64 {
        self.0.x.hypot(self.0.y)
    }

    /// The angle θ to the normal, in [0, π].
    pub fn theta(&self) -> f64 {
        self.sin_theta().atan2(self.0.z)
    }

    /// The angle φ around the normal, in [0, 2π); 0 or π for the normal itself, where it is not defined.
    pub fn phi(&self) -> f64 {
        let phi = self.0.y.atan2(self.0.x);
        // just below 2π the sum would round to 2π; abs turns −0 into 0
        if phi < 0.0 { (phi + TAU).min(TAU.next_down()) } else { phi.abs() }
    }

    /// The vector (x, y, z) of unit length.
    #[inline]
    pub fn vector(&self) -> DVec3 {
        self.0
    }
}

impl From<Direction> for DVec3 {
    fn from(direction: Direction) -> Self {
        direction.0
    }
}

/// The densities of section 3 for directions above a surface, in 1/sr. Both are sampled by inversion from two
/// uniform numbers (U, V), with φ = 2πV:
///
/// | | p(ω) | cos θ | sin θ | P(cos θ ≤ c) | worksheet |
/// |---|---|---|---|---|---|
/// | `Uniform` | 1/(2π) | 1 − U | √(U(2 − U)) | c | 3.4 |
/// | `Cosine` | cos θ/π | √(1 − U) | √U | c² | 3.5 |
///
/// Uniform: the area of a sphere between two heights is proportional to their distance (Archimedes), so cos θ
/// is uniform. Cosine: a uniform point of the unit disc, at radius √U, lifted onto the sphere (Malley;
/// *Physically Based Rendering*, 4th ed., section A.5).
///
/// # Smallest cosine
/// U = k·2⁻⁵³ is never 1, so cos θ is never 0, and f/p with `Cosine` never 0/0. The smallest cos θ is 2⁻⁵³ =
/// 1.1e-16 for `Uniform` and 2⁻²⁶·⁵ = 1.05e-8 for `Cosine`, each with probability 2⁻⁵³. sin θ is computed
/// from U, as √(1 − cos² θ) is 0 for U < 2⁻⁵³ and inaccurate long before.
///
/// ```
/// use rand::distr::Distribution;
/// use unbiased::{Density, Stream, lambertian::hemisphere::Hemisphere};
///
/// let direction = Hemisphere::Cosine.sample(&mut Stream::new(1, 0));
/// assert_eq!(Hemisphere::Cosine.pdf(&direction), direction.cos_theta() * std::f64::consts::FRAC_1_PI);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Hemisphere {
    /// The same for all directions above the horizon: p = 1/(2π).
    Uniform,
    /// Proportional to the cosine of the angle to the normal: p = cos θ/π.
    Cosine,
}

impl Hemisphere {
    /// Both densities.
    pub const ALL: [Self; 2] = [Self::Uniform, Self::Cosine];

    /// The direction for the uniform numbers u and v. u = 0 is the normal and u = 1 the horizon.
    ///
    /// ```
    /// use unbiased::lambertian::hemisphere::Hemisphere;
    ///
    /// let direction = Hemisphere::Cosine.direction_of(0.75, 0.5)?;
    /// assert_eq!(direction.cos_theta(), 0.5);
    /// assert_eq!(direction.phi(), std::f64::consts::PI);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    ///
    /// # Errors
    /// If u or v is not in \[0, 1\].
    pub fn direction_of(self, u: f64, v: f64) -> Result<Direction> {
        require("the uniform number u", u, (0.0..=1.0).contains(&u), "in [0, 1]")?;
        require("the uniform number v", v, (0.0..=1.0).contains(&v), "in [0, 1]")?;
        Ok(self.warp([u, v]))
    }
}

impl Distribution<Direction> for Hemisphere {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> Direction {
        let u = StandardUniform.sample(rng);
        self.warp([u, StandardUniform.sample(rng)])
    }
}

impl Density<2> for Hemisphere {
    type Point = Direction;

    /// The direction of [`direction_of`](Self::direction_of).
    #[inline(always)]
    fn warp(&self, [u, v]: [f64; 2]) -> Direction {
        let (sin_theta, cos_theta) = match self {
            Self::Uniform => ((u * (2.0 - u)).sqrt(), 1.0 - u),
            Self::Cosine => (u.sqrt(), (1.0 - u).sqrt()),
        };
        Direction::of(sin_theta, cos_theta, sin_cos_of_turns(v))
    }

    /// 1/(2π) or cos θ/π, in 1/sr; 0 below the horizon.
    #[inline(always)]
    fn pdf(&self, direction: &Direction) -> f64 {
        let cos_theta = direction.cos_theta();
        match self {
            _ if cos_theta < 0.0 => 0.0,
            Self::Uniform => 0.5 * FRAC_1_PI,
            Self::Cosine => cos_theta * FRAC_1_PI,
        }
    }
}
