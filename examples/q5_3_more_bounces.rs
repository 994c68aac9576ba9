//! Question 5.3: how does a larger p_rr change E[N]?
//!
//! E[N] = p_rr/(1 − p_rr) grows without bound. What bounces cost and gain is shown by a model with exact
//! answers: every vertex sees the light with probability v, reflects a fraction ρ, and goes on with
//! probability p_rr.

use unbiased::placement::sobol;
use unbiased::roulette::figures;
use unbiased::roulette::{LightModel, Roulette};
use unbiased::workbook::{self, Sheet};
use unbiased::{Estimator, Result};

/// The number of bounces at five p_rr, then the radiance of paths that are ended by roulette or cut off.
pub fn answer(sheet: &Sheet) -> Result<()> {
    let p_rr = sheet.number("p-rr");
    let model = LightModel::new(sheet.number("albedo"), sheet.number("visibility"))?;
    let max_k = sheet.whole_number("max-k")?;
    let (paths, truncated) = (model.roulette(p_rr)?, model.truncated(max_k)?);

    let seed = sheet.seed();
    sheet.row("bounces, variance and cost");
    sheet.figure(|| figures::mean_bounces([p_rr, 0.2], 100_000, seed))?;
    sheet.figure(|| figures::roulette_trade(&model, p_rr))?;
    sheet.figure(|| figures::truncation(&model, p_rr, max_k, 200, seed))?;
    for p_rr in [0.2, 0.5, 0.8, 0.9, 0.99] {
        let law = Roulette::new(p_rr)?.bounces();
        sheet.row("E[N]").parameter("p_rr", p_rr).truth(law.mean()).estimate(&law.by_inversion()?)?;
    }

    let ended = "light, paths ended by roulette";
    let with_roulette = |what, p_rr: f64, estimator: &dyn Estimator, draws, note: Option<String>| {
        let row = sheet.row(what).parameter("p_rr", p_rr).truth(model.mean()).takes(1.0 / (1.0 - p_rr));
        let row = row.draws(draws).estimate(estimator)?;
        note.map(|note| row.note(note));
        Ok(())
    };
    with_roulette(ended, p_rr, &paths, 1_000_000, None)?;
    with_roulette("the same, sets of 256 Sobol points", p_rr, &sobol(paths, 256)?, 4000, None)?;
    let best = model.optimum();
    if best > 0.0 && best < 1.0 {
        let at_best = model.roulette(best)?;
        let note = format!(
            "At p_rr = {best:.4} variance × cost is least: {:.2}, against {:.2} at p_rr = {p_rr}.",
            at_best.variance() * at_best.cost(),
            paths.variance() * paths.cost(),
        );
        with_roulette(ended, best, &at_best, 1_000_000, Some(note))?;
    }
    let crossing = model.crossing(p_rr, max_k)?;
    let overtaken = if crossing.is_finite() {
        format!("from about {crossing:.0} vertices on roulette has the smaller error")
    } else {
        "roulette never has the smaller error at this p_rr, its variance being infinite".to_owned()
    };
    let missing = match model.mean() {
        0.0 => "With v = 0 there is no light.".to_owned(),
        mean => format!(
            "Paths cut after k ≤ {max_k} miss {:.2} % of the light; {overtaken}.",
            -100.0 * truncated.bias() / mean
        ),
    };
    sheet
        .row("light, paths cut off")
        .truth(model.mean())
        .wrong_on_purpose("what comes after the last bounce is missing")
        .note(missing)
        .estimate(&truncated)?;
    Ok(())
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> std::process::ExitCode {
    workbook::main("5.3", answer)
}
