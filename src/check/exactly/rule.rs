//! The quadrature rule of a piece, and the polynomial through its nodes.

use std::f64::consts::PI;

use pulp::NullaryFnOnce;

use crate::fast::widest;

pub const NODES: usize = 17;

/// Points on a line that are computed at once.
pub const LANES: usize = 16;

/// Node on [−1, 1], weight on a piece of width 1, and weight in the coarser rule on every second node.
pub type Rule = [(f64, f64, f64); NODES];

/// The rules of Clenshaw & Curtis (1960) with 17 points and, on every second of them, with 9.
pub fn nested_rule() -> Rule {
    let weight = |k: usize, n: usize| {
        let angle = PI * k as f64 / n as f64;
        let sum: f64 = (1..=n / 2)
            .map(|j| {
                let last = if 2 * j == n { 1.0 } else { 2.0 };
                last * (2.0 * j as f64 * angle).cos() / (4 * j * j - 1) as f64
            })
            .sum();
        (if k.is_multiple_of(n) { 0.5 } else { 1.0 }) * (1.0 - sum) / n as f64
    };
    std::array::from_fn(|k| {
        let node = -(PI * k as f64 / 16.0).cos();
        (node, weight(k, 16), if k.is_multiple_of(2) { weight(k / 2, 8) } else { 0.0 })
    })
}

/// Chebyshev coefficients of the polynomial through these values at the nodes.
pub fn chebyshev(values: &[f64; NODES]) -> [f64; NODES] {
    let half_at_ends = |k: usize| if k.is_multiple_of(NODES - 1) { 0.5 } else { 1.0 };
    std::array::from_fn(|k| {
        let term = |(j, value): (usize, &f64)| {
            // the nodes are −cos(π j/16)
            half_at_ends(j) * value * (PI * (k * (16 - j) % 32) as f64 / 16.0).cos()
        };
        half_at_ends(k) * values.iter().enumerate().map(term).sum::<f64>() / 8.0
    })
}

/// The polynomial with these coefficients at several points (Clenshaw 1955).
pub fn polynomial(coefficients: &[f64; NODES], places: &[f64; LANES]) -> [f64; LANES] {
    widest(Clenshaw { coefficients, places })
}

struct Clenshaw<'a> {
    coefficients: &'a [f64; NODES],
    places: &'a [f64; LANES],
}

impl NullaryFnOnce for Clenshaw<'_> {
    type Output = [f64; LANES];

    #[inline(always)]
    fn call(self) -> [f64; LANES] {
        let (mut next, mut after) = ([0.0; LANES], [0.0; LANES]);
        let [constant, others @ ..] = self.coefficients;
        for coefficient in others.iter().rev() {
            for lane in 0..LANES {
                let this = coefficient + 2.0 * self.places[lane] * next[lane] - after[lane];
                (next[lane], after[lane]) = (this, next[lane]);
            }
        }
        std::array::from_fn(|lane| constant + self.places[lane] * next[lane] - after[lane])
    }
}
