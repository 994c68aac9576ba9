//! The table of questions, the options that all examples share, and how answers are printed, written as JSON and put on a page.
//!
//! An example is a function from [`Options`] to [`Answer`]s and a one-line `main`:
//!
//! ```no_run
//! use unbiased::workbook::{self, Answer, Options};
//! use unbiased::{Result, inversion::Exponential};
//!
//! pub fn answer(options: &Options) -> Result<Vec<Answer>> {
//!     let exponential = Exponential::new(options.number("rate"))?;
//!     let outcome = options.run(&exponential, 1_000_000)?;
//!     Ok(vec![Answer::new("1.1", "mean of X").truth(exponential.mean()).outcome(&outcome)])
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
mod terminal;
mod value;

use std::mem;
use std::process::ExitCode;
use std::time::Duration;

pub use answer::{Answer, Kind};
pub use appendix::{Appendix, Table};
pub use by_hand::{Judgement, Letter, Number, Slip, judge_answer, judge_answer_at};
#[cfg(feature = "notebook")]
pub(crate) use check::told_once;
pub use check::{check_mine, exercise, exercises};
pub use options::Options;
pub use value::Value;

use crate::error::{Error, Result};
use crate::figure::{Edition, write_whole};
use crate::numbers::parseable;
use crate::run::Budget;
use appendix::Beside;
use options::{Asked, Request};

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

/// What an example does: answers to its question, with the options given.
pub type AnswerFn = fn(&Options) -> Result<Vec<Answer>>;

/// An example's `main`: reads the command line, answers the question, prints the answers and saves their figures.
pub fn main(id: &str, answer: AnswerFn) -> ExitCode {
    ended(question(id).and_then(|question| {
        let questions = [question];
        let asked = Asked::Questions(&questions);
        let Some(options) = Request::read(asked)?.options(asked)? else { return Ok(()) };
        let options = options.for_question(question);
        let all = || {
            let answers = answer(&options)?;
            if let Some(shards) = &options.shards {
                shards.belong_to(&answers)?;
            }
            print::answers(question, &answers, &options)?;
            if options.both && options.shard.is_none() {
                for_students(answer, &options).map(|_| ())
            } else {
                Ok(())
            }
        };
        // a shard draws nothing
        if options.shard.is_some() { all() } else { options.with_out(all) }
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

/// The worksheet's `main`: answers all these questions, and writes `solution.html`, with the appendices as
/// pages beside it, or `student.html`, or all of them.
///
/// Under `--seconds` an appendix has at most a tenth of a second for each of its many estimators.
pub fn worksheet(answers: &[(&str, AnswerFn)], appendices: &[(&str, AppendixFn)]) -> ExitCode {
    let asked = answers.iter().map(|(id, answer)| Ok((question(id)?, *answer))).collect::<Result<Vec<_>>>();
    ended(asked.and_then(|asked| {
        let questions: Vec<_> = asked.iter().map(|(question, _)| *question).collect();
        let all = Asked::Questions(&questions);
        let Some(options) = Request::read(all)?.options(all)? else { return Ok(()) };
        options.with_out(|| {
            let mut answered = Vec::new();
            let mut unanswered = Vec::new();
            for (question, answer) in &asked {
                let options = options.for_question(question);
                let rows = answer(&options)?;
                print::answers(question, &rows, &options)?;
                answered.push((*question, rows));
                if options.both {
                    unanswered.push((*question, for_students(*answer, &options)?));
                }
            }
            if options.edition == Edition::Student {
                unanswered = mem::take(&mut answered);
            }
            let mut pages = Vec::new();
            if !unanswered.is_empty() {
                pages.push(("student.html".to_owned(), page::sheet(&unanswered)?));
            }
            if !answered.is_empty() {
                let mut beside = Vec::new();
                for (example, appendix) in appendices {
                    let appendix = within_reason(appendix::beside(example)?, *appendix, &options)?;
                    // their numbers for programs are what their own examples give
                    print::appendix(&appendix, !options.json, &options)?;
                    pages.push((format!("{example}.html"), page::beside(&appendix)));
                    beside.push(appendix);
                }
                pages.push(("solution.html".to_owned(), page::key(&answered, &beside, &options)?));
            }
            for (name, page) in pages {
                let path = options.out.join(name);
                write_whole(&path, page.as_bytes())?;
                print::page(&path, &options)?;
            }
            Ok(())
        })
    }))
}

/// What the student's edition has of a question beside the solution: its figures, which are saved. Of its
/// numbers it shows none, so that a few draws will do.
fn for_students(answer: AnswerFn, options: &Options) -> Result<Vec<Answer>> {
    let mut options = options.clone();
    options.edition = Edition::Student;
    options.budget = Some(Budget::Draws(FEW));
    options.shards = None;
    let rows = answer(&options)?;
    for figure in rows.iter().flat_map(|row| row.figures(Edition::Student)) {
        figure.save(&options.out)?;
    }
    Ok(rows)
}

/// Draws of an estimator whose numbers nobody will see.
const FEW: u64 = 1000;

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
