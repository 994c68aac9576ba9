//! Tables of text: in aligned columns, as CSV and as JSON.

use crate::error::{Error, Result};

/// A table; all cells are text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// What it shows, in one line.
    pub caption: String,
    /// The columns' names; the first column says what a row is about.
    pub columns: Vec<String>,
    /// One cell per column in each row.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table from its caption, its columns' names, and its rows.
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

    /// One JSON object per row, keyed by the columns' names.
    pub(crate) fn json(&self) -> String {
        let object = |row: &Vec<String>| {
            let cells = self.columns.iter().cloned().zip(row.iter().map(|cell| cell.clone().into()));
            serde_json::Value::Object(cells.collect()).to_string()
        };
        self.rows.iter().map(object).collect::<Vec<_>>().join("\n")
    }

    /// As CSV, the columns' names first.
    pub(crate) fn csv(&self) -> Result<String> {
        let failed = |reason: String| Error::Write { path: "a table as CSV".into(), reason };
        let mut csv = csv::Writer::from_writer(Vec::new());
        for row in std::iter::once(&self.columns).chain(&self.rows) {
            csv.write_record(row).map_err(|error| failed(error.to_string()))?;
        }
        let bytes = csv.into_inner().map_err(|error| failed(error.to_string()))?;
        String::from_utf8(bytes).map_err(|error| failed(error.to_string()))
    }

    /// Each column's width in characters.
    fn widths(&self) -> Vec<usize> {
        let cells = |column: usize| {
            let rows = std::iter::once(&self.columns).chain(&self.rows);
            rows.filter_map(move |row| row.get(column)).map(|cell| cell.chars().count())
        };
        (0..self.columns.len()).map(|column| cells(column).max().unwrap_or(0)).collect()
    }

    /// The width of its lines in characters.
    pub(crate) fn width(&self) -> usize {
        self.widths().iter().map(|width| width + 2).sum()
    }

    /// The table in lines of plain text, columns aligned.
    pub(crate) fn lines(&self) -> Vec<String> {
        let widths = self.widths();
        std::iter::once(&self.columns)
            .chain(&self.rows)
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
