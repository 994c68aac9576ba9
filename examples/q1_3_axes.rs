//! Question 1.3: what does the x-axis of the cdf stand for?
//!
//! The values that can be sampled. So the share of samples at most x must be F(x): counted here at x = 1/λ, where
//! F = 1 − 1/e whatever λ is.

use std::process::ExitCode;

use rand::distr::Distribution;
use unbiased::inversion::Exponential;
use unbiased::workbook::{self, Answer, Options};
use unbiased::{Result, from_fn};

/// The answers, as the options ask.
pub fn answer(options: &Options) -> Result<Vec<Answer>> {
    let exponential = Exponential::new(options.number("rate"))?;
    let x = exponential.mean();
    let share = from_fn(|rng| {
        let sample: f64 = exponential.sample(rng);
        if sample <= x { 1.0 } else { 0.0 }
    });
    Ok(vec![
        Answer::new("1.3", "what the axes stand for").note(
            "The x-axis holds the values that can be sampled, here all x ≥ 0; the height of the curve at x is the share of samples at most x.",
        ),
        Answer::new("1.3", "share of samples at most x")
            .parameter("rate", exponential.rate())
            .parameter("x", x)
            .truth(exponential.cdf(x))
            .outcome(&options.run(&share, 1_000_000)?),
    ])
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::main("1.3", answer)
}
