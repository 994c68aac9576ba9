//! Question 3.3: how does the reflected radiance depend on ω_o and on ρ?
//!
//! Not at all, and in proportion. Half the albedo gives half the radiance; and the BRDF ρ/π, which is all that
//! could know ω_o, does not.

use std::process::ExitCode;

use unbiased::Result;
use unbiased::hemisphere::Hemisphere;
use unbiased::lambertian::Lambertian;
use unbiased::workbook::{self, Answer, Options};

/// The answers, as the options ask.
pub fn answer(options: &Options) -> Result<Vec<Answer>> {
    let (albedo, radiance) = (options.number("albedo"), options.number("radiance"));
    let mut answers = vec![Answer::new("3.3", "dependence on ω_o").note(
        "The estimator draws directions ω_i of incoming light and never asks for ω_o: the same number holds for every eye.",
    )];
    for albedo in [albedo, 0.5 * albedo] {
        let cube = Lambertian::new(albedo)?;
        let estimator = cube.estimator(|_| radiance, Hemisphere::Uniform);
        answers.push(
            Answer::new("3.3", "reflected radiance")
                .parameter("albedo", albedo)
                .parameter("radiance", radiance)
                .truth(cube.reflected(radiance))
                .outcome(&options.run(&estimator, 1_000_000)?),
        );
    }
    Ok(answers)
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::main("3.3", answer)
}
