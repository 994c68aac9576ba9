//! What seed 2024 draws: the same bits in every release that does not say otherwise, and on every machine,
//! whatever its vectors. A change here changes published numbers and needs a line in the changelog.

use unbiased::inversion::Exponential;
use unbiased::lambertian::Lambertian;
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::paths::room::{BoxRoom, Scene};
use unbiased::paths::{Bounces, FindLight, Paths};
use unbiased::rectangle::{Integrand, Rectangle};
use unbiased::roulette::{LightModel, Roulette};
use unbiased::{Estimate, Estimator, Stream, from_fn};

use Bounces::{All, AllByThroughput, UpTo};
use FindLight::{ByChance, BySampling};
use Hemisphere::{Cosine, Uniform};

/// The first of a thousand draws that are filled, their mean, a hash of their bits, and one of those of a
/// hundred that are drawn one by one.
type Pinned = (f64, f64, u64, u64);

fn rows() -> Vec<(&'static str, Box<dyn Estimator>)> {
    let by = |scene, bounces, directions, light| {
        Paths::new(BoxRoom::new(scene).unwrap(), bounces, directions, light).unwrap()
    };
    let sheet = |bounces| by(Scene::default(), bounces, Cosine, BySampling);
    let scene = Scene { light_half_width: 1.9, emission: 0.125, ..Scene::default() };
    let lit = |bounces, directions, light| by(scene, bounces, directions, light);
    let surface = Lambertian::new(0.8).unwrap();
    let light = |direction: &Direction| 1.0 + direction.vector().x;
    let roulette = Roulette::new(0.8).unwrap();
    let model = LightModel::new(0.61, 0.3).unwrap();
    let r = Rectangle::new([0.3, 2.0], [-1.1, 3.0]).unwrap();
    let f = |x: f64, y: f64| x + 2.0 * y;
    vec![
        ("exponential", Box::new(Exponential::new(0.37).unwrap())),
        ("bounces by inversion", Box::new(roulette.bounces().by_inversion().unwrap())),
        ("bounces by simulation", Box::new(roulette.bounces().by_simulation().unwrap())),
        ("X_rr of U", Box::new(roulette.wrap(from_fn(|rng| rng.uniform())))),
        ("light by roulette", Box::new(model.roulette(0.83).unwrap())),
        ("light truncated", Box::new(model.truncated(3).unwrap())),
        ("square", Box::new(Rectangle::WORKSHEET.independent(|x, y| Integrand::Gaussian.at(x, y)))),
        ("rectangle", Box::new(r.independent(f))),
        ("all pairs", Box::new(r.all_pairs(f, 4).unwrap())),
        ("jittered", Box::new(r.jittered(f, 3).unwrap())),
        ("16 Sobol points", Box::new(r.sobol(f, 16).unwrap())),
        ("100 Sobol points", Box::new(r.sobol(f, 100).unwrap())),
        ("cosine", Box::new(surface.cosine_estimator(light))),
        ("uniform", Box::new(surface.uniform_estimator(light))),
        ("cosine, f/p", Box::new(surface.estimator(light, Cosine))),
        ("uniform, f/p", Box::new(surface.estimator(light, Uniform))),
        ("up to 3", Box::new(sheet(UpTo(3)))),
        ("all", Box::new(sheet(All(0.7)))),
        ("by throughput", Box::new(sheet(AllByThroughput))),
        ("in f32", Box::new(sheet(UpTo(3)).in_f32().unwrap())),
        ("lit, sampled, uniform", Box::new(lit(UpTo(3), Uniform, BySampling))),
        ("lit, by chance", Box::new(lit(UpTo(3), Cosine, ByChance))),
        ("lit, by chance, uniform, by throughput", Box::new(lit(AllByThroughput, Uniform, ByChance))),
        ("lit, by chance, all", Box::new(lit(All(0.8), Cosine, ByChance))),
    ]
}

const GOLDEN: [Pinned; 24] = [
    (1.0810447721369132, 2.6085386462547215, 0x2538a6a929bdfe0d, 0x4f17e520898fe104),
    (1.0, 3.834, 0x81aee418f0a72333, 0x7388b341fd8d0d66),
    (6.0, 4.068, 0xfc6a0a5ff3fe3e4a, 0x55d0cd47e1f78223),
    (0.6549430814788889, 0.5218383621574731, 0xaf5c9379481b99dd, 0xaff2b9d0dc239b7b),
    (0.29953328814549707, 0.8054837251319443, 0x9e66ddef9d76a480, 0xb0d34bf54be49915),
    (0.226981, 0.677267132, 0x01a11ba6b022aadf, 0x24113d2f4fdb3a72),
    (9.966364642925692, 3.145517497805223, 0xb827684438f3b685, 0x02700b57a473c530),
    (20.609364573238523, 21.979785342781444, 0xe3a2076360ccb1a1, 0xfa4e6e066c0b1f40),
    (20.9054339617293, 21.466710729991892, 0xc69efb452cdaf301, 0xd7380c5337d1cba5),
    (19.870499186574904, 21.37750950296628, 0xff26035db6b6d64d, 0xd4ca45edc60893a2),
    (20.976583639653626, 21.25394267802933, 0xe0d7729a36dbe371, 0x5c92f0ad9de4db06),
    (21.301598908389142, 21.256379685344776, 0x1150631937dce9e8, 0xc4f9f1b360fb9600),
    (0.3458571039628705, 0.7911684900456099, 0x5726cd2b12364617, 0x3246d7edad8501ed),
    (0.28564091483761483, 0.8036981819437546, 0xd2f97ef43e840d95, 0x03356aafd80e88a9),
    (0.34585710396287045, 0.7911684900456099, 0x96f5e7f2f61a1c3d, 0xea33c1986fb7fcb1),
    (0.28564091483761483, 0.8036981819437545, 0x1e4a6c352dc00285, 0xa39aa0d1ee334c60),
    (0.2954084286837314, 0.3358099546365098, 0x110c1941d90c9847, 0xd05f2234fa48f0fb),
    (0.38270034720132856, 0.357889561007151, 0x17f7b5d193215657, 0x74a0e9af81761865),
    (0.3076832193774369, 0.35621304461793707, 0xb98a5aa15def746c, 0xb2fe28a6cf260257),
    (0.2954084873199463, 0.3358099442720413, 0x2c7b712db16a916f, 0xeaa5a019a253ae87),
    (4.996741177937903, 3.5972214530574487, 0x5f9ef8ee60e9decf, 0x8c73755aefcbb36b),
    (4.225, 3.64756, 0x2e6136226e6c8dd2, 0xdd96e972cb08bf79),
    (0.38406581027659725, 3.7324584900414717, 0xf6fa1b87b91ae9c5, 0x0969917b22199cb9),
    (6.5, 4.017381161047932, 0xb348353d77042075, 0xa6e220aabde82251),
];

#[test]
fn what_is_drawn_is_pinned_bit_for_bit() {
    for ((name, estimator), pinned) in rows().into_iter().zip(GOLDEN) {
        let mut draws = [0.0; 1000];
        estimator.fill(&mut Stream::new(2024, 5), &mut draws);
        let (first, mean) = (draws[0], Estimate::from_draws(&draws).mean());
        let all = draws.iter().fold(0u64, |hash, draw| hash.rotate_left(5) ^ draw.to_bits());
        let mut rng = Stream::new(2024, 5);
        let one_by_one =
            (0..100).fold(0u64, |hash, _| hash.rotate_left(5) ^ estimator.draw(&mut rng).to_bits());
        assert_eq!((first, mean, all, one_by_one), pinned, "{name}");
    }
}
