//! Ratios of means to the truth.

use crate::estimate::Estimate;

/// A mean divided by a probe's scale, with its std error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ratio {
    /// The ratio.
    pub mean: f64,
    /// Its std error; 0 if all draws are equal.
    pub error: f64,
}

/// Ratios that differ by less than this are not told apart with the usual numbers of draws.
const ALIKE: f64 = 1e-3;

/// Two means found with Sobol points differ if they are this many std errors apart.
pub(super) const APART: f64 = 6.0;

impl Ratio {
    pub(super) const UNKNOWN: Self = Self { mean: f64::NAN, error: 0.0 };

    pub(super) const fn exact(mean: f64) -> Self {
        Self { mean, error: 0.0 }
    }

    pub(super) fn of(estimate: &Estimate, scale: f64) -> Self {
        Self { mean: estimate.mean() / scale, error: estimate.std_error().unwrap_or(f64::INFINITY) / scale }
    }

    pub(super) fn times(self, factor: f64) -> Self {
        Self { mean: factor * self.mean, error: factor.abs() * self.error }
    }

    /// Whether it differs from `other` by enough for draws to show it.
    pub(super) fn differs(self, other: Self) -> bool {
        let size = self.mean.abs().min(other.mean.abs()).max(1.0);
        let known = APART * self.error.hypot(other.error);
        let alike = (self.mean - other.mean).abs() <= known.max(ALIKE * size);
        !alike
    }

    /// Whether draws with this ratio vary: then its std error over the point sets is not just rounding.
    pub(super) fn varies(self) -> bool {
        self.error > 1e-13 * self.mean.abs()
    }
}
