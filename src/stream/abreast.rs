//! Up to 32 draws at a time, each in the lane of its generator.

use super::generator::{Fill, Xoshiro};
use super::word::LANES;
use super::{Source, Stream};
use crate::fast::{Real, widest};

impl Stream {
    /// The current draw alone, with its numbers in the first lane.
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

    /// The next draws, each in the lane of its generator; when one ends, the lane's next draw begins.
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
}

/// Several draws in progress, which take their numbers a few at a time, each equally many.
pub(crate) struct Abreast<'a> {
    rng: &'a mut Stream,
    first: u64,
    count: usize,
    stride: usize,
    /// The current draw of each lane, counted from the first one.
    places: [Option<usize>; LANES],
    /// How many lanes have a draw.
    under_way: usize,
    /// How many numbers the lane had returned before its current draw, and has returned by now.
    before: [u64; LANES],
    given: u64,
    /// The generators of the lanes that have no draw.
    waiting: [Xoshiro; LANES],
    /// Whether the lanes are in use, not just the current draw's generator.
    in_lanes: bool,
}

impl Abreast<'_> {
    /// The current draw of a lane, counted from the first one.
    #[inline]
    pub fn draw(&self, lane: usize) -> Option<usize> {
        self.places[lane]
    }

    #[inline]
    pub fn under_way(&self) -> bool {
        self.under_way > 0
    }

    /// Goes on to a lane's next draw; returns whether there is one.
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

    /// Call it when all draws have ended: the stream goes on with the draw after them.
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
