//! Paths in the box room, drawn from the side.

use glam::DVec3;

use super::labels::Labels;
use super::plot::{Axis, Ink, Marker, Panel, Plot, Width};
use super::{Edition, Figure};
use crate::box_room::{Face, Vertex};
use crate::error::Result;
use crate::paths::{Path, Paths};
use crate::stream::Stream;

/// What is shown, in metres.
const LOW: [f64; 2] = [-2.35, -0.35];
const HIGH: [f64; 2] = [2.35, 4.55];
/// Points of print to a metre: the axes of a column figure are 207.5 points wide.
const SCALE: f64 = 207.5 / (HIGH[0] - LOW[0]);
/// The height at which a metre is as high as it is wide, with 50 points above and below the axes.
const HEIGHT_MM: f64 = (SCALE * (HIGH[1] - LOW[1]) + 50.0) * 25.4 / 72.0;

/// One ink a path.
const INKS: [(Ink, &str); 3] = [(Ink::Blue, "①"), (Ink::Vermilion, "②"), (Ink::Green, "③")];
const PRIMES: [&str; 4] = ["", "′", "″", "‴"];

/// 4.1 and 4.2: up to three paths, as they were sampled, from the side: the student's edition, which has room, cube, light, eye and p only, and the solution.
///
/// Of the paths that reach the light the first ones are taken that can be told apart in a drawing: their vertices are apart and lie on faces that are seen edge on, and they pass
/// neither before nor behind the cube.
/// `paths` samples the light.
///
/// # Errors
/// If they cannot be drawn.
pub fn paths_drawn(paths: &Paths, count: usize, seed: u64) -> Result<[Figure; 2]> {
    let chosen = chosen(paths, count.min(INKS.len()), seed);
    Ok([drawing(paths, &chosen, seed, Edition::Student)?, drawing(paths, &chosen, seed, Edition::Solution)?])
}

/// Seen from the side, from the south.
fn seen(at: DVec3) -> [f64; 2] {
    [at.x, at.z]
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The path's points from p to the light, from the side.
fn polyline(path: &Path) -> Vec<[f64; 2]> {
    let vertices = path.vertices.iter().map(|vertex| seen(vertex.position()));
    vertices.chain(path.samples.last().map(|sample| seen(sample.point))).collect()
}

fn chosen(paths: &Paths, count: usize, seed: u64) -> Vec<Path> {
    let mut chosen: Vec<Path> = Vec::new();
    let mut taken: Vec<[f64; 2]> = vec![seen(paths.room().point().position())];
    for block in 0..4096 {
        if chosen.len() == count {
            break;
        }
        let path = paths.trace(&mut Stream::new(seed, block));
        let points = polyline(&path);
        let later = points.get(1..).unwrap_or_default();
        let reaches = path.light > 0.0 && path.samples.last().is_some_and(|sample| sample.visible);
        let on_edge = path.vertices.iter().skip(1).all(|vertex| vertex.normal().y == 0.0);
        let apart =
            |needed: f64, a: [f64; 2], others: &[[f64; 2]]| others.iter().all(|b| distance(a, *b) > needed);
        let told_apart = later.iter().enumerate().all(|(i, point)| {
            // the light is small: the last points may be closer
            let needed = if i + 1 == later.len() { 0.2 } else { 0.8 };
            apart(needed, *point, &taken) && apart(needed, *point, later.get(..i).unwrap_or_default())
        });
        let free = points.windows(2).all(|pair| passes_the_cube(pair) && passes(pair, eye(paths)));
        if reaches && on_edge && told_apart && free {
            taken.extend_from_slice(later);
            chosen.push(path);
        }
    }
    chosen
}

/// Points along a segment.
fn along(segment: &[[f64; 2]]) -> impl Iterator<Item = [f64; 2]> {
    let ends = <[[f64; 2]; 2]>::try_from(segment).ok();
    ends.into_iter().flat_map(|[a, b]| {
        (0..=200)
            .map(move |i| f64::from(i) / 200.0)
            .map(move |t| [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])])
    })
}

/// Whether a segment leaves room around a point.
fn passes(segment: &[[f64; 2]], point: [f64; 2]) -> bool {
    along(segment).all(|at| distance(at, point) > 0.3)
}

/// Whether a segment stays off the cube in the drawing.
fn passes_the_cube(segment: &[[f64; 2]]) -> bool {
    along(segment).all(|at| at[0].abs() >= Face::CUBE_HALF_WIDTH || at[1] >= Face::CUBE_HEIGHT)
}

/// Where the eye is drawn: before p's face, a little aside.
fn eye(paths: &Paths) -> [f64; 2] {
    let p = paths.room().point();
    let aside = if p.normal().x == 0.0 { DVec3::X * 0.45 } else { DVec3::Z * 0.45 };
    seen(p.position() + p.normal() * 1.5 + aside)
}

fn drawing(paths: &Paths, chosen: &[Path], seed: u64, edition: Edition) -> Result<Figure> {
    let bounces = paths.most_bounces();
    let (name, word) = if bounces == 2 { ("4_1_paths", "two") } else { ("4_2_paths", "three") };
    let metres = |name: &str, low: f64, high: f64, ticks: [(f64, &str); 5]| {
        Axis::linear(name, low, high).with_ticks(ticks)
    };
    let mut panel = Panel::new(
        &format!("Paths of {word} bounces, from the side"),
        metres("x (m)", LOW[0], HIGH[0], [(-2.0, "−2"), (-1.0, "−1"), (0.0, "0"), (1.0, "1"), (2.0, "2")]),
        metres("z (m)", LOW[1], HIGH[1], [(0.0, "0"), (1.0, "1"), (2.0, "2"), (3.0, "3"), (4.0, "4")]),
    );
    let mut labels = Labels::new(LOW, HIGH, SCALE);
    draw_room(paths, &mut panel, &mut labels);
    let p = seen(paths.room().point().position());
    if edition == Edition::Solution {
        let lines: Vec<_> = chosen.iter().map(polyline).collect();
        for line in &lines {
            labels.avoid(line);
        }
        let to_eye = direction(p, eye(paths), 0.7);
        labels.avoid(&[p, to_eye]);
        draw_normal(&paths.room().point(), "n", &mut panel, &mut labels);
        panel.arrow(Ink::Black, p, to_eye);
        for ((path, line), (ink, number)) in chosen.iter().zip(&lines).zip(INKS) {
            draw_path(path, line, ink, number, &mut panel, &mut labels);
        }
        labels.place(&mut panel, Ink::Black, to_eye, "ωₒ");
    }
    if paths.room().scene().light_half_width > 0.0 {
        labels.place(&mut panel, Ink::Black, [0.0, Face::ROOM_HEIGHT + 0.06], "light");
    }
    panel.marks("eye", Ink::Black, Marker::Ring, [eye(paths)]).marks(
        "eye",
        Ink::Black,
        Marker::Dot,
        [eye(paths)],
    );
    panel.marks("p", Ink::Black, Marker::Disc, [p]);
    labels.place(&mut panel, Ink::Black, eye(paths), "eye");
    labels.place(&mut panel, Ink::Black, p, "p");
    let (title, description) = match edition {
        Edition::Student => (
            format!("Draw paths of {word} bounces to p"),
            "The room from the side, 4 m wide and high, with the cube of 1 m on its floor, the light in the ceiling, the point p and the eye.".into(),
        ),
        Edition::Solution => (
            format!("{} sampled paths of {word} bounces", ["No", "One", "Two", "Three"].get(chosen.len()).unwrap_or(&"Some")),
            format!(
                "The room from the side. Numbered paths, as they were sampled (seed {seed}), go from p in a direction ωᵢ to a point p₁, p₂, … on another face{} and on to the light, none through the cube; ωₒ leads from p to the eye. \
                 Short arrows are normals n. What looks short may lead far in depth.",
                if bounces > 2 { ", from there to p₁′, p₂′, …" } else { "" }
            ),
        ),
    };
    Plot {
        name,
        title,
        description,
        edition,
        width: Width::Column,
        height_mm: HEIGHT_MM,
        columns: 1,
        panels: vec![panel],
    }
    .draw()
}

fn draw_room(paths: &Paths, panel: &mut Panel, labels: &mut Labels) {
    let (w, h) = (Face::ROOM_HALF_WIDTH, Face::ROOM_HEIGHT);
    let (c, t) = (Face::CUBE_HALF_WIDTH, Face::CUBE_HEIGHT);
    let room = [[-w, 0.0], [w, 0.0], [w, h], [-w, h], [-w, 0.0]];
    let cube = [[-c, 0.0], [-c, t], [c, t], [c, 0.0]];
    panel.band("cube", Ink::Grey, [[-c, 0.0, t], [c, 0.0, t]]);
    panel.line("room", Ink::Black, room).line("cube", Ink::Black, cube);
    labels.avoid(&room);
    labels.avoid(&cube);
    let light = paths.room().scene().light_half_width;
    if light > 0.0 {
        let (low, high) = (h - 0.03, h + 0.06);
        panel.band("light", Ink::Black, [[-light, low, high], [light, low, high]]);
        let outline = [[-light, low], [light, low], [light, high], [-light, high], [-light, low]];
        panel.line("light", Ink::Black, outline);
        labels.avoid(&outline);
    }
}

fn draw_path(path: &Path, line: &[[f64; 2]], ink: Ink, number: &str, panel: &mut Panel, labels: &mut Labels) {
    panel.line(&format!("path {number}"), ink, line.iter().copied());
    let index = INKS.iter().position(|(known, _)| *known == ink).unwrap_or(0);
    let digit = ["₁", "₂", "₃"].get(index).copied().unwrap_or_default();
    if let [p, next, ..] = *line {
        let tip = direction(p, next, 0.8);
        panel.arrow(ink, direction(p, next, 0.55), tip);
        labels.place(panel, ink, tip, &format!("ωᵢ{digit}"));
        labels.place(panel, ink, [0.4 * p[0] + 0.6 * next[0], 0.4 * p[1] + 0.6 * next[1]], number);
    }
    for (vertex, prime) in path.vertices.iter().skip(1).zip(PRIMES) {
        draw_normal(vertex, "n", panel, labels);
        panel.marks("p_j", ink, Marker::Disc, [seen(vertex.position())]);
        labels.place(panel, ink, seen(vertex.position()), &format!("p{digit}{prime}"));
    }
    panel.marks("point of the light", ink, Marker::Disc, line.last().copied());
}

/// The normal at a vertex: an arrow, or, seen end on, a ring.
fn draw_normal(vertex: &Vertex, text: &str, panel: &mut Panel, labels: &mut Labels) {
    let (from, to) = (seen(vertex.position()), seen(vertex.position() + vertex.normal() * 0.4));
    if distance(from, to) > 0.1 {
        panel.arrow(Ink::Grey, from, to);
        labels.avoid(&[from, to]);
        labels.place(panel, Ink::Grey, to, text);
    } else {
        panel.marks("normal", Ink::Grey, Marker::Ring, [from]);
    }
}

/// The point that lies `length` metres from `from` towards `to`, or half way if that is less.
fn direction(from: [f64; 2], to: [f64; 2], length: f64) -> [f64; 2] {
    let part = (length / distance(from, to).max(1e-9)).min(0.5 + 0.2 * length);
    [from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1])]
}
