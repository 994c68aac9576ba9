//! Question 4.3: the estimator for paths.
//!
//! L̂_o(p) = 1/n Σ f_r L_o(p_j) cos θ/p(ω) is the estimator of 3.4, with L_i replaced by the radiance that
//! leaves p_j. With the exact radiance reflected once at p_j it gives the two-bounce radiance; so it does
//! with an unbiased estimate of it. If that estimate continues in the same way, it gives more bounces. The
//! truths for one and two bounces are exact.

use unbiased::lambertian::hemisphere::Hemisphere::{Cosine, Uniform};
use unbiased::paths::figures;
use unbiased::paths::room::BoxRoom;
use unbiased::paths::{Bounces, FindLight, Paths, reflected};
use unbiased::placement::sobol;
use unbiased::workbook::{self, Sheet};
use unbiased::{Estimator, Result};

/// The radiance after exactly K bounces and after up to K, or after all.
pub fn answer(sheet: &Sheet) -> Result<()> {
    let room = BoxRoom::new(sheet.scene())?;
    let exact = [Some(room.one_bounce()), room.two_bounces()]; // after one bounce, and after two
    let (bounces, seed) = (sheet.limit("bounces"), sheet.seed());
    sheet.row("paths in the room");
    sheet.figure(|| figures::two_bounces_converging(&room, seed))?;
    sheet.figure(|| figures::occluded_fraction(200_000, seed))?;
    sheet.figure(|| figures::radiance_by_bounces(&room, seed))?;
    sheet.figure(|| figures::path_errors(&room, seed))?;

    let add = |what: &str, estimator: &dyn Estimator, truth: Option<f64>| {
        // a whole set of points is one draw
        let draws = if what.contains("Sobol") { 4000 } else { 1_000_000 };
        sheet.row(what).truth(truth).draws(draws).estimate(estimator).map(|_| ())
    };
    let Some(k) = bounces else {
        for (what, bounces) in [
            ("cumulative", Bounces::AllByThroughput),
            ("all light, roulette with q = 0.8", Bounces::All(0.8)),
            ("all light, roulette with q = 0.5", Bounces::All(0.5)),
        ] {
            let paths = Paths::new(room, bounces, Cosine, FindLight::BySampling)?;
            add(what, &paths, None)?;
        }
        return Ok(());
    };

    let truth = if k == 0 { Some(0.0) } else { exact.get(k as usize - 1).copied().flatten() };
    if k == 2 && exact[1].is_some() {
        // the sheet's estimator as it is, with L_o(p_j) known
        let known = reflected(room, Cosine, |p_j, _| room.direct(p_j));
        add("K-bounce part, L_o(p_j) known", &known, truth)?;
        add("K-bounce part, L_o(p_j) known, sets of 256 Sobol points", &sobol(&known, 256)?, truth)?;
    }
    if k > 0 {
        let paths = Paths::new(room, Bounces::Exactly(k - 1), Cosine, FindLight::BySampling)?;
        let estimated = reflected(room, Uniform, |p_j, rng| paths.light_from(p_j, rng));
        let doubt = Paths::new(room, Bounces::Exactly(k), Cosine, FindLight::BySampling)?.doubt();
        sheet.row("K-bounce part, L_o(p_j) estimated").truth(truth).doubt(doubt).estimate(&estimated)?;
    }
    for (what, directions, light) in [
        ("K-bounce part, light sampled, cosine directions", Cosine, FindLight::BySampling),
        ("K-bounce part, light sampled, uniform directions", Uniform, FindLight::BySampling),
        ("K-bounce part, light by chance, cosine directions", Cosine, FindLight::ByChance),
        ("K-bounce part, light by chance, uniform directions", Uniform, FindLight::ByChance),
    ] {
        let paths = Paths::new(room, Bounces::Exactly(k), directions, light)?;
        add(what, &paths, truth)?;
    }
    let all_known = exact.iter().take(k as usize).try_fold(0.0, |sum, part| Some(sum + (*part)?));
    let truth = if k <= 2 { all_known } else { None };
    let paths = Paths::new(room, Bounces::UpTo(k), Cosine, FindLight::BySampling)?;
    add("cumulative", &paths, truth)?;
    add("cumulative, sets of 256 Sobol points", &sobol(paths, 256)?, truth)
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> std::process::ExitCode {
    workbook::main("4.3", answer)
}
