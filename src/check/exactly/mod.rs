//! Exact mean and variance of an estimator of few random numbers: it is a function on the unit cube, so they
//! are integrals.

use rand::Rng;

use crate::error::{Result, require_count};
use crate::estimator::Estimator;
use crate::stream::Stream;
use crate::stream::points::{Placement, Sobol};

mod piece;
mod rule;
mod sweep;

use piece::{NOTHING, Sums, noise};
use sweep::{Line, Sweep, refused};

/// The exact moments of an estimator, each to the accuracy that [`exactly`] states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exact {
    /// E\[X\], to 1e-9 of E|X|
    pub mean: f64,
    /// Var X, to 1e-9 of itself, or as far as the rounding of the draws lets it be known
    pub variance: f64,
}

/// Mean and variance of an estimator that takes at most `random_numbers` ≤ 3 uniform numbers per draw, by
/// adaptive quadrature over the unit cube: a check of unbiasedness without noise or false alarms.
///
/// It integrates the values of [`Estimator::draw`] by nested rules of 9 and 17 points (Clenshaw & Curtis
/// 1960). Jumps, kinks and singularities at a value of one coordinate are isolated by bisection, down to
/// 2⁻⁵³, the step of [`Stream::uniform`].
///
/// # What is promised
/// The mean is accurate to 1e-9 of E|X| and the variance to a relative error of 1e-9. If σ is below 4e-6 of
/// E|X| the rounding of the draws makes the variance less accurate; below 5e-15 of E|X| it is given as 0.
///
/// A quadrature rule cannot see X between its nodes. So X is also compared at other points:
/// - *One number:* X is compared with the interpolating polynomials of the quadrature, at points 2⁻²⁰ apart
///   or less. A deviation of more than 1e-7 of E|X| over an interval of 2⁻²⁰ ≈ 9.6e-7 or more is detected. A
///   deviation over a shorter interval of width w is **missed** with a probability of about 1 − 2²⁰ w.
/// - *Two or three:* the same along a diagonal of the cube, which detects deviations that depend on one
///   number only. Others are detected by the quadrature's own points, less than 1/100 of the side apart in
///   two dimensions and 1/40 in three, and by 16 scrambled Sobol sets of 2¹⁴ points (Owen 1997): their values
///   must lie within the quadrature's range, extended by a quarter, and their means of X and X² must agree
///   with the quadrature to ten std errors plus 1/16384 of that range. So a deviation in a region smaller
///   than the distance of those points in every direction may be **missed**: with a probability of about
///   exp(−262144 a) if its volume is a and X leaves that range there, and always if X does not.
///
/// If a draw takes more than a microsecond, 2⁻¹⁴ ≈ 6e-5 replaces 2⁻²⁰.
///
/// ```
/// use unbiased::{check, from_fn};
///
/// let exact = check::exactly(&from_fn(|rng| -(1.0 - rng.uniform()).ln() / 0.37), 1)?;
/// assert!((exact.mean - 1.0 / 0.37).abs() < 1e-9);
/// assert!((exact.variance - 1.0 / 0.37f64.powi(2)).abs() < 1e-8);
/// # Ok::<(), unbiased::Error>(())
/// ```
///
/// # Errors
/// If `random_numbers` is not 1, 2 or 3; if a draw takes more numbers than that, or is not finite; if X jumps
/// along a line or surface that is oblique to the axes; if mean or variance is infinite, or depends on single
/// steps of 2⁻⁵³; if the size of X, its square or its variance is outside `f64`'s range; if the two rules
/// disagree, or the Sobol points disagree with them; or if it would take more than 3·10⁷ draws.
pub fn exactly(estimator: &(impl Estimator + ?Sized), random_numbers: usize) -> Result<Exact> {
    let count = random_numbers as u64;
    require_count("the random numbers of a draw", count, (1..=3).contains(&count), "1, 2 or 3")?;
    let mut sweep = Sweep::new(estimator, random_numbers)?;
    if random_numbers == 1 {
        let (sums, _) = sweep.integrate(Line::Axis(0), true)?;
        return Ok(Exact { mean: sweep.mean(&sums)?, variance: sweep.variance(&sums)? });
    }
    sweep.look_along_the_diagonal()?;
    let looked_at = std::mem::replace(&mut sweep.range, NOTHING);
    let (sums, _) = sweep.integrate(Line::Axis(0), false)?;
    let integrated = std::mem::replace(&mut sweep.range, looked_at);
    let scattered = sweep.sobol_means()?;
    let mean = sweep.mean(&sums)?;
    sweep.compare(&sums, integrated, scattered)?;
    Ok(Exact { mean, variance: sweep.variance(&sums)? })
}

/// The accuracy promised.
const ACCURACY: f64 = 1e-9;

/// Independently scrambled Sobol sets.
const SCRAMBLES: usize = 16;

/// The points of each set.
const POINTS: u32 = 1 << 14;

/// Points computed at a time.
const TOGETHER: usize = 1 << 10;

/// By how many std errors means may differ.
const STD_ERRORS: f64 = 10.0;

impl<E: Estimator + ?Sized> Sweep<'_, E> {
    /// Means of Y and Y² and their std errors, from independently scrambled Sobol sets.
    fn sobol_means(&mut self) -> Result<[[f64; 2]; 2]> {
        let mut means = [[0.0; SCRAMBLES]; 2];
        for scramble in 0..SCRAMBLES {
            let seed = Stream::new(1, scramble as u64).next_u64();
            let mut points = Stream::placed(Placement::Sobol(Sobol::new(POINTS, seed)), seed);
            for _ in 0..POINTS / TOGETHER as u32 {
                let mut draws = [0.0; TOGETHER];
                self.estimator.fill(&mut points, &mut draws);
                for x in draws {
                    if !x.is_finite() {
                        return Err(refused(format!("it is {x} at a Sobol point")));
                    }
                    let there = self.sums_of(x)?.moments;
                    for (means, value) in means.iter_mut().zip(there) {
                        means[scramble] += value / f64::from(POINTS);
                    }
                }
            }
        }
        Ok(means.map(|means| {
            let n = SCRAMBLES as f64;
            let mean = means.iter().sum::<f64>() / n;
            let squares: f64 = means.iter().map(|other| (other - mean).powi(2)).sum();
            [mean, (squares / (n * (n - 1.0))).sqrt()]
        }))
    }

    /// The mean, if it is as accurate as promised.
    fn mean(&self, sums: &Sums) -> Result<f64> {
        accurate("mean", sums.errors[0], sums.steps[0], ACCURACY * sums.size)?;
        let mean = self.unit * (self.middle + sums.moments[0]);
        let size = self.unit * sums.size;
        if !(is_zero_or_normal(size) && mean.is_finite()) {
            return Err(refused("its mean is beyond f64".into()));
        }
        // if the first draws were all 0 the unit is meaningless, and squares may have underflowed
        if sums.size > 0.0 && sums.size < 1e-100 {
            return Err(refused("the squares of its draws are beyond f64".into()));
        }
        Ok(mean)
    }

    /// The variance, if it is as accurate as promised.
    fn variance(&self, sums: &Sums) -> Result<f64> {
        let ([first, second], [error, of_square]) = (sums.moments, sums.errors);
        let (variance, noise) = (second - first * first, noise(sums.scales()));
        let errors = of_square + 2.0 * first.abs() * error;
        accurate("variance", errors, sums.steps[1], ACCURACY * variance + noise)?;
        let variance = if variance > noise { variance } else { 0.0 };
        let scaled = variance * self.unit * self.unit;
        if is_zero_or_normal(scaled) && (scaled > 0.0 || variance == 0.0) {
            Ok(scaled)
        } else {
            Err(refused("its variance is beyond f64".into()))
        }
    }

    /// Compares the integrals and the range of Y with those from points that the quadrature did not choose.
    fn compare(&self, sums: &Sums, [least, most]: [f64; 2], scattered: [[f64; 2]; 2]) -> Result<()> {
        let [low, high] = self.range;
        let room = 0.25 * (most - least) + 8.0 * f64::EPSILON * sums.size;
        let mut agrees = low >= least - room && high <= most + room;
        let squares = least.abs().max(most.abs()).powi(2);
        // with probability (1 − p)^16 all sets miss the same fraction p of the one point that a jump affects,
        // which no std error shows
        let jumps = [most - least, squares].map(|range| range / f64::from(POINTS));
        let rounding = [8.0 * f64::EPSILON * sums.size, noise(sums.scales())];
        for (order, [mean, std_error]) in scattered.into_iter().enumerate() {
            let accuracy = ACCURACY * sums.scales()[order] + rounding[order];
            agrees &= (mean - sums.moments[order]).abs() <= STD_ERRORS * std_error + jumps[order] + accuracy;
        }
        if agrees {
            Ok(())
        } else {
            Err(refused("its values at scrambled Sobol points do not agree with the quadrature".into()))
        }
    }
}

/// Whether the errors of a moment are small enough, and small if every node moved by a step.
fn accurate(what: &str, errors: f64, steps: f64, allowed: f64) -> Result<()> {
    let steps = 2.0 * steps;
    if errors + steps <= allowed {
        Ok(())
    } else if steps <= 0.5 * allowed {
        Err(refused(format!("its {what} is known only to {errors:.0e}; {allowed:.0e} is needed")))
    } else {
        let steps = "single steps 2⁻⁵³ of the random numbers";
        Err(refused(format!("its {what} depends on {steps}: its variance is infinite, or nearly so")))
    }
}

/// Whether it neither over- nor underflowed.
fn is_zero_or_normal(value: f64) -> bool {
    value == 0.0 || value.is_normal()
}
