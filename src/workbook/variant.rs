//! Variants, which give each student numbers of their own: a name, which is any text, determines the
//! parameters of every question, the same on every machine.
//!
//! A variant is fair: its numbers are short; none hides a mistake (λ = 1, p_rr = ½, a square, L_i = 1); every
//! wrong answer differs by at least 5 % from the right one, and every classic wrong answer by at least 5 %
//! from every other one.

use super::{Number, Options, Question};
use crate::error::{Error, Result};
use crate::numbers::typeset;
use crate::stream::mix;

/// The most tries to find a fair variant; a few are enough.
const TRIES: u64 = 10_000;

/// The smallest relative difference of two answers.
const APART: f64 = 0.05;

impl Options {
    /// The parameters of a variant for these questions; options that are already set take precedence.
    ///
    /// ```
    /// use unbiased::workbook::{Options, question, questions};
    ///
    /// let ada = Options::default().variant("Ada", questions())?;
    /// let question = question("5.2")?;
    /// assert_ne!(question.at(&ada)?.statement, question.at(&Options::default())?.statement);
    /// assert_eq!(question.at(&ada)?, question.at(&Options::default().variant("Ada", questions())?)?);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the name is empty.
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
fn fair(question: &'static Question, name: &str) -> Result<Options> {
    let letters = question.id.bytes().chain([0]).chain(name.bytes());
    let seed = letters.fold(0, |seed, byte| mix(seed ^ u64::from(byte)));
    for attempt in 0..TRIES {
        let mut options = Options::default();
        let mut word = mix(seed ^ mix(attempt));
        for parameter in question.parameters.iter().filter(|of| !of.variants.is_empty()) {
            word = mix(word);
            // the remainder's bias is below 20/2⁶⁴, which is negligible
            let place = (word % parameter.variants.len() as u64) as usize;
            let value = parameter.variants.get(place).copied().unwrap_or(f64::NAN);
            options.set(question, parameter.name, &value.to_string())?;
        }
        if is_fair(question, &options) {
            return Ok(options);
        }
    }
    Err(Error::Usage(format!("question {} has no fair variant for \"{name}\"", question.id)))
}

/// Whether no answer to the question can be taken for another, and all of its texts can be written.
fn is_fair(question: &'static Question, options: &Options) -> bool {
    question.at(options).is_ok()
        && question.numbers.iter().all(|number| tells_apart(question, number, options))
}

fn tells_apart(question: &'static Question, number: &Number, options: &Options) -> bool {
    let values = |formula: &str| question.evaluate(formula, options).unwrap_or_default();
    let truths = values(number.formula);
    // a right answer of 0 differs from every other number
    let differ = |a: f64, b: f64| (a - b).abs() >= APART * a.abs().max(b.abs()) && a != b;
    let wrong: Vec<_> = number.slips.iter().map(|slip| (slip, values(slip.answer))).collect();
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

/// The names of variants, one per line; blank lines are skipped.
///
/// # Errors
/// If the text is not UTF-8, there is no name, or two names would give the same folder.
pub(super) fn names(bytes: &[u8], file: &str) -> Result<Vec<String>> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text =
        std::str::from_utf8(bytes).map_err(|_| Error::Usage(format!("{file} is not text in UTF-8")))?;
    let names: Vec<String> =
        text.lines().map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned).collect();
    if names.is_empty() {
        return Err(Error::Usage(format!("{file} holds no names, one a line")));
    }
    let mut folders = std::collections::BTreeMap::new();
    for name in &names {
        if let Some(other) = folders.insert(folder(name).to_lowercase(), name) {
            return Err(Error::Usage(format!(
                "{file}: “{other}” and “{name}” would share a folder; change one of them"
            )));
        }
    }
    Ok(names)
}

/// A name as a folder name that is valid on any system.
pub(super) fn folder(name: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || "-_+ ".contains(c) { c } else { '_' };
    let folder: String = name.trim().chars().map(plain).take(100).collect();
    folder.trim().replace(' ', "_")
}

/// The numbers that a question asks for in a variant, as rows of a key: the name, the question, what is asked
/// for, the formula and the truth.
pub(super) fn key(name: &str, question: &'static Question, options: &Options) -> Result<Vec<Vec<String>>> {
    let row = |number: &Number| {
        let truths = question.evaluate(number.formula, options)?;
        let truth = typeset(truths.first().copied().unwrap_or(f64::NAN), 7);
        let id = format!("{}{}", question.id, number.part);
        Ok(vec![name.into(), id, number.asked(), number.formula.into(), truth])
    };
    question.numbers.iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_and_told_apart() {
        let read = |bytes: &[u8]| names(bytes, "f").map_err(|error| error.to_string());
        assert_eq!(read("\u{feff}Ada\r\n\n  Bo Li \n".as_bytes()), Ok(vec!["Ada".into(), "Bo Li".into()]));
        assert_eq!(read(b"\n \n"), Err("f holds no names, one a line".into()));
        assert_eq!(read(b"\xff"), Err("f is not text in UTF-8".into()));
        let twice = "f: “A/B” and “a_b” would share a folder; change one of them";
        assert_eq!(read(b"A/B\na_b\n"), Err(twice.into()));
        assert_eq!(folder("../é x"), "___é_x");
    }
}
