//! Section 1: the exponential distribution, filled and drawn, against rand_distr's ziggurat. Times are for
//! 1,024 draws.

use divan::{Bencher, black_box};
use rand::SeedableRng;
use rand_distr::{Distribution, Exp1};
use rand_xoshiro::Xoshiro256PlusPlus;
use unbiased::Stream;
use unbiased::inversion::Exponential;
use unbiased_bench::{SLICE, sum_of_drawn, sum_of_filled, uniforms};

fn main() {
    divan::main();
}

#[divan::bench]
fn uniform_numbers(bencher: Bencher) {
    let mut rng = Stream::new(1, 0);
    bencher.bench_local(|| sum_of_filled(&uniforms::<1>(), &mut rng, 1));
}

#[divan::bench]
fn filled(bencher: Bencher) {
    let (exponential, mut rng) = (Exponential::new(black_box(1.0)).unwrap(), Stream::new(1, 0));
    bencher.bench_local(|| sum_of_filled(&exponential, &mut rng, 1));
}

#[divan::bench]
fn drawn(bencher: Bencher) {
    let (exponential, mut rng) = (Exponential::new(black_box(1.0)).unwrap(), Stream::new(1, 0));
    bencher.bench_local(|| sum_of_drawn(&exponential, &mut rng, 1));
}

#[divan::bench]
fn rand_distr_ziggurat(bencher: Bencher) {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    bencher.bench_local(|| (0..SLICE).map(|_| -> f64 { Exp1.sample(&mut rng) }).sum::<f64>());
}
