//! The content of a figure before it is drawn: panels with axes, and items on them in data coordinates.

use std::fmt::Write as _;

use super::{Edition, Figure, render, six_digits};
use crate::error::{Error, Result};
use crate::numbers::{in_steps, power_of_ten, typeset};

/// How wide a figure is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Width {
    /// One column, 85 mm.
    Column,
    /// A drawing for the student to draw into, 150 mm.
    Drawing,
    /// The page, 170 mm.
    Page,
}

impl Width {
    pub fn millimetres(self) -> f64 {
        match self {
            Self::Column => 85.0,
            Self::Drawing => 150.0,
            Self::Page => 170.0,
        }
    }
}

/// A colour with a dash pattern that distinguishes it in grey (Okabe & Ito 2008).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ink {
    /// Blue, solid.
    Blue,
    /// Vermilion, dashed.
    Vermilion,
    /// Green, dash-dot.
    Green,
    /// Reddish purple, dotted.
    Purple,
    /// The truth: thin, black, solid.
    Black,
    /// Lines for orientation: thin, grey, solid.
    Grey,
}

/// The shape of a measured point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Marker {
    /// A small disc, for many points.
    Dot,
    Disc,
    Ring,
    Square,
    Triangle,
    Cross,
}

impl Marker {
    /// A sign like it, to be written before what is said of its points.
    pub fn sign(self) -> &'static str {
        match self {
            Self::Dot | Self::Disc => "●",
            Self::Ring => "○",
            Self::Square => "■",
            Self::Triangle => "▲",
            Self::Cross => "×",
        }
    }
}

/// On which side of its point a text is placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    Left,
    Right,
    Above,
    /// Above and to the right of the point.
    UpperRight,
    /// Below and to the right of the point.
    LowerRight,
    Centre,
}

/// An item on a panel, in data coordinates, clipped to the axes.
#[derive(Debug, Clone)]
pub(crate) enum Item {
    Line {
        series: String,
        ink: Ink,
        points: Vec<[f64; 2]>,
    },
    /// x, low and high
    Band {
        series: String,
        ink: Ink,
        points: Vec<[f64; 3]>,
    },
    Marks {
        series: String,
        ink: Ink,
        marker: Marker,
        points: Vec<[f64; 2]>,
    },
    /// x, y, low and high
    ErrorBars {
        series: String,
        ink: Ink,
        marker: Marker,
        points: Vec<[f64; 4]>,
    },
    /// bars from the axis to y, `width` wide in units of x
    Bars {
        series: String,
        ink: Ink,
        width: f64,
        points: Vec<[f64; 2]>,
    },
    /// a legend's marker, for a text beside it
    Key {
        ink: Ink,
        marker: Marker,
        at: [f64; 2],
    },
    /// a region between two values of x
    Shade {
        from: f64,
        to: f64,
    },
    Arrow {
        ink: Ink,
        from: [f64; 2],
        to: [f64; 2],
    },
    Text {
        ink: Ink,
        at: [f64; 2],
        side: Side,
        text: String,
    },
    /// a text of one line or more beside one of these points, wherever there is room
    Label {
        ink: Ink,
        beside: Vec<[f64; 2]>,
        text: String,
    },
}

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
        let visible: Vec<(f64, &str)> = self
            .ticks
            .iter()
            .filter(|(at, _)| (-1e-9..=1.0 + 1e-9).contains(&self.place(*at)))
            .map(|(at, label)| (*at, label.as_str()))
            .collect();
        let zero = visible.iter().position(|(at, _)| *at == 0.0).unwrap_or(0);
        let kept = |every: usize| visible.iter().copied().skip(zero % every).step_by(every);
        let free = |every: &usize| {
            kept(*every).zip(kept(*every).skip(1)).all(|((a, left), (b, right))| {
                (self.place(b) - self.place(a)).abs() * length >= 0.5 * (size(left) + size(right))
            })
        };
        kept((1..=visible.len()).find(free).unwrap_or(1)).collect()
    }

    /// The value at a place from 0, the low end, to 1, the high end.
    pub fn value(&self, place: f64) -> f64 {
        if self.logarithmic {
            self.low * (self.high / self.low).powf(place)
        } else {
            self.low + place * (self.high - self.low)
        }
    }

    /// Replaces the ticks.
    pub fn with_ticks<S: Into<String>>(mut self, ticks: impl IntoIterator<Item = (f64, S)>) -> Self {
        self.ticks = ticks.into_iter().map(|(at, label)| (at, label.into())).collect();
        self
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

/// A pair of axes with the items on them.
#[derive(Debug, Clone)]
pub(crate) struct Panel {
    pub heading: String,
    pub x: Axis,
    pub y: Axis,
    pub items: Vec<Item>,
    /// a drawing, without axes
    pub bare: bool,
}

impl Panel {
    /// Empty axes under a heading.
    pub fn new(heading: &str, x: Axis, y: Axis) -> Self {
        Self { heading: heading.into(), x, y, items: Vec::new(), bare: false }
    }

    /// A curve through `points`.
    pub fn line(&mut self, series: &str, ink: Ink, points: impl IntoIterator<Item = [f64; 2]>) -> &mut Self {
        let points = points.into_iter().collect();
        self.add(Item::Line { series: series.into(), ink, points })
    }

    /// The curve y = f(x) over the whole axis, through 241 evenly spaced points.
    pub fn curve(&mut self, series: &str, ink: Ink, f: impl Fn(f64) -> f64) -> &mut Self {
        let (low, high) = (self.x.low, self.x.high);
        self.curve_between(series, ink, low, high, f)
    }

    /// The curve y = f(x) for x from `low` to `high`.
    pub fn curve_between(
        &mut self,
        series: &str,
        ink: Ink,
        low: f64,
        high: f64,
        f: impl Fn(f64) -> f64,
    ) -> &mut Self {
        let logarithmic = self.x.logarithmic;
        let points = (0..=240).map(|i| {
            let part = f64::from(i) / 240.0;
            let x = if logarithmic { low * (high / low).powf(part) } else { low + part * (high - low) };
            [x, f(x)]
        });
        self.line(series, ink, points.filter(|[_, y]| y.is_finite()).collect::<Vec<_>>())
    }

    /// A horizontal line across the panel.
    pub fn level(&mut self, series: &str, ink: Ink, y: f64) -> &mut Self {
        let ends = [[self.x.low, y], [self.x.high, y]];
        self.line(series, ink, ends)
    }

    /// A vertical line across the panel.
    pub fn upright(&mut self, series: &str, ink: Ink, x: f64) -> &mut Self {
        let ends = [[x, self.y.low], [x, self.y.high]];
        self.line(series, ink, ends)
    }

    /// The region between low and high, given as (x, low, high).
    pub fn band(&mut self, series: &str, ink: Ink, points: impl IntoIterator<Item = [f64; 3]>) -> &mut Self {
        let points = points.into_iter().collect();
        self.add(Item::Band { series: series.into(), ink, points })
    }

    /// Measured points.
    pub fn marks(
        &mut self,
        series: &str,
        ink: Ink,
        marker: Marker,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) -> &mut Self {
        let points = points.into_iter().collect();
        self.add(Item::Marks { series: series.into(), ink, marker, points })
    }

    /// Measured points with their intervals, given as (x, y, low, high).
    pub fn error_bars(
        &mut self,
        series: &str,
        ink: Ink,
        marker: Marker,
        points: impl IntoIterator<Item = [f64; 4]>,
    ) -> &mut Self {
        let points = points.into_iter().collect();
        self.add(Item::ErrorBars { series: series.into(), ink, marker, points })
    }

    /// Bars from the axis up to y, centred on x.
    pub fn bars(
        &mut self,
        series: &str,
        ink: Ink,
        width: f64,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) -> &mut Self {
        let points = points.into_iter().collect();
        self.add(Item::Bars { series: series.into(), ink, width, points })
    }

    /// A shaded region between two values of x.
    pub fn shade(&mut self, from: f64, to: f64) -> &mut Self {
        self.add(Item::Shade { from, to })
    }

    /// An arrow.
    pub fn arrow(&mut self, ink: Ink, from: [f64; 2], to: [f64; 2]) -> &mut Self {
        self.add(Item::Arrow { ink, from, to })
    }

    /// A text beside a point.
    pub fn text(&mut self, ink: Ink, at: [f64; 2], side: Side, text: &str) -> &mut Self {
        self.add(Item::Text { ink, at, side, text: text.into() })
    }

    /// A text beside `at`, where there is room.
    pub fn label(&mut self, ink: Ink, at: [f64; 2], text: &str) -> &mut Self {
        self.add(Item::Label { ink, beside: vec![at], text: text.into() })
    }

    /// Names the line or the marks added last, where there is room beside them.
    pub fn named(&mut self, text: &str) -> &mut Self {
        let (ink, beside) = match self.items.last() {
            Some(Item::Line { ink, points, .. }) => (*ink, self.along(points)),
            Some(Item::Marks { ink, points, .. }) => (*ink, points.clone()),
            _ => return self,
        };
        self.add(Item::Label { ink, beside, text: text.into() })
    }

    /// Points of a line, fiftieths of the axes apart.
    fn along(&self, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let placed: Vec<_> = points.iter().map(|&[x, y]| [self.x.place(x), self.y.place(y)]).collect();
        let mut along = Vec::new();
        for pair in placed.windows(2) {
            let &[from, to] = pair else { continue };
            let step = [to[0] - from[0], to[1] - from[1]];
            let count = (50.0 * step[0].abs().max(step[1].abs())).ceil().clamp(1.0, 1000.0);
            let parts = (0..count as u32).map(|part| f64::from(part) / count);
            along.extend(parts.map(|part| self.spot(from[0] + part * step[0], from[1] + part * step[1])));
        }
        // one a fiftieth will do
        let mut last = [f64::INFINITY; 2];
        along.retain(|&[x, y]| {
            let at = [self.x.place(x), self.y.place(y)];
            let far = (at[0] - last[0]).abs().max((at[1] - last[1]).abs()) >= 0.02;
            if far {
                last = at;
            }
            far
        });
        along
    }

    /// A text beside the point at these fractions of the axes.
    pub fn note(&mut self, ink: Ink, [across, up]: [f64; 2], side: Side, text: &str) -> &mut Self {
        let at = self.spot(across, up);
        self.text(ink, at, side, text)
    }

    /// A legend's marker, for a text beside it.
    pub fn key(&mut self, ink: Ink, marker: Marker, at: [f64; 2]) -> &mut Self {
        self.add(Item::Key { ink, marker, at })
    }

    /// The point at these fractions of the axes.
    pub fn spot(&self, across: f64, up: f64) -> [f64; 2] {
        [self.x.value(across), self.y.value(up)]
    }

    fn add(&mut self, item: Item) -> &mut Self {
        self.items.push(item);
        self
    }
}

/// A whole figure, before it is drawn.
#[derive(Debug, Clone)]
pub(crate) struct Plot {
    /// The question's number and a word: the same in both editions.
    pub name: &'static str,
    /// What it shows, in one line. The student edition's must not tell the answer.
    pub title: String,
    /// The description for readers who cannot see it.
    pub description: String,
    pub edition: Edition,
    pub width: Width,
    pub height_mm: f64,
    /// Panels side by side, in rows of this many.
    pub columns: usize,
    pub panels: Vec<Panel>,
}

impl Plot {
    /// The solution's figure of these panels: a column wide if it is one, else in a row across the page.
    pub fn of(name: &'static str, height_mm: f64, panels: Vec<Panel>) -> Self {
        let width = if panels.len() > 1 { Width::Page } else { Width::Column };
        let (title, description) = (String::new(), String::new());
        let (edition, columns) = (Edition::Solution, panels.len());
        Self { name, title, description, edition, width, height_mm, columns, panels }
    }

    /// The same, with its title and what a reader who cannot see it should know.
    pub fn titled(self, title: impl Into<String>, description: impl Into<String>) -> Self {
        Self { title: title.into(), description: description.into(), ..self }
    }

    /// Draws it.
    pub fn draw(&self) -> Result<Figure> {
        let suffix = match self.edition {
            Edition::Student => "_student",
            Edition::Solution => "",
        };
        let name = format!("{}{suffix}", self.name);
        let axes = self.panels.iter().flat_map(|panel| [&panel.x, &panel.y]);
        if let Some(axis) = axes.into_iter().find(|axis| !axis.can_be_drawn()) {
            let [low, high] = [axis.low, axis.high].map(|end| typeset(end, 3));
            let reason = format!("no axis can be drawn from {low} to {high} ({})", axis.name);
            return Err(Error::Draft { what: name, reason });
        }
        let svg = render::svg(self, &name)?;
        let [title, description] = [&self.title, &self.description].map(String::clone);
        Ok(Figure { svg, csv: self.csv(), title, description, edition: self.edition, name })
    }

    /// All points drawn, one row each; the columns low and high are for bands and error bars. Points that are
    /// NaN are left out. So are coloured curves in the student edition, since their numbers would tell the
    /// answer.
    fn csv(&self) -> String {
        let mut csv = String::from("panel,series,x,y,low,high\n");
        for panel in &self.panels {
            for item in &panel.items {
                let in_colour =
                    matches!(item, Item::Line { ink, .. } if !matches!(ink, Ink::Black | Ink::Grey));
                if in_colour && self.edition == Edition::Student {
                    continue;
                }
                let (series, rows): (_, Vec<[Option<f64>; 4]>) = match item {
                    Item::Line { series, points, .. }
                    | Item::Marks { series, points, .. }
                    | Item::Bars { series, points, .. } => {
                        (series, points.iter().map(|&[x, y]| [Some(x), Some(y), None, None]).collect())
                    }
                    Item::Band { series, points, .. } => (
                        series,
                        points.iter().map(|&[x, low, high]| [Some(x), None, Some(low), Some(high)]).collect(),
                    ),
                    Item::ErrorBars { series, points, .. } => {
                        (series, points.iter().map(|point| point.map(Some)).collect())
                    }
                    Item::Key { .. }
                    | Item::Shade { .. }
                    | Item::Arrow { .. }
                    | Item::Text { .. }
                    | Item::Label { .. } => continue,
                };
                for row in rows.into_iter().filter(|row| !row.iter().flatten().any(|cell| cell.is_nan())) {
                    // writing to a String cannot fail
                    let _ = write!(csv, "{},{}", quoted(&panel.heading), quoted(series));
                    for cell in row {
                        let _ = write!(csv, ",{}", cell.map(six_digits).unwrap_or_default());
                    }
                    csv.push('\n');
                }
            }
        }
        csv
    }
}

/// A CSV field (RFC 4180).
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.into()
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

    #[test]
    fn csv_fields_with_commas_are_quoted() {
        assert_eq!(quoted("a"), "a");
        assert_eq!(quoted("a, \"b\""), "\"a, \"\"b\"\"\"");
    }
}
