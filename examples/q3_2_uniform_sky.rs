//! Question 3.2: the incoming radiance is the same from everywhere. What is the reflected radiance?
//!
//! L_r = ρ/π L_i ∫∫ cos θ sin θ dθ dφ = ρ L_i. Estimated as the integral over directions that it is, and wrongly, with a factor forgotten.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::process::ExitCode;

use unbiased::hemisphere::Hemisphere;
use unbiased::lambertian::Lambertian;
use unbiased::workbook::{self, Answer, Options};
use unbiased::{Result, f_over_p, figure, from_fn};

/// The answers, as the options ask.
pub fn answer(options: &Options) -> Result<Vec<Answer>> {
    let cube = Lambertian::new(options.number("albedo"))?;
    let radiance = options.number("radiance");
    let truth = cube.reflected(radiance);

    // over directions: f_r L_i cos θ / p(ω)
    let over_directions = f_over_p(|w| cube.brdf() * radiance * w.cos_theta(), Hemisphere::Uniform);
    // over angles: f_r L_i cos θ sin θ, with θ and φ uniform on [0, π/2) × [0, 2π)
    let over_angles = from_fn(|rng| {
        let theta = FRAC_PI_2 * rng.uniform();
        cube.brdf() * radiance * theta.cos() * theta.sin() * FRAC_PI_2 * TAU
    });
    let without_sine =
        from_fn(|rng| cube.brdf() * radiance * (FRAC_PI_2 * rng.uniform()).cos() * FRAC_PI_2 * TAU);
    let without_cosine = f_over_p(|_| cube.brdf() * radiance, Hemisphere::Uniform);

    let row = |what| {
        Answer::new("3.2", what)
            .parameter("albedo", cube.albedo())
            .parameter("radiance", radiance)
            .truth(truth)
    };
    Ok(vec![
        row("reflected radiance, integrated over directions")
            .outcome(&options.run(&over_directions, 1_000_000)?)
            .figure(figure::integrand()?),
        row("reflected radiance, integrated over θ and φ").outcome(&options.run(&over_angles, 1_000_000)?),
        row("sin θ forgotten").demonstration().outcome(&options.run(&without_sine, 1_000_000)?),
        row("cos θ forgotten").demonstration().outcome(&options.run(&without_cosine, 1_000_000)?),
    ])
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::main("3.2", answer)
}
