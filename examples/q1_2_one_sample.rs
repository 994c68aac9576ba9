//! Question 1.2: which value does U = 0.75 sample, for λ = 1?
//!
//! x = −ln(1 − 0.75) = ln 4, by the formula and by inverting the cdf numerically.

use std::process::ExitCode;

use unbiased::inversion::{Exponential, Inversion};
use unbiased::workbook::{self, Answer, Options};
use unbiased::{Result, figure};

/// The answers, as the options ask.
pub fn answer(options: &Options) -> Result<Vec<Answer>> {
    let (rate, u) = (options.number("rate"), options.number("u"));
    let exponential = Exponential::new(rate)?;
    let x = exponential.inverse_cdf(u)?;
    let any_cdf = Inversion::new(|x| exponential.cdf(x), [0.0, f64::INFINITY])?;

    Ok(vec![
        Answer::new("1.2", "the sample x")
            .parameter("rate", rate)
            .parameter("u", u)
            .truth(x)
            .value(any_cdf.inverse_cdf(u)?)
            .figure(figure::exponential(&exponential, u, options.edition)?),
        Answer::new("1.2", "the density there")
            .parameter("rate", rate)
            .parameter("u", u)
            .truth(rate * (1.0 - u))
            .value(exponential.pdf(x)),
    ])
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::main("1.2", answer)
}
