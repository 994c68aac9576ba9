//! An example's rows, merged from those of its shards.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::{Map, Value};

use super::Answer;
use crate::error::{Error, Result};
use crate::run::{Outcome, Part, merge};

/// A row that `--shard K/N --json` prints, as far as it is needed here.
#[derive(Deserialize)]
struct Row {
    #[serde(flatten)]
    name: Name,
    part: Part,
}

/// What a row is about.
#[derive(Debug, Clone, PartialEq, Deserialize)]
struct Name {
    question: String,
    what: String,
    parameters: Map<String, Value>,
}

/// The merged runs of all rows, in the order in which the example makes them.
#[derive(Debug)]
pub(super) struct Shards(RefCell<VecDeque<(Name, Outcome)>>);

impl Shards {
    /// Reads the files with what each shard has printed.
    pub fn read(paths: &[PathBuf]) -> Result<Self> {
        let files = paths.iter().map(|path| rows_of(path)).collect::<Result<Vec<_>>>()?;
        let names = |file: &[Row]| file.iter().map(|row| row.name.clone()).collect::<Vec<_>>();
        let first = files.first().map_or(Vec::new(), |file| names(file));
        for (path, file) in paths.iter().zip(&files) {
            let reason = if file.len() != first.len() {
                "more or fewer rows than"
            } else if names(file) != first {
                "rows of other estimators or parameters than"
            } else {
                continue;
            };
            return Err(Error::Parts { reason: format!("{} has {reason} the others", path.display()) });
        }
        let merged = first.into_iter().enumerate().map(|(index, name)| {
            let parts = files.iter().filter_map(|file| file.get(index));
            Ok((name, merge(&parts.map(|row| row.part.clone()).collect::<Vec<_>>())?))
        });
        merged.collect::<Result<_>>().map(|rows| Self(RefCell::new(rows)))
    }

    /// The next run that the example asks for, which must be for this row.
    pub fn next(&self, answer: &Answer) -> Result<Outcome> {
        let next = self.0.borrow_mut().pop_front();
        let (name, outcome) =
            next.ok_or_else(|| Error::Parts { reason: "they have fewer rows than this example".into() })?;
        let here = Name {
            question: answer.question.clone(),
            what: answer.what.clone(),
            parameters: answer.parameters_json(),
        };
        if name == here { Ok(outcome) } else { Err(of_another(&name)) }
    }

    /// Checks that the example has asked for all.
    pub fn are_used_up(&self) -> Result<()> {
        self.0.borrow().front().map_or(Ok(()), |(name, _)| Err(of_another(name)))
    }
}

fn rows_of(path: &Path) -> Result<Vec<Row>> {
    let refused = |reason| Error::Parts { reason: format!("{}: {reason}", path.display()) };
    let text = std::fs::read_to_string(path).map_err(|error| refused(error.to_string()))?;
    let rows = text.lines().filter(|line| !line.trim().is_empty()).map(serde_json::from_str);
    rows.collect::<Result<_, _>>()
        .map_err(|error| refused(format!("this is not what --shard K/N --json prints ({error})")))
}

fn of_another(name: &Name) -> Error {
    let what = &name.what;
    Error::Parts {
        reason: format!("\"{what}\" is of another example or other options: give those of the shards"),
    }
}
