//! Question 1.3: what does the x-axis of the cdf stand for?
//!
//! It is the values that can be sampled. So the share of samples at most x must be F(x): counted here at x =
//! 1/λ, where F = 1 − 1/e for every λ.

use rand::distr::Distribution;
use unbiased::inversion::Exponential;
use unbiased::workbook::{self, Sheet};
use unbiased::{Result, from_fn};

/// A sentence, and the share that it is about.
pub fn answer(sheet: &Sheet) -> Result<()> {
    let exponential = Exponential::new(sheet.number("rate"))?;
    let x = exponential.mean();
    let share = from_fn(|rng| {
        let sample: f64 = exponential.sample(rng);
        if sample <= x { 1.0 } else { 0.0 }
    });
    sheet.row("what the axes stand for").note(
        "The x-axis holds the values that can be sampled, here all x ≥ 0; the height of the curve at x is \
         the share of samples at most x.",
    );
    sheet.row("share of samples at most x").parameter("x", x).truth(exponential.cdf(x)).estimate(&share)?;
    Ok(())
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> std::process::ExitCode {
    workbook::main("1.3", answer)
}
