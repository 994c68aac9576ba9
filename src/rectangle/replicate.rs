//! Estimators whose draw is a whole set of points that depend on each other.

use super::Rectangle;
use crate::error::{Result, require_count};
use crate::estimator::{Estimator, from_fn};
use crate::placement::{jittered, sobol};

impl Rectangle {
    /// The estimator A/n² Σᵢ Σⱼ f(Xᵢ, Yⱼ) over all n² pairs of n values of x and n of y.
    ///
    /// The sheet's 2n values give n independent pairs, or n² dependent ones. The estimator is unbiased, as
    /// every single pair is uniform, but its variance does not fall as 1/n². It is A² \[σ² + (n − 1)(σ_x² +
    /// σ_y²)\]/n² with σ² = Var f(X, Y), σ_x² = Var E\[f|X\] and σ_y² = Var E\[f|Y\] (Efron & Stein 1981;
    /// [`Integrand::all_pairs_variance`](super::Integrand::all_pairs_variance)). The n independent pairs have
    /// A² σ²/n, which is never less. The two are equal for f(x, y) = g(x) + h(y), as then σ² = σ_x² + σ_y².
    ///
    /// ```
    /// use unbiased::{Budget, Run, rectangle::Rectangle};
    ///
    /// let bell = Rectangle::WORKSHEET.all_pairs(|x, y| (-x * x - y * y).exp(), 32)?;
    /// let outcome = Run::new(1).estimate(&bell, Budget::Draws(1000))?;
    /// assert_eq!(outcome.cost.random_numbers, 1000 * 2 * 32);
    /// assert_eq!(outcome.cost.evaluations, 1000 * 32 * 32);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    ///
    /// # Errors
    /// If n is not from 1 to 2¹⁶.
    pub fn all_pairs<F: Fn(f64, f64) -> f64 + Sync>(self, f: F, n: u64) -> Result<impl Estimator> {
        // a draw is 2³² evaluations at most
        let ok = (1..=1 << 16).contains(&n);
        let n = require_count("the number n of values", n, ok, "from 1 to 65536")? as u32;
        let evaluations = u64::from(n) * u64::from(n);
        Ok(from_fn(move |rng| {
            let xs: Vec<f64> = (0..n).map(|_| self.x_at(rng.uniform())).collect();
            let mut mean = Mean::new(self.area, evaluations);
            for _ in 0..n {
                let y = self.y_at(rng.uniform());
                for &x in &xs {
                    mean.add(f(x, y));
                }
            }
            rng.count_evaluations(evaluations);
            mean.times_area()
        }))
    }

    /// The estimator A/s² Σ f over one uniform point in each cell of an s × s grid: [`jittered`] points for
    /// [`independent`](Self::independent).
    ///
    /// Only the variance *within* the cells is left, A²/s⁴ Σ Var f(cell).
    ///
    /// # Errors
    /// If the side s is not from 1 to 256.
    pub fn jittered<F: Fn(f64, f64) -> f64 + Sync>(self, f: F, side: u64) -> Result<impl Estimator> {
        jittered(self.independent(f), side)
    }

    /// The estimator A/n Σ f over a scrambled Sobol set of n points: [`sobol`] points for
    /// [`independent`](Self::independent).
    ///
    /// ```
    /// use unbiased::{Budget, estimate, rectangle::Rectangle};
    ///
    /// let bell = Rectangle::WORKSHEET.sobol(|x, y| (-x * x - y * y).exp(), 1024)?;
    /// let estimate = estimate(&bell, Budget::Draws(100), 1)?;
    /// assert!(estimate.z(3.1122703197174722).unwrap().abs() < 5.0);
    /// assert!(estimate.std_error().unwrap() < 2e-4); // 1024 × 100 independent points: 0.012
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    ///
    /// # Errors
    /// If n is not from 1 to 2¹⁶, after which the sequence would repeat.
    pub fn sobol<F: Fn(f64, f64) -> f64 + Sync>(self, f: F, points: u64) -> Result<impl Estimator> {
        sobol(self.independent(f), points)
    }
}

/// The mean A/n Σ f of a replicate, by compensated summation (Neumaier 1974): accurate for 2³² terms.
///
/// Terms are first scaled by the power of two below A/n, which is exact, so the sum overflows only where the
/// result does.
struct Mean {
    area: f64,
    points: f64,
    scale: f64,
    sum: f64,
    lost: f64,
}

impl Mean {
    fn new(area: f64, points: u64) -> Self {
        const EXPONENT: u64 = 0x7ff << 52;
        let points = points as f64;
        let scale = f64::from_bits((area / points).to_bits() & EXPONENT).max(f64::MIN_POSITIVE);
        Self { area, points, scale, sum: 0.0, lost: 0.0 }
    }

    #[inline]
    fn add(&mut self, f: f64) {
        let term = f * self.scale;
        let sum = self.sum + term;
        let added = sum - self.sum;
        self.lost += (self.sum - (sum - added)) + (term - added);
        self.sum = sum;
    }

    fn times_area(self) -> f64 {
        // an infinite term makes `lost` NaN: return the infinity itself
        let sum = if self.sum.is_finite() { self.sum + self.lost } else { self.sum };
        sum / self.points * (self.area / self.scale)
    }
}
