//! The table of questions, the options that all examples share, and how answers are printed, written as JSON and put on a page.
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
mod grammar;
mod options;
mod page;
mod print;
mod progress;
mod section1;
mod section2;
mod section3;
mod section4;
mod section5;
mod shards;
mod sheet;
mod terminal;
mod value;

use std::process::ExitCode;
use std::time::Duration;

pub use answer::{Answer, Kind};
pub use appendix::{Appendix, Table};
pub use by_hand::{Judgement, Letter, Number, Slip, judge_answer, judge_answer_at};
#[cfg(feature = "notebook")]
pub(crate) use check::told_once;
pub use check::{check_mine, exercise, exercises};
pub use options::Options;
pub use sheet::{Row, Sheet};
pub use value::Value;

use crate::error::{Error, Result};
use crate::figure::{Edition, write_whole};
use crate::numbers::parseable;
use crate::run::Budget;
use appendix::Beside;
use options::{Asked, Request};
use sheet::Voice;

/// One question of the worksheet, with all that is known about it before anything is run.
///
/// Texts are plain; `latex` is LaTeX, shown on the page.
#[derive(Debug, Clone, Copy)]
pub struct Question {
    /// The worksheet's number.
    pub id: &'static str,
    /// A few words, which do not tell the answer.
    pub title: &'static str,
    /// What is asked.
    pub statement: &'static str,
    /// A nudge that does not tell the answer.
    pub hint: &'static str,
    /// The closed form in a line of plain text.
    pub formula: &'static str,
    /// The same in LaTeX, a displayed formula each.
    pub latex: &'static [&'static str],
    /// Why it is so, in a paragraph.
    pub answer: &'static str,
    /// The numbers that it asks for, with the wrong ones that people arrive at.
    pub numbers: &'static [Number],
    /// What else people answer.
    pub wrong: &'static [Wrong],
    /// Where the sheet as it was handed out needs correcting.
    pub on_the_original: Option<&'static str>,
    /// The file in `examples/`, without `.rs`.
    pub example: &'static str,
    /// The module that holds its estimators.
    pub module: &'static str,
    /// Its own options.
    pub parameters: &'static [Parameter],
}

/// A classic wrong answer that is no number.
#[derive(Debug, Clone, Copy)]
pub struct Wrong {
    /// What is answered.
    pub answer: &'static str,
    /// The slip that leads there.
    pub slip: &'static str,
}

/// An option of one question: `--name value`.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Its name on the command line, without the dashes.
    pub name: &'static str,
    /// Its value where none is given.
    pub default: Value,
    /// What it is, with its domain.
    pub help: &'static str,
}

/// All questions, in the worksheet's order.
pub fn questions() -> impl Iterator<Item = &'static Question> {
    let sections = [
        section1::QUESTIONS,
        section2::QUESTIONS,
        section3::QUESTIONS,
        section4::QUESTIONS,
        section5::QUESTIONS,
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

/// An example's `main`: reads the command line, answers the question, prints the answers and saves their figures.
pub fn main(id: &str, answer: AnswerFn) -> ExitCode {
    ended(question(id).and_then(|question| {
        let questions = [question];
        let asked = Asked::Questions(&questions);
        let Some(options) = Request::read(asked)?.options(asked)? else { return Ok(()) };
        let answer = || sheet::answered(question, answer, &options, Voice::Full).map(|_| ());
        // a shard draws nothing
        if options.shard.is_some() { answer() } else { options.with_out(answer) }
    }))
}

/// What an example beside the questions does.
pub type AppendixFn = fn(&Options) -> Result<Appendix>;

/// The `main` of this example beside the questions: reads the command line, prints the tables and saves the figures.
pub fn appendix(example: &str, appendix: AppendixFn) -> ExitCode {
    ended(appendix::beside(example).and_then(|beside| {
        let asked = Asked::Beside(beside);
        let Some(options) = Request::read(asked)?.options(asked)? else { return Ok(()) };
        options.with_out(|| print::appendix(&appendix(&options)?, true, &options))
    }))
}

/// The worksheet's `main`: answers all these questions, and writes `index.html` with all of it and the appendices.
///
/// Under `--seconds` an appendix has at most a tenth of a second for each of its many estimators.
pub fn worksheet(answers: &[(&str, AnswerFn)], appendices: &[(&str, AppendixFn)]) -> ExitCode {
    let asked = answers.iter().map(|(id, answer)| Ok((question(id)?, *answer))).collect::<Result<Vec<_>>>();
    ended(asked.and_then(|asked| {
        let questions: Vec<_> = asked.iter().map(|(question, _)| *question).collect();
        let all = Asked::Questions(&questions);
        let Some(options) = Request::read(all)?.options(all)? else { return Ok(()) };
        options.with_out(|| {
            let voice = if options.verbose { Voice::Full } else { Voice::Brief };
            let mut answered = Vec::new();
            for (question, answer) in &asked {
                answered.push((*question, sheet::answered(question, *answer, &options, voice)?));
            }
            let mut beside = Vec::new();
            if options.edition == Edition::Solution {
                for (example, appendix) in appendices {
                    print::title(example, "", &options)?;
                    let appendix = within_reason(appendix::beside(example)?, *appendix, &options)?;
                    // their numbers for programs are what their own examples give
                    print::appendix(&appendix, options.verbose && !options.json, &options)?;
                    beside.push(appendix);
                }
            }
            let path = options.out.join("index.html");
            write_whole(&path, page::page(&answered, &beside, &options)?.as_bytes())?;
            print::summary(&answered, &options)?;
            print::page(&path, &options)
        })
    }))
}

/// An appendix in the time that it may take beside the questions; its text says so where that is less than what is asked for.
fn within_reason(beside: &Beside, appendix: AppendixFn, options: &Options) -> Result<Appendix> {
    match options.budget {
        Some(Budget::Time(time)) if time > MOST_TIME_BESIDE && beside.seconds.is_some() => {
            let mut shorter = options.clone();
            shorter.budget = Some(Budget::Time(MOST_TIME_BESIDE));
            let mut appendix = appendix(&shorter)?;
            let (most, asked) = (MOST_TIME_BESIDE.as_secs_f64(), parseable(time.as_secs_f64()));
            appendix.text += &format!(
                " Here it is {most} s each at most; \"cargo run --release --example {} -- --seconds {asked}\" takes the time asked for.",
                beside.example
            );
            Ok(appendix)
        }
        _ => appendix(options),
    }
}

/// For each estimator of an appendix, of which there may be a hundred.
const MOST_TIME_BESIDE: Duration = Duration::from_millis(100);

/// 0 for success, 2 for bad arguments, 1 for a failed run; the reason on standard error, in one sentence.
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

/// Whether an answer may be shown in this edition.
fn shown(answer: &Answer, edition: Edition) -> bool {
    edition == Edition::Solution || answer.kind() == Kind::Answer
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds_given(options: &Options) -> Result<Appendix> {
        Ok(Appendix {
            example: "trade",
            title: "",
            text: format!("{:?}.", options.budget),
            tables: Vec::new(),
            records: Vec::new(),
            figures: Vec::new(),
        })
    }

    #[test]
    fn an_appendix_has_its_own_time_inside_the_worksheet_and_says_so() {
        let text = |example, budget| {
            let mut options = Options::default();
            options.budget = budget;
            within_reason(appendix::beside(example).unwrap(), seconds_given, &options).unwrap().text
        };
        let time = |seconds| Some(Budget::Time(Duration::from_secs_f64(seconds)));
        assert_eq!(
            text("trade", time(2.5)),
            "Some(Time(100ms)). Here it is 0.1 s each at most; \"cargo run --release --example trade -- --seconds 2.5\" takes the time asked for."
        );
        assert_eq!(text("trade", time(0.1)), "Some(Time(100ms)).");
        assert_eq!(text("trade", time(0.02)), "Some(Time(20ms)).");
        assert_eq!(text("trade", None), "None.");
        assert_eq!(text("extremes", time(2.0)), "Some(Time(2s)).");
    }
}
