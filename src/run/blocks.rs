//! Blocks of draws: how many, and their estimates merged along a fixed binary tree.

use serde::{Deserialize, Serialize};

use crate::estimate::Estimate;

/// The fewest blocks of a run (if it has as many draws): enough to keep all threads busy to the end.
const BLOCKS: u64 = 32;

/// The most draws in a block.
pub const LARGEST_BLOCK: u64 = 1 << 14;

/// Draws in each block of a run of `draws`: a power of two, so that runs of similar length share their
/// streams.
pub(super) fn block_size(draws: u64) -> u64 {
    let size = (draws / BLOCKS).clamp(1, LARGEST_BLOCK);
    1 << size.ilog2()
}

/// Consecutive blocks, as the fewest nodes that cover them in a binary tree over all block numbers: node j of
/// level l is the estimate of blocks j·2ˡ to (j + 1)·2ˡ − 1, merged from its two halves. So the sums of a run
/// are rounded alike, however its blocks are cut into shards.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Blocks {
    pub(super) first: u64,
    pub(super) end: u64,
    nodes: Vec<(u32, Estimate)>,
}

impl Blocks {
    /// No blocks yet; `first` will be the first one.
    pub fn starting_at(first: u64) -> Self {
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

    pub fn append(&mut self, next: &Self) {
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
