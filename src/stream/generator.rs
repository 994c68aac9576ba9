//! The generators of a block, one at a time or in vector lanes.

use pulp::NullaryFnOnce;

use super::points::SobolRows;
use super::word::{GOLDEN, LANES, mix};
use crate::fast::Real;

/// Xoshiro256++, with a state that can be copied from a lane and back.
#[derive(Debug, Clone, Copy)]
pub struct Xoshiro(pub [u64; 4]);

impl Xoshiro {
    #[inline(always)]
    pub fn next(&mut self) -> u64 {
        let Self([s0, s1, s2, s3]) = self;
        let word = s0.wrapping_add(*s3).rotate_left(23).wrapping_add(*s0);
        let shifted = *s1 << 17;
        *s2 ^= *s0;
        *s3 ^= *s1;
        *s1 ^= *s2;
        *s0 ^= *s3;
        *s2 ^= shifted;
        *s3 = s3.rotate_left(45);
        word
    }
}

/// Lanes whose states fit into the registers together.
pub const TOGETHER: usize = 16;

/// Constants that make the lanes' states differ.
pub const SALTS: [[u64; LANES]; 4] = {
    let mut salts = [[0; LANES]; 4];
    let mut n = 0;
    while n < 4 * LANES {
        salts[n % 4][n / 4] = mix(GOLDEN.wrapping_mul(n as u64 + 1));
        n += 1;
    }
    salts
};

/// Xoshiro256++ in every lane.
#[derive(Debug, Clone)]
pub struct Lanes {
    state: [[u64; LANES]; 4],
}

impl Lanes {
    pub fn new(seed: u64, block: u64) -> Self {
        let mixed = mixed(seed, block);
        let mut state = SALTS;
        for (lanes, mixed) in state.iter_mut().zip(mixed) {
            for word in lanes {
                *word = mix(mixed.wrapping_add(*word));
            }
        }
        Self { state }
    }

    #[inline]
    pub fn get(&self, lane: usize) -> Xoshiro {
        Xoshiro(self.state.map(|lanes| lanes[lane]))
    }

    #[inline]
    pub fn put(&mut self, lane: usize, one: Xoshiro) {
        for (lanes, word) in self.state.iter_mut().zip(one.0) {
            lanes[lane] = word;
        }
    }
}

pub struct Fill<'a, T> {
    pub lanes: &'a mut Lanes,
    pub rows: &'a mut [[T; LANES]],
    /// Numbers per draw, rows per number, and how many of those rows to fill.
    pub each: usize,
    pub sets: usize,
    pub count: usize,
    /// Sobol coordinates for the numbers, if any.
    pub sobol: Option<&'a SobolRows>,
}

impl<T: Real> NullaryFnOnce for Fill<'_, T> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        match self.sobol {
            None => self.fill(|_, _, _, _| ()),
            Some(sobol) => self.fill(|words, set, lane, number| sobol.place(words, set, lane, number)),
        }
    }
}

impl<T: Real> Fill<'_, T> {
    #[inline(always)]
    fn fill(self, place: impl Fn(&mut [u64; TOGETHER], usize, usize, usize)) {
        for lane in (0..LANES).step_by(TOGETHER) {
            // a copy that stays in registers
            let mut state = [[0; TOGETHER]; 4];
            for (copy, lanes) in state.iter_mut().zip(&self.lanes.state) {
                copy.copy_from_slice(&lanes[lane..][..TOGETHER]);
            }
            for set in 0..self.count {
                for number in 0..self.each {
                    let mut words = next(&mut state);
                    place(&mut words, set, lane, number);
                    let row = &mut self.rows[number * self.sets + set][lane..][..TOGETHER];
                    row.copy_from_slice(&words.map(T::of_word));
                }
            }
            for (copy, lanes) in state.iter().zip(&mut self.lanes.state) {
                lanes[lane..][..TOGETHER].copy_from_slice(copy);
            }
        }
    }
}

/// The next word of every lane, by [`Xoshiro::next`].
#[inline(always)]
fn next(state: &mut [[u64; TOGETHER]; 4]) -> [u64; TOGETHER] {
    let [s0, s1, s2, s3] = state;
    let mut words = [0; TOGETHER];
    for lane in 0..TOGETHER {
        let mut one = Xoshiro([s0[lane], s1[lane], s2[lane], s3[lane]]);
        words[lane] = one.next();
        [s0[lane], s1[lane], s2[lane], s3[lane]] = one.0;
    }
    words
}

/// Four words from seed and block; `mix` of them and a salt is a generator's state.
pub fn mixed(seed: u64, block: u64) -> [u64; 4] {
    [1, 2, 3, 4].map(|word| {
        let salt = GOLDEN.wrapping_mul(word);
        mix(seed.wrapping_add(salt)).wrapping_add(mix(block ^ !salt))
    })
}

#[cfg(test)]
mod tests {
    use rand::{Rng, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    use super::*;
    use crate::fast::widest;
    use crate::stream::Stream;

    /// Every generator of a block, alone and in its lane, agrees with rand_xoshiro's from the same state.
    #[test]
    fn generators_are_the_librarys() {
        for (seed, block) in [(0, 0), (1, 7), (u64::MAX, 3)] {
            let mut lanes = Lanes::new(seed, block);
            let mut rows = [[0.0; LANES]; 100];
            let begun = lanes.clone();
            widest(Fill { lanes: &mut lanes, rows: &mut rows, each: 100, sets: 1, count: 1, sobol: None });
            for lane in 0..LANES {
                let Xoshiro(state) = begun.get(lane);
                let mut bytes = [0; 32];
                for (bytes, word) in bytes.as_chunks_mut().0.iter_mut().zip(state) {
                    *bytes = word.to_le_bytes();
                }
                let (mut library, mut one) = (Xoshiro256PlusPlus::from_seed(bytes), begun.get(lane));
                for row in &rows {
                    let word = library.next_u64();
                    assert_eq!((one.next(), row[lane]), (word, f64::of_word(word)));
                }
            }
            assert_eq!(Stream::new(seed, block).one.0, begun.get(0).0);
        }
    }
}
