//! The one formula: ⟨Fₙ⟩ = 1/n Σ f(Xᵢ)/p(Xᵢ).

use rand::distr::Distribution;

use crate::run::Estimator;
use crate::stream::Stream;

/// A probability density that can be drawn from.
///
/// # Contract
/// `pdf` is the density of what `sample` draws: it integrates to 1 over the points that can be drawn and is
/// positive at every one of them. Units are those of 1/\[point\].
pub trait Density: Distribution<Self::Point> + Sync {
    /// What is drawn: a number, a point of the plane, a direction.
    type Point;

    /// The density at `x`; 0 where nothing is drawn.
    fn pdf(&self, x: &Self::Point) -> f64;
}

impl<D: Density + ?Sized> Density for &D
where
    for<'a> &'a D: Distribution<D::Point>,
{
    type Point = D::Point;

    fn pdf(&self, x: &Self::Point) -> f64 {
        (**self).pdf(x)
    }
}

/// The estimator f(X)/p(X) of ∫ f, X drawn from `density`.
///
/// It is unbiased if p > 0 wherever f ≠ 0 and ∫ |f| is finite; its variance is ∫ f²/p − (∫ f)², which is 0
/// exactly when p is proportional to an f of one sign. (Worksheet 2.1, 3.4, 3.5; *Physically Based
/// Rendering*, 4th ed., section 2.1.3.)
///
/// ```
/// use unbiased::{Budget, estimate, hemisphere::Hemisphere, ratio};
///
/// // ∫ cos θ dω over the hemisphere is π; a density in proportion to cos θ has no variance at all
/// let estimate = estimate(&ratio(|w| w.cos_theta(), Hemisphere::Cosine), Budget::Draws(100), 1)?;
/// assert!((estimate.mean() - std::f64::consts::PI).abs() < 1e-14);
/// # Ok::<(), unbiased::Error>(())
/// ```
pub fn ratio<F, D>(f: F, density: D) -> Ratio<F, D>
where
    F: Fn(&D::Point) -> f64 + Sync,
    D: Density,
{
    Ratio { f, density }
}

/// The estimator f(X)/p(X); see [`ratio`].
#[derive(Debug, Clone, Copy)]
pub struct Ratio<F, D> {
    f: F,
    density: D,
}

impl<F, D> Estimator for Ratio<F, D>
where
    F: Fn(&D::Point) -> f64 + Sync,
    D: Density,
{
    #[inline]
    fn draw(&self, rng: &mut Stream) -> f64 {
        let x = self.density.sample(rng);
        rng.count_evaluations(1);
        (self.f)(&x) / self.density.pdf(&x)
    }
}
