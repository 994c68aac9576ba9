//! A figure on a slide: as it is, as large as fits below its title.

use super::labels::width;
use super::{Figure, document};

/// 13.33 × 7.5 inches in CSS pixels.
const SIZE: [f64; 2] = [1280.0, 720.0];
const MARGIN: f64 = 24.0;
/// The sizes of the title's type in pixels; the largest that fits is taken.
const TYPE: std::ops::RangeInclusive<u8> = 16..=28;
const LINES: usize = 3;

impl Figure {
    /// The same on a slide of 16 to 9, below its title in large type: `name_slide`. It has no CSV.
    pub fn slide(&self) -> Self {
        let name = format!("{}_slide", self.name);
        Self { svg: svg(self, &name), csv: String::new(), name, ..self.clone() }
    }
}

fn svg(figure: &Figure, name: &str) -> String {
    let folded = |size: u8| (size, fold(&figure.title, SIZE[0] - 2.0 * MARGIN, f64::from(size)));
    let fits = TYPE.rev().map(folded).find(|(_, lines)| lines.len() <= LINES);
    let (size, lines) = fits.unwrap_or_else(|| folded(*TYPE.start()));
    let line = 1.25 * f64::from(size);
    let mut body = String::new();
    for (row, text) in lines.iter().enumerate() {
        body += &document::title_line(0.5 * SIZE[0], 0.5 * MARGIN + (row as f64 + 0.8) * line, size, text);
    }
    let top = 0.75 * MARGIN + line * lines.len() as f64;
    let (root, drawn) = figure.svg.split_once("</desc>\n").unwrap_or_default();
    let view = root.split_once("viewBox=\"").and_then(|(_, rest)| rest.split_once('"'));
    // its own size gives way to the room that there is
    body += &format!(
        "\n<svg x=\"{MARGIN}\" y=\"{top}\" width=\"{}\" height=\"{}\" viewBox=\"{}\">\n{drawn}",
        SIZE[0] - 2.0 * MARGIN,
        SIZE[1] - top - 0.5 * MARGIN,
        view.map_or("", |(view, _)| view),
    );
    let millimetres = SIZE.map(|pixels| (pixels * 254.0 / 96.0).round() / 10.0);
    document::document(name, millimetres, SIZE, [&figure.title, &figure.description], &body)
}

/// Lines no wider than `most`, broken at spaces, in type of this size.
fn fold(text: &str, most: f64, size: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(&format!("{line} {word}")) * size / 8.0 <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.into()),
        }
    }
    lines
}
