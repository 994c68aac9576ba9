//! Jittered and Sobol point sets, whose points are the random numbers of draws.

use std::sync::LazyLock;

use sobol_burley::NUM_DIMENSIONS;
use sobol_burley::parts::{owen_scramble_rev, sobol_rev};

use super::word::{GOLDEN, GRID, LANES, mix, on_the_grid};

/// At most this many numbers of a draw are placed; further ones are independent.
const PLACED: u64 = NUM_DIMENSIONS as u64;

/// A randomised point set.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Placement {
    Sobol(Sobol),
    Jittered(Grid),
}

impl Placement {
    /// Moves a random word into the cell of coordinate `dimension` of point `point`.
    #[inline]
    pub fn place(&self, word: u64, point: u64, dimension: u64) -> u64 {
        match self {
            _ if dimension >= PLACED => word,
            Self::Sobol(sobol) => {
                sobol.replaced(word, sobol_rev(reversed(point), dimension as u32), sobol.scramble(dimension))
            }
            Self::Jittered(grid) => grid.place(word, point, dimension),
        }
    }
}

/// A scrambled set of Sobol points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sobol {
    /// How many leading binary digits of a coordinate are Sobol's: each combination occurs once.
    digits: u32,
    seed: u64,
}

impl Sobol {
    pub fn new(points: u32, seed: u64) -> Self {
        Self { digits: points.next_power_of_two().trailing_zeros(), seed }
    }

    /// Different bits for every coordinate: `sobol_burley::sample` takes one 32-bit seed for all of them,
    /// which allows only 2³² replicates.
    #[inline]
    fn scramble(&self, dimension: u64) -> u32 {
        (hash(self.seed, dimension) >> 32) as u32
    }

    /// A word with its leading digits replaced by the scrambled digits of a bit-reversed Sobol coordinate.
    ///
    /// Over all scrambles the first 16 digits take each value equally often (`owen_scramble_rev` adds the
    /// scramble's low half and then only permutes); the other 7 of `sobol_burley`'s 23 digits do not quite.
    #[inline(always)]
    fn replaced(&self, word: u64, sobol_rev: u32, scramble: u32) -> u64 {
        let below = u64::MAX >> self.digits;
        u64::from(owen_scramble_rev(sobol_rev, scramble).reverse_bits()) << 32 & !below | word & below
    }

    /// The first `each` coordinates of `sets` · [`LANES`] consecutive points from `first`, a multiple of
    /// [`LANES`].
    pub fn rows(self, first: u64, each: usize, sets: usize) -> SobolRows {
        let placed = (0..NUM_DIMENSIONS).take(each);
        let firsts = (first..).step_by(LANES).take(sets);
        SobolRows {
            sobol: self,
            coordinates: placed
                .clone()
                .zip(&*LOWEST)
                .map(|(dimension, next)| (self.scramble(dimension.into()), next))
                .collect(),
            firsts: firsts
                .flat_map(|first| placed.clone().map(move |dimension| sobol_rev(reversed(first), dimension)))
                .collect(),
        }
    }
}

/// Coordinates of consecutive points, as [`Sobol::rows`] returns them.
pub(crate) struct SobolRows {
    sobol: Sobol,
    /// For each coordinate its scramble, and its values at the first 32 points of the sequence.
    coordinates: Vec<(u32, &'static [u32; LANES])>,
    /// The coordinates of each set's first point, set by set.
    firsts: Vec<u32>,
}

impl SobolRows {
    /// Places words of coordinate `number` of consecutive points of a set, the first of which is its
    /// `lane`th.
    #[inline(always)]
    pub fn place<const N: usize>(&self, words: &mut [u64; N], set: usize, lane: usize, number: usize) {
        let Some((scramble, next)) = self.coordinates.get(number) else { return };
        let first = self.firsts[set * self.coordinates.len() + number];
        for (word, next) in words.iter_mut().zip(&next[lane..]) {
            *word = self.sobol.replaced(*word, first ^ next, *scramble);
        }
    }
}

#[inline(always)]
fn reversed(point: u64) -> u32 {
    (point as u32).reverse_bits()
}

/// The first 32 points of the sequence, by coordinate: point 32k + l is the XOR of points 32k and l.
static LOWEST: LazyLock<Vec<[u32; LANES]>> = LazyLock::new(|| {
    let points = |dimension| std::array::from_fn(|point| sobol_rev(reversed(point as u64), dimension));
    (0..NUM_DIMENSIONS).map(points).collect()
});

#[inline(always)]
fn hash(seed: u64, n: u64) -> u64 {
    mix(seed.wrapping_add(GOLDEN.wrapping_mul(n + 1)))
}

/// A jittered set: a grid of cells with one point in each.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Grid {
    side: u32,
    seed: u64,
}

impl Grid {
    pub fn new(side: u32, seed: u64) -> Self {
        Self { side, seed }
    }

    #[inline]
    pub fn place(&self, word: u64, point: u64, dimension: u64) -> u64 {
        let cell = self.cell(point as u32, dimension / 2);
        let place = if dimension.is_multiple_of(2) { cell % self.side } else { cell / self.side };
        let u = (f64::from(place) + on_the_grid(word)) / f64::from(self.side);
        // `min`: rounding may have made u equal to 1
        ((u * GRID) as u64).min(GRID as u64 - 1) << 11 | word & 0x7ff
    }

    /// The cell of a point in a plane, that is, for a pair of dimensions.
    #[inline]
    fn cell(&self, point: u32, plane: u64) -> u32 {
        if plane == 0 {
            return point;
        }
        // a pseudo-random permutation, then a random shift, which makes every cell equally likely
        let (cells, key) = (self.side * self.side, hash(self.seed, plane));
        let turn = (((key >> 32) * u64::from(cells)) >> 32) as u32;
        (permuted(point, cells, key as u32) + turn) % cells
    }
}

/// A permutation of 0 … n − 1 that depends on the key: a bijection of the numbers below a power of two,
/// repeated until the result is below n (Kensler 2013, "Correlated multi-jittered sampling").
fn permuted(mut i: u32, n: u32, key: u32) -> u32 {
    let mask = n.next_power_of_two() - 1;
    loop {
        i ^= key;
        i = i.wrapping_mul(0xe170893d);
        i ^= key >> 16;
        i ^= (i & mask) >> 4;
        i ^= key >> 8;
        i = i.wrapping_mul(0x0929eb3f);
        i ^= key >> 23;
        i ^= (i & mask) >> 1;
        i = i.wrapping_mul(1 | key >> 27);
        i = i.wrapping_mul(0x6935fa69);
        i ^= (i & mask) >> 11;
        i = i.wrapping_mul(0x74dcb303);
        i ^= (i & mask) >> 2;
        i = i.wrapping_mul(0x9e501cc3);
        i ^= (i & mask) >> 2;
        i = i.wrapping_mul(0xc860a3df);
        i &= mask;
        i ^= i >> 5;
        if i < n {
            return i;
        }
    }
}
