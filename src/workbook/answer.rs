//! One number of an answer.

use serde::Serialize;

use super::Value;
use crate::box_room::Scene;
use crate::estimate::Estimate;
use crate::figure::{Edition, Figure};
use crate::run::{Cost, Outcome};
use crate::trade::Measured;

/// What a row of an answer is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Right, and checked against its truth.
    Answer,
    /// Wrong on purpose, or of infinite variance: to be looked at, not to be checked.
    Demonstration,
}

/// One number that answers (part of) a question, or a sentence where it has none.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    question: String,
    what: String,
    kind: Kind,
    parameters: Vec<(&'static str, Value)>,
    truth: Option<f64>,
    value: Option<f64>,
    estimate: Option<Estimate>,
    cost: Cost,
    seed: Option<u64>,
    seconds: Option<f64>,
    pilot_never_varied: bool,
    note: Option<String>,
    figures: Vec<Figure>,
}

impl Answer {
    /// An answer to `question`, the sheet's number first ("2.1", "5.1(ii)"), about `what`, which does not tell it.
    pub fn new(question: &str, what: &str) -> Self {
        Self {
            question: question.into(),
            what: what.into(),
            kind: Kind::Answer,
            parameters: Vec::new(),
            truth: None,
            value: None,
            estimate: None,
            cost: Cost::default(),
            seed: None,
            seconds: None,
            pilot_never_varied: false,
            note: None,
            figures: Vec::new(),
        }
    }

    /// Marks it as wrong on purpose, or of infinite variance.
    pub fn demonstration(mut self) -> Self {
        self.kind = Kind::Demonstration;
        self
    }

    /// A parameter that it was computed with.
    pub fn parameter(mut self, name: &'static str, value: impl Into<Value>) -> Self {
        self.parameters.push((name, value.into()));
        self
    }

    /// The numbers of the box room that it was computed in.
    pub fn scene(self, scene: &Scene) -> Self {
        self.parameter("wall_albedo", scene.wall_albedo)
            .parameter("cube_albedo", scene.cube_albedo)
            .parameter("radiance", scene.radiance)
            .parameter("light_half_width", scene.light_half_width)
            .parameter("point", scene.point)
    }

    /// The closed form's value.
    pub fn truth(mut self, truth: f64) -> Self {
        self.truth = Some(truth);
        self
    }

    /// A value without an error bar, found numerically.
    pub fn value(mut self, value: f64) -> Self {
        self.value = Some(value);
        self
    }

    /// What came of a run.
    pub fn outcome(mut self, outcome: &Outcome) -> Self {
        self.estimate = Some(outcome.estimate);
        self.cost = outcome.cost;
        self.seed = Some(outcome.seed);
        self.seconds = Some(outcome.elapsed.as_secs_f64());
        self.pilot_never_varied = outcome.pilot_never_varied();
        self
    }

    /// What a comparison found of one estimator, with what decides its rank as parameters.
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

    /// A sentence: the answer itself where the question has no number, or a word on this one.
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.note = Some(note.into());
        self
    }

    /// A figure that shows it.
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

    /// The closed form's value, if it has one.
    pub fn exact(&self) -> Option<f64> {
        self.truth
    }

    /// The estimate, if it was estimated.
    pub fn estimate(&self) -> Option<&Estimate> {
        self.estimate.as_ref()
    }

    /// How many standard errors the estimate lies from the truth, where there are both.
    pub fn z(&self) -> Option<f64> {
        self.estimate?.z(self.truth?)
    }

    /// Whether the estimate agrees with the truth, |z| ≤ 4, where there are both and the row is not a demonstration.
    pub fn agrees(&self) -> Option<bool> {
        if self.kind == Kind::Demonstration {
            return None;
        }
        Some(self.z()?.abs() <= 4.0)
    }

    pub(super) fn parameters(&self) -> &[(&'static str, Value)] {
        &self.parameters
    }

    /// The value found numerically, or the mean estimated.
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

    pub(super) fn pilot_never_varied(&self) -> bool {
        self.pilot_never_varied
    }

    pub(super) fn sentence(&self) -> Option<&str> {
        self.note.as_deref()
    }

    /// The figures that belong to this edition.
    pub(super) fn figures(&self, edition: Edition) -> impl Iterator<Item = &Figure> {
        self.figures.iter().filter(move |figure| figure.edition() == edition)
    }
}
