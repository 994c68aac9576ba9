//! Section 5: 1,024 numbers of bounces, by inversion and by coins.

use divan::Bencher;
use unbiased::Stream;
use unbiased::roulette::Roulette;
use unbiased_bench::{sum_of_drawn, sum_of_filled, uniforms};

fn main() {
    divan::main();
}

#[divan::bench]
fn uniform_numbers(bencher: Bencher) {
    let mut rng = Stream::new(1, 0);
    bencher.bench_local(|| sum_of_filled(&uniforms::<1>(), &mut rng, 1));
}

#[divan::bench]
fn by_inversion_filled(bencher: Bencher) {
    let (bounces, mut rng) =
        (Roulette::new(0.8).unwrap().bounces().by_inversion().unwrap(), Stream::new(1, 0));
    bencher.bench_local(|| sum_of_filled(&bounces, &mut rng, 1));
}

#[divan::bench]
fn by_inversion_drawn(bencher: Bencher) {
    let (bounces, mut rng) =
        (Roulette::new(0.8).unwrap().bounces().by_inversion().unwrap(), Stream::new(1, 0));
    bencher.bench_local(|| sum_of_drawn(&bounces, &mut rng, 1));
}

#[divan::bench]
fn by_coins(bencher: Bencher) {
    let (bounces, mut rng) =
        (Roulette::new(0.8).unwrap().bounces().by_simulation().unwrap(), Stream::new(1, 0));
    bencher.bench_local(|| sum_of_drawn(&bounces, &mut rng, 1));
}
