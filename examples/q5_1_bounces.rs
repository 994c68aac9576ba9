//! Question 5.1: with p_rr = 4/5, what are P(N = 0), P(N = 2) and E[N]?
//!
//! P(N = k) = p_rr^k (1 − p_rr) and E[N] = p_rr/(1 − p_rr). N is drawn twice: coin by coin, as a ray does, and in one step by
//! inversion. And the coin keeps every mean: E[X_rr] = E[X].

use std::process::ExitCode;

use unbiased::roulette::Roulette;
use unbiased::workbook::{self, Answer, Options};
use unbiased::{Estimator, Result, figure, from_fn};

/// The answers, as the options ask.
pub fn answer(options: &Options) -> Result<Vec<Answer>> {
    let p_rr = options.number("p-rr");
    let roulette = Roulette::new(p_rr)?;
    let coin_by_coin = from_fn(|rng| {
        let mut bounces = 0.0;
        while rng.uniform() < p_rr {
            bounces += 1.0;
        }
        bounces
    });
    // also an error where a ray would never end
    roulette.bounces().by_simulation()?;
    let in_one_step = roulette.bounces().by_inversion()?;

    let row = |part: &str, what: &str| Answer::new(&format!("5.1({part})"), what).parameter("p_rr", p_rr);
    let mut answers = Vec::new();
    for (part, k) in [("i", 0), ("ii", 2)] {
        let is_k = |bounces: f64| if bounces == k as f64 { 1.0 } else { 0.0 };
        let by_coins = from_fn(|rng| is_k(coin_by_coin.draw(rng)));
        let by_inversion = from_fn(|rng| is_k(in_one_step.draw(rng)));
        let what = |way| format!("P(N = {k}), {way}");
        answers.push(
            row(part, &what("coin by coin"))
                .truth(roulette.bounces().pmf(k))
                .outcome(&options.run(&by_coins, 1_000_000)?),
        );
        answers.push(
            row(part, &what("in one step"))
                .truth(roulette.bounces().pmf(k))
                .outcome(&options.run(&by_inversion, 1_000_000)?),
        );
    }
    answers.push(
        row("iii", "E[N], coin by coin")
            .truth(roulette.bounces().mean())
            .outcome(&options.run(&coin_by_coin, 1_000_000)?)
            .figure(figure::bounces([p_rr, 0.2], 2000, options.seed)?),
    );
    answers.push(
        row("iii", "E[N], in one step")
            .truth(roulette.bounces().mean())
            .outcome(&options.run(&in_one_step, 1_000_000)?),
    );

    // X = 3U² has the mean 1, and so has X_rr; without the division by p_rr it has p_rr
    let x = from_fn(|rng| 3.0 * rng.uniform().powi(2));
    let uncompensated = from_fn(|rng| if rng.uniform() < p_rr { x.draw(rng) } else { 0.0 });
    let row = |what| Answer::new("5.1", what).parameter("p_rr", p_rr).truth(1.0);
    answers.push(row("E[X_rr] of an X with mean 1").outcome(&options.run(&roulette.wrap(&x), 1_000_000)?));
    answers
        .push(row("not divided by p_rr").demonstration().outcome(&options.run(&uncompensated, 1_000_000)?));
    Ok(answers)
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::main("5.1", answer)
}
