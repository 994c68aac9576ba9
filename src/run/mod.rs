//! Running an estimator: draws in blocks, on all cores, with the same bits for any number of threads.
//!
//! A run of n draws is cut into blocks: 32 to 63 of them, or more where blocks would have over 2¹⁴ draws.
//! Block b draws from [`Stream::new`]`(seed, b)` and the blocks' estimates are merged along a fixed binary
//! tree over b. So the result does not depend on the number of threads or their timing, nor on whether the
//! run is done at once or in [shards](Run::shard) on several machines. Memory does not grow with the number
//! of draws.

use std::fmt;
use std::ops::Range;
use std::time::{Duration, Instant};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result, require, require_count, takes};
use crate::estimate::{Estimate, SLICE};
use crate::estimator::Estimator;
use crate::fast;
use crate::stream::{Stream, mix};

mod part;

use part::Blocks;
pub use part::{Part, merge};

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

impl Outcome {
    /// Whether all draws of the pilot run were equal, so that the number of draws could not be determined
    /// from it: either the estimator has no variance, or the pilot missed all of it. A value that a draw
    /// takes with probability p is missed by n draws with probability (1 − p)ⁿ: below 1e-12 for p ≥ 27.6/n,
    /// which is 1.7e-6 for the 2²⁴ draws after which a pilot of cheap draws stops. The run then takes 2²⁰
    /// draws, or as many as the pilot if that had fewer.
    pub fn pilot_never_varied(&self) -> bool {
        self.pilot.is_some_and(|pilot| pilot.std_error() == Some(0.0))
    }
}

/// A callback for progress: draws done, and the total if it is known.
pub type Progress<'a> = dyn Fn(u64, Option<u64>) + 'a;

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
        let mut work = Work { estimator, workers: self.workers()?, cost: Cost::default() };
        let by_count = |blocks: Blocks| (blocks, None, None);
        let (blocks, pilot, shortfall) = match budget {
            Budget::Draws(draws) => {
                require_count("the number of draws", draws, draws > 0, "positive")?;
                by_count(self.run_draws(&mut work, &watch, draws)?)
            }
            Budget::Time(time) => {
                let ok = !time.is_zero() && time <= LONGEST;
                require("the time in seconds", time.as_secs_f64(), ok, "positive and at most 1e6 (12 days)")?;
                let draws = self.draws_in(&mut work, &watch, time)?;
                by_count(self.run_draws(&mut work, &watch, draws)?)
            }
            Budget::StdError(target) => {
                require("the std error", target, target > 0.0, "positive")?;
                let pilot = self.pilot(&mut work, &watch, |_, std_error| std_error > 0.0)?;
                let (draws, shortfall) = self.needed(&pilot, &watch, target)?;
                (self.run_draws(&mut work, &watch, draws)?, Some(pilot), shortfall)
            }
            Budget::RelativeError(target) => {
                require("the relative error", target, target > 0.0, "positive")?;
                let pilot = self.pilot(&mut work, &watch, |mean, std_error| {
                    std_error > 0.0 && std_error < 0.25 * mean.abs()
                })?;
                let target = target * pilot.mean().abs();
                let (draws, shortfall) = self.needed(&pilot, &watch, target)?;
                (self.run_draws(&mut work, &watch, draws)?, Some(pilot), shortfall)
            }
        };
        let (estimate, seed, cost, elapsed) = (blocks.estimate(), self.seed, work.cost, watch.elapsed());
        let part = match budget {
            Budget::Draws(draws) if self.shard.is_some() => {
                Some(Part::of(seed, draws, blocks, cost, elapsed))
            }
            _ => None,
        };
        Ok(Outcome { estimate, seed, cost, elapsed, pilot, shortfall, part })
    }

    fn workers(&self) -> Result<Workers> {
        let Some(threads) = self.threads else { return Ok(Workers::AllCores) };
        let ok = (1..=MOST_THREADS).contains(&threads);
        require_count("the number of threads", threads as u64, ok, "from 1 to 1024")?;
        if threads == 1 {
            return Ok(Workers::Caller);
        }
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map(Workers::Own)
            .map_err(|error| Error::Threads { threads, reason: error.to_string() })
    }

    fn run_draws<E: Estimator + ?Sized>(
        &self,
        work: &mut Work<'_, E>,
        watch: &Watch<'_>,
        draws: u64,
    ) -> Result<Blocks> {
        let [k, of] = self.shard.unwrap_or([1, 1]).map(u128::from);
        let all = u128::from(draws.div_ceil(block_size(draws)));
        let [mut next, end] = [k - 1, k].map(|k| (all * k / of) as u64);
        let (mut blocks, mut batch) = (Blocks::from(next), FIRST_BATCH);
        while next < end {
            let start = watch.elapsed();
            let until = next.saturating_add(batch).min(end);
            work.extend(&mut blocks, self.seed, next..until, draws)?;
            next = until;
            self.report(blocks.draws(), draws);
            // short enough to report progress, long enough to keep all cores busy
            if watch.elapsed().saturating_sub(start) < BATCH_TIME {
                batch = (2 * batch).min(LARGEST_BATCH);
            }
        }
        Ok(blocks)
    }

    /// How many draws fit into `time`, by the speed of all threads in a pilot run of a tenth of it. The
    /// pilot's draws use other streams and are discarded, so the number is independent of the run's values.
    fn draws_in<E: Estimator + ?Sized>(
        &self,
        work: &mut Work<'_, E>,
        watch: &Watch<'_>,
        time: Duration,
    ) -> Result<u64> {
        let (start, seed) = (watch.elapsed(), mix(self.seed ^ PILOT_SALT));
        let until = start + time.saturating_sub(start) / 10;
        let estimator = work.estimator;
        let pace = |thread: usize| pace(estimator, seed, thread as u64, watch, [start, until]);
        let paces = match &work.workers {
            Workers::Caller => vec![pace(0)],
            Workers::AllCores => rayon::broadcast(|context| pace(context.index())),
            Workers::Own(pool) => pool.broadcast(|context| pace(context.index())),
        };
        let mut draws_per_second = 0.0;
        for pace in paces {
            let (draws_in_a_second, cost) = pace?;
            draws_per_second += draws_in_a_second;
            work.cost.add(cost);
        }
        let left = time.saturating_sub(watch.elapsed()).as_secs_f64();
        // a float-to-int cast saturates
        Ok(((draws_per_second * left) as u64).max(2))
    }

    /// The pilot run: doubles its draws, from streams of its own, until mean and std error are `enough` or
    /// the limit on draws is reached; without any variance, until [`CONSTANT_WORK`].
    fn pilot<E: Estimator + ?Sized>(
        &self,
        work: &mut Work<'_, E>,
        watch: &Watch<'_>,
        enough: impl Fn(f64, f64) -> bool,
    ) -> Result<Estimate> {
        let mut pilot = Estimate::new();
        let late = |part: f64| self.max_time.is_some_and(|time| watch.elapsed() >= time.mul_f64(part));
        for stage in 0.. {
            let draws = pilot.draws().max(FIRST_STAGE).min(self.max_draws.max(2) - pilot.draws());
            let mut more = Blocks::from(0);
            let seed = mix(self.seed ^ PILOT_SALT.wrapping_add(stage));
            work.extend(&mut more, seed, 0..u64::MAX, draws)?;
            pilot.merge(&more.estimate());
            let work = pilot.draws().max(work.cost.work() / 16);
            let std_error = pilot.std_error().unwrap_or(0.0);
            let long_enough = work >= PILOT_WORK && enough(pilot.mean(), std_error);
            let still = std_error == 0.0 && work >= CONSTANT_WORK;
            if long_enough || still || late(0.25) || pilot.draws() >= self.max_draws.max(2) {
                break;
            }
        }
        Ok(pilot)
    }

    /// The draws to take for a std error of `target`, by the pilot's variance, and the shortfall if time is
    /// short.
    fn needed(&self, pilot: &Estimate, watch: &Watch<'_>, target: f64) -> Result<(u64, Option<Shortfall>)> {
        let reached = pilot.std_error().unwrap_or(0.0);
        // fewer draws than the pilot's might miss rare values that the pilot found
        let fewest = pilot.draws();
        if reached == 0.0 {
            return Ok((fewest.min(PILOT_WORK), None));
        }
        let needed = (fewest as f64 * (reached / target).powi(2)).ceil().max(fewest as f64).min(f64::MAX);
        let limit = match self.max_time {
            Some(time) => {
                let elapsed = watch.elapsed().as_secs_f64();
                let times = (time.as_secs_f64() - elapsed) / elapsed.max(1e-9);
                ((fewest as f64 * times) as u64).min(self.max_draws).max(fewest)
            }
            None => self.max_draws.max(fewest),
        };
        if needed <= limit as f64 {
            Ok((needed as u64, None))
        } else if self.max_time.is_some() {
            Ok((limit, Some(Shortfall { std_error: target, draws: needed })))
        } else {
            Err(Error::Budget { std_error: target, needed, limit: self.max_draws })
        }
    }

    fn report(&self, draws: u64, total: u64) {
        if let Some(progress) = self.progress {
            progress(draws, Some(total));
        }
    }
}

/// The largest number of threads.
const MOST_THREADS: usize = 1024;

/// The longest time to run for.
const LONGEST: Duration = Duration::from_secs(1_000_000);

/// The fewest blocks of a run (if it has as many draws): enough to keep all threads busy to the end.
const BLOCKS: u64 = 32;

/// The most draws in a block.
const LARGEST_BLOCK: u64 = 1 << 14;

/// Blocks between two reports of progress: at first, and at most.
const FIRST_BATCH: u64 = 64;
const LARGEST_BATCH: u64 = 1024;

/// Batches that take less time than this are doubled.
const BATCH_TIME: Duration = Duration::from_millis(50);

/// Draws in a pilot run's first stage.
const FIRST_STAGE: u64 = 64;

/// Draws of a pilot run of cheap draws: its std error is accurate to 0.1 % if the draws' fourth moment is
/// that of a normal distribution. A draw with more than 16 random numbers or evaluations counts as more than
/// one.
const PILOT_WORK: u64 = 1 << 20;

/// Draws (counted likewise) after which a pilot run without variance ends.
const CONSTANT_WORK: u64 = 1 << 24;

/// Makes the pilot's seeds differ from the run's.
const PILOT_SALT: u64 = 0x7069_6c6f_7420_7275;

/// The threads that compute draws.
enum Workers {
    /// Only the calling one: starting another takes as long as ten thousand cheap draws.
    Caller,
    AllCores,
    Own(rayon::ThreadPool),
}

/// The estimator, its threads, and the work done so far.
struct Work<'e, E: ?Sized> {
    estimator: &'e E,
    workers: Workers,
    cost: Cost,
}

impl<E: Estimator + ?Sized> Work<'_, E> {
    /// Computes these blocks of a run of `draws` draws.
    fn extend(&mut self, blocks: &mut Blocks, seed: u64, range: Range<u64>, draws: u64) -> Result<()> {
        let size = block_size(draws);
        let estimator = self.estimator;
        let one = |block| one_block(estimator, seed, block, size.min(draws - block * size));
        let (first, end) = (range.start, range.end.min(draws.div_ceil(size)));
        // one block per task, so that a slow block does not delay others
        let count = usize::try_from(end.saturating_sub(first)).unwrap_or(usize::MAX);
        let side_by_side = || -> Vec<_> {
            (0..count).into_par_iter().with_max_len(1).map(|n| one(first + n as u64)).collect()
        };
        let results = match &self.workers {
            Workers::Caller => (first..end).map(one).collect(),
            Workers::AllCores => side_by_side(),
            Workers::Own(pool) => pool.install(side_by_side),
        };
        for result in results {
            let (of_block, cost) = result?;
            blocks.push(&of_block);
            self.cost.add(cost);
        }
        Ok(())
    }
}

/// Draws in each block of a run of `draws`: a power of two, so that runs of similar length share their
/// streams.
fn block_size(draws: u64) -> u64 {
    let size = (draws / BLOCKS).clamp(1, LARGEST_BLOCK);
    1 << size.ilog2()
}

impl Cost {
    fn add(&mut self, other: Self) {
        self.random_numbers = self.random_numbers.saturating_add(other.random_numbers);
        self.evaluations = self.evaluations.saturating_add(other.evaluations);
    }

    fn work(&self) -> u64 {
        self.random_numbers.max(self.evaluations)
    }
}

/// The time since the start of a run: every time measured in a run comes from here.
pub(crate) enum Watch<'a> {
    System(Option<Instant>),
    Own(&'a Clock<'a>, Duration),
}

impl<'a> Watch<'a> {
    pub fn start(clock: Option<&'a Clock<'a>>) -> Self {
        match clock {
            Some(clock) => Self::Own(clock, clock()),
            None if cfg!(all(target_arch = "wasm32", target_os = "unknown")) => Self::System(None),
            None => Self::System(Some(Instant::now())),
        }
    }

    pub fn elapsed(&self) -> Duration {
        match self {
            Self::System(start) => start.map_or(Duration::ZERO, |start| start.elapsed()),
            Self::Own(clock, start) => clock().saturating_sub(*start),
        }
    }
}

/// If a clock has not advanced after this many draws (at least some microseconds), it is taken to stand
/// still.
const CLOCK_DRAWS: u64 = 1 << 16;

/// The speed of one thread in draws per second, measured between the two times given.
fn pace(
    estimator: &(impl Estimator + ?Sized),
    seed: u64,
    thread: u64,
    watch: &Watch<'_>,
    [start, until]: [Duration; 2],
) -> Result<(f64, Cost)> {
    let (mut draws, mut chunk, mut cost, mut now) = (0, 1, Cost::default(), start);
    for block in 0.. {
        let (_, of_block) = one_block(estimator, seed, thread << 32 | block, chunk)?;
        cost.add(of_block);
        draws += chunk;
        let before = now;
        now = watch.elapsed();
        if now < before || (now == start && draws >= CLOCK_DRAWS) {
            return Err(Error::Clock);
        }
        if now >= until {
            break;
        }
        // at most what fits into the remaining time
        let room = draws as f64 * (until - now).as_secs_f64() / (now - start).as_secs_f64();
        chunk = (2 * chunk).min(LARGEST_BLOCK).min(room as u64).max(1);
    }
    Ok((draws as f64 / (now - start).as_secs_f64().max(1e-9), cost))
}

fn one_block(
    estimator: &(impl Estimator + ?Sized),
    seed: u64,
    block: u64,
    draws: u64,
) -> Result<(Estimate, Cost)> {
    let mut estimate = Estimate::new();
    let cost = walk_block(estimator, seed, block, draws, |slice| {
        estimate.extend_from_slice(slice);
        Ok(())
    })?;
    Ok((estimate, cost))
}

/// Computes the first `draws` draws of a block, at most [`SLICE`] at a time, checks that they are finite, and
/// passes them to `take`.
pub(crate) fn walk_block(
    estimator: &(impl Estimator + ?Sized),
    seed: u64,
    block: u64,
    draws: u64,
    mut take: impl FnMut(&[f64]) -> Result<()>,
) -> Result<Cost> {
    let mut rng = Stream::new(seed, block);
    let mut buffer = vec![0.0; draws.min(SLICE as u64) as usize];
    let mut done = 0;
    while done < draws {
        let slice = &mut buffer[..(draws - done).min(SLICE as u64) as usize];
        estimator.fill(&mut rng, slice);
        if !fast::all_finite(slice)
            && let Some(draw) = slice.iter().position(|draw| !draw.is_finite())
        {
            return Err(Error::Draw { seed, block, draw: done + draw as u64, value: slice[draw] });
        }
        take(slice)?;
        done += slice.len() as u64;
    }
    Ok(Cost { random_numbers: rng.random_numbers(), evaluations: rng.evaluations() })
}
