//! Draws a [`Plot`] with plotters. Its coordinates are integers, so units are a tenth of a pixel; otherwise
//! curves would look like staircases.

use std::sync::Once;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontFamily, register_font};

use super::document::{DASHES, MM};
use super::labels::{LINE, Labels, clip_segment, size, width};
use super::panel::{Ink, Item, Kind, Marker, Panel, Side};
use super::{Axis, Plot};

/// Units per typographic point.
const PT: f64 = 960.0 / 72.0;

const INK: RGBColor = RGBColor(0x22, 0x22, 0x22);
const GREY: RGBColor = RGBColor(0x88, 0x88, 0x88);
const FAINT: RGBColor = RGBColor(0xdd, 0xdd, 0xdd);

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// All panels, as plotters writes them.
pub(super) fn body(plot: &Plot) -> Result<String, String> {
    register_fonts();
    let mut svg = String::new();
    let size = ((plot.width_mm * MM) as u32, (plot.height_mm * MM) as u32);
    let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
    let columns = plot.columns.max(1);
    let areas = root.split_evenly((plot.panels.len().div_ceil(columns), columns));
    let drawn = plot.panels.iter().zip(&areas).try_for_each(|(panel, area)| draw_panel(panel, area));
    drawn.and_then(|()| root.present()).map_err(|error| error.to_string())?;
    drop((root, areas));
    Ok(svg)
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

/// Where the axes of a panel are, in units.
struct Frame<'p> {
    panel: &'p Panel,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Frame<'_> {
    /// Where a point is on the axes, from 0 to 1.
    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.panel.x.place(x), self.panel.y.place(y)]
    }

    /// The unit nearest to a place.
    fn lattice(&self, [x, y]: [f64; 2]) -> (i32, i32) {
        (
            (self.left + x * (self.right - self.left)).round() as i32,
            (self.bottom - y * (self.bottom - self.top)).round() as i32,
        )
    }

    fn at(&self, point: [f64; 2]) -> (i32, i32) {
        self.lattice(self.place(point))
    }

    fn holds(&self, [x, y]: [f64; 2]) -> bool {
        self.panel.x.holds(x) && self.panel.y.holds(y)
    }

    /// Whether a text there would be on the axes or just beside them.
    fn is_near(&self, point: [f64; 2]) -> bool {
        self.place(point).iter().all(|place| (-0.25..=1.25).contains(place))
    }

    /// The parts of a curve inside the axes, in units.
    fn clip(&self, points: impl Iterator<Item = [f64; 2]>) -> Vec<Vec<(i32, i32)>> {
        let places: Vec<_> = points.map(|point| self.place(point)).collect();
        let mut runs: Vec<Vec<(i32, i32)>> = Vec::new();
        let mut end = None;
        for (from, to) in places.iter().zip(places.iter().skip(1)) {
            let inside = clip_segment(*from, *to);
            if let Some([a, b]) = inside {
                match runs.last_mut() {
                    Some(run) if end == Some(a) => run.push(self.lattice(b)),
                    _ => runs.push(vec![self.lattice(a), self.lattice(b)]),
                }
            }
            end = inside.map(|[_, b]| b);
        }
        runs
    }
}

fn draw_panel(panel: &Panel, area: &Area<'_>) -> Drawn {
    let (across, down) = area.dim_in_pixel();
    let [left, right, bottom] =
        if panel.bare { [2.0; 3] } else { [20.0 + panel.y.label_width(), 11.0, 30.0] };
    let frame = Frame {
        panel,
        left: left * PT,
        right: f64::from(across) - right * PT,
        top: 20.0 * PT,
        bottom: f64::from(down) - bottom * PT,
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
    let mut all = Vec::new();
    for item in &frame.panel.items {
        match item {
            Item::Series { kind: Kind::Line, points, .. } => {
                for run in frame.clip(points.iter().map(|&[x, y, ..]| [x, y])) {
                    labels.avoid(&run.into_iter().map(real).collect::<Vec<_>>());
                }
            }
            Item::Series { kind: Kind::Marks(_), points, .. } => {
                for &[x, y, low, high] in points.iter().filter(|[x, y, ..]| frame.holds([*x, *y])) {
                    labels.keep_off(at(&[x, y]), [6.0; 2]);
                    if low <= high {
                        labels.avoid(&[at(&[x, low]), at(&[x, high])]);
                    }
                }
            }
            Item::Arrow { from, to, .. } => labels.avoid(&[at(from), at(to)]),
            Item::Text { at, side, text, .. } if frame.is_near(*at) => {
                let (start, horizontal, vertical) = stands(frame.at(*at), *side);
                let ([x, y], [across, up]) = (real(start), size(text));
                let aside = match horizontal {
                    HPos::Left => 0.5,
                    HPos::Center => 0.0,
                    HPos::Right => -0.5,
                };
                let below = match vertical {
                    VPos::Top => 0.5,
                    VPos::Center => 0.0,
                    VPos::Bottom => -0.5,
                };
                labels.keep_off([x + aside * across * PT, y + below * up * PT], [across, up]);
            }
            Item::Shade { from, to } => {
                for x in [*from, *to] {
                    labels.avoid(&[frame.panel.y.low, frame.panel.y.high].map(|y| at(&[x, y])));
                }
            }
            Item::Label { ink, beside, text } => all.push((ink, beside, text)),
            // what fills an area may lie under a label, and what belongs far outside is not drawn
            Item::Series { .. } | Item::Text { .. } => {}
        }
    }
    // those with the fewest places to choose from first
    all.sort_by_key(|(_, beside, _)| beside.len());
    for (ink, beside, text) in all {
        let points: Vec<_> = beside.iter().filter(|point| frame.holds(**point)).map(at).collect();
        let Some([x, y]) = labels.beside(&points, text) else { continue };
        let last = 0.5 * (text.lines().count() as f64 - 1.0);
        for (row, line) in text.lines().enumerate() {
            let middle = (x.round() as i32, (y + (row as f64 - last) * LINE * PT).round() as i32);
            write(line, middle, font(8.0, &dark(*ink), HPos::Center, VPos::Center), area)?;
        }
    }
    Ok(())
}

fn write(text: &str, at: (i32, i32), style: TextStyle<'_>, area: &Area<'_>) -> Drawn {
    area.draw(&Text::new(text, at, style))
}

fn path(points: Vec<(i32, i32)>, style: impl Into<ShapeStyle>, area: &Area<'_>) -> Drawn {
    area.draw(&PathElement::new(points, style))
}

fn draw_axes(frame: &Frame<'_>, area: &Area<'_>) -> Drawn {
    let Panel { heading, x, y, .. } = frame.panel;
    let thin = INK.stroke_width((0.5 * PT) as u32);
    let tick = 3.0 * PT;
    let corner = |x: f64, y: f64| (x.round() as i32, y.round() as i32);
    let mut bold = font(9.0, &INK, HPos::Left, VPos::Top);
    bold.font = bold.font.style(FontStyle::Bold);
    write(heading, corner(frame.left, 4.0 * PT), bold, area)?;
    if frame.panel.bare {
        return Ok(());
    }
    let [top, foot] = [frame.top, frame.bottom].map(|y| corner(frame.left, y));
    path(vec![top, foot, corner(frame.right, frame.bottom)], thin, area)?;
    let [across, up] = [frame.right - frame.left, frame.bottom - frame.top].map(|length| length / PT);
    for (at, label) in x.legible(across, |label| width(label) + 5.0) {
        let (column, row) = frame.at([at, y.low]);
        path(vec![(column, row), (column, row + tick as i32)], thin, area)?;
        let below = (column, row + (1.6 * tick) as i32);
        write(label, below, font(8.0, &INK, HPos::Center, VPos::Top), area)?;
    }
    for (at, label) in y.legible(up, |_| 10.0) {
        let (column, row) = frame.at([x.low, at]);
        path(vec![(column - tick as i32, row), (column, row)], thin, area)?;
        let beside = (column - (1.7 * tick) as i32, row);
        write(label, beside, font(8.0, &INK, HPos::Right, VPos::Center), area)?;
    }
    let middle = corner(0.5 * (frame.left + frame.right), frame.bottom + 17.0 * PT);
    let name = font(8.5, &INK, HPos::Center, VPos::Top);
    write(&x.name, middle, name.clone(), area)?;
    let beside = corner(1.0 * PT, 0.5 * (frame.top + frame.bottom));
    write(&y.name, beside, name.transform(FontTransform::Rotate270), area)
}

fn draw_item(item: &Item, frame: &Frame<'_>, area: &Area<'_>) -> Drawn {
    match item {
        Item::Series { ink, kind, points, .. } => draw_series(*ink, *kind, points, frame, area),
        Item::Arrow { ink, from, to } if frame.is_near(*from) && frame.is_near(*to) => {
            draw_arrow(frame.at(*from), frame.at(*to), *ink, area)
        }
        Item::Text { ink, at, side, text } if frame.is_near(*at) => {
            let (at, horizontal, vertical) = stands(frame.at(*at), *side);
            write(text, at, font(8.0, &dark(*ink), horizontal, vertical), area)
        }
        // a shade lies under the axes, labels above all else; and what belongs far outside is not drawn
        Item::Shade { .. } | Item::Label { .. } | Item::Arrow { .. } | Item::Text { .. } => Ok(()),
    }
}

fn draw_series(ink: Ink, kind: Kind, points: &[[f64; 4]], frame: &Frame<'_>, area: &Area<'_>) -> Drawn {
    let Axis { low: foot, high: top, .. } = frame.panel.y;
    match kind {
        Kind::Line => {
            let mut runs = frame.clip(points.iter().map(|&[x, y, ..]| [x, y])).into_iter();
            runs.try_for_each(|run| path(run, stroke(ink), area))
        }
        Kind::Band => {
            let inside: Vec<_> = points.iter().filter(|[x, ..]| frame.panel.x.holds(*x)).collect();
            let lows = inside.iter().map(|[x, _, low, _]| frame.at([*x, low.clamp(foot, top)]));
            let highs = inside.iter().rev().map(|[x, .., high]| frame.at([*x, high.clamp(foot, top)]));
            area.draw(&Polygon::new(lows.chain(highs).collect::<Vec<_>>(), colour(ink).mix(0.25)))
        }
        Kind::Marks(marker) => {
            let bar = colour(ink).stroke_width((0.8 * PT) as u32);
            let mut inside = points.iter().filter(|[x, y, ..]| frame.holds([*x, *y]));
            inside.try_for_each(|&[x, y, low, high]| {
                let runs = frame.clip([[x, low], [x, high]].into_iter());
                runs.into_iter().try_for_each(|run| path(run, bar, area))?;
                draw_marker(frame.at([x, y]), ink, marker, area)
            })
        }
        Kind::Bars(width) => points.iter().try_for_each(|&[x, y, ..]| {
            let [from, to] = [x - 0.5 * width, x + 0.5 * width];
            let corners = [frame.at([from, foot]), frame.at([to, y.clamp(foot, top)])];
            area.draw(&Rectangle::new(corners, colour(ink).mix(0.45).filled()))
        }),
    }
}

/// Where a text on this side of a point begins, ends or has its middle.
fn stands((x, y): (i32, i32), side: Side) -> ((i32, i32), HPos, VPos) {
    let gap = (4.0 * PT) as i32;
    match side {
        Side::Left => ((x - gap, y), HPos::Right, VPos::Center),
        Side::Right => ((x + gap, y), HPos::Left, VPos::Center),
        Side::Above => ((x, y - gap), HPos::Center, VPos::Bottom),
        Side::UpperRight => ((x + gap, y - gap / 2), HPos::Left, VPos::Bottom),
        Side::Centre => ((x, y), HPos::Center, VPos::Center),
    }
}

fn draw_marker((x, y): (i32, i32), ink: Ink, marker: Marker, area: &Area<'_>) -> Drawn {
    let colour = colour(ink);
    let r = (2.2 * PT) as i32;
    let line = colour.stroke_width((0.9 * PT) as u32);
    match marker {
        Marker::Dot => area.draw(&Circle::new((x, y), r / 2, colour.filled())),
        Marker::Disc => area.draw(&Circle::new((x, y), r, colour.filled())),
        Marker::Ring => area.draw(&Circle::new((x, y), r, line)),
        Marker::Square => area.draw(&Rectangle::new([(x - r, y - r), (x + r, y + r)], colour.filled())),
        Marker::Triangle => {
            let corners = vec![(x, y - r - r / 3), (x + r, y + r), (x - r, y + r)];
            area.draw(&Polygon::new(corners, colour))
        }
        Marker::Cross => {
            path(vec![(x - r, y - r), (x + r, y + r)], line, area)?;
            path(vec![(x - r, y + r), (x + r, y - r)], line, area)
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
    path(vec![from, corner(4.0 * PT, 0.0)], stroke(ink), area)?;
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
