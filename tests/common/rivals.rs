//! Rivals with given numbers, and their comparison.

use unbiased::Estimate;
use unbiased::trade::{Comparison, Measured, Nature};

/// Draws of these rivals: the std error of their mean is 1 % of σ.
const DRAWS: usize = 10_000;

/// A rival with these numbers.
pub fn measured(nature: Nature, mean: f64, variance: f64, seconds: f64) -> Measured {
    // draws with this mean and variance
    let apart = (variance * (DRAWS - 1) as f64 / DRAWS as f64).sqrt();
    let draws: Vec<f64> = (0..DRAWS).map(|i| if i % 2 == 0 { mean - apart } else { mean + apart }).collect();
    Measured {
        name: "rival".into(),
        series: None,
        nature,
        estimate: Estimate::from_draws(&draws),
        truth: 2.0,
        truth_error: 0.0,
        variance_error: 0.01 * variance,
        heavy_tail: false,
        evaluations: 1.0,
        random_numbers: 1.0,
        seconds,
        seconds_range: [seconds, seconds],
    }
}

pub fn named(name: &str, rival: Measured) -> Measured {
    Measured { name: name.into(), ..rival }
}

pub fn comparison(rivals: impl IntoIterator<Item = Measured>) -> Comparison {
    Comparison { seed: 1, truth: 2.0, truth_error: 0.0, rivals: rivals.into_iter().collect() }
}
