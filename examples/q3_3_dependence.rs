//! Question 3.3: how does the reflected radiance depend on ω_o and on ρ?
//!
//! It does not depend on ω_o, and is proportional to ρ: half the albedo gives half the radiance. Only the
//! BRDF could depend on ω_o, and ρ/π does not.

use unbiased::Result;
use unbiased::lambertian::Lambertian;
use unbiased::lambertian::hemisphere::Hemisphere;
use unbiased::workbook::{self, Sheet};

/// The albedo asked for, and half of it.
pub fn answer(sheet: &Sheet) -> Result<()> {
    let (albedo, radiance) = (sheet.number("albedo"), sheet.number("radiance"));
    let cubes = [Lambertian::new(albedo)?, Lambertian::new(0.5 * albedo)?];
    sheet.row("dependence on ω_o").note(
        "The estimator draws directions ω_i of incoming light and does not use ω_o: the result is the same \
         for every viewing direction.",
    );
    for cube in cubes {
        sheet
            .row("reflected radiance")
            .parameter("albedo", cube.albedo())
            .truth(cube.reflected(radiance))
            .estimate(&cube.estimator(|_| radiance, Hemisphere::Uniform))?;
    }
    Ok(())
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> std::process::ExitCode {
    workbook::main("3.3", answer)
}
