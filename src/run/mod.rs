//! Running an estimator: draws in blocks, on all cores, with the same bits for any number of threads.
//!
//! A run of n draws is cut into blocks: 32 to 63 of them, or more where blocks would have over 2¹⁴ draws.
//! Block b draws from [`crate::Stream::new`]`(seed, b)` and the blocks' estimates are merged along a fixed
//! binary tree over b. So the result does not depend on the number of threads or their timing, nor on whether
//! the run is done at once or in [shards](Run::shard) on several machines. Memory does not grow with the
//! number of draws.

use std::fmt;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result, require, require_count, takes};
use crate::estimate::Estimate;
use crate::estimator::Estimator;

mod blocks;
mod part;
mod pilot;
mod work;

pub use part::{Part, merge};
pub(crate) use work::{Watch, walk_block};
use work::{Work, Workers};

/// When a run ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Budget {
    /// After this many draws.
    Draws(u64),
    /// After as many draws as, by a pilot run's variance, make the std error this small, but never fewer than
    /// the pilot's: about 10⁶, or as many as take 2²⁴ random numbers or evaluations. The pilot uses its own
    /// streams and is discarded, so the result is exactly unbiased.
    StdError(f64),
    /// The same for the std error divided by the mean.
    RelativeError(f64),
    /// After as many draws as fit into this time, by the speed of a pilot run that takes a tenth of it, but
    /// at least two. (Stopping by the clock itself would favour draws that are quick to compute, and bias the
    /// mean: Glynn & Heidelberger 1990.) The number of draws depends on the machine; `Draws` with that number
    /// repeats the result.
    Time(Duration),
}

/// Runs an estimator until `budget` is spent, on all cores. The same number of draws and the same seed give
/// the same bits for any number of threads.
///
/// [`Run`] has more options and returns more.
///
/// ```
/// use unbiased::{Budget, estimate, inversion::Exponential};
///
/// let exponential = Exponential::new(0.37)?;
/// let estimate = estimate(&exponential, Budget::Draws(1_000_000), 1)?;
/// assert!(estimate.z(1.0 / 0.37).unwrap().abs() < 5.0);
/// # Ok::<(), unbiased::Error>(())
/// ```
///
/// # Errors
/// If the budget is empty or out of reach, or a draw is NaN or infinite.
pub fn estimate(estimator: &(impl Estimator + ?Sized), budget: Budget, seed: u64) -> Result<Estimate> {
    Ok(Run::new(seed).estimate(estimator, budget)?.estimate)
}

/// The work of a run, in units that do not depend on the machine.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Cost {
    /// Random numbers (64-bit words) taken.
    pub random_numbers: u64,
    /// Evaluations of the integrand (rays, path vertices) that the estimator counted.
    pub evaluations: u64,
}

/// The result of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The estimate.
    pub estimate: Estimate,
    /// The seed it was made with.
    pub seed: u64,
    /// The work, including the pilot's.
    pub cost: Cost,
    /// How long it took, including the pilot.
    pub elapsed: Duration,
    /// The pilot run that determined the number of draws, if the budget is an error.
    ///
    /// If all of its draws were equal, it could not: either the estimator has no variance, or the pilot
    /// missed all of it. A value that a draw takes with probability p is missed by n draws with probability
    /// (1 − p)ⁿ: below 1e-12 for p ≥ 27.6/n, which is 1.7e-6 for the 2²⁴ draws after which a pilot of cheap
    /// draws stops. The run then takes 2²⁰ draws, or as many as the pilot if that had fewer.
    pub pilot: Option<Estimate>,
    /// What was missing for the error asked for, if [`Run::max_time`] ended the run earlier.
    pub shortfall: Option<Shortfall>,
    /// If the run was a [shard](Run::shard): the part to be merged with the others.
    pub part: Option<Part>,
}

/// The draws that the error asked for would have needed. It displays as a clause: "a std error of 6e-4 takes
/// about 1.2e9 draws".
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shortfall {
    /// The std error asked for.
    pub std_error: f64,
    /// The draws needed for it, from the pilot run's variance.
    pub draws: f64,
}

impl fmt::Display for Shortfall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&takes(self.std_error, self.draws))
    }
}

/// A callback for progress: draws done, and the total.
pub type Progress<'a> = dyn Fn(u64, u64) + 'a;

/// A clock: the time since any fixed moment.
pub type Clock<'a> = dyn Fn() -> Duration + Sync + 'a;

/// A run with its options.
///
/// ```
/// use unbiased::{Budget, Run, from_fn};
///
/// let outcome = Run::new(1).threads(1).estimate(&from_fn(|rng| rng.uniform()), Budget::Draws(1000))?;
/// assert_eq!(outcome.cost.random_numbers, 1000);
/// # Ok::<(), unbiased::Error>(())
/// ```
#[derive(Clone, Copy)]
pub struct Run<'a> {
    seed: u64,
    threads: Option<usize>,
    max_draws: u64,
    max_time: Option<Duration>,
    progress: Option<&'a Progress<'a>>,
    clock: Option<&'a Clock<'a>>,
    shard: Option<[u64; 2]>,
}

impl<'a> Run<'a> {
    /// A run with this seed, on all cores; with a budget of an error, at most 10⁹ draws.
    pub fn new(seed: u64) -> Self {
        Self {
            seed,
            threads: None,
            max_draws: 1_000_000_000,
            max_time: None,
            progress: None,
            clock: None,
            shard: None,
        }
    }

    /// Uses this many threads instead of one per core; the result does not depend on it.
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = Some(threads);
        self
    }

    /// Sets the largest number of draws for a budget of an error.
    pub fn max_draws(mut self, max_draws: u64) -> Self {
        self.max_draws = max_draws;
        self
    }

    /// For a budget of an error, takes at most as many draws as fit into this time by the pilot run's speed,
    /// but never fewer than the pilot, which stops growing after a quarter of the time. If the error cannot
    /// be reached, there is no [`Error::Budget`] but an estimate with a [`Shortfall`]. The number of its
    /// draws depends on the machine but not on their values, so it is unbiased; `Budget::Draws` with that
    /// number repeats it.
    ///
    /// ```
    /// use std::time::Duration;
    /// use unbiased::{Budget, Run, from_fn};
    ///
    /// let run = Run::new(1).max_time(Duration::from_millis(50));
    /// let outcome = run.estimate(&from_fn(|rng| rng.uniform()), Budget::StdError(1e-9))?;
    /// println!("{}: {}", outcome.estimate, outcome.shortfall.unwrap());
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    pub fn max_time(mut self, time: Duration) -> Self {
        self.max_time = Some(time);
        self
    }

    /// Calls `progress` between batches of blocks.
    pub fn progress(mut self, progress: &'a Progress<'a>) -> Self {
        self.progress = Some(progress);
        self
    }

    /// Reads the time from this clock instead of the system's. On `wasm32-unknown-unknown` the system has
    /// none, and without this a budget of time is an error.
    pub fn clock(mut self, clock: &'a Clock<'a>) -> Self {
        self.clock = Some(clock);
        self
    }

    /// Takes only shard k of `of` of the run: an equal share of consecutive blocks. Its outcome has a
    /// [`Part`]; [`merge`] of all parts gives the same bits as the whole run at once.
    pub fn shard(mut self, k: u64, of: u64) -> Self {
        self.shard = Some([k, of]);
        self
    }

    /// Runs `estimator` until `budget` is spent.
    ///
    /// # Errors
    /// If a shard is not from 1 to the number of shards, or the budget of a shard is not a number of draws;
    /// if the budget is empty or out of reach, the threads cannot be started, a draw is NaN or infinite, or
    /// the budget is a time and the clock stands still or goes back.
    pub fn estimate(&self, estimator: &(impl Estimator + ?Sized), budget: Budget) -> Result<Outcome> {
        let watch = Watch::start(self.clock);
        if let Some([k, of]) = self.shard {
            require_count("the shard", k, (1..=of).contains(&k), "from 1 to the number of shards")?;
        }
        if self.shard.is_some() && !matches!(budget, Budget::Draws(_)) {
            return Err(Error::Parts {
                reason: "only a run of a given number of draws can be cut into shards".into(),
            });
        }
        let workers = Workers::start(self.threads)?;
        let mut work = Work { run: self, estimator, workers, watch, cost: Cost::default() };
        let (draws, pilot, shortfall) = match budget {
            Budget::Draws(draws) => {
                require_count("the number of draws", draws, draws > 0, "positive")?;
                (draws, None, None)
            }
            Budget::Time(time) => {
                let ok = !time.is_zero() && time <= LONGEST;
                require("the time in seconds", time.as_secs_f64(), ok, "positive and at most 1e6 (12 days)")?;
                (work.draws_in(time)?, None, None)
            }
            Budget::StdError(target) => {
                require("the std error", target, target > 0.0, "positive")?;
                let pilot = work.pilot(|_, std_error| std_error > 0.0)?;
                let (draws, shortfall) = work.needed(&pilot, target)?;
                (draws, Some(pilot), shortfall)
            }
            Budget::RelativeError(target) => {
                require("the relative error", target, target > 0.0, "positive")?;
                let pilot = work.pilot(|mean, std_error| std_error > 0.0 && std_error < 0.25 * mean.abs())?;
                let (draws, shortfall) = work.needed(&pilot, target * pilot.mean().abs())?;
                (draws, Some(pilot), shortfall)
            }
        };
        let blocks = work.all(draws)?;
        let (estimate, seed, cost, elapsed) = (blocks.estimate(), self.seed, work.cost, work.watch.elapsed());
        let part = self.shard.map(|_| Part { seed, draws, blocks, cost, seconds: elapsed.as_secs_f64() });
        Ok(Outcome { estimate, seed, cost, elapsed, pilot, shortfall, part })
    }
}

/// The longest time to run for.
const LONGEST: Duration = Duration::from_secs(1_000_000);
