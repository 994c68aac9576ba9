//! Question 3.2: the incoming radiance is the same from everywhere. What is the reflected radiance?
//!
//! L_r = ρ/π L_i ∫∫ cos θ sin θ dθ dφ = ρ L_i. Estimated as an integral over directions and over angles, and
//! wrongly, with a factor forgotten.

use std::f64::consts::{FRAC_PI_2, TAU};

use unbiased::lambertian::Lambertian;
use unbiased::lambertian::figures;
use unbiased::lambertian::hemisphere::Hemisphere;
use unbiased::workbook::{self, Sheet};
use unbiased::{Result, f_over_p, from_fn};

/// Over directions, over angles, and with a factor forgotten.
pub fn answer(sheet: &Sheet) -> Result<()> {
    let (cube, radiance) = (Lambertian::new(sheet.number("albedo"))?, sheet.number("radiance"));

    // f_r L_i cos θ / p(ω)
    let over_directions = f_over_p(|w| cube.brdf() * radiance * w.cos_theta(), Hemisphere::Uniform);
    // f_r L_i cos θ sin θ, with θ and φ uniform on [0, π/2) × [0, 2π)
    let over_angles = from_fn(|rng| {
        let theta = FRAC_PI_2 * rng.uniform();
        cube.brdf() * radiance * theta.cos() * theta.sin() * FRAC_PI_2 * TAU
    });
    let without_sine =
        from_fn(|rng| cube.brdf() * radiance * (FRAC_PI_2 * rng.uniform()).cos() * FRAC_PI_2 * TAU);
    let without_cosine = f_over_p(|_| cube.brdf() * radiance, Hemisphere::Uniform);

    let row = |what| sheet.row(what).truth(cube.reflected(radiance));
    row("reflected radiance, integrated over directions").estimate(&over_directions)?;
    sheet.figure(figures::integrand)?;
    row("reflected radiance, integrated over θ and φ").estimate(&over_angles)?;
    row("sin θ forgotten").wrong_on_purpose("dω = sin θ dθ dφ").estimate(&without_sine)?;
    row("cos θ forgotten").wrong_on_purpose("f/p has a factor cos θ").estimate(&without_cosine)?;
    Ok(())
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> std::process::ExitCode {
    workbook::main("3.2", answer)
}
