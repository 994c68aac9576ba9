//! Question 4.1: paths of two bounces in the box room.
//!
//! They are drawn as a path tracer finds them: from p a random direction ω_i leads to p_j, and from there the light is looked for. The numbers say what such paths carry: the part of the
//! light that reaches the eye after exactly two bounces.

use std::process::ExitCode;

use unbiased::box_room::BoxRoom;
use unbiased::hemisphere::Hemisphere;
use unbiased::paths::{Bounces, FindLight, Paths};
use unbiased::workbook::{self, Answer, Options};
use unbiased::{Result, figure};

/// The answers, as the options ask.
pub fn answer(options: &Options) -> Result<Vec<Answer>> {
    let room = BoxRoom::new(options.scene())?;
    let paths = Paths::new(room, Bounces::Exactly(2), Hemisphere::Cosine, FindLight::BySampling)?;

    let mut drawing = Answer::new("4.1", "the paths drawn");
    for figure in figure::paths_drawn(&paths, 3, options.seed)? {
        drawing = drawing.figure(figure);
    }
    let mut light = Answer::new("4.1", "light that such paths carry")
        .scene(room.scene())
        .outcome(&options.run(&paths, 1_000_000)?);
    if let Some(truth) = room.two_bounces() {
        light = light.truth(truth);
    }
    Ok(vec![drawing, light])
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::main("4.1", answer)
}
