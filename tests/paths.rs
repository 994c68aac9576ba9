//! Section 4's paths, held to a ladder of truths: the furnace, direct light, two bounces, the balance of
//! energy, every way against every other.
//!
//! Comparisons with an error bar may be missed by 8 std errors (1.2e-15, two-sided); a bias of 11 is caught
//! in all runs but one in a thousand. Each prints the bias that it would catch, and fails if that is more
//! than 1e-3 of the truth, or 1.5e-3 where ways are compared with each other. With `UNBIASED_MUTATION` it is
//! five times as much.

mod common;

use std::f64::consts::PI;

use common::{bounds, furnace, on_face, part_of_the_sky};
use glam::DVec3;
use rand::distr::Distribution;
use unbiased::lambertian::hemisphere::Hemisphere;
use unbiased::paths::room::{BoxRoom, Face, Scene, Vertex, nearest_hit, visible};
use unbiased::paths::{Bounces, FindLight, Paths};
use unbiased::placement::sobol;
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
}

impl From<Estimate> for Found {
    fn from(estimate: Estimate) -> Self {
        Self { mean: estimate.mean(), std_error: estimate.std_error().unwrap() }
    }
}

/// The bias that is caught, as a part of the truth.
fn caught() -> f64 {
    if common::mutation() { 5e-3 } else { 1e-3 }
}

fn plain(estimator: &impl Estimator, draws: u64, seed: u64) -> Found {
    estimate(estimator, Budget::Draws(draws), common::seed(seed)).unwrap().into()
}

/// As many draws as it takes to catch this bias, and some more.
fn held(estimator: &impl Estimator, pilot: u64, seed: u64, truth: f64, off: f64, what: &str) {
    let short = 11.5 * plain(estimator, pilot, seed).std_error / (caught() * truth - off);
    // a thousand are near normal, and a pilot is a tenth off
    let draws = 1000.max((1.3 * pilot as f64 * short * short) as u64);
    plain(estimator, draws, seed + 1).assert(truth, off, caught(), what);
}

// ---- the furnace

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

// ---- direct light, two bounces, and up to fifteen

/// One and two bounces are known to rounding (tests/scene.rs), from faces of every kind and where the cube
/// hides some of the light; up to 15 by the worksheet's cumulative values, known to 1e-5. Draws are sets of
/// 4096 points.
#[test]
fn light_is_what_is_known() {
    let mut rows: Vec<(Scene, Bounces, f64, f64)> = Vec::new();
    for (point, h) in [
        ([0.0, 0.0, 1.0], 0.5),
        ([0.2, -0.4, 1.0], 1.9),
        ([0.5, 0.1, 0.4], 1.7),
        ([-0.2, -0.5, 0.6], 1.3),
        ([2.0, 0.3, 2.5], 1.2),
        ([0.4, -2.0, 1.5], 1.4),
        ([-1.7, 0.2, 0.0], 1.0),
        // in the cube's shadow
        ([0.7, 0.1, 0.0], 1.3),
        ([-0.45, 0.62, 0.0], 1.7),
    ] {
        let scene =
            Scene { wall_albedo: 0.61, cube_albedo: 0.37, light_half_width: h, point, ..Scene::default() };
        rows.push((scene, Exactly(1), room(scene).one_bounce(), 0.0));
        rows.extend(room(scene).two_bounces().map(|two| (scene, Exactly(2), two, 0.0)));
    }
    for (most, value) in [(2, 0.31276), (3, 0.33502), (15, 0.35533)] {
        rows.push((Scene::default(), UpTo(most), value, 1e-5));
    }
    for (i, (scene, bounces, truth, off)) in rows.into_iter().enumerate() {
        for (j, way) in WAYS.into_iter().enumerate() {
            // what few paths find would take too long: all_ways_agree has it
            let part = part_of_the_sky(&room(scene).point(), scene.light_half_width);
            if way.1 == ByChance && (bounces != Exactly(1) || part < 0.06) {
                continue;
            }
            let set = sobol(paths(scene, bounces, way), 4096).unwrap();
            let what = format!("{bounces:?} {way:?} at {:?}, h = {}", scene.point, scene.light_half_width);
            held(&set, 256, 440 + 10 * (4 * i + j) as u64, truth, off, &what);
        }
    }
}

// ---- all light

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
                let u = DVec3::from_array([(); 3].map(|()| rng.uniform()));
                if let Some(vertex) = on_face(face, u) {
                    break vertex;
                }
            };
            let from = nearest_hit(&x, x.to_room(&Cosine.sample(rng))).unwrap();
            (1.0 - room.albedo(&x)) * PI * all.light_from(&from, rng) * surface
        });
        held(&absorbed, 100_000, 520 + 2 * i as u64, truth, 0.0, &format!("{bounces:?} {way:?}"));
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
    let p = part_of_the_sky(&room(top).point(), 1.7);
    ways_agree(top, &[Exactly(1)], 1000, Some(0.7 * (4.0 * p + 1.0 - p)));
    ways_agree(scene, &[Exactly(2)], 1100, None);
    ways_agree(scene, &[Exactly(3)], 1200, None);
    ways_agree(top, &[UpTo(3)], 1300, None);
    let shadow = Scene { wall_albedo: 0.3, cube_albedo: 0.5, point: [0.7, 0.1, 0.0], ..scene };
    // what more than 12 bounces would leave is below 0.3⁷·0.5⁶ = 4e-6, as the cube does not see itself
    ways_agree(shadow, &[All(0.6), AllByThroughput, UpTo(12)], 1400, None);
}

fn ways_agree(scene: Scene, group: &[Bounces], seed: u64, truth: Option<f64>) {
    let mut found: Vec<(String, Found)> = Vec::new();
    for bounces in group {
        for way in WAYS {
            let (seed, what) = (seed + 2 * found.len() as u64, format!("{bounces:?} {way:?}"));
            let estimator = paths(scene, *bounces, way);
            assert_eq!(estimator.doubt(), None);
            let pilot = plain(&estimator, common::draws(1_000_000), seed);
            // those that vary little know more than the others, at little cost
            let little = way.0 == Cosine && matches!(bounces, Exactly(_) | UpTo(_));
            let share = if little { 20.0 } else { 12.2 };
            let draws = common::draws(1_000_000) as f64
                * (share * pilot.std_error / (1.5 * caught() * pilot.mean)).powi(2);
            found.push((what, plain(&estimator, common::draws(1_000_000).max(draws as u64), seed + 1)));
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
        let both = Found { std_error: one.std_error.hypot(others.std_error), ..*one };
        both.assert(others.mean, 0.0, 1.5 * caught(), &format!("{what} and the others"));
        if let Some(truth) = truth {
            one.assert(truth, 0.0, 1.5 * caught(), what);
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
                        let [low, high] = bounds(pair[1].face());
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
