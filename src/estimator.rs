//! The one formula, ⟨Fₙ⟩ = 1/n Σ f(Xᵢ)/p(Xᵢ), and what is under it: an estimator is a function of uniform
//! numbers.

use pulp::NullaryFnOnce;

use crate::doubt::Doubt;
use crate::fast::widest;
use crate::stream::{LANES, Stream};

/// Something that can be drawn: each draw is one independent, unbiased value of the quantity estimated.
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
    /// One draw, from the numbers that `rng` gives.
    fn draw(&self, rng: &mut Stream) -> f64;

    /// Fills `draws` with the next draws of the stream: the same as [`draw`](Self::draw) and
    /// [`Stream::next_draw`] by turns, though not in this order. An estimator that can make many side by side
    /// overrides it.
    fn fill(&self, rng: &mut Stream, draws: &mut [f64]) {
        rng.one_at_a_time(draws, |rng| self.draw(rng));
    }

    /// Why error bars made of its draws are not to be trusted, where its parameters tell.
    fn doubt(&self) -> Option<Doubt> {
        None
    }
}

impl<E: Estimator + ?Sized> Estimator for &E {
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

impl<E: Estimator + ?Sized> Estimator for Box<E>
where
    Box<E>: Sync,
{
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

/// An estimator whose draw is what a closure makes of any number of uniform numbers, as many as it takes.
///
/// ```
/// use unbiased::{Budget, estimate, from_fn};
///
/// let square = from_fn(|rng| rng.uniform().powi(2)); // E[U²] = 1/3
/// let estimate = estimate(&square, Budget::Draws(10_000), 7)?;
/// assert!(estimate.z(1.0 / 3.0).unwrap().abs() < 5.0);
/// # Ok::<(), unbiased::Error>(())
/// ```
pub fn from_fn<F: Fn(&mut Stream) -> f64 + Sync>(f: F) -> FromFn<F> {
    FromFn(f)
}

/// An estimator made of a closure; see [`from_fn`].
#[derive(Debug, Clone, Copy)]
pub struct FromFn<F>(F);

impl<F: Fn(&mut Stream) -> f64 + Sync> Estimator for FromFn<F> {
    #[inline]
    fn draw(&self, rng: &mut Stream) -> f64 {
        (self.0)(rng)
    }
}

/// An estimator whose draw is what a closure makes of N uniform numbers. It counts one evaluation a draw.
///
/// Many draws are made side by side, in vectors where the closure's arithmetic allows: [`fast`](crate::fast)
/// has functions that do.
///
/// ```
/// use unbiased::{Budget, estimate, from_uniforms};
///
/// let quarter = from_uniforms(|[u, v]| if u * u + v * v < 1.0 { 4.0 } else { 0.0 });
/// let estimate = estimate(&quarter, Budget::Draws(100_000), 1)?;
/// assert!(estimate.z(std::f64::consts::PI).unwrap().abs() < 5.0);
/// # Ok::<(), unbiased::Error>(())
/// ```
pub fn from_uniforms<const N: usize, F: Fn([f64; N]) -> f64 + Sync>(f: F) -> FromUniforms<N, F> {
    FromUniforms(f)
}

/// An estimator made of a closure of N numbers; see [`from_uniforms`].
#[derive(Debug, Clone, Copy)]
pub struct FromUniforms<const N: usize, F>(F);

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

/// Draws whose numbers wait in the first-level cache.
const MANY: usize = 8 * LANES;

/// `f` of the numbers of each draw.
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

/// As arguments of their own the compiler knows them apart: a store into `draws` does not change what `f`
/// holds.
#[inline(always)]
fn evaluate<const N: usize, F: Fn([f64; N]) -> f64>(f: &F, numbers: &[[f64; MANY]; N], draws: &mut [f64]) {
    for place in 0..draws.len().min(MANY) {
        draws[place] = f(std::array::from_fn(|k| numbers[k][place]));
    }
}

/// A probability density that can be drawn from, by N uniform numbers.
///
/// # Contract
/// `pdf` is the density of `warp` of uniform numbers: it integrates to 1 over the points that can be drawn
/// and is positive at every one of them. Units are those of 1/\[point\].
///
/// ```
/// use unbiased::{Budget, Density, estimate, f_over_p};
///
/// /// p(x) = 2x on [0, 1), the inverse of whose cdf x² is √u.
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
    /// What is drawn: a number, a point of the plane, a direction.
    type Point;

    /// The point that N uniform numbers of [0, 1) are turned into.
    fn warp(&self, u: [f64; N]) -> Self::Point;

    /// The density at `x`; 0 where nothing is drawn.
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
/// It is unbiased if p > 0 wherever f ≠ 0 and ∫ |f| is finite; its variance is ∫ f²/p − (∫ f)², which is 0
/// exactly when p is proportional to an f of one sign. (Worksheet 2.1, 3.4, 3.5; *Physically Based
/// Rendering*, 4th ed., section 2.1.3.) Where a point is drawn at which p is 0, the density's two halves do
/// not belong together; the draw is then NaN or infinite, which ends a run with an error.
///
/// ```
/// use unbiased::{Budget, estimate, f_over_p, lambertian::hemisphere::Hemisphere};
///
/// // ∫ cos θ dω over the hemisphere is π; a density in proportion to cos θ has no variance at all
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
