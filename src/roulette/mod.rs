//! Section 5: Russian roulette, which ends paths at random without bias.
//!
//! X_rr = X/p_rr with probability p_rr, else 0, so E\[X_rr\] = E\[X\]. [`Roulette`] flips the coin,
//! [`Roulette::wrap`] applies it to any estimator, [`BounceCount`] is the distribution of the number of
//! bounces N, and [`LightModel`] gives the exact cost and gain of roulette.
//!
//! `examples/check_mine.rs` checks your own estimator for question 5.1.

use rand::Rng;
use rand::distr::{Distribution, StandardUniform};

use crate::error::{Result, require};
use crate::estimator::{Estimator, from_fn};

mod bounces;
#[cfg(feature = "workbook")]
pub mod figures;
mod light;
pub mod mistakes;
#[cfg(feature = "workbook")]
pub(crate) mod questions;

pub use bounces::BounceCount;
pub use light::{LightModel, RoulettePaths, TruncatedPaths};

/// Russian roulette with continuation probability p_rr: a coin that decides whether a path goes on.
/// [`BounceCount`] is how often it does.
///
/// (Worksheet 5; Arvo & Kirk, "Particle transport and image synthesis", 1990; *Physically Based Rendering*,
/// 4th ed., section 2.2.4.)
///
/// ```
/// use unbiased::roulette::Roulette;
///
/// let roulette = Roulette::new(0.75)?;
/// assert_eq!(roulette.bounces().mean(), 3.0);
/// # Ok::<(), unbiased::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roulette {
    p_rr: f64,
}

impl Roulette {
    /// Roulette that continues with probability p_rr. With p_rr = 1 no path ever ends.
    ///
    /// # Errors
    /// If p_rr is not in (0, 1]. At p_rr = 0 every draw is 0, which is biased unless E\[X\] = 0.
    pub fn new(p_rr: f64) -> Result<Self> {
        let ok = p_rr > 0.0 && p_rr <= 1.0;
        Ok(Self { p_rr: require(P_RR, p_rr, ok, "in (0, 1] (0 is biased unless E[X] = 0)")? })
    }

    /// The continuation probability p_rr.
    pub fn p_rr(&self) -> f64 {
        self.p_rr
    }

    /// The distribution of the number of bounces.
    pub fn bounces(&self) -> BounceCount {
        BounceCount { p_rr: self.p_rr }
    }

    /// Flips the coin: true, to continue, with probability p_rr, exactly so for every p_rr in `f64`.
    ///
    /// ```
    /// use unbiased::{Stream, roulette::Roulette};
    ///
    /// let (roulette, mut rng) = (Roulette::new(0.8)?, Stream::new(1, 0));
    /// let bounces = std::iter::repeat_with(|| roulette.continues(&mut rng)).take_while(|on| *on).count();
    /// assert!(bounces < 164);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    #[inline]
    pub fn continues<R: Rng + ?Sized>(&self, rng: &mut R) -> bool {
        coin(rng, self.p_rr)
    }

    /// The estimator X_rr: X/p_rr with probability p_rr, else 0 without drawing X. If X/p_rr overflows, the
    /// draw is infinite, which ends a run with an error.
    ///
    /// The coin takes a random number of its own, so it is independent of X. For an X with mean μ and
    /// variance σ² the variance of X_rr is E\[X²\]/p − μ² = σ²/p + μ² (1 − p)/p. The cost falls to a
    /// fraction p of X's, but p·Var X_rr = σ² + μ² (1 − p) ≥ σ². So roulette on a single X never lowers
    /// variance × cost.
    ///
    /// ```
    /// use unbiased::{Budget, estimate, inversion::Exponential, roulette::Roulette};
    ///
    /// let x = Exponential::new(0.37)?;
    /// let x_rr = Roulette::new(0.83)?.wrap(x);
    /// let estimate = estimate(&x_rr, Budget::Draws(100_000), 1)?;
    /// assert!(estimate.z(x.mean()).unwrap().abs() < 5.0);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    pub fn wrap<X: Estimator>(self, x: X) -> impl Estimator {
        // divided, not multiplied by 1/p_rr, which is infinite for p_rr < 5.6e-309
        from_fn(move |rng| if self.continues(rng) { x.draw(rng) / self.p_rr } else { 0.0 })
    }
}

const P_RR: &str = "the continuation probability p_rr";

/// True with probability p, exactly, for any p in \[0, 1\].
///
/// U < p alone would round p up to the grid k·2⁻⁵³: 1e-300 to 1.1e-16. So if U is the last grid point below
/// p, a second number decides, with probability (p − U)/2⁻⁵³.
#[inline]
pub(crate) fn coin<R: Rng + ?Sized>(rng: &mut R, mut p: f64) -> bool {
    const GRID: f64 = (1u64 << 53) as f64;
    loop {
        let u: f64 = StandardUniform.sample(rng);
        let beyond = (p - u) * GRID; // exact where it lies between 0 and 1
        if beyond <= 0.0 {
            return false;
        }
        if beyond >= 1.0 {
            return true;
        }
        p = beyond;
    }
}

/// pⁿ, by `powf`; exp(n ln p) has an error of n·ln p ulp.
fn power(p: f64, n: u128) -> f64 {
    if n <= 1 << 53 {
        p.powf(n as f64)
    } else {
        // n may not be exact in f64, but its upper 53 bits and the rest are
        let low = n & 0x7ff;
        p.powf((n - low) as f64) * p.powf(low as f64)
    }
}

/// 1 − pⁿ without cancellation, for n ≥ 1.
fn one_minus_power(p: f64, n: u128) -> f64 {
    if n == 1 { 1.0 - p } else { (n as f64 * p.ln()).exp_m1().abs() }
}
