//! What tests share: seeds, proptest's settings, numbers of every kind, comparisons that say what they give
//! in false alarms, quadrature, a furnace and a generator that is stuck.
#![allow(dead_code, unused_imports)] // each test takes what it needs

mod alarms;
#[cfg(feature = "workbook")]
pub mod drawn;
pub mod rivals;
pub mod notebook;
pub mod programs;

pub use alarms::{BUDGETS, alarm, deviations};
use std::f64::consts::{PI, TAU};

use glam::DVec3;
use proptest::prelude::*;
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::paths::room::{Face, Scene, Vertex};

/// Fixed by default; `UNBIASED_SEED=n` gives the whole suite fresh ones.
pub fn seed(n: u64) -> u64 {
    let fresh: u64 = std::env::var("UNBIASED_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(0);
    n.wrapping_add(fresh.wrapping_mul(1_000_003))
}

/// Set by `tests/mutants`, where a mutant is to cost seconds.
pub fn mutation() -> bool {
    std::env::var_os("UNBIASED_MUTATION").is_some()
}

/// So many draws; under mutation, a twentieth.
pub fn draws(n: u64) -> u64 {
    if mutation() { n.div_ceil(20) } else { n }
}

/// proptest's settings: as many cases as asked for, the same ones on every run; under mutation a tenth, but
/// not below 100.
pub fn config(cases: u32) -> proptest::test_runner::Config {
    proptest::test_runner::Config {
        cases: if mutation() { cases.min(cases.div_ceil(10).max(100)) } else { cases },
        rng_seed: proptest::test_runner::RngSeed::Fixed(seed(1)),
        failure_persistence: None,
        ..Default::default()
    }
}

/// 1 − 2⁻⁵³, the largest number below 1.
pub const NEARLY_ONE: f64 = 1.0 - 0.5 * f64::EPSILON;

/// Any bits.
pub fn any_bits() -> impl Strategy<Value = f64> {
    any::<u64>().prop_map(f64::from_bits)
}

/// Any bits, numbers of every size, and the edges themselves with their neighbours.
pub fn any_number() -> impl Strategy<Value = f64> {
    let edges = [0.0, -0.0, 0.25, 0.5, 1.0, 2.0, f64::MIN_POSITIVE, f64::MAX, f64::INFINITY, f64::NAN];
    let neighbours = edges.into_iter().flat_map(|x: f64| [x, x.next_up(), x.next_down(), -x]);
    prop_oneof![
        any_bits(),
        (-320.0..308.0f64).prop_map(|power| 10f64.powf(power)),
        -3.0..3.0f64,
        proptest::sample::select(neighbours.collect::<Vec<f64>>()),
    ]
}

/// Any bits in [0, 1]: all sizes alike, anywhere, near 1, near ½, and the ends.
pub fn probability() -> impl Strategy<Value = f64> {
    prop_oneof![
        (0..=1f64.to_bits()).prop_map(f64::from_bits),
        0.0..=1.0f64,
        (0.0..54.0f64).prop_map(|power| 1.0 - 2f64.powf(-power)),
        (1.0..54.0f64, any::<bool>()).prop_map(|(power, up)| {
            let off = 2f64.powf(-power);
            if up { 0.5 + off } else { 0.5 - off }
        }),
        proptest::sample::select(vec![0.0, f64::from_bits(1), 0.5, NEARLY_ONE, 1.0]),
    ]
}

/// How many `f64` lie between.
pub fn ulps(a: f64, b: f64) -> u64 {
    let rank = |x: f64| if x.is_sign_negative() { -(x.abs().to_bits() as i64) } else { x.to_bits() as i64 };
    if a.is_nan() || b.is_nan() { u64::MAX } else { rank(a).abs_diff(rank(b)) }
}

/// How far from 1 the length of a direction is, in ulp of 1.
pub fn ulps_off_unit(direction: &Direction) -> f64 {
    // |v|² − 1 = Σ (x² − share) with each square and its rounding
    let mut terms = vec![-1.0];
    for x in direction.vector().to_array() {
        terms.extend([x * x, x.mul_add(x, -(x * x))]);
    }
    terms.sort_by(|a: &f64, b: &f64| b.abs().total_cmp(&a.abs()));
    0.5 * terms.iter().sum::<f64>().abs() / f64::EPSILON
}

/// sup |Fₙ − F| of the sample, and how far it may be from 0: with probability 1 − 1e-12, √(ln(2e12)/2n) at
/// most, whatever n (Dvoretzky, Kiefer & Wolfowitz; Massart 1990).
pub fn dkw(mut sample: Vec<f64>, cdf: impl Fn(f64) -> f64) -> (f64, f64) {
    alarm(1e-12);
    sample.sort_by(f64::total_cmp);
    let n = sample.len() as f64;
    let off = sample.iter().enumerate().fold(0.0, |off: f64, (i, &x)| {
        let (f, below, above) = (cdf(x), i as f64 / n, (i + 1) as f64 / n);
        // a NaN anywhere stays NaN, which no bound lets pass
        let here = (f - below).abs().max((above - f).abs());
        if here <= off { off } else { here }
    });
    (off, ((2.0f64 / 1e-12).ln() / (2.0 * n)).sqrt())
}

/// Nodes and weights of Gauss and Legendre on [0, 1], by Newton's iteration.
pub fn gauss(n: usize) -> Vec<(f64, f64)> {
    let node = |i: usize| {
        let mut x = ((i as f64 + 0.75) / (n as f64 + 0.5) * PI).cos();
        let mut slope = 0.0;
        for _ in 0..100 {
            let (mut p, mut before) = (x, 1.0);
            for k in 2..=n {
                let k = k as f64;
                (p, before) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k, p);
            }
            slope = n as f64 * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
            if (p / slope).abs() < 1e-16 {
                break;
            }
        }
        (0.5 * (x + 1.0), 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(node).collect()
}

/// Howell, *A Catalog of Radiation Heat Transfer Configuration Factors*, B-3: an element under the corner of
/// a parallel rectangle a × b at the distance c; odd in a and b.
pub fn howell_parallel(a: f64, b: f64, c: f64) -> f64 {
    let (x, y) = (a / c, b / c);
    let (sx, sy) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    (x / sx * (y / sx).atan() + y / sy * (x / sy).atan()) / (2.0 * PI)
}

/// B-4: an element on a plane at right angles to the rectangle's, which starts above the element: a away from
/// the element's plane, b along it, c high; odd in b.
fn howell_perpendicular(a: f64, b: f64, c: f64) -> f64 {
    let s = a.hypot(c);
    ((b / c).atan() - c / s * (b / s).atan()) / (2.0 * PI)
}

/// The part of a vertex's hemisphere that a light of this half-width fills, if nothing hides it.
pub fn part_of_the_sky(vertex: &Vertex, h: f64) -> f64 {
    let ([x, y, z], n) = (vertex.position().to_array(), vertex.normal());
    let c = 4.0 - z;
    if n.z > 0.5 {
        return howell_parallel(h - x, h - y, c)
            + howell_parallel(h + x, h - y, c)
            + howell_parallel(h - x, h + y, c)
            + howell_parallel(h + x, h + y, c);
    }
    if n.z < -0.5 {
        return 0.0;
    }
    // along the normal, and across it
    let (own, across) = if n.x == 0.0 { (y * n.y, x) } else { (x * n.x, y) };
    let [near, far] = [-h - own, h - own].map(|distance| distance.max(0.0));
    let strip = |a: f64| howell_perpendicular(a, h - across, c) + howell_perpendicular(a, h + across, c);
    strip(far) - strip(near)
}

/// The variance of xy over an Owen-scrambled (0, m, 2)-net of n = 2ᵐ points on the unit square about the
/// origin. With N(j, k) = n max(1, 2^(m−j−k)) ordered pairs of points that share a cell of 2⁻ʲ × 2⁻ᵏ, the
/// gain of level (j, k) is \[4N(j+1, k+1) − 2N(j+1, k) − 2N(j, k+1) + N(j, k)\]/n = 0 up to j + k = m − 2,
/// then 2, then 1 (Owen 1997); xy has the variance 4^(−j−k)/256 there, j + k = K comes K + 1 times, and the
/// sum is this.
pub fn net_variance_of_xy(m: u32) -> f64 {
    (28.0 * f64::from(m) / 3.0 + 16.0 / 9.0) / 256.0 / 8f64.powi(m as i32)
}

/// Asserts that so large a share of n runs may be one whose probability lies in `range`: by Chernoff's bound
/// a right one is beyond with less than α.
pub fn is_share(what: &str, share: f64, n: u64, [low, high]: [f64; 2], alpha: f64) {
    alarm(alpha);
    let p = share.clamp(low, high);
    let term = |x: f64, y: f64| if x > 0.0 { x * (x / y).ln() } else { 0.0 };
    let entropy = term(share, p) + term(1.0 - share, 1.0 - p);
    assert!(n as f64 * entropy <= (2.0 / alpha).ln(), "{what}: {share} of {n} runs");
}

/// A room without a light in which every face emits 1 and reflects so much.
pub fn furnace(albedo: f64) -> Scene {
    Scene {
        wall_albedo: albedo,
        cube_albedo: albedo,
        light_half_width: 0.0,
        emission: 1.0,
        ..Default::default()
    }
}

/// The corners of a face, as the worksheet's picture has them: the room's faces look inwards, the cube's
/// outwards.
pub fn bounds(face: Face) -> [DVec3; 2] {
    let [low, high] = if is_cube(face) {
        [[-0.5, -0.5, 0.0], [0.5, 0.5, 1.0]]
    } else {
        [[-2.0, -2.0, 0.0], [2.0, 2.0, 4.0]]
    };
    let (mut ends, n) = ([low, high].map(DVec3::from_array), face.normal());
    for axis in (0..3).filter(|axis| n[*axis] != 0.0) {
        let upper = is_cube(face) == (n[axis] > 0.0);
        let at = ends[usize::from(upper)][axis];
        ends = ends.map(|mut end| {
            end[axis] = at;
            end
        });
    }
    ends
}

/// Whether a face is one of the cube's five.
pub fn is_cube(face: Face) -> bool {
    Face::ALL[..5].contains(&face)
}

/// A point at these fractions of a face's sides, if it is one of the face's own: no edge's and none under the
/// cube.
pub fn on_face(face: Face, u: DVec3) -> Option<Vertex> {
    let [low, high] = bounds(face);
    // low + 0·u is low exactly
    Vertex::at((low + (high - low) * u).to_array()).ok().filter(|vertex| vertex.face() == face)
}

/// A point on one of the faces, all faces alike.
pub fn any_point(rng: &mut unbiased::Stream) -> Vertex {
    let face = Face::ALL[(rng.uniform() * 11.0) as usize];
    loop {
        let u = DVec3::from_array([(); 3].map(|()| rng.uniform()));
        if let Some(vertex) = on_face(face, u) {
            return vertex;
        }
    }
}

/// Anywhere on the sphere.
pub fn any_direction(rng: &mut unbiased::Stream) -> DVec3 {
    let (z, phi) = (2.0 * rng.uniform() - 1.0, 2.0 * PI * rng.uniform());
    let sin = (1.0 - z * z).sqrt();
    DVec3::new(sin * phi.cos(), sin * phi.sin(), z)
}

/// The next number of each of the next draws.
pub fn fill_uniform(rng: &mut unbiased::Stream, uniforms: &mut [f64]) {
    unbiased::Estimator::fill(&unbiased::from_uniforms(|[u]| u), rng, uniforms);
}

/// A generator of one word for ever.
pub struct Stuck(pub u64);

impl rand::TryRng for Stuck {
    type Error = std::convert::Infallible;

    fn try_next_u32(&mut self) -> Result<u32, std::convert::Infallible> {
        Ok((self.0 >> 32) as u32)
    }

    fn try_next_u64(&mut self) -> Result<u64, std::convert::Infallible> {
        Ok(self.0)
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), std::convert::Infallible> {
        bytes.fill(self.0 as u8);
        Ok(())
    }
}

/// Compares drawn directions with the density claimed for them.
pub fn directions(
    sampler: &impl rand::distr::Distribution<Direction>,
    claimed: Hemisphere,
    deviation: f64,
    alpha: f64,
    seed: u64,
) -> unbiased::Result<unbiased::check::Agreement> {
    // P(cos θ ≤ c) is c or c²
    let power = if claimed == Hemisphere::Uniform { 1 } else { 2 };
    let unwarp = |w: &Direction| [w.cos_theta().max(0.0).powi(power), w.phi() / TAU];
    unbiased::check::points(sampler, unwarp, deviation, alpha, seed)
}
