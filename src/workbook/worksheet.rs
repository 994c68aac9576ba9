//! A worksheet of many questions, its key and its appendices, for one or for each student of a class.

use std::mem;
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use super::options::Voice;
use super::{AnswerFn, Appendix, Contents, Options, Table};
use super::{command_line, ended, page, print, sheet, variant};
use crate::error::{Error, Result};
use crate::numbers::parseable;
use crate::plot::{Edition, write_whole};
use crate::question::{Question, Values};
use crate::run::Budget;

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
///     let Ok(bounces) = question("5.2") else { return std::process::ExitCode::FAILURE };
///     Worksheet::new("A first sheet").question_at(bounces, answer, &[("p-rr", "0.3")]).run()
/// }
/// ```
#[derive(Debug, Clone)]
pub struct Worksheet {
    title: String,
    asked: Vec<(&'static Question, AnswerFn)>,
    beside: Vec<&'static Appendix>,
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
        values: &[(&'static str, &'static str)],
    ) -> Self {
        self.given.extend(values.iter().map(|(name, value)| (question, *name, *value)));
        self.question(question, answer)
    }

    /// Adds an appendix.
    pub fn beside(mut self, appendix: &'static Appendix) -> Self {
        self.beside.push(appendix);
        self
    }

    /// The worksheet's `main`: reads the command line, answers all questions, and writes `solution.html`,
    /// with the appendices as separate pages, or `student.html`, or both. With `--variants FILE` each name in
    /// the file gets a folder with its own pages, without appendices, and `key.csv` has everyone's answers.
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
        let Some(mut options) = command_line::read(&questions, None)? else { return Ok(()) };
        let mut own = Values::default();
        for (question, name, value) in &self.given {
            own.set(question, name, value)?;
        }
        options.values.put_below(own);
        options.title.clone_from(&self.title);
        options.voice = if options.verbose { Voice::Full } else { Voice::Brief };
        for question in &questions {
            question.at(&options.values)?;
        }
        options.with_out(|| match &options.variants {
            None => one_worksheet(&self.asked, &self.beside, &options),
            Some(file) => one_for_each(file, &self.asked, &options),
        })
    }
}

/// Writes the pages of one worksheet, and the appendices' pages with the key.
fn one_worksheet(
    asked: &[(&'static Question, AnswerFn)],
    appendices: &[&Appendix],
    options: &Options,
) -> Result<()> {
    let mut answered = Vec::new();
    let mut unanswered = Vec::new();
    for (question, answer) in asked {
        answered.push((*question, sheet::answered(question, *answer, options)?));
        if options.both {
            unanswered.push((*question, sheet::for_students(question, *answer, options)?));
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
        for appendix in appendices {
            print::title(appendix.example, "", options)?;
            let made = within_reason(appendix, options)?;
            // the appendices' own examples print their numbers for programs
            let voice = if options.json { Voice::Quiet } else { options.voice };
            print::appendix(appendix, &made, &Options { voice, json: false, ..options.clone() })?;
            pages.push((format!("{}.html", appendix.example), page::appendix(appendix, &made)));
        }
        pages.push(("solution.html".to_owned(), page::key(&answered, appendices, options)?));
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
    let mut rows = Vec::new();
    for name in &names {
        let mut own = options.clone();
        own.values = own.values.variant(name, asked.iter().map(|(question, _)| *question))?;
        own.out = options.out.join(variant::folder(name));
        (own.voice, own.one_figure) = (Voice::Quiet, true);
        own.with_out(|| one_worksheet(asked, &[], &own))?;
        print::line(&format!("{name}: {}", own.out.display()))?;
        for (question, _) in asked {
            rows.extend(variant::key(name, question, &own.values)?);
        }
    }
    let key = Table::new("", ["name", "question", "asked for", "formula", "answer"], rows);
    let path = options.out.join("key.csv");
    write_whole(&path, key.csv()?.as_bytes())?;
    print::line(&format!("The key of all: {}", path.display()))
}

/// An appendix in the time that it may take as part of the worksheet. Its text says so if that is less than
/// asked for.
fn within_reason(appendix: &Appendix, options: &Options) -> Result<Contents> {
    match options.budget {
        Some(Budget::Time(time)) if time > MOST_TIME_BESIDE && appendix.seconds.is_some() => {
            let shorter = Options { budget: Some(Budget::Time(MOST_TIME_BESIDE)), ..options.clone() };
            let mut made = (appendix.make)(&shorter)?;
            let (most, asked) = (MOST_TIME_BESIDE.as_secs_f64(), parseable(time.as_secs_f64()));
            made.text += &format!(
                " Here it is {most} s each at most; \"cargo run --release --example {} -- --seconds \
                 {asked}\" takes the time asked for.",
                appendix.example
            );
            Ok(made)
        }
        _ => (appendix.make)(options),
    }
}

/// The most time for each estimator of an appendix, of which there may be a hundred.
const MOST_TIME_BESIDE: Duration = Duration::from_millis(100);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_appendix_has_its_own_time_inside_the_worksheet_and_says_so() {
        let text = |seconds, budget| {
            let make = |options: &Options| {
                let text = format!("{:?}.", options.budget);
                Ok(Contents { text, tables: Vec::new(), records: Vec::new(), figures: Vec::new() })
            };
            let appendix = Appendix { example: "trade", title: "", about: "", seconds, why: "", make };
            within_reason(&appendix, &Options { budget, ..Options::default() }).unwrap().text
        };
        let time = |seconds| Some(Budget::Time(Duration::from_secs_f64(seconds)));
        assert_eq!(
            text(Some(""), time(2.5)),
            "Some(Time(100ms)). Here it is 0.1 s each at most; \"cargo run --release --example trade -- \
             --seconds 2.5\" takes the time asked for."
        );
        assert_eq!(text(Some(""), time(0.1)), "Some(Time(100ms)).");
        assert_eq!(text(Some(""), time(0.02)), "Some(Time(20ms)).");
        assert_eq!(text(Some(""), None), "None.");
        assert_eq!(text(None, time(2.0)), "Some(Time(2s)).");
    }
}
