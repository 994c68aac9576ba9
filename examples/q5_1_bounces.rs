//! Question 5.1: with p_rr = 4/5, what are P(N = 0), P(N = 2) and E[N]?
//!
//! P(N = k) = p_rr^k (1 − p_rr) and E[N] = p_rr/(1 − p_rr). N is sampled in two ways: one coin per bounce, as
//! a ray does, and in one step by inversion. Last, the coin does not change a mean: E[X_rr] = E[X].

use unbiased::roulette::Roulette;
use unbiased::roulette::figures;
use unbiased::workbook::{self, Sheet};
use unbiased::{Estimator, Result, from_fn};

/// Each part coin by coin and in one step, then the mean that roulette does not change.
pub fn answer(sheet: &Sheet) -> Result<()> {
    let p_rr = sheet.number("p-rr");
    let roulette = Roulette::new(p_rr)?;
    let law = roulette.bounces();
    let coin_by_coin = from_fn(|rng| {
        let mut bounces = 0.0;
        while rng.uniform() < p_rr {
            bounces += 1.0;
        }
        bounces
    });
    let in_one_step = law.by_inversion()?; // an error where a ray would never end
    let coins = law.mean() + 1.0;

    for (part, k) in [("(i)", 0), ("(ii)", 2)] {
        let is_k = |bounces: f64| if bounces == k as f64 { 1.0 } else { 0.0 };
        let by_coins = from_fn(|rng| is_k(coin_by_coin.draw(rng)));
        let by_inversion = from_fn(|rng| is_k(in_one_step.draw(rng)));
        let row = |way| sheet.row(format!("P(N = {k}), {way}")).part(part).truth(law.pmf(k));
        row("coin by coin").takes(coins).estimate(&by_coins)?;
        row("in one step").estimate(&by_inversion)?;
    }
    let row = |way| sheet.row(format!("E[N], {way}")).part("(iii)").truth(law.mean());
    row("coin by coin").takes(coins).estimate(&coin_by_coin)?;
    // it draws coin by coin, thousands of times
    if coins <= 1e5 {
        let seed = sheet.seed();
        sheet.figure(|| figures::bounces([p_rr, 0.2], 2000, seed))?;
    }
    row("in one step").estimate(&in_one_step)?;

    // X = 3U² has the mean 1, and so has X_rr; without the division by p_rr it has p_rr
    let x = from_fn(|rng| 3.0 * rng.uniform().powi(2));
    let uncompensated = from_fn(|rng| if rng.uniform() < p_rr { x.draw(rng) } else { 0.0 });
    sheet.row("E[X_rr] of an X with mean 1").truth(1.0).estimate(&roulette.wrap(&x))?;
    sheet
        .row("not divided by p_rr")
        .truth(1.0)
        .wrong_on_purpose("nothing compensates for the rays that end")
        .estimate(&uncompensated)?;
    Ok(())
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> std::process::ExitCode {
    workbook::main("5.1", answer)
}
