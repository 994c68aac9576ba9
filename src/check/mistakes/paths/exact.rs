//! Light in the box room without random paths: closed forms, and quadrature of closed forms.
//!
//! What p sees of the light is a polygon: the light, less what lies below p's horizon, less the cube's shadow, which is convex. From the cube's
//! top p sees the walls above z = 1 and the ceiling, which see the whole light; the ceiling gets none of it, being in its plane.

use std::f64::consts::FRAC_1_PI;
use std::sync::LazyLock;

use glam::DVec3;

use crate::box_room::{BoxRoom, Face, Vertex, form_factor, nearest};
use crate::hemisphere::Hemisphere;

/// The widest light whose two-bounce part the rules below integrate to 1e-10.
const WIDEST: f64 = 1.0;

const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// Whether the light after k bounces is known exactly (by quadrature: to 1e-10).
pub(super) fn is_known(room: &BoxRoom, k: u32) -> bool {
    let scene = room.scene();
    let on_top = room.point().face() == Face::CubeTop;
    let furnace = scene.light_half_width == 0.0;
    match k {
        0 => true,
        1 => furnace || scene.emission == 0.0,
        2 if on_top => furnace || (scene.emission == 0.0 && scene.light_half_width <= WIDEST),
        _ => furnace && scene.wall_albedo == scene.cube_albedo,
    }
}

/// The light after k bounces; where it is not known, by quasi-random directions to 1e-3 or so.
pub(super) fn after(room: &BoxRoom, k: u32) -> f64 {
    let (scene, p) = (room.scene(), room.point());
    if k == 0 {
        return room.emitted(&p);
    }
    if !is_known(room, k) {
        return by_lattice(room, k);
    }
    if scene.light_half_width == 0.0 {
        return scene.emission * (0..k).map(|j| albedo(room, j)).product::<f64>();
    }
    let reflected = room.albedo(&p) * scene.radiance;
    match k {
        1 => reflected * seen(room, &p),
        _ => reflected * albedo(room, 1) * over_the_walls(room, |p_j, w| seen(room, p_j) * w.z * FRAC_1_PI),
    }
}

/// The albedo at a path's vertex j, where that does not depend on the path.
pub(super) fn albedo(room: &BoxRoom, vertex: u32) -> f64 {
    if vertex == 0 { room.albedo(&room.point()) } else { room.scene().wall_albedo }
}

/// The part of the cosine-weighted hemisphere above a point that the light fills, the cube's shadow taken off.
pub(super) fn seen(room: &BoxRoom, vertex: &Vertex) -> f64 {
    let of = |corners: &[DVec3]| form_factor(corners, vertex.position(), vertex.normal());
    of(&room.light_corners()) - of(&shadow(room, vertex))
}

/// The same for the light's four mirror images in the walls: the chance that a cosine direction from the cube's top meets the light by way of
/// a mirror.
pub(super) fn seen_in_mirrors(room: &BoxRoom) -> f64 {
    let (p, across) = (room.point(), 2.0 * Face::ROOM_HALF_WIDTH);
    let walls = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
    let image = |[x, y]: [f64; 2]| room.light_corners().map(|corner| corner + DVec3::new(x, y, 0.0) * across);
    walls.map(|wall| form_factor(&image(wall), p.position(), p.normal())).iter().sum()
}

/// ∫ `f` dA over what a point sees of the light, `shadowed` or as if the cube hid nothing.
pub(super) fn over_the_light(
    room: &BoxRoom,
    vertex: &Vertex,
    shadowed: bool,
    f: impl Fn(DVec3) -> f64,
) -> f64 {
    let above = |corners: &[DVec3]| {
        let rise = |y: DVec3| vertex.normal().dot(y - vertex.position());
        over_polygon(&cut(corners, rise), &f)
    };
    above(&room.light_corners()) - if shadowed { above(&shadow(room, vertex)) } else { 0.0 }
}

/// ∫ `f` dω over the directions from p, on the cube's top, to the walls, whose points f is given, too.
pub(super) fn over_the_walls(room: &BoxRoom, f: impl Fn(&Vertex, DVec3) -> f64) -> f64 {
    let (p, w) = (room.point().position(), Face::ROOM_HALF_WIDTH);
    let mut sum = 0.0;
    for (along, across) in [(DVec3::X, DVec3::Y), (DVec3::Y, DVec3::X)] {
        // cut where φ begins anew
        let middle = p.dot(along);
        for (side, [from, to]) in [(-w, [-w, middle]), (-w, [middle, w]), (w, [-w, middle]), (w, [middle, w])]
        {
            let corner = |a: f64, z: f64| along * a + across * side + DVec3::Z * z;
            let (low, high) = (Face::CUBE_HEIGHT, Face::ROOM_HEIGHT);
            let (a, b, c) = (corner(from, low), corner(to, low), corner(from, high));
            for [s, ws] in GAUSS.iter() {
                for [t, wt] in GAUSS.iter() {
                    let point = a + (b - a) * *s + (c - a) * *t;
                    let Ok(p_j) = Vertex::at(point.to_array()) else { continue };
                    let (way, area) = (point - p, (to - from) * (high - low));
                    let r = way.length();
                    let solid = area * p_j.normal().dot(-way) / (r * r * r);
                    sum += ws * wt * solid * f(&p_j, way / r);
                }
            }
        }
    }
    sum
}

/// ∫₀¹ `f`.
pub(super) fn over_the_unit(f: impl Fn(f64) -> f64) -> f64 {
    GAUSS.iter().map(|[x, w]| w * f(*x)).sum()
}

/// What the cube hides of the light: empty from z = 1 upwards, and from the cube's own sides, where the horizon hides the same.
fn shadow(room: &BoxRoom, vertex: &Vertex) -> Vec<DVec3> {
    let (o, c) = (vertex.position(), Face::CUBE_HALF_WIDTH);
    if o.z >= Face::CUBE_HEIGHT || vertex.face().is_cube() {
        return Vec::new();
    }
    // the cube's section, seen from o, is thrown on to the ceiling at least `scale` times as large
    let scale = (Face::ROOM_HEIGHT - o.z) / (Face::CUBE_HEIGHT - o.z);
    let mut hidden = room.light_corners().to_vec();
    for axis in [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y] {
        let beyond = o.dot(axis) - c;
        if beyond > 0.0 {
            hidden = cut(&hidden, |y| -(y - o).dot(axis) - scale * beyond);
        }
    }
    // and lies between the two vertical planes through o that touch the cube
    let corners = CORNERS.map(|[x, y]| DVec3::new(c * x, c * y, 0.0));
    let turn = |a: DVec3, b: DVec3| (a - o).truncate().perp_dot((b - o).truncate());
    for corner in corners {
        for sense in [1.0, -1.0] {
            if corners.iter().all(|other| sense * turn(corner, *other) >= 0.0) {
                hidden = cut(&hidden, |y| sense * turn(corner, y));
            }
        }
    }
    hidden
}

/// What is left of a convex polygon where `side` is not negative; it is linear.
fn cut(corners: &[DVec3], side: impl Fn(DVec3) -> f64) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let (here, there) = (side(*a), side(*b));
        if here >= 0.0 {
            kept.push(*a);
        }
        if (here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0) {
            kept.push(*a + (*b - *a) * (here / (here - there)));
        }
    }
    kept
}

/// ∫ `f` over a convex polygon, cut into triangles from its first corner.
fn over_polygon(corners: &[DVec3], f: impl Fn(DVec3) -> f64) -> f64 {
    let [first, rest @ ..] = corners else { return 0.0 };
    let mut sum = 0.0;
    for (b, c) in rest.iter().zip(rest.iter().skip(1)) {
        let (b, c) = (*b - *first, *c - *first);
        let area = b.cross(c).length();
        for [s, ws] in GAUSS.iter() {
            for [t, wt] in GAUSS.iter() {
                sum += ws * wt * s * area * f(*first + (b + (c - b) * *t) * *s);
            }
        }
    }
    sum
}

/// Points of the quasi-random rule, and its step: powers of 1/x with x⁵ = x + 1, equidistributed in four dimensions.
const POINTS: u32 = 1 << 17;
const STEP: f64 = 0.856_674_883_854_502_9;

/// The light after k bounces: what is reflected at once at the last of k vertices, in closed form, averaged over directions to get there.
fn by_lattice(room: &BoxRoom, k: u32) -> f64 {
    let mut sum = 0.0;
    for point in 1..=POINTS {
        let (mut vertex, mut weight, mut step) = (room.point(), 1.0, 1.0);
        let mut next = || {
            step *= STEP;
            (f64::from(point) * step).fract()
        };
        for _ in 1..k {
            let Ok(direction) = Hemisphere::Cosine.direction_of(next(), next()) else { continue };
            weight *= room.albedo(&vertex);
            vertex = nearest(vertex.position(), vertex.to_room(&direction));
        }
        let from_faces = room.scene().emission;
        let from_light = if room.albedo(&vertex) > 0.0 { seen(room, &vertex) } else { 0.0 };
        let arrives = room.scene().radiance * from_light + from_faces * (1.0 - from_light);
        sum += weight * room.albedo(&vertex) * arrives;
    }
    sum / f64::from(POINTS)
}

const NODES: usize = 16;

/// Gauss and Legendre's nodes and weights on [0, 1].
static GAUSS: LazyLock<[[f64; 2]; NODES]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let n = NODES as f64;
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        // Newton's steps on P_n: six are more than enough
        for _ in 0..6 {
            let (mut before, mut value) = (1.0, x);
            for j in 2..=NODES {
                let j = j as f64;
                (before, value) = (value, ((2.0 * j - 1.0) * x * value - (j - 1.0) * before) / j);
            }
            slope = n * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        [0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope)]
    })
});
