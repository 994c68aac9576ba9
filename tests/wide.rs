//! Estimators that are filled many at a time: the furnace, light of any size, single precision, pinned bits.

mod common;

use unbiased::inversion::Exponential;
use unbiased::lambertian::Lambertian;
use unbiased::lambertian::hemisphere::Hemisphere;
use unbiased::paths::room::{BoxRoom, Scene};
use unbiased::paths::{Bounces, FindLight, Paths};
use unbiased::rectangle::{Integrand, Rectangle};
use unbiased::roulette::Roulette;
use unbiased::{Estimate, Estimator, Stream};

fn paths(scene: Scene, bounces: Bounces, directions: Hemisphere, light: FindLight) -> Paths {
    Paths::new(BoxRoom::new(scene).unwrap(), bounces, directions, light).unwrap()
}

/// In the furnace every path of k bounces has the same light, ρ of the cube's top times ρ of the walls it
/// sees: nothing is off.
#[test]
fn the_furnace_is_exact_side_by_side() {
    let furnace = Scene { light_half_width: 0.0, emission: 1.0, ..Scene::default() };
    for (k, exact) in [(0, 1.0), (1, 0.8), (2, 0.4)] {
        let mut draws = [0.0; 1000];
        let cosine = paths(furnace, Bounces::Exactly(k), Hemisphere::Cosine, FindLight::BySampling);
        cosine.fill(&mut Stream::new(common::seed(820), 0), &mut draws);
        assert!(draws.iter().all(|draw| *draw == exact), "{k} bounces");
    }
}

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
                paths(scene, Bounces::UpTo(most), Hemisphere::Cosine, light)
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
    let paths = paths(small, Bounces::Exactly(1), Hemisphere::Cosine, FindLight::BySampling);
    for draws in [fill(&paths), fill(&paths.in_f32().unwrap())] {
        let exact = 0.8 * 10.0 / (9.0 * std::f64::consts::PI);
        assert!(draws.iter().all(|draw| (draw / exact - 1.0).abs() <= 1e-6), "{:?} for {exact}", draws[0]);
    }
}

#[test]
fn what_leaves_f32_is_an_error() {
    let of = |scene: Scene, bounces| {
        let all = paths(scene, bounces, Hemisphere::Cosine, FindLight::BySampling);
        all.in_f32().map(|_| ()).map_err(|error| error.to_string())
    };
    let dark = |wall_albedo| Scene { wall_albedo, ..Scene::default() };
    assert_eq!(of(dark(0.5), Bounces::Exactly(64)), Ok(()));
    assert_eq!(of(dark(0.0), Bounces::Exactly(64)), Ok(()));
    assert_eq!(
        of(dark(0.25), Bounces::Exactly(64)).unwrap_err(),
        format!(
            "the least albedo, to the power of the bounces, must be at least 1e-25 in single precision, not \
             {:?}",
            0.25f64.powi(64)
        )
    );
    assert_eq!(of(dark(1e-9), Bounces::UpTo(64)), Ok(()));
    for bounces in [Bounces::UpTo(2), Bounces::AllByThroughput, Bounces::All(0.5), Bounces::Exactly(2)] {
        assert!(of(dark(1e-13), bounces).is_err());
    }
    assert_eq!(of(dark(1e-13), Bounces::UpTo(1)), Ok(()));
    let faint = Scene { emission: 1e-10, ..Scene::default() };
    assert!(of(faint, Bounces::UpTo(2)).unwrap_err().starts_with(
        "the faces' emission, in parts of the light's, must be 0 or at least 1e-10 in single precision, not \
         3.14"
    ));
    assert_eq!(of(Scene { light_half_width: 0.0, ..faint }, Bounces::UpTo(2)), Ok(()));
    assert_eq!(of(Scene { radiance: 0.0, ..faint }, Bounces::UpTo(2)), Ok(()));
    assert_eq!(of(Scene { radiance: 0.0, ..Scene::default() }, Bounces::UpTo(2)), Ok(()));
    // a q that f32 has not: the coin's least probability in its place, and the mean stays
    let furnace = Scene { light_half_width: 0.0, emission: 1.0, ..Scene::default() };
    let seldom = paths(furnace, Bounces::All(1e-60), Hemisphere::Cosine, FindLight::ByChance);
    // directions and a coin of each vertex: one that lets the path go on, and one that ends it
    let script = [0.0, 0.0, 0.0, 0.9, 0.9, 0.9].repeat(32);
    let mut draws = [0.0; 32];
    seldom.in_f32().unwrap().fill(&mut Stream::scripted(&script), &mut draws);
    let once = 1.0 + 0.8 * 2f64.powi(24);
    assert!(draws.iter().all(|draw| (draw / once - 1.0).abs() <= 1e-6), "{draws:?}");
}

fn wide_ones() -> Vec<(&'static str, Box<dyn Estimator>)> {
    let by = |bounces| paths(Scene::default(), bounces, Hemisphere::Cosine, FindLight::BySampling);
    let surface = Lambertian::new(0.8).unwrap();
    let light = |direction: &unbiased::lambertian::hemisphere::Direction| 1.0 + direction.vector().x;
    vec![
        ("exponential", Box::new(Exponential::new(0.37).unwrap())),
        ("bounces", Box::new(Roulette::new(0.8).unwrap().bounces().by_inversion().unwrap())),
        ("square", Box::new(Rectangle::WORKSHEET.independent(|x, y| Integrand::Gaussian.at(x, y)))),
        ("cosine", Box::new(surface.cosine_estimator(light))),
        ("uniform", Box::new(surface.uniform_estimator(light))),
        ("up to 3", Box::new(by(Bounces::UpTo(3)))),
        ("all", Box::new(by(Bounces::All(0.7)))),
        ("by weight", Box::new(by(Bounces::AllByThroughput))),
        ("in f32", Box::new(by(Bounces::UpTo(3)).in_f32().unwrap())),
    ]
}

/// What seed 2024 fills: the same bits in every release that does not say otherwise, and on every machine,
/// whatever its vectors.
#[test]
fn what_is_filled_is_pinned_bit_for_bit() {
    for ((name, estimator), golden) in wide_ones().into_iter().zip(GOLDEN) {
        let mut draws = [0.0; 1000];
        estimator.fill(&mut Stream::new(2024, 5), &mut draws);
        let all = draws.iter().fold(0u64, |hash, draw| hash.rotate_left(5) ^ draw.to_bits());
        let mean = Estimate::from_draws(&draws).mean();
        assert_eq!((draws[0], mean, all), golden, "{name}");
    }
}

/// The first draw, the mean of a thousand, and all of their bits.
const GOLDEN: [(f64, f64, u64); 9] = [
    (1.0810447721369132, 2.6085386462547215, 0x2538a6a929bdfe0d),
    (1.0, 3.834, 0x81aee418f0a72333),
    (9.966364642925692, 3.145517497805223, 0xb827684438f3b685),
    (0.3458571039628705, 0.7911684900456099, 0x5726cd2b12364617),
    (0.28564091483761483, 0.8036981819437546, 0xd2f97ef43e840d95),
    (0.2954084286837314, 0.3358099546365098, 0x110c1941d90c9847),
    (0.38270034720132856, 0.357889561007151, 0x17f7b5d193215657),
    (0.3076832193774369, 0.35621304461793707, 0xb98a5aa15def746c),
    (0.2954084873199463, 0.3358099442720413, 0x2c7b712db16a916f),
];
