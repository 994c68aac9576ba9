//! Question 1.1: which function of U is a sample of the exponential distribution?
//!
//! x = F⁻¹(u) = −ln(1 − u)/λ. Samples are drawn with this formula, and by inverting the cdf numerically; both
//! must have mean 1/λ.

use rand::distr::Distribution;
use unbiased::inversion::figures;
use unbiased::inversion::{Exponential, Inversion};
use unbiased::workbook::{self, Sheet};
use unbiased::{Result, from_fn};

/// Also uses the rate 0.37, since dividing and multiplying by λ look the same at λ = 1.
pub fn answer(sheet: &Sheet) -> Result<()> {
    let asked = Exponential::new(sheet.number("rate"))?;
    let seed = sheet.seed();
    sheet.row("the samples' distribution");
    sheet.figure(|| figures::empirical_cdf(&asked, 200, seed))?;
    sheet.figure(|| figures::tails(&asked, 1 << 20, seed))?;

    for exponential in [asked, Exponential::new(0.37)?] {
        let (rate, mean) = (exponential.rate(), exponential.mean());
        let by_formula = from_fn(|rng| -(1.0 - rng.uniform()).ln() / rate);
        let any_cdf = Inversion::new(|x| exponential.cdf(x), [0.0, f64::INFINITY])?;
        let by_bisection = from_fn(|rng| any_cdf.sample(rng));
        let squared_deviation = from_fn(|rng| {
            let x: f64 = exponential.sample(rng);
            (x - mean).powi(2)
        });
        let multiplied = from_fn(|rng| -rate * (1.0 - rng.uniform()).ln());

        let row = |what| sheet.row(what).parameter("rate", rate).truth(mean);
        row("mean of the samples, by the formula").estimate(&by_formula)?;
        row("mean of the samples, the cdf inverted by bisection").draws(100_000).estimate(&by_bisection)?;
        row("variance of the samples").truth(exponential.variance()).estimate(&squared_deviation)?;
        row("mean of the samples, multiplied by λ instead of divided")
            .wrong_on_purpose("x = −λ ln(1 − u)")
            .estimate(&multiplied)?;
    }
    Ok(())
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> std::process::ExitCode {
    workbook::main("1.1", answer)
}
