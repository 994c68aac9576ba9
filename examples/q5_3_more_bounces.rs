//! Question 5.3: how does a larger p_rr change E[N]?
//!
//! E[N] = p_rr/(1 − p_rr) grows without bound. What the bounces cost and buy is seen in a model of light transport that has exact answers:
//! every vertex sees the light with probability v, reflects ρ of it, and goes on with probability q.

use std::process::ExitCode;

use unbiased::roulette::{LightModel, Roulette};
use unbiased::workbook::{self, Answer, Options};
use unbiased::{Result, figure};

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
            .figure(figure::truncation(&model, q, 200, options.seed)?),
    ];
    for p_rr in [0.2, 0.5, 0.8, 0.9, 0.99] {
        let roulette = Roulette::new(p_rr)?;
        answers.push(
            Answer::new("5.3", "E[N]")
                .parameter("p_rr", p_rr)
                .truth(roulette.mean())
                .outcome(&options.run(&roulette.bounces_by_inversion()?, 1_000_000)?),
        );
    }
    let row = |what| {
        Answer::new("5.3", what)
            .parameter("albedo", model.albedo())
            .parameter("visibility", model.visibility())
            .truth(model.mean())
    };
    let with_roulette = |q: f64| -> Result<Answer> {
        let paths = model.roulette(q)?;
        let row =
            row("light, paths ended by roulette").parameter("q", q).outcome(&options.run(&paths, 1_000_000)?);
        Ok(if paths.variance().is_finite() { row } else { row.demonstration() })
    };
    answers.push(with_roulette(q)?);
    let best = model.optimum();
    if best > 0.0 && best < 1.0 {
        answers.push(with_roulette(best)?.note(format!(
            "At q* = {best:.4} variance × cost is least: {:.2}, against {:.2} at q = {q}.",
            model.roulette(best)?.variance() * model.roulette(best)?.cost(),
            paths.variance() * paths.cost(),
        )));
    }
    answers.push(
        row("light, paths cut off")
            .demonstration()
            .parameter("max_k", max_k as f64)
            .outcome(&options.run(&truncated, 1_000_000)?)
            .note(format!(
                "Paths cut after k ≤ {max_k} miss {:.2} % of the light; from about {:.0} vertices on roulette has the smaller error.",
                -100.0 * truncated.bias() / model.mean(),
                model.crossing(q, max_k)?,
            )),
    );
    Ok(answers)
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::main("5.3", answer)
}
