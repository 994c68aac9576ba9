//! Where random numbers come from: one independent stream for every (seed, block).

use std::convert::Infallible;

use pulp::NullaryFnOnce;
use rand::{SeedableRng, TryRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::fast::widest;

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
    Generator {
        one: Xoshiro256PlusPlus,
        seed: u64,
        block: u64,
        lanes: Option<Box<Lanes>>,
    },
    /// These words one after the other, then 0 for ever.
    Script(Vec<u64>),
}

impl Stream {
    /// The stream of `block` in the run with `seed`.
    pub fn new(seed: u64, block: u64) -> Self {
        let mut state = [0; 32];
        for (bytes, mixed) in state.as_chunks_mut::<8>().0.iter_mut().zip(mixed(seed, block)) {
            *bytes = mix(mixed).to_le_bytes();
        }
        let one = Xoshiro256PlusPlus::from_seed(state);
        let source = Source::Generator { one, seed, block, lanes: None };
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

    /// Starts over with a script of these steps k of the grid k·2⁻⁵³.
    #[inline]
    pub(crate) fn rewind(&mut self, steps: &[u64]) {
        let words = steps.iter().map(|step| step << 11);
        match &mut self.source {
            Source::Script(script) if script.len() == steps.len() => {
                script.iter_mut().zip(words).for_each(|(word, new)| *word = new);
            }
            source => *source = Source::Script(words.collect()),
        }
        (self.random_numbers, self.evaluations) = (0, 0);
    }

    /// A uniform number on the grid k·2⁻⁵³ in [0, 1): never 1, and 0 with probability 2⁻⁵³.
    ///
    /// 1 − u is exact on this grid and lies in (0, 1].
    #[inline]
    pub fn uniform(&mut self) -> f64 {
        on_the_grid(self.next_word())
    }

    /// Fills `uniforms` with numbers as [`uniform`](Self::uniform) gives them, but not the same ones, and in a fraction of the time: from sixteen generators side by
    /// side, each started from (seed, block, its place).
    ///
    /// The sixteen take turns; a call begins at the first of them, wherever the one before it ended. A [`scripted`](Self::scripted) stream gives its next numbers.
    pub fn fill_uniform(&mut self, uniforms: &mut [f64]) {
        match &mut self.source {
            Source::Generator { seed, block, lanes, .. } => {
                self.random_numbers = self.random_numbers.wrapping_add(uniforms.len() as u64);
                let lanes = lanes.get_or_insert_with(|| Box::new(Lanes::new(*seed, *block)));
                widest(Fill { lanes, uniforms });
            }
            Source::Script(_) => uniforms.fill_with(|| self.uniform()),
        }
    }

    /// Fills `uniforms` with numbers on the grid k·2⁻²⁴, two of each word.
    pub(crate) fn fill_uniform_pairs(&mut self, uniforms: &mut [f32]) {
        match &mut self.source {
            Source::Generator { seed, block, lanes, .. } => {
                let words = uniforms.len().div_ceil(2) as u64;
                self.random_numbers = self.random_numbers.wrapping_add(words);
                let lanes = lanes.get_or_insert_with(|| Box::new(Lanes::new(*seed, *block)));
                widest(FillPairs { lanes, uniforms });
            }
            Source::Script(_) => {
                // the script's own numbers, rounded down
                uniforms.fill_with(|| halves(self.next_word())[1]);
            }
        }
    }

    #[inline]
    fn next_word(&mut self) -> u64 {
        let Ok(word) = self.try_next_u64();
        word
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
            Source::Generator { one, .. } => one.try_next_u64(),
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

/// The upper 53 bits as a number in [0, 1).
#[inline(always)]
fn on_the_grid(bits: u64) -> f64 {
    const STEP: f64 = 1.0 / (1u64 << 53) as f64;
    (bits >> 11) as f64 * STEP
}

/// Generators side by side: as many as fill the widest vectors twice, since the steps of one depend on each other.
const LANES: usize = 16;

/// What sets the lanes apart.
const SALTS: [[u64; LANES]; 4] = {
    let mut salts = [[0; LANES]; 4];
    let mut n = 0;
    while n < 4 * LANES {
        // lane 0 would be the stream's own generator
        salts[n % 4][n / 4] = mix(GOLDEN.wrapping_mul(n as u64 + 4));
        n += 1;
    }
    salts
};

/// Xoshiro256++ in every lane.
#[derive(Debug, Clone)]
struct Lanes {
    state: [[u64; LANES]; 4],
}

impl Lanes {
    fn new(seed: u64, block: u64) -> Self {
        let mixed = mixed(seed, block);
        let mut state = SALTS;
        for (lanes, mixed) in state.iter_mut().zip(mixed) {
            for word in lanes {
                *word = mix(mixed.wrapping_add(*word));
            }
        }
        Self { state }
    }

    /// The next word of every lane.
    #[inline(always)]
    fn next(&mut self) -> [u64; LANES] {
        let [s0, s1, s2, s3] = &mut self.state;
        let mut words = [0; LANES];
        for lane in 0..LANES {
            words[lane] = s0[lane].wrapping_add(s3[lane]).rotate_left(23).wrapping_add(s0[lane]);
            let shifted = s1[lane] << 17;
            s2[lane] ^= s0[lane];
            s3[lane] ^= s1[lane];
            s1[lane] ^= s2[lane];
            s0[lane] ^= s3[lane];
            s2[lane] ^= shifted;
            s3[lane] = s3[lane].rotate_left(45);
        }
        words
    }
}

impl Lanes {
    /// Both halves of the next word of every lane.
    #[inline(always)]
    fn next_pairs(&mut self) -> [f32; 2 * LANES] {
        let words = self.next();
        let mut pairs = [0.0; 2 * LANES];
        for lane in 0..LANES {
            [pairs[lane], pairs[LANES + lane]] = halves(words[lane]);
        }
        pairs
    }
}

struct Fill<'a> {
    lanes: &'a mut Lanes,
    uniforms: &'a mut [f64],
}

impl NullaryFnOnce for Fill<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        // a copy, which stays in registers
        let mut lanes = self.lanes.clone();
        let (rows, rest) = self.uniforms.as_chunks_mut::<LANES>();
        for row in rows {
            *row = lanes.next().map(on_the_grid);
        }
        if !rest.is_empty() {
            for (uniform, word) in rest.iter_mut().zip(lanes.next()) {
                *uniform = on_the_grid(word);
            }
        }
        *self.lanes = lanes;
    }
}

struct FillPairs<'a> {
    lanes: &'a mut Lanes,
    uniforms: &'a mut [f32],
}

impl NullaryFnOnce for FillPairs<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let mut lanes = self.lanes.clone();
        let (rows, rest) = self.uniforms.as_chunks_mut::<{ 2 * LANES }>();
        for row in rows {
            *row = lanes.next_pairs();
        }
        if !rest.is_empty() {
            for (uniform, number) in rest.iter_mut().zip(lanes.next_pairs()) {
                *uniform = number;
            }
        }
        *self.lanes = lanes;
    }
}

/// The lower and the upper half of a word as numbers in [0, 1).
#[inline(always)]
fn halves(bits: u64) -> [f32; 2] {
    const STEP: f32 = 1.0 / (1u32 << 24) as f32;
    [bits as u32, (bits >> 32) as u32].map(|half| (half >> 8) as i32 as f32 * STEP)
}

/// Four words out of seed and block, of which a finaliser makes a generator's state.
fn mixed(seed: u64, block: u64) -> [u64; 4] {
    [1, 2, 3, 4].map(|word| {
        let salt = GOLDEN.wrapping_mul(word);
        mix(seed.wrapping_add(salt)).wrapping_add(mix(block ^ !salt))
    })
}

/// 2⁶⁴/φ, the increment of SplitMix64.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// SplitMix64's finaliser (Stafford's mix 13): a bijection in which every input bit moves half of the output's.
pub(crate) const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
