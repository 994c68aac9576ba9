//! An example's rows, merged from those of its shards.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::path::PathBuf;

use serde::Deserialize;

use super::Answer;
use super::answer::parameters_of;
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
    parameters: serde_json::Map<String, serde_json::Value>,
}

/// The merged runs of all rows, in the order in which the example makes them.
#[derive(Debug)]
pub(super) struct Shards {
    names: Vec<Name>,
    outcomes: RefCell<VecDeque<Outcome>>,
}

impl Shards {
    /// Reads the files with what each shard has printed.
    pub fn read(paths: &[PathBuf]) -> Result<Self> {
        let mut files = Vec::new();
        for path in paths {
            let refused = |reason| Error::Parts { reason: format!("{}: {reason}", path.display()) };
            let text = std::fs::read_to_string(path).map_err(|error| refused(error.to_string()))?;
            let lines = text.lines().filter(|line| !line.trim().is_empty());
            let rows: Vec<Row> = lines
                .map(serde_json::from_str)
                .collect::<Result<_, _>>()
                .map_err(|error| refused(format!("this is not what --shard K/N --json prints ({error})")))?;
            files.push(rows);
        }
        let rows = files.first().map_or(0, Vec::len);
        let (mut names, mut outcomes) = (Vec::new(), VecDeque::new());
        for row in 0..rows {
            let mut name: Option<Name> = None;
            let mut parts = Vec::new();
            for (path, file) in paths.iter().zip(&files) {
                let refused = |reason: &str| {
                    Err(Error::Parts { reason: format!("{} has {reason} the others", path.display()) })
                };
                let Some(row) = file.get(row).filter(|_| file.len() == rows) else {
                    return refused("more or fewer rows than");
                };
                if *name.get_or_insert_with(|| row.name.clone()) != row.name {
                    return refused("rows of other estimators or parameters than");
                }
                parts.push(row.part.clone());
            }
            names.extend(name);
            outcomes.push_back(merge(&parts)?);
        }
        Ok(Self { names, outcomes: RefCell::new(outcomes) })
    }

    /// The next run that the example asks for.
    pub fn next(&self) -> Result<Outcome> {
        let next = self.outcomes.borrow_mut().pop_front();
        next.ok_or_else(|| Error::Parts { reason: "they have fewer rows than this example".into() })
    }

    /// Checks that the shards belong to these answers: same order, same parameters.
    pub fn belong_to(&self, answers: &[Answer]) -> Result<()> {
        let mut names = self.names.iter().peekable();
        for answer in answers {
            let name = Name {
                question: answer.question().into(),
                what: answer.what().into(),
                parameters: parameters_of(answer),
            };
            names.next_if_eq(&&name);
        }
        match names.next() {
            None => Ok(()),
            Some(Name { what, .. }) => Err(Error::Parts {
                reason: format!(
                    "\"{what}\" is of another example or other options: give those of the shards"
                ),
            }),
        }
    }
}
