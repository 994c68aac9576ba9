//! Section 1: the inversion method, which maps a uniform random number through the inverse of a cdf.
//!
//! If U is uniform on [0, 1), then F⁻(U) = inf{x : F(x) ≥ U} has the cdf F. For the exponential distribution
//! the inverse is a formula ([`Exponential`]); for any other one-dimensional cdf it is found by bisection
//! ([`Inversion`]).
//!
//! `examples/check_mine.rs` checks your own estimator for question 1.1.

#[cfg(feature = "workbook")]
pub mod figures;
pub mod mistakes;
#[cfg(feature = "workbook")]
pub(crate) mod questions;

use rand::Rng;
use rand::distr::{Distribution, StandardUniform};

use crate::error::{Error, Result, require};
use crate::estimator::{Density, Estimator, from_uniforms};
use crate::fast;
use crate::float::{Extended, ROUNDING, is_probability};
use crate::stream::Stream;

/// The exponential distribution with rate λ: p(x) = λ e^(−λx) for x ≥ 0, mean 1/λ, variance 1/λ².
///
/// Sampled by inversion, X = −ln(1 − U)/λ. As an [`Estimator`] each draw is X, so it estimates the mean.
///
/// ```
/// use unbiased::inversion::Exponential;
///
/// let exponential = Exponential::new(1.0)?;
/// let x = exponential.inverse_cdf(0.75)?;
/// assert_eq!(x, 4f64.ln());
/// assert_eq!(exponential.pdf(x), 0.25);
/// # Ok::<(), unbiased::Error>(())
/// ```
///
/// # Largest sample
/// U = k·2⁻⁵³ is never 1, so X is at most 53 ln 2/λ = 36.7368/λ, which has probability 2⁻⁵³. In `f32`, U =
/// k·2⁻²⁴, and X is at most 24 ln 2/λ = 16.6355/λ, with probability 2⁻²⁴. On these grids 1 − U is exact, so
/// the plain logarithm is accurate. A sample is infinite, which ends a run with an error, only if these
/// quotients overflow: for λ < 2.1e-307 in `f64` and λ < 4.9e-38 in `f32`.
///
/// # Source
/// Worksheet 1.1; *Physically Based Rendering*, 4th ed., section A.4.2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exponential {
    rate: f64,
    mean: f64,
}

impl Exponential {
    /// The exponential distribution with rate λ, in units of 1/x.
    ///
    /// # Errors
    /// If λ is not positive and finite.
    pub fn new(rate: f64) -> Result<Self> {
        let ok = rate > 0.0 && rate.is_finite();
        let rate = require("the rate λ", rate, ok, "positive and finite")?;
        Ok(Self { rate, mean: 1.0 / rate })
    }

    /// The rate λ.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// The mean 1/λ.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// The variance 1/λ².
    pub fn variance(&self) -> f64 {
        self.mean * self.mean
    }

    /// The density p(x) = λ e^(−λx), 0 for x < 0.
    pub fn pdf(&self, x: f64) -> f64 {
        if x < 0.0 {
            return 0.0;
        }
        let (product, lost) = self.times(x);
        if product > FAR {
            return self.pdf_far_out(product, lost);
        }
        let survival = (-product).exp();
        self.rate * (survival - survival * lost)
    }

    /// λ e^(−λx) where e^(−λx) alone may underflow: e^(−512) is split off once or twice, and what is left is
    /// well inside `f64`'s range.
    #[cold]
    fn pdf_far_out(&self, product: f64, lost: f64) -> f64 {
        let once = Extended::from(EXP_FAR[0]) + Extended::from(EXP_FAR[1]);
        let (far, factor) = if product > 2.0 * FAR { (2.0 * FAR, once.squared()) } else { (FAR, once) };
        let rest = (far - product).exp();
        (Extended::from(self.rate) * factor * Extended::from(rest - rest * lost)).round()
    }

    /// F(x) = P(X ≤ x) = 1 − e^(−λx). Computed with `exp_m1`, as 1 − e^(−λx) rounds to 0 at λx = 1e-17. It
    /// never decreases from one `f64` to the next.
    pub fn cdf(&self, x: f64) -> f64 {
        if x < 0.0 {
            return 0.0;
        }
        // rounding of λx costs at most half an ulp; a correction could make F decrease between neighbouring
        // numbers
        (-self.rate * x).exp_m1().abs()
    }

    /// P(X > x) = e^(−λx). Accurate for large x, where 1 − F(x) cancels.
    pub fn survival(&self, x: f64) -> f64 {
        if x < 0.0 {
            return 1.0;
        }
        let (product, lost) = self.times(x);
        let survival = (-product).exp();
        survival - survival * lost
    }

    /// F⁻¹(u) = −ln(1 − u)/λ for u in \[0, 1\]; F⁻¹(1) = +∞. Computed with `ln_1p`, as 1 − u rounds to 1 for
    /// u = 1e-20.
    ///
    /// # Errors
    /// If u is not in \[0, 1\].
    pub fn inverse_cdf(&self, u: f64) -> Result<f64> {
        require_probability(u)?;
        // abs rather than a sign change: the sample at u = 0 is 0, not −0
        Ok((-u).ln_1p().abs() / self.rate)
    }

    /// λx and its rounding error: half an ulp of an exponent near 700 is 300 ulp of its exponential.
    fn times(&self, x: f64) -> (f64, f64) {
        let product = self.rate * x;
        let lost = self.rate.mul_add(x, -product);
        (product, if lost.is_finite() { lost } else { 0.0 })
    }
}

/// The λx from which the density is computed in several factors.
const FAR: f64 = 512.0;

/// e^(−512) as a double-double.
const EXP_FAR: [f64; 2] = [4.377491037053051e-223, 2.706079830228623e-239];

fn require_probability(u: f64) -> Result<f64> {
    require("the probability u", u, (0.0..=1.0).contains(&u), "in [0, 1]")
}

impl Distribution<f64> for Exponential {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        self.warp([StandardUniform.sample(rng)])
    }
}

impl Distribution<f32> for Exponential {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> f32 {
        let u: f32 = StandardUniform.sample(rng);
        // divided in f64: a rate outside f32's range would give 0/0 for U = 0, or lose digits
        (f64::from((1.0 - u).ln().abs()) / self.rate) as f32
    }
}

impl Density<1> for Exponential {
    type Point = f64;

    #[inline(always)]
    fn warp(&self, [u]: [f64; 1]) -> f64 {
        let x = fast::ln(1.0 - u).abs();
        // multiplying takes half the time of dividing
        if self.mean.is_normal() { x * self.mean } else { x / self.rate }
    }

    fn pdf(&self, x: &f64) -> f64 {
        Exponential::pdf(self, *x)
    }
}

impl Estimator for Exponential {
    #[inline]
    fn draw(&self, rng: &mut Stream) -> f64 {
        from_uniforms(|u| self.warp(u)).draw(rng)
    }

    fn fill(&self, rng: &mut Stream, draws: &mut [f64]) {
        from_uniforms(|u| self.warp(u)).fill(rng, draws);
    }
}

/// The inverse F⁻(u) = inf{x : F(x) ≥ u} of any one-dimensional cdf, smooth or with jumps and flat parts,
/// found by bisection.
///
/// The bracket is halved in the *order of `f64`'s bit patterns*, not in length. So at most 64 evaluations of
/// F lead from any support, even an infinite one, to two neighbouring numbers; the upper one is the answer.
/// There is no tolerance and no starting guess, and jumps and flat parts need no special treatment.
///
/// As a [`Distribution`] it draws F⁻(U), with 2⁻⁵⁴ in place of U = 0. So the smallest and the largest sample
/// have probability 2⁻⁵³ each, and are finite if F⁻ is there. A sample is NaN if F turns out not to be a cdf,
/// which ends a run with an error; [`inverse_cdf`](Self::inverse_cdf) says what is wrong.
///
/// ```
/// use unbiased::inversion::Inversion;
///
/// let fair_die = Inversion::new(|x: f64| (x.floor() / 6.0).clamp(0.0, 1.0), [1.0, 6.0])?;
/// assert_eq!(fair_die.inverse_cdf(0.5)?, 3.0);
/// assert_eq!(fair_die.inverse_cdf(0.51)?, 4.0);
/// # Ok::<(), unbiased::Error>(())
/// ```
///
/// # Source
/// Worksheet 1.1, "any other one-dimensional distribution"; Devroye, *Non-Uniform Random Variate Generation*,
/// section II.2.
#[derive(Debug, Clone, Copy)]
pub struct Inversion<F> {
    cdf: F,
    /// The support's lower end.
    low: f64,
    /// The interval that is searched: the support, or a part of it with all but 2⁻⁴⁰ of the mass.
    within: [f64; 2],
}

/// The largest |x| at which `new` evaluates a cdf on an infinite support. For larger x, intermediate results
/// such as λx often overflow, and some libraries' cdfs panic.
const FARTHEST: f64 = f64::from_bits((1023 + 960) << 52);

impl<F: Fn(f64) -> f64> Inversion<F> {
    /// The inverse of `cdf` on the support \[low, high\]. At an infinite end F is taken as 0 or 1 without
    /// calling `cdf`. If `cdf` is NaN for all large x, as ∞·0 is, F counts as 1 there if it has come within
    /// 2⁻⁴⁰ of 1 before; likewise as 0 towards −∞.
    ///
    /// # Errors
    /// If the support is empty or NaN, or if the cdf, evaluated at 65 points across the support, leaves \[0,
    /// 1\] or decreases, by more than 2⁻⁴⁰, is NaN elsewhere, or levels off so that there is mass at
    /// infinity.
    pub fn new(cdf: F, [low, high]: [f64; 2]) -> Result<Self> {
        require("the support's lower end", low, low < f64::INFINITY, "a number below +∞")?;
        require("the support's upper end", high, high > low, "above the lower end")?;
        // makes −0 into 0, which has the same rank
        let low = low + 0.0;
        let mut inversion = Self { cdf, low, within: [low, high] };
        let [first, last] = inversion.within.map(|end| inversion.last_number(0f64.clamp(low, high), end));
        let mut looks = [(first, 0.0); 65];
        for (step, look) in looks.iter_mut().enumerate() {
            let part = (order(last) as i128 - order(first) as i128) * step as i128 / 64;
            let x = from_order((order(first) as i128 + part) as i64);
            *look = (x, inversion.probability(x)?);
        }
        for (before, after) in looks.iter().zip(&looks[1..]) {
            not_falling(*before, *after)?;
        }
        let [start, second, .., last_but_one, end] = looks;
        if low.is_infinite() {
            inversion.within[0] = infinite_end(low, start, start.1, second.1 - start.1)?;
        }
        if high.is_infinite() {
            inversion.within[1] = infinite_end(high, end, 1.0 - end.1, end.1 - last_but_one.1)?;
        }
        Ok(inversion)
    }

    /// F⁻(u) = inf{x : F(x) ≥ u}: the smallest `f64` in the support at which the cdf reaches u, or the
    /// support's lower end for u = 0. If the cdf ends less than 2⁻⁴⁰ below u, the result is the point where
    /// it reaches its last value.
    ///
    /// # Errors
    /// If u is not in \[0, 1\], or if the bisection finds that the cdf leaves \[0, 1\], decreases, or does
    /// not reach u, by more than 2⁻⁴⁰.
    pub fn inverse_cdf(&self, u: f64) -> Result<f64> {
        require_probability(u)?;
        if u == 0.0 {
            return Ok(self.low);
        }
        let [low, high] = self.within;
        let (mut below, mut above) = (order(low), order(high));
        let (mut f_below, mut f_above) = (self.probability(low)?, self.probability(high)?);
        if f_above < u - ROUNDING {
            let reason =
                format!("at the support's upper end {high:?} it is {f_above}, and never reaches {u}");
            return Err(Error::NotACdf { reason });
        }
        // a cdf may end a rounding error below 1: its last value counts as 1
        let u = u.min(f_above);
        if f_below >= u {
            return Ok(low);
        }
        // invariant: F(below) < u ≤ F(above)
        while above.wrapping_sub(below) as u64 > 1 {
            let middle = below.midpoint(above);
            let x = from_order(middle);
            let f = self.probability(x)?;
            not_falling((from_order(below), f_below), (x, f))?;
            not_falling((x, f), (from_order(above), f_above))?;
            if f < u {
                (below, f_below) = (middle, f);
            } else {
                (above, f_above) = (middle, f);
            }
        }
        Ok(from_order(above))
    }

    fn probability(&self, x: f64) -> Result<f64> {
        let f = match x {
            f64::NEG_INFINITY => 0.0,
            f64::INFINITY => 1.0,
            x => (self.cdf)(x),
        };
        let outside = || Error::NotACdf { reason: format!("F({x:?}) is {f}, outside [0, 1]") };
        if is_probability(f) { Ok(f) } else { Err(outside()) }
    }

    /// For an infinite end, the last number from `inside` towards it at which F is not NaN; for a finite end,
    /// that end.
    fn last_number(&self, inside: f64, end: f64) -> f64 {
        let is_nan = |rank| (self.cdf)(from_order(rank)).is_nan();
        let far = if inside.abs() < FARTHEST { FARTHEST } else { f64::MAX };
        let (mut number, mut nan) = (order(inside), order(end.clamp(-far, far)));
        if end.is_finite() || !is_nan(nan) {
            return from_order(nan);
        }
        while number.abs_diff(nan) > 1 {
            let middle = number.midpoint(nan);
            *(if is_nan(middle) { &mut nan } else { &mut number }) = middle;
        }
        from_order(number)
    }
}

/// How far to search towards an infinite end of the support: up to x, the last number with a value F(x), if
/// all the mass up to rounding lies on this side of it, else up to the end.
fn infinite_end(end: f64, (x, f): (f64, f64), beyond: f64, rise: f64) -> Result<f64> {
    let not_a_cdf = |reason| Err(Error::NotACdf { reason });
    if beyond <= ROUNDING {
        Ok(x)
    } else if x.abs() < FARTHEST {
        not_a_cdf(format!("beyond F({x:?}) = {f} it is NaN"))
    } else if rise <= ROUNDING * (1.0 - beyond) {
        not_a_cdf(format!("towards {end} it stays at {f}, which leaves mass at infinity"))
    } else {
        Ok(end)
    }
}

fn not_falling((x, f_x): (f64, f64), (y, f_y): (f64, f64)) -> Result<()> {
    if f_y >= f_x - ROUNDING {
        Ok(())
    } else {
        Err(Error::NotACdf { reason: format!("it falls from F({x:?}) = {f_x} to F({y:?}) = {f_y}") })
    }
}

impl<F: Fn(f64) -> f64> Distribution<f64> for Inversion<F> {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        // U = 0 is replaced by the middle of its grid cell [0, 2⁻⁵³), as F⁻(0) may be −∞
        const MIDDLE: f64 = 0.5 / (1u64 << 53) as f64;
        let u: f64 = StandardUniform.sample(rng);
        self.inverse_cdf(u.max(MIDDLE)).unwrap_or(f64::NAN)
    }
}

/// The rank of x among all `f64` from −∞ to +∞: neighbours differ by 1.
fn order(x: f64) -> i64 {
    let bits = x.to_bits() as i64;
    if bits < 0 { i64::MIN - bits } else { bits }
}

fn from_order(rank: i64) -> f64 {
    f64::from_bits(if rank < 0 { i64::MIN - rank } else { rank } as u64)
}
