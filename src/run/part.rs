//! Shards of a run, and merging them: the blocks' estimates along a fixed binary tree.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::work::block_size;
use super::{Cost, Outcome};
use crate::error::{Error, Result};
use crate::estimate::Estimate;

/// One shard of a run: the estimates of its blocks, to the last bit, so that [`merge`] can put the whole run
/// together from shards of any machines.
///
/// Its JSON form is small: a few numbers, and at most two estimates for each doubling of the number of
/// blocks.
///
/// ```
/// use unbiased::{Budget, Run, inversion::Exponential, merge};
///
/// let (exponential, draws) = (Exponential::new(0.37)?, Budget::Draws(10_000));
/// let shards = [1, 2, 3].map(|k| Run::new(1).shard(k, 3).estimate(&exponential, draws));
/// let parts: Vec<_> = shards.into_iter().filter_map(|shard| shard.ok()?.part).collect();
/// let whole = Run::new(1).estimate(&exponential, draws)?;
/// assert_eq!(merge(&parts)?.estimate, whole.estimate);
/// # Ok::<(), unbiased::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Part {
    pub(super) seed: u64,
    /// Of the whole run.
    pub(super) draws: u64,
    pub(super) blocks: Blocks,
    pub(super) cost: Cost,
    pub(super) seconds: f64,
}

/// Puts a run together from all of its shards, in any order: the estimate has the same bits as that of the
/// undivided run.
///
/// The cost and the time are the sums over the shards.
///
/// # Errors
/// If the shards have different seeds or numbers of draws, one is missing, or one is there twice. It cannot
/// detect shards of different estimators.
pub fn merge(parts: &[Part]) -> Result<Outcome> {
    let refused = |reason: String| Err(Error::Parts { reason });
    let Some(Part { seed, draws, .. }) = parts.first() else {
        return refused("there are none".into());
    };
    for part in parts {
        if part.seed != *seed {
            return refused(format!("one has seed {}, another {seed}", part.seed));
        } else if part.draws != *draws {
            return refused(format!("one is of a run of {} draws, another of {draws}", part.draws));
        }
    }
    let mut parts: Vec<&Part> = parts.iter().collect();
    parts.sort_by_key(|part| (part.blocks.first, part.blocks.end));
    let (mut blocks, mut cost, mut seconds) = (Blocks::from(0), Cost::default(), 0.0);
    for part in parts {
        if part.blocks.first < blocks.end {
            return refused(format!("block {} is there twice", part.blocks.first));
        } else if part.blocks.first > blocks.end {
            return refused(format!("block {} is missing", blocks.end));
        }
        blocks.append(&part.blocks);
        cost.add(part.cost);
        seconds += part.seconds;
    }
    let estimate = blocks.estimate();
    let all = draws.div_ceil(block_size(*draws));
    if blocks.end != all {
        return refused(format!("block {} is missing", blocks.end));
    } else if estimate.draws() != *draws {
        return refused(format!("they have {} draws, not {draws}", estimate.draws()));
    }
    let elapsed = Duration::try_from_secs_f64(seconds).unwrap_or_default();
    Ok(Outcome { estimate, seed: *seed, cost, elapsed, pilot: None, shortfall: None, part: None })
}

/// Consecutive blocks, as the fewest nodes that cover them in a binary tree over all block numbers: node j of
/// level l is the estimate of blocks j·2ˡ to (j + 1)·2ˡ − 1, merged from its two halves. So the sums of a run
/// are rounded alike, however its blocks are cut into shards.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Blocks {
    first: u64,
    end: u64,
    nodes: Vec<(u32, Estimate)>,
}

impl Blocks {
    /// No blocks yet; `first` will be the first one.
    pub fn from(first: u64) -> Self {
        Self { first, end: first, nodes: Vec::new() }
    }

    /// Adds the next block.
    pub fn push(&mut self, estimate: &Estimate) {
        self.push_node(0, *estimate);
    }

    fn push_node(&mut self, mut level: u32, mut estimate: Estimate) {
        // an odd index: the previous node is the left half of their common parent
        let begins = |end: u64, level: u32| end.checked_shr(level).unwrap_or(0);
        let mut index = begins(self.end, level);
        while let Some((_, before)) = self.nodes.pop_if(|(other, _)| *other == level && index % 2 == 1) {
            estimate = merged(before, &estimate);
            (level, index) = (level + 1, index / 2);
        }
        self.nodes.push((level, estimate));
        self.end = (index + 1).checked_shl(level).unwrap_or(u64::MAX);
    }

    fn append(&mut self, next: &Self) {
        for (level, estimate) in &next.nodes {
            self.push_node(*level, *estimate);
        }
    }

    /// The estimate of all its blocks.
    pub fn estimate(&self) -> Estimate {
        let last_first = self.nodes.iter().rev().map(|(_, estimate)| *estimate);
        last_first.reduce(|right, left| merged(left, &right)).unwrap_or_default()
    }

    pub fn draws(&self) -> u64 {
        self.nodes.iter().fold(0, |draws, (_, estimate)| draws.saturating_add(estimate.draws()))
    }
}

fn merged(mut left: Estimate, right: &Estimate) -> Estimate {
    left.merge(right);
    left
}
