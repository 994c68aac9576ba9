//! What a figure shows, before it is drawn: panels with axes, and things on them in the data's own units.

use std::fmt::Write as _;

use super::{Edition, Figure, render, six_digits};
use crate::error::Result;

/// How wide a figure is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Width {
    /// One column, 85 mm.
    Column,
    /// The page, 170 mm.
    Page,
}

impl Width {
    pub fn millimetres(self) -> f64 {
        match self {
            Self::Column => 85.0,
            Self::Page => 170.0,
        }
    }
}

/// A colour with the dash that tells it apart in grey (Okabe & Ito 2008).
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
    /// What is only there for orientation: thin, grey, solid.
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

/// On which side of its point a text stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    Left,
    Right,
    Above,
    Centre,
}

/// One thing on a panel. Coordinates are data; what leaves the axes is clipped.
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
    /// a row of a matrix: cells one unit wide and high about (x, `row`), given as x, value and its shade from −1 to 1
    Cells {
        series: String,
        row: f64,
        points: Vec<[f64; 3]>,
        texts: Vec<String>,
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
}

/// One axis: its range, name with unit, ticks, and whether it is logarithmic.
#[derive(Debug, Clone)]
pub(crate) struct Axis {
    pub name: String,
    pub low: f64,
    pub high: f64,
    pub logarithmic: bool,
    /// where the ticks are, and what they say
    pub ticks: Vec<(f64, String)>,
}

impl Axis {
    /// From `low` to `high`, with about six round ticks.
    pub fn linear(name: &str, low: f64, high: f64) -> Self {
        let step = round_step((high - low) / 5.0);
        let places = (-step.log10().floor()).max(0.0) as usize;
        let (first, last) = ((low / step - 1e-9).ceil() as i64, (high / step + 1e-9).floor() as i64);
        let ticks = (first..=last).map(|i| {
            let at = i as f64 * step;
            (at, format!("{at:.places$}").replace('-', "−"))
        });
        Self { name: name.into(), low, high, logarithmic: false, ticks: ticks.collect() }
    }

    /// From `low` to `high` > 0, logarithmic, with ticks at powers of ten.
    pub fn log(name: &str, low: f64, high: f64) -> Self {
        let (first, last) = ((low.log10() - 1e-9).ceil() as i32, (high.log10() + 1e-9).floor() as i32);
        let every = ((last - first) / 6).max(1);
        let ticks = (first..=last)
            .filter(|power| (power - first) % every == 0)
            .map(|power| (10f64.powi(power), power_of_ten(power)));
        Self { name: name.into(), low, high, logarithmic: true, ticks: ticks.collect() }
    }

    /// With these ticks instead.
    pub fn with_ticks<S: Into<String>>(mut self, ticks: impl IntoIterator<Item = (f64, S)>) -> Self {
        self.ticks = ticks.into_iter().map(|(at, label)| (at, label.into())).collect();
        self
    }

    /// Where a value stands on the axis, 0 at the low end and 1 at the high one.
    pub fn place(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value.ln() - self.low.ln()) / (self.high.ln() - self.low.ln())
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }
}

/// The largest of 1, 2, 5 · 10^k that is not above `rough` by more than a half.
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

/// 10ⁿ
pub(crate) fn power_of_ten(power: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match power {
        0 => "1".into(),
        1 => "10".into(),
        _ => {
            let sign = if power < 0 { "⁻" } else { "" };
            let digits = power.unsigned_abs().to_string();
            let raised = digits.bytes().filter_map(|digit| DIGITS.get(usize::from(digit - b'0')));
            format!("10{sign}{}", raised.collect::<String>())
        }
    }
}

/// One pair of axes with what is drawn on them.
#[derive(Debug, Clone)]
pub(crate) struct Panel {
    pub heading: String,
    pub x: Axis,
    pub y: Axis,
    pub items: Vec<Item>,
}

impl Panel {
    /// Empty axes under a heading.
    pub fn new(heading: &str, x: Axis, y: Axis) -> Self {
        Self { heading: heading.into(), x, y, items: Vec::new() }
    }

    /// A curve through `points`.
    pub fn line(&mut self, series: &str, ink: Ink, points: impl IntoIterator<Item = [f64; 2]>) -> &mut Self {
        let points = points.into_iter().collect();
        self.add(Item::Line { series: series.into(), ink, points })
    }

    /// The curve y = f(x) over the whole axis, in 241 points evenly apart on it.
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

    /// A row of a matrix: cells one unit wide and high about (x, `row`), given as (x, value, shade) and the text on each. A shade of −1 is
    /// blue, 0 white, 1 vermilion.
    pub fn cells(
        &mut self,
        series: &str,
        row: f64,
        cells: impl IntoIterator<Item = ([f64; 3], String)>,
    ) -> &mut Self {
        let (points, texts) = cells.into_iter().unzip();
        self.add(Item::Cells { series: series.into(), row, points, texts })
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
    /// What it shows, in a line. The student's must not tell the answer.
    pub title: String,
    /// What a reader who cannot see it should know.
    pub description: String,
    pub edition: Edition,
    pub width: Width,
    pub height_mm: f64,
    /// Panels side by side, in rows of this many.
    pub columns: usize,
    pub panels: Vec<Panel>,
}

impl Plot {
    /// Draws it.
    pub fn draw(&self) -> Result<Figure> {
        let suffix = match self.edition {
            Edition::Student => "_student",
            Edition::Solution => "",
        };
        let name = format!("{}{suffix}", self.name);
        let svg = render::svg(self, &name)?;
        Ok(Figure { svg, csv: self.csv(), title: self.title.clone(), edition: self.edition, name })
    }

    /// All points drawn, a row each; the columns low and high are those of bands and error bars.
    fn csv(&self) -> String {
        let mut csv = String::from("panel,series,x,y,low,high\n");
        for panel in &self.panels {
            for item in &panel.items {
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
                    Item::Cells { series, points, .. } => (
                        series,
                        points.iter().map(|&[x, value, _]| [Some(x), Some(value), None, None]).collect(),
                    ),
                    Item::Shade { .. } | Item::Arrow { .. } | Item::Text { .. } => continue,
                };
                for row in rows {
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
        assert_eq!(power_of_ten(-18), "10⁻¹⁸");
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
