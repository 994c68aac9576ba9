//! Question 3.1: what is the cube's emitted radiance?
//!
//! L_e = 0: wood is no lamp. So the outgoing radiance L_o = L_e + L_r is the reflected one alone, and a cube in the
//! dark is dark.

use std::process::ExitCode;

use unbiased::Result;
use unbiased::hemisphere::Hemisphere;
use unbiased::lambertian::Lambertian;
use unbiased::workbook::{self, Answer, Options};

/// The answers, as the options ask.
pub fn answer(options: &Options) -> Result<Vec<Answer>> {
    let cube = Lambertian::new(options.number("albedo"))?;
    let in_the_dark = cube.estimator(|_| 0.0, Hemisphere::Uniform);
    Ok(vec![
        Answer::new("3.1", "emitted radiance L_e")
            .parameter("albedo", cube.albedo())
            .truth(0.0)
            .value(cube.emitted()),
        Answer::new("3.1", "outgoing radiance L_e + L_r in the dark")
            .parameter("albedo", cube.albedo())
            .truth(0.0)
            .outcome(&options.run(&in_the_dark, 1000)?),
    ])
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::main("3.1", answer)
}
