//! Question 4.1: paths of two bounces in the box room.
//!
//! They are traced backwards, as in a path tracer: from p a random direction ω_i leads to p_j, where the
//! light is sampled. The numbers are the radiance at the eye after exactly two bounces.

use unbiased::Result;
use unbiased::lambertian::hemisphere::Hemisphere;
use unbiased::paths::figures;
use unbiased::paths::room::BoxRoom;
use unbiased::paths::{Bounces, FindLight, Paths};
use unbiased::workbook::{self, Sheet};

/// Three paths to draw, and the radiance of all such paths.
pub fn answer(sheet: &Sheet) -> Result<()> {
    let room = BoxRoom::new(sheet.scene())?;
    let paths = Paths::new(room, Bounces::Exactly(2), Hemisphere::Cosine, FindLight::BySampling)?;
    let seed = sheet.seed();
    sheet.row("the paths drawn");
    sheet.drawing(|_| figures::paths_drawn(&paths, 3, seed))?;
    sheet.row("radiance of such paths").truth(room.two_bounces()).estimate(&paths)?;
    Ok(())
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> std::process::ExitCode {
    workbook::main("4.1", answer)
}
