//! Section 3: radiance reflected by a diffuse surface.
//!
//! Every integral is L_r = ∫ f_r L_i cos θ dω over the directions above the surface, with f_r = ρ/π.
//! [`Lambertian`] has its estimators for any incoming radiance L_i. A [`Light`] is an L_i for which L_r and
//! the variance of each estimator are known exactly.
//!
//! `examples/check_mine.rs` checks your own estimator for question 3.5.

#[cfg(feature = "workbook")]
pub mod figures;
pub mod hemisphere;
pub mod mistakes;
#[cfg(feature = "workbook")]
pub(crate) mod questions;

use std::f64::consts::PI;

use crate::error::{Result, require};
use crate::estimator::{Density, Estimator, f_over_p, from_uniforms};
use crate::float::Extended;
use crate::lambertian::hemisphere::{Direction, Hemisphere};

/// A diffuse surface with BRDF f_r = ρ/π: it reflects the fraction ρ of the incoming power, with the same
/// radiance in all directions.
///
/// The reflected radiance is linear in the albedo ρ and does not depend on the viewing direction (3.3). The
/// surface emits nothing (3.1), so the outgoing radiance is L_r alone. (Worksheet 3; *Physically Based
/// Rendering*, 4th ed., section 9.2.)
///
/// Incoming radiance is any function of the direction it comes from, in W m⁻² sr⁻¹; results are in the same
/// unit.
///
/// ```
/// use unbiased::{Budget, estimate, lambertian::Lambertian};
///
/// // 3.5 with incoming radiance 10 W m⁻² sr⁻¹ from one half of the sky
/// let surface = Lambertian::new(0.61)?;
/// let half = surface.cosine_estimator(|direction| if direction.vector().x > 0.0 { 10.0 } else { 0.0 });
/// let estimate = estimate(&half, Budget::Draws(100_000), 1)?;
/// assert!(estimate.z(0.61 * 10.0 / 2.0).unwrap().abs() < 5.0);
/// # Ok::<(), unbiased::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lambertian {
    albedo: f64,
}

impl Lambertian {
    /// A surface of albedo ρ.
    ///
    /// ```
    /// let error = unbiased::lambertian::Lambertian::new(1.2).unwrap_err();
    /// let sentence = "the albedo ρ must be between 0 and 1 (above 1 it would create energy), not 1.2";
    /// assert_eq!(error.to_string(), sentence);
    /// ```
    ///
    /// # Errors
    /// If ρ is not between 0 and 1: above 1 the surface would create energy.
    pub fn new(albedo: f64) -> Result<Self> {
        let ok = (0.0..=1.0).contains(&albedo);
        let allowed = "between 0 and 1 (above 1 it would create energy)";
        Ok(Self { albedo: require("the albedo ρ", albedo, ok, allowed)? })
    }

    /// The albedo ρ.
    pub fn albedo(self) -> f64 {
        self.albedo
    }

    /// The BRDF f_r = ρ/π, in 1/sr, the same for every pair of directions.
    pub fn brdf(self) -> f64 {
        self.albedo / PI
    }

    /// The emitted radiance L_e = 0 (worksheet 3.1).
    pub fn emitted(self) -> f64 {
        0.0
    }

    /// L_r = ρ L_i, for the same incoming radiance L_i from all directions (worksheet 3.2).
    pub fn reflected(self, radiance: f64) -> f64 {
        self.albedo * radiance
    }

    /// The estimator f_r L_i cos θ/p(ω) of L_r with directions drawn from any `density`.
    /// [`uniform_estimator`](Self::uniform_estimator) and [`cosine_estimator`](Self::cosine_estimator) are
    /// its simplified forms for two densities.
    ///
    /// Directions below the horizon contribute 0, so a density over the whole sphere works, too.
    pub fn estimator<const N: usize, L, D>(self, light: L, density: D) -> impl Estimator
    where
        L: Fn(&Direction) -> f64 + Sync,
        D: Density<N, Point = Direction>,
    {
        let brdf = self.brdf();
        let integrand = move |direction: &Direction| {
            let cos_theta = direction.cos_theta();
            if cos_theta > 0.0 { brdf * light(direction) * cos_theta } else { 0.0 }
        };
        f_over_p(integrand, density)
    }

    /// The estimator 2ρ L_i cos θ of L_r, directions drawn uniformly (worksheet 3.4).
    pub fn uniform_estimator<L: Fn(&Direction) -> f64 + Sync>(self, light: L) -> impl Estimator {
        from_uniforms(move |u| {
            let direction = Hemisphere::Uniform.warp(u);
            2.0 * self.albedo * light(&direction) * direction.cos_theta()
        })
    }

    /// The estimator ρ L_i of L_r, directions drawn in proportion to cos θ (worksheet 3.5). The directions
    /// must be *drawn* from that density: with uniform ones this formula is right if L_i does not depend on
    /// θ, but wrong in general.
    pub fn cosine_estimator<L: Fn(&Direction) -> f64 + Sync>(self, light: L) -> impl Estimator {
        from_uniforms(move |u| self.albedo * light(&Hemisphere::Cosine.warp(u)))
    }
}

/// Incoming radiance for which the reflected radiance and the variance of each estimator have a closed form
/// (worksheet 3.6).
///
/// ```
/// use unbiased::lambertian::hemisphere::Hemisphere::{Cosine, Uniform};
/// use unbiased::lambertian::{CosinePower, Lambertian, Light, RingLight};
///
/// let white = Lambertian::new(1.0)?;
/// let even = CosinePower::new(0.0)?; // constant: cosine directions have no variance
/// assert_eq!((even.variance(white, Uniform), even.variance(white, Cosine)), (1.0 / 3.0, 0.0));
/// let ring = RingLight::new(0.1)?; // along the horizon: cosine directions have 8 times the variance
/// let times = ring.variance(white, Cosine) / ring.variance(white, Uniform);
/// assert!((times - 297.0 / 37.0).abs() < 1e-14);
/// # Ok::<(), unbiased::Error>(())
/// ```
pub trait Light: Sync {
    /// The incoming radiance L_i from `direction`; 0 from below the horizon.
    fn incoming(&self, direction: &Direction) -> f64;

    /// The radiance L_r = ∫ f_r L_i cos θ dω that `surface` reflects.
    fn reflected(&self, surface: Lambertian) -> f64;

    /// The variance of one draw f_r L_i cos θ/p, with p = `hemisphere`; +∞ if it is infinite.
    fn variance(&self, surface: Lambertian, hemisphere: Hemisphere) -> f64;
}

/// L_i = cos^a θ with a > −2: brighter overhead for a > 0, brighter along the horizon for a < 0, and constant
/// for a = 0.
///
/// | | value | finite for |
/// |---|---|---|
/// | L_r | 2ρ/(a+2) | a > −2 |
/// | variance, uniform | 4ρ² (a+1)²/((2a+3)(a+2)²) | a > −3/2 |
/// | variance, cosine | ρ² a²/((a+1)(a+2)²) | a > −1 |
///
/// So neither density is always better. The variance of cosine directions is 0 at a = 0, that of uniform ones
/// is 0 at a = −1, where the other is infinite, and they are equal at a = −1/2. The forms 4ρ²\[1/(2a+3) −
/// 1/(a+2)²\] and ρ²\[1/(a+1) − 4/(a+2)²\] are the same, but cancel.
///
/// # Directions left out
/// No direction has a cos θ below the smallest one of [`Hemisphere`]. A fraction 2^(−53(a+2)) of L_r is left
/// out with uniform directions and 2^(−26.5(a+2)) with cosine ones. This is less than 1.1e-8 wherever the
/// variance is finite, but 2.5 % and 16 % at a = −1.9.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CosinePower {
    a: f64,
}

impl CosinePower {
    /// Incoming radiance L_i = cos^a θ.
    ///
    /// # Errors
    /// If a is not finite, or not above −2, below which the reflected radiance is infinite.
    pub fn new(a: f64) -> Result<Self> {
        let ok = a > -2.0 && a.is_finite();
        Ok(Self { a: require("the exponent a", a, ok, "above -2 and finite")? })
    }

    /// The exponent a.
    pub fn a(self) -> f64 {
        self.a
    }
}

impl Light for CosinePower {
    #[inline]
    fn incoming(&self, direction: &Direction) -> f64 {
        let cos_theta = direction.cos_theta();
        if cos_theta > 0.0 { cos_theta.powf(self.a) } else { 0.0 }
    }

    fn reflected(&self, surface: Lambertian) -> f64 {
        2.0 * surface.albedo / (self.a + 2.0)
    }

    fn variance(&self, surface: Lambertian, hemisphere: Hemisphere) -> f64 {
        let [a, one, half] = [self.a, 1.0, 0.5].map(Extended::from);
        // the variance is (ρ zero/(a + 2))²/room
        let (zero, room) = match hemisphere {
            Hemisphere::Uniform => (a + one, half * (a + one + half)),
            Hemisphere::Cosine => (a, a + one),
        };
        let deviation = zero * surface.albedo.into() / (a + one + one);
        if deviation.is_zero() {
            0.0 // for ρ = 0 even where the formula is infinite
        } else if room.is_positive() {
            (deviation.squared() / room).round()
        } else {
            f64::INFINITY
        }
    }
}

/// L_i = 1 where 0 < cos θ ≤ ε, and 0 elsewhere: a ring along the horizon, with 0 < ε ≤ 1.
///
/// L_r = ρε²; the variance is ρ²(4ε³/3 − ε⁴) with uniform directions and ρ²ε²(1 − ε²) with cosine ones.
/// Cosine's is the larger for ε < 3/4: 297/37 = 8.03 times at ε = 0.1.
///
/// The edge cos θ = ε belongs to the ring, so ε = 1 is constant incoming radiance, the normal included.
/// Cosine directions have cos θ ≥ 1.05e-8, so they miss any narrower ring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingLight {
    width: f64,
}

impl RingLight {
    /// The ring up to cos θ = ε.
    ///
    /// # Errors
    /// If ε is not in (0, 1\].
    pub fn new(width: f64) -> Result<Self> {
        let ok = width > 0.0 && width <= 1.0;
        Ok(Self { width: require("the ring's width ε", width, ok, "above 0 and at most 1")? })
    }

    /// The width ε.
    pub fn width(self) -> f64 {
        self.width
    }
}

impl Light for RingLight {
    #[inline]
    fn incoming(&self, direction: &Direction) -> f64 {
        let cos_theta = direction.cos_theta();
        if cos_theta > 0.0 && cos_theta <= self.width { 1.0 } else { 0.0 }
    }

    fn reflected(&self, surface: Lambertian) -> f64 {
        let width = Extended::from(self.width);
        (width.squared() * surface.albedo.into()).round()
    }

    fn variance(&self, surface: Lambertian, hemisphere: Hemisphere) -> f64 {
        let [albedo, width, three] = [surface.albedo, self.width, 3.0].map(Extended::from);
        let square = (albedo * width).squared();
        let variance = match hemisphere {
            Hemisphere::Uniform => square * width * (Extended::ONE + three - three * width) / three,
            Hemisphere::Cosine => square * (Extended::ONE - width.squared()),
        };
        variance.round()
    }
}
