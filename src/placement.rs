//! Better placed numbers for any estimator: jittered or Sobol points in place of independent ones.
//!
//! An estimator is a function of uniform numbers, f(u₁, u₂, …). Over points that fill the unit cube more evenly than independent
//! ones its mean is the same and varies less. [`sobol`] and [`jittered`] make an estimator of an estimator: one draw of theirs
//! is the mean over a whole set of points. The points of a set depend on each other, but the sets, each randomised afresh, do
//! not, so draws are independent and the error bar made of them is right.
//!
//! # Which dimensions matter
//! With n points in place of n independent draws the variance falls by a factor that depends on how few numbers f hangs on,
//! and how smoothly:
//!
//! - a smooth function of one or two numbers gains most: nearly n² (Sobol, in two dimensions or one) or n (jittered, in two);
//! - a jump costs most of it: only the points in cells that the jump crosses still vary;
//! - of many numbers only the few that f mostly depends on are placed well *together*. A path's first bounce has the first
//!   few. In the sheet's scene 4,096 points in place of as many paths of one bounce lower the variance 3·10⁶ times, of two 280 times,
//!   of three or fifteen five times (65,536 points: 23 and 13 times), and of two with L_o(p_j) known 4,500 times: the light of later
//!   bounces depends on all of its numbers at once, and through the cube's edges in jumps.
//!
//! (*Physically Based Rendering*, 4th ed., chapter 8; Owen 1997; Burley 2020.)
//!
//! ```
//! use unbiased::hemisphere::Hemisphere::Cosine;
//! use unbiased::{Budget, estimate, f_over_p, placement};
//!
//! // ∫ cos² θ dω over the hemisphere is 2π/3
//! let squared = f_over_p(|w| w.cos_theta().powi(2), Cosine);
//! let placed = placement::sobol(&squared, 1024)?;
//! let independent = estimate(&squared, Budget::Draws(102_400), 1)?;
//! let better = estimate(&placed, Budget::Draws(100), 1)?; // as many evaluations
//! assert!(better.z(2.0943951023931953).unwrap().abs() < 5.0);
//! assert!(better.std_error() < independent.std_error().map(|error| error / 100.0));
//! # Ok::<(), unbiased::Error>(())
//! ```

use std::sync::LazyLock;

use sobol_burley::NUM_DIMENSIONS;
use sobol_burley::parts::{owen_scramble_rev, sobol_rev};

use crate::error::{Result, require_count};
use crate::estimate::{Estimate, SLICE};
use crate::estimator::Estimator;
use crate::fast::all_finite;
use crate::stream::{GOLDEN, GRID, LANES, Stream, mix, on_the_grid};

/// Sobol's points are kept to 16 digits by `sobol_burley`, so the set repeats after 2¹⁶ of them.
const MOST_POINTS: u64 = 1 << 16;

/// Numbers of a draw that are placed, at most; further ones are independent.
const PLACED: u64 = NUM_DIMENSIONS as u64;

/// The mean of n draws of `estimator` over the first n points of an Owen-scrambled Sobol sequence: number d of draw i is
/// coordinate d of point i.
///
/// For n = 2ᵐ each number takes every interval of length 1/n once, and the first two every rectangle of 2⁻ᵏ by 2^(k−m): the
/// error of a smooth function of them falls nearly as n^(−3/2) (Owen 1997). Other n are allowed, and gain less.
///
/// The points are those of `sobol_burley`, to as many binary digits as n takes; the digits below come from the stream, as in
/// Owen's definition. Each coordinate has 32 random bits of its own to scramble by, and every point is then exactly uniform,
/// on the same grid of 2⁻⁵³ as [`Stream::uniform`]. Beyond 256 numbers a draw's numbers are independent.
///
/// # Errors
/// If n is not from 1 to 2¹⁶, after which the sequence would repeat.
pub fn sobol<E: Estimator>(estimator: E, points: u64) -> Result<Placed<E>> {
    let ok = (1..=MOST_POINTS).contains(&points);
    let points = require_count("the number of Sobol points", points, ok, "from 1 to 65536")?;
    Ok(Placed { estimator, points, side: None })
}

/// The mean of s² draws of `estimator` over one uniform point in each cell of an s × s grid: numbers 2k and 2k + 1 of a draw are
/// a point of the plane; each plane has its cells in an order of its own.
///
/// For a function of two numbers the variance is that *within* the cells alone: if it is smooth it falls as s⁻⁴ and the error as
/// 1/evaluations; across a jump such as a disc's edge, as evaluations^(−3/4). It is never more than with as many
/// independent points. (*Physically Based Rendering*, 4th ed., section 2.2.1.)
///
/// # Errors
/// If the side s is not from 1 to 256: the set would have more than 2¹⁶ points.
pub fn jittered<E: Estimator>(estimator: E, side: u64) -> Result<Placed<E>> {
    let side = require_count("the side of the grid", side, (1..=256).contains(&side), "from 1 to 256")?;
    Ok(Placed { estimator, points: side * side, side: Some(side) })
}

/// An estimator over a set of points; see [`sobol`] and [`jittered`].
#[derive(Debug, Clone, Copy)]
pub struct Placed<E> {
    estimator: E,
    points: u64,
    /// The side of the grid, if it is one.
    side: Option<u64>,
}

impl<E: Estimator> Estimator for Placed<E> {
    fn draw(&self, rng: &mut Stream) -> f64 {
        let Ok(seed) = rand::TryRng::try_next_u64(rng);
        let placement = match self.side {
            Some(side) => Placement::Jittered(Grid::new(side as u32, seed)),
            None => Placement::Sobol(Sobol::new(self.points as u32, seed)),
        };
        let mut points = Stream::placed(placement, seed);
        let (mut estimate, mut draws) = (Estimate::new(), [0.0; SLICE]);
        while estimate.draws() < self.points {
            let count = (self.points - estimate.draws()).min(SLICE as u64) as usize;
            let draws = &mut draws[..count];
            self.estimator.fill(&mut points, draws);
            // such a value says more than what a mean makes of it
            if !all_finite(draws)
                && let Some(bad) = draws.iter().find(|draw| !draw.is_finite())
            {
                return *bad;
            }
            estimate.extend_from_slice(draws);
        }
        rng.count(&points);
        estimate.mean()
    }
}

/// Where the numbers of a set's draws lie.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Placement {
    Sobol(Sobol),
    Jittered(Grid),
}

impl Placement {
    /// A random word, moved to where number `dimension` of draw `point` belongs.
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
    /// The first binary digits of its coordinates, of which it has every combination once.
    digits: u32,
    seed: u64,
}

impl Sobol {
    pub fn new(points: u32, seed: u64) -> Self {
        Self { digits: points.next_power_of_two().trailing_zeros(), seed }
    }

    /// Bits of its own for every coordinate: one 32-bit seed for all, as `sobol_burley::sample` takes, knows only 2³² replicates.
    #[inline]
    fn scramble(&self, dimension: u64) -> u32 {
        (hash(self.seed, dimension) >> 32) as u32
    }

    /// A word with its first digits replaced by those of a coordinate that is given in reverse, scrambled.
    ///
    /// Over all scrambles the first 16 digits take each value equally often (`owen_scramble_rev` adds the
    /// scramble's low half and then only permutes); the further ones of `sobol_burley`'s 23 do not quite.
    #[inline(always)]
    fn replaced(&self, word: u64, sobol_rev: u32, scramble: u32) -> u64 {
        let below = u64::MAX >> self.digits;
        u64::from(owen_scramble_rev(sobol_rev, scramble).reverse_bits()) << 32 & !below | word & below
    }

    /// Where the first `each` numbers of points belong, from `first`, a multiple of [`LANES`], on: of so many sets of as many neighbours.
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

/// The coordinates of the points of sets, as [`Sobol::rows`] gives them.
pub(crate) struct SobolRows {
    sobol: Sobol,
    /// What each is scrambled by, and those of the first points of all.
    coordinates: Vec<(u32, &'static [u32; LANES])>,
    /// Of each set's first point, set by set.
    firsts: Vec<u32>,
}

impl SobolRows {
    /// Places words of number `number` of neighbouring points of a set, of which the first is its `lane`th.
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

/// The first 32 points of the sequence, by coordinate: point 32k + l is that of 32k and that of l, added digit by digit without a carry.
static LOWEST: LazyLock<Vec<[u32; LANES]>> = LazyLock::new(|| {
    let points = |dimension| std::array::from_fn(|point| sobol_rev(reversed(point as u64), dimension));
    (0..NUM_DIMENSIONS).map(points).collect()
});

#[inline(always)]
fn hash(seed: u64, n: u64) -> u64 {
    mix(seed.wrapping_add(GOLDEN.wrapping_mul(n + 1)))
}

/// A grid of cells with a point in each.
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
        // the cast cuts a number off that rounding made 1
        ((u * GRID) as u64).min(GRID as u64 - 1) << 11 | word & 0x7ff
    }

    /// The cell of a point in one of its planes.
    #[inline]
    fn cell(&self, point: u32, plane: u64) -> u32 {
        if plane == 0 {
            return point;
        }
        // a permutation that looks random, turned so that every cell is as likely
        let (cells, key) = (self.side * self.side, hash(self.seed, plane));
        let turn = (((key >> 32) * u64::from(cells)) >> 32) as u32;
        (permuted(point, cells, key as u32) + turn) % cells
    }
}

/// A permutation of 0 … n − 1, another one for each key: bijections of the numbers below a power of two, until it is below n
/// (Kensler 2013, "Correlated multi-jittered sampling").
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
