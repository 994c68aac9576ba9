//! Question 3.5: the estimator of L_r with directions drawn from p = cos θ/π.
//!
//! Each draw is f/p = ρ L_i: the cosine cancels on paper. The directions must be *drawn* from the new density, too.

use std::process::ExitCode;

use rand::distr::Distribution;
use unbiased::hemisphere::{Direction, Hemisphere};
use unbiased::lambertian::mistakes::Reflection;
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

    let general = f_over_p(|w| cube.brdf() * light(w) * w.cos_theta(), Hemisphere::Cosine);
    let simplified = from_fn(|rng| cube.albedo() * light(&Hemisphere::Cosine.sample(rng)));
    // the classic mistakes: only the formula changed, or only the directions
    let only_formula = from_fn(|rng| cube.albedo() * light(&Hemisphere::Uniform.sample(rng)));
    let only_directions = from_fn(|rng| {
        let w = Hemisphere::Cosine.sample(rng);
        2.0 * cube.albedo() * light(&w) * w.cos_theta()
    });

    let row = |what| {
        Answer::new("3.5", what)
            .parameter("albedo", cube.albedo())
            .parameter("radiance", radiance)
            .parameter("a", sky.a())
            .truth(truth)
    };
    Ok(vec![
        row("reflected radiance, general form")
            .outcome(&options.run(&general, 1_000_000)?)
            .figure(figure::directions(Hemisphere::Cosine, 600, options.seed)?)
            .figure(figure::wealth(options.seed)?)
            .figure(figure::mistakes::<Reflection>()?),
        row("reflected radiance, simplified").outcome(&options.run(&simplified, 1_000_000)?),
        row("reflected radiance, sets of 256 Sobol points")
            .outcome(&options.run(&sobol(&general, 256)?, 4000)?),
        row("the formula changed, the directions still uniform")
            .demonstration()
            .outcome(&options.run(&only_formula, 1_000_000)?),
        row("the directions changed, the formula still the uniform one")
            .demonstration()
            .outcome(&options.run(&only_directions, 1_000_000)?),
    ])
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::main("3.5", answer)
}
