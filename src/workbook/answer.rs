//! One number of an answer.

use std::borrow::Cow;

use serde::Serialize;

use super::Value;
use crate::doubt::Doubt;
use crate::estimate::Estimate;
use crate::plot::{Edition, Figure};
use crate::run::{Cost, Outcome, Part, Shortfall};
use crate::trade::Measured;

/// What a row of an answer is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Right, and checked against its truth.
    Answer,
    /// Wrong on purpose, or of infinite variance: shown, but not checked.
    Demonstration,
}

/// Why a row is not judged.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Words {
    /// A classic mistake, in a few words.
    WrongOnPurpose(String),
    /// The error bar cannot be trusted.
    Doubted(Doubt),
    /// Not run.
    LeftOut,
}

/// One number that answers (part of) a question, or a sentence where it has none.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    question: String,
    what: String,
    kind: Kind,
    words: Option<Words>,
    parameters: Vec<(Cow<'static, str>, Value)>,
    truth: Option<f64>,
    value: Option<f64>,
    estimate: Option<Estimate>,
    cost: Cost,
    seed: Option<u64>,
    seconds: Option<f64>,
    shortfall: Option<Shortfall>,
    part: Option<Part>,
    note: Option<String>,
    figures: Vec<Figure>,
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
            kind: Kind::Answer,
            words: None,
            parameters: Vec::new(),
            truth: None,
            value: None,
            estimate: None,
            cost: Cost::default(),
            seed: None,
            seconds: None,
            shortfall: None,
            part: None,
            note: None,
            figures: Vec::new(),
        }
    }

    /// Marks it as wrong on purpose, or of infinite variance.
    pub fn demonstration(mut self) -> Self {
        self.kind = Kind::Demonstration;
        self
    }

    /// The same, with the reason.
    pub(super) fn not_judged(mut self, words: Words) -> Self {
        self.words = Some(words);
        self.demonstration()
    }

    /// The part of its question that it answers: "(ii)".
    pub(super) fn part_of_question(mut self, part: &str) -> Self {
        self.question += part;
        self
    }

    /// A parameter that it was computed with; if the same name is given again, the last value counts.
    pub fn parameter(mut self, name: impl Into<Cow<'static, str>>, value: impl Into<Value>) -> Self {
        let (name, value) = (name.into(), value.into());
        match self.parameters.iter_mut().find(|(known, _)| *known == name) {
            Some((_, known)) => *known = value,
            None => self.parameters.push((name, value)),
        }
        self
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

    /// The outcome of a run.
    pub fn outcome(mut self, outcome: &Outcome) -> Self {
        self.estimate = Some(outcome.estimate);
        self.cost = outcome.cost;
        self.seed = Some(outcome.seed);
        self.seconds = Some(outcome.elapsed.as_secs_f64());
        self.shortfall = outcome.shortfall;
        self.part = outcome.part.clone();
        self
    }

    /// The result of a comparison for one estimator, with what its rank is based on as parameters.
    pub fn measured(mut self, rival: &Measured, seed: u64) -> Self {
        let draws = rival.estimate.draws() as f64;
        let count = |each: f64| (each * draws).round() as u64;
        self.estimate = Some(rival.estimate);
        self.cost =
            Cost { random_numbers: count(rival.random_numbers), evaluations: count(rival.evaluations) };
        self.seed = Some(seed);
        self.seconds = Some(rival.seconds * draws);
        self.truth(rival.truth)
            .parameter("variance", rival.variance())
            .parameter("variance_error", rival.variance_error)
            .parameter("seconds_per_draw", rival.seconds)
            .parameter("efficiency", rival.efficiency())
    }

    /// A sentence: the answer itself if the question has no number, or a remark on the number. A second one
    /// is appended.
    pub fn note(mut self, note: impl Into<String>) -> Self {
        let note = note.into();
        self.note = Some(self.note.map_or(note.clone(), |before| format!("{before} {note}")));
        self
    }

    /// A figure for it.
    pub fn figure(mut self, figure: Figure) -> Self {
        self.figures.push(figure);
        self
    }

    /// The sheet's number.
    pub fn question(&self) -> &str {
        &self.question
    }

    /// What it is about.
    pub fn what(&self) -> &str {
        &self.what
    }

    /// Whether it is meant to be right.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// The exact value, if there is one.
    pub fn exact(&self) -> Option<f64> {
        self.truth
    }

    /// The estimate, if it was estimated.
    pub fn estimate(&self) -> Option<&Estimate> {
        self.estimate.as_ref()
    }

    /// The difference of estimate and truth in standard errors, if both are known.
    pub fn z(&self) -> Option<f64> {
        self.estimate?.z(self.truth?)
    }

    /// Whether the estimate agrees with the truth, |z| ≤ 4. `None` if one of them is missing, the row is a
    /// demonstration, or its error bar is in doubt.
    pub fn agrees(&self) -> Option<bool> {
        if self.kind == Kind::Demonstration || self.doubt().is_some() {
            return None;
        }
        Some(self.z()?.abs() <= 4.0)
    }

    /// Why its error bar cannot be trusted, if so: for a given reason, or because there are too few draws, or
    /// all are equal.
    ///
    /// At least 1000 draws are needed, or 100 000 if all are equal but differ from the truth. A value of
    /// probability p per draw is missed by all n draws with probability at most 1e-12 if p ≥ 27.6/n, here
    /// 3e-4. If all draws are below a hundredth of the truth, or are 0 and no truth is known, no number of
    /// draws is enough: the whole mean may come from rarer values, as with a light too small to hit.
    pub(super) fn doubt(&self) -> Option<Doubt> {
        if let Some(Words::Doubted(doubt)) = &self.words {
            return Some(doubt.clone());
        }
        let (estimate, Kind::Answer) = (self.estimate?, self.kind) else { return None };
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

    /// Whether it is right: see [`agrees`](Self::agrees); to nine digits if it was computed numerically.
    pub(super) fn right(&self) -> Option<bool> {
        match (self.value, self.truth, self.kind) {
            (Some(value), Some(truth), Kind::Answer) => Some((value - truth).abs() <= 1e-9 * truth.abs()),
            _ => self.agrees(),
        }
    }

    /// ✓ or ✗, or words that say why it is neither.
    pub(super) fn verdict(&self) -> &'static str {
        if let Some(doubt) = self.doubt() {
            return doubt.mark();
        }
        match (&self.words, self.right()) {
            (Some(Words::WrongOnPurpose(_)), _) => "wrong on purpose",
            (Some(Words::LeftOut), _) => "left out",
            (None, Some(true)) => "✓",
            (None, Some(false)) => "✗",
            (None, None) if self.kind == Kind::Demonstration => "not judged",
            (None, None) if self.found().is_some() && self.truth.is_none() => "no closed form",
            _ => "",
        }
    }

    /// The mistake that it makes on purpose.
    pub(super) fn on_purpose(&self) -> Option<&str> {
        match &self.words {
            Some(Words::WrongOnPurpose(why)) => Some(why),
            _ => None,
        }
    }

    /// A sentence of warning about its error bar, unless the verdict says it already.
    pub(super) fn caution(&self) -> Option<String> {
        match self.doubt()? {
            Doubt::TooFewDraws => None,
            doubt => Some(format!("Careful: {doubt}.")),
        }
    }

    pub(super) fn parameters(&self) -> &[(Cow<'static, str>, Value)] {
        &self.parameters
    }

    /// The value computed numerically, or the estimated mean.
    pub(super) fn found(&self) -> Option<f64> {
        self.value.or(self.estimate.map(|estimate| estimate.mean()))
    }

    pub(super) fn cost(&self) -> Cost {
        self.cost
    }

    pub(super) fn seed(&self) -> Option<u64> {
        self.seed
    }

    pub(super) fn seconds(&self) -> Option<f64> {
        self.seconds
    }

    /// How far it is from the error asked for, if it was cut short.
    pub(super) fn shortfall(&self) -> Option<Shortfall> {
        self.shortfall
    }

    /// The data from which the whole run can be merged, if it is a shard.
    pub(super) fn part(&self) -> Option<&Part> {
        self.part.as_ref()
    }

    pub(super) fn sentence(&self) -> Option<&str> {
        self.note.as_deref()
    }

    /// The figures that belong to this edition.
    pub(super) fn figures(&self, edition: Edition) -> impl Iterator<Item = &Figure> {
        self.figures.iter().filter(move |figure| figure.edition() == edition)
    }
}

/// A row's parameters as JSON.
pub(super) fn parameters_of(answer: &Answer) -> serde_json::Map<String, serde_json::Value> {
    answer.parameters.iter().map(|(name, value)| (name.to_string(), value.json())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Budget, Estimator, Run, from_fn};

    fn row(estimator: &dyn Estimator, draws: u64, truth: f64) -> Answer {
        let outcome = Run::new(1).threads(1).estimate(estimator, Budget::Draws(draws)).unwrap();
        Answer::new("1.1", "").truth(truth).outcome(&outcome)
    }

    /// U's mean is 1/2. With 1000 draws 0.4 is eleven standard errors off; with fewer it is not judged.
    #[test]
    fn what_is_wrong_is_marked_once_there_are_draws_enough() {
        let uniform = from_fn(|rng| rng.uniform());
        for (draws, right, wrong) in
            [(1, None, None), (2, None, None), (999, None, None), (1000, Some(true), Some(false))]
        {
            assert_eq!(row(&uniform, draws, 0.5).agrees(), right, "{draws}");
            assert_eq!(row(&uniform, draws, 0.4).agrees(), wrong, "{draws}");
            let few = wrong.is_none().then_some(Doubt::TooFewDraws);
            assert_eq!(row(&uniform, draws, 0.4).doubt(), few);
        }
        assert_eq!(row(&uniform, 1000, 0.4).demonstration().agrees(), None);
        assert_eq!(row(&uniform, 2, 0.4).demonstration().doubt(), None);
    }

    #[test]
    fn draws_that_are_all_alike_are_judged_later_if_they_are_off() {
        let one = from_fn(|_| 1.0);
        for (draws, truth, agrees) in [
            (1000, 1.0, Some(true)),
            (99_999, 1.1, None),
            (100_000, 1.1, Some(false)),
            (999, 1.0, None),
            (100_000, 99.0, Some(false)),
            (100_000, 101.0, None),
        ] {
            assert_eq!(row(&one, draws, truth).agrees(), agrees, "{draws} {truth}");
        }
    }
}
