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
pub mod extremes;
mod grammar;
mod options;
mod page;
mod print;
mod progress;
mod shards;
mod sheet;
mod stated;
mod terminal;
mod value;
mod variant;

use std::mem;
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

pub use answer::{Answer, Kind};
pub use appendix::{Appendix, Table};
pub use by_hand::{Judgement, Number, Slip, judge_answer, judge_answer_at};
pub(crate) use by_hand::{classic, slip};
#[cfg(feature = "notebook")]
pub(crate) use check::told_once;
pub use check::{check_mine, exercise, exercises, mistakes};
pub use options::Options;
pub use sheet::{Row, Sheet};
pub use stated::{Letter, Stated};
pub use value::Value;

use crate::error::{Error, Result};
use crate::numbers::parseable;
use crate::plot::{Edition, write_whole};
use crate::run::Budget;
use crate::{inversion, lambertian, paths, rectangle, roulette};
use appendix::Beside;
use options::{Asked, Request};
use sheet::Voice;

/// One question of the worksheet, with all that is fixed before anything is run.
///
/// Texts are plain, and `latex` is LaTeX for the page. A part between « and » is a formula in the question's
/// letters, written as answers are; [`at`](Self::at) replaces it by its value at the parameters.
#[derive(Debug, Clone, Copy)]
pub struct Question {
    /// The worksheet's number.
    pub id: &'static str,
    /// A few words that do not give the answer away.
    pub title: &'static str,
    /// What is asked.
    pub statement: &'static str,
    /// A hint that does not give the answer away.
    pub hint: &'static str,
    /// The closed form in one line of plain text.
    pub formula: &'static str,
    /// The same in LaTeX, one displayed formula each.
    pub latex: &'static [&'static str],
    /// The explanation, one paragraph.
    pub answer: &'static str,
    /// The numbers that it asks for, with known wrong ones.
    pub numbers: &'static [Number],
    /// Classic wrong answers that are not numbers.
    pub wrong: &'static [Wrong],
    /// A correction to the sheet as it was handed out.
    pub on_the_original: Option<&'static str>,
    /// The file in `examples/`, without `.rs`.
    pub example: &'static str,
    /// Its own options.
    pub parameters: &'static [Parameter],
    /// Further letters of its formulas, computed from the parameters.
    pub derived: &'static [Letter],
}

/// A classic wrong answer that is not a number.
#[derive(Debug, Clone, Copy)]
pub struct Wrong {
    /// The wrong answer.
    pub answer: &'static str,
    /// The slip that leads there.
    pub slip: &'static str,
}

/// An option of one question: `--name value`.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Its name on the command line, without the dashes.
    pub name: &'static str,
    /// The default value.
    pub default: Value,
    /// The description, with the domain.
    pub help: &'static str,
    /// The values that it may have in a variant, short ones; none if it is not varied.
    pub variants: &'static [f64],
    /// Its letter in formulas, if it is a number.
    pub letter: Option<Letter>,
}

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

/// The `main` of the example of one of the workbook's questions: see [`main_of`].
pub fn main(id: &str, answer: AnswerFn) -> ExitCode {
    match question(id) {
        Ok(question) => main_of(question, answer),
        Err(error) => ended(Err(error)),
    }
}

/// The `main` of an example: reads the command line, answers the question, prints the answers and saves their
/// figures.
pub fn main_of(question: &'static Question, answer: AnswerFn) -> ExitCode {
    let answered = || {
        let questions = [question];
        let asked = Asked::Questions(&questions);
        let Some(options) = Request::read(asked)?.options(asked)? else { return Ok(()) };
        let options = options.for_question(question);
        // a parameter outside its domain is an error before anything is run
        question.at(&options)?;
        let all = || {
            sheet::answered(question, answer, &options, Voice::Full)?;
            if options.both && options.shard.is_none() {
                for_students(question, answer, &options)?;
            }
            Ok(())
        };
        // a shard draws no figures
        if options.shard.is_some() { all() } else { options.with_out(all) }
    };
    ended(answered())
}

/// What an appendix's example does.
pub type AppendixFn = fn(&Options) -> Result<Appendix>;

/// The `main` of an appendix's example: reads the command line, prints the tables and saves the figures.
pub fn appendix(example: &str, appendix: AppendixFn) -> ExitCode {
    ended(appendix::beside(example).and_then(|beside| {
        let asked = Asked::Beside(beside);
        let Some(options) = Request::read(asked)?.options(asked)? else { return Ok(()) };
        options.with_out(|| print::appendix(&appendix(&options)?, true, &options))
    }))
}

/// A worksheet: questions of this crate or your own, each with the function that answers it.
///
/// `examples/own_worksheet.rs` is a worksheet for another course.
///
/// ```no_run
/// use unbiased::workbook::{Sheet, Worksheet, question};
/// use unbiased::{Result, from_fn};
///
/// fn answer(sheet: &Sheet) -> Result<()> {
///     let p = sheet.number("p-rr");
///     let coin = from_fn(|rng| if rng.uniform() < p { 1.0 } else { 0.0 });
///     sheet.row("P(N ≥ 1)").truth(p).estimate(&coin)?;
///     Ok(())
/// }
///
/// fn main() -> std::process::ExitCode {
///     let worksheet = Worksheet::new("A first sheet");
///     question("5.2").map(|question| worksheet.question_at(question, answer, &[("p-rr", "0.3")])).map_or(
///         std::process::ExitCode::FAILURE,
///         |worksheet| worksheet.run(),
///     )
/// }
/// ```
#[derive(Debug, Clone)]
pub struct Worksheet {
    title: String,
    asked: Vec<(&'static Question, AnswerFn)>,
    beside: Vec<(&'static str, AppendixFn)>,
    /// Parameters that differ from the questions' defaults.
    given: Vec<(&'static Question, &'static str, &'static str)>,
}

impl Worksheet {
    /// A worksheet without questions.
    pub fn new(title: &str) -> Self {
        Self { title: title.into(), asked: Vec::new(), beside: Vec::new(), given: Vec::new() }
    }

    /// Adds a question.
    pub fn question(mut self, question: &'static Question, answer: AnswerFn) -> Self {
        self.asked.push((question, answer));
        self
    }

    /// Adds a question with other values of its parameters, given by name.
    pub fn question_at(
        mut self,
        question: &'static Question,
        answer: AnswerFn,
        numbers: &[(&'static str, &'static str)],
    ) -> Self {
        self.given.extend(numbers.iter().map(|(name, value)| (question, *name, *value)));
        self.question(question, answer)
    }

    /// Adds an appendix.
    pub fn beside(mut self, example: &'static str, appendix: AppendixFn) -> Self {
        self.beside.push((example, appendix));
        self
    }

    /// The worksheet's `main`: reads the command line, answers all questions, and writes `solution.html`,
    /// with the appendices as separate pages, or `student.html`, or both.
    ///
    /// With `--seconds`, each of the many estimators in an appendix gets at most a tenth of a second.
    pub fn run(self) -> ExitCode {
        ended(self.pages())
    }

    fn pages(&self) -> Result<()> {
        let questions: Vec<_> = self.asked.iter().map(|(question, _)| *question).collect();
        for (index, question) in questions.iter().enumerate() {
            if questions.iter().take(index).any(|before| before.id == question.id) {
                return Err(Error::Usage(format!("question {} is on the worksheet twice", question.id)));
            }
        }
        if questions.is_empty() {
            return Err(Error::Usage(format!("the worksheet “{}” has no questions", self.title)));
        }
        let all = Asked::Questions(&questions);
        let Some(mut options) = Request::read(all)?.options(all)? else { return Ok(()) };
        for (question, name, value) in &self.given {
            let mut own = Options::default();
            own.set(question, name, value)?;
            options.put_below(own.for_alone(question));
        }
        options.title.clone_from(&self.title);
        for question in &questions {
            question.at(&options)?;
        }
        match &options.variants {
            None => options.with_out(|| one_worksheet(&self.asked, &self.beside, &options)),
            Some(file) => options.with_out(|| one_for_each(file, &self.asked, &options)),
        }
    }
}

/// Writes the pages of one worksheet, and the appendices' pages with the key.
fn one_worksheet(
    asked: &[(&'static Question, AnswerFn)],
    appendices: &[(&'static str, AppendixFn)],
    options: &Options,
) -> Result<()> {
    let voice = if options.verbose { Voice::Full } else { Voice::Brief };
    let mut answered = Vec::new();
    let mut unanswered = Vec::new();
    for (question, answer) in asked {
        answered.push((*question, sheet::answered(question, *answer, options, voice)?));
        if options.both {
            unanswered.push((*question, for_students(question, *answer, options)?));
        }
    }
    if options.edition == Edition::Student {
        unanswered = mem::take(&mut answered);
    }
    let mut pages = Vec::new();
    if !unanswered.is_empty() {
        pages.push(("student.html".to_owned(), page::sheet(&unanswered, options)?));
    }
    if !answered.is_empty() {
        let mut beside = Vec::new();
        for (example, appendix) in appendices {
            print::title(example, "", options)?;
            let appendix = within_reason(appendix::beside(example)?, *appendix, options)?;
            // no JSON: the appendices' own examples print their numbers for programs
            print::appendix(&appendix, options.verbose && !options.json, options)?;
            pages.push((format!("{example}.html"), page::beside(&appendix)));
            beside.push(appendix);
        }
        pages.push(("solution.html".to_owned(), page::key(&answered, &beside, options)?));
    }
    print::summary(&answered, options)?;
    for (name, page) in pages {
        let path = options.out.join(name);
        write_whole(&path, page.as_bytes())?;
        print::page(&path, options)?;
    }
    Ok(())
}

/// A folder of pages for each name in a file, and one key for all of them.
fn one_for_each(file: &Path, asked: &[(&'static Question, AnswerFn)], options: &Options) -> Result<()> {
    let shown = file.display().to_string();
    let bytes =
        std::fs::read(file).map_err(|error| Error::Usage(format!("{shown} could not be read: {error}")))?;
    let names = variant::names(&bytes, &shown)?;
    let failed = |error: String| Error::Write { path: "the key".into(), reason: error };
    let mut key = csv::Writer::from_writer(Vec::new());
    key.write_record(["name", "question", "asked for", "formula", "answer"])
        .map_err(|error| failed(error.to_string()))?;
    for name in &names {
        let mut own = options.clone().variant(name, asked.iter().map(|(question, _)| *question))?;
        own.out = options.out.join(variant::folder(name));
        (own.quiet, own.one_figure) = (true, true);
        own.with_out(|| one_worksheet(asked, &[], &own))?;
        print::line(&format!("{name}: {}", own.out.display()))?;
        for [question, what, formula, truth] in
            variant::key(asked.iter().map(|(question, _)| *question), &own)?
        {
            key.write_record([name, &question, &what, &formula, &truth])
                .map_err(|error| failed(error.to_string()))?;
        }
    }
    let bytes = key.into_inner().map_err(|error| failed(error.to_string()))?;
    let path = options.out.join("key.csv");
    write_whole(&path, &bytes)?;
    print::line(&format!("The key of all: {}", path.display()))
}

/// The question in the student's edition, if both editions are made: its figures are saved.
fn for_students(question: &'static Question, answer: AnswerFn, options: &Options) -> Result<Vec<Answer>> {
    let mut options = options.clone();
    options.edition = Edition::Student;
    options.quiet = true;
    sheet::answered(question, answer, &options, Voice::Brief)
}

/// An appendix in the time that it may take as part of the worksheet. Its text says so if that is less than
/// asked for.
fn within_reason(beside: &Beside, appendix: AppendixFn, options: &Options) -> Result<Appendix> {
    match options.budget {
        Some(Budget::Time(time)) if time > MOST_TIME_BESIDE && beside.seconds.is_some() => {
            let mut shorter = options.clone();
            shorter.budget = Some(Budget::Time(MOST_TIME_BESIDE));
            let mut appendix = appendix(&shorter)?;
            let (most, asked) = (MOST_TIME_BESIDE.as_secs_f64(), parseable(time.as_secs_f64()));
            appendix.text += &format!(
                " Here it is {most} s each at most; \"cargo run --release --example {} -- --seconds \
                 {asked}\" takes the time asked for.",
                beside.example
            );
            Ok(appendix)
        }
        _ => appendix(options),
    }
}

/// The most time for each estimator of an appendix, of which there may be a hundred.
const MOST_TIME_BESIDE: Duration = Duration::from_millis(100);

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
            "Some(Time(100ms)). Here it is 0.1 s each at most; \"cargo run --release --example trade -- \
             --seconds 2.5\" takes the time asked for."
        );
        assert_eq!(text("trade", time(0.1)), "Some(Time(100ms)).");
        assert_eq!(text("trade", time(0.02)), "Some(Time(20ms)).");
        assert_eq!(text("trade", None), "None.");
        assert_eq!(text("extremes", time(2.0)), "Some(Time(2s)).");
    }
}
