//! Question 3.4: the estimator of L_r with directions drawn in proportion to the BRDF.
//!
//! The BRDF ρ/π is constant, so p = 1/(2π) and each draw is f/p = 2ρ L_i cos θ. The light is L cos^a θ, which reflects 2ρL/(a + 2).

use std::process::ExitCode;

use rand::distr::Distribution;
use unbiased::hemisphere::{Direction, Hemisphere};
use unbiased::lambertian::{CosinePower, Lambertian, Light};
use unbiased::placement::sobol;
use unbiased::workbook::{self, Answer, Options};
use unbiased::{Result, f_over_p, figure, from_fn};

/// The answers, as the options ask.
pub fn answer(options: &Options) -> Result<Vec<Answer>> {
    let cube = Lambertian::new(options.number("albedo"))?;
    let (radiance, sky) = (options.number("radiance"), CosinePower::new(options.number("a"))?);
    let light = |w: &Direction| radiance * sky.incoming(w);
    let truth = radiance * sky.reflected(cube);

    let general = f_over_p(|w| cube.brdf() * light(w) * w.cos_theta(), Hemisphere::Uniform);
    let simplified = from_fn(|rng| {
        let w = Hemisphere::Uniform.sample(rng);
        2.0 * cube.albedo() * light(&w) * w.cos_theta()
    });
    let without_cosine = f_over_p(|w| cube.brdf() * light(w), Hemisphere::Uniform);
    let half_density = from_fn(|rng| {
        let w = Hemisphere::Uniform.sample(rng);
        4.0 * cube.albedo() * light(&w) * w.cos_theta()
    });

    let row = |what| {
        Answer::new("3.4", what)
            .parameter("albedo", cube.albedo())
            .parameter("radiance", radiance)
            .parameter("a", sky.a())
            .truth(truth)
    };
    Ok(vec![
        row("reflected radiance, general form")
            .outcome(&options.run(&general, 1_000_000)?)
            .figure(figure::directions(Hemisphere::Uniform, 600, options.seed)?),
        row("reflected radiance, simplified").outcome(&options.run(&simplified, 1_000_000)?),
        row("reflected radiance, sets of 256 Sobol points")
            .outcome(&options.run(&sobol(&general, 256)?, 4000)?),
        row("cos θ forgotten").demonstration().outcome(&options.run(&without_cosine, 1_000_000)?),
        row("the whole sphere's density").demonstration().outcome(&options.run(&half_density, 1_000_000)?),
    ])
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::main("3.4", answer)
}
