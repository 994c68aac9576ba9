//! Question 3.6: why does cosine-weighted sampling do better than uniform sampling?
//!
//! Because its density is closer to the integrand, which has a factor cos θ: the rate 1/√n is the same, the variance of a draw is smaller, and
//! it is 0 where the two are proportional. It is also larger under some lights. The variance is itself a mean, of (X − L_r)², and is estimated as one.

use std::process::ExitCode;

use unbiased::hemisphere::Hemisphere::{self, Cosine, Uniform};
use unbiased::lambertian::{CosinePower, Lambertian, Light, RingLight};
use unbiased::workbook::{self, Answer, Options};
use unbiased::{Estimator, Result, figure, from_fn};

/// The answers, as the options ask.
pub fn answer(options: &Options) -> Result<Vec<Answer>> {
    let cube = Lambertian::new(options.number("albedo"))?;
    let ring = RingLight::new(options.number("width"))?;
    let mut answers = vec![
        Answer::new("3.6", "variance against the light")
            .figure(figure::variance_against_exponent(100_000, options.seed)?)
            .figure(figure::variance_against_ring(400_000, options.seed)?),
    ];
    for a in [options.number("a"), 0.0, -0.5] {
        let sky = CosinePower::new(a)?;
        for (what, hemisphere) in
            [("variance, uniform directions", Uniform), ("variance, cosine directions", Cosine)]
        {
            let row = Answer::new("3.6", what).parameter("albedo", cube.albedo()).parameter("a", a);
            // the error bar of a variance takes E[X⁴]: finite for a > −5/4 and a > −1/2
            let has_error_bar = a > if hemisphere == Uniform { -1.25 } else { -0.5 };
            let row = if has_error_bar { row } else { row.demonstration() };
            answers.push(measured(row, cube, sky, hemisphere, options)?);
        }
    }
    for (what, hemisphere) in
        [("variance, uniform directions, ring", Uniform), ("variance, cosine directions, ring", Cosine)]
    {
        let row =
            Answer::new("3.6", what).parameter("albedo", cube.albedo()).parameter("width", ring.width());
        answers.push(measured(row, cube, ring, hemisphere, options)?);
    }
    Ok(answers)
}

/// The row with its exact variance and the mean of (X − L_r)².
fn measured(
    row: Answer,
    cube: Lambertian,
    light: impl Light + Copy,
    hemisphere: Hemisphere,
    options: &Options,
) -> Result<Answer> {
    let mean = light.reflected(cube);
    let draw: Box<dyn Estimator> = match hemisphere {
        Uniform => Box::new(cube.uniform_estimator(move |w| light.incoming(w))),
        Cosine => Box::new(cube.cosine_estimator(move |w| light.incoming(w))),
    };
    let squared_deviation = from_fn(|rng| {
        let x = draw.draw(rng);
        let deviation = x - mean;
        // a few units in the last place of x are rounding, and no variance
        if deviation.abs() <= 8.0 * f64::EPSILON * x.abs() { 0.0 } else { deviation * deviation }
    });
    Ok(row.truth(light.variance(cube, hemisphere)).outcome(&options.run(&squared_deviation, 1_000_000)?))
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::main("3.6", answer)
}
