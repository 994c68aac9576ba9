//! Section 4's scene: its closed forms, light of any size, and scenes of any bits. No test here has a false
//! alarm.

mod common;

use std::f64::consts::FRAC_1_PI;

use common::{any_number, bounds, config, probability};
use glam::DVec3;
use proptest::prelude::*;
use proptest::sample::select;
use rayon::prelude::*;
use unbiased::lambertian::hemisphere::Hemisphere;
use unbiased::paths::room::{BoxRoom, Face, Scene, Vertex, form_factor, visible};
use unbiased::paths::{Bounces, FindLight, Paths};
use unbiased::{Error, Estimator, Stream};

use Bounces::{All, Exactly, UpTo};
use FindLight::{ByChance, BySampling};
use Hemisphere::Cosine;

fn paths(scene: Scene, bounces: Bounces, (directions, light): (Hemisphere, FindLight)) -> Paths {
    Paths::new(BoxRoom::new(scene).unwrap(), bounces, directions, light).unwrap()
}

// ---- closed forms

/// From anywhere on any face but the ceiling, to a light of any size.
#[test]
fn direct_light_is_howells() {
    let mut rng = Stream::new(common::seed(440), 0);
    for _ in 0..2000 {
        let h = 0.3 + 1.6 * rng.uniform();
        let scene = Scene { light_half_width: h, cube_albedo: 0.37, wall_albedo: 0.61, ..Scene::default() };
        let (room, p) = (BoxRoom::new(scene).unwrap(), common::any_point(&mut rng));
        let (part, albedo) =
            (common::part_of_the_sky(&p, h), if common::is_cube(p.face()) { 0.37 } else { 0.61 });
        if p.face() != Face::Ceiling {
            let off = (room.direct(&p) / (albedo * 10.0) - part).abs();
            // 1e-15 of the form factor, and a few roundings of the four terms of the truth
            assert!(off <= 4e-15, "{p:?}, h = {h}: {off:e} beside {part}");
        }
    }
}

#[test]
fn direct_light_is_the_worksheets() {
    let room = BoxRoom::new(Scene::default()).unwrap();
    let p = room.point();
    assert_eq!((p.face(), p.position()), (Face::CubeTop, DVec3::Z));
    let close = |given: f64, exact: f64| (given - exact).abs() <= 2.0 * f64::EPSILON * exact / 2.0;
    assert!(close(room.direct(&p), 0.2728543591976926), "{}", room.direct(&p));
    assert!(close(form_factor(&room.light_corners(), p.position(), p.normal()), 0.03410679489971157));
    assert_eq!(room.light_area(), 1.0);
    // in the ceiling's plane there is none, and none without a light
    for half_width in [0.5, 1.9, 0.0] {
        let room = BoxRoom::new(Scene { light_half_width: half_width, ..Scene::default() }).unwrap();
        for point in [[1.95, 0.3, 4.0], [-1.96, -2.0, 4.0]] {
            assert_eq!(room.direct(&Vertex::at(point).unwrap()), 0.0);
        }
        assert_eq!(room.direct(&room.point()) > 0.0, half_width > 0.0);
    }
    // a whole ceiling over its edge is seen edge on
    let room = BoxRoom::new(Scene { light_half_width: 2.0, ..Scene::default() }).unwrap();
    for point in [[2.0, 0.3, 4.0], [2.0, 2.0, 4.0], [1.0, 1.0, 4.0]] {
        assert_eq!(room.direct(&Vertex::at(point).unwrap()), 0.0);
    }
}

/// Lights up to the whole ceiling, p in the middle of the cube's top, in its corner, and elsewhere:
/// half-width, p's x and y, and the part of two bounces for albedos and a radiance of 1, by
/// tests/data/two_bounces.py.
const TWO_BOUNCES: [(f64, [f64; 2], f64); 27] = [
    (0.5, [0.0, 0.0], 0.009975980387042279),
    (0.5, [0.5, -0.5], 0.010152748997395585),
    (0.5, [0.21, -0.43], 0.010068077054039933),
    (1.0, [0.0, 0.0], 0.040567707679614804),
    (1.0, [0.5, -0.5], 0.04108240469256288),
    (1.0, [0.21, -0.43], 0.040843442089380256),
    (1.2, [0.0, 0.0], 0.058769683842531318),
    (1.2, [0.5, -0.5], 0.05934669907600761),
    (1.2, [0.21, -0.43], 0.059087113901419767),
    (1.5, [0.0, 0.0], 0.092172326066653306),
    (1.5, [0.5, -0.5], 0.092605801718764196),
    (1.5, [0.21, -0.43], 0.092440486490090728),
    (1.9, [0.0, 0.0], 0.145252452823966264),
    (1.9, [0.5, -0.5], 0.144781679166209066),
    (1.9, [0.21, -0.43], 0.145113869978267033),
    (1.99, [0.0, 0.0], 0.157539550596856411),
    (1.99, [0.5, -0.5], 0.156743593260245248),
    (1.99, [0.21, -0.43], 0.157250497448360718),
    (1.999, [0.0, 0.0], 0.158738475194193826),
    (1.999, [0.5, -0.5], 0.157908922336847623),
    (1.999, [0.21, -0.43], 0.158433805505638651),
    (1.999999, [0.0, 0.0], 0.158870742028913175),
    (1.999999, [0.5, -0.5], 0.158037476387899969),
    (1.999999, [0.21, -0.43], 0.158564345417137392),
    (2.0, [0.0, 0.0], 0.158870874296065122),
    (2.0, [0.5, -0.5], 0.158037604943371936),
    (2.0, [0.21, -0.43], 0.158564475957737283),
];

/// Also where the light comes within a micrometre of the walls, and where it touches them.
#[test]
fn two_bounces_are_known_to_1e_12() {
    let of = |light_half_width, [x, y]: [f64; 2]| {
        let point = [x, y, 1.0];
        let scene = Scene {
            wall_albedo: 1.0,
            cube_albedo: 1.0,
            radiance: 1.0,
            light_half_width,
            point,
            ..Scene::default()
        };
        BoxRoom::new(scene).unwrap().two_bounces().unwrap()
    };
    let mut worst = 0.0f64;
    for (h, at, exact) in TWO_BOUNCES {
        let off = (of(h, at) / exact - 1.0).abs();
        println!("h = {h} at {at:?}: {off:.1e}");
        worst = worst.max(off);
    }
    assert!(worst <= 1e-12, "{worst:e}");
    // no jump where the cells change, or where they can be no smaller; L₂ rises by 0.13 of itself a metre at
    // the end, and by 1.6 or less elsewhere
    let steps = [0.9999999999, 1.0, 1.0000000001, 1.0000000002];
    let last = [1e-9, 1e-11, 1e-13, 0.0].map(|d| 2.0 - d);
    for h in [&steps[..], &last[..]] {
        for pair in h.windows(2) {
            let (one, other) = (of(pair[0], [0.1, 0.3]), of(pair[1], [0.1, 0.3]));
            let off = (other / one - 1.0).abs();
            assert!(off <= 3.0 * (pair[1] - pair[0]) + 1e-12, "{pair:?}: {off:e}");
        }
    }
}

#[test]
fn a_vertex_has_the_albedo_and_the_emission_of_its_face() {
    let scene = Scene { wall_albedo: 0.3, cube_albedo: 0.6, emission: 0.25, ..Scene::default() };
    let room = BoxRoom::new(scene).unwrap();
    for (point, albedo, emitted, light) in [
        ([0.0, 0.0, 1.0], 0.6, 0.25, false),
        ([0.5, 0.0, 0.5], 0.6, 0.25, false),
        ([1.5, 0.0, 0.0], 0.3, 0.25, false),
        ([2.0, 0.0, 2.0], 0.3, 0.25, false),
        ([0.51, 0.0, 4.0], 0.3, 0.25, false),
        ([0.5, -0.5, 4.0], 0.0, 10.0, true),
        ([0.0, 0.0, 4.0], 0.0, 10.0, true),
    ] {
        let vertex = Vertex::at(point).unwrap();
        assert_eq!((room.albedo(&vertex), room.emitted(&vertex)), (albedo, emitted), "{point:?}");
        assert_eq!(room.is_light(&vertex), light);
    }
    assert_eq!(*room.scene(), scene);
    let dark = BoxRoom::new(Scene { light_half_width: 0.0, ..scene }).unwrap();
    assert!(!dark.is_light(&Vertex::at([0.0, 0.0, 4.0]).unwrap()));
    assert_eq!(dark.light_area(), 0.0);
}

/// From low on a wall the cube hides no light, however wide: a line from there over its top meets the ceiling
/// more than 4 m away.
#[test]
fn the_cube_hides_nothing_from_the_walls() {
    for h in [0.5, 1.5, 1.99] {
        for z in [0.05, 0.5, 0.95] {
            for point in [[2.0, 0.3, z], [-2.0, -1.1, z], [0.4, 2.0, z], [1.3, -2.0, z]] {
                let scene = Scene { light_half_width: h, point, ..Scene::default() };
                let room = BoxRoom::new(scene).unwrap();
                let part = common::part_of_the_sky(&room.point(), h);
                let off = (room.one_bounce() / (0.5 * 10.0) - part).abs();
                assert!(off <= 4e-15, "{point:?}, h = {h}: {off:e} beside {part}");
            }
        }
    }
}

/// The part of the light that the cube leaves free, on the floor beside it: against n² points of the light. A
/// row of them meets the edge of the convex shadow twice, and is off by half a cell each time: together 1/n
/// of the light, times how much brighter than the mean a point may be, less than 1.5.
#[test]
fn the_cube_shades_the_floor_beside_it() {
    for ([x, y], h) in [([0.7, 0.1], 0.5), ([0.6, 0.55], 0.8), ([-0.45, 0.62], 1.7), ([-0.9, 0.0], 1.9)] {
        let scene = Scene { light_half_width: h, point: [x, y, 0.0], ..Scene::default() };
        let room = BoxRoom::new(scene).unwrap();
        let (p, n) = (room.point(), 2000);
        let at = |i: i32| -h + (2.0 * f64::from(i) + 1.0) * h / f64::from(n);
        let sum: f64 = (0..n)
            .into_par_iter()
            .map(|i| {
                let points = (0..n).map(|j| DVec3::new(at(i), at(j), 4.0));
                let seen = points.filter(|point| visible(&p, *point));
                // cos θ cos θ′/r², 4 m below
                seen.map(|point| 16.0 / (point - p.position()).length_squared().powi(2)).sum::<f64>()
            })
            .sum();
        let cell = 4.0 * h * h / f64::from(n * n);
        let (found, free) = (0.5 * 10.0 * FRAC_1_PI * cell * sum, room.direct(&p));
        let off = (room.one_bounce() / found - 1.0).abs();
        println!("[{x}, {y}]: {:.3} of the light, off by {off:.1e}", found / free);
        assert!(
            off <= 1.5 / f64::from(n) * free / found && found < 0.995 * free,
            "[{x}, {y}]: {} for {found}",
            room.one_bounce()
        );
    }
    // from where the cube hides nothing
    for point in [[0.2, 0.1, 1.0], [0.5, 0.1, 0.4], [2.0, 0.3, 0.5], [1.7, 0.2, 0.0]] {
        let room = BoxRoom::new(Scene { point, ..Scene::default() }).unwrap();
        assert_eq!(room.one_bounce(), room.direct(&room.point()));
        assert_eq!(room.two_bounces().is_some(), point[2] == 1.0);
    }
}

// ---- light and scenes of any size

/// Light of any size that a scene may have is the same light: a power of two more of it, and every draw has
/// the same bits, in `f32` too, and through lights as small.
#[test]
fn light_of_any_size_is_the_same_light() {
    let fill = |estimator: &dyn Estimator| {
        let mut draws = [0.0; 300];
        estimator.fill(&mut Stream::new(common::seed(825), 0), &mut draws);
        draws
    };
    let scene = Scene { emission: 0.375, ..Scene::default() };
    for (most, emission) in [(3, 0.0), (3, scene.emission), (64, 0.0)] {
        for light in FindLight::ALL {
            let of = |times: f64| {
                let scene = Scene { radiance: scene.radiance * times, emission: emission * times, ..scene };
                paths(scene, UpTo(most), (Cosine, light))
            };
            let [double, single] = [fill(&of(1.0)), fill(&of(1.0).in_f32().unwrap())];
            assert!(single.iter().any(|draw| *draw > 0.0));
            for times in [-325, -130, 130, 325].map(|power| 2f64.powi(power)) {
                assert_eq!(fill(&of(times)), double.map(|draw| draw * times));
                assert_eq!(fill(&of(times).in_f32().unwrap()), single.map(|draw| draw * times));
            }
        }
    }
    // a light of 1e-49 m in its middle is a point of the same power
    let small = Scene { light_half_width: 5e-50, radiance: 1e99, ..Scene::default() };
    let paths = paths(small, Exactly(1), (Cosine, BySampling));
    for draws in [fill(&paths), fill(&paths.in_f32().unwrap())] {
        let exact = 0.8 * 10.0 / (9.0 * std::f64::consts::PI);
        assert!(draws.iter().all(|draw| (draw / exact - 1.0).abs() <= 1e-6), "{:?} for {exact}", draws[0]);
    }
}

/// In single precision the coin's least probability stands in for a q below it, and the mean stays.
#[test]
fn a_q_that_f32_has_not_is_its_least() {
    let seldom = paths(common::furnace(0.8), All(1e-60), (Cosine, ByChance));
    // directions and a coin of each vertex: one that lets the path go on, and one that ends it
    let script = [0.0, 0.0, 0.0, 0.9, 0.9, 0.9].repeat(32);
    let mut draws = [0.0; 32];
    seldom.in_f32().unwrap().fill(&mut Stream::scripted(&script), &mut draws);
    let once = 1.0 + 0.8 * 2f64.powi(24);
    assert!(draws.iter().all(|draw| (draw / once - 1.0).abs() <= 1e-6), "{draws:?}");
}

fn any_point() -> impl Strategy<Value = [f64; 3]> {
    let on_a_face = (select(Face::ALL.to_vec()), probability(), probability(), probability());
    let on_a_face = on_a_face.prop_map(|(face, u, v, w)| {
        let [low, high] = bounds(face);
        // the far end as it is, not to rounding
        (low + (high - low) * DVec3::new(u, v, w)).min(high).to_array()
    });
    prop_oneof![4 => on_a_face, 1 => prop::array::uniform3(any_number())]
}

/// Any bits, or a number that is allowed.
fn mostly(allowed: impl Strategy<Value = f64> + 'static) -> impl Strategy<Value = f64> {
    prop_oneof![9 => allowed, 1 => any_number()]
}

/// 0, or anything from 1e-100 to 1e100.
fn radiance() -> impl Strategy<Value = f64> {
    mostly(prop_oneof![
        1 => select(vec![0.0, -0.0, 1e-100, 1e100]),
        3 => (-100.0..100.0f64).prop_map(|power| 10f64.powf(power)),
    ])
}

fn any_scene() -> impl Strategy<Value = Scene> {
    let half_width = mostly(prop_oneof![
        0.0..=2.0f64,
        (-50.0..0.3f64).prop_map(|power| 10f64.powf(power)),
        select(vec![0.0, 1e-50, 2.0, 2f64.next_down()]),
    ]);
    let numbers = (mostly(probability()), mostly(probability()), radiance(), half_width, radiance());
    (numbers, any_point()).prop_map(|(numbers, point)| {
        let (wall_albedo, cube_albedo, radiance, light_half_width, emission) = numbers;
        Scene { wall_albedo, cube_albedo, radiance, light_half_width, emission, point }
    })
}

fn any_bounces() -> impl Strategy<Value = Bounces> {
    let q = prop_oneof![probability(), any_number(), 0.0..1.0f64];
    prop_oneof![
        (0..70u32).prop_map(Bounces::Exactly),
        (0..70u32).prop_map(Bounces::UpTo),
        q.prop_map(Bounces::All),
        Just(Bounces::AllByThroughput),
        any::<u32>().prop_map(Bounces::UpTo),
    ]
}

fn is_a_radiance(value: f64) -> bool {
    value == 0.0 || (1e-100..=1e100).contains(&value)
}

proptest! {
    #![proptest_config(config(1_500))]

    /// A scene of any bits is an error that is true, or a room in which every draw of every way is a number,
    /// in `f32` too.
    #[test]
    fn any_scene_is_lit_or_an_error(
        scene in any_scene(), bounces in any_bounces(), seed in any::<u64>(),
        directions in select(Hemisphere::ALL.to_vec()), light in select(FindLight::ALL.to_vec())
    ) {
        let sound = [scene.wall_albedo, scene.cube_albedo].iter().all(|albedo| (0.0..=1.0).contains(albedo))
            && is_a_radiance(scene.radiance)
            && is_a_radiance(scene.emission)
            && (scene.light_half_width == 0.0 || (1e-50..=2.0).contains(&scene.light_half_width));
        let room = match BoxRoom::new(scene) {
            Ok(room) => room,
            Err(Error::Parameter { .. }) => {
                prop_assert!(!sound);
                return Ok(());
            }
            Err(Error::Point { .. }) => {
                // a face's own points are its own, but for the light's and those under the cube
                let [x, y, z] = scene.point;
                let faces = Face::ALL.iter().filter(|face| {
                    let [low, high] = bounds(**face);
                    DVec3::from_array(scene.point).cmpge(low).all()
                        && DVec3::from_array(scene.point).cmple(high).all()
                });
                let hole = if z == 0.0 { 0.5 } else { scene.light_half_width };
                prop_assert!(sound && (faces.count() == 0 || x.abs().max(y.abs()) <= hole));
                return Ok(());
            }
            Err(other) => return Err(TestCaseError::fail(format!("{other}"))),
        };
        prop_assert!(sound);
        let p = room.point();
        let most = scene.radiance * room.albedo(&p);
        for known in [room.direct(&p), room.one_bounce()] {
            prop_assert!((0.0..=most).contains(&known), "{known:?} of {scene:?}");
        }
        prop_assert!(room.one_bounce() <= room.direct(&p));
        // where the rule's cells shrink it takes its time
        if scene.light_half_width < 1.0 {
            let two = room.two_bounces();
            prop_assert_eq!(two.is_some(), p.face() == Face::CubeTop);
            prop_assert!(two.is_none_or(|two| (0.0..=most * scene.wall_albedo).contains(&two)), "{two:?} of \
                {scene:?}");
        }
        let paths = match Paths::new(room, bounces, directions, light) {
            Ok(paths) => paths,
            Err(Error::Count { value, .. }) => {
                prop_assert!(value > 64);
                return Ok(());
            }
            Err(Error::Parameter { value, .. }) => {
                match bounces {
                    Bounces::All(q) => prop_assert!(!(q > 0.0 && q <= 0.9999)),
                    Bounces::AllByThroughput => prop_assert!(value > 0.999),
                    other => prop_assert!(false, "{other:?}"),
                }
                return Ok(());
            }
            Err(other) => return Err(TestCaseError::fail(format!("{other}"))),
        };
        prop_assert!(paths.doubt().map(|doubt| doubt.to_string()).is_none_or(|caution|
            !caution.contains("NaN")
            && !caution.contains("inf ")), "{:?}", paths.doubt());
        let mut rng = Stream::new(seed, 0);
        let mut draws = [f64::NAN; 40];
        paths.fill(&mut rng, &mut draws);
        let drawn: Vec<f64> = (0..4).map(|_| paths.draw(&mut rng)).collect();
        prop_assert!(draws.iter().chain(&drawn).all(|draw| *draw >= 0.0 && draw.is_finite()), "{draws:?} \
            {drawn:?} of \
            {paths:?}");
        match paths.in_f32() {
            Ok(single) => {
                let mut in_f32 = [f64::NAN; 40];
                single.fill(&mut rng, &mut in_f32);
                prop_assert!(in_f32.iter().all(|draw| *draw >= 0.0 && draw.is_finite()), "{in_f32:?} of \
                    {single:?}");
                // where every draw finds something, it does in f32
                let always = |draws: &[f64]| draws.iter().all(|draw| *draw > 0.0);
                prop_assert!(!always(&draws) || in_f32.iter().any(|draw| *draw > 0.0), "{in_f32:?} of \
                    {single:?}");
            }
            Err(Error::Parameter { .. }) => {}
            Err(other) => return Err(TestCaseError::fail(format!("{other}"))),
        }
    }
}
