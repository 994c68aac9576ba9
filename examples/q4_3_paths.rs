//! Question 4.3: the estimator for paths.
//!
//! L̂_o(p) = 1/n Σ f_r L_o(p_j) cos θ/p(ω) is 3.4's estimator with the light taken from where it left. With the exact L_o(p_j) of the light reflected once it gives the two-bounce part; with an
//! unbiased estimate of it, too; and if that estimate goes on in the same way, more bounces. The truths of one and two bounces are exact.

use std::process::ExitCode;

use unbiased::box_room::BoxRoom;
use unbiased::hemisphere::Hemisphere::{Cosine, Uniform};
use unbiased::paths::mistakes::LightOfPaths;
use unbiased::paths::{Bounces, FindLight, Paths, reflected};
use unbiased::placement::sobol;
use unbiased::workbook::{self, Answer, Options};
use unbiased::{Estimator, Result, figure};

#[path = "section4/dark.rs"]
#[allow(clippy::duplicate_mod)] // the worksheet takes it in with each of its examples
mod dark;

/// The answers, as the options ask.
pub fn answer(options: &Options) -> Result<Vec<Answer>> {
    let room = BoxRoom::new(options.scene())?;
    let bounces = options.limit("bounces");
    let exact = [Some(room.one_bounce()), room.two_bounces()]; // after one bounce, and after two

    let mut drawings = Answer::new("4.3", "paths in the room");
    if options.shard.is_none() {
        drawings = drawings
            .figure(figure::two_bounces_converging(&room, options.seed)?)
            .figure(figure::occluded_fraction(200_000, options.seed)?)
            .figure(figure::radiance_by_bounces(&room, options.seed)?)
            .figure(figure::mistakes::<LightOfPaths>()?);
        for figure in figure::path_errors(&room, options.seed)? {
            drawings = drawings.figure(figure);
        }
    }
    let mut answers = vec![drawings];
    let mut add =
        |what: &str, estimator: &dyn Estimator, truth: Option<f64>, caution: Option<String>| -> Result<()> {
            // a set of points is one draw
            let draws = if what.contains("Sobol") { 4000 } else { 1_000_000 };
            let mut row = Answer::new("4.3", what).outcome(&options.run(estimator, draws)?);
            if let Some(truth) = truth {
                row = row.truth(truth);
            }
            if let Some(caution) = caution {
                row = row.note(format!("Careful: {caution}.")).demonstration();
            }
            row = dark::unless_none_found(row, &room);
            answers.push(row.scene(room.scene()).parameter("bounces", bounces));
            Ok(())
        };

    if let Some(k) = bounces {
        let truth = if k == 0 { Some(0.0) } else { exact.get(k as usize - 1).copied().flatten() };
        let once_less = |light| Paths::new(room, Bounces::Exactly(k.saturating_sub(1)), Cosine, light);
        if k == 2 && exact[1].is_some() {
            // the sheet's estimator as it stands, with L_o(p_j) known
            let known = reflected(room, Cosine, |p_j, _| room.direct(p_j));
            add("K-bounce part, L_o(p_j) known", &known, truth, None)?;
            add(
                "K-bounce part, L_o(p_j) known, sets of 256 Sobol points",
                &sobol(&known, 256)?,
                truth,
                None,
            )?;
        }
        if k > 0 {
            let paths = once_less(FindLight::BySampling)?;
            let estimated = reflected(room, Uniform, |p_j, rng| paths.light_from(p_j, rng));
            let whole = Paths::new(room, Bounces::Exactly(k), Cosine, FindLight::BySampling)?;
            add("K-bounce part, L_o(p_j) estimated", &estimated, truth, whole.caution())?;
        }
        for (what, directions, light) in [
            ("K-bounce part, light sampled, cosine directions", Cosine, FindLight::BySampling),
            ("K-bounce part, light sampled, uniform directions", Uniform, FindLight::BySampling),
            ("K-bounce part, light by chance, cosine directions", Cosine, FindLight::ByChance),
            ("K-bounce part, light by chance, uniform directions", Uniform, FindLight::ByChance),
        ] {
            let paths = Paths::new(room, Bounces::Exactly(k), directions, light)?;
            add(what, &paths, truth, paths.caution())?;
        }
        let all_known = exact.iter().take(k as usize).try_fold(0.0, |sum, part| Some(sum + (*part)?));
        let truth = if k <= 2 { all_known } else { None };
        let paths = Paths::new(room, Bounces::UpTo(k), Cosine, FindLight::BySampling)?;
        add("cumulative", &paths, truth, paths.caution())?;
        add("cumulative, sets of 256 Sobol points", &sobol(paths, 256)?, truth, paths.caution())?;
    } else {
        for (what, bounces) in [
            ("cumulative", Bounces::AllByThroughput),
            ("all light, roulette with q = 0.8", Bounces::All(0.8)),
            ("all light, roulette with q = 0.5", Bounces::All(0.5)),
        ] {
            let paths = Paths::new(room, bounces, Cosine, FindLight::BySampling)?;
            add(what, &paths, None, paths.caution())?;
        }
    }
    Ok(answers)
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::main("4.3", answer)
}
