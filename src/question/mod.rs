//! What a question of a worksheet is: its texts, its parameters, and the numbers that it asks for.
//!
//! Every answer, right or wrong, is stored as the formula that people read. Its value is computed from that
//! formula, at the question's parameters.

pub(crate) mod grammar;
mod stated;
mod value;
mod values;
mod variant;

pub use stated::Stated;
pub(crate) use stated::{SAME, same};
pub use value::Value;
pub use values::Values;
pub(crate) use values::{Given, parameter};

use crate::error::Result;

/// One question of the worksheet, with all that is fixed before anything is run.
///
/// Texts are plain, and `latex` is LaTeX for the page. A part between « and » is a formula in the question's
/// letters, written as answers are; [`at`](Self::at) replaces it by its value at the parameters.
#[derive(Debug, Clone, Copy)]
pub struct Question {
    /// Its number on the worksheet: "5.1".
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
    /// Ruled lines for an answer on paper; 0 if it is drawn into the figure, which is then as large as fits.
    pub lines: usize,
    /// Its parameters.
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

/// A parameter of one question, on the command line `--name value`.
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

/// A letter that stands for a number.
#[derive(Debug, Clone, Copy)]
pub struct Letter {
    /// Its spellings, the worksheet's first.
    pub names: &'static [&'static str],
    /// Its value at the question's parameters; an error if these are outside their domain.
    pub value: fn(&Values) -> Result<f64>,
    /// A generic value, at which different formulas give different results.
    pub generic: f64,
}

/// A number that a question asks for.
#[derive(Debug, Clone, Copy)]
pub struct Number {
    /// The part of the question that asks for it, "(ii)"; empty if the question asks for one number only.
    pub part: &'static str,
    /// Its symbol.
    pub symbol: &'static str,
    /// A description in words.
    pub what: &'static str,
    /// The right answer for all parameters: a formula in the letters, or several with " or " between them.
    pub formula: &'static str,
    /// If it is the factor c of an estimator c/n Σ …, that estimator; then c/n is accepted, too.
    pub over_n: Option<&'static str>,
    /// The wrong answers.
    pub slips: &'static [Slip],
}

/// A wrong answer that is a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Slip {
    /// Its name for programs, unique among the wrong answers to the question.
    pub id: &'static str,
    /// The wrong answer for all parameters: a formula, or several with " or " between them.
    pub answer: &'static str,
    /// The slip that leads to it.
    pub words: &'static str,
    /// Whether it is also listed with the solution.
    pub classic: bool,
}

/// A wrong answer that is only used to judge answers.
pub(crate) const fn slip(id: &'static str, answer: &'static str, words: &'static str) -> Slip {
    Slip { id, answer, words, classic: false }
}

/// A wrong answer that is also listed with the solution.
pub(crate) const fn classic(id: &'static str, answer: &'static str, words: &'static str) -> Slip {
    Slip { id, answer, words, classic: true }
}

impl Number {
    /// A description of what is asked for: "the factor c in c/n Σ L_i".
    pub(crate) fn asked(&self) -> String {
        self.over_n.map_or(self.what.into(), |sum| format!("{} in {sum}", self.what))
    }
}
