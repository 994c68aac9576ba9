//! Adaptive quadrature along lines through the unit cube: a piece is halved until its two rules agree.

use std::time::Duration;

use rand::Rng;

use super::piece::{FEW, GRID, NARROW, NOTHING, Piece, STEP, Sums, causes, merged, widened};
use super::rule::{LANES, NODES, Rule, chebyshev, nested_rule, polynomial};
use crate::error::{Error, Result};
use crate::estimator::Estimator;
use crate::run::Watch;
use crate::stream::{GOLDEN, Stream};

/// The inverse of the largest distance between points at which X is compared with its polynomials.
const LOOKS: f64 = (1u64 << 20) as f64;

/// If a draw takes longer than this, fewer points are compared: 2²⁰ of them would take many seconds.
const SLOW: Duration = Duration::from_micros(1);
const FEWER_LOOKS: f64 = (1u64 << 14) as f64;

/// Draws that determine the scale of X; odd, so that there is a median.
const FIRST: usize = 255;

/// Evaluations after which the integration is given up: about a second.
const MOST: u64 = 30_000_000;

/// After this many jumps at different places it is assumed that one jump is oblique to the axes.
const JUMPS: usize = 256;

/// A line of integration: along one axis, with earlier axes fixed and later ones integrated, or along a
/// diagonal.
#[derive(Clone, Copy)]
pub enum Line {
    Axis(usize),
    Diagonal([u64; 3]),
}

pub struct Sweep<'a, E: ?Sized> {
    pub estimator: &'a E,
    dimensions: usize,
    looks: f64,
    rng: Stream,
    point: [u64; 3],
    /// A power of two by which X is divided, so that its square neither over- nor underflows.
    pub unit: f64,
    /// The median that is subtracted from X to give Y.
    pub middle: f64,
    /// What errors are relative to, estimated from the first draws.
    scales: [f64; 2],
    /// The smallest and the largest Y since this was last set.
    pub range: [f64; 2],
    rule: Rule,
    cuts: [Vec<u64>; 3],
    jumps: usize,
    evaluations: u64,
}

impl<'a, E: Estimator + ?Sized> Sweep<'a, E> {
    pub fn new(estimator: &'a E, dimensions: usize) -> Result<Self> {
        // multiples of the golden ratio: evenly spread, and except for 0 not where jumps are likely
        let pieces = [64, 16, 6].get(dimensions - 1).copied().unwrap_or(1);
        let mut cuts: Vec<u64> =
            (0..pieces).map(|k: u64| k.wrapping_mul(GOLDEN) >> 11).chain([GRID]).collect();
        cuts.sort_unstable();
        let mut sweep = Self {
            estimator,
            dimensions,
            looks: LOOKS,
            rng: Stream::scripted(&[]),
            point: [0; 3],
            unit: 1.0,
            middle: 0.0,
            scales: [0.0; 2],
            range: NOTHING,
            rule: nested_rule(),
            cuts: std::array::from_fn(|_| cuts.clone()),
            jumps: 0,
            evaluations: 0,
        };
        let mut random = Stream::new(0, 0);
        let mut draws = Vec::with_capacity(FIRST);
        let mut quickest = Duration::MAX;
        for _ in 0..FIRST {
            sweep.point = std::array::from_fn(|_| random.next_u64() >> 11);
            let watch = Watch::start(None);
            draws.push(sweep.draw()?);
            quickest = quickest.min(watch.elapsed());
        }
        // on a busy machine at least one of these draws is not delayed
        if quickest > SLOW {
            sweep.looks = FEWER_LOOKS;
        }
        draws.sort_unstable_by(f64::total_cmp);
        let largest = draws.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
        if largest > 0.0 {
            sweep.unit = 2f64.powi(largest.log2().floor() as i32).max(f64::MIN_POSITIVE);
        }
        // the median is within a std deviation of the mean, so hardly a digit of the variance is lost
        sweep.middle = draws.get(FIRST / 2).map_or(0.0, |median| median / sweep.unit);
        let mut sums = Sums::default();
        for x in draws {
            sums.add(1.0 / FIRST as f64, &sweep.sums_of(x)?);
        }
        sweep.scales = sums.scales();
        Ok(sweep)
    }

    /// X at the point.
    #[inline]
    fn draw(&mut self) -> Result<f64> {
        self.evaluations += 1;
        if self.evaluations > MOST {
            return Err(refused(format!(
                "it would take more than {MOST} draws, as an X that oscillates often does"
            )));
        }
        let point = self.point.get(..self.dimensions).unwrap_or_default();
        self.rng.rewind(point);
        let value = self.estimator.draw(&mut self.rng);
        let taken = self.rng.random_numbers();
        if taken > self.dimensions as u64 {
            let allowed = self.dimensions;
            return Err(refused(format!("it took {taken} random numbers in a draw, not {allowed}")));
        }
        if !value.is_finite() {
            let point: Vec<f64> = point.iter().map(|&step| step as f64 * STEP).collect();
            return Err(refused(format!("it is {value} at u = {point:?}")));
        }
        Ok(value)
    }

    #[inline]
    pub fn sums_of(&mut self, x: f64) -> Result<Sums> {
        let x = x / self.unit;
        let y = x - self.middle;
        let square = y * y;
        if !square.is_finite() {
            return Err(refused("the squares of its draws are beyond f64".into()));
        }
        self.range = widened(self.range, y);
        Ok(Sums { moments: [y, square], size: x.abs(), ..Sums::default() })
    }

    /// The integrals over the axes after the line's, at this step of the line.
    #[inline]
    fn at(&mut self, line: Line, step: u64) -> Result<Sums> {
        self.go(line, step);
        if let Line::Axis(axis) = line
            && axis + 1 < self.dimensions
        {
            return Ok(self.integrate(Line::Axis(axis + 1), false)?.0);
        }
        let x = self.draw()?;
        self.sums_of(x)
    }

    #[inline]
    fn go(&mut self, line: Line, step: u64) {
        match line {
            Line::Axis(axis) => {
                if let Some(coordinate) = self.point.get_mut(axis) {
                    *coordinate = step;
                }
            }
            Line::Diagonal(offsets) => self.point = offsets.map(|offset| (step + offset) % GRID),
        }
    }

    /// The integrals along a line, and its pieces. With `look`, each piece is also compared at other points.
    pub fn integrate(&mut self, line: Line, look: bool) -> Result<(Sums, Vec<Piece>)> {
        let cuts = self.cuts_of(line);
        let mut pieces = Vec::with_capacity(2 * cuts.len());
        for (&from, &to) in cuts.iter().zip(cuts.iter().skip(1)) {
            pieces.push(self.piece(line, from, to)?);
        }
        // pieces are judged relative to the whole, so all are judged again after some were halved
        loop {
            let mut whole = Sums::default();
            pieces.iter().for_each(|piece| whole.add(1.0, &piece.sums));
            let [size, square] = whole.scales();
            let scales = [size.max(self.scales[0]), square.max(self.scales[1])];
            let mut halved = Vec::with_capacity(pieces.len() + 64);
            for piece in &mut pieces {
                if look && !piece.looked_at && piece.width() * self.looks > 1.0 && piece.is_good(scales) {
                    self.look(line, piece)?;
                }
                if piece.is_good(scales) {
                    halved.push(*piece);
                } else {
                    let middle = piece.from.midpoint(piece.to);
                    halved.push(self.piece(line, piece.from, middle)?);
                    halved.push(self.piece(line, middle, piece.to)?);
                }
            }
            let done = halved.len() == pieces.len();
            pieces = halved;
            if done {
                if let Line::Axis(axis @ 1..) = line {
                    self.remember_jumps(axis, &pieces)?;
                }
                return Ok((whole, pieces));
            }
        }
    }

    /// The initial pieces of a line.
    fn cuts_of(&self, line: Line) -> Vec<u64> {
        match line {
            Line::Axis(axis) => self.cuts.get(axis).cloned().unwrap_or_default(),
            Line::Diagonal(offsets) => {
                // the diagonal leaves the cube at its far faces and continues at the opposite ones
                let faces = offsets.map(|offset| GRID - offset);
                merged(self.cuts.first().cloned().unwrap_or_default(), faces)
            }
        }
    }

    /// Both rules on one piece, or all its steps if they are few. Both ends are nodes, so that a jump close
    /// to an end is not missed.
    fn piece(&mut self, line: Line, from: u64, to: u64) -> Result<Piece> {
        let (mut sums, mut ranges) = (Sums::default(), [NOTHING; 2]);
        let mut include = |sums: &mut Sums, weight: f64, there: &Sums| {
            sums.add(weight, there);
            for (range, value) in ranges.iter_mut().zip(there.moments) {
                *range = widened(*range, value);
            }
        };
        let width = (to - from) as f64 * STEP;
        let mut jump = None;
        if to - from <= FEW {
            let (mut before, mut rise) = (f64::NAN, 0.0);
            for step in from..to {
                let there = self.at(line, step)?;
                include(&mut sums, STEP, &there);
                let [value, _] = there.moments;
                let change = (value - before).abs();
                if change > rise {
                    (jump, rise) = (Some((step, change)), change);
                }
                before = value;
            }
        } else {
            let mut coarse = [0.0; 2];
            for (index, (_, weight, coarser)) in self.rule.into_iter().enumerate() {
                let there = self.at(line, self.node(from, to, index))?;
                include(&mut sums, width * weight, &there);
                coarse = [0, 1].map(|order| coarse[order] + width * coarser * there.moments[order]);
            }
            sums.errors =
                [0, 1].map(|order| sums.errors[order] + (sums.moments[order] - coarse[order]).abs());
        }
        let ranges = ranges.map(|[least, most]| most - least);
        sums.steps = [0, 1].map(|order| sums.steps[order] + STEP * ranges[order]);
        Ok(Piece { from, to, sums, ranges, jump, looked_at: false })
    }

    /// The step that contains the rule's node on a piece.
    #[inline]
    fn node(&self, from: u64, to: u64, index: usize) -> u64 {
        let (node, ..) = self.rule[index];
        (from + (0.5 * (1.0 + node) * (to - from) as f64) as u64).min(to - 1)
    }

    /// Raises a piece's error bounds to the difference of X from its polynomial at points that are not nodes.
    fn look(&mut self, line: Line, piece: &mut Piece) -> Result<()> {
        let Piece { from, to, .. } = *piece;
        let mut values = [0.0; NODES];
        for (index, value) in values.iter_mut().enumerate() {
            [*value, _] = self.at(line, self.node(from, to, index))?.moments;
        }
        let coefficients = chebyshev(&values);
        let rows = (piece.width() * self.looks / LANES as f64).ceil().max(1.0);
        let steps = (to - from) as f64;
        let apart = steps / (rows * LANES as f64);
        let mut off = [0.0; 2];
        for row in 0..rows as usize {
            let (mut places, mut values) = ([0.0; LANES], [0.0; LANES]);
            for (index, (place, value)) in (row * LANES..).zip(places.iter_mut().zip(&mut values)) {
                // an irregular fraction, so that it is not a node
                let step = ((index as f64 + 0.382) * apart) as i64;
                *place = step as f64;
                self.go(line, from + step as u64);
                *value = self.draw()?;
            }
            let places = places.map(|step| (step + 0.5) * (2.0 / steps) - 1.0);
            let values = values.map(|value| value / self.unit - self.middle);
            self.range = values.iter().fold(self.range, |range, &value| widened(range, value));
            let taken = polynomial(&coefficients, &places);
            for (value, taken) in values.iter().zip(&taken) {
                let difference = (value - taken).abs();
                off = [off[0] + difference, off[1] + difference * (value + taken).abs()];
            }
        }
        let weight = piece.width() / (rows * LANES as f64);
        piece.sums.errors = [0, 1].map(|order| piece.sums.errors[order].max(weight * off[order]));
        piece.looked_at = true;
        Ok(())
    }

    /// Cuts an axis where X jumps, so that other lines along it need not search for the place.
    fn remember_jumps(&mut self, axis: usize, pieces: &[Piece]) -> Result<()> {
        let narrow = pieces.iter().any(|piece| piece.width() < NARROW);
        let Some(cuts) = self.cuts.get_mut(axis).filter(|_| narrow) else { return Ok(()) };
        let new: Vec<[u64; 2]> =
            causes(pieces, cuts).filter(|piece| piece.width() < NARROW).map(Piece::ends).collect();
        if !new.is_empty() {
            self.jumps += new.len();
            if self.jumps > JUMPS {
                return Err(refused("it jumps at an angle to the axes, or at too many places".into()));
            }
            *cuts = merged(std::mem::take(cuts), new.into_iter().flatten());
        }
        Ok(())
    }

    /// Integrates along the cube's diagonal, and cuts the axes wherever that line had to be cut.
    pub fn look_along_the_diagonal(&mut self) -> Result<()> {
        let mut random = Stream::new(0, 1);
        let offsets = std::array::from_fn(|_| random.next_u64() >> 11);
        let line = Line::Diagonal(offsets);
        let first = self.cuts_of(line);
        let (_, pieces) = self.integrate(line, true)?;
        for piece in causes(&pieces, &first) {
            let [before, after] = piece.ends().map(|end| offsets.map(|offset| (end + offset) % GRID));
            self.point = before;
            let start = self.draw()?;
            for axis in 0..self.dimensions {
                // cut only the axis along which X jumps here
                self.point = before;
                self.point[axis] = after[axis];
                let change = (self.draw()? - start).abs() / self.unit;
                if piece.jump.is_none_or(|(_, rise)| change >= 0.5 * rise) {
                    let cuts = std::mem::take(&mut self.cuts[axis]);
                    self.cuts[axis] = merged(cuts, [before[axis], after[axis]]);
                }
            }
        }
        Ok(())
    }
}

pub fn refused(reason: String) -> Error {
    Error::NotIntegrable { reason }
}
