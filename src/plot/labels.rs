//! Placing labels in a drawing: beside their points, without covering lines or each other.

/// A rectangle given by its centre, in the drawing's units.
#[derive(Debug, Clone, Copy)]
struct Box2 {
    middle: [f64; 2],
    half: [f64; 2],
}

impl Box2 {
    /// The area of the overlap of two rectangles.
    fn overlap(&self, other: &Self) -> f64 {
        let sides = self.middle.into_iter().zip(self.half).zip(other.middle.into_iter().zip(other.half));
        let along = sides.map(|((a, p), (b, q))| ((a + p).min(b + q) - (a - p).max(b - q)).max(0.0));
        along.product()
    }

    /// Whether a segment passes through.
    fn is_crossed(&self, segment: [[f64; 2]; 2]) -> bool {
        let [x, y] = self.middle;
        let [across, up] = self.half;
        let [from, to] = segment.map(|at| [0.5 + 0.5 * (at[0] - x) / across, 0.5 + 0.5 * (at[1] - y) / up]);
        clip_segment(from, to).is_some()
    }
}

/// The part of a segment inside the unit square (Liang & Barsky 1984).
pub(super) fn clip_segment(from: [f64; 2], to: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    let step = [to[0] - from[0], to[1] - from[1]];
    for (start, step) in from.into_iter().zip(step) {
        for (direction, room) in [(-step, start), (step, 1.0 - start)] {
            if direction == 0.0 || !direction.is_finite() {
                if room < 0.0 || !direction.is_finite() {
                    return None;
                }
            } else if direction < 0.0 {
                enter = enter.max(room / direction);
            } else {
                leave = leave.min(room / direction);
            }
        }
    }
    let along = |t: f64| [from[0] + t * step[0], from[1] + t * step[1]];
    let a = if enter == 0.0 { from } else { along(enter) };
    let b = if leave == 1.0 { to } else { along(leave) };
    (enter <= leave).then_some([a, b])
}

/// Whether two segments cross.
fn cross([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> bool {
    let turn = |from: [f64; 2], to: [f64; 2], at: [f64; 2]| {
        (to[0] - from[0]) * (at[1] - from[1]) - (to[1] - from[1]) * (at[0] - from[0])
    };
    turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) <= 0.0
}

/// The approximate width of a text in points: at 8 points a letter is about 5.2 wide, a super- or subscript
/// about 3.4.
pub(super) fn width(text: &str) -> f64 {
    let of = |c: char| {
        if "₀₁₂₃₄₅₆₇₈₉ₒᵢⱼ′⁰¹²³⁴⁵⁶⁷⁸⁹⁻.,|il()".contains(c) {
            3.4
        } else {
            5.2
        }
    };
    text.chars().map(of).sum()
}

/// How many points wide and high a text of one line or more is, at 8 points.
pub(super) fn size(text: &str) -> [f64; 2] {
    [text.lines().map(width).fold(0.0, f64::max), LINE * text.lines().count() as f64]
}

/// Points from line to line.
pub(super) const LINE: f64 = 9.2;

/// Distances from its point at which a label may stand.
const RINGS: u8 = 12;
/// What each costs: all of them less than a line that is crossed.
const FAR: f64 = 0.08;

/// Labels of one drawing, each placed where it covers the least.
pub(crate) struct Labels {
    /// points of print per unit
    scale: f64,
    bounds: Box2,
    lines: Vec<[[f64; 2]; 2]>,
    taken: Vec<Box2>,
    in_the_way: f64,
}

impl Labels {
    /// For a drawing from `low` to `high`, a unit of which is printed `scale` points wide.
    pub fn new(low: [f64; 2], high: [f64; 2], scale: f64) -> Self {
        let middle = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
        let bounds = Box2 { middle, half: [high[0] - middle[0], high[1] - middle[1]] };
        Self { scale, bounds, lines: Vec::new(), taken: Vec::new(), in_the_way: 0.0 }
    }

    /// Keeps labels off the lines through these points.
    pub fn avoid(&mut self, points: &[[f64; 2]]) {
        self.lines.extend(points.windows(2).filter_map(|pair| <[[f64; 2]; 2]>::try_from(pair).ok()));
    }

    /// Keeps labels off what is there already, so many points wide and high.
    pub fn keep_off(&mut self, middle: [f64; 2], size: [f64; 2]) {
        self.taken.push(Box2 { middle, half: size.map(|size| 0.5 * size / self.scale) });
    }

    /// The middle of a text beside one of these points, of the first of those where it is least in the way.
    /// None if there are no points.
    pub fn beside(&mut self, points: &[[f64; 2]], text: &str) -> Option<[f64; 2]> {
        let half = size(text).map(|size| 0.5 * size / self.scale);
        let mut best: Option<(f64, f64, Box2)> = None;
        for ring in 0..RINGS {
            for at in points {
                for step in 0..24 {
                    let angle = f64::from(step) * std::f64::consts::TAU / 24.0;
                    let gap = (3.0 + 4.0 * f64::from(ring)) / self.scale;
                    let middle =
                        [at[0] + angle.cos() * (half[0] + gap), at[1] + angle.sin() * (half[1] + gap)];
                    let candidate = Box2 { middle, half };
                    let in_the_way = self.cost(&candidate);
                    if best.is_some_and(|(least, ..)| in_the_way + FAR * f64::from(ring) >= least) {
                        continue;
                    }
                    let cost = in_the_way + FAR * f64::from(ring) + 0.5 * self.between(*at, middle);
                    if best.is_none_or(|(least, ..)| cost < least) {
                        best = Some((cost, in_the_way, candidate));
                    }
                }
            }
            // further away is worse
            if best.is_some_and(|(least, ..)| least <= FAR * f64::from(ring + 1)) {
                break;
            }
        }
        let (_, in_the_way, label) = best?;
        self.taken.push(Box2 { half: label.half.map(|half| half + 0.5 / self.scale), ..label });
        self.in_the_way += in_the_way;
        Some(label.middle)
    }

    /// How bad the placement is so far: the lines that labels cross, and how much they cover of each other.
    /// 0, up to rounding, if nothing is covered.
    pub fn in_the_way(&self) -> f64 {
        self.in_the_way
    }

    /// How many lines are between a point, which may be on one, and the middle of its label.
    fn between(&self, at: [f64; 2], middle: [f64; 2]) -> f64 {
        let way = [middle[0] - at[0], middle[1] - at[1]];
        let off = 0.7 / self.scale / way[0].hypot(way[1]);
        let way = [[at[0] + off * way[0], at[1] + off * way[1]], middle];
        self.lines.iter().filter(|line| cross(**line, way)).count() as f64
    }

    fn cost(&self, label: &Box2) -> f64 {
        let crossed = self.lines.iter().filter(|line| label.is_crossed(**line)).count();
        let covered: f64 = self.taken.iter().map(|taken| taken.overlap(label)).sum();
        let whole = 4.0 * label.half[0] * label.half[1];
        let outside = 1.0 - label.overlap(&self.bounds) / whole;
        crossed as f64 + 20.0 * covered / whole + 100.0 * outside
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_know_whether_they_are_in_the_way() {
        let mut labels = Labels::new([0.0, 0.0], [10.0, 10.0], 10.0);
        labels.beside(&[[5.0, 5.0]], "p");
        assert!(labels.in_the_way() <= 1e-9, "{}", labels.in_the_way()); // but for rounding
        // a grid so fine that no label fits into it
        for i in 0..100 {
            let x = 0.1 * f64::from(i);
            labels.avoid(&[[x, 0.0], [x, 10.0]]);
        }
        labels.beside(&[[5.0, 5.0]], "p");
        assert!(labels.in_the_way() >= 4.0, "{}", labels.in_the_way());
    }

    #[test]
    fn a_label_stands_on_its_own_side_of_a_line() {
        let mut labels = Labels::new([0.0, 0.0], [100.0, 100.0], 1.0);
        labels.avoid(&[[0.0, 52.0], [100.0, 52.0]]);
        labels.avoid(&[[0.0, 50.0], [100.0, 50.0]]);
        let [_, low] = labels.beside(&[[50.0, 50.0]], "lower").unwrap();
        let [_, high] = labels.beside(&[[50.0, 52.0]], "upper").unwrap();
        assert!(low < 50.0 && high > 52.0, "{low}, {high}");
        assert!(labels.in_the_way() <= 1e-9 && labels.beside(&[], "nowhere").is_none());
    }

    #[test]
    fn segments_are_clipped_to_the_unit_square() {
        assert_eq!(clip_segment([0.2, 0.2], [0.8, 0.4]), Some([[0.2, 0.2], [0.8, 0.4]]));
        assert_eq!(clip_segment([-1.0, 0.5], [3.0, 0.5]), Some([[0.0, 0.5], [1.0, 0.5]]));
        assert_eq!(clip_segment([0.5, 0.5], [0.5, 2.5]), Some([[0.5, 0.5], [0.5, 1.0]]));
        assert_eq!(clip_segment([2.0, 0.0], [2.0, 1.0]), None);
        assert_eq!(clip_segment([-1.0, 0.9], [0.5, 2.4]), None);
        assert_eq!(clip_segment([0.5, 0.5], [f64::INFINITY, 0.5]), None);
        assert_eq!(clip_segment([0.5, 0.5], [0.5, f64::NAN]), None);
    }

    #[test]
    fn segments_cross_boxes_or_do_not() {
        let label = Box2 { middle: [1.0, 1.0], half: [0.5, 0.25] };
        for (segment, crossed) in [
            ([[0.0, 1.0], [2.0, 1.0]], true),
            ([[0.0, 0.0], [2.0, 2.0]], true),
            ([[1.0, 1.1], [1.1, 1.0]], true),
            ([[0.0, 1.5], [2.0, 1.5]], false),
            ([[0.0, 1.0], [0.4, 1.0]], false),
            ([[0.0, 0.0], [0.0, 2.0]], false),
            ([[1.0, 0.0], [1.0, 2.0]], true),
        ] {
            assert_eq!(label.is_crossed(segment), crossed, "{segment:?}");
        }
    }
}
