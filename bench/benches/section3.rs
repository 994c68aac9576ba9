//! Section 3: 1,024 directions with incoming radiance L_i = 1 + sin θ cos φ, and with cos² θ, a power, which
//! is not vectorized.

use divan::Bencher;
use unbiased::Stream;
use unbiased::lambertian::{CosinePower, Lambertian, Light};
use unbiased_bench::{sum_of_drawn, sum_of_filled, uniforms};

fn main() {
    divan::main();
}

#[divan::bench]
fn uniform_numbers(bencher: Bencher) {
    let mut rng = Stream::new(1, 0);
    bencher.bench_local(|| sum_of_filled(&uniforms::<2>(), &mut rng, 1));
}

#[divan::bench]
fn cosine_filled(bencher: Bencher) {
    let mut rng = Stream::new(1, 0);
    let light = Lambertian::new(0.8).unwrap().cosine_estimator(|direction| 1.0 + direction.vector().x);
    bencher.bench_local(|| sum_of_filled(&light, &mut rng, 1));
}

#[divan::bench]
fn cosine_drawn(bencher: Bencher) {
    let mut rng = Stream::new(1, 0);
    let light = Lambertian::new(0.8).unwrap().cosine_estimator(|direction| 1.0 + direction.vector().x);
    bencher.bench_local(|| sum_of_drawn(&light, &mut rng, 1));
}

#[divan::bench]
fn uniform_filled(bencher: Bencher) {
    let mut rng = Stream::new(1, 0);
    let light = Lambertian::new(0.8).unwrap().uniform_estimator(|direction| 1.0 + direction.vector().x);
    bencher.bench_local(|| sum_of_filled(&light, &mut rng, 1));
}

#[divan::bench]
fn uniform_drawn(bencher: Bencher) {
    let mut rng = Stream::new(1, 0);
    let light = Lambertian::new(0.8).unwrap().uniform_estimator(|direction| 1.0 + direction.vector().x);
    bencher.bench_local(|| sum_of_drawn(&light, &mut rng, 1));
}

#[divan::bench]
fn a_power_of_the_cosine(bencher: Bencher) {
    let (power, mut rng) = (CosinePower::new(2.0).unwrap(), Stream::new(1, 0));
    let light = Lambertian::new(0.8).unwrap().cosine_estimator(move |direction| power.incoming(direction));
    bencher.bench_local(|| sum_of_filled(&light, &mut rng, 1));
}
