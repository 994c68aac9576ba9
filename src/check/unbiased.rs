//! A sequential test of an estimator's mean.

use rayon::prelude::*;

use super::report::{Look, Report, Verdict};
use super::wealth::{Bets, Growth, Wealth};
use crate::error::{Error, Result, require};
use crate::estimate::Estimate;
use crate::estimator::Estimator;
use crate::run::walk_block;

/// Checks whether `estimator`, whose draws lie in `range`, has the mean `truth` to within 0.1 % of the truth,
/// or of the range where the truth is 0.
///
/// The short form of [`Unbiased`] with its default settings: a right estimator is called biased with
/// probability at most 1e-12.
///
/// ```
/// use unbiased::{check, check::Verdict, from_fn};
///
/// let right = from_fn(|rng| 3.0 * rng.uniform().powi(2)); // E[3U²] = 1, in [0, 3]
/// assert_eq!(check::unbiased(&right, 1.0, [0.0, 3.0])?.verdict, Verdict::Unbiased);
///
/// let wrong = from_fn(|rng| 2.0 * rng.uniform().powi(2)); // the 3 taken for a 2
/// assert_eq!(check::unbiased(&wrong, 1.0, [0.0, 3.0])?.verdict, Verdict::Biased);
/// # Ok::<(), unbiased::Error>(())
/// ```
///
/// # Errors
/// Those of [`Unbiased::new`] and [`Unbiased::run`].
pub fn unbiased(estimator: &(impl Estimator + ?Sized), truth: f64, range: [f64; 2]) -> Result<Report> {
    Unbiased::new(truth, range)?.run(estimator)
}

/// A sequential test of an estimator's mean, valid for every number of draws and without the central limit
/// theorem, for draws in a known range.
///
/// It bets against the claim that the mean is μ: one bettor bets that the mean is larger, one that it is
/// smaller, each starting with a wealth of 1. If the claim holds, the average of the two wealths ever reaches
/// 1/α with probability at most α; once it does, the estimator is called *biased*. It is called *unbiased
/// within δ* once a bettor who bets that the mean is larger than μ(1 − δ), and one who bets that it is
/// smaller than μ(1 + δ), have each reached 1/β = 10⁶. A right estimator takes about 40 σ²/(δμ)² draws; a
/// factor of 2 is refuted after some hundred.
///
/// The range's upper end may be infinite: then a mean that is too large can be refuted, but no estimator can
/// be called unbiased.
///
/// Sources: Ville 1939; Waudby-Smith & Ramdas 2024; for tests of renderers Subr & Arvo 2007; Gandy & Scott
/// 2020; Jung, Hanika & Dachsbacher 2020.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unbiased {
    truth: f64,
    low: f64,
    high: f64,
    tolerance: f64,
    alpha: f64,
    seed: u64,
    max_draws: u64,
}

impl Unbiased {
    /// A check for the mean `truth`, for draws in `range`, with δ = 1e-3, α = 1e-12, seed 1 and at most 10⁹
    /// draws. If the truth is 0, the tolerance is 1e-3 of the range, or of the distance to its lower
    /// end if the upper one is infinite.
    ///
    /// # Errors
    /// If the range is empty or NaN, its lower end infinite, or the truth not strictly inside it.
    pub fn new(truth: f64, [low, high]: [f64; 2]) -> Result<Self> {
        require("the range's lower end", low, low.is_finite(), "finite")?;
        require("the range's upper end", high, high > low, "above the lower end")?;
        let ok = high == f64::INFINITY || (high - low).is_finite();
        require("the range's length", high - low, ok, "within f64")?;
        let inside = low < truth && truth < high;
        require("the truth", truth, inside, "strictly inside the range of the draws")?;
        let range = if high.is_finite() { high - low } else { truth - low };
        let unit = if truth == 0.0 { range } else { truth.abs() };
        // smaller if the truth is close to an end of the range, which truth ± tolerance must not reach
        let tolerance = (1e-3 * unit).min(0.5 * (truth - low)).min(0.5 * (high - truth));
        require("the tolerance, a part in a thousand,", tolerance, tolerance > 0.0, "positive")?;
        Ok(Self { truth, low, high, tolerance, alpha: 1e-12, seed: 1, max_draws: 1_000_000_000 })
    }

    /// Sets the tolerance to δ times the truth.
    ///
    /// # Errors
    /// If δ is not positive, the truth is 0 (see [`within_absolute`](Self::within_absolute)), or μ(1 ± δ)
    /// leaves the range.
    pub fn within(self, delta: f64) -> Result<Self> {
        require("the tolerance δ", delta, delta > 0.0, "positive")?;
        require("the truth of a relative tolerance", self.truth, self.truth != 0.0, "other than 0")?;
        self.within_absolute(delta * self.truth.abs())
    }

    /// Sets the tolerance, in the truth's unit.
    ///
    /// # Errors
    /// If it is not positive, or the truth ± the tolerance leaves the range.
    pub fn within_absolute(mut self, tolerance: f64) -> Result<Self> {
        let room = (self.truth - self.low).min(self.high - self.truth);
        let ok = tolerance > 0.0 && tolerance < room;
        self.tolerance = require(
            "the tolerance",
            tolerance,
            ok,
            "positive and less than the truth's distance from the range's ends",
        )?;
        Ok(self)
    }

    /// Sets α, the largest probability of calling a right estimator biased.
    ///
    /// # Errors
    /// If α is not strictly between 0 and 1.
    pub fn alpha(mut self, alpha: f64) -> Result<Self> {
        self.alpha = require(
            "the false-alarm probability α",
            alpha,
            alpha > 0.0 && alpha < 1.0,
            "strictly between 0 and 1",
        )?;
        Ok(self)
    }

    /// Sets the seed of the draws.
    pub fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Gives up after this many draws.
    pub fn max_draws(mut self, max_draws: u64) -> Self {
        self.max_draws = max_draws;
        self
    }

    /// Draws from `estimator` until there is a verdict, which does not depend on the number of threads.
    ///
    /// # Errors
    /// If a draw is not finite, or is outside the range by more than 1e-12 of it: the error probabilities
    /// would not hold.
    pub fn run(&self, estimator: &(impl Estimator + ?Sized)) -> Result<Report> {
        self.watch(estimator, |_| ())
    }

    /// Like [`run`](Self::run), and returns the bettors' wealth at least every 256 draws; the last entry is
    /// that at the verdict.
    ///
    /// ```
    /// use unbiased::{check::Unbiased, from_fn};
    ///
    /// let wrong = from_fn(|rng| 2.0 * rng.uniform().powi(2)); // E[3U²] = 1, the 3 taken for a 2
    /// let (report, looks) = Unbiased::new(1.0, [0.0, 3.0])?.trace(&wrong)?;
    /// let last = looks.last().unwrap();
    /// assert_eq!(last.draws, report.estimate.draws());
    /// assert!(last.against_truth >= 1e12f64.ln());
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`run`](Self::run).
    pub fn trace(&self, estimator: &(impl Estimator + ?Sized)) -> Result<(Report, Vec<Look>)> {
        let mut looks = Vec::new();
        let report = self.watch(estimator, |look| looks.push(look))?;
        Ok((report, looks))
    }

    fn watch(&self, estimator: &(impl Estimator + ?Sized), mut each: impl FnMut(Look)) -> Result<Report> {
        let bettors = self.bettors();
        let mut wealths: [Wealth; 4] = Default::default();
        let (mut above, mut below) = (false, false);
        let mut estimate = Estimate::new();
        // a badly wrong estimator is refuted by few draws: begin with small blocks
        let (mut next, mut batch, mut size) = (0, 1, FIRST_BLOCK);
        loop {
            let blocks: Vec<_> = (next..next + batch)
                .into_par_iter()
                .map(|block| self.leaves(estimator, &bettors, block, size))
                .collect();
            for leaves in blocks {
                for leaf in leaves? {
                    estimate.merge(&leaf.estimate);
                    for (wealth, growth) in wealths.iter_mut().zip(&leaf.growths) {
                        wealth.grow(growth);
                    }
                    let [up, down, up_low, down_high] = wealths.each_ref().map(Wealth::log_mean);
                    let two_sided = up.max(down) + (0.5 + 0.5 * (-(up - down).abs()).exp()).ln();
                    each(Look {
                        draws: estimate.draws(),
                        against_truth: two_sided,
                        against_too_low: up_low,
                        against_too_high: down_high,
                    });
                    above |= up_low >= -BETA.ln();
                    below |= self.high.is_finite() && down_high >= -BETA.ln();
                    if two_sided >= -self.alpha.ln() {
                        return Ok(self.report(Verdict::Biased, estimate));
                    }
                    if above && below {
                        return Ok(self.report(Verdict::Unbiased, estimate));
                    }
                }
            }
            if estimate.draws() >= self.most_useful_draws(&estimate) {
                return Ok(self.report(Verdict::Undecided, estimate));
            }
            next += batch;
            if size < LARGEST_BLOCK {
                size *= 2;
            } else {
                batch = (2 * batch).min(MOST_BLOCKS);
            }
        }
    }

    fn report(&self, verdict: Verdict, estimate: Estimate) -> Report {
        let Self { truth, tolerance, alpha, seed, .. } = *self;
        Report { verdict, truth, estimate, tolerance, alpha, seed }
    }

    /// The four bets: that the mean is larger than the truth, smaller than the truth, larger than truth −
    /// tolerance, and smaller than truth + tolerance.
    fn bettors(&self) -> [Bets; 4] {
        let (up, down) = (self.truth - self.low, self.high - self.truth);
        let range = self.high - self.low;
        // for a difference d the best fraction is d·μ/σ², at least d/(room on the other side), since σ² ≤
        // up·down; without an upper end, assume σ of at most ten times the mean
        let smallest = |room: f64| {
            let room = if room.is_finite() { room } else { 100.0 * up };
            (self.tolerance / room).clamp(1e-12, 1e-3)
        };
        [
            Bets::against(up, range, smallest(down)),
            Bets::against(down, range, smallest(up)),
            Bets::against(up - self.tolerance, range, smallest(down)),
            Bets::against(down - self.tolerance, range, smallest(up)),
        ]
    }

    /// One block of `size` draws, in leaves of up to [`LEAF`].
    fn leaves(
        &self,
        estimator: &(impl Estimator + ?Sized),
        [up, down, up_low, down_high]: &[Bets; 4],
        block: u64,
        size: u64,
    ) -> Result<Vec<Leaf>> {
        let Self { seed, low, high, .. } = *self;
        // rounding may push a draw slightly past an end
        let reach = if high.is_finite() { high - low } else { self.truth - low };
        let slack = |end: f64| 1e-12 * reach + 4.0 * f64::EPSILON * end.abs();
        let inside = low - slack(low)..=if high.is_finite() { high + slack(high) } else { high };
        let from_low = |draw: f64| (draw - low).max(0.0);
        let from_high = |draw: f64| (high - draw).max(0.0);
        let (mut leaves, mut done) = (Vec::new(), 0);
        walk_block(estimator, seed, block, size, |slice| {
            for draws in slice.chunks(LEAF) {
                if let Some(draw) = draws.iter().position(|draw| !inside.contains(draw)) {
                    let (value, draw) = (draws[draw], done + draw as u64);
                    return Err(Error::OutOfRange { seed, block, draw, value, range: [low, high] });
                }
                let downwards = |bets: &Bets| {
                    if high.is_finite() { bets.growth(draws, from_high) } else { Growth::default() }
                };
                leaves.push(Leaf {
                    estimate: Estimate::from_draws(draws),
                    growths: [
                        up.growth(draws, from_low),
                        downwards(down),
                        up_low.growth(draws, from_low),
                        downwards(down_high),
                    ],
                });
                done += draws.len() as u64;
            }
            Ok(())
        })?;
        Ok(leaves)
    }

    /// The draws after which to give up: twice what a right estimator of this variance needs in all but one
    /// of a million runs.
    fn most_useful_draws(&self, estimate: &Estimate) -> u64 {
        let bound = -BETA.ln() + 10f64.ln();
        let deviations = (2.0 * bound).sqrt() + 7.0;
        // not by the variance, which may overflow
        let deviation = estimate.std_error().unwrap_or(0.0) * (estimate.draws() as f64).sqrt();
        let spread = (deviation / self.tolerance).powi(2);
        // even without variance the wealth grows only by a factor of about 1 + d/room per draw, on the side
        // with more room
        let (up, down) = (self.truth - self.low, self.high - self.truth);
        let room = if down.is_finite() { up.max(down) } else { up };
        let draws = 2.0 * spread * deviations * deviations + 4.0 * bound * room / self.tolerance;
        (draws.ceil() as u64).min(self.max_draws)
    }
}

/// The probability that a mean is wrongly called large enough, or small enough.
const BETA: f64 = 1e-6;

/// The most draws between two looks at the wealth.
const LEAF: usize = 256;

/// Draws in the first block, and in the largest ones.
const FIRST_BLOCK: u64 = 16;
const LARGEST_BLOCK: u64 = 1 << 14;

/// Blocks computed at a time.
const MOST_BLOCKS: u64 = 64;

/// The estimate from some draws, and the growth of each bettor's wealth by them.
struct Leaf {
    estimate: Estimate,
    growths: [Growth; 4],
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The exact probability that the check calls draws of 0 and 1 with the claimed mean biased within
    /// `leaves` leaves, by dynamic programming over the number of ones.
    fn false_alarm(mean: f64, alpha: f64, leaves: usize) -> f64 {
        let check = Unbiased::new(mean, [0.0, 1.0]).unwrap().within(0.01).unwrap();
        let [up, down, ..] = check.bettors();
        let per_draw = [
            [up.growth(&[0.0], |y| y), up.growth(&[1.0], |y| y)],
            [down.growth(&[0.0], |y| 1.0 - y), down.growth(&[1.0], |y| 1.0 - y)],
        ];
        let wealth = |draws: usize, ones: usize| {
            let side = |[zero, one]: &[Growth; 2]| {
                let bets = zero
                    .iter()
                    .zip(one)
                    .map(|(zero, one)| ((draws - ones) as f64 * zero + ones as f64 * one).exp());
                bets.sum::<f64>() / zero.len() as f64
            };
            0.5 * (side(&per_draw[0]) + side(&per_draw[1]))
        };
        // the distribution of the number of ones in a leaf
        let mut leaf = vec![(1.0 - mean).powi(LEAF as i32)];
        for k in 0..LEAF {
            leaf.push(leaf[k] * (LEAF - k) as f64 / (k + 1) as f64 * mean / (1.0 - mean));
        }
        let mut alive = vec![1.0];
        let mut alarm = 0.0;
        for leaf_number in 1..=leaves {
            let mut next = vec![0.0; alive.len() + LEAF];
            for (ones, probability) in
                alive.iter().enumerate().filter(|(_, probability)| **probability > 1e-25)
            {
                for (more, share) in leaf.iter().enumerate() {
                    next[ones + more] += probability * share;
                }
            }
            for (ones, probability) in next.iter_mut().enumerate() {
                if *probability > 1e-25 && wealth(leaf_number * LEAF, ones) >= 1.0 / alpha {
                    alarm += *probability;
                    *probability = 0.0;
                }
            }
            alive = next;
        }
        alarm
    }

    /// Computed exactly: the rate is below α at every level, by a factor of 2 to 1000 over the first 15,000
    /// draws.
    #[test]
    fn false_alarms_of_two_point_draws_stay_below_alpha_at_every_level() {
        for mean in [0.5, 0.1, 0.83] {
            for alpha in [1e-1, 1e-3, 1e-6, 1e-9, 1e-12] {
                let rate = false_alarm(mean, alpha, 60);
                println!("mean {mean}, α = {alpha:e}: {rate:.2e}, {:.1} times below", alpha / rate);
                assert!(rate <= alpha, "mean {mean}, α = {alpha:e}: {rate:e}");
                assert!(rate >= 1e-3 * alpha, "mean {mean}, α = {alpha:e}: {rate:e}, the bets are too small");
            }
        }
    }
}
