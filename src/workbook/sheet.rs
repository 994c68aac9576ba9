//! The sheet that an example fills: a question's rows, one after the other.

use std::cell::{Cell, RefCell};

use super::answer::Unjudged;
use super::options::Voice;
use super::{Answer, AnswerFn, Options, print};
use crate::doubt::Doubt;
use crate::error::Result;
use crate::estimator::Estimator;
use crate::numbers::rounded;
use crate::paths::questions::scene;
use crate::paths::room::Scene;
use crate::plot::{Edition, Figure};
use crate::question::{Question, Value};
use crate::stream::{Stream, mix};

/// A question's sheet. It knows the question, its parameters, the seed and the number of draws, and an
/// example adds rows to it.
///
/// In the student's edition nothing is run: rows have titles only, and only figures to draw in are made.
pub struct Sheet {
    question: &'static Question,
    options: Options,
    rows: RefCell<Vec<Answer>>,
    /// How many rows are printed; `None` before the question is.
    printed: Cell<Option<usize>>,
}

/// The draws of a row that asks for no other number.
const DRAWS: u64 = 1_000_000;

/// The most random numbers, or evaluations if those are more, that a row takes unless the command line asks
/// for draws: some ten seconds of them.
const MOST_WORK: f64 = 1e9;

/// The same for a single draw, which cannot be cut short.
const MOST_WORK_A_DRAW: f64 = 1e7;

/// Answers a question, prints it and saves its figures.
pub(super) fn answered(
    question: &'static Question,
    answer: AnswerFn,
    options: &Options,
) -> Result<Vec<Answer>> {
    let options = options.for_question(question);
    let sheet = Sheet { question, options, rows: RefCell::default(), printed: Cell::new(None) };
    if sheet.options.voice == Voice::Brief {
        sheet.print_first(0)?;
    }
    answer(&sheet)?;
    if let Some(shards) = &sheet.options.shards {
        shards.are_used_up()?;
    }
    sheet.print_first(usize::MAX)?;
    let rows = sheet.rows.into_inner();
    print::ending(question, &rows, &sheet.options)?;
    Ok(rows)
}

/// Answers a question in the student's edition beside the key, and saves its figures.
pub(super) fn for_students(
    question: &'static Question,
    answer: AnswerFn,
    options: &Options,
) -> Result<Vec<Answer>> {
    let options = Options { edition: Edition::Student, voice: Voice::Quiet, ..options.clone() };
    answered(question, answer, &options)
}

impl Sheet {
    /// The value of the question's parameter `name`, a number; NaN if it has none of that name.
    pub fn number(&self, name: &str) -> f64 {
        self.options.values.number(name)
    }

    /// The same, which must be a whole number ≥ 0.
    ///
    /// # Errors
    /// If it is anything else.
    pub fn whole_number(&self, name: &'static str) -> Result<u64> {
        self.options.values.whole_number(name)
    }

    /// The value of the question's parameter `name`, a count; `None` for "all".
    pub fn limit(&self, name: &str) -> Option<u32> {
        self.options.values.limit(name)
    }

    /// The box room that section 4's parameters describe.
    pub fn scene(&self) -> Scene {
        scene(&self.options.values)
    }

    /// The seed of all random numbers.
    pub fn seed(&self) -> u64 {
        self.options.seed
    }

    /// Adds a row about `what`, which must not give the answer away. Its parameters are the question's own.
    pub fn row(&self, what: impl AsRef<str>) -> Row<'_> {
        let mut answer = Answer::new(self.question.id, what.as_ref());
        for (parameter, value) in self.options.values.parameters() {
            answer.set_parameter(&parameter.name.replace('-', "_"), value);
        }
        self.rows.borrow_mut().push(answer);
        Row { sheet: self, index: self.last(), draws: DRAWS }
    }

    /// Adds a figure of the answer to the row before it. A question's first one is printed, the others are
    /// seen on a screen. It is made where it is shown: not in the student's edition, and not by a shard.
    ///
    /// # Errors
    /// Those of making it.
    pub fn figure<F: Into<Vec<Figure>>>(&self, make: impl FnOnce() -> Result<F>) -> Result<()> {
        if self.options.edition == Edition::Solution { self.drawing(|_| make()) } else { Ok(()) }
    }

    /// Adds a figure that students also draw in to the last row.
    ///
    /// # Errors
    /// Those of making it.
    pub fn drawing<F: Into<Vec<Figure>>>(&self, make: impl FnOnce(Edition) -> Result<F>) -> Result<()> {
        let drawn = |row: &Answer| row.figures(self.options.edition).next().is_some();
        let enough = self.options.one_figure && self.rows.borrow().iter().any(drawn);
        if self.options.shard.is_none() && !enough {
            self.print_all_but_the_last()?;
            for figure in make(self.options.edition)?.into() {
                self.change(self.last(), |answer| answer.figures.push(figure));
            }
        }
        Ok(())
    }

    fn change(&self, index: usize, change: impl FnOnce(&mut Answer)) {
        if let Some(answer) = self.rows.borrow_mut().get_mut(index) {
            change(answer);
        }
    }

    fn last(&self) -> usize {
        self.rows.borrow().len().saturating_sub(1)
    }

    /// Prints the question, if it is not printed yet, and those of the first `done` rows that are not. Merged
    /// shards may turn out not to belong to these rows only at the end.
    fn print_first(&self, done: usize) -> Result<()> {
        if self.printed.get().is_none() {
            print::heading(self.question, &self.options)?;
        }
        let printed = self.printed.get().unwrap_or(0);
        if self.options.voice == Voice::Full {
            for answer in self.rows.borrow().iter().take(done).skip(printed) {
                print::row(answer, &self.options)?;
            }
        }
        self.printed.set(Some(done.max(printed)));
        Ok(())
    }

    /// Prints all rows but the last, which is still being worked on. Not for merged shards.
    fn print_all_but_the_last(&self) -> Result<()> {
        if self.options.shards.is_some() { Ok(()) } else { self.print_first(self.last()) }
    }
}

impl From<Figure> for Vec<Figure> {
    fn from(figure: Figure) -> Self {
        vec![figure]
    }
}

/// A row of a [`Sheet`], to which numbers and remarks are added.
pub struct Row<'s> {
    sheet: &'s Sheet,
    index: usize,
    draws: u64,
}

impl Row<'_> {
    fn set(self, change: impl FnOnce(&mut Answer)) -> Self {
        self.sheet.change(self.index, change);
        self
    }

    /// The part of the question that it belongs to: "(ii)".
    pub fn part(self, part: &str) -> Self {
        self.set(|answer| answer.question += part)
    }

    /// A parameter that differs from the question's, or is an additional one.
    pub fn parameter(self, name: &str, value: impl Into<Value>) -> Self {
        self.set(|answer| answer.set_parameter(name, value.into()))
    }

    /// The exact value; `None` if none is known.
    pub fn truth(self, truth: impl Into<Option<f64>>) -> Self {
        self.set(|answer| answer.truth = truth.into())
    }

    /// A value without an error bar, computed numerically.
    pub fn value(self, value: f64) -> Self {
        self.set(|answer| answer.value = Some(value))
    }

    /// A sentence: the answer itself if it is no number, or a remark on the number. A second one is appended.
    pub fn note(self, note: impl AsRef<str>) -> Self {
        self.set(|answer| answer.add_note(note.as_ref()))
    }

    /// Marks it as a classic mistake, described in a few words, that need not agree with the truth.
    pub fn wrong_on_purpose(self, why: &str) -> Self {
        self.set(|answer| answer.unjudged = Some(Unjudged::WrongOnPurpose(why.into())))
    }

    /// If there is a reason to doubt its error bar that the estimator itself does not know, the row is not
    /// judged.
    pub fn doubt(self, doubt: Option<Doubt>) -> Self {
        self.set(|answer| answer.unjudged = doubt.map(Unjudged::Doubted).or(answer.unjudged.take()))
    }

    /// The number of draws, if it should not be a million when the command line names none.
    pub fn draws(self, draws: u64) -> Self {
        Self { draws, ..self }
    }

    /// The approximate number of random numbers per draw. If these are too many, the row is left out, and
    /// says so.
    pub fn takes(self, numbers: f64) -> Self {
        if numbers <= MOST_WORK_A_DRAW {
            return self;
        }
        let note = format!("Left out: a draw takes about {} random numbers.", rounded(numbers, 2));
        self.note(note).set(|answer| answer.unjudged = Some(Unjudged::LeftOut))
    }

    /// Runs an estimator for it: for the draws, the time or the error on the command line.
    ///
    /// # Errors
    /// Those of [`Run::estimate`](crate::Run::estimate).
    pub fn estimate(self, estimator: &(impl Estimator + ?Sized)) -> Result<Self> {
        let Options { edition, budget, one_figure, shards, .. } = &self.sheet.options;
        let left_out = |row: &Answer| row.unjudged == Some(Unjudged::LeftOut);
        if *edition == Edition::Student || self.sheet.rows.borrow().get(self.index).is_some_and(left_out) {
            return Ok(self);
        }
        self.sheet.print_all_but_the_last()?;
        if let Some(shards) = shards {
            let outcome = self.sheet.rows.borrow().get(self.index).map(|row| shards.next(row)).transpose()?;
            return Ok(self.doubt(estimator.doubt()).set(|answer| answer.outcome = outcome));
        }
        let (draws, cut) = match budget {
            None => within_reason(estimator, self.draws),
            Some(_) => (self.draws, None),
        };
        // so that the worksheets of a class take a minute
        let draws = if *one_figure { (draws / 8).max(2) } else { draws };
        let outcome = self.sheet.options.run(estimator, draws)?;
        Ok(self.doubt(estimator.doubt()).set(|answer| {
            answer.outcome = Some(outcome);
            if let Some(cut) = cut {
                answer.add_note(&cut);
            }
        }))
    }
}

/// The number of draws, at most `draws`, that takes no more than [`MOST_WORK`], from the cost of a few trial
/// draws; and a remark if it is smaller. It depends on no clock, so the same command gives the same draws.
fn within_reason(estimator: &(impl Estimator + ?Sized), draws: u64) -> (u64, Option<String>) {
    let mut rng = Stream::new(mix(0x7768_6174_206f_6e65), 0);
    let mut tried = 0;
    let work = |rng: &Stream| rng.random_numbers().max(rng.evaluations()) as f64;
    while tried < 64 && work(&rng) < MOST_WORK_A_DRAW {
        estimator.draw(&mut rng);
        tried += 1;
    }
    let each = work(&rng) / f64::from(tried);
    if each * draws as f64 <= MOST_WORK {
        return (draws, None);
    }
    let fewer = ((MOST_WORK / each) as u64).clamp(2, draws);
    // a round number
    let fewer = rounded(fewer as f64, 1).parse::<f64>().map_or(fewer, |round| round as u64).max(2);
    let each = rounded(each, 2);
    let cut = format!(
        "Cut short: a draw takes about {each} random numbers or evaluations. --draws {draws} takes all of \
         them."
    );
    (fewer, Some(cut))
}
