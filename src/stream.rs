//! Where random numbers come from: one numbering of them by (seed, block, draw).
//!
//! A block of a run has 32 generators. Draw i of the block takes its numbers from generator i mod 32, after the numbers
//! of the draws before it there. So a draw's numbers do not depend on how draws are computed: one at a time in any order of
//! the generators, or 32 side by side in the lanes of vectors.

use std::convert::Infallible;
use std::ops::Range;

use pulp::NullaryFnOnce;
use rand::TryRng;

use crate::fast::{Real, widest};
use crate::placement::{Placement, SobolRows};

/// A stream of random numbers: those of one block of a run, draw by draw.
///
/// The generators are Xoshiro256++ (Blackman & Vigna 2019), started from (seed, block, place). The same triple gives the same
/// numbers on every machine and in every release that does not say otherwise in the changelog. Seed, block and place are
/// hashed together into the 256 bits of a generator's state, so neighbouring ones share nothing.
///
/// It is an ordinary [`rand::Rng`], so every distribution of rand's can draw from it, and it counts
/// what it gave, so that an estimator's cost is known. It gives the numbers of one draw until [`next_draw`](Self::next_draw).
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
    /// The generator of the current draw, and all of them if another was ever needed; there its own place is out of date.
    one: Xoshiro,
    lanes: Option<Box<Lanes>>,
    /// The current draw, and the numbers that were given before it.
    draw: u64,
    before: u64,
    random_numbers: u64,
    evaluations: u64,
}

/// What becomes of the generators' numbers.
#[derive(Debug, Clone)]
enum Source {
    Independent,
    Placed(Placement),
    /// These words one after the other, then 0 for ever, in their place.
    Script(Vec<u64>),
}

/// Generators of a block: as many as fill the widest vectors four times, since the steps of one draw depend on each other.
pub(crate) const LANES: usize = 32;

impl Stream {
    /// The stream of `block` in the run with `seed`, at its first draw.
    pub fn new(seed: u64, block: u64) -> Self {
        let words = mixed(seed, block);
        let one = Xoshiro(std::array::from_fn(|n| mix(words[n].wrapping_add(SALTS[n][0]))));
        let source = Source::Independent;
        Self { source, seed, block, one, lanes: None, draw: 0, before: 0, random_numbers: 0, evaluations: 0 }
    }

    /// A stream whose draws are the points of a placed set, randomised by `seed`.
    pub(crate) fn placed(placement: Placement, seed: u64) -> Self {
        Self { source: Source::Placed(placement), ..Self::new(seed, 0) }
    }

    /// A stream that gives these uniform numbers, each rounded down to the grid of 2⁻⁵³ and kept in [0, 1), and then 0 for ever: it makes of an estimator a
    /// function on the unit cube.
    ///
    /// ```
    /// let mut rng = unbiased::Stream::scripted(&[0.25, 0.75]);
    /// assert_eq!([rng.uniform(), rng.uniform(), rng.uniform()], [0.25, 0.75, 0.0]);
    /// ```
    pub fn scripted(uniforms: &[f64]) -> Self {
        // a float-to-int cast saturates, and takes NaN to 0
        let word = |u: &f64| ((u * GRID) as u64).min((1 << 53) - 1) << 11;
        Self { source: Source::Script(uniforms.iter().map(word).collect()), ..Self::new(0, 0) }
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
        on_the_grid(self.word())
    }

    #[inline]
    fn word(&mut self) -> u64 {
        let Ok(word) = self.try_next_u64();
        word
    }

    /// Goes on to the numbers of the next draw; [`Estimator::fill`](crate::Estimator::fill) does so after each of its draws.
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

    /// Fills `draws` with what `draw` makes of the numbers of each: a generator after the other, each of which then stays in registers.
    #[inline]
    pub(crate) fn one_at_a_time(&mut self, draws: &mut [f64], draw: impl Fn(&mut Self) -> f64) {
        match self.source {
            Source::Independent => {
                // one of its own, of which the compiler knows the source: the generator can stay in registers
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

    /// The next word of a source that few streams have: out of the way, so that a draw stays short enough to be inlined.
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

    /// The generator of the current draw.
    pub(crate) fn lane(&self) -> usize {
        if let Source::Script(_) = self.source { 0 } else { self.draw as usize % LANES }
    }

    /// Gives each of the next `draws` draws its first `each` numbers, and goes on to the draw after them. There are `each` times as many
    /// rows as 32 draws take, which are at most `sets`: number k of a draw is in row k·sets and those after it, in the place of its
    /// generator; what lies before the first draw or after the last stays.
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

    /// This draw, with its numbers in the first lane.
    pub(crate) fn alone(&mut self) -> Abreast<'_> {
        Abreast {
            first: self.draw,
            count: 1,
            stride: 1,
            places: std::array::from_fn(|lane| (lane == 0).then_some(0)),
            under_way: 1,
            before: [0; LANES],
            given: 0,
            waiting: [self.one; LANES],
            in_lanes: false,
            rng: self,
        }
    }

    /// The next draws, each in the lane of its generator: where one has ended another begins.
    pub(crate) fn abreast(&mut self, draws: usize) -> Abreast<'_> {
        if let Source::Script(_) = self.source {
            return Abreast { count: draws, under_way: draws.min(1), ..self.alone() };
        }
        let (one, first) = (self.one, self.draw);
        let place = |lane: usize| (lane as u64).wrapping_sub(first) as usize % LANES;
        let lanes = self.lanes();
        lanes.put(first as usize % LANES, one);
        Abreast {
            count: draws,
            stride: LANES,
            places: std::array::from_fn(|lane| Some(place(lane)).filter(|place| *place < draws)),
            under_way: draws.min(LANES),
            waiting: std::array::from_fn(|lane| lanes.get(lane)),
            in_lanes: true,
            ..self.alone()
        }
    }

    /// Leaves numbers out until this many were given in all.
    #[inline]
    pub(crate) fn skip_to(&mut self, random_numbers: u64) {
        while self.random_numbers < random_numbers {
            self.word();
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

    /// Counts what a stream gave that was started from here.
    pub(crate) fn count(&mut self, other: &Self) {
        self.random_numbers = self.random_numbers.wrapping_add(other.random_numbers);
        self.count_evaluations(other.evaluations);
    }
}

/// Draws side by side that take their numbers a few at a time, all as many.
pub(crate) struct Abreast<'a> {
    rng: &'a mut Stream,
    first: u64,
    count: usize,
    stride: usize,
    /// The draw of each lane, counted from the first, how many have one, and how many numbers the lane had given before it.
    places: [Option<usize>; LANES],
    under_way: usize,
    before: [u64; LANES],
    given: u64,
    /// The generators of the lanes that have no draw.
    waiting: [Xoshiro; LANES],
    /// Whether each lane has a generator of its own.
    in_lanes: bool,
}

impl Abreast<'_> {
    /// The draw that is under way in a lane, counted from the first.
    #[inline]
    pub fn draw(&self, lane: usize) -> Option<usize> {
        self.places[lane]
    }

    #[inline]
    pub fn under_way(&self) -> bool {
        self.under_way > 0
    }

    /// Lets a lane that has a draw go on to its next one, if there is one.
    #[inline]
    pub fn next_draw(&mut self, lane: usize) -> bool {
        let next = self.places[lane].map(|place| place + self.stride);
        self.places[lane] = next.filter(|place| *place < self.count);
        self.before[lane] = self.given;
        if self.places[lane].is_none() {
            self.under_way -= 1;
            self.waiting[lane] = self.rng.lanes().get(lane);
        }
        self.places[lane].is_some()
    }

    /// The next numbers of each lane's draw, as many as there are rows.
    pub fn numbers<T: Real>(&mut self, rows: &mut [[T; LANES]]) {
        let rng = &mut *self.rng;
        if !self.in_lanes {
            return rows.iter_mut().for_each(|row| row[0] = T::of_word(rng.word()));
        }
        let each = rows.len();
        widest(Fill { lanes: rng.lanes(), rows, each, sets: 1, count: 1, sobol: None });
        if let Source::Placed(placement) = &rng.source {
            for lane in 0..LANES {
                let Some(place) = self.places[lane] else { continue };
                let point = self.first + place as u64;
                for (row, dimension) in rows.iter_mut().zip(self.given - self.before[lane]..) {
                    row[lane] = T::of_word(placement.place(row[lane].word(), point, dimension));
                }
            }
        }
        self.given += each as u64;
        rng.random_numbers = rng.random_numbers.wrapping_add((each * self.under_way) as u64);
    }

    pub fn count_evaluations(&mut self, n: u64) {
        self.rng.count_evaluations(n);
    }

    /// Ends when all draws have: the stream goes on with the one after them.
    pub fn finish(self) {
        let Self { rng, first, count, waiting, in_lanes, .. } = self;
        if in_lanes {
            (rng.draw, rng.before) = (first + count as u64, rng.random_numbers);
            rng.one = waiting[rng.lane()];
            let lanes = rng.lanes();
            for (lane, one) in waiting.into_iter().enumerate() {
                lanes.put(lane, one);
            }
        }
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

/// Points of the grid of uniform numbers.
pub(crate) const GRID: f64 = (1u64 << 53) as f64;

/// The upper 53 bits as a number in [0, 1).
///
/// The upper and the lower half become numbers by their bits: a conversion of one integer to `f64` waits on x86 for what its register held
/// before, which is often the draw before.
#[inline(always)]
pub(crate) fn on_the_grid(bits: u64) -> f64 {
    const UPPER: f64 = 19_342_813_113_834_066_795_298_816.0; // 2⁸⁴: its last place is 2³²
    const LOWER: f64 = 4_503_599_627_370_496.0; // 2⁵²: its last place is 1
    let upper = f64::from_bits(UPPER.to_bits() | bits >> 43);
    let lower = f64::from_bits(LOWER.to_bits() | bits >> 11 & 0xffff_ffff);
    (upper - (UPPER + LOWER) + lower) * (1.0 / GRID)
}

/// The generator Xoshiro256++, whose state can be taken from a lane and put back.
#[derive(Debug, Clone, Copy)]
struct Xoshiro([u64; 4]);

impl Xoshiro {
    #[inline(always)]
    fn next(&mut self) -> u64 {
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

/// Lanes that have room in the registers together.
const TOGETHER: usize = 16;

/// What sets the lanes apart.
const SALTS: [[u64; LANES]; 4] = {
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

    #[inline]
    fn get(&self, lane: usize) -> Xoshiro {
        Xoshiro(self.state.map(|lanes| lanes[lane]))
    }

    #[inline]
    fn put(&mut self, lane: usize, one: Xoshiro) {
        for (lanes, word) in self.state.iter_mut().zip(one.0) {
            lanes[lane] = word;
        }
    }
}

struct Fill<'a, T> {
    lanes: &'a mut Lanes,
    rows: &'a mut [[T; LANES]],
    /// Numbers of a draw, rows from one of them to the next, and how many of those to fill.
    each: usize,
    sets: usize,
    count: usize,
    /// Where they are placed.
    sobol: Option<&'a SobolRows>,
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
            // a copy, which stays in registers
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

/// The next word of every lane: [`Xoshiro::next`] side by side.
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

/// Four words out of seed and block, of which a finaliser makes a generator's state.
fn mixed(seed: u64, block: u64) -> [u64; 4] {
    [1, 2, 3, 4].map(|word| {
        let salt = GOLDEN.wrapping_mul(word);
        mix(seed.wrapping_add(salt)).wrapping_add(mix(block ^ !salt))
    })
}

/// 2⁶⁴/φ, the increment of SplitMix64.
pub(crate) const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// SplitMix64's finaliser (Stafford's mix 13): a bijection in which every input bit moves half of the output's.
pub(crate) const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use rand::{Rng, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    use super::*;

    /// Every generator of a block, alone and in its lane, is the library's from the same state.
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

    /// A conversion by bits is the plain one.
    #[test]
    fn a_word_is_the_same_number_either_way() {
        let mut rng = Stream::new(5, 0);
        let random = std::iter::repeat_with(|| rng.next_u64()).take(100_000);
        for word in [0, u64::MAX, 1 << 11, (1 << 11) - 1, 1 << 43, (1 << 43) - 1].into_iter().chain(random) {
            assert_eq!(on_the_grid(word), f64::of_word(word));
            assert_eq!(f64::of_word(on_the_grid(word).word()), on_the_grid(word));
        }
    }
}
