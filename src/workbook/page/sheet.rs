//! A question to be answered by hand.

use maud::{Markup, html};

use super::super::{Answer, Options};
use super::text::prose;
use crate::error::Result;
use crate::plot::Edition;
use crate::question::Question;

/// The number of ruled lines for an answer by hand; none if the answer is drawn.
fn lines(id: &str) -> usize {
    match id {
        "4.1" | "4.2" => 0,
        "3.1" => 1,
        "1.2" | "1.3" | "5.2" => 2,
        "3.3" | "5.3" => 3,
        "3.4" | "3.5" | "3.6" | "4.3" => 4,
        "5.1" => 6,
        _ => 5,
    }
}

/// Whether the figure is drawn into by hand, and so as large as the paper allows.
fn drawn_into(id: &str) -> bool {
    matches!(id, "4.1" | "4.2")
}

pub(super) fn article(question: &'static Question, answers: &[Answer], options: &Options) -> Result<Markup> {
    let stated = question.at(&options.values)?;
    let edition = Edition::Student;
    let answers = answers.iter().filter(|answer| answer.shown_in(edition));
    Ok(html! {
        article id=(super::id_of(question)) {
            h3 { (question.id) " " (prose(&stated.title)) }
            p.statement { (prose(&stated.statement)) }
            div.drawing[drawn_into(question.id)] {
                @for figure in answers.flat_map(|answer| answer.figures(edition)) { (super::shown(figure)) }
            }
            div aria-hidden="true" { @for _ in 0..lines(question.id) { div.line {} } }
        }
    })
}
