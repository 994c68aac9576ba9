//! A question to be answered by hand.

use maud::{Markup, html};

use super::super::{Answer, Options};
use super::text::prose;
use crate::error::Result;
use crate::plot::Edition;
use crate::question::Question;

pub(super) fn article(question: &'static Question, answers: &[Answer], options: &Options) -> Result<Markup> {
    let stated = question.at(&options.values)?;
    let edition = Edition::Student;
    let answers = answers.iter().filter(|answer| answer.shown_in(edition));
    Ok(html! {
        article id=(super::id_of(question)) {
            h3 { (question.id) " " (prose(&stated.title)) }
            p.statement { (prose(&stated.statement)) }
            div.drawing[question.lines == 0] {
                @for figure in answers.flat_map(|answer| answer.figures(edition)) { (super::shown(figure)) }
            }
            div aria-hidden="true" { @for _ in 0..question.lines { div.line {} } }
        }
    })
}
