//! Genz's six families of integrands in two dimensions: each is difficult in one way, and has a closed form.

use std::f64::consts::TAU;

use super::integrand::bell;
use crate::error::{Result, require};

/// Genz's families, named after what makes them difficult.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Family {
    /// cos(2πw₁ + a₁x + a₂y)
    Oscillatory,
    /// 1/((a₁⁻² + (x − w₁)²)(a₂⁻² + (y − w₂)²))
    ProductPeak,
    /// (1 + a₁x + a₂y)⁻³
    CornerPeak,
    /// e^(−a₁²(x − w₁)² − a₂²(y − w₂)²)
    Gaussian,
    /// e^(−a₁|x − w₁| − a₂|y − w₂|): continuous, with a kink
    Continuous,
    /// e^(a₁x + a₂y) where x ≤ w₁ and y ≤ w₂, else 0
    Discontinuous,
}

impl Family {
    /// All six.
    pub const ALL: [Self; 6] = [
        Self::Oscillatory,
        Self::ProductPeak,
        Self::CornerPeak,
        Self::Gaussian,
        Self::Continuous,
        Self::Discontinuous,
    ];
}

/// An integrand of one of the families over the unit square, with steepness a = (a₁, a₂) and position w =
/// (w₁, w₂).
///
/// (A. Genz, "Testing multidimensional integration routines", 1984.)
///
/// ```
/// use unbiased::rectangle::{Family, Genz, Rectangle};
/// use unbiased::{Budget, estimate};
///
/// let peak = Genz::new(Family::CornerPeak, [5.0, 3.0], [0.3, 0.6])?;
/// let square = Rectangle::new([0.0, 1.0], [0.0, 1.0])?;
/// let found = estimate(&square.independent(|x, y| peak.at(x, y)), Budget::Draws(100_000), 1)?;
/// assert!(found.z(peak.integral()).unwrap().abs() < 5.0);
/// # Ok::<(), unbiased::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Genz {
    family: Family,
    a: [f64; 2],
    w: [f64; 2],
}

impl Genz {
    /// The integrand.
    ///
    /// # Errors
    /// If an a is not in \[0.01, 100\], where the closed forms are accurate, or a w not in \[0, 1\].
    pub fn new(family: Family, a: [f64; 2], w: [f64; 2]) -> Result<Self> {
        for a in a {
            require("Genz's a", a, (0.01..=100.0).contains(&a), "from 0.01 to 100")?;
        }
        for w in w {
            require("Genz's w", w, (0.0..=1.0).contains(&w), "in [0, 1]")?;
        }
        Ok(Self { family, a, w })
    }

    /// f(x, y).
    #[inline]
    pub fn at(&self, x: f64, y: f64) -> f64 {
        let Self { family, a: [a, b], w: [u, v] } = *self;
        match family {
            Family::Oscillatory => (TAU * u + a * x + b * y).cos(),
            Family::ProductPeak => {
                ((1.0 / (a * a) + (x - u) * (x - u)) * (1.0 / (b * b) + (y - v) * (y - v))).recip()
            }
            Family::CornerPeak => (1.0 + a * x + b * y).powi(-3),
            Family::Gaussian => (-(a * (x - u)).powi(2) - (b * (y - v)).powi(2)).exp(),
            Family::Continuous => (-a * (x - u).abs() - b * (y - v).abs()).exp(),
            Family::Discontinuous if x > u || y > v => 0.0,
            Family::Discontinuous => (a * x + b * y).exp(),
        }
    }

    /// ∫∫ f over the unit square.
    pub fn integral(&self) -> f64 {
        let Self { family, a: [a, b], w: [u, v] } = *self;
        match family {
            // the mean of e^(iax) over [0, 1] is e^(ia/2) sin(a/2)/(a/2)
            Family::Oscillatory => {
                let mean = |a: f64| (0.5 * a).sin() / (0.5 * a);
                (TAU * u + 0.5 * (a + b)).cos() * mean(a) * mean(b)
            }
            Family::ProductPeak => {
                let side = |a: f64, w: f64| a * ((a * (1.0 - w)).atan() + (a * w).atan());
                side(a, u) * side(b, v)
            }
            // [1 − 1/(1 + a) − 1/(1 + b) + 1/(1 + a + b)]/(2ab), of which the bracket is ab(2 + a + b)/((1 +
            // a)(1 + b)(1 + a + b))
            Family::CornerPeak => 0.5 * (2.0 + a + b) / ((1.0 + a) * (1.0 + b) * (1.0 + a + b)),
            Family::Gaussian => {
                let side = |a: f64, w: f64| bell(1.0, [-a * w, a * (1.0 - w)]) / a;
                side(a, u) * side(b, v)
            }
            Family::Continuous => {
                let side = |a: f64, w: f64| -((-a * w).exp_m1() + (-a * (1.0 - w)).exp_m1()) / a;
                side(a, u) * side(b, v)
            }
            Family::Discontinuous => (a * u).exp_m1() / a * ((b * v).exp_m1() / b),
        }
    }
}
