//! Question 3.1: what is the cube's emitted radiance?
//!
//! L_e = 0, as wood does not emit light. So the outgoing radiance L_o = L_e + L_r is the reflected radiance
//! alone, and it is 0 if no light arrives.

use unbiased::Result;
use unbiased::lambertian::Lambertian;
use unbiased::lambertian::hemisphere::Hemisphere;
use unbiased::workbook::{self, Sheet};

/// Nothing is emitted, and nothing is reflected in the dark.
pub fn answer(sheet: &Sheet) -> Result<()> {
    let cube = Lambertian::new(sheet.number("albedo"))?;
    let in_the_dark = cube.estimator(|_| 0.0, Hemisphere::Uniform);
    sheet.row("emitted radiance L_e").truth(0.0).value(cube.emitted());
    sheet.row("outgoing radiance L_e + L_r in the dark").truth(0.0).draws(1000).estimate(&in_the_dark)?;
    Ok(())
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> std::process::ExitCode {
    workbook::main("3.1", answer)
}
