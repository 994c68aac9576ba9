//! The light after one bounce and after two, where it is known exactly.

use std::f64::consts::{FRAC_1_PI, PI};

use glam::DVec3;

use super::BoxRoom;
use super::face::{Face, Vertex};

impl BoxRoom {
    /// The light of the lamp that leaves p after one bounce, where the cube cannot hide any of it: on the cube itself, and from its height upwards. None elsewhere.
    pub fn one_bounce(&self) -> Option<f64> {
        let p = self.point();
        let clear = p.face().is_cube() || p.position().z >= Face::CUBE_HEIGHT;
        clear.then(|| self.direct(&p))
    }

    /// The light of the lamp that leaves p after two bounces, where it is known exactly: on the cube's top. None elsewhere.
    ///
    /// p sees the walls above the cube's height, which see the whole light, and the ceiling, which lies in the light's plane and gets none. So it is
    ///
    /// > L₂ = (ρ/π) Σ ∫ L₁(x) cos θ cos θₓ/r² dA
    ///
    /// over these parts of the four walls, with L₁ = [`direct`](Self::direct): smooth, and integrated by the Gauss–Legendre rule to about 1e-12 (1e-9 for
    /// a light that comes near the walls).
    pub fn two_bounces(&self) -> Option<f64> {
        let p = self.point();
        if p.face() != Face::CubeTop {
            return None;
        }
        let nodes = gauss_legendre();
        let from_wall = |face: Face| -> f64 {
            let [mut low, high] = face.bounds();
            low.z = Face::CUBE_HEIGHT;
            // one of the two is 0
            let across = DVec3::new(high.x - low.x, high.y - low.y, 0.0);
            let mut sum = 0.0;
            for (u, u_weight) in &nodes {
                for (v, v_weight) in &nodes {
                    // both ends drawn together with a power: a light near the wall makes its upper edge steep
                    let (z, slope) = (v * v * (3.0 - 2.0 * v), 6.0 * v * (1.0 - v));
                    let height = z * (high.z - low.z);
                    let x = Vertex::new(low + across * *u + DVec3::Z * height, face);
                    let way = x.position() - p.position();
                    let cosines = way.z * -x.normal().dot(way);
                    let r2 = way.length_squared();
                    sum += u_weight * v_weight * slope * self.direct(&x) * cosines / (r2 * r2);
                }
            }
            sum * across.length() * (high.z - low.z)
        };
        let walls = [Face::West, Face::East, Face::South, Face::North];
        Some(self.albedo(&p) * FRAC_1_PI * walls.into_iter().map(from_wall).sum::<f64>())
    }
}

/// The nodes and weights of the Gauss–Legendre rule of 32 points on [0, 1], by Newton's method from cosines (*Numerical Recipes*, 3rd ed., section 4.6).
fn gauss_legendre() -> Vec<(f64, f64)> {
    const POINTS: u32 = 32;
    let node = |i: u32| {
        let mut x = (PI * (f64::from(i) + 0.75) / (f64::from(POINTS) + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..10 {
            let (mut last, mut now) = (0.0, 1.0);
            for k in 0..POINTS {
                let k = f64::from(k);
                (last, now) = (now, ((2.0 * k + 1.0) * x * now - k * last) / (k + 1.0));
            }
            slope = f64::from(POINTS) * (x * now - last) / (x * x - 1.0);
            x -= now / slope;
        }
        (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..POINTS).map(node).collect()
}
