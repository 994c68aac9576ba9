//! An estimator of few random numbers is a function on the unit cube: its mean and variance are integrals, without noise.

use crate::error::{Error, Result, require_count};
use crate::run::Estimator;
use crate::stream::Stream;

/// The exact moments of an estimator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exact {
    /// E\[X\]
    pub mean: f64,
    /// Var X
    pub variance: f64,
}

/// Mean and variance of an estimator that takes `random_numbers` uniform numbers a draw, at most 3, by adaptive quadrature over the unit
/// cube: a check of unbiasedness with no noise and no false alarm.
///
/// Jumps, kinks and integrable singularities are cornered by bisection (Clenshaw & Curtis 1960, nested 9 and 17 points), to about 1e-10 of E|X|, where they lie across
/// the axes; a jump aslant to them takes too long, which is an error. It integrates what [`Estimator::draw`] returns.
///
/// # Errors
/// If an estimator takes more numbers than that, or a draw is not finite.
///
/// ```
/// use unbiased::{check, from_fn};
///
/// let exact = check::exactly(&from_fn(|rng| -(1.0 - rng.uniform()).ln() / 0.37), 1)?;
/// assert!((exact.mean - 1.0 / 0.37).abs() < 1e-9);
/// assert!((exact.variance - 1.0 / 0.37f64.powi(2)).abs() < 1e-8);
/// # Ok::<(), unbiased::Error>(())
/// ```
pub fn exactly(estimator: &(impl Estimator + ?Sized), random_numbers: usize) -> Result<Exact> {
    let count = random_numbers as u64;
    require_count("the random numbers of a draw", count, (1..=3).contains(&count), "1, 2 or 3")?;
    let draw = |point: &[f64]| {
        let mut rng = Stream::scripted(point);
        let value = estimator.draw(&mut rng);
        if rng.random_numbers() > count {
            let taken = rng.random_numbers();
            return Err(Error::NotIntegrable {
                reason: format!("it took {taken} random numbers in a draw, not {count}"),
            });
        }
        if !value.is_finite() {
            return Err(Error::NotIntegrable { reason: format!("it is {value} at u = {point:?}") });
        }
        Ok(value)
    };
    let mut sweep = Sweep { dimensions: random_numbers, rule: nested_rule(), evaluations: 0 };
    let mut point = vec![0.0; random_numbers];
    let mean = sweep.integrate(&draw, &mut point, 0, 0.0)?;
    // about the mean, so that the variance of an estimator that hardly varies keeps its digits; below its rounding there is only noise
    let squared_deviation = |point: &[f64]| Ok((draw(point)? - mean.value).powi(2));
    let noise = (4.0 * f64::EPSILON * mean.size).powi(2);
    let variance = sweep.integrate(&squared_deviation, &mut point, 0, noise)?;
    Ok(Exact { mean: mean.value, variance: if variance.value > noise { variance.value } else { 0.0 } })
}

/// Error allowed to a piece, relative to the whole integral of |f|.
const TOLERANCE: f64 = 1e-13;

/// Width below which a piece is not halved any more.
const NARROWEST: f64 = 1e-13;

/// Evaluations after which a sweep is given up: about a second.
const MOST: u64 = 30_000_000;

/// An integral of f and of |f|.
#[derive(Clone, Copy)]
struct Integral {
    value: f64,
    size: f64,
}

/// Node on [−1, 1], weight, and weight in the coarser rule that the same nodes serve.
type Rule = [(f64, f64, f64); 17];

struct Sweep {
    dimensions: usize,
    rule: Rule,
    evaluations: u64,
}

impl Sweep {
    /// ∫ f over the coordinates of `point` from `axis` on, the ones before being fixed, to the larger of a relative 1e-13 and `noise`.
    fn integrate(
        &mut self,
        f: &dyn Fn(&[f64]) -> Result<f64>,
        point: &mut [f64],
        axis: usize,
        noise: f64,
    ) -> Result<Integral> {
        if axis == self.dimensions {
            self.evaluations += 1;
            if self.evaluations > MOST {
                let reason = format!("it takes more than {MOST} evaluations, as jumps aslant to the axes do");
                return Err(Error::NotIntegrable { reason });
            }
            let value = f(point)?;
            return Ok(Integral { value, size: value.abs() });
        }
        let mut whole = Integral { value: 0.0, size: 0.0 };
        let mut scale = 0.0f64;
        let mut pieces = vec![(0.0, 1.0)];
        while let Some((from, to)) = pieces.pop() {
            let (piece, error) = self.piece(f, point, axis, noise, from, to)?;
            scale = scale.max(piece.size);
            // a jump is cornered by halving; where halving ends, so little is left that any value will do
            if error <= (TOLERANCE * scale).max(noise) || to - from < NARROWEST {
                whole.value += piece.value;
                whole.size += piece.size;
            } else {
                let middle = 0.5 * (from + to);
                pieces.extend([(middle, to), (from, middle)]);
            }
        }
        Ok(whole)
    }

    /// The nested rules on one piece, and their difference. Both ends are nodes, so that a jump close to one cannot hide from them.
    fn piece(
        &mut self,
        f: &dyn Fn(&[f64]) -> Result<f64>,
        point: &mut [f64],
        axis: usize,
        noise: f64,
        from: f64,
        to: f64,
    ) -> Result<(Integral, f64)> {
        let (centre, half) = (0.5 * (from + to), 0.5 * (to - from));
        let (mut fine, mut coarse, mut size) = (0.0, 0.0, 0.0);
        for (node, weight, coarser) in self.rule {
            if let Some(coordinate) = point.get_mut(axis) {
                *coordinate = centre + half * node;
            }
            let inner = self.integrate(f, point, axis + 1, noise)?;
            fine += weight * inner.value;
            coarse += coarser * inner.value;
            size += weight * inner.size;
        }
        Ok((Integral { value: half * fine, size: half * size }, half * (fine - coarse).abs()))
    }
}

/// Clenshaw & Curtis (1960) with 17 points and, at every second of them, with 9.
fn nested_rule() -> Rule {
    let weight = |k: usize, n: usize| {
        let angle = std::f64::consts::PI * k as f64 / n as f64;
        let sum: f64 = (1..=n / 2)
            .map(|j| {
                let last = if 2 * j == n { 1.0 } else { 2.0 };
                last * (2.0 * j as f64 * angle).cos() / (4 * j * j - 1) as f64
            })
            .sum();
        (if k.is_multiple_of(n) { 1.0 } else { 2.0 }) * (1.0 - sum) / n as f64
    };
    std::array::from_fn(|k| {
        let node = -(std::f64::consts::PI * k as f64 / 16.0).cos();
        (node, weight(k, 16), if k.is_multiple_of(2) { weight(k / 2, 8) } else { 0.0 })
    })
}
