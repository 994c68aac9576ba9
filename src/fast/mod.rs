//! Functions and loops that go wide: plain sums, products and selections, which the compiler turns into vector instructions.
//!
//! [`ln`], [`exp`] and [`sin_cos_of_turns`] are what drawing needs of a mathematical library, within 2 units of the last place and without a branch or a call, so
//! that a loop over them is vectorised. The crate's own loops are compiled for each of a processor's instruction sets and chosen as the program runs; nothing has to be asked
//! of the compiler. An integrand or a light of one's own goes wide in the same way if nothing but arithmetic and these functions is in it.
//!
//! # The same bits
//! A sum or a product is rounded alike in every instruction set, and none is fused unless the source says so. So these functions and everything
//! that is drawn with them have the same bits on every machine with IEEE 754 arithmetic, which `std`'s `ln`, `exp` and `sin` do not promise.

use pulp::{Arch, NullaryFnOnce};

mod exp;
mod ln;
mod real;
mod turns;

pub use exp::exp;
pub use ln::ln;
pub(crate) use real::Real;
pub use turns::sin_cos_of_turns;

/// Runs a loop, compiled for the widest vectors that this processor has.
///
/// `kernel`'s `call` has to be `#[inline(always)]`, and what it calls inlined into it, or it stays as narrow as the rest of the crate.
#[inline]
pub(crate) fn widest<K: NullaryFnOnce>(kernel: K) -> K::Output {
    #[cfg(test)]
    if tests::NARROW.get() {
        return kernel.call();
    }
    Arch::new().dispatch(kernel)
}

/// `f` of every number of a slice, in place.
#[inline]
pub(crate) fn map<F: Fn(f64) -> f64>(numbers: &mut [f64], f: F) {
    widest(Map { numbers, f });
}

struct Map<'a, F> {
    numbers: &'a mut [f64],
    f: F,
}

impl<F: Fn(f64) -> f64> NullaryFnOnce for Map<'_, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for number in self.numbers {
            *number = (self.f)(*number);
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use std::cell::Cell;

    thread_local! {
        /// Whether this thread runs its loops without vectors wider than all processors have.
        pub(crate) static NARROW: Cell<bool> = const { Cell::new(false) };
    }

    /// The same computation with the processor's widest vectors, and without.
    pub(crate) fn both<T>(compute: impl Fn() -> T) -> [T; 2] {
        let wide = compute();
        NARROW.set(true);
        let narrow = compute();
        NARROW.set(false);
        [wide, narrow]
    }
}
