//! Question 5.2: with p_rr = 1/5, what is E[N]?
//!
//! E[N] = p_rr/(1 − p_rr) = 1/4. That is cheap, but the radiance estimated along such paths has an infinite
//! variance if p_rr ≤ ρ²: it is unbiased, and usually too small.

use unbiased::roulette::{LightModel, Roulette};
use unbiased::workbook::{self, Sheet};
use unbiased::{Estimator, Result};

/// The number of bounces, and the radiance estimated with so few.
pub fn answer(sheet: &Sheet) -> Result<()> {
    let p_rr = sheet.number("p-rr");
    let law = Roulette::new(p_rr)?.bounces();
    let model = LightModel::new(sheet.number("albedo"), sheet.number("visibility"))?;
    let (coin_by_coin, in_one_step) = (law.by_simulation()?, law.by_inversion()?);
    let paths = model.roulette(p_rr)?;
    let coins = law.mean() + 1.0;

    sheet.row("E[N], coin by coin").truth(law.mean()).takes(coins).estimate(&coin_by_coin)?;
    sheet.row("E[N], in one step").truth(law.mean()).estimate(&in_one_step)?;
    let light = sheet.row("radiance along such paths").truth(model.mean()).draws(1000).takes(coins);
    let light = light.estimate(&paths)?;
    if paths.doubt().is_some() {
        light.note(INFINITE);
    }
    Ok(())
}

const INFINITE: &str = "It is infinite since p_rr ≤ ρ². At ρ = 0.8, v = 0.5 and p_rr = 1/5, the 95 % \
                        intervals of a thousand paths cover the truth less than half of the time, and most \
                        estimates are too dark.";

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> std::process::ExitCode {
    workbook::main("5.2", answer)
}
