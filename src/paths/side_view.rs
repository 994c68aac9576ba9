//! Paths in the box room, drawn from the side.

use glam::DVec3;

use crate::error::{Result, require_count};
use crate::paths::room::{BoxRoom, Face, Vertex};
use crate::paths::{Path, Paths};
use crate::plot::Labels;
use crate::plot::{Axis, Edition, Figure, Ink, Marker, Panel, Plot, Width};
use crate::stream::Stream;

/// The visible part of the room, in metres.
const LOW: [f64; 2] = [-2.25, -0.2];
const HIGH: [f64; 2] = [2.25, 4.3];
/// Points of print per metre: the figure is 150 mm wide, with a margin of 2 points on both sides.
const SCALE: f64 = (150.0 * 72.0 / 25.4 - 4.0) / (HIGH[0] - LOW[0]);
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
/// ```
/// use unbiased::paths::room::{BoxRoom, Scene};
/// use unbiased::paths::figures;
/// use unbiased::lambertian::hemisphere::Hemisphere;
/// use unbiased::paths::{Bounces, FindLight, Paths};
///
/// let room = BoxRoom::new(Scene::default())?;
/// let paths = |k| Paths::new(room, Bounces::Exactly(k), Hemisphere::Cosine, FindLight::BySampling);
/// let [to_fill_in, solved] = figures::paths_drawn(&paths(2)?, 3, 1)?;
/// assert_eq!([to_fill_in.name(), solved.name()], ["4_1_paths_student", "4_1_paths"]);
/// assert_eq!(solved.title(), "Three sampled paths of two bounces");
/// assert!(figures::paths_drawn(&paths(5)?, 3, 1).is_err());
/// # Ok::<(), unbiased::Error>(())
/// ```
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
        let crowded = self.picture(&[], Edition::Solution).1;
        let mut most = Vec::new();
        // the first one may leave no room for others: then start with the next one
        for first in 0..candidates.len() {
            let mut chosen: Vec<Drawn> = Vec::new();
            for path in candidates.iter().skip(first) {
                if chosen.len() == count {
                    return chosen;
                }
                chosen.push(path.clone());
                if !self.told_apart(&chosen) || self.picture(&chosen, Edition::Solution).1 > crowded + 1e-9 {
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
        if light <= 0.0 {
            return None;
        }
        let point = match samples.last() {
            Some(sample) => (sample.visible && sample.from + 1 == bounces).then_some(sample.point)?,
            // found by chance: the last vertex is on the light
            None => vertices.pop_if(|last| self.room.is_light(last))?.position(),
        };
        if vertices.len() != bounces {
            return None;
        }
        let line =
            vertices.iter().map(|vertex| self.seen(vertex.position())).chain([self.seen(point)]).collect();
        Some(Drawn { vertices, line })
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
        let points = |path: &Drawn, least: usize| {
            path.line.get(least..path.line.len().saturating_sub(1)).unwrap_or_default().to_vec()
        };
        let vertices: Vec<_> = paths.iter().flat_map(|path| points(path, 1)).chain([self.p()]).collect();
        let ends: Vec<_> = paths.iter().filter_map(|path| path.line.last().copied()).collect();
        let apart = |points: &[[f64; 2]], least: f64| {
            points.iter().enumerate().all(|(i, a)| points.iter().take(i).all(|b| distance(*a, *b) > least))
        };
        // arrows of all paths, and p's own
        let mut tips = vec![self.to_eye(), self.tip_of_normal(&self.room.point())];
        tips.extend(paths.iter().filter_map(|path| match *path.line {
            [p, next, ..] => Some(direction(p, next, 0.8)),
            _ => None,
        }));
        // an arrow must not lie on another path's line
        let legs = || {
            let eye = [self.p(), self.eye()];
            paths.iter().flat_map(|path| segments(&path.line)).chain([eye])
        };
        let arrows_apart = paths.iter().filter_map(|path| segments(&path.line).next()).all(|first| {
            let arrow = [0.6, 0.8].map(|at| direction(first[0], first[1], at));
            legs().filter(|leg| *leg != first).all(|leg| arrow.iter().all(|at| distance_to(leg, *at) > 0.1))
        });
        let off_lines = |at: [f64; 2], least: f64| {
            paths
                .iter()
                .flat_map(|path| segments(&path.line))
                .all(|segment| segment.contains(&at) || distance_to(segment, at) > least)
        };
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

    /// The drawing without its heading, and how much its labels overlap other things.
    fn picture(&self, chosen: &[Drawn], edition: Edition) -> (Vec<Panel>, f64) {
        let metres = |name: &str, axis: usize| Axis::linear(name, LOW[axis], HIGH[axis]);
        let mut panel = Panel::new("", metres("across (m)", 0), metres("z (m)", 1));
        panel.bare = true;
        let mut labels = Labels::new(LOW, HIGH, SCALE);
        self.draw_room(&mut panel, &mut labels);
        let (p, eye) = (self.p(), self.eye());
        if edition == Edition::Solution {
            for path in chosen {
                labels.avoid(&path.line);
            }
            let to_eye = self.to_eye();
            panel.line("to the eye", Ink::Black, [p, eye]);
            labels.avoid(&[p, eye]);
            draw_arrow(Ink::Black, p, to_eye, &mut panel, &mut labels);
            self.draw_normal(&self.room.point(), &mut panel, &mut labels);
            for (path, (ink, number, digit)) in chosen.iter().zip(INKS) {
                self.draw_path(path, ink, number, digit, &mut panel, &mut labels);
            }
            labels.place(&mut panel, Ink::Black, to_eye, "ωₒ");
        }
        if self.room.scene().light_half_width > 0.0 {
            labels.place(&mut panel, Ink::Black, [0.0, Face::ROOM_HEIGHT + 0.06], "light");
        }
        panel.marks("eye", Ink::Black, Marker::Ring, [eye]).marks("eye", Ink::Black, Marker::Dot, [eye]);
        panel.marks("p", Ink::Black, Marker::Disc, [p]);
        labels.place(&mut panel, Ink::Black, eye, "eye");
        labels.place(&mut panel, Ink::Black, p, "p");
        let in_the_way = labels.in_the_way();
        (vec![panel], in_the_way)
    }

    fn drawing(&self, bounces: u32, chosen: &[Drawn], seed: u64, edition: Edition) -> Result<Figure> {
        let (name, word) = if bounces == 2 { ("4_1_paths", "two") } else { ("4_2_paths", "three") };
        let (mut panels, _) = self.picture(chosen, edition);
        for panel in &mut panels {
            let from = if self.from_east { "the east, along x" } else { "the south, along y" };
            panel.heading = format!("Paths of {word} bounces in the room, seen from the side: from {from}");
        }
        let number = ["No", "One", "Two", "Three"].get(chosen.len()).unwrap_or(&"Some");
        let paths = if chosen.len() == 1 { "path" } else { "paths" };
        let (title, description) = match edition {
            Edition::Student => (
                format!("Draw paths of {word} bounces to p"),
                "The room seen from the side, 4 m wide and high, with the cube of 1 m on its floor, the \
                 light in the ceiling, the point p and the eye."
                    .into(),
            ),
            Edition::Solution if chosen.is_empty() => {
                let why = if self.can_be_lit() {
                    format!(
                        "Of {TRIED} paths (seed {seed}) none reached the light and could be made out in a \
                         drawing"
                    )
                } else {
                    "No light leaves p after that many bounces: there is no light, or what the paths meet \
                     reflects none"
                        .into()
                };
                (
                    format!("No sampled paths of {word} bounces"),
                    format!(
                        "The room seen from the side. {why}. ωₒ leads from p to the eye, n is the normal."
                    ),
                )
            }
            Edition::Solution => (
                format!("{number} sampled {paths} of {word} bounces"),
                format!(
                    "The room seen from the side. Numbered paths, as they were sampled (seed {seed}), go \
                     from p in a direction ωᵢ to a point p₁, p₂, … on another face{} and on to the light, \
                     none through the cube; ωₒ leads from p to the eye. Short arrows are normals n. What \
                     looks short may lead far in depth.",
                    if bounces > 2 { ", from there to p₁′, p₂′, …" } else { "" }
                ),
            ),
        };
        Plot {
            name,
            title,
            description,
            edition,
            width: Width::Drawing,
            height_mm: HEIGHT_MM,
            columns: 1,
            panels,
        }
        .draw()
    }

    fn draw_room(&self, panel: &mut Panel, labels: &mut Labels) {
        let (w, h) = (Face::ROOM_HALF_WIDTH, Face::ROOM_HEIGHT);
        let (c, t) = (Face::CUBE_HALF_WIDTH, Face::CUBE_HEIGHT);
        let room = [[-w, 0.0], [w, 0.0], [w, h], [-w, h], [-w, 0.0]];
        let cube = [[-c, 0.0], [-c, t], [c, t], [c, 0.0]];
        panel.band("cube", Ink::Grey, [[-c, 0.0, t], [c, 0.0, t]]);
        panel.line("room", Ink::Black, room).line("cube", Ink::Black, cube);
        labels.avoid(&room);
        labels.avoid(&cube);
        let light = self.room.scene().light_half_width;
        if light > 0.0 {
            let (low, high) = (h - 0.03, h + 0.06);
            panel.band("light", Ink::Black, [[-light, low, high], [light, low, high]]);
            let outline = [[-light, low], [light, low], [light, high], [-light, high], [-light, low]];
            panel.line("light", Ink::Black, outline);
            labels.avoid(&outline);
        }
    }

    fn draw_path(
        &self,
        path: &Drawn,
        ink: Ink,
        number: &str,
        digit: &str,
        panel: &mut Panel,
        labels: &mut Labels,
    ) {
        panel.line(&format!("path {number}"), ink, path.line.iter().copied());
        if let [p, next, ..] = *path.line {
            let tip = direction(p, next, 0.8);
            draw_arrow(ink, direction(p, next, 0.55), tip, panel, labels);
            labels.place(panel, ink, tip, &format!("ωᵢ{digit}"));
            labels.place(panel, ink, [0.4 * p[0] + 0.6 * next[0], 0.4 * p[1] + 0.6 * next[1]], number);
        }
        for (vertex, prime) in path.vertices.iter().skip(1).zip(PRIMES) {
            self.draw_normal(vertex, panel, labels);
            panel.marks("p_j", ink, Marker::Disc, [self.seen(vertex.position())]);
            labels.place(panel, ink, self.seen(vertex.position()), &format!("p{digit}{prime}"));
        }
        panel.marks("point of the light", ink, Marker::Disc, path.line.last().copied());
    }

    /// The normal at a vertex, which is on a face seen edge on.
    fn draw_normal(&self, vertex: &Vertex, panel: &mut Panel, labels: &mut Labels) {
        let tip = self.tip_of_normal(vertex);
        draw_arrow(Ink::Grey, self.seen(vertex.position()), tip, panel, labels);
        labels.place(panel, Ink::Grey, tip, "n");
    }
}

/// An arrow, whose line and head labels must not cover.
fn draw_arrow(ink: Ink, from: [f64; 2], to: [f64; 2], panel: &mut Panel, labels: &mut Labels) {
    panel.arrow(ink, from, to);
    let length = distance(from, to).max(1e-9);
    let (x, y) = ((to[0] - from[0]) / length, (to[1] - from[1]) / length);
    // heads are 6 points long and 4.8 wide
    let barb = |aside: f64| [to[0] - (6.0 * x - aside * y) / SCALE, to[1] - (6.0 * y + aside * x) / SCALE];
    labels.avoid(&[from, to]);
    labels.avoid(&[barb(2.4), to, barb(-2.4), barb(2.4)]);
}
