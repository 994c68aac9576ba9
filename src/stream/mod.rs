//! Random numbers, indexed by (seed, block, draw).
//!
//! A block of a run has 32 generators. Draw i of the block takes its numbers from generator i mod 32, after
//! the earlier draws of that generator. So a draw's numbers do not depend on how draws are computed: one at a
//! time, generator by generator, or 32 at a time in vector lanes.

use std::convert::Infallible;
use std::ops::Range;

use rand::TryRng;

use crate::fast::{Real, widest};
use generator::{Fill, Lanes, SALTS, Xoshiro, mixed};
use points::Placement;
use word::on_the_grid;

mod abreast;
mod generator;
pub(crate) mod points;
mod word;

pub(crate) use abreast::Abreast;
pub(crate) use word::{GOLDEN, GRID, LANES, mix};

/// The random numbers of one block of a run, draw by draw.
///
/// The generators are Xoshiro256++ (Blackman & Vigna 2019), seeded by (seed, block, lane). The same triple
/// gives the same numbers on every machine, and in every release unless the changelog says otherwise. Seed,
/// block and lane are hashed together into the 256 bits of a generator's state, so similar triples give
/// unrelated generators.
///
/// It is a [`rand::Rng`], so it works with every distribution of rand, and it counts the numbers taken, so
/// that an estimator's cost is known. It returns numbers of the same draw until
/// [`next_draw`](Self::next_draw) is called.
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
    seed: u64,
    block: u64,
    /// The generator of the current draw.
    one: Xoshiro,
    /// All generators, once another one was needed; the current one's entry here is out of date.
    lanes: Option<Box<Lanes>>,
    /// The current draw, and how many numbers were taken before it.
    draw: u64,
    before: u64,
    random_numbers: u64,
    evaluations: u64,
}

/// How the stream's numbers are made.
#[derive(Debug, Clone)]
enum Source {
    Independent,
    Placed(Placement),
    /// These words in order, and 0 after the last one.
    Script(Vec<u64>),
}

impl Stream {
    /// The stream of `block` in the run with `seed`, at its first draw.
    pub fn new(seed: u64, block: u64) -> Self {
        let words = mixed(seed, block);
        let one = Xoshiro(std::array::from_fn(|n| mix(words[n].wrapping_add(SALTS[n][0]))));
        let source = Source::Independent;
        Self { source, seed, block, one, lanes: None, draw: 0, before: 0, random_numbers: 0, evaluations: 0 }
    }

    /// A stream whose draws are the points of a jittered or Sobol set, randomised by `seed`.
    pub(crate) fn placed(placement: Placement, seed: u64) -> Self {
        Self { source: Source::Placed(placement), ..Self::new(seed, 0) }
    }

    /// A stream that returns these uniform numbers, each rounded down to a multiple of 2⁻⁵³ and clamped to
    /// [0, 1), and 0 after the last one. With it an estimator can be evaluated as a function on the unit
    /// cube.
    ///
    /// ```
    /// let mut rng = unbiased::Stream::scripted(&[0.25, 0.75]);
    /// assert_eq!([rng.uniform(), rng.uniform(), rng.uniform()], [0.25, 0.75, 0.0]);
    /// ```
    pub fn scripted(uniforms: &[f64]) -> Self {
        // a float-to-int cast saturates, and turns NaN into 0
        let word = |u: &f64| ((u * GRID) as u64).min((1 << 53) - 1) << 11;
        Self { source: Source::Script(uniforms.iter().map(word).collect()), ..Self::new(0, 0) }
    }

    /// Restarts the stream with the script of uniform numbers k·2⁻⁵³, for k in `steps`.
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

    /// A uniform multiple of 2⁻⁵³ in [0, 1): never 1, and 0 with probability 2⁻⁵³.
    ///
    /// 1 − u is exact on this grid and lies in (0, 1].
    #[inline]
    pub fn uniform(&mut self) -> f64 {
        on_the_grid(self.word())
    }

    #[inline]
    fn word(&mut self) -> u64 {
        let Ok(word) = self.try_next_u64();
        word
    }

    /// Goes on to the numbers of the next draw; [`Estimator::fill`](crate::Estimator::fill) does so after
    /// each of its draws.
    ///
    /// ```
    /// use unbiased::{Estimator, Stream, from_uniforms};
    ///
    /// let (product, mut draws) = (from_uniforms(|[u, v]| u * v), [0.0; 100]);
    /// product.fill(&mut Stream::new(1, 0), &mut draws);
    /// let mut rng = Stream::new(1, 0);
    /// for filled in draws {
    ///     assert_eq!(product.draw(&mut rng), filled);
    ///     rng.next_draw();
    /// }
    /// ```
    #[inline]
    pub fn next_draw(&mut self) {
        self.go_to(self.draw + 1);
    }

    #[inline]
    fn go_to(&mut self, draw: u64) {
        let [from, to] = [self.draw, draw].map(|draw| draw as usize % LANES);
        if from != to {
            let one = self.one;
            let lanes = self.lanes();
            lanes.put(from, one);
            self.one = lanes.get(to);
        }
        (self.draw, self.before) = (draw, self.random_numbers);
    }

    /// Fills `draws` with calls of `draw`, generator by generator, so that each stays in registers.
    #[inline]
    pub(crate) fn one_at_a_time(&mut self, draws: &mut [f64], draw: impl Fn(&mut Self) -> f64) {
        match self.source {
            Source::Independent => {
                // a copy whose source the compiler knows, so that the generator can stay in registers
                let source = Source::Independent;
                let mut rng = Self { source, lanes: self.lanes.take(), ..*self };
                for lane in 0..LANES.min(draws.len()) {
                    rng.go_to(self.draw + lane as u64);
                    let mut place = lane;
                    while place < draws.len() {
                        draws[place] = draw(&mut rng);
                        place += LANES;
                    }
                }
                rng.go_to(self.draw + draws.len() as u64);
                *self = rng;
            }
            Source::Placed(_) => draws.iter_mut().for_each(|place| {
                *place = draw(self);
                self.next_draw();
            }),
            Source::Script(_) => draws.fill_with(|| draw(self)),
        }
    }

    fn lanes(&mut self) -> &mut Lanes {
        self.lanes.get_or_insert_with(|| Box::new(Lanes::new(self.seed, self.block)))
    }

    /// The next word of a stream that is not independent. Not inlined, so that the common case is short
    /// enough to be.
    #[inline(never)]
    fn elsewhere(&mut self, index: u64) -> u64 {
        match &self.source {
            Source::Independent => self.one.next(),
            Source::Placed(placement) => {
                placement.place(self.one.next(), self.draw, index.wrapping_sub(self.before))
            }
            Source::Script(words) => words.get(index as usize).copied().unwrap_or(0),
        }
    }

    /// The index of the current draw's generator.
    pub(crate) fn lane(&self) -> usize {
        if let Source::Script(_) = self.source { 0 } else { self.draw as usize % LANES }
    }

    /// Writes the first `each` numbers of each of the next `draws` draws into `rows`, and goes on to the draw
    /// after them. A set is 32 draws, one per generator, and there are at most `sets`: number k of a draw in
    /// set s is in row k·sets + s, at the index of its generator. Entries before the first draw and after the
    /// last are left as they are.
    pub(crate) fn fill_rows<T: Real>(
        &mut self,
        each: usize,
        sets: usize,
        draws: usize,
        rows: &mut [[T; LANES]],
    ) {
        let (mut done, mut set, script) = (0, 0, matches!(self.source, Source::Script(_)));
        while done < draws {
            let lane = self.lane();
            let whole = if lane == 0 && !script { (draws - done) / LANES } else { 0 };
            if whole > 0 {
                self.fill_whole_rows(each, sets, set..set + whole, rows);
                done += whole * LANES;
                set += whole;
                continue;
            }
            let until = (lane + draws - done).min(LANES);
            for lane in lane..until {
                for row in rows.iter_mut().skip(set).step_by(sets).take(each) {
                    row[lane] = T::of_word(self.word());
                }
                if !script {
                    self.next_draw();
                }
            }
            done += until - lane;
            set += 1;
        }
    }

    fn fill_whole_rows<T: Real>(
        &mut self,
        each: usize,
        sets: usize,
        range: Range<usize>,
        rows: &mut [[T; LANES]],
    ) {
        let (one, first) = (self.one, self.draw);
        let (count, rows) = (range.len(), rows.get_mut(range.start..).unwrap_or_default());
        let sobol = match &self.source {
            Source::Placed(Placement::Sobol(sobol)) => Some(sobol.rows(first, each, count)),
            _ => None,
        };
        let lanes = self.lanes();
        lanes.put(0, one);
        widest(Fill { lanes, rows, each, sets, count, sobol: sobol.as_ref() });
        self.one = lanes.get(0);
        if let Source::Placed(Placement::Jittered(grid)) = &self.source {
            for (set, first) in (0..count).zip((self.draw..).step_by(LANES)) {
                for (dimension, row) in (0..).zip(rows.iter_mut().skip(set).step_by(sets).take(each)) {
                    for (number, point) in row.iter_mut().zip(first..) {
                        *number = T::of_word(grid.place(number.word(), point, dimension));
                    }
                }
            }
        }
        self.random_numbers = self.random_numbers.wrapping_add((each * count * LANES) as u64);
        self.before = self.random_numbers;
        self.draw += (count * LANES) as u64;
    }

    /// Skips numbers until this many were taken in all.
    #[inline]
    pub(crate) fn skip_to(&mut self, random_numbers: u64) {
        while self.random_numbers < random_numbers {
            self.word();
        }
    }

    /// How many random numbers (64-bit words) were taken.
    pub fn random_numbers(&self) -> u64 {
        self.random_numbers
    }

    /// Adds `n` to the count of evaluations (of an integrand, or rays, or path vertices).
    #[inline]
    pub fn count_evaluations(&mut self, n: u64) {
        self.evaluations = self.evaluations.wrapping_add(n);
    }

    /// How many evaluations were counted.
    pub fn evaluations(&self) -> u64 {
        self.evaluations
    }

    /// Adds the counts of a stream that was seeded from this one.
    pub(crate) fn count(&mut self, other: &Self) {
        self.random_numbers = self.random_numbers.wrapping_add(other.random_numbers);
        self.count_evaluations(other.evaluations);
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
        Ok(if let Source::Independent = self.source { self.one.next() } else { self.elsewhere(index) })
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(8) {
            let Ok(word) = self.try_next_u64();
            chunk.copy_from_slice(&word.to_le_bytes()[..chunk.len()]);
        }
        Ok(())
    }
}
