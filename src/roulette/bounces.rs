//! The number of bounces N: its distribution in closed form, and two ways to sample it.

use rand::Rng;
use rand::distr::{Distribution, StandardUniform};

use super::{P_RR, coin, one_minus_power, power};
use crate::error::{Result, require};
use crate::estimator::{Estimator, from_uniforms};
use crate::fast;
use crate::float::Extended;
use crate::stream::Stream;

/// The distribution of the number of bounces N ≥ 0 of a path that goes on with probability p_rr after each:
/// P(N = k) = p_rrᵏ (1 − p_rr).
///
/// This is the geometric distribution that counts *failures* before the first success, where success ends the
/// path with probability 1 − p_rr. Some libraries use the same name for the number of *trials*, N + 1. At
/// p_rr = 1 a path never ends: N is infinite, and every P(N = k) is 0. (Worksheet 5.1 to 5.3.)
///
/// ```
/// use unbiased::roulette::Roulette;
///
/// let bounces = Roulette::new(0.75)?.bounces();
/// assert_eq!(bounces.pmf(0), 1.0 / 4.0);
/// assert_eq!(bounces.pmf(2), 9.0 / 64.0);
/// assert_eq!(bounces.mean(), 3.0);
/// # Ok::<(), unbiased::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BounceCount {
    pub(super) p_rr: f64,
}

impl BounceCount {
    /// P(N = k) = pᵏ (1 − p).
    pub fn pmf(&self, k: u64) -> f64 {
        power(self.p_rr, k.into()) * (1.0 - self.p_rr)
    }

    /// P(N ≤ k) = 1 − pᵏ⁺¹, computed with `exp_m1`, as the difference cancels for p near 1.
    pub fn cdf(&self, k: u64) -> f64 {
        one_minus_power(self.p_rr, u128::from(k) + 1)
    }

    /// P(N > k) = pᵏ⁺¹, accurate for large k, where 1 − P(N ≤ k) cancels.
    pub fn survival(&self, k: u64) -> f64 {
        power(self.p_rr, u128::from(k) + 1)
    }

    /// E\[N\] = p/(1 − p), which grows without bound: +∞ at p = 1.
    pub fn mean(&self) -> f64 {
        self.p_rr / (1.0 - self.p_rr)
    }

    /// Var N = p/(1 − p)², +∞ at p = 1.
    pub fn variance(&self) -> f64 {
        let p = Extended::from(self.p_rr);
        (p / (Extended::ONE - p).squared()).round()
    }

    /// The smallest k with [`cdf`](Self::cdf)(k) ≥ u, by bisection: rounding of a logarithm may be off by
    /// one.
    ///
    /// The result is `u64::MAX`, for infinity, at u = 1 (no number of bounces is certain to be enough), and
    /// at p = 1 for every u > 0.
    ///
    /// ```
    /// let bounces = unbiased::roulette::Roulette::new(0.5)?.bounces();
    /// assert_eq!(bounces.quantile(0.75)?, 1);
    /// assert_eq!(bounces.quantile(0.76)?, 2);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    ///
    /// # Errors
    /// If u is not in \[0, 1\].
    pub fn quantile(&self, u: f64) -> Result<u64> {
        require("the probability u", u, (0.0..=1.0).contains(&u), "in [0, 1]")?;
        // the rounded cdf reaches 1, the exact one does not
        if u >= 1.0 {
            return Ok(u64::MAX);
        }
        let (mut low, mut high) = (0, u64::MAX);
        while low < high {
            let middle = low.midpoint(high);
            if self.cdf(middle) < u {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        Ok(high)
    }

    /// N sampled by flipping one coin per bounce. Expected cost: 1/(1 − p) coins per draw; n bounces or more
    /// have probability pⁿ, and take n coins. A draw never ends only if the generator keeps giving numbers
    /// below p.
    ///
    /// ```
    /// use unbiased::{Budget, estimate, roulette::Roulette};
    ///
    /// let bounces = Roulette::new(0.8)?.bounces();
    /// let estimate = estimate(&bounces.by_simulation()?, Budget::Draws(100_000), 1)?;
    /// assert!(estimate.z(4.0).unwrap().abs() < 5.0);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    ///
    /// # Errors
    /// If p_rr = 1: a draw would never end.
    pub fn by_simulation(self) -> Result<impl Distribution<u64> + Estimator + Copy> {
        self.require_an_end()?;
        Ok(BouncesBySimulation { p_rr: self.p_rr })
    }

    /// N sampled in one step, ⌊ln(1 − U)/ln p⌋, at the same cost for every p.
    ///
    /// U = k·2⁻⁵³ is never 1, so N is at most 53 ln 2/−ln p, beyond which the probability is below 2⁻⁵³: 164
    /// bounces for p = 4/5, and 3.3e17 for p = 1 − 2⁻⁵³.
    ///
    /// ```
    /// use unbiased::{Budget, estimate, roulette::Roulette};
    ///
    /// let bounces = Roulette::new(0.8)?.bounces();
    /// let estimate = estimate(&bounces.by_inversion()?, Budget::Draws(100_000), 1)?;
    /// assert!(estimate.z(4.0).unwrap().abs() < 5.0);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    ///
    /// # Errors
    /// If p_rr = 1: N is infinite.
    pub fn by_inversion(self) -> Result<impl Distribution<u64> + Estimator + Copy> {
        self.require_an_end()?;
        Ok(BouncesByInversion { per_ln: 1.0 / self.p_rr.ln() })
    }

    fn require_an_end(self) -> Result<f64> {
        require(P_RR, self.p_rr, self.p_rr < 1.0, "below 1 (at 1 the bounces never end)")
    }
}

/// N by flipping coins.
#[derive(Clone, Copy)]
struct BouncesBySimulation {
    p_rr: f64,
}

impl Distribution<u64> for BouncesBySimulation {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> u64 {
        let mut bounces = 0;
        while coin(rng, self.p_rr) {
            bounces += 1;
        }
        bounces
    }
}

impl Estimator for BouncesBySimulation {
    #[inline]
    fn draw(&self, rng: &mut Stream) -> f64 {
        let bounces: u64 = self.sample(rng);
        bounces as f64
    }
}

/// N = ⌊ln(1 − U)/ln p⌋.
#[derive(Clone, Copy)]
struct BouncesByInversion {
    /// 1/ln p
    per_ln: f64,
}

impl BouncesByInversion {
    #[inline(always)]
    fn bounces_at(&self, [u]: [f64; 1]) -> f64 {
        fast::floor((fast::ln(1.0 - u) * self.per_ln).abs())
    }
}

impl Distribution<u64> for BouncesByInversion {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> u64 {
        self.bounces_at([StandardUniform.sample(rng)]) as u64
    }
}

impl Estimator for BouncesByInversion {
    #[inline]
    fn draw(&self, rng: &mut Stream) -> f64 {
        from_uniforms(|u| self.bounces_at(u)).draw(rng)
    }

    fn fill(&self, rng: &mut Stream, draws: &mut [f64]) {
        from_uniforms(|u| self.bounces_at(u)).fill(rng, draws);
    }
}
