//! Where random numbers come from: one independent stream for every (seed, block).

use std::convert::Infallible;

use rand::{SeedableRng, TryRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// A stream of random numbers: Xoshiro256++ (Blackman & Vigna 2019), started from (seed, block).
///
/// The same pair gives the same numbers on every machine and in every release that does not say
/// otherwise in the changelog. Seed and block are hashed together into the 256 bits of the generator's state,
/// so neighbouring seeds and neighbouring blocks share nothing.
///
/// It is an ordinary [`rand::Rng`], so every distribution of rand's can draw from it, and it counts
/// what it gave, so that an estimator's cost is known.
///
/// ```
/// use unbiased::Stream;
///
/// let mut rng = Stream::new(1, 0);
/// let u = rng.uniform();
/// assert!((0.0..1.0).contains(&u));
/// assert_eq!(rng.random_numbers(), 1);
/// assert_ne!(u, Stream::new(2, 0).uniform());
/// ```
#[derive(Debug, Clone)]
pub struct Stream {
    source: Source,
    random_numbers: u64,
    evaluations: u64,
}

/// What a stream's numbers come from.
#[derive(Debug, Clone)]
enum Source {
    Generator(Xoshiro256PlusPlus),
    /// These words one after the other, then 0 for ever.
    Script(Vec<u64>),
}

impl Stream {
    /// The stream of `block` in the run with `seed`.
    pub fn new(seed: u64, block: u64) -> Self {
        let mut state = [0; 32];
        for (word, bytes) in state.as_chunks_mut::<8>().0.iter_mut().enumerate() {
            let salt = GOLDEN.wrapping_mul(word as u64 + 1);
            let mixed = mix(seed.wrapping_add(salt)).wrapping_add(mix(block ^ !salt));
            *bytes = mix(mixed).to_le_bytes();
        }
        let source = Source::Generator(Xoshiro256PlusPlus::from_seed(state));
        Self { source, random_numbers: 0, evaluations: 0 }
    }

    /// A stream that gives these uniform numbers, each rounded down to the grid of 2⁻⁵³ and kept in [0, 1), and then 0 for ever: it makes of an estimator a
    /// function on the unit cube.
    ///
    /// ```
    /// let mut rng = unbiased::Stream::scripted(&[0.25, 0.75]);
    /// assert_eq!([rng.uniform(), rng.uniform(), rng.uniform()], [0.25, 0.75, 0.0]);
    /// ```
    pub fn scripted(uniforms: &[f64]) -> Self {
        const GRID: f64 = (1u64 << 53) as f64;
        // a float-to-int cast saturates, and takes NaN to 0
        let word = |u: &f64| ((u * GRID) as u64).min((1 << 53) - 1) << 11;
        let source = Source::Script(uniforms.iter().map(word).collect());
        Self { source, random_numbers: 0, evaluations: 0 }
    }

    /// A uniform number on the grid k·2⁻⁵³ in [0, 1): never 1, and 0 with probability 2⁻⁵³.
    ///
    /// 1 − u is exact on this grid and lies in (0, 1].
    #[inline]
    pub fn uniform(&mut self) -> f64 {
        const STEP: f64 = 1.0 / (1u64 << 53) as f64;
        let Ok(bits) = self.try_next_u64();
        (bits >> 11) as f64 * STEP
    }

    /// Fills `uniforms` with what repeated [`uniform`](Self::uniform) would give, faster: the generator's state stays in registers.
    pub fn fill_uniform(&mut self, uniforms: &mut [f64]) {
        for uniform in uniforms {
            *uniform = self.uniform();
        }
    }

    /// How many random numbers (words of 64 bits) were given.
    pub fn random_numbers(&self) -> u64 {
        self.random_numbers
    }

    /// Counts `n` evaluations of an integrand (or rays, or path vertices): the work that a draw took.
    #[inline]
    pub fn count_evaluations(&mut self, n: u64) {
        self.evaluations = self.evaluations.wrapping_add(n);
    }

    /// How many evaluations the estimators that drew from here counted.
    pub fn evaluations(&self) -> u64 {
        self.evaluations
    }
}

impl TryRng for Stream {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        let Ok(bits) = self.try_next_u64();
        Ok((bits >> 32) as u32)
    }

    #[inline]
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        let index = self.random_numbers;
        self.random_numbers = index.wrapping_add(1);
        match &mut self.source {
            Source::Generator(rng) => rng.try_next_u64(),
            Source::Script(words) => Ok(words.get(index as usize).copied().unwrap_or(0)),
        }
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(8) {
            let Ok(word) = self.try_next_u64();
            chunk.copy_from_slice(&word.to_le_bytes()[..chunk.len()]);
        }
        Ok(())
    }
}

/// 2⁶⁴/φ, the increment of SplitMix64.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// SplitMix64's finaliser (Stafford's mix 13): a bijection in which every input bit moves half of the output's.
pub(crate) fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
