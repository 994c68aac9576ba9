//! Exact mean and variance of an estimator of few random numbers: it is a function on the unit cube, so they
//! are integrals.

use std::f64::consts::PI;
use std::time::Duration;

use pulp::NullaryFnOnce;
use rand::Rng;

use crate::error::{Error, Result, require_count};
use crate::estimator::Estimator;
use crate::fast::widest;
use crate::run::Watch;
use crate::stream::Stream;
use crate::stream::points::{Placement, Sobol};

/// The exact moments of an estimator, each to the accuracy that [`exactly`] states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exact {
    /// E\[X\], to 1e-9 of E|X|
    pub mean: f64,
    /// Var X, to 1e-9 of itself, or as far as the rounding of the draws lets it be known
    pub variance: f64,
}

/// Mean and variance of an estimator that takes at most `random_numbers` ≤ 3 uniform numbers per draw, by
/// adaptive quadrature over the unit cube: a check of unbiasedness without noise or false alarms.
///
/// It integrates the values of [`Estimator::draw`] by nested rules of 9 and 17 points (Clenshaw & Curtis
/// 1960). Jumps, kinks and singularities at a value of one coordinate are isolated by bisection, down to
/// 2⁻⁵³, the step of [`Stream::uniform`].
///
/// # What is promised
/// The mean is accurate to 1e-9 of E|X| and the variance to a relative error of 1e-9. If σ is below 4e-6 of
/// E|X| the rounding of the draws makes the variance less accurate; below 5e-15 of E|X| it is given as 0.
///
/// A quadrature rule cannot see X between its nodes. So X is also compared at other points:
/// - *One number:* X is compared with the interpolating polynomials of the quadrature, at points 2⁻²⁰ apart
///   or less. A deviation of more than 1e-7 of E|X| over an interval of 2⁻²⁰ ≈ 9.6e-7 or more is detected. A
///   deviation over a shorter interval of width w is **missed** with a probability of about 1 − 2²⁰ w.
/// - *Two or three:* the same along a diagonal of the cube, which detects deviations that depend on one
///   number only. Others are detected by the quadrature's own points, less than 1/100 of the side apart in
///   two dimensions and 1/40 in three, and by 16 scrambled Sobol sets of 2¹⁴ points (Owen 1997): their values
///   must lie within the quadrature's range, extended by a quarter, and their means of X and X² must agree
///   with the quadrature to ten std errors plus 1/16384 of that range. So a deviation in a region smaller
///   than the distance of those points in every direction may be **missed**: with a probability of about
///   exp(−262144 a) if its volume is a and X leaves that range there, and always if X does not.
///
/// If a draw takes more than a microsecond, 2⁻¹⁴ ≈ 6e-5 replaces 2⁻²⁰.
///
/// ```
/// use unbiased::{check, from_fn};
///
/// let exact = check::exactly(&from_fn(|rng| -(1.0 - rng.uniform()).ln() / 0.37), 1)?;
/// assert!((exact.mean - 1.0 / 0.37).abs() < 1e-9);
/// assert!((exact.variance - 1.0 / 0.37f64.powi(2)).abs() < 1e-8);
/// # Ok::<(), unbiased::Error>(())
/// ```
///
/// # Errors
/// If a draw takes more numbers than that, or is not finite; if X jumps along a line or surface that is
/// aslant to the axes; if mean or variance is infinite, or depends on single steps of 2⁻⁵³; if the size of X,
/// its square or its variance is outside `f64`'s range; if the two rules disagree; or if it would take more
/// than 3·10⁷ draws.
pub fn exactly(estimator: &(impl Estimator + ?Sized), random_numbers: usize) -> Result<Exact> {
    let count = random_numbers as u64;
    require_count("the random numbers of a draw", count, (1..=3).contains(&count), "1, 2 or 3")?;
    let mut sweep = Sweep::new(estimator, random_numbers)?;
    if random_numbers == 1 {
        let (sums, _) = sweep.integrate(Line::Axis(0), true)?;
        let (mean, variance) = sweep.judged(&sums)?;
        return Ok(Exact { mean, variance: variance? });
    }
    sweep.look_along_the_diagonal()?;
    let looked_at = std::mem::replace(&mut sweep.range, NOTHING);
    let (sums, _) = sweep.integrate(Line::Axis(0), false)?;
    let integrated = std::mem::replace(&mut sweep.range, looked_at);
    let scattered = sweep.scattered()?;
    let (mean, variance) = sweep.judged(&sums)?;
    let [first, second] = sweep.compare(&sums, integrated, scattered);
    first.and(second)?;
    Ok(Exact { mean, variance: variance? })
}

/// The inverse of the largest distance between points at which X is compared with its polynomials.
const LOOKS: f64 = (1u64 << 20) as f64;

/// If a draw takes longer than this, fewer points are compared: 2²⁰ of them would take many seconds.
const SLOW: Duration = Duration::from_micros(1);
const FEWER_LOOKS: f64 = (1u64 << 14) as f64;

/// The accuracy promised.
const ACCURACY: f64 = 1e-9;

/// The error allowed in a piece, relative to the whole: for a thousand pieces the sum is a tenth of what is
/// promised.
const TOLERANCE: f64 = 1e-13;

/// Below this width the error allowed shrinks with the width, so that a jump is bisected down to the grid.
const NARROW: f64 = 1.0 / (1u64 << 30) as f64;

/// 2⁶⁴ divided by the golden ratio.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// The number of steps of the grid of uniform numbers.
const GRID: u64 = 1 << 53;

/// The width of one step.
const STEP: f64 = 1.0 / GRID as f64;

/// A piece with at most this many steps is summed over all of them.
const FEW: u64 = 16;

/// Draws that determine the scale of X; odd, so that there is a median.
const FIRST: usize = 255;

/// The empty range.
const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// Evaluations after which the integration is given up: about a second.
const MOST: u64 = 30_000_000;

/// After this many jumps at different places it is assumed that one jump is aslant to the axes.
const JUMPS: usize = 256;

/// Independently scrambled Sobol sets, points of each, points computed at a time, and std errors allowed.
const SCRAMBLES: usize = 16;
const POINTS: u32 = 1 << 14;
const TOGETHER: usize = 1 << 10;
const STD_ERRORS: f64 = 10.0;

/// Integrals over a piece. X is in units of its typical size, and Y = X − its median.
#[derive(Clone, Copy, Default)]
struct Sums {
    /// of Y and Y²
    moments: [f64; 2],
    /// of |X|
    size: f64,
    /// error bounds of the moments
    errors: [f64; 2],
    /// how much Y and Y² could change if every node moved by one step of the grid
    steps: [f64; 2],
}

impl Sums {
    fn add(&mut self, weight: f64, other: &Self) {
        for order in 0..2 {
            self.moments[order] += weight * other.moments[order];
            self.errors[order] += weight * other.errors[order];
            self.steps[order] += weight * other.steps[order];
        }
        self.size += weight * other.size;
    }

    /// What errors of the two moments are relative to.
    fn scales(&self) -> [f64; 2] {
        [self.size, self.moments[1]]
    }
}

/// The error of the variance due to the rounding of X.
fn noise([size, square]: [f64; 2]) -> f64 {
    let rounding = 8.0 * f64::EPSILON * size;
    2.0 * rounding * square.sqrt() + rounding * rounding
}

/// A line of integration: along one axis, with earlier axes fixed and later ones integrated, or along a
/// diagonal.
#[derive(Clone, Copy)]
enum Line {
    Axis(usize),
    Diagonal([u64; 3]),
}

/// An interval of a line, in steps, with the integrals over it.
#[derive(Clone, Copy)]
struct Piece {
    from: u64,
    to: u64,
    sums: Sums,
    /// The difference between the largest and the smallest Y, and Y², at its nodes.
    ranges: [f64; 2],
    /// The step at which Y changes most and by how much, if the piece was summed step by step.
    jump: Option<(u64, f64)>,
    looked_at: bool,
}

impl Piece {
    fn width(&self) -> f64 {
        (self.to - self.from) as f64 * STEP
    }

    /// Where to cut other lines so that they need not search for the same jump.
    fn ends(&self) -> [u64; 2] {
        self.jump.map_or([self.from, self.to], |(step, _)| around(step))
    }

    /// Whether its error is small compared with the whole.
    fn is_good(&self, scales: [f64; 2]) -> bool {
        let allowed = TOLERANCE * (self.width() / NARROW).min(1.0);
        // A node may be up to a step below its exact place. A jump is not mistaken for that: on more than 16
        // steps it makes the two rules differ by more than 16 × 0.00597 steps times its height.
        let [one, other] = self.ranges.map(|range| 0.095 * STEP * range);
        let [error, of_square] = self.sums.errors;
        self.to - self.from <= FEW
            || (error <= allowed * scales[0] + one
                && of_square <= allowed * scales[1] + noise(scales) * self.width() + other)
    }
}

struct Sweep<'a, E: ?Sized> {
    estimator: &'a E,
    dimensions: usize,
    looks: f64,
    rng: Stream,
    point: [u64; 3],
    /// A power of two by which X is divided, so that its square neither over- nor underflows.
    unit: f64,
    /// The median that is subtracted from X to give Y.
    middle: f64,
    /// What errors are relative to, estimated from the first draws.
    scales: [f64; 2],
    /// The smallest and the largest Y since this was last set.
    range: [f64; 2],
    rule: Rule,
    cuts: [Vec<u64>; 3],
    jumps: usize,
    evaluations: u64,
}

impl<'a, E: Estimator + ?Sized> Sweep<'a, E> {
    fn new(estimator: &'a E, dimensions: usize) -> Result<Self> {
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
    fn sums_of(&mut self, x: f64) -> Result<Sums> {
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
    fn integrate(&mut self, line: Line, look: bool) -> Result<(Sums, Vec<Piece>)> {
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
            let taken = widest(Clenshaw { coefficients: &coefficients, places: &places });
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
                return Err(refused("it jumps aslant to the axes, or at too many places".into()));
            }
            *cuts = merged(std::mem::take(cuts), new.into_iter().flatten());
        }
        Ok(())
    }

    /// Integrates along the cube's diagonal, and cuts the axes wherever that line had to be cut.
    fn look_along_the_diagonal(&mut self) -> Result<()> {
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

    /// Means of Y and Y² and their std errors, from independently scrambled Sobol sets.
    fn scattered(&mut self) -> Result<[[f64; 2]; 2]> {
        let mut means = [[0.0; SCRAMBLES]; 2];
        for scramble in 0..SCRAMBLES {
            let seed = Stream::new(1, scramble as u64).next_u64();
            let mut points = Stream::placed(Placement::Sobol(Sobol::new(POINTS, seed)), seed);
            for _ in 0..POINTS / TOGETHER as u32 {
                let mut draws = [0.0; TOGETHER];
                self.estimator.fill(&mut points, &mut draws);
                for x in draws {
                    if !x.is_finite() {
                        return Err(refused(format!("it is {x} at a scattered point")));
                    }
                    let there = self.sums_of(x)?.moments;
                    for (means, value) in means.iter_mut().zip(there) {
                        means[scramble] += value / f64::from(POINTS);
                    }
                }
            }
        }
        Ok(means.map(|means| {
            let n = SCRAMBLES as f64;
            let mean = means.iter().sum::<f64>() / n;
            let squares: f64 = means.iter().map(|other| (other - mean).powi(2)).sum();
            [mean, (squares / (n * (n - 1.0))).sqrt()]
        }))
    }

    /// Mean and variance, if they are as accurate as promised.
    fn judged(&self, sums: &Sums) -> Result<(f64, Result<f64>)> {
        let ([first, second], [error, of_square]) = (sums.moments, sums.errors);
        let noise = noise(sums.scales());
        let ok = |what: &str, errors: f64, steps: f64, allowed: f64| {
            let steps = 2.0 * steps;
            let reason = if errors + steps <= allowed {
                return Ok(());
            } else if steps <= 0.5 * allowed {
                format!("its {what} is known to {errors:.0e} only, where {allowed:.0e} is asked for")
            } else {
                let steps = "single steps 2⁻⁵³ of the random numbers";
                format!("its {what} depends on {steps}: its variance is infinite or as good as")
            };
            Err(refused(reason))
        };
        ok("mean", error, sums.steps[0], ACCURACY * sums.size)?;
        let mean = self.unit * (self.middle + first);
        let size = self.unit * sums.size;
        let within = |value: f64| value == 0.0 || value.is_normal();
        if !(within(size) && mean.is_finite()) {
            return Err(refused("its mean is beyond f64".into()));
        }
        // if the first draws were all 0 the unit is meaningless, and squares may have underflowed
        if sums.size > 0.0 && sums.size < 1e-100 {
            return Err(refused("the squares of its draws are beyond f64".into()));
        }
        let variance = second - first * first;
        let errors = of_square + 2.0 * first.abs() * error;
        let variance = ok("variance", errors, sums.steps[1], ACCURACY * variance + noise).and_then(|()| {
            let variance = if variance > noise { variance } else { 0.0 };
            let scaled = variance * self.unit * self.unit;
            if within(scaled) && (scaled > 0.0 || variance == 0.0) {
                Ok(scaled)
            } else {
                Err(refused("its variance is beyond f64".into()))
            }
        });
        Ok((mean, variance))
    }

    /// Compares the integrals and the range of Y with those from points that the quadrature did not choose.
    fn compare(&self, sums: &Sums, [least, most]: [f64; 2], scattered: [[f64; 2]; 2]) -> [Result<()>; 2] {
        let [low, high] = self.range;
        let room = 0.25 * (most - least) + 8.0 * f64::EPSILON * sums.size;
        let inside = low >= least - room && high <= most + room;
        let squares = least.abs().max(most.abs()).powi(2);
        // with probability (1 − p)^16 all sets miss the same fraction p of the one point that a jump affects,
        // which no std error shows
        let jumps = [most - least, squares].map(|range| range / f64::from(POINTS));
        [0, 1].map(|order| {
            let [mean, std_error] = scattered[order];
            let rounding = [8.0 * f64::EPSILON * sums.size, noise(sums.scales())][order];
            let allowed = STD_ERRORS * std_error + jumps[order] + ACCURACY * sums.scales()[order] + rounding;
            if inside && (mean - sums.moments[order]).abs() <= allowed {
                return Ok(());
            }
            Err(refused("its values at scattered points do not agree with the quadrature".into()))
        })
    }
}

fn refused(reason: String) -> Error {
    Error::NotIntegrable { reason }
}

#[inline]
fn widened([least, most]: [f64; 2], value: f64) -> [f64; 2] {
    [least.min(value), most.max(value)]
}

/// The union of cuts, sorted.
fn merged(mut cuts: Vec<u64>, more: impl IntoIterator<Item = u64>) -> Vec<u64> {
    cuts.extend(more);
    cuts.sort_unstable();
    cuts.dedup();
    cuts
}

/// The pieces that caused a line to be cut beyond its initial pieces.
fn causes<'p>(pieces: &'p [Piece], first: &[u64]) -> impl Iterator<Item = &'p Piece> {
    let known = |step: u64| first.binary_search(&step).is_ok();
    pieces.iter().enumerate().filter_map(move |(index, piece)| {
        // a piece next to a much narrower one was only cut to get there
        let near = pieces.iter().skip(index.saturating_sub(2)).take(5);
        let on_the_way =
            near.into_iter().any(|other| 3 * (other.to - other.from) < 2 * (piece.to - piece.from));
        let at_first = known(piece.from) && known(piece.to);
        (!on_the_way && !at_first).then_some(piece)
    })
}

/// A piece of few steps around a jump, wide enough for rounding to move the jump a little.
fn around(jump: u64) -> [u64; 2] {
    let from = jump.saturating_sub(FEW / 2).min(GRID - FEW);
    [from, from + FEW]
}

const NODES: usize = 17;

/// Points on a line that are computed at once.
const LANES: usize = 16;

/// Node on [−1, 1], weight on a piece of width 1, and weight in the coarser rule on every second node.
type Rule = [(f64, f64, f64); NODES];

/// The rules of Clenshaw & Curtis (1960) with 17 points and, on every second of them, with 9.
fn nested_rule() -> Rule {
    let weight = |k: usize, n: usize| {
        let angle = PI * k as f64 / n as f64;
        let sum: f64 = (1..=n / 2)
            .map(|j| {
                let last = if 2 * j == n { 1.0 } else { 2.0 };
                last * (2.0 * j as f64 * angle).cos() / (4 * j * j - 1) as f64
            })
            .sum();
        (if k.is_multiple_of(n) { 0.5 } else { 1.0 }) * (1.0 - sum) / n as f64
    };
    std::array::from_fn(|k| {
        let node = -(PI * k as f64 / 16.0).cos();
        (node, weight(k, 16), if k.is_multiple_of(2) { weight(k / 2, 8) } else { 0.0 })
    })
}

/// Chebyshev coefficients of the polynomial through these values at the nodes.
fn chebyshev(values: &[f64; NODES]) -> [f64; NODES] {
    let half_at_ends = |k: usize| if k.is_multiple_of(NODES - 1) { 0.5 } else { 1.0 };
    std::array::from_fn(|k| {
        let term = |(j, value): (usize, &f64)| {
            // the nodes are −cos(π j/16)
            half_at_ends(j) * value * (PI * (k * (16 - j) % 32) as f64 / 16.0).cos()
        };
        half_at_ends(k) * values.iter().enumerate().map(term).sum::<f64>() / 8.0
    })
}

/// Evaluates the polynomial with these coefficients at several points (Clenshaw 1955).
struct Clenshaw<'a> {
    coefficients: &'a [f64; NODES],
    places: &'a [f64; LANES],
}

impl NullaryFnOnce for Clenshaw<'_> {
    type Output = [f64; LANES];

    #[inline(always)]
    fn call(self) -> [f64; LANES] {
        let (mut next, mut after) = ([0.0; LANES], [0.0; LANES]);
        let [constant, others @ ..] = self.coefficients;
        for coefficient in others.iter().rev() {
            for lane in 0..LANES {
                let this = coefficient + 2.0 * self.places[lane] * next[lane] - after[lane];
                (next[lane], after[lane]) = (this, next[lane]);
            }
        }
        std::array::from_fn(|lane| constant + self.places[lane] * next[lane] - after[lane])
    }
}
