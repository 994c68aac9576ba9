//! Axes: their ranges, ticks and names.

use crate::numbers::{in_steps, power_of_ten, typeset};

/// One axis: its range, name with unit, ticks, and whether it is logarithmic.
#[derive(Debug, Clone)]
pub(crate) struct Axis {
    pub name: String,
    pub low: f64,
    pub high: f64,
    pub logarithmic: bool,
    /// the ticks' places and labels
    pub ticks: Vec<(f64, String)>,
}

impl Axis {
    /// From `low` to `high`, with about six round ticks. For very small or large numbers the ticks are
    /// multiples of a power of ten that is given in the name.
    pub fn linear(name: &str, low: f64, high: f64) -> Self {
        let size = low.abs().max(high.abs());
        let power = if (0.01..1e4).contains(&size) || !size.is_normal() { 0.0 } else { size.log10().floor() };
        let (unit, step) = (10f64.powf(power), round_step((high - low) / 5.0));
        let steps = if step.is_normal() && size / step < 1e14 {
            (low / step - 1e-9).ceil() as i64..=(high / step + 1e-9).floor() as i64
        } else {
            // `Plot::draw` reports an axis that cannot be drawn
            std::ops::RangeInclusive::new(1, 0)
        };
        let ticks = steps.map(|i| (i as f64 * step, in_steps(i as f64 * step / unit, step / unit))).collect();
        let name = if power == 0.0 { name.into() } else { in_units(name, &power_of_ten(power as i32)) };
        Self { name, low, high, logarithmic: false, ticks }
    }

    /// From `low` to `high` > 0, logarithmic, with ticks at powers of ten, or at 1, 2 and 5 times them if
    /// there would be fewer than two.
    pub fn log(name: &str, low: f64, high: f64) -> Self {
        let (from, to) = (low.log10() - 1e-9, high.log10() + 1e-9);
        // `Plot::draw` reports an axis that cannot be drawn
        let (first, last) =
            if (to - from).is_finite() { (from.ceil() as i32, to.floor() as i32) } else { (1, 0) };
        let every = ((last - first) / 6).max(1);
        let power = |power| (10f64.powi(power), power_of_ten(power));
        let ticks = if last > first {
            (first..=last).filter(|power| (power - first) % every == 0).map(power).collect()
        } else {
            let digits = (first - 1..=last).flat_map(|power| [1.0, 2.0, 5.0].map(|d| d * 10f64.powi(power)));
            digits.filter(|at| (low..=high).contains(at)).map(|at| (at, typeset(at, 1))).collect()
        };
        Self { name: name.into(), low, high, logarithmic: true, ticks }
    }

    /// Replaces the ticks.
    pub fn with_ticks<S: Into<String>>(self, ticks: impl IntoIterator<Item = (f64, S)>) -> Self {
        Self { ticks: ticks.into_iter().map(|(at, label)| (at, label.into())).collect(), ..self }
    }

    /// Whether the axis can be drawn: its ends are distinguishable and neither too small nor too large.
    pub fn can_be_drawn(&self) -> bool {
        let sizes = 1e-300..1e300;
        let whole = self.low.is_finite() && self.high.is_finite() && self.low < self.high;
        let from = if self.logarithmic { self.low } else { self.high - self.low };
        let apart = self.logarithmic || from > 1e-12 * self.low.abs().max(self.high.abs());
        whole && apart && sizes.contains(&from) && sizes.contains(&self.high.abs().max(self.low.abs()))
    }

    /// The ticks whose labels, of these sizes, do not touch on an axis of this length: all of them, or every
    /// second, and so on, always including 0 if that is one of them.
    pub fn legible(&self, length: f64, size: impl Fn(&str) -> f64) -> Vec<(f64, &str)> {
        let ticks = self.ticks.iter().map(|(at, label)| (*at, label.as_str()));
        let visible: Vec<_> = ticks.filter(|(at, _)| self.holds(*at)).collect();
        let zero = visible.iter().position(|(at, _)| *at == 0.0).unwrap_or(0);
        let kept = |every: usize| visible.iter().copied().skip(zero % every).step_by(every);
        let free = |every: &usize| {
            kept(*every).zip(kept(*every).skip(1)).all(|((a, left), (b, right))| {
                (self.place(b) - self.place(a)).abs() * length >= 0.5 * (size(left) + size(right))
            })
        };
        kept((1..=visible.len()).find(free).unwrap_or(1)).collect()
    }

    /// About how many points wide the widest label is.
    pub fn label_width(&self) -> f64 {
        let letters = self.ticks.iter().map(|(_, label)| label.chars().count()).max().unwrap_or(0) as f64;
        // a few characters may all be wide, many are not
        5.4 * letters.min(8.0) + 4.4 * (letters - 8.0).max(0.0)
    }

    /// The value at a place from 0, the low end, to 1, the high end.
    pub fn value(&self, place: f64) -> f64 {
        self.between(self.low, self.high, place)
    }

    /// The value at a place from 0, which is at `low`, to 1, at `high`.
    pub fn between(&self, low: f64, high: f64, place: f64) -> f64 {
        if self.logarithmic { low * (high / low).powf(place) } else { low + place * (high - low) }
    }

    /// Whether a value is on the axis, up to rounding.
    pub fn holds(&self, value: f64) -> bool {
        (-1e-9..=1.0 + 1e-9).contains(&self.place(value))
    }

    /// The place of a value on the axis: 0 at the low end and 1 at the high end.
    pub fn place(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value.ln() - self.low.ln()) / (self.high.ln() - self.low.ln())
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }
}

/// The least and the largest of the values that a logarithmic axis can show, if there are any.
pub(crate) fn extent(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    let shown = values.into_iter().filter(|value| *value > 0.0 && value.is_finite());
    shown.map(|value| [value, value]).reduce(|[low, high], [a, b]| [low.min(a), high.max(b)])
}

/// The number of the form 1, 2 or 5 · 10^k that is nearest to `rough`.
fn round_step(rough: f64) -> f64 {
    let power = 10f64.powf(rough.log10().floor());
    let factor = match rough / power {
        r if r < 1.5 => 1.0,
        r if r < 3.5 => 2.0,
        r if r < 7.5 => 5.0,
        _ => 10.0,
    };
    factor * power
}

/// Adds a factor to the unit in an axis's name.
fn in_units(name: &str, factor: &str) -> String {
    if let Some(name) = name.strip_suffix(" (dimensionless)") {
        format!("{name} ({factor})")
    } else if let Some((quantity, unit)) = name.strip_suffix(')').and_then(|name| name.rsplit_once(" (")) {
        format!("{quantity} ({factor} {unit})")
    } else {
        format!("{name} ({factor})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let labels = |axis: Axis| axis.ticks.into_iter().map(|(_, label)| label).collect::<Vec<_>>();
        assert_eq!(labels(Axis::linear("x", 0.0, 5.0)), ["0", "1", "2", "3", "4", "5"]);
        assert_eq!(labels(Axis::linear("x", -1.0, 1.05)), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(labels(Axis::linear("x", 0.0, 40.0)), ["0", "10", "20", "30", "40"]);
        assert_eq!(labels(Axis::log("x", 1.0, 1e4)), ["1", "10", "10²", "10³", "10⁴"]);
        assert_eq!(labels(Axis::log("x", 0.002, 50.0)), ["10⁻²", "10⁻¹", "1", "10"]);
        assert_eq!(labels(Axis::log("x", 0.3, 7.0)), ["0.5", "1", "2", "5"]);
        assert_eq!(labels(Axis::linear("x", 0.0, 5e-4)), ["0", "1", "2", "3", "4", "5"]);
        assert_eq!(Axis::linear("x (dimensionless)", 0.0, 5e-4).name, "x (10⁻⁴)");
        assert_eq!(Axis::linear("L (W m⁻² sr⁻¹)", 0.0, 2e9).name, "L (10⁹ W m⁻² sr⁻¹)");
        assert_eq!(Axis::linear("p(x)", 0.0, 2e9).name, "p(x) (10⁹)");
    }

    #[test]
    fn places_run_from_0_to_1() {
        let linear = Axis::linear("x", -2.0, 2.0);
        assert_eq!([linear.place(-2.0), linear.place(0.0), linear.place(2.0)], [0.0, 0.5, 1.0]);
        let log = Axis::log("x", 1.0, 100.0);
        assert!((log.place(10.0) - 0.5).abs() < 1e-15);
    }
}
