//! A class: the names of its variants, their folders, and the key of them all.

use crate::error::{Error, Result};
use crate::numbers::typeset;
use crate::question::{Number, Question, Values};

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
pub(super) fn key(name: &str, question: &'static Question, values: &Values) -> Result<Vec<Vec<String>>> {
    let row = |number: &Number| {
        let truths = question.evaluate(number.formula, values)?;
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
