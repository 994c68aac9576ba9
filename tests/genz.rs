//! Genz's families of integrands: their integrals.

mod common;

use proptest::prelude::*;
use unbiased::rectangle::{Family, Genz};

#[test]
fn bad_input_is_an_error() {
    assert!(Genz::new(Family::Gaussian, [0.0, 1.0], [0.5; 2]).is_err());
    assert!(Genz::new(Family::Gaussian, [1.0, 1.0], [0.5, 1.5]).is_err());
}

/// ∫ f over [0, 1]² by the Gauss–Legendre rule of five points on 40 × 40 parts of each of the four rectangles
/// that w divides the square into.
fn quadrature(f: impl Fn(f64, f64) -> f64, w: [f64; 2]) -> f64 {
    let rule = common::gauss(5);
    let [xs, ys] = w.map(|w| {
        let sides = [(0.0, w), (w, 1.0 - w)].map(|(low, length)| (low, length / 40.0));
        let parts =
            sides.into_iter().flat_map(|(low, part)| (0..40).map(move |i| (low + f64::from(i) * part, part)));
        let nodes =
            parts.flat_map(|(low, part)| rule.iter().map(move |(x, weight)| (low + part * x, part * weight)));
        nodes.collect::<Vec<_>>()
    });
    xs.iter().map(|(x, a)| ys.iter().map(|(y, b)| a * b * f(*x, *y)).sum::<f64>()).sum()
}

proptest! {
    #![proptest_config(common::config(24))]

    #[test]
    fn genz_families_have_their_integrals(
        a in 0.5..12.0, b in 0.5..12.0, u in 0.05..0.95, v in 0.05..0.95, family in 0usize..6,
    ) {
        let genz = Genz::new(Family::ALL[family], [a, b], [u, v]).unwrap();
        let size = quadrature(|x, y| genz.at(x, y).abs(), [u, v]);
        let off = (genz.integral() - quadrature(|x, y| genz.at(x, y), [u, v])).abs();
        // the rule's own error is below 1e-12 of the integrand's size for a ≤ 12
        prop_assert!(off <= 1e-11 * size, "{:?}: off by {off}", genz);
    }
}
