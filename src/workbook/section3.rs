//! The questions of section 3.

use super::Question;

pub(super) const QUESTIONS: &[Question] = &[];
