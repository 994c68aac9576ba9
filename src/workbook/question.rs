//! A question, and its texts with the values of its parameters.

use super::{Number, Options, Value, grammar};
use crate::error::{Error, Result};
use crate::numbers::typeset;

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

/// A letter that stands for a number.
#[derive(Debug, Clone, Copy)]
pub struct Letter {
    /// Its spellings, the worksheet's first.
    pub names: &'static [&'static str],
    /// Its value at the question's parameters; an error if these are outside their domain.
    pub value: fn(&Options) -> Result<f64>,
    /// A generic value, at which different formulas give different results.
    pub generic: f64,
}

/// A question's texts, with the values of its parameters in them; see [`Question`].
#[derive(Debug, Clone, PartialEq)]
pub struct Stated {
    /// A few words that do not give the answer away.
    pub title: String,
    /// What is asked.
    pub statement: String,
    /// A hint that does not give the answer away.
    pub hint: String,
    /// The closed form in one line of plain text.
    pub formula: String,
    /// The same in LaTeX, one displayed formula each.
    pub latex: Vec<String>,
    /// The explanation, one paragraph.
    pub answer: String,
    /// Classic wrong answers, each with its slip.
    pub wrong: Vec<(String, String)>,
    /// A correction to the sheet as it was handed out.
    pub on_the_original: Option<String>,
}

impl Question {
    /// Its texts at its parameters, as given in the options, else the sheet's.
    ///
    /// ```
    /// use unbiased::workbook::{Options, question};
    ///
    /// let question = question("5.2")?;
    /// let mut options = Options::default();
    /// options.set(question, "p-rr", "0.6")?;
    /// assert_eq!(question.at(&options)?.formula, "E[N] = p_rr/(1 − p_rr) = 1.5");
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    ///
    /// # Errors
    /// If a parameter is outside its domain; the message names the question.
    pub fn at(&'static self, options: &Options) -> Result<Stated> {
        let options = options.for_question(self);
        let named = |error| match error {
            Error::Usage(reason) => Error::Usage(reason),
            other => Error::Usage(format!("question {}: {other}", self.id)),
        };
        let letters = self.values(&options).map_err(named)?;
        let fill = |text: &str| self.filled(text, &letters);
        let wrong = self.classic_wrong_answers(&options).map_err(named)?;
        let wrong = wrong.into_iter().map(|(answer, slip)| Ok((fill(&answer)?, fill(slip)?)));
        Ok(Stated {
            title: fill(self.title)?,
            statement: fill(self.statement)?,
            hint: fill(self.hint)?,
            formula: fill(self.formula)?,
            latex: self.latex.iter().map(|latex| fill(latex)).collect::<Result<_>>()?,
            answer: fill(self.answer)?,
            wrong: wrong.collect::<Result<_>>()?,
            on_the_original: self.on_the_original.map(fill).transpose()?,
        })
    }

    /// The letters of its formulas.
    pub(super) fn letters(&self) -> impl Iterator<Item = &'static Letter> + use<> {
        let own = self.parameters.iter().filter_map(|parameter| parameter.letter.as_ref());
        own.chain(self.derived)
    }

    /// The values of these letters at the question's parameters.
    pub(super) fn values(&self, options: &Options) -> Result<Vec<f64>> {
        self.letters().map(|letter| (letter.value)(options)).collect()
    }

    /// The value of a formula in its letters.
    pub(super) fn value(&self, formula: &str, letters: &[f64]) -> Result<f64> {
        let spellings: Vec<_> = self.letters().map(|letter| letter.names).collect();
        let value = grammar::read(formula, &spellings, &[]);
        let value = value.and_then(|tokens| grammar::evaluate(&tokens, letters)).map(|known| known.value);
        value.ok_or_else(|| Error::Usage(format!("the formula \"{formula}\" is not understood")))
    }

    fn filled(&self, text: &str, letters: &[f64]) -> Result<String> {
        let mut filled = String::new();
        let mut rest = text;
        while let Some((before, formula, after)) = rest
            .split_once('«')
            .and_then(|(before, rest)| rest.split_once('»').map(|(formula, after)| (before, formula, after)))
        {
            filled += before;
            filled += &typeset(self.value(formula, letters)?, 7);
            rest = after;
        }
        Ok(filled + rest)
    }
}
