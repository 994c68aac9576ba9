//! Question 5.2: with p_rr = 1/5, what is E[N]?
//!
//! E[N] = p_rr/(1 − p_rr) = 1/4. Cheap; but light gathered along such paths has an infinite variance where p_rr ≤ ρ²: its estimate is unbiased
//! and usually too dark.

use std::process::ExitCode;

use unbiased::Result;
use unbiased::roulette::{LightModel, Roulette};
use unbiased::workbook::{self, Answer, Options};

/// The answers, as the options ask.
pub fn answer(options: &Options) -> Result<Vec<Answer>> {
    let p_rr = options.number("p-rr");
    let roulette = Roulette::new(p_rr)?;
    let model = LightModel::new(options.number("albedo"), options.number("visibility"))?;
    let paths = model.roulette(p_rr)?;

    let row = |what| Answer::new("5.2", what).parameter("p_rr", p_rr);
    let light = row("light along such paths")
        .parameter("albedo", model.albedo())
        .parameter("visibility", model.visibility())
        .truth(model.mean())
        .outcome(&options.run(&paths, 1000)?);
    Ok(vec![
        row("E[N], coin by coin")
            .truth(roulette.bounces().mean())
            .outcome(&options.run(&roulette.bounces().by_simulation()?, 1_000_000)?),
        row("E[N], in one step")
            .truth(roulette.bounces().mean())
            .outcome(&options.run(&roulette.bounces().by_inversion()?, 1_000_000)?),
        if paths.variance().is_finite() { light } else { light.demonstration().note(INFINITE) },
    ])
}

const INFINITE: &str = "The variance of these paths is infinite, since p_rr ≤ ρ²: the error bar above means nothing. At ρ = 0.8, v = 0.5 and p_rr = 1/5, the 95 % \
                        intervals of a thousand paths cover the truth less than half of the time, and most estimates are too dark.";

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::main("5.2", answer)
}
