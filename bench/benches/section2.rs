//! Section 2: 1,024 independent points of the sheet's square, for each integrand of the test set.

use divan::Bencher;
use unbiased::Stream;
use unbiased::rectangle::{Integrand, Rectangle};
use unbiased_bench::{sum_of_drawn, sum_of_filled, uniforms};

fn main() {
    divan::main();
}

#[divan::bench]
fn uniform_numbers(bencher: Bencher) {
    let mut rng = Stream::new(1, 0);
    bencher.bench_local(|| sum_of_filled(&uniforms::<2>(), &mut rng, 1));
}

#[divan::bench(args = Integrand::ALL)]
fn filled(bencher: Bencher, f: &Integrand) {
    let (f, mut rng) = (*f, Stream::new(1, 0));
    let points = Rectangle::WORKSHEET.independent(move |x, y| f.at(x, y));
    bencher.bench_local(|| sum_of_filled(&points, &mut rng, 1));
}

#[divan::bench(args = Integrand::ALL)]
fn drawn(bencher: Bencher, f: &Integrand) {
    let (f, mut rng) = (*f, Stream::new(1, 0));
    let points = Rectangle::WORKSHEET.independent(move |x, y| f.at(x, y));
    bencher.bench_local(|| sum_of_drawn(&points, &mut rng, 1));
}
