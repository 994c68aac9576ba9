//! An estimator of few random numbers is a function on the unit cube: its mean and variance are integrals, without noise.

use crate::error::{Error, Result, require_count};
use crate::run::Estimator;
use crate::stream::Stream;

/// The exact moments of an estimator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exact {
    /// E[X]
    pub mean: f64,
    /// Var X
    pub variance: f64,
}

/// Mean and variance of an estimator that takes `random_numbers` uniform numbers a draw, at most 3, by adaptive quadrature over the unit
/// cube: a check of unbiasedness with no noise and no false alarm.
///
/// Jumps and integrable singularities are found by bisection (Gauss–Kronrod, 15 points; Piessens et al. 1983, *QUADPACK*), to about 1e-10 of the
/// mean, where their number is finite in each direction. It integrates what [`Estimator::draw`] returns.
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
    let mut point = vec![0.0; random_numbers];
    let mean = integrate(&draw, &mut point, 0)?;
    // about the mean, so that the variance of an estimator that hardly varies keeps its digits
    let squared_deviation = |point: &[f64]| Ok((draw(point)? - mean).powi(2));
    let variance = integrate(&squared_deviation, &mut point, 0)?;
    Ok(Exact { mean, variance })
}

/// ∫ f over the coordinates of `point` from `axis` on, the ones before being fixed.
fn integrate(f: &dyn Fn(&[f64]) -> Result<f64>, point: &mut [f64], axis: usize) -> Result<f64> {
    if axis == point.len() {
        return f(point);
    }
    let mut along = |u: f64| {
        if let Some(coordinate) = point.get_mut(axis) {
            *coordinate = u;
        }
        integrate(f, point, axis + 1)
    };
    let whole = kronrod(&mut along, 0.0, 1.0)?;
    let mut pieces = vec![(0.0, 1.0, whole)];
    let mut integral = 0.0;
    let mut scale = whole.size;
    while let Some((from, to, rule)) = pieces.pop() {
        scale = scale.max(rule.size);
        // a jump is cornered by halving; where halving ends, so little is left that any value will do
        if rule.error <= TOLERANCE * scale || to - from < NARROWEST {
            integral += rule.value;
            continue;
        }
        let middle = 0.5 * (from + to);
        pieces.push((from, middle, kronrod(&mut along, from, middle)?));
        pieces.push((middle, to, kronrod(&mut along, middle, to)?));
    }
    Ok(integral)
}

/// Error allowed to a piece, relative to the whole integral of |f|.
const TOLERANCE: f64 = 1e-13;

/// Width below which a piece is not halved any more.
const NARROWEST: f64 = 1e-13;

/// One piece's integral of f and of |f|, and the error in it.
#[derive(Clone, Copy)]
struct Rule {
    value: f64,
    size: f64,
    error: f64,
}

/// The Gauss–Kronrod pair of 7 and 15 points.
fn kronrod(f: &mut impl FnMut(f64) -> Result<f64>, from: f64, to: f64) -> Result<Rule> {
    let (centre, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (mut fine, mut coarse, mut size) = (0.0, 0.0, 0.0);
    for (node, weight, gauss) in NODES {
        let both = if node == 0.0 { &[0.0][..] } else { &[-node, node] };
        for node in both {
            let value = f(centre + half * node)?;
            fine += weight * value;
            size += weight * value.abs();
            coarse += gauss * value;
        }
    }
    Ok(Rule { value: half * fine, size: half * size, error: half * (fine - coarse).abs() })
}

/// Node, Kronrod weight and Gauss weight (0 where Gauss has no node), from QUADPACK.
const NODES: [(f64, f64, f64); 8] = [
    (0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0),
    (0.949_107_912_342_758_5, 0.063_092_092_629_978_55, 0.129_484_966_168_869_7),
    (0.864_864_423_359_769_1, 0.104_790_010_322_250_18, 0.0),
    (0.741_531_185_599_394_4, 0.140_653_259_715_525_92, 0.279_705_391_489_276_67),
    (0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0),
    (0.405_845_151_377_397_17, 0.190_350_578_064_785_41, 0.381_830_050_505_118_94),
    (0.207_784_955_007_898_47, 0.204_432_940_075_298_89, 0.0),
    (0.0, 0.209_482_141_084_727_83, 0.417_959_183_673_469_4),
];
