//! What the workbook says beside the questions: a text, tables and figures, on the page and by an example of
//! its own.

use super::Answer;
use crate::error::{Error, Result};
use crate::plot::Figure;

/// What is known of an example beside the questions before it is run.
pub(super) struct Beside {
    /// The file in `examples/`, without `.rs`.
    pub example: &'static str,
    /// What it does, in a paragraph.
    pub about: &'static str,
    /// What `--seconds` is to it, if anything.
    pub seconds: Option<&'static str>,
    /// Why it takes no other options than it does.
    pub why: &'static str,
}

const ALL: [Beside; 2] = [
    Beside {
        example: "extremes",
        about: "Where the obvious code breaks: formulas as one writes them down, inputs at which they fail, \
                and what the crate gives there.",
        seconds: None,
        why: "it evaluates each formula once, and has no student edition and no hint",
    },
    Beside {
        example: "trade",
        about: "What does a second buy? The workbook's rival estimators, compared by variance and time on \
                one core of this machine.",
        seconds: Some("seconds for each estimator (0.03)"),
        why: "it compares estimators on one core, for --seconds S each, and has no student edition and no \
              hint",
    },
];

/// The example beside the questions of this name.
pub(super) fn beside(example: &str) -> Result<&'static Beside> {
    let known = ALL.iter().find(|beside| beside.example == example);
    known.ok_or_else(|| Error::Usage(format!("there is no example {example} beside the questions")))
}

impl Beside {
    /// Refuses an option of the questions' examples that it can do nothing with.
    pub fn take(&self, option: &str) -> Result<()> {
        let refused = match option {
            "draws" | "error" | "threads" | "edition" | "hint" => true,
            "seconds" => self.seconds.is_none(),
            _ => false,
        };
        let Self { example, why, .. } = self;
        if refused { Err(Error::Usage(format!("{example} takes no --{option}: {why}"))) } else { Ok(()) }
    }
}

/// A part of the worksheet that answers no question of the sheet's. The student's edition leaves it out.
#[derive(Debug, Clone)]
pub struct Appendix {
    /// The file in `examples/`, without `.rs`.
    pub example: &'static str,
    /// A few words.
    pub title: &'static str,
    /// What it is about, in a paragraph.
    pub text: String,
    /// Its tables, in order.
    pub tables: Vec<Table>,
    /// The numbers for programs: what `--json` gives.
    pub records: Vec<Answer>,
    /// Its figures.
    pub figures: Vec<Figure>,
}

/// A table; all cells are text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// What it shows, in a line.
    pub caption: String,
    /// The columns' names; the first one names what a row is about.
    pub columns: Vec<String>,
    /// As many cells a row as there are columns.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// One with a caption, names of columns, and rows.
    pub fn new<C: Into<String>>(
        caption: &str,
        columns: impl IntoIterator<Item = C>,
        rows: impl IntoIterator<Item = Vec<String>>,
    ) -> Self {
        Self {
            caption: caption.into(),
            columns: columns.into_iter().map(Into::into).collect(),
            rows: rows.into_iter().collect(),
        }
    }

    /// One JSON object a row, by the columns' names.
    pub(crate) fn json(&self) -> String {
        let object = |row: &Vec<String>| {
            let cells = self.columns.iter().cloned().zip(row.iter().map(|cell| cell.clone().into()));
            serde_json::Value::Object(cells.collect()).to_string()
        };
        self.rows.iter().map(object).collect::<Vec<_>>().join("\n")
    }

    /// The table in lines of plain text, columns aligned.
    pub(crate) fn lines(&self) -> Vec<String> {
        let all: Vec<&Vec<String>> = std::iter::once(&self.columns).chain(&self.rows).collect();
        let width = |column: usize| {
            all.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.columns.len()).map(width).collect();
        all.iter()
            .map(|row| {
                let padded = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}"));
                padded.collect::<Vec<_>>().join("  ").trim_end().to_owned()
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned() {
        let rows = vec![vec!["ln".into(), "1".into()], vec!["−exp_m1".into(), "22".into()]];
        let table = Table::new("", ["form", "ulps"], rows);
        assert_eq!(table.lines(), ["form     ulps", "ln       1", "−exp_m1  22"]);
    }
}
