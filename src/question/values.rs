//! The values of questions' parameters: as given, or else their defaults.

use super::{Parameter, Question, Value};
use crate::error::{Error, Result};
use crate::numbers::parseable;

/// The values of questions' parameters: those that were set, and the sheet's own for all others.
#[derive(Debug, Clone, Default)]
pub struct Values {
    /// The last one of a name counts.
    given: Vec<Given>,
    /// The question whose parameters are asked for by name.
    question: Option<&'static Question>,
}

/// A value as given.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Given {
    /// The question, if it is for one alone, as `--5.2.p-rr` is; else it is for every question with that
    /// parameter.
    pub of: Option<&'static str>,
    pub name: &'static str,
    pub value: Value,
}

/// The parameter `name` of one of these questions; an error names `option`.
pub(crate) fn parameter<'q>(
    questions: impl IntoIterator<Item = &'q Question>,
    name: &str,
    option: &str,
) -> Result<&'static Parameter> {
    let mut known = questions.into_iter().flat_map(|question| question.parameters);
    let unknown = || Error::Usage(format!("there is no option --{option}; --help lists them"));
    known.find(|parameter| parameter.name == name).ok_or_else(unknown)
}

impl Parameter {
    /// Reads a value of this parameter.
    pub(crate) fn read(&self, given: &str) -> Result<Value> {
        let kind = self.default.kind();
        let unread = || Error::Usage(format!("--{} takes {kind}, not \"{given}\"", self.name));
        self.default.read_alike(given).ok_or_else(unread)
    }
}

impl Values {
    /// Sets the question's parameter `name` to a value as the command line takes it: "0.8", "4/5".
    ///
    /// # Errors
    /// If the question has no such parameter, or `given` is not a value of its kind.
    pub fn set(&mut self, question: &Question, name: &str, given: &str) -> Result<()> {
        let parameter = parameter([question], name, name)?;
        let value = parameter.read(given)?;
        self.give(Given { of: Some(question.id), name: parameter.name, value });
        Ok(())
    }

    /// Adds a value; it overrides earlier ones.
    pub(crate) fn give(&mut self, given: Given) {
        self.given.push(given);
    }

    /// Adds the values in `below`, where they are not set here.
    pub(crate) fn put_below(&mut self, mut below: Self) {
        below.given.append(&mut self.given);
        self.given = below.given;
    }

    /// The same values, of this question's parameters.
    pub(crate) fn for_question(&self, question: &'static Question) -> Self {
        Self { question: Some(question), ..self.clone() }
    }

    /// The value of the question's parameter `name`: as given, else its default.
    pub(crate) fn value(&self, name: &str) -> Option<Value> {
        let question = self.question?;
        let own = |given: &&Given| given.name == name && given.of.is_none_or(|of| of == question.id);
        let given = self.given.iter().rev().find(own).map(|given| given.value);
        let default = || question.parameters.iter().find(|parameter| parameter.name == name);
        given.or_else(|| default().map(|parameter| parameter.default))
    }

    /// The question's parameters, with their values.
    pub(crate) fn parameters(&self) -> impl Iterator<Item = (&'static Parameter, Value)> {
        let parameters = self.question.map_or(&[][..], |question| question.parameters).iter();
        parameters.filter_map(|parameter| Some((parameter, self.value(parameter.name)?)))
    }

    /// The number `name`, a parameter of the question that these values are for: as given, else its default.
    /// It is for [`Letter::value`](super::Letter::value), which gets such values: NaN for values that are for
    /// no question, and if the question has no such parameter.
    pub fn number(&self, name: &str) -> f64 {
        match self.value(name) {
            Some(Value::Number(number)) => number,
            _ => f64::NAN,
        }
    }

    /// The value of a parameter that is a count, or `None` for "all". `None`, too, if the question has no
    /// such parameter.
    pub(crate) fn limit(&self, name: &str) -> Option<u32> {
        match self.value(name) {
            Some(Value::Limit(limit)) => limit,
            _ => None,
        }
    }

    /// The value of a parameter that must be a whole number ≥ 0.
    pub(crate) fn whole_number(&self, name: &str) -> Result<u64> {
        let value = self.number(name);
        if value >= 0.0 && value < u64::MAX as f64 && value.fract() == 0.0 {
            Ok(value as u64)
        } else {
            Err(Error::Usage(format!("--{name} takes a whole number, not {}", parseable(value))))
        }
    }
}
