//! Question 4.2: paths of three bounces in the box room.
//!
//! One more vertex, p_j′, drawn from p_j around the normal there. No closed form is known for the radiance;
//! two independent estimators, which share only the room, agree on it.

use unbiased::Result;
use unbiased::lambertian::hemisphere::Hemisphere::{Cosine, Uniform};
use unbiased::paths::figures;
use unbiased::paths::room::BoxRoom;
use unbiased::paths::{Bounces, FindLight, Paths};
use unbiased::workbook::{self, Sheet};

/// Three paths to draw, and the radiance of all such paths, found in two ways.
pub fn answer(sheet: &Sheet) -> Result<()> {
    let room = BoxRoom::new(sheet.scene())?;
    let sampled = Paths::new(room, Bounces::Exactly(3), Cosine, FindLight::BySampling)?;
    let by_chance = Paths::new(room, Bounces::Exactly(3), Uniform, FindLight::ByChance)?;
    let seed = sheet.seed();
    sheet.row("the paths drawn");
    sheet.drawing(|_| figures::paths_drawn(&sampled, 3, seed))?;
    for (what, paths) in [
        ("radiance of such paths, light sampled, cosine directions", sampled),
        ("radiance of such paths, light by chance, uniform directions", by_chance),
    ] {
        sheet.row(what).estimate(&paths)?;
    }
    Ok(())
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> std::process::ExitCode {
    workbook::main("4.2", answer)
}
