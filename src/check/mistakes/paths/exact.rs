//! Light in the box room without random paths: closed forms, and quadrature of closed forms.
//!
//! What p sees of the light is a polygon: the light, less what lies below p's horizon, less the cube's shadow, which is convex. From the cube's
//! top p sees the walls above z = 1 and the ceiling, which see the whole light; the ceiling gets none of it, being in its plane.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use crate::box_room::exact::{over_the_walls, seen};
use crate::box_room::{BoxRoom, Face, form_factor, nearest};
use crate::hemisphere::Hemisphere;

/// The widest light whose two-bounce part is known to 1e-10 for the wrong estimators, too: what they find is integrated over the light as well, from points of the walls near it.
const WIDEST: f64 = 1.0;

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

/// The part of the cosine-weighted hemisphere above p that the light's four mirror images in the walls fill: the chance that a cosine direction from the cube's top meets the light by way of
/// a mirror.
pub(super) fn seen_in_mirrors(room: &BoxRoom) -> f64 {
    let (p, across) = (room.point(), 2.0 * Face::ROOM_HALF_WIDTH);
    let walls = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
    let image = |[x, y]: [f64; 2]| room.light_corners().map(|corner| corner + DVec3::new(x, y, 0.0) * across);
    walls.map(|wall| form_factor(&image(wall), p.position(), p.normal())).iter().sum()
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
