//! Draws a [`Plot`] with plotters. Its coordinates are integers, so units are a tenth of a pixel; otherwise
//! curves would look like staircases.

use std::sync::Once;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontFamily, register_font};

use super::labels::{LINE, Labels, size, width};
use super::panel::{Ink, Item, Marker, Panel, Plot, Side};
use crate::error::{Error, Result};

/// Units per millimetre: ten per CSS pixel of 1/96 inch.
const MM: f64 = 960.0 / 25.4;
/// Units per typographic point.
const PT: f64 = 960.0 / 72.0;

const INK: RGBColor = RGBColor(0x22, 0x22, 0x22);
const GREY: RGBColor = RGBColor(0x88, 0x88, 0x88);
const FAINT: RGBColor = RGBColor(0xdd, 0xdd, 0xdd);

/// plotters has no dashes: lines get one of these opacities, which `finish` replaces by the dash pattern.
const DASHES: [(f64, &str); 3] = [(0.991, "75 30"), (0.992, "90 30 15 30"), (0.993, "15 25")];

/// Fonts that have all characters used, in order of preference.
const FONTS: &str = "font-family=\"DejaVu Sans, Noto Sans, Noto Sans Math, STIX Two Math, sans-serif\"";

/// The white outline of texts.
const EDGE: &str = " stroke=\"#FFFFFF\" stroke-width=\"24\" paint-order=\"stroke\"";

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

pub(super) fn svg(plot: &Plot, name: &str) -> Result<String> {
    register_fonts();
    let size = ((plot.width.millimetres() * MM) as u32, (plot.height_mm * MM) as u32);
    let mut svg = String::new();
    draw(plot, &mut svg, size).map_err(|reason| Error::Draft { what: name.into(), reason })?;
    Ok(finish(plot, name, &svg))
}

/// plotters needs a font's metrics even for SVG; this one has all Greek letters and symbols needed.
fn register_fonts() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // if a font cannot be parsed, the first text drawn gives an error
        let _ = register_font("sans-serif", FontStyle::Normal, dejavu::sans::regular());
        let _ = register_font("sans-serif", FontStyle::Bold, dejavu::sans::bold());
    });
}

fn draw(plot: &Plot, svg: &mut String, size: (u32, u32)) -> Result<(), String> {
    let root = SVGBackend::with_string(svg, size).into_drawing_area();
    let columns = plot.columns.max(1);
    let areas = root.split_evenly((plot.panels.len().div_ceil(columns), columns));
    for (panel, area) in plot.panels.iter().zip(&areas) {
        draw_panel(panel, area).map_err(|error| error.to_string())?;
    }
    root.present().map_err(|error| error.to_string())
}

type Drawn = std::result::Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// Where the axes of a panel are, in units.
struct Frame<'p> {
    panel: &'p Panel,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Frame<'_> {
    fn at(&self, [x, y]: [f64; 2]) -> (i32, i32) {
        let (x, y) = (self.panel.x.place(x), self.panel.y.place(y));
        (
            (self.left + x * (self.right - self.left)).round() as i32,
            (self.bottom - y * (self.bottom - self.top)).round() as i32,
        )
    }

    fn holds(&self, [x, y]: [f64; 2]) -> bool {
        let inside = |place: f64| (-1e-9..=1.0 + 1e-9).contains(&place);
        inside(self.panel.x.place(x)) && inside(self.panel.y.place(y))
    }

    /// Whether a text there would be on the axes or just beside them.
    fn is_near(&self, [x, y]: [f64; 2]) -> bool {
        let near = |place: f64| (-0.25..=1.25).contains(&place);
        near(self.panel.x.place(x)) && near(self.panel.y.place(y))
    }

    /// The parts of a curve inside the axes, in units.
    fn clip(&self, points: &[[f64; 2]]) -> Vec<Vec<(i32, i32)>> {
        let (x_axis, y_axis) = (&self.panel.x, &self.panel.y);
        let placed = points.iter().map(|&[x, y]| [x_axis.place(x), y_axis.place(y)]).collect::<Vec<_>>();
        let lattice = |[x, y]: [f64; 2]| {
            (
                (self.left + x * (self.right - self.left)).round() as i32,
                (self.bottom - y * (self.bottom - self.top)).round() as i32,
            )
        };
        let mut runs: Vec<Vec<(i32, i32)>> = Vec::new();
        let mut end = None;
        for pair in placed.windows(2) {
            let &[from, to] = pair else { continue };
            let Some([a, b]) = clip_segment(from, to) else {
                end = None;
                continue;
            };
            match runs.last_mut() {
                Some(run) if end == Some(a) => run.push(lattice(b)),
                _ => runs.push(vec![lattice(a), lattice(b)]),
            }
            end = Some(b);
        }
        runs
    }
}

/// The part of a segment inside the unit square (Liang & Barsky 1984).
fn clip_segment(from: [f64; 2], to: [f64; 2]) -> Option<[[f64; 2]; 2]> {
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

fn draw_panel(panel: &Panel, area: &Area<'_>) -> Drawn {
    let (across, down) = area.dim_in_pixel();
    let widest = panel.y.ticks.iter().map(|(_, label)| label.chars().count()).max().unwrap_or(0) as f64;
    // a few characters may all be wide, many are not
    let beside = if panel.bare { 2.0 } else { 20.0 + 5.4 * widest.min(8.0) + 4.4 * (widest - 8.0).max(0.0) };
    let frame = Frame {
        panel,
        left: beside * PT,
        right: f64::from(across) - if panel.bare { 2.0 } else { 11.0 } * PT,
        top: 20.0 * PT,
        bottom: f64::from(down) - if panel.bare { 2.0 } else { 30.0 } * PT,
    };
    for item in &panel.items {
        if let Item::Shade { from, to } = *item {
            let corners = [frame.at([from, panel.y.low]), frame.at([to, panel.y.high])];
            area.draw(&Rectangle::new(corners, FAINT.filled()))?;
        }
    }
    draw_axes(&frame, area)?;
    for item in &panel.items {
        draw_item(item, &frame, area)?;
    }
    draw_labels(&frame, area)
}

/// The labels, where they are least in the way of all else.
fn draw_labels(frame: &Frame<'_>, area: &Area<'_>) -> Drawn {
    let real = |(x, y): (i32, i32)| [f64::from(x), f64::from(y)];
    let at = |point: &[f64; 2]| real(frame.at(*point));
    let mut labels = Labels::new([frame.left, frame.top], [frame.right, frame.bottom], 1.0 / PT);
    let marker = [6.0; 2];
    for item in &frame.panel.items {
        match item {
            Item::Line { points, .. } => {
                for run in frame.clip(points) {
                    labels.avoid(&run.into_iter().map(real).collect::<Vec<_>>());
                }
            }
            Item::Marks { points, .. } => {
                points
                    .iter()
                    .filter(|point| frame.holds(**point))
                    .for_each(|p| labels.keep_off(at(p), marker));
            }
            Item::ErrorBars { points, .. } => {
                for &[x, y, low, high] in points.iter().filter(|[x, y, ..]| frame.holds([*x, *y])) {
                    labels.keep_off(at(&[x, y]), marker);
                    labels.avoid(&[at(&[x, low]), at(&[x, high])]);
                }
            }
            Item::Key { at: key, .. } => labels.keep_off(at(key), marker),
            Item::Arrow { from, to, .. } => labels.avoid(&[at(from), at(to)]),
            Item::Text { at, side, text, .. } if frame.is_near(*at) => {
                let (start, horizontal, vertical) = stands(frame.at(*at), *side);
                let ([x, y], [across, up]) = (real(start), size(text));
                let x = x + match horizontal {
                    HPos::Left => 0.5,
                    HPos::Center => 0.0,
                    HPos::Right => -0.5,
                } * across
                    * PT;
                let y = y + match vertical {
                    VPos::Top => 0.5,
                    VPos::Center => 0.0,
                    VPos::Bottom => -0.5,
                } * up
                    * PT;
                labels.keep_off([x, y], [across, up]);
            }
            Item::Shade { from, to } => {
                let ends = [frame.panel.y.low, frame.panel.y.high];
                [from, to].into_iter().for_each(|x| labels.avoid(&ends.map(|y| at(&[*x, y]))));
            }
            // what fills an area may lie under a label
            Item::Band { .. } | Item::Bars { .. } => {}
            Item::Text { .. } | Item::Label { .. } => {}
        }
    }
    let mut all: Vec<_> = frame
        .panel
        .items
        .iter()
        .filter_map(|item| match item {
            Item::Label { ink, beside, text } => Some((ink, beside, text)),
            _ => None,
        })
        .collect();
    // those with the fewest places to choose from first
    all.sort_by_key(|(_, beside, _)| beside.len());
    for (ink, beside, text) in all {
        let points: Vec<_> = beside.iter().filter(|point| frame.holds(**point)).map(at).collect();
        let Some([x, y]) = labels.beside(&points, text) else { continue };
        let last = 0.5 * (text.lines().count() as f64 - 1.0);
        for (row, line) in text.lines().enumerate() {
            let middle = (x.round() as i32, (y + (row as f64 - last) * LINE * PT).round() as i32);
            let style = font(8.0, &dark(*ink), HPos::Center, VPos::Center);
            area.draw(&Text::new(line.to_owned(), middle, style))?;
        }
    }
    Ok(())
}

fn draw_axes(frame: &Frame<'_>, area: &Area<'_>) -> Drawn {
    let Panel { heading, x, y, .. } = frame.panel;
    let thin = INK.stroke_width((0.5 * PT) as u32);
    let tick = 3.0 * PT;
    let corner = |x: f64, y: f64| (x.round() as i32, y.round() as i32);
    let above = corner(frame.left, 4.0 * PT);
    area.draw(&Text::new(heading.clone(), above, bold(9.0, &INK)))?;
    if frame.panel.bare {
        return Ok(());
    }
    area.draw(&PathElement::new(
        vec![
            corner(frame.left, frame.top),
            corner(frame.left, frame.bottom),
            corner(frame.right, frame.bottom),
        ],
        thin,
    ))?;
    let [across, up] = [frame.right - frame.left, frame.bottom - frame.top].map(|length| length / PT);
    for (at, label) in x.legible(across, |label| width(label) + 5.0) {
        let (column, row) = frame.at([at, y.low]);
        area.draw(&PathElement::new(vec![(column, row), (column, row + tick as i32)], thin))?;
        let below = row + (1.6 * tick) as i32;
        area.draw(&Text::new(label.to_string(), (column, below), font(8.0, &INK, HPos::Center, VPos::Top)))?;
    }
    for (at, label) in y.legible(up, |_| 10.0) {
        let (column, row) = frame.at([x.low, at]);
        area.draw(&PathElement::new(vec![(column - tick as i32, row), (column, row)], thin))?;
        let beside = column - (1.7 * tick) as i32;
        area.draw(&Text::new(label.to_string(), (beside, row), font(8.0, &INK, HPos::Right, VPos::Center)))?;
    }
    let middle = corner(0.5 * (frame.left + frame.right), frame.bottom + 17.0 * PT);
    area.draw(&Text::new(x.name.clone(), middle, font(8.5, &INK, HPos::Center, VPos::Top)))?;
    let beside = corner(1.0 * PT, 0.5 * (frame.top + frame.bottom));
    let upright = font(8.5, &INK, HPos::Center, VPos::Top).transform(FontTransform::Rotate270);
    area.draw(&Text::new(y.name.clone(), beside, upright))
}

fn draw_item(item: &Item, frame: &Frame<'_>, area: &Area<'_>) -> Drawn {
    match item {
        Item::Line { ink, points, .. } => {
            for run in frame.clip(points) {
                area.draw(&PathElement::new(run, stroke(*ink)))?;
            }
        }
        Item::Band { ink, points, .. } => {
            let clamp = |y: f64| y.clamp(frame.panel.y.low, frame.panel.y.high);
            let inside = points.iter().filter(|[x, ..]| frame.holds([*x, frame.panel.y.low]));
            let (mut low, mut high) = (Vec::new(), Vec::new());
            for &[x, from, to] in inside {
                low.push(frame.at([x, clamp(from)]));
                high.push(frame.at([x, clamp(to)]));
            }
            high.reverse();
            low.append(&mut high);
            area.draw(&Polygon::new(low, colour(*ink).mix(0.25)))?;
        }
        Item::Marks { ink, marker, points, .. } => {
            for &point in points.iter().filter(|&&point| frame.holds(point)) {
                draw_marker(frame.at(point), *ink, *marker, area)?;
            }
        }
        Item::ErrorBars { ink, marker, points, .. } => {
            for &[x, y, low, high] in points.iter().filter(|[x, y, ..]| frame.holds([*x, *y])) {
                for run in frame.clip(&[[x, low], [x, high]]) {
                    area.draw(&PathElement::new(run, colour(*ink).stroke_width((0.8 * PT) as u32)))?;
                }
                draw_marker(frame.at([x, y]), *ink, *marker, area)?;
            }
        }
        Item::Bars { ink, width, points, .. } => {
            for &[x, y] in points {
                let corners = [
                    frame.at([x - 0.5 * width, frame.panel.y.low]),
                    frame.at([x + 0.5 * width, y.clamp(frame.panel.y.low, frame.panel.y.high)]),
                ];
                area.draw(&Rectangle::new(corners, colour(*ink).mix(0.45).filled()))?;
            }
        }
        Item::Key { ink, marker, at } if frame.is_near(*at) => {
            draw_marker(frame.at(*at), *ink, *marker, area)?;
        }
        Item::Arrow { ink, from, to } if frame.is_near(*from) && frame.is_near(*to) => {
            draw_arrow(frame.at(*from), frame.at(*to), *ink, area)?;
        }
        Item::Text { ink, at, side, text } if frame.is_near(*at) => {
            let (at, horizontal, vertical) = stands(frame.at(*at), *side);
            area.draw(&Text::new(text.clone(), at, font(8.0, &dark(*ink), horizontal, vertical)))?;
        }
        // a shade lies under the axes, labels above all else; and what belongs far outside is not drawn
        Item::Shade { .. }
        | Item::Label { .. }
        | Item::Key { .. }
        | Item::Arrow { .. }
        | Item::Text { .. } => {}
    }
    Ok(())
}

/// Where a text on this side of a point begins, ends or has its middle.
fn stands((x, y): (i32, i32), side: Side) -> ((i32, i32), HPos, VPos) {
    let gap = (4.0 * PT) as i32;
    match side {
        Side::Left => ((x - gap, y), HPos::Right, VPos::Center),
        Side::Right => ((x + gap, y), HPos::Left, VPos::Center),
        Side::Above => ((x, y - gap), HPos::Center, VPos::Bottom),
        Side::UpperRight => ((x + gap, y - gap / 2), HPos::Left, VPos::Bottom),
        Side::LowerRight => ((x + gap, y + gap / 2), HPos::Left, VPos::Top),
        Side::Centre => ((x, y), HPos::Center, VPos::Center),
    }
}

fn draw_marker((x, y): (i32, i32), ink: Ink, marker: Marker, area: &Area<'_>) -> Drawn {
    let colour = colour(ink);
    let radius = (2.2 * PT) as i32;
    let line = colour.stroke_width((0.9 * PT) as u32);
    match marker {
        Marker::Dot => area.draw(&Circle::new((x, y), radius / 2, colour.filled())),
        Marker::Disc => area.draw(&Circle::new((x, y), radius, colour.filled())),
        Marker::Ring => area.draw(&Circle::new((x, y), radius, line)),
        Marker::Square => {
            area.draw(&Rectangle::new([(x - radius, y - radius), (x + radius, y + radius)], colour.filled()))
        }
        Marker::Triangle => {
            let corners =
                vec![(x, y - radius - radius / 3), (x + radius, y + radius), (x - radius, y + radius)];
            area.draw(&Polygon::new(corners, colour))
        }
        Marker::Cross => {
            area.draw(&PathElement::new(vec![(x - radius, y - radius), (x + radius, y + radius)], line))?;
            area.draw(&PathElement::new(vec![(x - radius, y + radius), (x + radius, y - radius)], line))
        }
    }
}

fn draw_arrow(from: (i32, i32), to: (i32, i32), ink: Ink, area: &Area<'_>) -> Drawn {
    let (dx, dy) = (f64::from(to.0 - from.0), f64::from(to.1 - from.1));
    let length = dx.hypot(dy).max(1.0);
    let (ux, uy) = (dx / length, dy / length);
    let corner = |back: f64, aside: f64| {
        let x = f64::from(to.0) - back * ux - aside * uy;
        let y = f64::from(to.1) - back * uy + aside * ux;
        (x.round() as i32, y.round() as i32)
    };
    area.draw(&PathElement::new(vec![from, corner(4.0 * PT, 0.0)], stroke(ink)))?;
    let head = vec![to, corner(6.0 * PT, 2.4 * PT), corner(6.0 * PT, -2.4 * PT)];
    area.draw(&Polygon::new(head, colour(ink)))
}

fn colour(ink: Ink) -> RGBColor {
    match ink {
        Ink::Blue => RGBColor(0x00, 0x72, 0xb2),
        Ink::Vermilion => RGBColor(0xd5, 0x5e, 0x00),
        Ink::Green => RGBColor(0x00, 0x9e, 0x73),
        Ink::Purple => RGBColor(0xcc, 0x79, 0xa7),
        Ink::Black => INK,
        Ink::Grey => GREY,
    }
}

/// The colour for text, dark enough to be read on white.
fn dark(ink: Ink) -> RGBColor {
    let RGBColor(r, g, b) = colour(ink);
    let darker = |c: u8| (f64::from(c) * 0.75) as u8;
    RGBColor(darker(r), darker(g), darker(b))
}

fn stroke(ink: Ink) -> ShapeStyle {
    let (width, [dashed, dash_dot, dotted]) = (1.3, DASHES.map(|(opacity, _)| opacity));
    let (width, opacity) = match ink {
        Ink::Blue => (width, 1.0),
        Ink::Vermilion => (width, dashed),
        Ink::Green => (width, dash_dot),
        Ink::Purple => (width, dotted),
        Ink::Black | Ink::Grey => (0.6, 1.0),
    };
    colour(ink).mix(opacity).stroke_width((width * PT) as u32)
}

fn font(points: f64, colour: &impl Color, horizontal: HPos, vertical: VPos) -> TextStyle<'static> {
    // plotters writes sizes divided by 1.24
    let size = points * PT * 1.24;
    FontDesc::new(FontFamily::SansSerif, size, FontStyle::Normal)
        .color(colour)
        .pos(Pos::new(horizontal, vertical))
}

fn bold(points: f64, colour: &RGBColor) -> TextStyle<'static> {
    let size = points * PT * 1.24;
    FontDesc::new(FontFamily::SansSerif, size, FontStyle::Bold)
        .color(colour)
        .pos(Pos::new(HPos::Left, VPos::Top))
}

/// Adds the size in mm, title, description and dash patterns, and a white outline around texts so that lines
/// do not touch them.
fn finish(plot: &Plot, name: &str, svg: &str) -> String {
    let size = [plot.width.millimetres(), plot.height_mm];
    let body = svg.split_once('>').map_or("", |(_, body)| body);
    let body = body.strip_suffix("</svg>\n").unwrap_or(body);
    let mut body = body
        .replace(" opacity=\"1\"", "")
        .replace(" \"/>", "\"/>")
        .replace("font-family=\"sans-serif\"", FONTS)
        .replace("<text ", &format!("<text{EDGE} "));
    for (opacity, pattern) in DASHES {
        body = body.replace(&format!("opacity=\"{opacity}\""), &format!("stroke-dasharray=\"{pattern}\""));
    }
    let lattice = size.map(|size| (size * MM).trunc());
    document(name, size, lattice, [&plot.title, &plot.description], &body)
}

/// A picture of this size in mm on white, `[width, height]` of its own units, with title and description.
pub(super) fn document(
    name: &str,
    [width, height]: [f64; 2],
    [across, down]: [f64; 2],
    [title, description]: [&str; 2],
    body: &str,
) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" viewBox=\"0 0 \
         {across} {down}\" stroke-linejoin=\"round\" role=\"img\" aria-labelledby=\"{name}-title \
         {name}-desc\">\n<title id=\"{name}-title\">{}</title>\n<desc id=\"{name}-desc\">{}</desc>\n<rect \
         width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>{body}</svg>\n",
        escape(title),
        escape(description),
    )
}

/// A line of a title about x, on the line at y, in type of `size`.
pub(super) fn title_line(x: f64, y: f64, size: u8, text: &str) -> String {
    let RGBColor(r, g, b) = INK;
    format!(
        "\n<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\" {FONTS} font-size=\"{size}\" \
         fill=\"#{r:02X}{g:02X}{b:02X}\">{}</text>",
        escape(text)
    )
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
