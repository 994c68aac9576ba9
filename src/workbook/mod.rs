//! The questions, the options that all examples share, and the output of answers: as text, as JSON and as
//! pages.
//!
//! An example adds rows to a [`Sheet`], and has a one-line `main`:
//!
//! ```no_run
//! use unbiased::workbook::{self, Sheet};
//! use unbiased::{Result, inversion::Exponential};
//!
//! pub fn answer(sheet: &Sheet) -> Result<()> {
//!     let exponential = Exponential::new(sheet.number("rate"))?;
//!     sheet.row("mean of X").truth(exponential.mean()).estimate(&exponential)?;
//!     Ok(())
//! }
//!
//! fn main() -> std::process::ExitCode {
//!     workbook::main("1.1", answer)
//! }
//! ```

mod answer;
mod appendix;
mod by_hand;
mod check;
mod command_line;
pub mod extremes;
mod help;
mod options;
mod page;
mod print;
mod progress;
mod repeat;
mod shards;
mod sheet;
mod table;
mod terminal;
mod variant;
mod worksheet;

use std::process::ExitCode;

pub use answer::Answer;
pub use appendix::{Appendix, Contents};
pub use by_hand::{Judgement, judge_answer};
#[cfg(feature = "notebook")]
pub(crate) use check::told_once;
pub use check::{check_mine, exercise, mistakes};
pub use options::Options;
#[cfg(feature = "notebook")]
pub(crate) use print::interval;
pub use sheet::{Row, Sheet};
pub use table::Table;
pub use worksheet::Worksheet;

use crate::error::{Error, Result};
use crate::question::Question;
use crate::{inversion, lambertian, paths, rectangle, roulette};

/// All questions, in the worksheet's order.
pub fn questions() -> impl Iterator<Item = &'static Question> {
    let sections = [
        inversion::questions::QUESTIONS,
        rectangle::questions::QUESTIONS,
        lambertian::questions::QUESTIONS,
        paths::questions::QUESTIONS,
        roulette::questions::QUESTIONS,
    ];
    sections.into_iter().flatten()
}

/// The question with this number.
///
/// # Errors
/// If there is none.
pub fn question(id: &str) -> Result<&'static Question> {
    questions()
        .find(|question| question.id == id)
        .ok_or_else(|| Error::Usage(format!("there is no question {id}")))
}

/// What an example does: adds the rows that answer its question.
pub type AnswerFn = fn(&Sheet) -> Result<()>;

/// The `main` of a question's example: reads the command line, answers the question, prints the answers and
/// saves their figures.
pub fn main(id: &str, answer: AnswerFn) -> ExitCode {
    let answered = || {
        let question = question(id)?;
        let Some(options) = command_line::read(&[question], None)? else { return Ok(()) };
        // a parameter outside its domain is an error before anything is run
        question.at(&options.values)?;
        // a shard draws no figures
        if options.shard.is_some() {
            return sheet::answered(question, answer, &options).map(|_| ());
        }
        options.with_out(|| {
            sheet::answered(question, answer, &options)?;
            if options.both {
                sheet::for_students(question, answer, &options)?;
            }
            Ok(())
        })
    };
    ended(answered())
}

/// The `main` of an appendix's example: reads the command line, prints the tables and saves the figures.
pub fn appendix(appendix: &Appendix) -> ExitCode {
    let made = || {
        let Some(options) = command_line::read(&[], Some(appendix))? else { return Ok(()) };
        options.with_out(|| print::appendix(appendix, &(appendix.make)(&options)?, &options))
    };
    ended(made())
}

/// The exit code: 0 for success, 2 for bad arguments, 1 for a failed run, with the reason on standard error
/// in one sentence.
fn ended(result: Result<()>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            match error {
                Error::Usage(_)
                | Error::Parts { .. }
                | Error::Parameter { .. }
                | Error::Point { .. }
                | Error::Count { .. }
                | Error::TooFewDraws { .. } => ExitCode::from(2),
                _ => ExitCode::FAILURE,
            }
        }
    }
}
