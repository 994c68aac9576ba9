//! Section 2: integrals over a rectangle, estimated from uniform random points.
//!
//! Each of these is an unbiased [`Estimator`] of ∫∫ f(x, y) dx dy over [a, b] × [c, d], with area A = (b −
//! a)(d − c), if ∫∫ |f| is finite. Its error bar is valid if ∫∫ f² is finite, too.
//!
//! | estimator | one draw | evaluations |
//! |---|---|---|
//! | [`f_over_p`](crate::f_over_p)`(f, rectangle)` | f(X, Y)/p(X, Y) | 1 |
//! | [`Rectangle::independent`] | A f(X, Y), the same simplified | 1 |
//! | [`Rectangle::all_pairs`] | A/n² Σᵢ Σⱼ f(Xᵢ, Yⱼ) | n² |
//! | [`Rectangle::jittered`] | A/s² Σ f, one point in each cell of an s × s grid | s² |
//! | [`Rectangle::sobol`] | A/n Σ f over a scrambled Sobol set of n points | n |
//!
//! The points of the last three depend on each other. So one draw is a whole replicate with new random
//! numbers: draws are independent, and their error bar is valid.
//!
//! `examples/check_mine.rs` checks your own estimator for question 2.1.

#[cfg(feature = "workbook")]
pub mod figures;
mod genz;
mod integrand;
pub mod mistakes;
#[cfg(feature = "workbook")]
pub(crate) mod questions;
mod replicate;

pub use genz::{Family, Genz};
pub use integrand::Integrand;

use rand::Rng;
use rand::distr::{Distribution, StandardUniform};

use crate::error::{Result, require};
use crate::estimator::{Density, Estimator, from_uniforms};

/// The rectangle [a, b] × [c, d], and the uniform distribution on it.
///
/// X and Y are drawn independently, so their joint density is the product of the two: p(x, y) = p(x) p(y) =
/// 1/(b − a) · 1/(d − c) inside, in 1/\[x y\], and 0 outside. (Worksheet 2.1.)
///
/// Rounding never puts X = a + (b − a)U outside: X = a has probability 2⁻⁵³, and X = b is drawn only if b −
/// 2⁻⁵³(b − a) rounds to b. X is accurate to the last place of the larger of a and X.
///
/// ```
/// use unbiased::{Budget, estimate, f_over_p, rectangle::Rectangle};
///
/// // ∫∫ x² + y² over the sheet's square [−2, 2]², where p = 1/16, is 128/3
/// let estimator = f_over_p(|[x, y]| x * x + y * y, Rectangle::WORKSHEET);
/// let estimate = estimate(&estimator, Budget::Draws(100_000), 1)?;
/// assert!(estimate.z(128.0 / 3.0).unwrap().abs() < 5.0);
/// # Ok::<(), unbiased::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    x: [f64; 2],
    y: [f64; 2],
    width: f64,
    height: f64,
    area: f64,
    density: f64,
}

impl Rectangle {
    /// The square of worksheet 2.1, [−2, 2]².
    pub const WORKSHEET: Self =
        Self { x: [-2.0, 2.0], y: [-2.0, 2.0], width: 4.0, height: 4.0, area: 16.0, density: 1.0 / 16.0 };

    /// The rectangle of all (x, y) with a ≤ x ≤ b and c ≤ y ≤ d.
    ///
    /// ```
    /// use unbiased::rectangle::Rectangle;
    ///
    /// assert_eq!(Rectangle::new([0.3, 2.0], [-1.1, 3.0])?.area(), 1.7 * 4.1);
    /// let error = Rectangle::new([2.0, -2.0], [-2.0, 2.0]).unwrap_err();
    /// assert_eq!(error.to_string(), "the end b of [a, b] must be finite and above a, not -2");
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    ///
    /// # Errors
    /// If an end is not finite, a ≥ b, c ≥ d, or the width, the height, the area or 1/area is outside `f64`'s
    /// normal range, where digits are lost.
    pub fn new([a, b]: [f64; 2], [c, d]: [f64; 2]) -> Result<Self> {
        require("the end a of [a, b]", a, a.is_finite(), "finite")?;
        require("the end b of [a, b]", b, b > a && b.is_finite(), "finite and above a")?;
        require("the end c of [c, d]", c, c.is_finite(), "finite")?;
        require("the end d of [c, d]", d, d > c && d.is_finite(), "finite and above c")?;
        let [width, height] = [b - a, d - c];
        require("the width b − a", width, width.is_normal(), NORMAL)?;
        require("the height d − c", height, height.is_normal(), NORMAL)?;
        let area = width * height;
        let density = 1.0 / area;
        require("the area", area, area.is_normal() && density.is_normal(), "from 2.3e-308 to 4.4e307")?;
        Ok(Self { x: [a, b], y: [c, d], width, height, area, density })
    }

    /// A = (b − a)(d − c).
    pub fn area(&self) -> f64 {
        self.area
    }

    /// [a, b].
    pub fn x_range(&self) -> [f64; 2] {
        self.x
    }

    /// [c, d].
    pub fn y_range(&self) -> [f64; 2] {
        self.y
    }

    /// The estimator A f(X, Y) of ∫∫ f: [`f_over_p`](crate::f_over_p)`(f, rectangle)` with the constant
    /// density 1/A taken out of the sum.
    ///
    /// On the sheet's square its mean after n draws is ⟨Fₙ⟩ = 16/n Σ f(Xᵢ, Yᵢ). The variance of a draw is A
    /// ∫∫ f² − (∫∫ f)².
    ///
    /// ```
    /// use unbiased::{Budget, estimate, rectangle::Rectangle};
    ///
    /// // volume under e^(−x²−y²): π erf(2)²
    /// let bell = Rectangle::WORKSHEET.independent(|x, y| (-x * x - y * y).exp());
    /// let estimate = estimate(&bell, Budget::Draws(100_000), 1)?;
    /// assert!(estimate.z(3.1122703197174722).unwrap().abs() < 5.0);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    pub fn independent<F: Fn(f64, f64) -> f64 + Sync>(self, f: F) -> impl Estimator {
        from_uniforms(move |u| {
            let [x, y] = self.warp(u);
            self.area * f(x, y)
        })
    }

    #[inline(always)]
    fn x_at(&self, u: f64) -> f64 {
        let [a, b] = self.x;
        let x = a + u * self.width;
        // never outside: rounding in the last cell of a grid can give u = 1, and a + (b − a) can round to
        // more than b
        if x < b { x } else { b }
    }

    #[inline(always)]
    fn y_at(&self, v: f64) -> f64 {
        let [c, d] = self.y;
        let y = c + v * self.height;
        if y < d { y } else { d }
    }
}

const NORMAL: &str = "in f64's normal range, from 2.3e-308 to 1.7e308";

impl Distribution<[f64; 2]> for Rectangle {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> [f64; 2] {
        let u = StandardUniform.sample(rng);
        self.warp([u, StandardUniform.sample(rng)])
    }
}

impl Density<2> for Rectangle {
    type Point = [f64; 2];

    /// The point that lies at the fraction (u, v) of width and height.
    #[inline(always)]
    fn warp(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [self.x_at(u), self.y_at(v)]
    }

    #[inline(always)]
    fn pdf(&self, &[x, y]: &[f64; 2]) -> f64 {
        let ([a, b], [c, d]) = (self.x, self.y);
        if (a..=b).contains(&x) && (c..=d).contains(&y) { self.density } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn u_of_one_is_not_rounded_past_the_end() {
        let mut past = 0;
        for i in 1..10_000 {
            let (a, b) = (-0.5 - f64::from(i) / 2e4, 0.3 * f64::EPSILON);
            past += usize::from(a + (b - a) > b);
            let r = Rectangle::new([a, b], [-b, -a]).unwrap();
            assert!(r.x_at(1.0) <= b && r.y_at(1.0) <= -a, "[{a:?}, {b:?}]");
        }
        assert!(past > 0, "none of these needed the guard");
    }
}
