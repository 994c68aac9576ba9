//! The integrals over a piece of a line, and where lines are cut.

/// The error allowed in a piece, relative to the whole: for a thousand pieces the sum is a tenth of what is
/// promised.
const TOLERANCE: f64 = 1e-13;

/// Below this width the error allowed shrinks with the width, so that a jump is bisected down to the grid.
pub const NARROW: f64 = 1.0 / (1u64 << 30) as f64;

/// The number of steps of the grid of uniform numbers.
pub const GRID: u64 = 1 << 53;

/// The width of one step.
pub const STEP: f64 = 1.0 / GRID as f64;

/// A piece with at most this many steps is summed over all of them.
pub const FEW: u64 = 16;

/// The empty range.
pub const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// Integrals over a piece. X is in units of its typical size, and Y = X − its median.
#[derive(Clone, Copy, Default)]
pub struct Sums {
    /// of Y and Y²
    pub moments: [f64; 2],
    /// of |X|
    pub size: f64,
    /// error bounds of the moments
    pub errors: [f64; 2],
    /// how much Y and Y² could change if every node moved by one step of the grid
    pub steps: [f64; 2],
}

impl Sums {
    #[inline]
    pub fn add(&mut self, weight: f64, other: &Self) {
        for order in 0..2 {
            self.moments[order] += weight * other.moments[order];
            self.errors[order] += weight * other.errors[order];
            self.steps[order] += weight * other.steps[order];
        }
        self.size += weight * other.size;
    }

    /// What errors of the two moments are relative to.
    pub fn scales(&self) -> [f64; 2] {
        [self.size, self.moments[1]]
    }
}

/// The error of the variance due to the rounding of X.
pub fn noise([size, square]: [f64; 2]) -> f64 {
    let rounding = 8.0 * f64::EPSILON * size;
    2.0 * rounding * square.sqrt() + rounding * rounding
}

/// An interval of a line, in steps, with the integrals over it.
#[derive(Clone, Copy)]
pub struct Piece {
    pub from: u64,
    pub to: u64,
    pub sums: Sums,
    /// The difference between the largest and the smallest Y, and Y², at its nodes.
    pub ranges: [f64; 2],
    /// The step at which Y changes most and by how much, if the piece was summed step by step.
    pub jump: Option<(u64, f64)>,
    pub looked_at: bool,
}

impl Piece {
    pub fn width(&self) -> f64 {
        (self.to - self.from) as f64 * STEP
    }

    /// Where to cut other lines so that they need not search for the same jump.
    pub fn ends(&self) -> [u64; 2] {
        self.jump.map_or([self.from, self.to], |(step, _)| around(step))
    }

    /// Whether its error is small compared with the whole.
    pub fn is_good(&self, scales: [f64; 2]) -> bool {
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

#[inline]
pub fn widened([least, most]: [f64; 2], value: f64) -> [f64; 2] {
    [least.min(value), most.max(value)]
}

/// The union of cuts, sorted.
pub fn merged(mut cuts: Vec<u64>, more: impl IntoIterator<Item = u64>) -> Vec<u64> {
    cuts.extend(more);
    cuts.sort_unstable();
    cuts.dedup();
    cuts
}

/// The pieces that caused a line to be cut beyond its initial pieces.
pub fn causes<'p>(pieces: &'p [Piece], first: &[u64]) -> impl Iterator<Item = &'p Piece> {
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
