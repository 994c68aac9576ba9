//! Radiance in the box room without random paths: closed forms, and quadrature of closed forms.
//!
//! The part of the light that is visible from p is a polygon: the light without what lies below p's horizon,
//! and without the cube's shadow, which is convex. The cube's top sees the walls above z = 1, from which the
//! whole light is visible, and the ceiling, which receives nothing as it lies in the light's plane.

use std::f64::consts::FRAC_1_PI;
use std::sync::LazyLock;

use glam::DVec3;

use super::{BoxRoom, Face, Vertex, form_factor};

impl BoxRoom {
    /// The radiance, in W m⁻² sr⁻¹, that comes from the light and leaves p after one bounce, L₁ = ρ L_e P:
    /// exact everywhere.
    ///
    /// P is the form factor of the visible part of the light: of the square above p's horizon without the
    /// cube's shadow on it, which is a convex polygon, too ([`form_factor`], after Lambert 1760).
    ///
    /// ```
    /// use unbiased::paths::room::{BoxRoom, Scene};
    ///
    /// // beside the cube, which hides a part of the light
    /// let room = BoxRoom::new(Scene { point: [0.7, 0.1, 0.0], ..Scene::default() })?;
    /// assert!(room.one_bounce() < room.direct(&room.point()));
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    pub fn one_bounce(&self) -> f64 {
        let p = self.point();
        self.albedo(&p) * self.scene().radiance * seen(self, &p)
    }

    /// The radiance, in W m⁻² sr⁻¹, that leaves p after two bounces, exact for p on the cube's top; `None`
    /// elsewhere.
    ///
    /// p sees the walls above the cube's height, from which the whole light is visible, and the ceiling,
    /// which lies in the light's plane and receives nothing. So it is
    ///
    /// > L₂ = (ρ/π) ∫ L₁(x) cos θ dω
    ///
    /// over the directions to these parts of the four walls, with L₁ = [`direct`](Self::direct), integrated
    /// by the Gauss–Legendre rule. Near the upper edge of a wall the irradiance from a close light varies
    /// rapidly, so the rule's cells shrink towards that edge. The relative error was 1e-12 at most for light
    /// half-widths from 0.5 to 2, the whole ceiling.
    ///
    /// ```
    /// use unbiased::paths::room::{BoxRoom, Scene};
    ///
    /// let room = BoxRoom::new(Scene::default())?;
    /// assert!((room.two_bounces().unwrap() - 0.039903921548169116).abs() < 1e-13);
    /// let floor = BoxRoom::new(Scene { point: [1.5, 0.0, 0.0], ..Scene::default() })?;
    /// assert_eq!(floor.two_bounces(), None);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    pub fn two_bounces(&self) -> Option<f64> {
        let p = self.point();
        let on_top = p.face() == Face::CubeTop;
        on_top.then(|| self.albedo(&p) * FRAC_1_PI * over_the_walls(self, |p_j, w| self.direct(p_j) * w.z))
    }
}

/// The fraction of the cosine-weighted hemisphere above a point that the light fills, without the cube's
/// shadow.
pub(crate) fn seen(room: &BoxRoom, vertex: &Vertex) -> f64 {
    let of = |corners: &[DVec3]| form_factor(corners, vertex.position(), vertex.normal());
    of(&room.light_corners()) - of(&shadow(room, vertex))
}

/// ∫ `f` dω over the directions from p, on the cube's top, to the walls. `f` is given the wall point and the
/// direction.
pub(crate) fn over_the_walls(room: &BoxRoom, f: impl Fn(&Vertex, DVec3) -> f64) -> f64 {
    let (p, w) = (room.point().position(), Face::ROOM_HALF_WIDTH);
    let (low, high) = (Face::CUBE_HEIGHT, Face::ROOM_HEIGHT);
    let beside = w - room.scene().light_half_width;
    let mut sum = 0.0;
    for (along, across) in [(DVec3::X, DVec3::Y), (DVec3::Y, DVec3::X)] {
        // cut where φ wraps around
        let middle = p.dot(along);
        for (side, end) in [(-w, -w), (-w, w), (w, -w), (w, w)] {
            for z in cells(beside.max(NEGLIGIBLE), high, low) {
                let height = z[1] - z[0];
                let strip = beside.max(high - z[1]).max(NEGLIGIBLE / height);
                for [from, to] in cells(strip, end, middle) {
                    let corner = |a: f64, z: f64| along * a + across * side + DVec3::Z * z;
                    let (a, b, c) = (corner(from, z[0]), corner(to, z[0]), corner(from, z[1]));
                    for [s, ws] in GAUSS.iter() {
                        for [t, wt] in GAUSS.iter() {
                            let point = a + (b - a) * *s + (c - a) * *t;
                            let Ok(p_j) = Vertex::at(point.to_array()) else { continue };
                            let (way, area) = (point - p, (to - from) * height);
                            let r = way.length();
                            let solid = area * p_j.normal().dot(-way) / (r * r * r);
                            sum += ws * wt * solid * f(&p_j, way / r);
                        }
                    }
                }
            }
        }
    }
    sum
}

/// An area of wall, in m², that adds nothing to the radiance at p, whatever the light.
const NEGLIGIBLE: f64 = 1e-12;

/// Cuts the interval between `end` and `other` into cells that shrink towards `end`, each given as \[low,
/// high\].
///
/// The irradiance on a wall from a light at the given `distance` is smooth, but has singularities at that
/// distance from the wall's edges and from the real axis. These are so far from each cell that 24 nodes have
/// an error of about 1e-14. For `distance` ≥ 1 the whole wall is one such cell.
fn cells(distance: f64, end: f64, other: f64) -> impl Iterator<Item = [f64; 2]> {
    let (first, length) = (if distance < 1.0 { 2.0 * distance } else { f64::INFINITY }, (other - end).abs());
    let mut from = 0.0;
    let lengths = std::iter::successors(Some(first), |to| Some(6.0 * to));
    let ends = lengths.take_while(move |to| *to < 0.6 * length).chain([length]);
    ends.map(move |to| {
        let [a, b] = [from, to].map(|x| if x == length { other } else { end + x.copysign(other - end) });
        from = to;
        [a.min(b), a.max(b)]
    })
}

/// The cube's shadow on the light: empty from z = 1 upwards, and for the cube's own sides, where the horizon
/// hides the same part.
fn shadow(room: &BoxRoom, vertex: &Vertex) -> Vec<DVec3> {
    let (o, c) = (vertex.position(), Face::CUBE_HALF_WIDTH);
    if o.z >= Face::CUBE_HEIGHT || vertex.face().is_cube() {
        return Vec::new();
    }
    // the cube's section, projected from o on to the ceiling, is at least `scale` times as large
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

/// The part of a convex polygon where the linear function `side` is not negative.
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

const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

const NODES: usize = 24;

/// Nodes and weights of the Gauss–Legendre rule on [0, 1].
static GAUSS: LazyLock<[[f64; 2]; NODES]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let n = NODES as f64;
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        // Newton's method on P_n: six steps are more than enough
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
