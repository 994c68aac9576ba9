//! One table of all estimators, and what holds for each: filled draws are those drawn one at a time, on
//! placed numbers and on independent ones.

mod common;

use unbiased::inversion::{Exponential, Inversion};
use unbiased::lambertian::Lambertian;
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::paths::room::{BoxRoom, Scene};
use unbiased::paths::{Bounces, FindLight, Paths, reflected};
use unbiased::placement::{jittered, sobol};
use unbiased::rectangle::{Integrand, Rectangle};
use unbiased::roulette::{LightModel, Roulette};
use unbiased::{Estimator, Stream, f_over_p, from_fn, from_uniforms};

/// Every estimator that the crate has, with how far a filled draw may be from a single one, relative to it.
fn all() -> Vec<(String, Box<dyn Estimator>, f64)> {
    let exponential = Exponential::new(0.37).unwrap();
    let square = Rectangle::WORKSHEET;
    let bell = |x: f64, y: f64| Integrand::Gaussian.at(x, y);
    let surface = Lambertian::new(0.8).unwrap();
    let light = |direction: &Direction| 1.0 + direction.vector().x;
    let roulette = Roulette::new(0.8).unwrap();
    let model = LightModel::new(0.8, 0.5).unwrap();
    let room = BoxRoom::new(Scene { emission: 0.3, ..Scene::default() }).unwrap();
    let normal = Inversion::new(|x: f64| 0.5 + 0.5 * x / (1.0 + x.abs()), [f64::NEG_INFINITY, f64::INFINITY]);
    let normal = normal.unwrap();
    let exact: Vec<(&str, Box<dyn Estimator>)> = vec![
        ("exponential", Box::new(exponential)),
        ("inversion", Box::new(from_fn(move |rng| rand::distr::Distribution::sample(&normal, rng)))),
        ("independent", Box::new(square.independent(bell))),
        ("f/p on the square", Box::new(f_over_p(move |&[x, y]: &[f64; 2]| bell(x, y), square))),
        ("all pairs", Box::new(square.all_pairs(bell, 9).unwrap())),
        ("jittered", Box::new(square.jittered(bell, 9).unwrap())),
        ("sobol", Box::new(square.sobol(bell, 100).unwrap())),
        ("cosine", Box::new(surface.cosine_estimator(light))),
        ("uniform", Box::new(surface.uniform_estimator(light))),
        ("f/p over directions", Box::new(surface.estimator(light, Hemisphere::Cosine))),
        ("bounces by inversion", Box::new(roulette.bounces().by_inversion().unwrap())),
        ("bounces by simulation", Box::new(roulette.bounces().by_simulation().unwrap())),
        ("X_rr", Box::new(roulette.wrap(exponential))),
        ("model, roulette", Box::new(model.roulette(0.8).unwrap())),
        ("model, truncated", Box::new(model.truncated(8).unwrap())),
        ("no number", Box::new(from_uniforms(|[]| 1.0))),
        ("five numbers", Box::new(from_uniforms(|u: [f64; 5]| u.iter().sum()))),
        ("reflected", Box::new(reflected(room, Hemisphere::Uniform, move |p_j, _| room.emitted(p_j)))),
        ("jittered X_rr", Box::new(jittered(roulette.wrap(exponential), 3).unwrap())),
    ];
    let exact = exact.into_iter().map(|(name, estimator)| (name.to_owned(), estimator, 0.0));
    let mut all: Vec<_> = exact.collect();
    for bounces in [Bounces::UpTo(3), Bounces::UpTo(15), Bounces::All(0.7), Bounces::AllByThroughput] {
        for light in FindLight::ALL {
            let paths = Paths::new(room, bounces, Hemisphere::Cosine, light).unwrap();
            // other roundings, which every further bounce makes more of
            all.push((format!("{bounces:?}, {light:?}"), Box::new(paths), 1e-12));
            all.push((format!("{bounces:?}, {light:?} in f32"), Box::new(paths.in_f32().unwrap()), 0.0));
            all.push((format!("sobol {bounces:?}, {light:?}"), Box::new(sobol(paths, 64).unwrap()), 0.0));
        }
    }
    all
}

/// In parts of any size, and one at a time: to the bit, or for paths side by side to rounding, with as many
/// numbers and evaluations.
#[test]
fn filling_is_drawing() {
    for (name, estimator, allowed) in all() {
        let (mut many, mut one) = (Stream::new(common::seed(7), 3), Stream::new(common::seed(7), 3));
        for part in [1, 31, 32, 33, 255, 256, 257, 1000, 5, 300].into_iter().cycle().take(40) {
            let mut filled = vec![f64::NAN; part];
            estimator.fill(&mut many, &mut filled);
            for draw in filled {
                let drawn = estimator.draw(&mut one);
                one.next_draw();
                assert!((draw - drawn).abs() <= allowed * drawn.abs(), "{name}: {draw:?} and {drawn:?}");
            }
        }
        let counted = |rng: &Stream| (rng.random_numbers(), rng.evaluations());
        assert_eq!(counted(&many), counted(&one), "{name}");
    }
}

/// In parts of any size a fill is the same fill, to the bit for paths, too.
#[test]
fn filling_in_parts_is_filling() {
    for (name, estimator, _) in all() {
        let mut whole = [0.0; 777];
        estimator.fill(&mut Stream::new(common::seed(8), 1), &mut whole);
        let (mut rng, mut parts) = (Stream::new(common::seed(8), 1), [0.0; 777]);
        for part in parts.chunks_mut(61) {
            estimator.fill(&mut rng, part);
        }
        assert_eq!(whole, parts, "{name}");
    }
}
