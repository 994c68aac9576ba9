//! A question's texts with the values of its parameters, and its classic wrong answers.

use super::{Letter, Number, Question, Values, grammar};
use crate::error::{Error, Result};
use crate::numbers::{rounded, shortened, typeset};

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
    /// Its texts, with the given values of its parameters, or else their defaults.
    ///
    /// ```
    /// use unbiased::question::Values;
    /// use unbiased::workbook::question;
    ///
    /// let question = question("5.2")?;
    /// let mut values = Values::default();
    /// values.set(question, "p-rr", "0.6")?;
    /// assert_eq!(question.at(&values)?.formula, "E[N] = p_rr/(1 − p_rr) = 1.5");
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    ///
    /// # Errors
    /// If a parameter is outside its domain; the message names the question.
    pub fn at(&'static self, values: &Values) -> Result<Stated> {
        let values = values.for_question(self);
        let named = |error| match error {
            Error::Usage(reason) => Error::Usage(reason),
            other => Error::Usage(format!("question {}: {other}", self.id)),
        };
        let letters = self.letter_values(&values).map_err(named)?;
        let fill = |text: &str| self.filled(text, &letters);
        let wrong = self.classic_wrong_answers(&values).map_err(named)?;
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
    pub(crate) fn letters(&self) -> impl Iterator<Item = &'static Letter> + use<> {
        let own = self.parameters.iter().filter_map(|parameter| parameter.letter.as_ref());
        own.chain(self.derived)
    }

    /// The values of these letters at the question's parameters.
    pub(crate) fn letter_values(&self, values: &Values) -> Result<Vec<f64>> {
        self.letters().map(|letter| (letter.value)(values)).collect()
    }

    /// The value of a formula in its letters.
    pub(crate) fn value(&self, formula: &str, letters: &[f64]) -> Result<f64> {
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

impl Question {
    /// The values of a formula in its letters, or of several with " or " between them, at these
    /// parameters.
    ///
    /// # Errors
    /// If a parameter is outside its domain, or the formula cannot be read.
    pub fn evaluate(&'static self, formula: &str, values: &Values) -> Result<Vec<f64>> {
        let values = values.for_question(self);
        self.with_letters(formula, &self.letter_values(&values)?)
    }

    pub(crate) fn with_letters(&self, formula: &str, letters: &[f64]) -> Result<Vec<f64>> {
        formula.split(" or ").map(|formula| self.value(formula, letters)).collect()
    }
}

impl Question {
    /// Its classic wrong answers, each with its slip. Those that are numbers have their values at the
    /// question's parameters, and are left out if they are right there.
    pub(crate) fn classic_wrong_answers(
        &'static self,
        values: &Values,
    ) -> Result<Vec<(String, &'static str)>> {
        let mut all = Vec::new();
        for number in self.numbers {
            let truths = self.evaluate(number.formula, values)?;
            for slip in number.slips.iter().filter(|slip| slip.classic) {
                let mut values = self.evaluate(slip.answer, values)?;
                if !values.iter().any(|value| truths.iter().any(|truth| same(*value, *truth))) {
                    values.dedup_by(|a, b| same(*a, *b));
                    all.push((number.equation(slip.answer, &values), slip.words));
                }
            }
        }
        all.extend(self.wrong.iter().map(|wrong| (wrong.answer.into(), wrong.slip)));
        Ok(all)
    }
}

impl Number {
    /// `E[N] = 1/(1 − p_rr) = 5`
    fn equation(&self, formula: &str, values: &[f64]) -> String {
        let values = values
            .iter()
            .filter(|value| value.is_finite())
            .map(|value| shortened(rounded(*value, 4).parse().unwrap_or(*value)).replace('-', "−"));
        let values = values.collect::<Vec<_>>().join(" or ");
        let value =
            if values.is_empty() || values == formula { String::new() } else { format!(" = {values}") };
        let place = self.over_n.map_or(String::new(), |sum| format!(" in {sum}"));
        format!("{} = {formula}{value}{place}", self.symbol)
    }
}

/// Numbers closer than this, relatively, are equal up to rounding.
pub(crate) const SAME: f64 = 1e-9;

pub(crate) fn same(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= SAME * a.abs().max(b.abs())
}
