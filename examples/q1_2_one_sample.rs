//! Question 1.2: which value does U = 0.75 sample, for λ = 1?
//!
//! x = −ln(1 − 0.75) = ln 4, by the formula and by inverting the cdf numerically.

use unbiased::Result;
use unbiased::inversion::figures;
use unbiased::inversion::{Exponential, Inversion};
use unbiased::workbook::{self, Sheet};

/// The sample, and the density there.
pub fn answer(sheet: &Sheet) -> Result<()> {
    let (rate, u) = (sheet.number("rate"), sheet.number("u"));
    let exponential = Exponential::new(rate)?;
    let x = exponential.inverse_cdf(u)?;
    let any_cdf = Inversion::new(|x| exponential.cdf(x), [0.0, f64::INFINITY])?;

    sheet.row("the sample x").truth(x).value(any_cdf.inverse_cdf(u)?);
    sheet.drawing(|edition| figures::exponential(&exponential, u, edition))?;
    sheet.row("the density there").truth(rate * (1.0 - u)).value(exponential.pdf(x));
    Ok(())
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> std::process::ExitCode {
    workbook::main("1.2", answer)
}
