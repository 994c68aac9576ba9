//! Figures as SVG, with their numbers as CSV.
//!
//! Every figure has a title and a description for readers who cannot see it, is 85, 150 or 170 mm wide (a
//! slide is 13.33 inches), can be read in grey, and has the same bytes on every run. If a question asks the
//! student to mark or draw something there are two editions: [`Edition::Student`] has the same canvas and
//! axes without the answer.

mod axis;
mod document;
mod figure;
mod labels;
mod layout;
mod panel;
mod render;
mod slide;

pub use figure::Figure;

pub(crate) use axis::{Axis, extent};
pub(crate) use figure::write_whole;
pub(crate) use labels::Labels;
pub(crate) use layout::Plot;
pub(crate) use panel::{Ink, Marker, Panel, Side};

/// For whom a figure or page is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edition {
    /// For students to fill in: the same canvas without the answer.
    Student,
    /// With the answer.
    Solution,
}
