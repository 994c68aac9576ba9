//! The sequential test of an estimator's mean.

use std::fmt;

use rayon::prelude::*;

use super::wealth::{Bets, Growth, Wealth};
use crate::error::{Error, Result, require};
use crate::estimate::Estimate;
use crate::estimator::Estimator;
use crate::run::walk_block;

/// What a check says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The mean is not the truth; this is wrong with probability at most α.
    Biased,
    /// The mean is within δ of the truth; this is wrong with probability at most 2β.
    Unbiased,
    /// Neither could be shown with the draws allowed: a failure of the check, not a pass.
    Undecided,
}

/// Checks whether `estimator`, whose draws lie in `range`, has the mean `truth` to within one part in a
/// thousand, of the range where the truth is 0.
///
/// The short form of [`Unbiased`], with its error probabilities: a right estimator is called biased with
/// probability at most 1e-12.
///
/// # Errors
/// Those of [`Unbiased::new`] and [`Unbiased::run`].
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
pub fn unbiased(estimator: &(impl Estimator + ?Sized), truth: f64, range: [f64; 2]) -> Result<Report> {
    Unbiased::new(truth, range)?.run(estimator)
}

/// A sequential test of an estimator's mean, valid at every sample size and without the central limit
/// theorem, for draws in a known range.
///
/// It bets against the claim that the mean is μ, upwards and downwards (see the module's sources). If the
/// claim holds, the probability that the mean of both wealths ever reaches 1/α is at most α: then the
/// estimator is called *biased*. It is called *unbiased within δ* once a bettor against the mean μ(1 − δ) who
/// bets upwards, and one against μ(1 + δ) who bets downwards, have each made 1/β. A right estimator takes
/// about 40 σ²/(δμ)² draws; a factor of 2 is refuted in some hundred.
///
/// For draws in [0, ∞) the range's upper end may be infinite: too large a mean is then still refuted, but
/// none can be certified.
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
    beta: f64,
    seed: u64,
    max_draws: u64,
}

/// A check's verdict, and what it rests on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Report {
    /// The verdict.
    pub verdict: Verdict,
    /// The mean claimed.
    pub truth: f64,
    /// The mean found.
    pub estimate: Estimate,
    /// The largest difference that is taken for none, |δμ|.
    pub tolerance: f64,
    /// The probability of calling a right estimator biased.
    pub alpha: f64,
    /// The seed of all draws.
    pub seed: u64,
}

/// The bettors' wealth after some of a check's draws, as natural logarithms: 0 at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// The draws so far.
    pub draws: u64,
    /// ln of the mean wealth of the two who bet against the truth, upwards and downwards: *biased* once it
    /// reaches ln(1/α).
    pub against_truth: f64,
    /// ln of the wealth of who bets upwards against the truth less the tolerance: too low a mean is excluded
    /// once it reaches ln(1/β).
    pub against_too_low: f64,
    /// ln of the wealth of who bets downwards against the truth plus the tolerance; stays 0 where the range
    /// has no upper end.
    pub against_too_high: f64,
}

impl Unbiased {
    /// Checks against the mean `truth`, for draws in `range`, with δ = 1e-3, α = 1e-12, β = 1e-6, seed 1 and
    /// at most 10⁹ draws. Where the truth is 0, which no relative tolerance is a part of, a difference of
    /// 1e-3 of the range counts as none, or of the distance to its lower end where the upper one is infinite.
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
        // less where the truth is close to an end, beyond which nothing can be told apart
        let tolerance = (1e-3 * unit).min(0.5 * (truth - low)).min(0.5 * (high - truth));
        require("the tolerance, a part in a thousand,", tolerance, tolerance > 0.0, "positive")?;
        Ok(Self { truth, low, high, tolerance, alpha: 1e-12, beta: 1e-6, seed: 1, max_draws: 1_000_000_000 })
    }

    /// Takes a relative difference of at most δ for none.
    ///
    /// # Errors
    /// If δ is not positive, the truth is 0 (see [`within_absolute`](Self::within_absolute)), or μ(1 ± δ)
    /// leaves the range.
    pub fn within(self, delta: f64) -> Result<Self> {
        require("the tolerance δ", delta, delta > 0.0, "positive")?;
        require("the truth of a relative tolerance", self.truth, self.truth != 0.0, "other than 0")?;
        self.within_absolute(delta * self.truth.abs())
    }

    /// Takes a difference of at most this for none.
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

    /// Calls a right estimator biased with probability at most α.
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

    /// Certifies each side with an error probability of at most β.
    ///
    /// # Errors
    /// If β is not strictly between 0 and 1.
    pub fn beta(mut self, beta: f64) -> Result<Self> {
        self.beta =
            require("the error probability β", beta, beta > 0.0 && beta < 1.0, "strictly between 0 and 1")?;
        Ok(self)
    }

    /// Draws with this seed.
    pub fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Gives up after this many draws.
    pub fn max_draws(mut self, max_draws: u64) -> Self {
        self.max_draws = max_draws;
        self
    }

    /// Draws from `estimator` until there is a verdict. It is the same for any number of threads.
    ///
    /// # Errors
    /// If a draw is not finite, or leaves the range: the proof would be void. (By up to 1e-12 of the range it
    /// is rounding.)
    pub fn run(&self, estimator: &(impl Estimator + ?Sized)) -> Result<Report> {
        self.watch(estimator, |_| ())
    }

    /// The same, with the bettors' wealth on the way: a look at least every 256 draws, the last one the
    /// verdict's.
    ///
    /// # Errors
    /// Those of [`run`](Self::run).
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
        // slow draws that are far off are few: the first looks come soon
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
                    above |= up_low >= -self.beta.ln();
                    below |= self.high.is_finite() && down_high >= -self.beta.ln();
                    if two_sided >= -self.alpha.ln() {
                        return Ok(self.report(Verdict::Biased, estimate));
                    }
                    if above && below {
                        return Ok(self.report(Verdict::Unbiased, estimate));
                    }
                }
            }
            if estimate.draws() >= self.patience(&estimate) {
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

    /// Bets upwards and downwards against the truth, upwards against what is just too low and downwards
    /// against what is just too high.
    fn bettors(&self) -> [Bets; 4] {
        let (up, down) = (self.truth - self.low, self.high - self.truth);
        let range = self.high - self.low;
        // the best bet on a difference of d is d·μ/σ², at least d over the other side's room, since σ² ≤
        // up·down; without an upper end, a σ of ten times the mean is provided for
        let timid = |room: f64| {
            let room = if room.is_finite() { room } else { 100.0 * up };
            (self.tolerance / room).clamp(1e-12, 1e-3)
        };
        [
            Bets::against(up, range, timid(down)),
            Bets::against(down, range, timid(up)),
            Bets::against(up - self.tolerance, range, timid(down)),
            Bets::against(down - self.tolerance, range, timid(up)),
        ]
    }

    /// One block of so many draws, in leaves of up to [`LEAF`].
    fn leaves(
        &self,
        estimator: &(impl Estimator + ?Sized),
        [up, down, up_low, down_high]: &[Bets; 4],
        block: u64,
        size: u64,
    ) -> Result<Vec<Leaf>> {
        let Self { seed, low, high, .. } = *self;
        // rounding may take a draw past an end, by a part of the range or of the end itself
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

    /// The draws after which nothing more is expected: twice what a right estimator of this variance needs
    /// but for one run in a million.
    fn patience(&self, estimate: &Estimate) -> u64 {
        let bound = -self.beta.ln() + 10f64.ln();
        let deviations = (2.0 * bound).sqrt() + 7.0;
        // of the std deviation, since a variance may be beyond f64
        let deviation = estimate.std_error().unwrap_or(0.0) * (estimate.draws() as f64).sqrt();
        let spread = (deviation / self.tolerance).powi(2);
        // an estimator that hardly varies still gains only about d/room a draw, on the side with the larger
        // room
        let (up, down) = (self.truth - self.low, self.high - self.truth);
        let room = if down.is_finite() { up.max(down) } else { up };
        let draws = 2.0 * spread * deviations * deviations + 4.0 * bound * room / self.tolerance;
        (draws.ceil() as u64).min(self.max_draws)
    }
}

/// Draws between two looks at the wealth, at most.
const LEAF: usize = 256;

/// Draws in a block: in the first one, and at most.
const FIRST_BLOCK: u64 = 16;
const LARGEST_BLOCK: u64 = 1 << 14;

/// Blocks in flight at a time.
const MOST_BLOCKS: u64 = 64;

/// What some draws did to the estimate and to each bettor's wealth.
struct Leaf {
    estimate: Estimate,
    growths: [Growth; 4],
}

impl Report {
    /// The mean found, divided by the truth, with its std error.
    pub fn ratio(&self) -> (f64, f64) {
        let std_error = self.estimate.std_error().unwrap_or(f64::INFINITY);
        (self.estimate.mean() / self.truth, std_error / self.truth.abs())
    }
}

/// The verdict in a sentence.
impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (truth, estimate, draws) = (self.truth, self.estimate, self.estimate.draws());
        match self.verdict {
            Verdict::Unbiased => {
                write!(
                    f,
                    "unbiased within {:.1e}: {estimate} after {draws} draws, the truth is {truth}",
                    self.tolerance
                )
            }
            Verdict::Biased => {
                let (ratio, error) = self.ratio();
                write!(
                    f,
                    "biased: {estimate} after {draws} draws, {ratio:.3} ± {error:.3} times the truth \
                     {truth}; \
                     a right estimator would be called so with probability {:.0e} at most",
                    self.alpha
                )
            }
            Verdict::Undecided => {
                write!(
                    f,
                    "undecided after {draws} draws: {estimate}, the truth is {truth} and a difference of \
                     {:.1e} was to be seen",
                    self.tolerance
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The exact probability that the check calls draws of two values, 0 and 1, with the mean claimed biased
    /// within `leaves` leaves: by dynamic programming over the number of ones.
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
        // the law of the ones in a leaf
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

    /// Exact, not simulated: the rate is below α at every level, by a factor of 2 to 1000 over the first
    /// 15,000 draws.
    #[test]
    fn false_alarms_of_two_point_draws_stay_below_alpha_at_every_level() {
        for mean in [0.5, 0.1, 0.83] {
            for alpha in [1e-1, 1e-3, 1e-6, 1e-9, 1e-12] {
                let rate = false_alarm(mean, alpha, 60);
                println!("mean {mean}, α = {alpha:e}: {rate:.2e}, {:.1} times below", alpha / rate);
                assert!(rate <= alpha, "mean {mean}, α = {alpha:e}: {rate:e}");
                assert!(rate >= 1e-3 * alpha, "mean {mean}, α = {alpha:e}: {rate:e}, the bets are too timid");
            }
        }
    }
}
