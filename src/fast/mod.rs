//! Branch-free functions and loops of plain sums, products and selections, which the compiler turns into
//! vector instructions.
//!
//! [`ln`], [`exp`], [`floor`] and [`sin_cos_of_turns`] are the mathematical functions that sampling needs,
//! accurate to 2 units in the last place and without branches or calls, so that a loop over them is
//! vectorised. The crate's loops are compiled for several instruction sets, and the best one is chosen at run
//! time; no compiler flags are needed. Your own integrand or light is vectorised, too, if it contains only
//! arithmetic and these functions.
//!
//! # The same bits
//! Sums and products are rounded alike in every instruction set, and they are not fused unless the source
//! says so. So these functions, and all draws made with them, have the same bits on every machine with IEEE
//! 754 arithmetic, which `std`'s `ln`, `exp` and `sin` do not guarantee.

use pulp::{Arch, NullaryFnOnce};

mod exp;
mod floor;
mod ln;
mod real;
mod turns;

pub use exp::exp;
pub use floor::floor;
pub use ln::ln;
pub(crate) use real::Real;
pub use turns::sin_cos_of_turns;

/// Runs a loop compiled for the widest vectors of this processor.
///
/// `kernel`'s `call` must be `#[inline(always)]` with everything that it calls inlined, or it is compiled for
/// the crate's default vectors.
#[inline]
pub(crate) fn widest<K: NullaryFnOnce>(kernel: K) -> K::Output {
    #[cfg(test)]
    if tests::NARROW.get() {
        return kernel.call();
    }
    Arch::new().dispatch(kernel)
}

/// Whether no number is NaN or infinite.
#[inline]
pub(crate) fn all_finite(numbers: &[f64]) -> bool {
    widest(AllFinite(numbers))
}

struct AllFinite<'a>(&'a [f64]);

impl NullaryFnOnce for AllFinite<'_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        // no early exit, which would prevent vectorisation
        self.0.iter().fold(true, |finite, number| finite & number.is_finite())
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use std::cell::Cell;

    use super::*;
    use crate::inversion::Exponential;
    use crate::lambertian::Lambertian;
    use crate::rectangle::{Integrand, Rectangle};
    use crate::roulette::Roulette;
    use crate::{Estimate, Estimator, Stream};

    thread_local! {
        /// Whether this thread runs its loops with the default vectors only.
        pub(crate) static NARROW: Cell<bool> = const { Cell::new(false) };
    }

    /// The results of a computation with the processor's widest vectors, and without.
    pub(crate) fn both<T>(compute: impl Fn() -> T) -> [T; 2] {
        let wide = compute();
        NARROW.set(true);
        let narrow = compute();
        NARROW.set(false);
        [wide, narrow]
    }

    /// For every estimator that computes many draws at a time, and for their sums.
    #[test]
    fn wide_and_narrow_loops_have_the_same_bits() {
        let square = Rectangle::WORKSHEET;
        let cube = Lambertian::new(0.8).unwrap();
        let bounces = Roulette::new(0.83).unwrap().bounces().by_inversion().unwrap();
        let estimators: [Box<dyn Estimator>; 7] = [
            Box::new(Exponential::new(0.37).unwrap()),
            Box::new(Exponential::new(1e-320).unwrap()),
            Box::new(bounces),
            Box::new(square.independent(|x, y| Integrand::Gaussian.at(x, y))),
            Box::new(square.independent(|x, y| Integrand::Disc.at(x, y))),
            Box::new(cube.cosine_estimator(|direction| 1.0 + direction.vector().x)),
            Box::new(cube.uniform_estimator(|direction| 1.0 + direction.vector().x)),
        ];
        for (seed, estimator) in (0..).zip(&estimators) {
            for count in [1, 15, 512, 1003] {
                let [wide, narrow] = both(|| {
                    let (mut rng, mut draws) = (Stream::new(seed, 3), vec![0.0; count]);
                    estimator.fill(&mut rng, &mut draws);
                    let bits: Vec<u64> = draws.iter().map(|draw| draw.to_bits()).collect();
                    (bits, format!("{:?}", Estimate::from_draws(&draws)), rng.random_numbers())
                });
                assert_eq!(wide, narrow, "estimator {seed}, {count} draws");
            }
        }
    }

    #[test]
    fn a_number_that_is_not_finite_is_found_anywhere() {
        for count in [1, 7, 64, 512] {
            assert!(all_finite(&vec![f64::MAX; count]));
            for place in 0..count {
                for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                    let mut numbers = vec![1.0; count];
                    numbers[place] = bad;
                    assert!(!all_finite(&numbers));
                }
            }
        }
    }
}
