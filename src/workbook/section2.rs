//! The questions of section 2.

use super::Question;

pub(super) const QUESTIONS: &[Question] = &[];
