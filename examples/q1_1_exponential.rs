//! Question 1.1: which function of U is a sample of the exponential distribution?
//!
//! x = F⁻¹(u) = −ln(1 − u)/λ. Below it is drawn that way, and once more without the formula, by inverting the
//! cdf numerically; both must have mean 1/λ.

use std::process::ExitCode;

use rand::distr::Distribution;
use unbiased::inversion::{Exponential, Inversion};
use unbiased::workbook::{self, Answer, Options};
use unbiased::{Result, figure, from_fn};

/// The answers, as the options ask; the rate 0.37 beside the one asked for, since at λ = 1 dividing and multiplying by λ look alike.
pub fn answer(options: &Options) -> Result<Vec<Answer>> {
    let asked = Exponential::new(options.number("rate"))?;
    let mut answers = vec![
        Answer::new("1.1", "the samples' distribution")
            .figure(figure::empirical_cdf(&asked, 200, options.seed)?)
            .figure(figure::tails(&asked, 1 << 20, options.seed)?),
    ];
    for exponential in [asked, Exponential::new(0.37)?] {
        answers.extend(of_one_rate(&exponential, options)?);
    }
    Ok(answers)
}

fn of_one_rate(exponential: &Exponential, options: &Options) -> Result<Vec<Answer>> {
    let (rate, mean) = (exponential.rate(), exponential.mean());

    let by_formula = from_fn(|rng| -(1.0 - rng.uniform()).ln() / rate);
    let any_cdf = Inversion::new(|x| exponential.cdf(x), [0.0, f64::INFINITY])?;
    let by_bisection = from_fn(|rng| any_cdf.sample(rng));
    let squared_deviation = from_fn(|rng| {
        let x: f64 = exponential.sample(rng);
        (x - mean).powi(2)
    });
    let multiplied = from_fn(|rng| -rate * (1.0 - rng.uniform()).ln());

    let row = |what| Answer::new("1.1", what).parameter("rate", rate);
    Ok(vec![
        row("mean of the samples, by the formula").truth(mean).outcome(&options.run(&by_formula, 1_000_000)?),
        row("mean of the samples, the cdf inverted by bisection")
            .truth(mean)
            .outcome(&options.run(&by_bisection, 100_000)?),
        row("variance of the samples")
            .truth(exponential.variance())
            .outcome(&options.run(&squared_deviation, 1_000_000)?),
        row("mean of the samples, multiplied by λ instead of divided")
            .demonstration()
            .truth(mean)
            .outcome(&options.run(&multiplied, 1_000_000)?),
    ])
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::main("1.1", answer)
}
