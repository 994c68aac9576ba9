//! Shared by the benchmarks: draws made many at a time, and summed.

use unbiased::{Estimator, Stream, from_uniforms};

/// A number of draws that stays in the first-level cache, as in a run.
pub const SLICE: usize = 1024;

/// Sums `slices` slices of draws made by `fill`: a bare loop.
#[inline(never)]
pub fn sum_of_filled(estimator: &(impl Estimator + ?Sized), rng: &mut Stream, slices: usize) -> f64 {
    let mut draws = [0.0; SLICE];
    let mut sums = [0.0; 16];
    for _ in 0..slices {
        estimator.fill(rng, &mut draws);
        for row in draws.as_chunks::<16>().0 {
            for (sum, draw) in sums.iter_mut().zip(row) {
                *sum += draw;
            }
        }
    }
    sums.iter().sum()
}

/// The same with one draw after another.
#[inline(never)]
pub fn sum_of_drawn(estimator: &(impl Estimator + ?Sized), rng: &mut Stream, slices: usize) -> f64 {
    (0..slices * SLICE).map(|_| estimator.draw(rng)).sum()
}

/// The same number of uniform numbers as an estimator takes per draw, and their sum.
pub fn uniforms<const N: usize>() -> impl Estimator {
    from_uniforms(|u: [f64; N]| u.iter().sum())
}
