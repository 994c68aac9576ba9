//! Computing the draws of a run, block by block, on several threads.

use std::ops::Range;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::blocks::{Blocks, block_size};
use super::{Clock, Cost, Run};
use crate::error::{Error, Result, require_count};
use crate::estimate::{Estimate, SLICE};
use crate::estimator::Estimator;
use crate::fast;
use crate::stream::Stream;

/// The largest number of threads.
const MOST_THREADS: usize = 1024;

/// Blocks between two reports of progress: at first, and at most.
const FIRST_BATCH: u64 = 64;
const LARGEST_BATCH: u64 = 1024;

/// Batches that take less time than this are doubled.
const BATCH_TIME: Duration = Duration::from_millis(50);

/// The threads that compute draws.
pub enum Workers {
    /// Only the calling one: starting another takes as long as ten thousand cheap draws.
    Caller,
    AllCores,
    Own(rayon::ThreadPool),
}

impl Workers {
    pub fn start(threads: Option<usize>) -> Result<Self> {
        let Some(threads) = threads else { return Ok(Self::AllCores) };
        let ok = (1..=MOST_THREADS).contains(&threads);
        require_count("the number of threads", threads as u64, ok, "from 1 to 1024")?;
        if threads == 1 {
            return Ok(Self::Caller);
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.map(Self::Own).map_err(|error| Error::Threads { threads, reason: error.to_string() })
    }
}

/// A run under way: its options and estimator, its threads, and the time and work that it took so far.
pub struct Work<'a, E: ?Sized> {
    pub run: &'a Run<'a>,
    pub estimator: &'a E,
    pub workers: Workers,
    pub watch: Watch<'a>,
    pub cost: Cost,
}

impl<E: Estimator + ?Sized> Work<'_, E> {
    /// All blocks of a run of `draws` draws, or those of its shard.
    pub fn all(&mut self, draws: u64) -> Result<Blocks> {
        let [k, of] = self.run.shard.unwrap_or([1, 1]).map(u128::from);
        let all = u128::from(draws.div_ceil(block_size(draws)));
        let [mut next, end] = [k - 1, k].map(|k| (all * k / of) as u64);
        let (mut blocks, mut batch) = (Blocks::starting_at(next), FIRST_BATCH);
        while next < end {
            let start = self.watch.elapsed();
            let until = next.saturating_add(batch).min(end);
            self.extend(&mut blocks, self.run.seed, next..until, draws)?;
            next = until;
            if let Some(progress) = self.run.progress {
                progress(blocks.draws(), draws);
            }
            // short enough to report progress, long enough to keep all cores busy
            if self.watch.elapsed().saturating_sub(start) < BATCH_TIME {
                batch = (2 * batch).min(LARGEST_BATCH);
            }
        }
        Ok(blocks)
    }

    /// Computes these blocks of a run of `draws` draws.
    pub fn extend(&mut self, blocks: &mut Blocks, seed: u64, range: Range<u64>, draws: u64) -> Result<()> {
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

impl Cost {
    pub(super) fn add(&mut self, other: Self) {
        self.random_numbers = self.random_numbers.saturating_add(other.random_numbers);
        self.evaluations = self.evaluations.saturating_add(other.evaluations);
    }

    pub(super) fn work(&self) -> u64 {
        self.random_numbers.max(self.evaluations)
    }
}

/// The time since the start of a run: every time measured in a run comes from here.
pub enum Watch<'a> {
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

pub fn one_block(
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
pub fn walk_block(
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
