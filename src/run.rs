//! Running an estimator: draws in blocks, on all cores, with the same bits for any number of threads.
//!
//! Draws are cut into blocks of [`Estimator::draws_per_block`]. Block b draws from [`Stream::new`]`(seed, b)` and the
//! blocks' estimates are merged in the order of b, so neither the number of threads nor their timing can
//! be seen in the result. Memory does not grow with the number of draws.

use std::fmt;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::error::{Error, Result, require, require_count, takes};
use crate::estimate::{Estimate, SLICE};
use crate::fast;
use crate::stream::{Stream, mix};

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
    /// One draw.
    fn draw(&self, rng: &mut Stream) -> f64;

    /// Fills `draws` with independent draws. An estimator that can make many side by side overrides this;
    /// the values may then differ from those of repeated [`draw`](Self::draw), the distribution may not.
    fn fill(&self, rng: &mut Stream, draws: &mut [f64]) {
        for draw in draws {
            *draw = self.draw(rng);
        }
    }

    /// How many draws share a stream: fewer where one draw is much work, so that a run still keeps all cores busy.
    fn draws_per_block(&self) -> u64 {
        1 << 14
    }
}

impl<E: Estimator + ?Sized> Estimator for &E {
    fn draw(&self, rng: &mut Stream) -> f64 {
        (**self).draw(rng)
    }

    fn fill(&self, rng: &mut Stream, draws: &mut [f64]) {
        (**self).fill(rng, draws);
    }

    fn draws_per_block(&self) -> u64 {
        (**self).draws_per_block()
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

    fn draws_per_block(&self) -> u64 {
        (**self).draws_per_block()
    }
}

/// An estimator whose draw is what a closure returns.
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

/// When a run is over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Budget {
    /// After this many draws.
    Draws(u64),
    /// After the draws that, by a pilot run's variance, bring the std error to this, but never fewer than the pilot's: some
    /// 10⁶ where draws are cheap. The pilot has a stream of its own and is discarded, so the result stays exactly unbiased.
    StdError(f64),
    /// The same for the std error divided by the mean.
    RelativeError(f64),
    /// After the first batch of blocks that ends past this time. The draws then depend on the machine;
    /// `Draws` with the number that came of it repeats the result.
    Time(Duration),
}

/// The estimate after `budget`, on all cores. The same budget of draws and seed give the same bits for any number of threads.
///
/// [`Run`] takes more options and tells more.
///
/// # Errors
/// If the budget is empty or out of reach, or a draw is NaN or infinite.
///
/// ```
/// use unbiased::{Budget, estimate, inversion::Exponential};
///
/// let exponential = Exponential::new(0.37)?;
/// let estimate = estimate(&exponential, Budget::Draws(1_000_000), 1)?;
/// assert!(estimate.z(1.0 / 0.37).unwrap().abs() < 5.0);
/// # Ok::<(), unbiased::Error>(())
/// ```
pub fn estimate(estimator: &(impl Estimator + ?Sized), budget: Budget, seed: u64) -> Result<Estimate> {
    Ok(Run::new(seed).estimate(estimator, budget)?.estimate)
}

/// What a run took, in units that do not depend on the machine.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Cost {
    /// Random numbers (words of 64 bits) that the streams gave.
    pub random_numbers: u64,
    /// Evaluations of the integrand (rays, path vertices) that the estimator counted.
    pub evaluations: u64,
}

/// What came of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// The estimate.
    pub estimate: Estimate,
    /// The seed it was made with.
    pub seed: u64,
    /// What it cost, the pilot included.
    pub cost: Cost,
    /// How long it took, the pilot included.
    pub elapsed: Duration,
    /// The pilot run that fixed the number of draws, if the budget asked for an error.
    pub pilot: Option<Estimate>,
    /// By how much it falls short of the error asked for, where [`Run::max_time`] cut it short.
    pub shortfall: Option<Shortfall>,
}

/// What an error would have taken that a run had no time for. It displays as a clause:
/// "a std error of 6e-4 takes about 1.2e9 draws".
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shortfall {
    /// The std error asked for.
    pub std_error: f64,
    /// The draws that it would take, by the pilot run's variance.
    pub draws: f64,
}

impl fmt::Display for Shortfall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&takes(self.std_error, self.draws))
    }
}

impl Outcome {
    /// Whether the pilot run never varied, so that there was nothing to fix the number of draws by: either the estimator has
    /// no variance, or the pilot missed all of it. A value that a draw takes with probability p is missed by n draws with
    /// probability (1 − p)ⁿ: below 1e-12 for p ≥ 27.6/n, which is 1.7e-6 for the 2²⁴ draws after which a pilot of cheap
    /// draws gives up. The run then takes as many draws as a pilot begins with.
    pub fn pilot_never_varied(&self) -> bool {
        self.pilot.is_some_and(|pilot| pilot.std_error() == Some(0.0))
    }
}

/// How far a run has come: draws done, and the total where it is known.
pub type Progress<'a> = dyn Fn(u64, Option<u64>) + 'a;

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
}

impl<'a> Run<'a> {
    /// A run with this seed, on all cores, of at most 10⁹ draws where the budget names an error.
    pub fn new(seed: u64) -> Self {
        Self { seed, threads: None, max_draws: 1_000_000_000, max_time: None, progress: None }
    }

    /// Uses this many threads instead of one a core; the result of the same draws is the same.
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = Some(threads);
        self
    }

    /// Allows this many draws where the budget names an error.
    pub fn max_draws(mut self, max_draws: u64) -> Self {
        self.max_draws = max_draws;
        self
    }

    /// Where the budget names an error, takes no more draws than this time allows by the pilot run's pace, though never fewer
    /// than the pilot, which itself doubles no more once the time is over. An error out of reach is then no [`Error::Budget`]:
    /// the estimate comes with a [`Shortfall`]. The number of its draws depends on the machine, but not on their values, so it
    /// stays unbiased; `Budget::Draws` with that number repeats it.
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

    /// Runs `estimator` until `budget` is spent.
    ///
    /// # Errors
    /// If the budget is empty or out of reach, the threads cannot be started, or a draw is NaN or infinite.
    pub fn estimate(&self, estimator: &(impl Estimator + ?Sized), budget: Budget) -> Result<Outcome> {
        let start = Instant::now();
        let mut blocks = Blocks { estimator, workers: self.workers()?, cost: Cost::default() };
        let by_count = |estimate| (estimate, None, None);
        let (estimate, pilot, shortfall) = match budget {
            Budget::Draws(draws) => {
                require_count("the number of draws", draws, draws > 0, "positive")?;
                by_count(self.run_draws(&mut blocks, draws)?)
            }
            Budget::Time(time) => {
                require("the time in seconds", time.as_secs_f64(), !time.is_zero(), "positive")?;
                by_count(self.run_time(&mut blocks, start, time)?)
            }
            Budget::StdError(target) => {
                require("the std error", target, target > 0.0, "positive")?;
                let pilot = self.pilot(&mut blocks, start, |_, std_error| std_error > 0.0)?;
                let (draws, shortfall) = self.needed(&pilot, blocks.pilot_draws(), start, target)?;
                (self.run_draws(&mut blocks, draws)?, Some(pilot), shortfall)
            }
            Budget::RelativeError(target) => {
                require("the relative error", target, target > 0.0, "positive")?;
                let pilot = self.pilot(&mut blocks, start, |mean, std_error| {
                    std_error > 0.0 && std_error < 0.25 * mean.abs()
                })?;
                let target = target * pilot.mean().abs();
                let (draws, shortfall) = self.needed(&pilot, blocks.pilot_draws(), start, target)?;
                (self.run_draws(&mut blocks, draws)?, Some(pilot), shortfall)
            }
        };
        Ok(Outcome {
            estimate,
            seed: self.seed,
            cost: blocks.cost,
            elapsed: start.elapsed(),
            pilot,
            shortfall,
        })
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

    fn run_draws<E: Estimator + ?Sized>(&self, blocks: &mut Blocks<'_, E>, draws: u64) -> Result<Estimate> {
        let mut estimate = Estimate::new();
        while estimate.draws() < draws {
            blocks.extend(&mut estimate, self.seed, BATCH, draws)?;
            self.report(&estimate, Some(draws));
        }
        Ok(estimate)
    }

    fn run_time<E: Estimator + ?Sized>(
        &self,
        blocks: &mut Blocks<'_, E>,
        start: Instant,
        time: Duration,
    ) -> Result<Estimate> {
        let mut estimate = Estimate::new();
        let mut batch = 1;
        while start.elapsed() < time {
            let batch_start = Instant::now();
            blocks.extend(&mut estimate, self.seed, batch, u64::MAX)?;
            self.report(&estimate, None);
            // batches short enough to overrun by a few per cent, long enough to keep all cores busy
            if batch < BATCH && batch_start.elapsed() < time / 32 {
                batch *= 2;
            }
        }
        Ok(estimate)
    }

    /// Draws from a stream of its own until mean and std error are `enough`, doubling up to the limit on draws; without any
    /// variance only up to [`STILL_BLOCKS`].
    fn pilot<E: Estimator + ?Sized>(
        &self,
        blocks: &mut Blocks<'_, E>,
        start: Instant,
        enough: impl Fn(f64, f64) -> bool,
    ) -> Result<Estimate> {
        let seed = mix(self.seed ^ PILOT);
        let mut pilot = Estimate::new();
        let mut batch = PILOT_BLOCKS;
        let size = blocks.size();
        loop {
            blocks.extend(&mut pilot, seed, batch, self.max_draws.max(2))?;
            let std_error = pilot.std_error().unwrap_or(0.0);
            let still = std_error == 0.0 && pilot.draws() >= size.saturating_mul(STILL_BLOCKS);
            let late = self.max_time.is_some_and(|time| start.elapsed() >= time);
            if enough(pilot.mean(), std_error) || still || late || pilot.draws() >= self.max_draws {
                return Ok(pilot);
            }
            batch = pilot.draws() / size;
        }
    }

    /// The draws to take for a std error of `target`, by the pilot's variance, and what is missing where time is short.
    fn needed(
        &self,
        pilot: &Estimate,
        first: u64,
        start: Instant,
        target: f64,
    ) -> Result<(u64, Option<Shortfall>)> {
        let reached = pilot.std_error().unwrap_or(0.0);
        if reached == 0.0 {
            return Ok((first.min(pilot.draws()), None));
        }
        // with fewer draws than the pilot's, what the pilot saw may be missing: the error bar would say less than is known
        let fewest = pilot.draws();
        let needed = (fewest as f64 * (reached / target).powi(2)).ceil().max(fewest as f64).min(f64::MAX);
        let limit = match self.max_time {
            Some(time) => {
                let times = time.as_secs_f64() / start.elapsed().as_secs_f64().max(1e-9);
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

    fn report(&self, estimate: &Estimate, total: Option<u64>) {
        if let Some(progress) = self.progress {
            progress(estimate.draws(), total);
        }
    }
}

/// More threads than any machine has cores for only bring it to its knees.
const MOST_THREADS: usize = 1024;

/// Blocks between two looks at the clock or the progress bar.
const BATCH: u64 = 1024;

/// Blocks of a pilot run: its std error is known to about 10 %.
const PILOT_BLOCKS: u64 = 64;

/// Blocks after which a pilot run that has not varied is taken to have no variance. Blocks are about equal work, so this is
/// a tenth of a second where draws are cheap, and fewer draws where they are not.
const STILL_BLOCKS: u64 = 1024;

/// Sets the pilot's seed apart from the run's.
const PILOT: u64 = 0x7069_6c6f_7420_7275;

/// Which threads do the work.
enum Workers {
    /// The calling one alone: starting another would take as long as some ten thousand draws.
    Caller,
    AllCores,
    Own(rayon::ThreadPool),
}

/// The blocks of one estimator's run, and what they have cost so far.
struct Blocks<'e, E: ?Sized> {
    estimator: &'e E,
    workers: Workers,
    cost: Cost,
}

impl<E: Estimator + ?Sized> Blocks<'_, E> {
    /// Draws in a block.
    fn size(&self) -> u64 {
        self.estimator.draws_per_block().max(1)
    }

    /// Draws that a pilot run begins with.
    fn pilot_draws(&self) -> u64 {
        self.size().saturating_mul(PILOT_BLOCKS)
    }

    /// Takes the next `batch` blocks into `estimate`, but no more than `limit` draws in all.
    fn extend(&mut self, estimate: &mut Estimate, seed: u64, batch: u64, limit: u64) -> Result<()> {
        let size = self.size();
        let first = estimate.draws() / size;
        let last = first.saturating_add(batch).min(limit.div_ceil(size));
        let estimator = self.estimator;
        let one = |block| one_block(estimator, seed, block, size.min(limit - block * size));
        let side_by_side = || -> Vec<_> { (first..last).into_par_iter().map(one).collect() };
        let results = match &self.workers {
            Workers::Caller => (first..last).map(one).collect(),
            Workers::AllCores => side_by_side(),
            Workers::Own(pool) => pool.install(side_by_side),
        };
        for result in results {
            let (of_block, cost) = result?;
            estimate.merge(&of_block);
            self.cost.random_numbers += cost.random_numbers;
            self.cost.evaluations += cost.evaluations;
        }
        Ok(())
    }
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

/// Takes the first `draws` draws of a block, at most [`SLICE`] at a time, and sees that they are finite.
pub(crate) fn walk_block(
    estimator: &(impl Estimator + ?Sized),
    seed: u64,
    block: u64,
    draws: u64,
    mut take: impl FnMut(&[f64]) -> Result<()>,
) -> Result<Cost> {
    let mut rng = Stream::new(seed, block);
    let mut buffer = [0.0; SLICE];
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
