//! Question 3.4: the estimator of L_r with directions drawn in proportion to the BRDF.
//!
//! The BRDF ρ/π is constant, so p = 1/(2π) and each draw is f/p = 2ρ L_i cos θ. The incoming radiance is L
//! cos^a θ, for which L_r = 2ρL/(a + 2).

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
    let draw = |rng: &mut _| Hemisphere::Uniform.sample(rng);

    let general = f_over_p(|w| cube.brdf() * light(w) * w.cos_theta(), Hemisphere::Uniform);
    let simplified = from_fn(|rng| {
        let w = draw(rng);
        2.0 * cube.albedo() * light(&w) * w.cos_theta()
    });
    let without_cosine = f_over_p(|w| cube.brdf() * light(w), Hemisphere::Uniform);
    let half_density = from_fn(|rng| {
        let w = draw(rng);
        4.0 * cube.albedo() * light(&w) * w.cos_theta()
    });

    let (truth, seed) = (radiance * sky.reflected(cube), sheet.seed());
    let infinite = sky.variance(cube, Hemisphere::Uniform).is_infinite();
    let row = |what| sheet.row(what).truth(truth).doubt(infinite.then_some(Doubt::InfiniteVariance));
    row("reflected radiance, general form").estimate(&general)?;
    sheet.figure(|| figures::directions(Hemisphere::Uniform, 600, seed))?;
    row("reflected radiance, simplified").estimate(&simplified)?;
    row("reflected radiance, sets of 256 Sobol points").draws(4000).estimate(&sobol(&general, 256)?)?;
    row("cos θ forgotten").wrong_on_purpose("f/p has a factor cos θ").estimate(&without_cosine)?;
    row("the whole sphere's density")
        .wrong_on_purpose("p = 1/(4π), though directions are drawn from half the sphere")
        .estimate(&half_density)?;
    Ok(())
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> std::process::ExitCode {
    workbook::main("3.4", answer)
}
