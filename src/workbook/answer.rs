//! One number of an answer.

use std::time::Duration;

use crate::doubt::Doubt;
use crate::estimate::Estimate;
use crate::plot::{Edition, Figure};
use crate::question::Value;
use crate::run::{Cost, Outcome};
use crate::trade::Measured;

/// Why a row is shown, but not judged.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Unjudged {
    /// Wrong, or of infinite variance.
    Demonstration,
    /// A classic mistake, in a few words.
    WrongOnPurpose(String),
    /// The error bar cannot be trusted.
    Doubted(Doubt),
    /// Not run.
    LeftOut,
}

/// One number that answers (part of) a question, or a sentence where it has none.
///
/// A [`Sheet`](super::Sheet) makes its own; an [`Appendix`](super::Appendix) lists some for `--json`.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// The question's number, and its part: "5.1(ii)".
    pub(super) question: String,
    pub(super) what: String,
    pub(super) unjudged: Option<Unjudged>,
    pub(super) parameters: Vec<(String, Value)>,
    pub(super) truth: Option<f64>,
    /// Computed numerically, without an error bar.
    pub(super) value: Option<f64>,
    pub(super) outcome: Option<Outcome>,
    pub(super) note: Option<String>,
    pub(super) figures: Vec<Figure>,
}

/// With fewer draws a mean may be far from normal, and z is meaningless.
const FEWEST: u64 = 1000;

/// The same if all draws are equal, but differ from the truth.
const FEWEST_ALIKE: u64 = 100_000;

impl Answer {
    /// An answer to `question`, the sheet's number first ("2.1", "5.1(ii)"), about `what`, which must not
    /// give the answer away.
    pub fn new(question: &str, what: &str) -> Self {
        Self {
            question: question.into(),
            what: what.into(),
            unjudged: None,
            parameters: Vec::new(),
            truth: None,
            value: None,
            outcome: None,
            note: None,
            figures: Vec::new(),
        }
    }

    /// Marks it as wrong on purpose, or of infinite variance.
    pub fn demonstration(mut self) -> Self {
        self.unjudged = Some(Unjudged::Demonstration);
        self
    }

    /// A parameter that it was computed with; if the same name is given again, the last value counts.
    pub fn parameter(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.set_parameter(name, value.into());
        self
    }

    pub(super) fn set_parameter(&mut self, name: &str, value: Value) {
        match self.parameters.iter_mut().find(|(known, _)| known == name) {
            Some((_, known)) => *known = value,
            None => self.parameters.push((name.into(), value)),
        }
    }

    /// The exact value.
    pub fn truth(mut self, truth: f64) -> Self {
        self.truth = Some(truth);
        self
    }

    /// A value without an error bar, computed numerically.
    pub fn value(mut self, value: f64) -> Self {
        self.value = Some(value);
        self
    }

    /// The result of a comparison for one estimator, with what its rank is based on as parameters.
    pub fn measured(mut self, rival: &Measured, seed: u64) -> Self {
        let draws = rival.estimate.draws() as f64;
        let count = |each: f64| (each * draws).round() as u64;
        self.outcome = Some(Outcome {
            estimate: rival.estimate,
            seed,
            cost: Cost { random_numbers: count(rival.random_numbers), evaluations: count(rival.evaluations) },
            elapsed: Duration::try_from_secs_f64(rival.seconds * draws).unwrap_or_default(),
            pilot: None,
            shortfall: None,
            part: None,
        });
        self.truth(rival.truth)
            .parameter("variance", rival.variance())
            .parameter("variance_error", rival.variance_error)
            .parameter("seconds_per_draw", rival.seconds)
            .parameter("efficiency", rival.efficiency())
    }

    /// Adds a sentence: the answer itself if the question has no number, or a remark on the number.
    pub(super) fn add_note(&mut self, note: &str) {
        self.note = Some(self.note.as_ref().map_or(note.into(), |before| format!("{before} {note}")));
    }

    pub(super) fn estimate(&self) -> Option<&Estimate> {
        self.outcome.as_ref().map(|outcome| &outcome.estimate)
    }

    /// The value computed numerically, or the estimated mean.
    pub(super) fn found(&self) -> Option<f64> {
        self.value.or(self.estimate().map(Estimate::mean))
    }

    /// Whether there is a number to show.
    pub(super) fn is_a_number(&self) -> bool {
        self.found().is_some() || self.truth.is_some()
    }

    pub(super) fn seconds(&self) -> Option<f64> {
        self.outcome.as_ref().map(|outcome| outcome.elapsed.as_secs_f64())
    }

    /// Its parameters for programs.
    pub(super) fn parameters_json(&self) -> serde_json::Map<String, serde_json::Value> {
        self.parameters.iter().map(|(name, value)| (name.clone(), value.json())).collect()
    }

    /// The difference of estimate and truth in standard errors, if both are known.
    pub(super) fn z(&self) -> Option<f64> {
        self.estimate()?.z(self.truth?)
    }

    /// Whether it is right: whether a numerical value has nine digits of the truth, or an estimate |z| ≤ 4.
    /// `None` if something is missing, the row is not judged, or its error bar is in doubt.
    pub(super) fn right(&self) -> Option<bool> {
        if self.unjudged.is_some() || self.doubt().is_some() {
            return None;
        }
        match (self.value, self.truth) {
            (Some(value), Some(truth)) => Some((value - truth).abs() <= 1e-9 * truth.abs()),
            _ => Some(self.z()?.abs() <= 4.0),
        }
    }

    /// Why its error bar cannot be trusted, if so: for a given reason, or because there are too few draws, or
    /// all are equal.
    ///
    /// At least 1000 draws are needed, or 100 000 if all are equal but differ from the truth. A value of
    /// probability p per draw is missed by all n draws with probability at most 1e-12 if p ≥ 27.6/n, here
    /// 3e-4. If all draws are below a hundredth of the truth, or are 0 and no truth is known, no number of
    /// draws is enough: the whole mean may come from rarer values, as with a light too small to hit.
    pub(super) fn doubt(&self) -> Option<Doubt> {
        match &self.unjudged {
            Some(Unjudged::Doubted(doubt)) => return Some(doubt.clone()),
            Some(_) => return None,
            None => {}
        }
        let estimate = self.estimate()?;
        let Some(truth) = self.truth else {
            let dark = estimate.mean() == 0.0 && estimate.std_error() == Some(0.0);
            return dark.then_some(Doubt::NeverVaried);
        };
        let all_alike_and_off = self.z().is_some_and(f64::is_infinite);
        match estimate.draws() {
            draws if draws < FEWEST || all_alike_and_off && draws < FEWEST_ALIKE => Some(Doubt::TooFewDraws),
            _ if all_alike_and_off && estimate.mean().abs() < 0.01 * truth.abs() => Some(Doubt::NeverVaried),
            _ => None,
        }
    }

    /// ✓ or ✗, or words that say why it is neither.
    pub(super) fn verdict(&self) -> &'static str {
        match (&self.unjudged, self.doubt(), self.right()) {
            (_, Some(doubt), _) => doubt.mark(),
            (Some(Unjudged::WrongOnPurpose(_)), ..) => "wrong on purpose",
            (Some(Unjudged::LeftOut), ..) => "left out",
            (Some(_), ..) => "not judged",
            (None, _, Some(true)) => "✓",
            (None, _, Some(false)) => "✗",
            _ if self.found().is_some() && self.truth.is_none() => "no closed form",
            _ => "",
        }
    }

    /// A sentence of warning about its error bar, unless the verdict says it already.
    pub(super) fn caution(&self) -> Option<String> {
        match self.doubt()? {
            Doubt::TooFewDraws => None,
            doubt => Some(format!("Careful: {doubt}.")),
        }
    }

    /// Whether it may be shown in this edition: a demonstration names a mistake.
    pub(super) fn shown_in(&self, edition: Edition) -> bool {
        edition == Edition::Solution || self.unjudged.is_none()
    }

    /// The figures that belong to this edition.
    pub(super) fn figures(&self, edition: Edition) -> impl Iterator<Item = &Figure> {
        self.figures.iter().filter(move |figure| figure.edition() == edition)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Budget, Estimator, Run, from_fn};

    fn row(estimator: &dyn Estimator, draws: u64, truth: f64) -> Answer {
        let outcome = Run::new(1).threads(1).estimate(estimator, Budget::Draws(draws)).unwrap();
        Answer { outcome: Some(outcome), ..Answer::new("1.1", "").truth(truth) }
    }

    /// U's mean is 1/2. With 1000 draws 0.4 is eleven standard errors off; with fewer it is not judged.
    #[test]
    fn what_is_wrong_is_marked_once_there_are_draws_enough() {
        let uniform = from_fn(|rng| rng.uniform());
        for (draws, right, wrong) in
            [(1, None, None), (2, None, None), (999, None, None), (1000, Some(true), Some(false))]
        {
            assert_eq!(row(&uniform, draws, 0.5).right(), right, "{draws}");
            assert_eq!(row(&uniform, draws, 0.4).right(), wrong, "{draws}");
            let few = wrong.is_none().then_some(Doubt::TooFewDraws);
            assert_eq!(row(&uniform, draws, 0.4).doubt(), few);
        }
        assert_eq!(row(&uniform, 1000, 0.4).demonstration().right(), None);
        assert_eq!(row(&uniform, 2, 0.4).demonstration().doubt(), None);
    }

    #[test]
    fn draws_that_are_all_alike_are_judged_later_if_they_are_off() {
        let one = from_fn(|_| 1.0);
        for (draws, truth, right) in [
            (1000, 1.0, Some(true)),
            (99_999, 1.1, None),
            (100_000, 1.1, Some(false)),
            (999, 1.0, None),
            (100_000, 99.0, Some(false)),
            (100_000, 101.0, None),
        ] {
            assert_eq!(row(&one, draws, truth).right(), right, "{draws} {truth}");
        }
    }
}
