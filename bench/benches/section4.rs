//! Section 4: 1,024 paths through the box room, light sampled, cosine directions.

use divan::Bencher;
use unbiased::Stream;
use unbiased::lambertian::hemisphere::Hemisphere;
use unbiased::paths::room::{BoxRoom, Scene};
use unbiased::paths::{Bounces, FindLight, Paths};
use unbiased_bench::{sum_of_drawn, sum_of_filled};

fn main() {
    divan::main();
}

const BOUNCES: [&str; 6] =
    ["up to 1", "up to 2", "up to 3", "up to 15", "all, q = 0.7", "all, by throughput"];

fn paths(name: &str) -> Paths {
    let bounces = match name {
        "up to 1" => Bounces::UpTo(1),
        "up to 2" => Bounces::UpTo(2),
        "up to 3" => Bounces::UpTo(3),
        "up to 15" => Bounces::UpTo(15),
        "all, q = 0.7" => Bounces::All(0.7),
        _ => Bounces::AllByThroughput,
    };
    let room = BoxRoom::new(Scene::default()).unwrap();
    Paths::new(room, bounces, Hemisphere::Cosine, FindLight::BySampling).unwrap()
}

#[divan::bench(args = BOUNCES)]
fn filled(bencher: Bencher, name: &str) {
    let (paths, mut rng) = (paths(name), Stream::new(1, 0));
    bencher.bench_local(|| sum_of_filled(&paths, &mut rng, 1));
}

#[divan::bench(args = BOUNCES)]
fn filled_in_f32(bencher: Bencher, name: &str) {
    let (paths, mut rng) = (paths(name).in_f32().unwrap(), Stream::new(1, 0));
    bencher.bench_local(|| sum_of_filled(&paths, &mut rng, 1));
}

#[divan::bench(args = BOUNCES)]
fn drawn(bencher: Bencher, name: &str) {
    let (paths, mut rng) = (paths(name), Stream::new(1, 0));
    bencher.bench_local(|| sum_of_drawn(&paths, &mut rng, 1));
}
