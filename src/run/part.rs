//! Shards of a run, and merging them into the whole run.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::blocks::{Blocks, block_size};
use super::{Cost, Outcome};
use crate::error::{Error, Result};

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
    let (mut blocks, mut cost, mut seconds) = (Blocks::starting_at(0), Cost::default(), 0.0);
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
