//! Paths in the box room, drawn from the side.

use glam::DVec3;

use crate::error::{Result, require_count};
use crate::paths::room::{BoxRoom, Face, Vertex};
use crate::paths::{Path, Paths};
use crate::plot::{Axis, Edition, Figure, Ink, Labels, Marker, Panel, Plot, Side};
use crate::stream::Stream;

/// The visible part of the room, in metres.
const LOW: [f64; 2] = [-2.25, -0.2];
const HIGH: [f64; 2] = [2.25, 4.3];
/// Room for students to draw into.
const WIDTH_MM: f64 = 150.0;
/// Points of print per metre, with a margin of 2 points on both sides.
const SCALE: f64 = (WIDTH_MM * 72.0 / 25.4 - 4.0) / (HIGH[0] - LOW[0]);
/// The height at which both axes have this scale, with 22 points above and below.
const HEIGHT_MM: f64 = (SCALE * (HIGH[1] - LOW[1]) + 22.0) * 25.4 / 72.0;

/// One ink per path.
const INKS: [(Ink, &str, &str); 3] =
    [(Ink::Blue, "①", "₁"), (Ink::Vermilion, "②", "₂"), (Ink::Green, "③", "₃")];
const PRIMES: [&str; 2] = ["", "′"];

/// The largest number of paths that are traced to find some that can be drawn.
const TRIED: u64 = 100_000;
/// The largest number of legible paths among which a set is chosen that can be told apart.
const CANDIDATES: usize = 300;

/// Figures for 4.1 and 4.2: up to three sampled paths of two or three bounces, from the side. The first
/// figure is the student's edition, which has only room, cube, light, eye and p; the second is the solution.
///
/// Drawn are the first paths that reach the light after the largest number of bounces that `paths` counts,
/// and that can be told apart in a drawing: their vertices are apart and lie on faces seen edge on, they pass
/// neither before nor behind the cube, and there is room for their labels. If none of the first 100,000 will
/// do, the title begins with "No", and the description says why. If the light is found by chance few paths
/// reach it, and fewer than `count` are usually drawn.
///
/// The room is seen from the south, or from the east if p would be before or behind the cube.
///
/// # Errors
/// If `paths` counts up to any other number of bounces than two or three, or the figures cannot be drawn.
pub fn paths_drawn(paths: &Paths, count: usize, seed: u64) -> Result<[Figure; 2]> {
    let bounces = paths.most_bounces();
    let ok = (2..=3).contains(&bounces);
    require_count("the number of bounces of paths that are drawn", bounces.into(), ok, "2 or 3")?;
    let side = SideView::new(*paths.room());
    let chosen = side.chosen(paths, count.min(INKS.len()), seed);
    let drawing = |edition| side.drawing(bounces, &chosen, seed, edition);
    Ok([drawing(Edition::Student)?, drawing(Edition::Solution)?])
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The distance from a point to a segment.
fn distance_to([a, b]: [[f64; 2]; 2], point: [f64; 2]) -> f64 {
    let (step, way) = ([b[0] - a[0], b[1] - a[1]], [point[0] - a[0], point[1] - a[1]]);
    let length2 = step[0] * step[0] + step[1] * step[1];
    let t =
        if length2 > 0.0 { ((way[0] * step[0] + way[1] * step[1]) / length2).clamp(0.0, 1.0) } else { 0.0 };
    distance([a[0] + t * step[0], a[1] + t * step[1]], point)
}

/// The segments of a line through points.
fn segments(line: &[[f64; 2]]) -> impl Iterator<Item = [[f64; 2]; 2]> {
    line.iter().copied().zip(line.iter().copied().skip(1)).map(|(a, b)| [a, b])
}

/// Whether a segment does not touch the cube in the drawing.
fn passes_the_cube([a, b]: [[f64; 2]; 2]) -> bool {
    let mut points =
        (0..=200).map(|i| f64::from(i) / 200.0).map(|t| [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
    points.all(|at| !before_the_cube(at))
}

fn before_the_cube(at: [f64; 2]) -> bool {
    at[0].abs() < Face::CUBE_HALF_WIDTH && at[1] < Face::CUBE_HEIGHT
}

/// The point that lies `length` metres from `from` towards `to`, or half way if that is less.
fn direction(from: [f64; 2], to: [f64; 2], length: f64) -> [f64; 2] {
    let part = (length / distance(from, to).max(1e-9)).min(0.5 + 0.2 * length);
    [from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1])]
}

/// A path that is drawn.
#[derive(Debug, Clone)]
struct Drawn {
    /// its vertices from p on, without the point of the light
    vertices: Vec<Vertex>,
    /// all its points, from the side
    line: Vec<[f64; 2]>,
}

/// The view of the room: from the south, along y, or from the east, along x.
struct SideView {
    room: BoxRoom,
    from_east: bool,
}

impl SideView {
    fn new(room: BoxRoom) -> Self {
        let p = room.point();
        let at = p.position();
        Self { room, from_east: p.normal().y != 0.0 || before_the_cube([at.x, at.z]) }
    }

    fn seen(&self, at: DVec3) -> [f64; 2] {
        [if self.from_east { at.y } else { at.x }, at.z]
    }

    /// The component of a direction away from the viewer.
    fn depth(&self, way: DVec3) -> f64 {
        if self.from_east { way.x } else { way.y }
    }

    fn p(&self) -> [f64; 2] {
        self.seen(self.room.point().position())
    }

    /// Where the eye is drawn: in front of p's face, and to the side, towards the middle of the room.
    fn eye(&self) -> [f64; 2] {
        let (p, [across, up]) = (self.p(), self.seen(self.room.point().normal()));
        let towards = |middle: f64, at: f64| if at > middle { -1.0 } else { 1.0 };
        let aside = if across == 0.0 { [towards(0.0, p[0]), 0.0] } else { [0.0, towards(2.0, p[1])] };
        [p[0] + 1.4 * across + 0.6 * aside[0], p[1] + 1.4 * up + 0.6 * aside[1]]
    }

    /// The tip of the arrow ω_o.
    fn to_eye(&self) -> [f64; 2] {
        direction(self.p(), self.eye(), 0.7)
    }

    fn tip_of_normal(&self, vertex: &Vertex) -> [f64; 2] {
        self.seen(vertex.position() + vertex.normal() * 0.4)
    }

    /// The first paths of the stream that can be drawn together.
    fn chosen(&self, paths: &Paths, count: usize, seed: u64) -> Vec<Drawn> {
        if !self.can_be_lit() {
            return Vec::new();
        }
        let candidates: Vec<Drawn> = (0..TRIED)
            .filter_map(|block| self.whole(paths.trace(&mut Stream::new(seed, block)), paths.most_bounces()))
            .filter(|path| self.reads_well(path) && self.told_apart(std::slice::from_ref(path)))
            .take(CANDIDATES)
            .collect();
        // where p lies in a corner, the room alone may be too crowded; paths must not add to that, up to
        // rounding
        let in_the_way = |paths: &[Drawn]| self.picture(paths, Edition::Solution).labels.in_the_way();
        let crowded = in_the_way(&[]);
        let mut most = Vec::new();
        // the first one may leave no room for others: then start with the next one
        for first in 0..candidates.len() {
            let mut chosen: Vec<Drawn> = Vec::new();
            for path in candidates.iter().skip(first) {
                if chosen.len() == count {
                    return chosen;
                }
                chosen.push(path.clone());
                if !self.told_apart(&chosen) || in_the_way(&chosen) > crowded + 1e-9 {
                    chosen.pop();
                }
            }
            if chosen.len() > most.len() {
                most = chosen;
            }
        }
        most
    }

    /// Whether any light can leave p after two bounces or more. The cube does not see itself, so one of two
    /// consecutive vertices is on a wall.
    fn can_be_lit(&self) -> bool {
        let scene = self.room.scene();
        let reflects = scene.wall_albedo > 0.0 && self.room.albedo(&self.room.point()) > 0.0;
        reflects && scene.radiance > 0.0 && scene.light_half_width > 0.0
    }

    /// The path, if it reaches the light after this number of bounces.
    fn whole(&self, path: Path, bounces: u32) -> Option<Drawn> {
        let Path { mut vertices, samples, light } = path;
        let bounces = bounces as usize;
        let point = match samples.last() {
            Some(sample) => (sample.visible && sample.from + 1 == bounces).then_some(sample.point)?,
            // found by chance: the last vertex is on the light
            None => vertices.pop_if(|last| self.room.is_light(last))?.position(),
        };
        let points = vertices.iter().map(Vertex::position).chain([point]);
        let line = points.map(|at| self.seen(at)).collect();
        (light > 0.0 && vertices.len() == bounces).then_some(Drawn { vertices, line })
    }

    /// Whether a path is legible on its own.
    fn reads_well(&self, path: &Drawn) -> bool {
        let later = || path.vertices.iter().skip(1);
        let edge_on = later().all(|vertex| self.depth(vertex.normal()) == 0.0);
        // near a corner it is not clear on which face a vertex lies, and light arrives along the face
        let off_corners = later().all(|vertex| {
            let [across, up] = self.seen(vertex.position());
            (across.abs() < 1.65 || (0.35..3.65).contains(&up)) && (up > 0.0 || across.abs() > 0.8)
        });
        let free = segments(&path.line)
            .all(|segment| passes_the_cube(segment) && distance_to(segment, self.eye()) > 0.3);
        // and it must not go back the way it came
        let turns = segments(&path.line).zip(segments(&path.line).skip(1)).all(|([a, at], [_, b])| {
            let ([x, y], [u, v]) = ([a[0] - at[0], a[1] - at[1]], [b[0] - at[0], b[1] - at[1]]);
            x * u + y * v < 0.94 * x.hypot(y) * u.hypot(v)
        });
        edge_on && off_corners && free && turns
    }

    /// Whether the last path can be told from those before it.
    fn told_apart(&self, paths: &[Drawn]) -> bool {
        let later = paths.iter().flat_map(|path| path.vertices.iter().skip(1));
        let vertices: Vec<_> = later.map(|vertex| self.seen(vertex.position())).chain([self.p()]).collect();
        let ends: Vec<_> = paths.iter().filter_map(|path| path.line.last().copied()).collect();
        let apart = |points: &[[f64; 2]], least: f64| {
            points.iter().enumerate().all(|(i, a)| points.iter().take(i).all(|b| distance(*a, *b) > least))
        };
        let legs = || paths.iter().flat_map(|path| segments(&path.line));
        let first_legs = || paths.iter().filter_map(|path| segments(&path.line).next());
        // arrows of all paths, and p's own
        let tips: Vec<_> = [self.to_eye(), self.tip_of_normal(&self.room.point())]
            .into_iter()
            .chain(first_legs().map(|[p, next]| direction(p, next, 0.8)))
            .collect();
        // an arrow must not lie on another path's line
        let arrows_apart = first_legs().all(|first @ [p, next]| {
            let mut others = legs().chain([[self.p(), self.eye()]]).filter(|leg| *leg != first);
            others.all(|leg| [0.6, 0.8].iter().all(|at| distance_to(leg, direction(p, next, *at)) > 0.1))
        });
        let off_lines =
            |at: [f64; 2], least: f64| legs().all(|leg| leg.contains(&at) || distance_to(leg, at) > least);
        let vertex_normals =
            paths.iter().flat_map(|path| &path.vertices).map(|vertex| self.tip_of_normal(vertex));
        // the light is small: points on it may be closer
        apart(&vertices, 0.6)
            && apart(&ends, 0.2)
            && apart(&tips, 0.25)
            && arrows_apart
            && vertices.iter().all(|at| off_lines(*at, 0.2))
            && off_lines(self.p(), 0.5)
            && vertex_normals.chain([self.to_eye()]).all(|tip| off_lines(tip, 0.12))
    }

    /// The drawing without its heading.
    fn picture(&self, chosen: &[Drawn], edition: Edition) -> Sketch {
        let mut sketch = Sketch::new();
        self.draw_room(&mut sketch);
        let (p, eye) = (self.p(), self.eye());
        if edition == Edition::Solution {
            for path in chosen {
                sketch.labels.avoid(&path.line);
            }
            let to_eye = self.to_eye();
            sketch.line("to the eye", Ink::Black, &[p, eye]);
            sketch.arrow(Ink::Black, p, to_eye);
            self.draw_normal(&self.room.point(), &mut sketch);
            for (path, (ink, number, digit)) in chosen.iter().zip(INKS) {
                self.draw_path(path, ink, number, digit, &mut sketch);
            }
            sketch.label(Ink::Black, to_eye, "ωₒ");
        }
        if self.room.scene().light_half_width > 0.0 {
            sketch.label(Ink::Black, [0.0, Face::ROOM_HEIGHT + 0.06], "light");
        }
        let panel = &mut sketch.panel;
        panel.marks("eye", Ink::Black, Marker::Ring, [eye]).marks("eye", Ink::Black, Marker::Dot, [eye]);
        panel.marks("p", Ink::Black, Marker::Disc, [p]);
        sketch.label(Ink::Black, eye, "eye");
        sketch.label(Ink::Black, p, "p");
        sketch
    }

    fn drawing(&self, bounces: u32, chosen: &[Drawn], seed: u64, edition: Edition) -> Result<Figure> {
        let (name, word) = if bounces == 2 { ("4_1_paths", "two") } else { ("4_2_paths", "three") };
        let from = if self.from_east { "the east, along x" } else { "the south, along y" };
        let Sketch { mut panel, .. } = self.picture(chosen, edition);
        panel.heading = format!("Paths of {word} bounces in the room, seen from the side: from {from}");
        let sampled = match chosen.len() {
            1 => "One sampled path",
            2 => "Two sampled paths",
            _ => "Three sampled paths",
        };
        let (title, description) = match edition {
            Edition::Student => (
                format!("Draw paths of {word} bounces to p"),
                "The room seen from the side, 4 m wide and high, with the cube of 1 m on its floor, the \
                 light in the ceiling, the point p and the eye."
                    .into(),
            ),
            Edition::Solution if chosen.is_empty() => {
                let why = if self.can_be_lit() {
                    &format!("Of {TRIED} paths (seed {seed}) none that reached the light can be made out")
                } else {
                    "No light leaves p after that many bounces: there is no light, or what the paths meet \
                     reflects none"
                };
                (
                    format!("No sampled paths of {word} bounces"),
                    format!(
                        "The room seen from the side. {why}. ωₒ leads from p to the eye, n is the normal."
                    ),
                )
            }
            Edition::Solution => (
                format!("{sampled} of {word} bounces"),
                format!(
                    "The room seen from the side. Numbered paths, as they were sampled (seed {seed}), go \
                     from p in a direction ωᵢ to a point p₁, p₂, … on another face{} and on to the light, \
                     none through the cube; ωₒ leads from p to the eye. Short arrows are normals n. A \
                     segment that looks short may be long along the line of sight.",
                    if bounces > 2 { ", from there to p₁′, p₂′, …" } else { "" }
                ),
            ),
        };
        let plot = Plot::of(name, HEIGHT_MM, vec![panel]);
        Plot { edition, width_mm: WIDTH_MM, ..plot }.draw(title, description)
    }

    fn draw_room(&self, sketch: &mut Sketch) {
        let (w, h) = (Face::ROOM_HALF_WIDTH, Face::ROOM_HEIGHT);
        let (c, t) = (Face::CUBE_HALF_WIDTH, Face::CUBE_HEIGHT);
        sketch.panel.band("cube", Ink::Grey, [[-c, 0.0, t], [c, 0.0, t]]);
        sketch.line("room", Ink::Black, &[[-w, 0.0], [w, 0.0], [w, h], [-w, h], [-w, 0.0]]);
        sketch.line("cube", Ink::Black, &[[-c, 0.0], [-c, t], [c, t], [c, 0.0]]);
        let light = self.room.scene().light_half_width;
        if light > 0.0 {
            let (low, high) = (h - 0.03, h + 0.06);
            sketch.panel.band("light", Ink::Black, [[-light, low, high], [light, low, high]]);
            let outline = [[-light, low], [light, low], [light, high], [-light, high], [-light, low]];
            sketch.line("light", Ink::Black, &outline);
        }
    }

    /// A path, whose line labels keep off already.
    fn draw_path(&self, path: &Drawn, ink: Ink, number: &str, digit: &str, sketch: &mut Sketch) {
        sketch.panel.line(&format!("path {number}"), ink, path.line.iter().copied());
        if let Some([p, next]) = segments(&path.line).next() {
            let tip = direction(p, next, 0.8);
            sketch.arrow(ink, direction(p, next, 0.55), tip);
            sketch.label(ink, tip, &format!("ωᵢ{digit}"));
            sketch.label(ink, [0.4 * p[0] + 0.6 * next[0], 0.4 * p[1] + 0.6 * next[1]], number);
        }
        for (vertex, prime) in path.vertices.iter().skip(1).zip(PRIMES) {
            self.draw_normal(vertex, sketch);
            let at = self.seen(vertex.position());
            sketch.panel.marks("p_j", ink, Marker::Disc, [at]);
            sketch.label(ink, at, &format!("p{digit}{prime}"));
        }
        sketch.panel.marks("point of the light", ink, Marker::Disc, path.line.last().copied());
    }

    /// The normal at a vertex, which is on a face seen edge on.
    fn draw_normal(&self, vertex: &Vertex, sketch: &mut Sketch) {
        let tip = self.tip_of_normal(vertex);
        sketch.arrow(Ink::Grey, self.seen(vertex.position()), tip);
        sketch.label(Ink::Grey, tip, "n");
    }
}

/// A drawing, and what its labels keep off.
struct Sketch {
    panel: Panel,
    labels: Labels,
}

impl Sketch {
    fn new() -> Self {
        let metres = |name: &str, axis: usize| Axis::linear(name, LOW[axis], HIGH[axis]);
        let axes = Panel::new("", metres("across (m)", 0), metres("z (m)", 1));
        Self { panel: Panel { bare: true, ..axes }, labels: Labels::new(LOW, HIGH, SCALE) }
    }

    fn line(&mut self, series: &str, ink: Ink, points: &[[f64; 2]]) {
        self.panel.line(series, ink, points.iter().copied());
        self.labels.avoid(points);
    }

    fn arrow(&mut self, ink: Ink, from: [f64; 2], to: [f64; 2]) {
        self.panel.arrow(ink, from, to);
        let length = distance(from, to).max(1e-9);
        let (x, y) = ((to[0] - from[0]) / length, (to[1] - from[1]) / length);
        // heads are 6 points long and 4.8 wide
        let barb =
            |aside: f64| [to[0] - (6.0 * x - aside * y) / SCALE, to[1] - (6.0 * y + aside * x) / SCALE];
        self.labels.avoid(&[from, to]);
        self.labels.avoid(&[barb(2.4), to, barb(-2.4), barb(2.4)]);
    }

    fn label(&mut self, ink: Ink, at: [f64; 2], text: &str) {
        if let Some(middle) = self.labels.beside(&[at], text) {
            self.panel.text(ink, middle, Side::Centre, text);
        }
    }
}
