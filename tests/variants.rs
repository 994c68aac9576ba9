//! Are a thousand variants fair, and the same everywhere?
//!
//! Nothing here is random: names choose the numbers.
#![cfg(feature = "workbook")]

use std::collections::BTreeSet;

use unbiased::question::Values;
use unbiased::workbook::{question, questions};

fn variant(name: &str) -> Values {
    Values::default().variant(name, questions()).unwrap()
}

/// Every wrong answer is 5 % off the right one, every classic one 5 % off the others, no parameter hides a
/// mistake, and numbers are short.
#[test]
fn a_thousand_variants_are_fair() {
    let differ = |a: f64, b: f64| (a - b).abs() >= 0.05 * a.abs().max(b.abs()) && a != b;
    let mut statements = BTreeSet::new();
    for index in 0..1000 {
        let options = variant(&format!("student {index}"));
        for question in questions() {
            let stated = question.at(&options).unwrap();
            if question.id == "1.2" {
                statements.insert(stated.statement.clone());
            }
            for parameter in question.parameters {
                let Some(letter) = parameter.letter else { continue };
                let value = question.evaluate(letter.names[0], &options).unwrap()[0];
                assert!(value.to_string().trim_start_matches('-').len() <= 4, "{value}");
                let hides = match parameter.name {
                    "rate" | "radiance" if question.id != "3.1" => value == 1.0,
                    "p-rr" | "u" | "visibility" | "light-half-width" => value == 0.5,
                    "albedo" => value == 0.5 || value == 1.0,
                    _ => false,
                };
                assert!(!hides, "{}: --{} {value}", question.id, parameter.name);
            }
            for number in question.numbers {
                let values = |formula: &str| question.evaluate(formula, &options).unwrap();
                let truths = values(number.formula);
                let mut classic: Vec<(&str, f64)> = Vec::new();
                for slip in number.slips {
                    for value in values(slip.answer) {
                        let right = truths.iter().any(|truth| !differ(value, *truth));
                        assert!(!right, "{index}, {}{}: {} is {value}", question.id, number.part, slip.id);
                        if slip.classic {
                            let twin =
                                classic.iter().find(|(id, other)| *id != slip.id && !differ(value, *other));
                            assert!(twin.is_none(), "{index}, {}: {} and {twin:?}", question.id, slip.id);
                            classic.push((slip.id, value));
                        }
                    }
                }
            }
        }
    }
    // 13 rates and 13 numbers u, less those that are not fair
    assert!(statements.len() > 100, "{}", statements.len());
}

/// The names' own numbers, written down once: they are the same on every machine.
#[test]
fn a_name_has_the_same_numbers_everywhere() {
    for (name, u, p_rr) in GOLDEN {
        let options = variant(name);
        let letter = |id: &str, name: &str| question(id).unwrap().evaluate(name, &options).unwrap()[0];
        assert_eq!((letter("1.2", "u"), letter("5.1", "p_rr")), (u, p_rr), "{name}");
    }
}

const GOLDEN: [(&str, f64, f64); 3] = [("Ada", 0.9, 0.7), ("42", 0.85, 0.2), ("Łukasz Żółć", 0.95, 0.25)];

#[test]
fn what_is_given_stands_above_the_variant_and_a_name_is_needed() {
    let question = question("5.2").unwrap();
    let mut options = Values::default();
    options.set(question, "p-rr", "0.55").unwrap();
    let options = options.variant("Ada", questions()).unwrap();
    assert_eq!(question.evaluate("p_rr", &options).unwrap(), [0.55]);
    for name in ["", "  "] {
        let error = Values::default().variant(name, questions()).unwrap_err().to_string();
        assert_eq!(error, "a variant needs a name: any text or number");
    }
}
