//! Question 3.6: why does cosine-weighted sampling do better than uniform sampling?
//!
//! Its density is closer to the integrand, which has a factor cos θ. The rate 1/√n is the same, but the
//! variance of a draw is smaller, and 0 if density and integrand are proportional. For some incoming
//! radiances it is larger. The variance is itself a mean, of (X − L_r)², and is estimated as one.

use unbiased::lambertian::figures;
use unbiased::lambertian::hemisphere::Hemisphere::{self, Cosine, Uniform};
use unbiased::lambertian::{CosinePower, Lambertian, Light, RingLight};
use unbiased::workbook::{self, Row, Sheet};
use unbiased::{Doubt, Estimator, Result, from_fn};

/// Both variances under cos^a θ, and under a ring of light at the horizon.
pub fn answer(sheet: &Sheet) -> Result<()> {
    let cube = Lambertian::new(sheet.number("albedo"))?;
    let ring = RingLight::new(sheet.number("width"))?;
    let skies = [CosinePower::new(sheet.number("a"))?, CosinePower::new(0.0)?, CosinePower::new(-0.5)?];

    let seed = sheet.seed();
    sheet.row("variance against the light");
    sheet.figure(|| figures::variance_against_exponent(100_000, seed))?;
    sheet.figure(|| figures::variance_against_ring(400_000, seed))?;
    for sky in skies {
        // the error bar of a variance needs a finite E[X⁴]: a > −5/4 (uniform), a > −1/2 (cosine)
        for (what, density, least) in
            [("variance, uniform directions", Uniform, -1.25), ("variance, cosine directions", Cosine, -0.5)]
        {
            let row = sheet
                .row(what)
                .parameter("a", sky.a())
                .doubt((sky.a() <= least).then_some(Doubt::InfiniteVariance));
            measured(row, cube, sky, density)?;
        }
    }
    measured(sheet.row("variance, uniform directions, ring"), cube, ring, Uniform)?;
    measured(sheet.row("variance, cosine directions, ring"), cube, ring, Cosine)
}

/// The exact variance and the mean of (X − L_r)².
fn measured(row: Row<'_>, cube: Lambertian, light: impl Light + Copy, density: Hemisphere) -> Result<()> {
    let mean = light.reflected(cube);
    let draw: Box<dyn Estimator> = match density {
        Uniform => Box::new(cube.uniform_estimator(move |w| light.incoming(w))),
        Cosine => Box::new(cube.cosine_estimator(move |w| light.incoming(w))),
    };
    let squared_deviation = from_fn(|rng| {
        let x = draw.draw(rng);
        let deviation = x - mean;
        // a deviation of a few units in the last place of x is only rounding
        if deviation.abs() <= 8.0 * f64::EPSILON * x.abs() { 0.0 } else { deviation * deviation }
    });
    row.truth(light.variance(cube, density)).estimate(&squared_deviation)?;
    Ok(())
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> std::process::ExitCode {
    workbook::main("3.6", answer)
}
