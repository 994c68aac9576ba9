//! The questions of section 5.

use super::Question;

pub(super) const QUESTIONS: &[Question] = &[];
