//! Appendices: text, tables and figures that answer no question of the sheet. Each has a page and an example
//! of its own.

use super::{Answer, Options, Table};
use crate::error::{Error, Result};
use crate::plot::Figure;

/// A part of the worksheet that answers none of the sheet's questions, with all that is fixed before it is
/// made. The student's edition leaves it out.
#[derive(Debug, Clone, Copy)]
pub struct Appendix {
    /// The file in `examples/`, without `.rs`.
    pub example: &'static str,
    /// The title, a few words.
    pub title: &'static str,
    /// The paragraph that describes it in `--help`.
    pub about: &'static str,
    /// What `--seconds` means to it, if it takes that option.
    pub seconds: Option<&'static str>,
    /// Why it does not take the other options of the questions' examples.
    pub why: &'static str,
    /// Makes it.
    pub make: fn(&Options) -> Result<Contents>,
}

impl Appendix {
    /// Refuses an option of the questions' examples that makes no sense for it.
    pub(super) fn check_option(&self, option: &str) -> Result<()> {
        let refused = match option {
            "draws" | "error" | "threads" | "edition" | "hint" => true,
            "seconds" => self.seconds.is_none(),
            _ => false,
        };
        let Self { example, why, .. } = self;
        if refused { Err(Error::Usage(format!("{example} takes no --{option}: {why}"))) } else { Ok(()) }
    }
}

/// What an appendix holds.
#[derive(Debug, Clone)]
pub struct Contents {
    /// An introduction, one paragraph.
    pub text: String,
    /// Its tables, in order.
    pub tables: Vec<Table>,
    /// The numbers for programs, which `--json` prints.
    pub records: Vec<Answer>,
    /// Its figures.
    pub figures: Vec<Figure>,
}
