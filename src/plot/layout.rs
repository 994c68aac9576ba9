//! A figure before it is drawn: its panels and their numbers.

use std::fmt::Write as _;

use super::panel::{Item, Kind};
use super::{Edition, Ink, Panel};
use crate::numbers::csv_field;

/// A figure before it is drawn.
#[derive(Debug, Clone)]
pub(crate) struct Plot {
    /// The question's number and a word: the same in both editions.
    pub name: &'static str,
    pub edition: Edition,
    pub width_mm: f64,
    pub height_mm: f64,
    /// Panels side by side, in rows of this many.
    pub columns: usize,
    pub panels: Vec<Panel>,
}

impl Plot {
    /// The solution's figure of these panels: a column wide if it is one, else in a row across the page.
    pub fn of(name: &'static str, height_mm: f64, panels: Vec<Panel>) -> Self {
        let width_mm = if panels.len() > 1 { 170.0 } else { 85.0 };
        Self { name, edition: Edition::Solution, width_mm, height_mm, columns: panels.len(), panels }
    }

    /// All points drawn, one row each; the columns low and high are for bands and error bars. Points that are
    /// NaN are left out. So are coloured curves in the student edition, since their numbers would tell the
    /// answer.
    pub(super) fn csv(&self) -> String {
        let mut csv = String::from("panel,series,x,y,low,high\n");
        let items = self.panels.iter().flat_map(|panel| panel.items.iter().map(move |item| (panel, item)));
        for (panel, item) in items {
            let Item::Series { name, ink, kind, points } = item else { continue };
            let answer = *kind == Kind::Line && !matches!(ink, Ink::Black | Ink::Grey);
            if name.is_empty() || (answer && self.edition == Edition::Student) {
                continue;
            }
            let [panel, series] = [&panel.heading, name].map(|name| csv_field(name));
            let is_drawn = |[x, y, low, high]: &&[f64; 4]| {
                !x.is_nan() && !(y.is_nan() && (low.is_nan() || high.is_nan()))
            };
            for point in points.iter().filter(is_drawn) {
                let cells = point.map(|cell| if cell.is_nan() { String::new() } else { six_digits(cell) });
                // writing to a String cannot fail
                let _ = writeln!(csv, "{panel},{series},{}", cells.join(","));
            }
        }
        csv
    }
}

/// Six significant digits, so that different last digits of ln and sin on other machines do not show.
fn six_digits(x: f64) -> String {
    // `{:e}` rounds to significant digits
    let text = format!("{x:.5e}");
    let plain = x == 0.0 || (-4.0..15.0).contains(&x.abs().log10());
    if plain { text.parse().map_or(text, |rounded: f64| rounded.to_string()) } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_six_digits() {
        for (x, shown) in [
            (0.0, "0"),
            (1.0, "1"),
            (-0.25, "-0.25"),
            (1.386_294_361_119_890_6, "1.38629"),
            (123_456_789.0, "123457000"),
            (0.000_123_456_789, "0.000123457"),
            (1.234_567_89e-9, "1.23457e-9"),
            (9.999_999_9e20, "1.00000e21"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(six_digits(x), shown);
        }
    }
}
