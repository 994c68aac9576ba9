//! Question 3.5: the estimator of L_r with directions drawn from p = cos θ/π.
//!
//! Each draw is f/p = ρ L_i, as the cosine cancels. The directions must be *drawn* from the new density, too.

use rand::distr::Distribution;
use unbiased::lambertian::figures;
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::lambertian::{CosinePower, Lambertian, Light};
use unbiased::placement::sobol;
use unbiased::workbook::{self, Sheet};
use unbiased::{Doubt, Result, f_over_p, from_fn};

/// The general form, the simplified one, better placed numbers, the mistakes.
pub fn answer(sheet: &Sheet) -> Result<()> {
    let (cube, radiance) = (Lambertian::new(sheet.number("albedo"))?, sheet.number("radiance"));
    let sky = CosinePower::new(sheet.number("a"))?;
    let light = |w: &Direction| radiance * sky.incoming(w);

    let general = f_over_p(|w| cube.brdf() * light(w) * w.cos_theta(), Hemisphere::Cosine);
    let simplified = from_fn(|rng| cube.albedo() * light(&Hemisphere::Cosine.sample(rng)));
    // the classic mistakes: only the formula changed, or only the directions
    let only_formula = from_fn(|rng| cube.albedo() * light(&Hemisphere::Uniform.sample(rng)));
    let only_directions = from_fn(|rng| {
        let w = Hemisphere::Cosine.sample(rng);
        2.0 * cube.albedo() * light(&w) * w.cos_theta()
    });

    let (truth, seed) = (radiance * sky.reflected(cube), sheet.seed());
    let infinite = sky.variance(cube, Hemisphere::Cosine).is_infinite();
    let row = |what| sheet.row(what).truth(truth).doubt(infinite.then_some(Doubt::InfiniteVariance));
    row("reflected radiance, general form").estimate(&general)?;
    sheet.figure(|| figures::directions(Hemisphere::Cosine, 600, seed))?;
    sheet.figure(|| figures::betting(seed))?;
    row("reflected radiance, simplified").estimate(&simplified)?;
    row("reflected radiance, sets of 256 Sobol points").draws(4000).estimate(&sobol(&general, 256)?)?;
    row("the formula changed, the directions still uniform")
        .wrong_on_purpose("ρ L_i belongs to p = cos θ/π alone")
        .estimate(&only_formula)?;
    row("the directions changed, the formula still the uniform one")
        .wrong_on_purpose("2ρ L_i cos θ belongs to p = 1/(2π) alone")
        .estimate(&only_directions)?;
    Ok(())
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> std::process::ExitCode {
    workbook::main("3.5", answer)
}
