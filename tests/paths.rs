//! Section 4's paths, held to a ladder of truths: the furnace, direct light, two bounces, the balance of
//! energy, every way against every other.
//!
//! # What a test catches
//! Where a draw is a function of a few numbers, these are put in: Gauss's nodes where it is smooth, which
//! leaves rounding, and two random points in each of very many cells where it has jumps, whose differences
//! give the error bar. Such a bar, and that of plain draws, may be missed by 8 std errors (1.2e-15,
//! two-sided); a bias of 11 is caught in all runs but one in a thousand. Every comparison with an error bar
//! prints the bias that it would catch, and fails if that is more than 1e-3 of the truth: direct light,
//! shadows, two bounces (the light sampled or found by chance; paths one by one and side by side), the
//! furnace without a limit, the balance of energy (faces that emit, and the lamp alone), the worksheet's
//! cumulative values, and every way against all others together, whose error is part of the 1e-3. What
//! roulette ends is seen as a part of all light, what p itself emits included. About 100 comparisons: 1.2e-13
//! a run. With `UNBIASED_MUTATION` the cumulative values catch 5e-3.

mod common;

use common::{furnace, gauss, howell_parallel, howell_perpendicular};
use std::f64::consts::{FRAC_1_PI, PI};

use glam::DVec3;
use rand::distr::Distribution;
use rayon::prelude::*;
use unbiased::lambertian::Lambertian;
use unbiased::lambertian::hemisphere::Hemisphere;
use unbiased::paths::room::{BoxRoom, Face, Scene, Vertex, nearest_hit, visible};
use unbiased::paths::{Bounces, FindLight, Paths, reflected};
use unbiased::{Budget, Estimate, Estimator, Stream, estimate, from_fn};

use Bounces::{All, AllByThroughput, Exactly, UpTo};
use FindLight::{ByChance, BySampling};
use Hemisphere::{Cosine, Uniform};

const WAYS: [(Hemisphere, FindLight); 4] =
    [(Cosine, BySampling), (Uniform, BySampling), (Cosine, ByChance), (Uniform, ByChance)];

fn room(scene: Scene) -> BoxRoom {
    BoxRoom::new(scene).unwrap()
}

fn paths(scene: Scene, bounces: Bounces, (directions, light): (Hemisphere, FindLight)) -> Paths {
    Paths::new(room(scene), bounces, directions, light).unwrap()
}

// ---- estimates with error bars
// -------------------------------------------------------------------------------------

/// A mean and its standard error.
#[derive(Debug, Clone, Copy)]
struct Found {
    mean: f64,
    std_error: f64,
}

impl Found {
    /// Holds it against a truth known to within `off`, and says which bias it would have caught.
    fn assert(self, truth: f64, off: f64, caught: f64, what: &str) {
        let allowed = common::deviations(8.0) * self.std_error + off + 1e-13 * truth;
        let bias = (11.0 * self.std_error + off) / truth;
        println!("{what}: {:.8} for {truth:.8}, catches {bias:.1e}", self.mean);
        assert!((self.mean - truth).abs() <= allowed, "{what}: {self:?} for {truth}");
        assert!(bias <= caught, "{what}: a bias of {bias:e} would pass");
    }

    fn agrees(self, other: Self, caught: f64, what: &str) {
        let std_error = self.std_error.hypot(other.std_error);
        Self { std_error, ..self }.assert(other.mean, 0.0, caught, what);
    }
}

impl From<Estimate> for Found {
    fn from(estimate: Estimate) -> Self {
        Self { mean: estimate.mean(), std_error: estimate.std_error().unwrap() }
    }
}

fn plain(estimator: &impl Estimator, draws: u64, seed: u64) -> Found {
    estimate(estimator, Budget::Draws(draws), common::seed(seed)).unwrap().into()
}

/// The cells of the unit cube of d dimensions, cut into `side` on each: those whose last number is in the
/// n-th part. The lowest corner of each, in cells.
fn cells(dimensions: u32, side: u64, part: u64) -> impl Iterator<Item = [f64; 4]> {
    let last = dimensions as usize - 1;
    let mut corner = [0.0; 4];
    corner[last] = part as f64;
    (0..side.pow(dimensions - 1)).map(move |_| {
        let this = corner;
        for x in &mut corner[..last] {
            *x += 1.0;
            if *x < side as f64 {
                break;
            }
            *x = 0.0;
        }
        this
    })
}

/// From the sums of all parts, of means and of squared differences by four.
fn over_cells(parts: &[[f64; 2]], cells: u64) -> Found {
    let [sum, squares] = parts.iter().fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
    Found { mean: sum / cells as f64, std_error: squares.sqrt() / cells as f64 }
}

/// Two random points in each of `side`ᵈ cells of the unit cube of d dimensions, of whose numbers a draw is a
/// function.
fn in_cells(estimator: &impl Estimator, dimensions: u32, side: u64, seed: u64) -> Found {
    let d = dimensions as usize;
    let parts: Vec<[f64; 2]> = (0..side)
        .into_par_iter()
        .map(|part| {
            let mut rng = Stream::new(common::seed(seed), part);
            let (mut sum, mut squares) = (0.0, 0.0);
            for corner in cells(dimensions, side, part) {
                let mut draw = || {
                    let point = corner.map(|low| (low + rng.uniform()) / side as f64);
                    let mut script = Stream::scripted(&point[..d]);
                    let x = estimator.draw(&mut script);
                    assert!(script.random_numbers() <= dimensions.into(), "more numbers than thought");
                    x
                };
                let (a, b) = (draw(), draw());
                sum += 0.5 * (a + b);
                squares += 0.25 * (a - b) * (a - b);
            }
            [sum, squares]
        })
        .collect();
    over_cells(&parts, side.pow(dimensions))
}

/// The same for paths that are filled, thirty-two at a time.
fn filled_in_cells(paths: &Paths, dimensions: u32, side: u64, seed: u64) -> Found {
    const TOGETHER: usize = 32;
    let d = dimensions as usize;
    let parts: Vec<[f64; 2]> = (0..side)
        .into_par_iter()
        .map(|part| {
            let mut rng = Stream::new(common::seed(seed), part);
            let (mut sum, mut squares) = (0.0, 0.0);
            let mut cells = cells(dimensions, side, part);
            loop {
                let mut script = Vec::new();
                for corner in cells.by_ref().take(TOGETHER / 2) {
                    for _ in 0..2 {
                        script.extend(corner[..d].iter().map(|low| (low + rng.uniform()) / side as f64));
                    }
                }
                if script.is_empty() {
                    return [sum, squares];
                }
                let mut draws = vec![0.0; script.len() / d];
                let mut rng = Stream::scripted(&script);
                paths.fill(&mut rng, &mut draws);
                assert_eq!(rng.random_numbers() as usize, script.len(), "other numbers than thought");
                for pair in draws.chunks_exact(2) {
                    sum += 0.5 * (pair[0] + pair[1]);
                    squares += 0.25 * (pair[0] - pair[1]).powi(2);
                }
            }
        })
        .collect();
    over_cells(&parts, side.pow(dimensions))
}

/// Two random points in as many cells as it takes to catch this bias, from `side`ᵈ on.
fn held(
    estimator: &impl Estimator,
    dimensions: u32,
    side: u64,
    seed: u64,
    truth: f64,
    caught: f64,
    what: &str,
) {
    held_by(|side| in_cells(estimator, dimensions, side, seed), dimensions, side, truth, caught, what);
}

fn held_by(
    in_cells: impl Fn(u64) -> Found,
    dimensions: u32,
    mut side: u64,
    truth: f64,
    caught: f64,
    what: &str,
) {
    let mut found = in_cells(side);
    for _ in 0..4 {
        let short = 11.5 * found.std_error / (caught * truth);
        if short <= 1.0 {
            break;
        }
        // with jumps half an order better than without cells, where it is smooth a whole one
        let order = f64::from(dimensions) / 2.0 + 0.8;
        side = (side as f64 * short.powf(1.0 / order) * 1.03) as u64 + 1;
        found = in_cells(side);
    }
    found.assert(truth, 0.02 * caught * truth, caught, &format!("{what} in {side}^{dimensions} cells"));
}

// ---- truths by other means
// -----------------------------------------------------------------------------------------

/// The part of a vertex's hemisphere that a light of this half-width fills, if nothing hides it.
fn seen(vertex: &Vertex, h: f64) -> f64 {
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

/// The part of two bounces at (x, y, 1) on the cube's top for albedos of 1 and a radiance of 1: over the
/// walls above z = 1, which see the whole light.
fn two_bounces(x: f64, y: f64, h: f64) -> f64 {
    let rule = gauss(16);
    // finer towards the ceiling, near whose edge the light may be
    let mut heights = vec![1.0, 2.0, 3.0];
    heights.extend((0..24).map(|i| 4.0 - 0.5f64.powi(i)).skip(1));
    heights.push(4.0);
    let mut sum = 0.0;
    for (own, across, wall) in
        [(x, y, [1.0, 0.0]), (-x, y, [-1.0, 0.0]), (y, x, [0.0, 1.0]), (-y, x, [0.0, -1.0])]
    {
        for ends in heights.windows(2) {
            for part in 0..32 {
                for (s, ws) in &rule {
                    for (t, wt) in &rule {
                        let z = ends[0] + (ends[1] - ends[0]) * s;
                        let along = -2.0 + (f64::from(part) + t) / 8.0;
                        let at = if wall[1] == 0.0 {
                            [2.0 * wall[0], along, z]
                        } else {
                            [along, 2.0 * wall[1], z]
                        };
                        let (up, away) = (z - 1.0, 2.0 - own);
                        let r2 = up * up + away * away + (along - across).powi(2);
                        let area = ws * wt * (ends[1] - ends[0]) / 8.0;
                        sum += area * seen(&wall_vertex(at), h) * up * away / (r2 * r2);
                    }
                }
            }
        }
    }
    sum * FRAC_1_PI
}

/// A point on a wall, not on the edge that it may be rounded to.
fn wall_vertex([x, y, z]: [f64; 3]) -> Vertex {
    Vertex::at([x, y, z.min(4f64.next_down())]).unwrap()
}

/// The part of the hemisphere above (x, y, 0) that the light fills beside the cube's shadow: seen from the
/// floor, a light's point is hidden if the way to it crosses the square [−½, ½]² before it has risen to z =
/// 1. Gauss over each piece, cut where the shadow begins and ends.
fn seen_from_floor(x: f64, y: f64, h: f64) -> f64 {
    let hidden = |lx: f64, ly: f64| {
        // slabs in the plane, over the first quarter of the way
        let (mut from, mut to) = (0.0f64, 0.25f64);
        for (origin, target) in [(x, lx), (y, ly)] {
            let way = target - origin;
            if way == 0.0 {
                if origin.abs() >= 0.5 {
                    return false;
                }
                continue;
            }
            let (a, b) = ((-0.5 - origin) / way, (0.5 - origin) / way);
            from = from.max(a.min(b));
            to = to.min(a.max(b));
        }
        from < to
    };
    let rule = gauss(8);
    let row = |ly: f64| {
        let mut ends = vec![-h];
        for i in 0..200 {
            let (mut a, mut b) = (-h + h * f64::from(i) / 100.0, -h + h * f64::from(i + 1) / 100.0);
            if hidden(a, ly) != hidden(b, ly) {
                for _ in 0..50 {
                    let middle = 0.5 * (a + b);
                    if hidden(middle, ly) == hidden(a, ly) { a = middle } else { b = middle }
                }
                ends.push(a);
            }
        }
        ends.push(h);
        let mut sum = 0.0;
        for piece in ends.windows(2) {
            let (low, width) = (piece[0], piece[1] - piece[0]);
            if !hidden(low + 0.5 * width, ly) {
                sum += rule
                    .iter()
                    .map(|(t, w)| {
                        let r2 = (low + width * t - x).powi(2) + (ly - y).powi(2) + 16.0;
                        w * width * 16.0 / (r2 * r2)
                    })
                    .sum::<f64>();
            }
        }
        sum
    };
    let rows = 400;
    let step = 2.0 * h / f64::from(rows);
    let sum: f64 = (0..rows)
        .flat_map(|i| rule.iter().map(move |(t, w)| (i, *t, *w)))
        .map(|(i, t, w)| w * step * row(-h + (f64::from(i) + t) * step))
        .sum();
    sum * FRAC_1_PI
}

#[test]
fn truths_are_the_worksheets() {
    let p = Vertex::at([0.0, 0.0, 1.0]).unwrap();
    assert!((8.0 * seen(&p, 0.5) - 0.2728543591976926).abs() <= 1e-15);
    let two = 4.0 * two_bounces(0.0, 0.0, 0.5);
    assert!((two / 0.039903921548169116 - 1.0).abs() <= 1e-10, "{two}");
    // where nothing is hidden the floor sees what Howell says
    let far = Vertex::at([1.7, 0.2, 0.0]).unwrap();
    assert!((seen_from_floor(1.7, 0.2, 1.0) / seen(&far, 1.0) - 1.0).abs() <= 1e-12);
}

/// One bounce is known everywhere, also where the cube hides some of the light; two on the cube's top, by the
/// quadrature here.
#[test]
fn the_rooms_closed_forms_are_the_quadratures() {
    for (h, x, y, closeness) in [(0.5, 0.0, 0.0, 1e-11), (1.3, 0.21, -0.43, 1e-11), (1.9, -0.37, 0.12, 1e-11)]
    {
        let scene = Scene {
            wall_albedo: 0.61,
            cube_albedo: 0.37,
            light_half_width: h,
            radiance: 7.0,
            point: [x, y, 1.0],
            ..Scene::default()
        };
        let (one, two) = (room(scene).one_bounce(), room(scene).two_bounces().unwrap());
        let p = Vertex::at([x, y, 1.0]).unwrap();
        assert!((one / (0.37 * 7.0 * seen(&p, h)) - 1.0).abs() <= 1e-13, "{one}");
        let off = (two / (0.37 * 0.61 * 7.0 * two_bounces(x, y, h)) - 1.0).abs();
        println!("h = {h}: {off:.1e}");
        assert!(off <= closeness, "h = {h}: {two}, {off:e} off");
    }
    for (x, y, h) in [(0.7, 0.1, 0.5), (0.6, 0.55, 0.8), (1.7, 0.2, 1.0)] {
        let scene = Scene { light_half_width: h, point: [x, y, 0.0], ..Scene::default() };
        let truth = 0.5 * 10.0 * seen_from_floor(x, y, h);
        let off = (room(scene).one_bounce() / truth - 1.0).abs();
        println!("floor at ({x}, {y}): {off:.1e}");
        assert!(off <= 1e-6, "the cube's shadow at ({x}, {y}): off by {off:e}");
    }
    let known = |point| room(Scene { point, ..Scene::default() }).two_bounces().is_some();
    assert_eq!(
        [known([0.2, 0.1, 1.0]), known([0.5, 0.1, 0.4]), known([1.5, 0.1, 0.0])],
        [true, false, false]
    );
}

#[test]
fn paths_say_what_they_count() {
    for (bounces, most) in
        [(Exactly(3), 3), (UpTo(7), 7), (UpTo(0), 0), (All(0.5), u32::MAX), (AllByThroughput, u32::MAX)]
    {
        let paths = paths(furnace(0.5), bounces, WAYS[0]);
        assert_eq!(paths.most_bounces(), most, "{bounces:?}");
        assert_eq!(paths.room().scene(), room(furnace(0.5)).scene());
    }
}

// ---- the furnace
// ---------------------------------------------------------------------------------------------------

const ALBEDOS: [f64; 4] = [0.2, 0.5, 0.8, 0.99];

fn close(given: f64, exact: f64) -> bool {
    (given - exact).abs() <= 64.0 * f64::EPSILON * exact
}

/// Every face emits 1 and reflects ρ: ρᵏ after k bounces. With cosine directions every single draw is exact.
#[test]
fn the_furnace_is_exact_with_cosine_directions() {
    let points = [
        [0.0, 0.0, 1.0],
        [0.5, 0.1, 0.3],
        [1.0, 1.0, 0.0],
        [2.0, 0.3, 3.0],
        [0.0, 0.0, 4.0],
        [2.0, 2.0, 4.0],
    ];
    for albedo in ALBEDOS {
        for (light, point) in FindLight::ALL.into_iter().flat_map(|light| points.map(|point| (light, point)))
        {
            let scene = Scene { point, ..furnace(albedo) };
            let mut sum = 0.0;
            for k in 0..=64 {
                sum += albedo.powi(k as i32);
                let mut rng = Stream::new(common::seed(420), k.into());
                for _ in 0..if k < 4 { 50 } else { 2 } {
                    assert!(close(
                        paths(scene, Exactly(k), (Cosine, light)).draw(&mut rng),
                        albedo.powi(k as i32)
                    ));
                    assert!(close(paths(scene, UpTo(k), (Cosine, light)).draw(&mut rng), sum));
                }
            }
        }
    }
}

/// With uniform ones a draw is Σ ρᵏ Π 2 cos θ with cos θ = 1 − u: linear in every u, so that two of Gauss's
/// nodes give the mean, whatever the angles φ.
#[test]
fn the_furnace_is_exact_with_uniform_directions() {
    let rule = gauss(2);
    let mut phi = Stream::new(common::seed(421), 0);
    for albedo in ALBEDOS {
        for k in 0..=6u32 {
            for light in FindLight::ALL {
                let exactly = paths(furnace(albedo), Exactly(k), (Uniform, light));
                let up_to = paths(furnace(albedo), UpTo(k), (Uniform, light));
                let mut means = [0.0; 2];
                for nodes in 0..1u32 << k {
                    let mut script = Vec::new();
                    let mut weight = 1.0;
                    for bounce in 0..k {
                        let (u, w) = rule[(nodes >> bounce & 1) as usize];
                        script.extend([u, phi.uniform()]);
                        weight *= w;
                    }
                    means[0] += weight * exactly.draw(&mut Stream::scripted(&script));
                    means[1] += weight * up_to.draw(&mut Stream::scripted(&script));
                }
                let sum: f64 = (0..=k as i32).map(|j| albedo.powi(j)).sum();
                assert!(close(means[0], albedo.powi(k as i32)) && close(means[1], sum), "{means:?}");
            }
        }
    }
}

/// Coins put in by hand: a path goes on for U < q, and not for U ≥ q, q rounded up to the grid. Its draw is
/// then Σ (ρ/q)ᵏ over the bounces that it made, and since it makes k of them or more with probability qᵏ, its
/// mean is 1/(1 − ρ).
#[test]
fn roulette_in_the_furnace_is_exact() {
    let mut phi = Stream::new(common::seed(422), 0);
    for albedo in ALBEDOS {
        let by_throughput = paths(furnace(albedo), AllByThroughput, (Cosine, ByChance));
        for (q, by_q) in [0.3, 0.75, albedo, 0.9999]
            .map(|q| (q, paths(furnace(albedo), All(q), (Cosine, ByChance))))
            .into_iter()
            // by weight it goes on with probability ρ, and every vertex counts 1
            .chain([(albedo, by_throughput)])
        {
            // the smallest number of the grid that does not go on, and the largest one that does; a weight
            // that went on may be a hair below 1
            let above = (q * 2f64.powi(53)).ceil() * 2f64.powi(-53);
            let below = above - if by_q == by_throughput { 2f64.powi(-50) } else { 2f64.powi(-53) };
            for bounces in 0..8 {
                let mut script = Vec::new();
                for coin in vec![below; bounces].into_iter().chain([above]) {
                    script.extend([phi.uniform(), phi.uniform(), coin]);
                }
                let exact: f64 = (0..=bounces as i32).map(|k| (albedo / q).powi(k)).sum();
                let draw = by_q.draw(&mut Stream::scripted(&script));
                assert!(close(draw, exact), "{albedo}, {q}, {bounces}: {draw} for {exact}");
            }
        }
    }
}

/// A q between two points of the grid goes on with the upper one's probability, and the light is divided by
/// that.
#[test]
fn a_q_between_grid_points_is_the_upper_one() {
    let step = 2f64.powi(-53);
    let seldom = paths(furnace(0.5), All(1.5 * step), (Cosine, ByChance));
    let script = [0.3, 0.4, step, 0.3, 0.4, 2.0 * step];
    assert_eq!(seldom.draw(&mut Stream::scripted(&script)), 1.0 + 0.5 / (2.0 * step));
}

/// All bounces by drawing, where no draw is bounded, too: ρ² or (4/3)ρ² is below q.
#[test]
fn the_furnace_without_a_limit() {
    for (i, (albedo, bounces, directions)) in [
        (0.2, All(0.5), Uniform),
        (0.07, AllByThroughput, Uniform),
        (0.5, All(0.85), Cosine),
        (0.05, AllByThroughput, Cosine),
    ]
    .into_iter()
    .enumerate()
    {
        let found =
            plain(&paths(furnace(albedo), bounces, (directions, ByChance)), 11_000_000, 430 + i as u64);
        found.assert(1.0 / (1.0 - albedo), 0.0, 1e-3, &format!("{bounces:?}, {directions:?}, ρ = {albedo}"));
    }
}

// ---- direct light
// --------------------------------------------------------------------------------------------------

/// A point that the cube hides no light from: on the cube; on a wall, since what goes from there to the
/// ceiling is above z = 1 when it is over the cube; or on the floor, a third of 2 + h away from the middle.
fn free_point(h: f64, rng: &mut Stream) -> [f64; 3] {
    loop {
        let face = Face::ALL[(rng.uniform() * 11.0) as usize];
        let [low, high] = face.bounds();
        let u = DVec3::new(rng.uniform(), rng.uniform(), rng.uniform());
        let point = low + (high - low) * u;
        let away = point.x.abs().max(point.y.abs());
        if (face == Face::Floor && away < (2.0 + h) / 3.0) || face == Face::Ceiling {
            continue;
        }
        return point.to_array();
    }
}

/// A light's size and a point from which a hundredth of the sky or more is light.
fn lit_scene(rng: &mut Stream) -> (Scene, f64) {
    loop {
        let light_half_width = 0.3 + 1.6 * rng.uniform();
        let point = free_point(light_half_width, rng);
        let p = seen(&Vertex::at(point).unwrap(), light_half_width);
        if p > 0.02 {
            let [wall_albedo, cube_albedo] = [(); 2].map(|()| 0.1 + 0.9 * rng.uniform());
            let scene =
                Scene { wall_albedo, cube_albedo, radiance: 3.0, light_half_width, emission: 0.0, point };
            return (scene, p);
        }
    }
}

#[test]
fn direct_light_is_howells() {
    let mut rng = Stream::new(common::seed(440), 0);
    for i in 0..6 {
        let (scene, p) = lit_scene(&mut rng);
        let at = room(scene).point();
        let truth = room(scene).albedo(&at) * scene.radiance * p;
        assert!((room(scene).direct(&at) / truth - 1.0).abs() <= 1e-12);
        for (j, way) in WAYS.into_iter().enumerate() {
            let once = paths(scene, Exactly(1), way);
            if way.1 == ByChance && p < 0.06 {
                continue; // it would take too long
            }
            let side = if way.1 == BySampling { 100 } else { 500 };
            let what = format!("{way:?} {:?} h = {:.2}", at.face(), scene.light_half_width);
            held(&once, 2, side, 441 + 4 * i + j as u64, truth, 1e-3, &what);
        }
    }
}

/// Each draw that looks for the light along a cosine direction is 0 or ρ L_e, so its mean ρ L_e P gives its
/// variance (ρ L_e)² P (1 − P).
#[test]
fn by_chance_a_draw_is_all_or_nothing() {
    let once = paths(Scene::default(), Exactly(1), (Cosine, ByChance));
    let mut rng = Stream::new(common::seed(445), 0);
    let draws: Vec<f64> = (0..100_000).map(|_| once.draw(&mut rng)).collect();
    assert!(draws.iter().all(|x| *x == 0.0 || *x == 8.0) && draws.contains(&8.0));
    let found = Estimate::from_draws(&draws);
    let (p, n) = (found.mean() / 8.0, 1e5);
    assert!((found.variance().unwrap() / (64.0 * p * (1.0 - p) * n / (n - 1.0)) - 1.0).abs() <= 1e-12);
}

/// Lights of other shapes through section 3's estimator: a triangle and a pentagon, one partly below the
/// horizon.
#[test]
fn polygonal_lights_fill_their_part_of_the_sky() {
    let surface = Lambertian::new(0.61).unwrap();
    let triangle = [[0.4, -0.5, 1.0], [1.2, 0.3, 0.8], [-0.2, 0.9, 1.1]];
    let low = [[1.0, -0.8, -0.4], [0.9, 0.9, -0.1], [0.6, 0.2, 1.2]];
    for (i, corners) in [triangle, low].into_iter().enumerate() {
        let [a, b, c] = corners.map(DVec3::from_array);
        let sides = [a.cross(b), b.cross(c), c.cross(a)];
        let turn = sides[0].dot(c).signum();
        let lit = |w: DVec3| sides.iter().all(|side| side.dot(w) * turn > 0.0);
        let cosine = surface.cosine_estimator(|w| if lit(w.vector()) { 7.0 } else { 0.0 });
        // ∫ cos θ cos θ′/(πr²) over the part above the horizon: cos θ is 0 below, which Gauss's nodes see if
        // there are enough
        let rule = gauss(16);
        let area = (b - a).cross(c - b);
        let mut p = 0.0;
        for (i, j) in (0..64).flat_map(|i| (0..64).map(move |j| (i, j))) {
            for ((s, ws), (t, wt)) in rule.iter().flat_map(|s| rule.iter().map(move |t| (s, t))) {
                let (s, t) = ((f64::from(i) + s) / 64.0, (f64::from(j) + t) / 64.0);
                let v = a + (b - a) * s + (c - b) * (s * t);
                p += ws * wt * s * area.dot(v).abs() * v.z.max(0.0) / v.length_squared().powi(2) / 4096.0;
            }
        }
        p *= FRAC_1_PI;
        let known = unbiased::paths::room::form_factor(&[a, b, c], DVec3::ZERO, DVec3::Z);
        assert!((known / p - 1.0).abs() <= 1e-6, "{known} {p}");
        held(&cosine, 2, 800, 450 + i as u64, 0.61 * 7.0 * p, 1e-3, "polygon");
    }
}

#[test]
fn shadows_of_the_cube_are_where_they_belong() {
    let points = [([0.7, 0.1], 1.3), ([-0.45, 0.62], 1.7), ([-0.9, 0.0], 1.9)];
    for (i, ([x, y], h)) in points.into_iter().enumerate() {
        let scene = Scene { light_half_width: h, point: [x, y, 0.0], ..Scene::default() };
        let free = seen(&room(scene).point(), h);
        let part = seen_from_floor(x, y, h);
        println!("{:.3} of the light is seen", part / free);
        assert!(part < 0.995 * free);
        for (j, way) in WAYS.into_iter().enumerate() {
            let once = paths(scene, Exactly(1), way);
            held(&once, 2, 300, 460 + 4 * i as u64 + j as u64, 5.0 * part, 1e-3, &format!("{way:?}"));
        }
    }
}

// ---- two bounces
// ---------------------------------------------------------------------------------------------------

/// Of points on the cube's top a scene, what it looks like, and the light of two bounces there.
fn two_bounce_scene(h: f64, [x, y]: [f64; 2], [wall_albedo, cube_albedo]: [f64; 2]) -> (Scene, String, f64) {
    let scene =
        Scene { wall_albedo, cube_albedo, light_half_width: h, point: [x, y, 1.0], ..Scene::default() };
    let truth = wall_albedo * cube_albedo * 10.0 * two_bounces(x, y, h);
    (scene, format!("h = {h:.2} at ({x:.2}, {y:.2})"), truth)
}

/// One by one and side by side.
fn both_hold(scene: Scene, way: (Hemisphere, FindLight), side: u64, seed: u64, truth: f64, what: &str) {
    let twice = paths(scene, Exactly(2), way);
    held(&twice, 4, side, seed, truth, 1e-3, &format!("{way:?} {what}"));
    let filled = |side| filled_in_cells(&twice, 4, side, seed + 100);
    held_by(filled, 4, side, truth, 1e-3, &format!("{way:?} {what}, side by side"));
}

/// With a light of nearly all of the ceiling, which is found by chance often enough.
#[test]
fn two_bounces_by_chance_are_the_quadratures() {
    let mut rng = Stream::new(common::seed(470), 0);
    let mut between = |low: f64, high: f64| low + (high - low) * rng.uniform();
    let at = [between(-0.5, 0.5), between(-0.5, 0.5)];
    let (scene, what, truth) = two_bounce_scene(1.9, at, [between(0.1, 1.0), between(0.1, 1.0)]);
    // as many cells as it takes, found beforehand
    for (seed, (directions, side)) in (471..).zip([(Cosine, 70), (Uniform, 81)]) {
        both_hold(scene, (directions, ByChance), side, seed, truth, &what);
    }
}

#[test]
fn two_bounces_are_the_quadratures() {
    for i in 0..2 {
        let mut rng = Stream::new(common::seed(480), i);
        let mut between = |low: f64, high: f64| low + (high - low) * rng.uniform();
        let h = if i == 0 { 0.5 } else { between(1.0, 1.6) };
        let at = if i == 0 { [0.0; 2] } else { [between(-0.5, 0.5), between(-0.5, 0.5)] };
        let (scene, what, truth) = two_bounce_scene(h, at, [between(0.1, 1.0), between(0.1, 1.0)]);
        for (j, way) in WAYS[..2].iter().enumerate() {
            both_hold(scene, *way, 20, 481 + 4 * i + j as u64, truth, &what);
        }
        let scene_room = room(scene);
        for (j, directions) in Hemisphere::ALL.into_iter().enumerate() {
            let exact = reflected(scene_room, directions, |p_j, _| scene_room.direct(p_j));
            held(
                &exact,
                2,
                200,
                500 + 2 * i + j as u64,
                truth,
                5e-4,
                &format!("direct light plugged in, {what}"),
            );
            let once = paths(scene, Exactly(1), (directions, BySampling));
            let estimated = reflected(scene_room, directions, |p_j, rng| once.light_from(p_j, rng));
            held(
                &estimated,
                4,
                20,
                510 + 2 * i + j as u64,
                truth,
                1e-3,
                &format!("an estimate plugged in, {what}"),
            );
        }
    }
}

// ---- all light
// -----------------------------------------------------------------------------------------------------

/// All light that is emitted is absorbed: ∫ (1 − ρ) E dA = π ∫ L_e dA, over walls, cube and the light itself.
/// E(x) = π times the light that leaves what a cosine direction from x meets, with all its bounces and every
/// shadow. If the faces emit, too, the draws vary little.
#[test]
fn what_is_emitted_is_absorbed() {
    let (emission, radiance) = (1.0, 2.0);
    let scene = Scene {
        wall_albedo: 0.2,
        cube_albedo: 0.3,
        light_half_width: 1.9,
        emission,
        radiance,
        ..Scene::default()
    };
    let room = room(scene);
    let surface: f64 = Face::ALL.iter().map(|face| face.area()).sum();
    let light = 3.8 * 3.8;
    let truth = PI * (radiance * light + emission * (surface - light));
    for (i, (bounces, way)) in [(All(0.4), WAYS[0]), (UpTo(20), WAYS[1])].into_iter().enumerate() {
        let all = paths(scene, bounces, way);
        let absorbed = from_fn(|rng| {
            // a point in proportion to area, the floor's by rejection
            let x = loop {
                let mut left = rng.uniform() * (surface + 1.0);
                let area = |face: Face| if face == Face::Floor { 16.0 } else { face.area() };
                let Some(face) = Face::ALL.into_iter().find(|face| {
                    left -= area(*face);
                    left < 0.0
                }) else {
                    continue;
                };
                let [low, high] = face.bounds();
                let u = DVec3::new(rng.uniform(), rng.uniform(), rng.uniform());
                match Vertex::at((low + (high - low) * u).to_array()) {
                    Ok(vertex) if vertex.face() == face => break vertex,
                    _ => {}
                }
            };
            let from = nearest_hit(&x, x.to_room(&Cosine.sample(rng))).unwrap();
            (1.0 - room.albedo(&x)) * PI * all.light_from(&from, rng) * surface
        });
        let what = format!("{bounces:?} {way:?}");
        let pilot = plain(&absorbed, 100_000, 520 + i as u64).std_error;
        let draws = 1e5 * (12.5 * pilot / (1e-3 * truth)).powi(2);
        plain(&absorbed, draws as u64, 524 + i as u64).assert(
            truth,
            0.0,
            1e-3,
            &format!("{what}, {draws:.1e} draws"),
        );
    }
}

/// The same of the lamp alone, from two random points in each of very many cells of every face: what leaves a
/// point is ρ E/π, by paths side by side; the light, which reflects nothing, gets what comes from where
/// cosine directions lead.
#[test]
fn what_the_lamp_emits_is_absorbed() {
    // a cell is all light or has none, and all cube or has none
    let side = 128;
    let scene = Scene { wall_albedo: 0.4, cube_albedo: 0.3, light_half_width: 1.0, ..Scene::default() };
    let truth = PI * scene.radiance * 4.0;
    for (seed, (bounces, way, paths_a_point)) in
        (526..).zip([(All(0.6), WAYS[0], 320), (UpTo(12), WAYS[1], 256)])
    {
        let n = paths_a_point as f64;
        let absorbed = |at: [f64; 3], rng: &mut Stream| {
            if let Ok(room) = BoxRoom::new(Scene { point: at, ..scene }) {
                let mut draws = vec![0.0; paths_a_point];
                let albedo = room.albedo(&room.point());
                Paths::new(room, bounces, way.0, way.1).unwrap().fill(rng, &mut draws);
                return (1.0 / albedo - 1.0) * PI * draws.iter().sum::<f64>() / n;
            }
            let (light, all) = (Vertex::at(at).unwrap(), paths(scene, bounces, way));
            let mut sum = 0.0;
            for _ in 0..64 {
                let from = nearest_hit(&light, light.to_room(&Cosine.sample(rng))).unwrap();
                sum += PI * all.light_from(&from, rng);
            }
            sum / 64.0
        };
        let faces = Face::ALL.into_iter().flat_map(|face| (0..side).map(move |row| (face, row)));
        let rows: Vec<[f64; 2]> = faces
            .enumerate()
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(|(n, (face, row))| {
                let mut rng = Stream::new(common::seed(seed), n as u64);
                let [low, high] = face.bounds();
                let side = if face.is_cube() { side / 4 } else { side };
                let cell = (high - low) / side as f64;
                let area = (if face.is_cube() { 1.0 } else { 16.0 }) / (side * side) as f64;
                let (mut sum, mut squares) = (0.0, 0.0);
                for column in if row < side { 0..side } else { 0..0 } {
                    let mut there = || {
                        // of three numbers one is of no account, across the face
                        let first = if cell.x == 0.0 { [0, row, column] } else { [row, column, column] };
                        let u = DVec3::from_array(first.map(|i| i as f64 + rng.uniform()));
                        let at = (low + cell * u).to_array();
                        let within = Vertex::at(at).is_ok_and(|vertex| vertex.face() == face);
                        if within { area * absorbed(at, &mut rng) } else { 0.0 }
                    };
                    let (a, b) = (there(), there());
                    sum += 0.5 * (a + b);
                    squares += 0.25 * (a - b) * (a - b);
                }
                [sum, squares]
            })
            .collect();
        let [sum, squares] = rows.iter().fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
        // what more than 12 bounces would leave is below 0.4¹³
        let found = Found { mean: sum, std_error: squares.sqrt() };
        found.assert(truth, 7e-6 * truth, 1e-3, &format!("the lamp's, {bounces:?} {way:?}"));
    }
}

/// The worksheet's cumulative values, each known to within 1e-5, which is 7e-5 of it or less.
#[test]
fn cumulative_light_is_the_worksheets() {
    for (i, (k, value)) in [(1, 0.27285), (2, 0.31276), (3, 0.33502), (15, 0.35533)].into_iter().enumerate() {
        for (j, way) in WAYS[..2].iter().enumerate() {
            let estimator = paths(Scene::default(), UpTo(k), *way);
            let found = plain(&estimator, common::draws(8_000_000), 530 + 4 * j as u64 + i as u64);
            let caught = if common::mutation() { 5e-3 } else { 1e-3 };
            found.assert(value, 1e-5, caught, &format!("up to {k} bounces {way:?}"));
        }
    }
}

/// Every way against all others together, each weighing as much as it knows; with a large light that is found
/// by chance, too, faces that emit, and an end of every kind.
#[test]
fn all_ways_agree() {
    let scene = Scene {
        wall_albedo: 0.4,
        cube_albedo: 0.7,
        light_half_width: 1.7,
        emission: 1.0,
        radiance: 2.0,
        point: [0.5, 0.1, 0.4],
    };
    // here most of what arrives is the lamp's: nothing hides it, and what is not light emits 1
    let top = Scene { radiance: 4.0, point: [0.2, 0.1, 1.0], ..scene };
    let p = seen(&room(top).point(), 1.7);
    ways_agree(top, &[Exactly(1)], 1000, Some(0.7 * (4.0 * p + 1.0 - p)));
    ways_agree(scene, &[Exactly(2)], 1100, None);
    ways_agree(scene, &[Exactly(3)], 1200, None);
    ways_agree(top, &[UpTo(3)], 1300, None);
    let shadow = Scene { wall_albedo: 0.3, cube_albedo: 0.5, point: [0.7, 0.1, 0.0], ..scene };
    // what more than 12 bounces would leave is below 0.3⁷·0.5⁶ = 4e-6, as the cube does not see itself
    ways_agree(shadow, &[All(0.6), AllByThroughput, UpTo(12)], 1400, None);
}

/// The bias that is caught, as a part of the mean: for 1e-3 it would take a minute.
const CAUGHT: f64 = 1.5e-3;

fn ways_agree(scene: Scene, group: &[Bounces], seed: u64, truth: Option<f64>) {
    let mut found: Vec<(String, Found)> = Vec::new();
    for bounces in group {
        for way in WAYS {
            let (seed, what) = (seed + 2 * found.len() as u64, format!("{bounces:?} {way:?}"));
            let estimator = paths(scene, *bounces, way);
            assert_eq!(estimator.doubt(), None);
            let pilot = plain(&estimator, 1_000_000, seed);
            // those that vary little know more than the others, at little cost
            let little = way.0 == Cosine && estimator.most_bounces() <= 64;
            let share = if little { 20.0 } else { 12.2 };
            let draws = 1e6 * (share * pilot.std_error / (CAUGHT * pilot.mean)).powi(2);
            found.push((what, plain(&estimator, 1_000_000.max(draws as u64), seed + 1)));
        }
    }
    for (i, (what, one)) in found.iter().enumerate() {
        let others = found.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, (_, other))| other);
        let [mut sum, mut weights] = [0.0; 2];
        for other in others {
            let weight = other.std_error.powi(-2);
            sum += weight * other.mean;
            weights += weight;
        }
        let others = Found { mean: sum / weights, std_error: weights.sqrt().recip() };
        one.agrees(others, CAUGHT, &format!("{what} and the others"));
        if let Some(truth) = truth {
            one.assert(truth, 0.0, CAUGHT, what);
        }
    }
}

/// On one and the same path UpTo(K) finds what Exactly(0), …, Exactly(K) find, if neither samples the light:
/// the numbers drawn are the same.
#[test]
fn bounces_add_up_path_by_path() {
    let scene = Scene { light_half_width: 1.9, emission: 0.25, ..Scene::default() };
    for directions in Hemisphere::ALL {
        for block in 0..2000 {
            let draw = |bounces| {
                paths(scene, bounces, (directions, ByChance)).draw(&mut Stream::new(common::seed(541), block))
            };
            let sum: f64 = (0..=6).map(|k| draw(Exactly(k))).sum();
            assert!((draw(UpTo(6)) - sum).abs() <= 1e-14 * sum);
        }
    }
}

// ---- paths as they are drawn
// ---------------------------------------------------------------------------------------

#[test]
fn a_traced_path_is_the_one_drawn() {
    let scenes = [
        Scene::default(),
        Scene { light_half_width: 1.9, emission: 0.5, point: [1.0, 0.2, 0.0], ..Scene::default() },
        Scene { light_half_width: 0.0, emission: 0.5, point: [0.0, 0.0, 4.0], ..Scene::default() },
    ];
    for scene in scenes {
        let room = room(scene);
        for way in WAYS {
            for bounces in [Exactly(0), Exactly(2), UpTo(0), UpTo(3), All(0.8), AllByThroughput] {
                let estimator = paths(scene, bounces, way);
                for block in 0..200 {
                    let mut rng = Stream::new(common::seed(542), block);
                    let path = estimator.trace(&mut rng);
                    let mut again = Stream::new(common::seed(542), block);
                    assert_eq!(path.light.to_bits(), estimator.draw(&mut again).to_bits());
                    // a draw leaves out the numbers that its path did not need
                    assert!(rng.random_numbers() <= again.random_numbers());
                    assert_eq!(rng.evaluations(), again.evaluations());
                    assert_eq!(path.vertices[0], room.point());
                    for pair in path.vertices.windows(2) {
                        let way = pair[1].position() - pair[0].position();
                        assert!(pair[0].normal().dot(way) > 0.0 && pair[1].normal().dot(way) < 0.0);
                        assert!(visible(&pair[0], pair[1].position()) && !room.is_light(&pair[0]));
                        let [low, high] = pair[1].face().bounds();
                        assert!(pair[1].position().cmpge(low).all() && pair[1].position().cmple(high).all());
                    }
                    for sample in &path.samples {
                        let from = &path.vertices[sample.from];
                        assert!(
                            sample.point.z == 4.0
                                && sample.point.x.abs().max(sample.point.y.abs()) <= scene.light_half_width
                        );
                        let above = from.normal().dot(sample.point - from.position()) > 0.0
                            && from.position().z < 4.0;
                        assert_eq!(sample.visible, above && visible(from, sample.point));
                    }
                    let sampled = way.1 == BySampling && scene.light_half_width > 0.0;
                    assert!(sampled || path.samples.is_empty());
                    // the light is sampled once at every vertex that counts, and no vertex is visited for
                    // nothing
                    match bounces {
                        Exactly(0) | UpTo(0) => assert_eq!((path.vertices.len(), path.samples.len()), (1, 0)),
                        Exactly(2) if sampled && scene.emission == 0.0 => {
                            let lit = room.is_light(&path.vertices[1]);
                            assert_eq!((path.vertices.len(), path.samples.len()), (2, usize::from(!lit)));
                        }
                        UpTo(3) if sampled => {
                            let dark = path.vertices.iter().take(3).filter(|v| !room.is_light(v)).count();
                            assert_eq!(path.samples.len(), dark);
                        }
                        UpTo(3) => assert!(
                            path.vertices.len() == 4
                                || path.vertices.last().is_some_and(|v| room.is_light(v))
                        ),
                        _ => {}
                    }
                }
            }
        }
    }
}

#[test]
fn a_seed_keeps_its_paths() {
    let scene = Scene { light_half_width: 1.9, emission: 0.125, ..Scene::default() };
    let mut rng = Stream::new(1, 0);
    let mut bits = Vec::new();
    for way in WAYS {
        for bounces in [UpTo(3), All(0.8), AllByThroughput] {
            bits.push(paths(scene, bounces, way).draw(&mut rng).to_bits());
        }
    }
    let found = (rng.random_numbers(), rng.evaluations());
    assert_eq!((bits.as_slice(), found), (GOLDEN.as_slice(), COUNTS), "{bits:#x?}");
}

const GOLDEN: [u64; 12] = [
    0x3ffc0df328adeafd,
    0x40036721e91e74b1,
    0x400893431c865e25,
    0x400d1ef7af53e51d,
    0x400796714f2ae74b,
    0x4010d33a06b3851f,
    0x4010e66666666666,
    0x4024400000000000,
    0x3fd0000000000000,
    0x3fe05f560c623536,
    0x3fc0000000000000,
    0x3fc0000000000000,
];

const COUNTS: (u64, u64) = (76, 22);

// ---- cautions, errors and ends
// -------------------------------------------------------------------------------------

#[test]
fn a_caution_says_when_the_variance_may_be_infinite() {
    let with = |wall_albedo, cube_albedo, light_half_width| Scene {
        wall_albedo,
        cube_albedo,
        light_half_width,
        ..Scene::default()
    };
    let says = |scene, bounces, way| paths(scene, bounces, way).doubt().map(|doubt| doubt.to_string());
    // q against ρ² and (4/3)ρ² of the larger albedo, whichever it is
    for scene in [with(0.5, 0.8, 0.5), with(0.8, 0.1, 0.5)] {
        for light in FindLight::ALL {
            assert_eq!(says(scene, All(0.6400001), (Cosine, light)), None);
            let told = "the variance may be infinite, and the error bar too short: q = 0.64 is not above ρ² \
                        = 0.6400 for the largest albedo";
            assert_eq!(says(scene, All(0.64), (Cosine, light)).unwrap(), told);
            assert!(says(scene, All(0.2), (Cosine, light)).is_some());
            assert_eq!(says(scene, All(0.86), (Uniform, light)), None);
            let told = "the variance may be infinite, and the error bar too short: q = 0.85 is not above \
                        (4/3)ρ² = 0.8533 for the largest albedo";
            assert_eq!(says(scene, All(0.85), (Uniform, light)).unwrap(), told);
        }
    }
    // by weight: never with cosine directions; with uniform ones from ρ² = 3/4 on
    assert_eq!(says(with(0.5, 0.99, 0.5), AllByThroughput, WAYS[0]), None);
    assert_eq!(says(with(0.5, 0.86, 0.5), AllByThroughput, WAYS[1]), None);
    assert_eq!(
        says(with(0.5, 0.87, 0.5), AllByThroughput, WAYS[1]).unwrap(),
        "the variance may be infinite, and the error bar too short: the squared throughput of a path grows \
         by (4/3)ρ² = 1.0092 a bounce for the largest albedo, and nothing ends a path of throughput 1 or \
         more"
    );
    // a number of bounces ends every path, but uniform directions make weights that vary too much: from 24 of
    // them on, (9/5)²⁴ = 1.3e6
    let few = |draws: &str| {
        Some(format!(
            "uniform directions make most throughputs far too small and a few very large, so that the error \
             bar of fewer than about {draws} draws means nothing"
        ))
    };
    for albedo in [1.0, 0.5, 1e-3] {
        let scene = with(albedo, albedo, 0.5);
        assert_eq!(says(scene, Exactly(24), (Uniform, BySampling)), None);
        assert_eq!(says(scene, Exactly(25), (Uniform, BySampling)), few("1e6"));
        assert_eq!(says(scene, Exactly(64), (Uniform, BySampling)), few("1e16"));
        let furnace = Scene { emission: 1.0, light_half_width: 0.0, ..scene };
        assert_eq!(says(furnace, Exactly(23), (Uniform, ByChance)), None);
        assert_eq!(says(furnace, Exactly(24), (Uniform, ByChance)), few("1e6"));
        for light in FindLight::ALL {
            assert_eq!(says(scene, Exactly(64), (Cosine, light)), None);
            assert_eq!(says(scene, UpTo(64), (Cosine, light)), None);
        }
    }
    // a sum is no worse than its terms: with an albedo that makes the first ones the largest there is nothing
    // to say
    assert_eq!(says(with(0.5, 0.5, 0.5), UpTo(64), WAYS[1]), None);
    assert_eq!(says(with(1.0, 1.0, 0.5), UpTo(12), WAYS[1]), None);
    assert!(says(with(1.0, 1.0, 0.5), UpTo(64), WAYS[1]).unwrap().contains("uniform directions"));
    // a light that one path in 100 finds, in 1e6 of them, and in more
    assert_eq!(says(with(0.5, 0.5, 0.5), Exactly(15), (Uniform, ByChance)), None);
    assert_eq!(
        says(with(0.5, 0.5, 0.5), Exactly(16), (Uniform, ByChance)).unwrap(),
        "uniform directions make most throughputs far too small and a few very large, and few paths find the \
         light, so that the error bar of fewer than about 1e6 draws means nothing"
    );
    assert_eq!(says(with(0.5, 0.5, 0.00501), Exactly(1), (Cosine, ByChance)), None);
    assert_eq!(
        says(with(0.5, 0.5, 0.0005), Exactly(1), (Cosine, ByChance)).unwrap(),
        "few paths find the light, so that the error bar of fewer than about 1e8 draws means nothing"
    );
    assert_eq!(says(with(0.5, 0.5, 0.0), Exactly(1), (Cosine, ByChance)), None);
    assert_eq!(says(with(0.5, 0.5, 0.0005), UpTo(0), (Cosine, ByChance)), None);
    let lit = Scene { emission: 1.0, ..with(0.5, 0.5, 0.0005) };
    assert_eq!(says(lit, AllByThroughput, (Cosine, ByChance)), None);
    // a light that touches the walls, sampled from there
    let told = "the variance may be infinite, and the error bar too short: the light touches the walls, \
                where its samples weigh without bound";
    for bounces in [UpTo(2), Exactly(2), All(0.9), AllByThroughput] {
        assert_eq!(says(with(0.5, 0.5, 2.0), bounces, WAYS[0]).unwrap(), told);
        assert_eq!(says(with(0.5, 0.5, 2.0), bounces, WAYS[2]), None);
        // one that all but does: 8/(2 − h)³
        assert_eq!(says(with(0.5, 0.5, 1.979), bounces, WAYS[0]), None);
        let told = "the light is so near the walls that a few of its samples outweigh all others, so that \
                    the error bar of fewer than about 8e9 draws means nothing";
        assert_eq!(says(with(0.5, 0.5, 1.999), bounces, WAYS[0]).unwrap(), told);
        assert_eq!(says(with(0.5, 0.5, 1.999), bounces, WAYS[2]), None);
        assert!(says(with(0.5, 0.5, 2f64.next_down()), bounces, WAYS[0]).is_some());
    }
    assert_eq!(says(with(0.5, 0.5, 2.0), UpTo(1), WAYS[0]), None);
}

#[test]
fn bad_paths_are_errors() {
    let new = |scene, bounces| Paths::new(room(scene), bounces, Cosine, BySampling);
    let says = |scene, bounces, sentence: &str| {
        assert_eq!(new(scene, bounces).unwrap_err().to_string(), sentence);
    };
    for bounces in [Exactly(65), UpTo(65)] {
        says(
            Scene::default(),
            bounces,
            "the number of bounces must be at most 64 (without a limit, roulette ends the paths), not 65",
        );
    }
    for (q, shown) in [
        (0.0, "0"),
        (-0.5, "-0.5"),
        (1.0, "1"),
        (0.9999000000000001, "0.9999000000000001"),
        (f64::NAN, "NaN"),
    ] {
        let rest = "above 0 and at most 0.9999, where a path has ten thousand bounces";
        says(
            Scene::default(),
            All(q),
            &format!("the continuation probability q must be {rest}, not {shown}"),
        );
    }
    for (wall_albedo, cube_albedo, shown) in
        [(1.0, 0.5, "1"), (0.5, 1.0, "1"), (0.9990000000000001, 0.2, "0.9990000000000001")]
    {
        let rest =
            "at most 0.999 where nothing but absorption ends a path (or choose a q or a number of bounces)";
        let scene = Scene { wall_albedo, cube_albedo, ..Scene::default() };
        says(scene, AllByThroughput, &format!("the largest albedo must be {rest}, not {shown}"));
        assert!(new(scene, All(0.9999)).is_ok() && new(scene, UpTo(64)).is_ok());
    }
    let scene = Scene { wall_albedo: 0.999, ..Scene::default() };
    assert!(
        new(scene, AllByThroughput).is_ok()
            && new(scene, Exactly(64)).is_ok()
            && new(scene, All(5e-324)).is_ok()
    );
}

/// Points everywhere, edges and corners too, lights of every size, ρ = 0 and 1, long paths: every draw is
/// finite and not negative.
#[test]
fn no_scene_gives_anything_but_numbers() {
    let mut points = vec![
        [0.5, 0.5, 1.0],
        [-0.5, 0.0, 1.0],
        [0.5, 0.5, 0.5],
        [0.5, 0.0, 0.0],
        [0.5, 0.5, 0.0],
        [2.0, 2.0, 0.0],
        [-2.0, 0.0, 0.0],
        [2.0, 2.0, 3.0],
        [2.0, -2.0, 4.0],
        [2.0, 0.0, 4f64.next_down()],
        [2.0, 0.0, 5e-324],
    ];
    points.extend(Face::ALL.map(|face| {
        let [low, high] = face.bounds();
        if face == Face::Floor { [1.5, 0.1, 0.0] } else { (low * 0.375 + high * 0.625).to_array() }
    }));
    for point in points {
        for light_half_width in [0.0, 1e-12, 0.4, 2.0] {
            for albedo in [0.0, 0.7, 1.0] {
                let scene = Scene {
                    wall_albedo: albedo,
                    cube_albedo: 1.0,
                    radiance: 3.0,
                    light_half_width,
                    emission: 0.0,
                    point,
                };
                let Ok(room) = BoxRoom::new(scene) else { continue };
                for (directions, light) in WAYS {
                    for bounces in [Exactly(0), UpTo(1), UpTo(64), All(0.9), All(0.9999)] {
                        let long = bounces == All(0.9999);
                        if long && (light_half_width < 2.0 || albedo < 1.0) {
                            continue;
                        }
                        let estimator = Paths::new(room, bounces, directions, light).unwrap();
                        let mut rng = Stream::new(common::seed(544), 0);
                        for _ in 0..if long { 2 } else { 20 } {
                            let draw = estimator.draw(&mut rng);
                            assert!(draw >= 0.0 && draw.is_finite(), "{draw} {point:?} {bounces:?}");
                            // along the ceiling no light arrives at once; without a light there is none
                            let dark = point[2] == 4.0 && bounces == UpTo(1)
                                || bounces == Exactly(0)
                                || light_half_width == 0.0;
                            assert!(!dark || draw == 0.0, "{draw} {point:?}");
                        }
                    }
                }
            }
        }
    }
}

/// k = 0 is what p emits itself, and a light that L̂_o is asked for at its own vertex shines.
#[test]
fn no_bounce_is_emission() {
    let scene = Scene { emission: 0.75, ..Scene::default() };
    let mut rng = Stream::new(common::seed(545), 0);
    for way in WAYS {
        assert_eq!(paths(scene, Exactly(0), way).draw(&mut rng), 0.75);
        assert_eq!(paths(scene, UpTo(0), way).draw(&mut rng), 0.75);
        let light = Vertex::at([0.1, 0.2, 4.0]).unwrap();
        assert_eq!(paths(scene, UpTo(5), way).light_from(&light, &mut rng), 10.0);
    }
    assert_eq!(rng.random_numbers(), 0);
}
