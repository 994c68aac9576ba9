//! Variants, which give each student numbers of their own: a name, which is any text, determines the
//! parameters of every question, the same on every machine.
//!
//! A variant is fair: its numbers are short; none hides a mistake (λ = 1, p_rr = ½, a square, L_i = 1); every
//! wrong answer differs by at least 5 % from the right one, and every classic wrong answer by at least 5 %
//! from every other one.

use super::{Number, Question, Values};
use crate::error::{Error, Result};
use crate::stream::mix;

/// The most tries to find a fair variant; a few are enough.
const TRIES: u64 = 10_000;

/// The smallest relative difference of two answers.
const APART: f64 = 0.05;

impl Values {
    /// The values of a variant for these questions; those that are already set take precedence.
    ///
    /// ```
    /// use unbiased::question::Values;
    /// use unbiased::workbook::{question, questions};
    ///
    /// let ada = Values::default().variant("Ada", questions())?;
    /// let question = question("5.2")?;
    /// assert_ne!(question.at(&ada)?.statement, question.at(&Values::default())?.statement);
    /// assert_eq!(question.at(&ada)?, question.at(&Values::default().variant("Ada", questions())?)?);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the name is empty, or one of the questions has no fair variant for it.
    pub fn variant(
        mut self,
        name: &str,
        questions: impl IntoIterator<Item = &'static Question>,
    ) -> Result<Self> {
        let name = name.trim();
        if name.is_empty() {
            return Err(Error::Usage("a variant needs a name: any text or number".into()));
        }
        for question in questions {
            self.put_below(fair(question, name)?);
        }
        Ok(self)
    }
}

/// The first fair choice of a question's parameters for this name.
fn fair(question: &'static Question, name: &str) -> Result<Values> {
    let letters = question.id.bytes().chain([0]).chain(name.bytes());
    let seed = letters.fold(0, |seed, byte| mix(seed ^ u64::from(byte)));
    for attempt in 0..TRIES {
        let mut chosen = Values::default();
        let mut word = mix(seed ^ mix(attempt));
        for parameter in question.parameters.iter().filter(|of| !of.variants.is_empty()) {
            word = mix(word);
            // the remainder's bias is below 20/2⁶⁴, which is negligible
            let place = (word % parameter.variants.len() as u64) as usize;
            let value = parameter.variants.get(place).copied().unwrap_or(f64::NAN);
            chosen.set(question, parameter.name, &value.to_string())?;
        }
        if is_fair(question, &chosen) {
            return Ok(chosen);
        }
    }
    Err(Error::Usage(format!("question {} has no fair variant for \"{name}\"", question.id)))
}

/// Whether no wrong answer can be taken for the right one, nor one classic wrong answer for another, and all
/// texts can be written.
fn is_fair(question: &'static Question, values: &Values) -> bool {
    question.at(values).is_ok() && question.numbers.iter().all(|number| tells_apart(question, number, values))
}

fn tells_apart(question: &'static Question, number: &Number, values: &Values) -> bool {
    let at = |formula: &str| question.evaluate(formula, values).unwrap_or_default();
    let truths = at(number.formula);
    // a right answer of 0 differs from every other number
    let differ = |a: f64, b: f64| (a - b).abs() >= APART * a.abs().max(b.abs()) && a != b;
    let wrong: Vec<_> = number.slips.iter().map(|slip| (slip, at(slip.answer))).collect();
    let right_is_alone = wrong
        .iter()
        .all(|(_, values)| values.iter().all(|value| truths.iter().all(|truth| differ(*value, *truth))));
    let classic = || wrong.iter().filter(|(slip, _)| slip.classic).enumerate();
    right_is_alone
        && classic().all(|(index, (_, values))| {
            let others = classic().skip(index + 1).flat_map(|(_, (_, others))| others);
            others.into_iter().all(|other| values.iter().all(|value| differ(*value, *other)))
        })
}
