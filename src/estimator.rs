//! The formula ⟨Fₙ⟩ = 1/n Σ f(Xᵢ)/p(Xᵢ). An estimator is a function of uniform random numbers.

use std::ops::Deref;

use pulp::NullaryFnOnce;

use crate::doubt::Doubt;
use crate::fast::widest;
use crate::stream::{LANES, Stream};

/// An estimator: each draw is one independent value whose mean is the quantity estimated.
///
/// ```
/// use unbiased::{Estimator, Stream};
///
/// /// 4·[x² + y² ≤ 1] for a random point of the unit square: an unbiased estimate of π.
/// struct Quarter;
///
/// impl Estimator for Quarter {
///     fn draw(&self, rng: &mut Stream) -> f64 {
///         let (x, y) = (rng.uniform(), rng.uniform());
///         if x * x + y * y <= 1.0 { 4.0 } else { 0.0 }
///     }
/// }
///
/// let estimate = unbiased::estimate(&Quarter, unbiased::Budget::Draws(100_000), 1)?;
/// assert!(estimate.z(std::f64::consts::PI).unwrap().abs() < 5.0);
/// # Ok::<(), unbiased::Error>(())
/// ```
pub trait Estimator: Sync {
    /// One draw, made from random numbers of `rng`.
    fn draw(&self, rng: &mut Stream) -> f64;

    /// Fills `draws` with the next draws of the stream: the same values as alternate calls of
    /// [`draw`](Self::draw) and [`Stream::next_draw`], though not computed in this order. Override it where
    /// many draws can be computed together.
    fn fill(&self, rng: &mut Stream, draws: &mut [f64]) {
        rng.one_at_a_time(draws, |rng| self.draw(rng));
    }

    /// Why error bars of its draws cannot be trusted, if its parameters imply that.
    fn doubt(&self) -> Option<Doubt> {
        None
    }
}

/// References and boxes of estimators are estimators.
impl<P: Deref<Target: Estimator> + Sync> Estimator for P {
    fn draw(&self, rng: &mut Stream) -> f64 {
        (**self).draw(rng)
    }

    fn fill(&self, rng: &mut Stream, draws: &mut [f64]) {
        (**self).fill(rng, draws);
    }

    fn doubt(&self) -> Option<Doubt> {
        (**self).doubt()
    }
}

/// An estimator whose draw is the value of a closure, which may take any number of uniform numbers.
///
/// ```
/// use unbiased::{Budget, estimate, from_fn};
///
/// let square = from_fn(|rng| rng.uniform().powi(2)); // E[U²] = 1/3
/// let estimate = estimate(&square, Budget::Draws(10_000), 7)?;
/// assert!(estimate.z(1.0 / 3.0).unwrap().abs() < 5.0);
/// # Ok::<(), unbiased::Error>(())
/// ```
pub fn from_fn<F: Fn(&mut Stream) -> f64 + Sync>(f: F) -> impl Estimator {
    FromFn(f)
}

struct FromFn<F>(F);

impl<F: Fn(&mut Stream) -> f64 + Sync> Estimator for FromFn<F> {
    #[inline]
    fn draw(&self, rng: &mut Stream) -> f64 {
        (self.0)(rng)
    }
}

/// An estimator whose draw is the value of a closure of N uniform numbers. It counts one evaluation per draw.
///
/// Many draws are computed together, vectorised if the closure's arithmetic allows it; the functions of
/// [`fast`](crate::fast) do.
///
/// ```
/// use unbiased::{Budget, estimate, from_uniforms};
///
/// let quarter = from_uniforms(|[u, v]| if u * u + v * v < 1.0 { 4.0 } else { 0.0 });
/// let estimate = estimate(&quarter, Budget::Draws(100_000), 1)?;
/// assert!(estimate.z(std::f64::consts::PI).unwrap().abs() < 5.0);
/// # Ok::<(), unbiased::Error>(())
/// ```
pub fn from_uniforms<const N: usize, F: Fn([f64; N]) -> f64 + Sync>(f: F) -> impl Estimator {
    FromUniforms(f)
}

struct FromUniforms<const N: usize, F>(F);

impl<const N: usize, F: Fn([f64; N]) -> f64 + Sync> Estimator for FromUniforms<N, F> {
    #[inline]
    fn draw(&self, rng: &mut Stream) -> f64 {
        rng.count_evaluations(1);
        (self.0)(std::array::from_fn(|_| rng.uniform()))
    }

    fn fill(&self, rng: &mut Stream, draws: &mut [f64]) {
        let mut numbers = [[0.0; MANY]; N];
        let mut rest = &mut *draws;
        while !rest.is_empty() {
            let lane = rng.lane();
            let some;
            (some, rest) = rest.split_at_mut(rest.len().min(MANY - lane));
            let rows = numbers.as_flattened_mut().as_chunks_mut().0;
            rng.fill_rows(N, MANY / LANES, some.len(), rows);
            if lane == 0 {
                widest(Evaluate { f: &self.0, numbers: &numbers, draws: some });
            } else {
                for (draw, place) in some.iter_mut().zip(lane..) {
                    *draw = (self.0)(numbers.map(|numbers| numbers[place]));
                }
            }
        }
        rng.count_evaluations(draws.len() as u64);
    }
}

/// Draws computed at a time: their random numbers fit into the first-level cache.
const MANY: usize = 8 * LANES;

/// Evaluates `f` at the numbers of each draw.
struct Evaluate<'a, const N: usize, F> {
    f: &'a F,
    numbers: &'a [[f64; MANY]; N],
    draws: &'a mut [f64],
}

impl<const N: usize, F: Fn([f64; N]) -> f64> NullaryFnOnce for Evaluate<'_, N, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        evaluate(self.f, self.numbers, self.draws);
    }
}

/// Separate arguments, so that the compiler knows they do not alias: a store into `draws` does not change
/// what `f` holds.
#[inline(always)]
fn evaluate<const N: usize, F: Fn([f64; N]) -> f64>(f: &F, numbers: &[[f64; MANY]; N], draws: &mut [f64]) {
    for place in 0..draws.len().min(MANY) {
        draws[place] = f(std::array::from_fn(|k| numbers[k][place]));
    }
}

/// A probability density, and how to sample it from N uniform numbers.
///
/// # Contract
/// `pdf` is the density of the points that `warp` returns for uniform numbers: it integrates to 1 over them
/// and is positive at each. Its units are 1/(units of the sampled domain), such as 1/sr.
///
/// ```
/// use unbiased::{Budget, Density, estimate, f_over_p};
///
/// /// p(x) = 2x on [0, 1); its cdf x² has the inverse √u.
/// struct Rising;
///
/// impl Density<1> for Rising {
///     type Point = f64;
///
///     fn warp(&self, [u]: [f64; 1]) -> f64 {
///         (1.0 - u).sqrt() // above 0, where p is
///     }
///
///     fn pdf(&self, x: &f64) -> f64 {
///         2.0 * x
///     }
/// }
///
/// // ∫₀¹ x² dx
/// let third = estimate(&f_over_p(|x| x * x, Rising), Budget::Draws(100_000), 1)?;
/// assert!(third.z(1.0 / 3.0).unwrap().abs() < 5.0);
/// # Ok::<(), unbiased::Error>(())
/// ```
pub trait Density<const N: usize>: Sync {
    /// The type of a sample: a number, a point in the plane, a direction.
    type Point;

    /// Maps N uniform numbers in [0, 1) to a point.
    fn warp(&self, u: [f64; N]) -> Self::Point;

    /// The density at `x`; 0 at points that are never sampled.
    fn pdf(&self, x: &Self::Point) -> f64;
}

impl<const N: usize, D: Density<N> + ?Sized> Density<N> for &D {
    type Point = D::Point;

    #[inline(always)]
    fn warp(&self, u: [f64; N]) -> Self::Point {
        (**self).warp(u)
    }

    #[inline(always)]
    fn pdf(&self, x: &Self::Point) -> f64 {
        (**self).pdf(x)
    }
}

/// The estimator f(X)/p(X) of ∫ f, X drawn from `density`.
///
/// It is unbiased if p > 0 wherever f ≠ 0 and ∫ |f| is finite. Its variance is ∫ f²/p − (∫ f)², which is 0
/// exactly if p is proportional to f and f does not change sign. If `warp` returns a point at which `pdf` is
/// 0, the two do not belong together; the draw is then NaN or infinite, and the run ends with an error.
/// (Worksheet 2.1, 3.4, 3.5; *Physically Based Rendering*, 4th ed., section 2.1.3.)
///
/// ```
/// use unbiased::{Budget, estimate, f_over_p, lambertian::hemisphere::Hemisphere};
///
/// // ∫ cos θ dω over the hemisphere is π; with a density proportional to cos θ the variance is 0
/// let estimate = estimate(&f_over_p(|w| w.cos_theta(), Hemisphere::Cosine), Budget::Draws(100), 1)?;
/// assert!((estimate.mean() - std::f64::consts::PI).abs() < 1e-14);
/// # Ok::<(), unbiased::Error>(())
/// ```
pub fn f_over_p<const N: usize, F, D>(f: F, density: D) -> impl Estimator
where
    F: Fn(&D::Point) -> f64 + Sync,
    D: Density<N>,
{
    from_uniforms(move |u| {
        let x = density.warp(u);
        f(&x) / density.pdf(&x)
    })
}
