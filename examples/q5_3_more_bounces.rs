//! Question 5.3: how does a larger p_rr change E[N]?
//!
//! E[N] = p_rr/(1 − p_rr) grows without bound. What the bounces cost and buy is seen in a model of light transport that has exact answers:
//! every vertex sees the light with probability v, reflects ρ of it, and goes on with probability q.

use std::process::ExitCode;

use unbiased::placement::sobol;
use unbiased::roulette::{LightModel, Roulette};
use unbiased::workbook::{self, Answer, Options};
use unbiased::{Estimator, Result, figure};

/// The answers, as the options ask.
pub fn answer(options: &Options) -> Result<Vec<Answer>> {
    let q = options.number("p-rr");
    let model = LightModel::new(options.number("albedo"), options.number("visibility"))?;
    let max_k = options.whole_number("max-k")?;
    let (paths, truncated) = (model.roulette(q)?, model.truncated(max_k)?);

    let mut answers = vec![
        Answer::new("5.3", "bounces, variance and cost")
            .figure(figure::mean_bounces(100_000, options.seed)?)
            .figure(figure::roulette_trade(&model, q)?)
            .figure(figure::truncation(&model, q, max_k, 200, options.seed)?),
    ];
    for p_rr in [0.2, 0.5, 0.8, 0.9, 0.99] {
        let roulette = Roulette::new(p_rr)?;
        answers.push(
            Answer::new("5.3", "E[N]")
                .parameter("p_rr", p_rr)
                .truth(roulette.bounces().mean())
                .outcome(&options.run(&roulette.bounces().by_inversion()?, 1_000_000)?),
        );
    }
    let row = |what| {
        Answer::new("5.3", what)
            .parameter("albedo", model.albedo())
            .parameter("visibility", model.visibility())
            .truth(model.mean())
    };
    let with_roulette = |what, q: f64, estimator: &dyn Estimator, draws| -> Result<Answer> {
        let row = row(what).parameter("q", q).outcome(&options.run(estimator, draws)?);
        Ok(if model.roulette(q)?.variance().is_finite() { row } else { row.demonstration() })
    };
    let ended = "light, paths ended by roulette";
    answers.push(with_roulette(ended, q, &paths, 1_000_000)?);
    let placed = sobol(paths, 256)?;
    answers.push(with_roulette("the same, sets of 256 Sobol points", q, &placed, 4000)?);
    let best = model.optimum();
    if best > 0.0 && best < 1.0 {
        let at_best = model.roulette(best)?;
        answers.push(with_roulette(ended, best, &at_best, 1_000_000)?.note(format!(
            "At q* = {best:.4} variance × cost is least: {:.2}, against {:.2} at q = {q}.",
            at_best.variance() * at_best.cost(),
            paths.variance() * paths.cost(),
        )));
    }
    let crossing = model.crossing(q, max_k)?;
    let overtaken = if crossing.is_finite() {
        format!("from about {crossing:.0} vertices on roulette has the smaller error")
    } else {
        "roulette never has the smaller error at this q, its variance being infinite".to_owned()
    };
    let missing = -100.0 * truncated.bias() / model.mean();
    answers.push(
        row("light, paths cut off")
            .demonstration()
            .parameter("max_k", max_k as f64)
            .outcome(&options.run(&truncated, 1_000_000)?)
            .note(format!("Paths cut after k ≤ {max_k} miss {missing:.2} % of the light; {overtaken}.")),
    );
    Ok(answers)
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::main("5.3", answer)
}
