//! Question 4.2: paths of three bounces in the box room.
//!
//! One more vertex, p_j′, drawn from p_j around the normal there. No closed form is known for the light they carry; two estimators
//! that share nothing but the room agree on it.

use std::process::ExitCode;

use unbiased::box_room::BoxRoom;
use unbiased::hemisphere::Hemisphere;
use unbiased::paths::{Bounces, FindLight, Paths};
use unbiased::workbook::{self, Answer, Options};
use unbiased::{Result, figure};

#[path = "section4/dark.rs"]
#[allow(clippy::duplicate_mod)] // the worksheet takes it in with each of its examples
mod dark;

/// The answers, as the options ask.
pub fn answer(options: &Options) -> Result<Vec<Answer>> {
    let room = BoxRoom::new(options.scene())?;
    let paths = |directions, light| Paths::new(room, Bounces::Exactly(3), directions, light);

    let mut drawing = Answer::new("4.2", "the paths drawn");
    for figure in figure::paths_drawn(&paths(Hemisphere::Cosine, FindLight::BySampling)?, 3, options.seed)? {
        drawing = drawing.figure(figure);
    }
    let mut answers = vec![drawing];
    for (what, directions, light) in [
        ("light sampled, cosine directions", Hemisphere::Cosine, FindLight::BySampling),
        ("light by chance, uniform directions", Hemisphere::Uniform, FindLight::ByChance),
    ] {
        let outcome = options.run(&paths(directions, light)?, 1_000_000)?;
        let row = Answer::new("4.2", &format!("light that such paths carry, {what}"));
        answers.push(dark::unless_none_found(row.scene(room.scene()).outcome(&outcome), &room));
    }
    Ok(answers)
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::main("4.2", answer)
}
