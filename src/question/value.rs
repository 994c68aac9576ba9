//! The value of a parameter, of a question or a row.

use std::fmt;

use serde_json::json;

use crate::numbers::{parseable, shortened};

/// The value of a parameter, always of the kind of its default.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value {
    /// A number, given as `0.8` or `4/5`.
    Number(f64),
    /// A count with an end, `3`, or without one, `all`.
    Limit(Option<u32>),
    /// A point in metres, given as `x,y,z`.
    Point([f64; 3]),
}

impl Value {
    /// Reads a value of the same kind.
    pub(crate) fn read_alike(self, text: &str) -> Option<Self> {
        match self {
            Self::Number(_) => number(text).map(Self::Number),
            Self::Limit(_) if text == "all" => Some(Self::Limit(None)),
            Self::Limit(_) => text.parse().ok().map(|count| Self::Limit(Some(count))),
            Self::Point(_) => {
                let coordinates: Vec<f64> = text.split(',').map(number).collect::<Option<_>>()?;
                coordinates.try_into().ok().map(Self::Point)
            }
        }
    }

    /// The name of this kind of value.
    pub(crate) fn kind(self) -> &'static str {
        match self {
            Self::Number(_) => "a number",
            Self::Limit(_) => "a whole number or \"all\"",
            Self::Point(_) => "three numbers x,y,z",
        }
    }

    /// The placeholder for it in the list of options.
    pub(crate) fn placeholder(self) -> &'static str {
        match self {
            Self::Number(_) => "X",
            Self::Limit(_) => "K",
            Self::Point(_) => "X,Y,Z",
        }
    }

    pub(crate) fn json(self) -> serde_json::Value {
        match self {
            Self::Number(number) => json!(number),
            Self::Limit(limit) => limit.map_or_else(|| json!("all"), |most| json!(most)),
            Self::Point(point) => json!(point),
        }
    }

    /// Short text for people: numbers to a few digits.
    pub(crate) fn shortened(self) -> String {
        match self {
            Self::Number(number) => shortened(number),
            Self::Limit(_) => self.to_string(),
            Self::Point(point) => format!("({})", point.map(shortened).join(", ")),
        }
    }
}

/// The form that the command line takes.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => f.write_str(&parseable(*number)),
            Self::Limit(Some(count)) => write!(f, "{count}"),
            Self::Limit(None) => write!(f, "all"),
            Self::Point(point) => f.write_str(&point.map(parseable).join(",")),
        }
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

/// A number or a fraction of two: `0.8`, `4/5`.
fn number(text: &str) -> Option<f64> {
    match text.split_once('/') {
        Some((above, below)) => Some(above.parse::<f64>().ok()? / below.parse::<f64>().ok()?),
        None => text.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_as_they_are_shown() {
        for value in [
            Value::Number(0.8),
            Value::Number(-1e-300),
            Value::Number(f64::MAX),
            Value::Number(5e-324),
            Value::Number(1.0 / 3.0),
            Value::Limit(Some(15)),
            Value::Limit(None),
            Value::Point([0.0, -0.25, 1.0]),
        ] {
            let text = value.to_string();
            assert!(value.read_alike(&text) == Some(value) && text.len() <= 23, "{text}");
        }
        assert_eq!(Value::Number(0.0).read_alike("4/5"), Some(Value::Number(0.8)));
        assert_eq!(Value::Point([0.0; 3]).read_alike("0,1/4,1"), Some(Value::Point([0.0, 0.25, 1.0])));
    }

    #[test]
    fn values_of_another_kind_are_refused() {
        for (kind, text) in [
            (Value::Number(0.0), "all"),
            (Value::Number(0.0), "1,2,3"),
            (Value::Limit(None), "2.5"),
            (Value::Limit(None), "-1"),
            (Value::Point([0.0; 3]), "1,2"),
            (Value::Point([0.0; 3]), "1,2,3,4"),
            (Value::Point([0.0; 3]), "1,,3"),
        ] {
            assert_eq!(kind.read_alike(text), None, "{kind:?} {text}");
        }
    }
}
