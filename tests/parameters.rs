//! Do the workbook's texts follow its parameters? One set of parameters in statement, hint, closed form, why
//! and wrong answers.
//!
//! Nothing here is random.
#![cfg(feature = "workbook")]

use std::collections::BTreeSet;

use unbiased::question::{Parameter, Question, Stated, Value, Values};
use unbiased::workbook::{question, questions};

fn texts(stated: &Stated) -> Vec<String> {
    let Stated { title, statement, hint, formula, latex, answer, wrong, on_the_original } = stated.clone();
    let mut all = vec![title, statement, hint, formula, answer];
    all.extend(latex);
    all.extend(wrong.into_iter().flat_map(|(wrong, slip)| [wrong, slip]));
    all.extend(on_the_original);
    all
}

fn at(question: &'static Question, given: &[(&str, f64)]) -> Stated {
    let mut options = Values::default();
    for (name, value) in given {
        options.set(question, name, &value.to_string()).unwrap();
    }
    question.at(&options).unwrap_or_else(|error| panic!("{given:?}: {error}"))
}

/// The numbers that are written in a text, fractions among them.
fn numbers(text: &str) -> BTreeSet<String> {
    let words = text.split(|c: char| !(c.is_ascii_digit() || ".−/".contains(c)));
    let words = words.map(|word| word.trim_matches(|c| "./".contains(c)).to_owned());
    words.filter(|word| word.chars().any(|c| c.is_ascii_digit())).collect()
}

/// A value of its own for every parameter, inside its domain.
fn other(parameter: &Parameter) -> f64 {
    let Value::Number(default) = parameter.default else { panic!("--{} is no number", parameter.name) };
    let own = parameter.letter.map(|letter| letter.generic).filter(|own| *own != default);
    own.unwrap_or(default + 3.0)
}

/// Each parameter alone: its new value is in the texts that had the old one, and the old one in none that
/// changed.
#[test]
fn no_default_is_left_in_a_text_once_it_is_changed() {
    let mut told = BTreeSet::new();
    for question in questions() {
        for parameter in question.parameters {
            let Value::Number(default) = parameter.default else { continue };
            // all the others are no defaults already
            let numbers_of = question.parameters.iter().filter(|of| matches!(of.default, Value::Number(_)));
            let mut given: Vec<_> = numbers_of.map(|of| (of.name, other(of))).collect();
            let changed = at(question, &given);
            given.retain(|(name, _)| *name != parameter.name);
            let sheet = at(question, &given);
            for (before, after) in texts(&sheet).iter().zip(texts(&changed)) {
                if *before == after {
                    continue;
                }
                told.insert((question.id, parameter.name));
                let old = default.to_string().replace('-', "−");
                // 0, 1 and 2 are numbers of many formulas
                let of_its_own = default.abs() > 2.0 || default.fract() != 0.0;
                let left = of_its_own && numbers(&after).contains(&old);
                assert!(!left, "{}: --{} leaves {old} in “{after}”", question.id, parameter.name);
            }
        }
    }
    for question_and_parameter in [
        ("1.2", "rate"),
        ("1.2", "u"),
        ("2.1", "x-low"),
        ("2.1", "y-high"),
        ("3.2", "albedo"),
        ("3.2", "radiance"),
        ("3.4", "a"),
        ("3.6", "width"),
        ("4.1", "light-half-width"),
        ("4.2", "wall-albedo"),
        ("5.1", "p-rr"),
        ("5.2", "p-rr"),
        ("5.2", "albedo"),
        ("5.3", "visibility"),
    ] {
        assert!(told.contains(&question_and_parameter), "{question_and_parameter:?} is in no text");
    }
}

/// What is written outside « and » holds for every parameter: no default and no answer at the defaults is in
/// it.
#[test]
fn templates_hold_no_defaults() {
    for question in questions() {
        let mut own = BTreeSet::new();
        for parameter in question.parameters {
            if let Value::Number(number) = parameter.default {
                own.insert(number.to_string());
            }
        }
        for number in question.numbers {
            for truth in question.evaluate(number.formula, &Values::default()).unwrap() {
                own.insert(format!("{truth:.6}").trim_end_matches('0').trim_end_matches('.').to_owned());
            }
        }
        own.retain(|number| !["0", "1", "2", "4"].contains(&number.trim_start_matches('-')));
        own.extend(["4/5", "1/5", "3/4", "16/125", "1/16", "ln 4"].map(str::to_owned));
        let Question { title, statement, hint, formula, latex, answer, .. } = *question;
        for text in [title, statement, hint, formula, answer].into_iter().chain(latex.iter().copied()) {
            let mut outside = String::new();
            for (index, part) in text.split(['«', '»']).enumerate() {
                if index % 2 == 0 {
                    outside += part;
                    outside.push(' ');
                }
            }
            let found: Vec<_> = numbers(&outside).intersection(&own).cloned().collect();
            assert!(found.is_empty(), "{}: {found:?} in “{text}”", question.id);
        }
    }
}

#[test]
fn closed_forms_have_the_values_of_their_parameters() {
    for (id, name, value, part) in [
        // −ln 0.59/1, −ln 0.25/0.37
        ("1.2", "u", 0.41, "−ln(1 − u)/λ = 0.5276327"),
        ("1.2", "rate", 0.37, "= 3.746742, where p(x) = λ(1 − u) = 0.0925"),
        ("2.1", "x-high", 0.5, "10/n Σ"),
        ("3.2", "albedo", 0.5, "ρ L_i = 0.5"),
        ("5.1", "p-rr", 0.5, "0.5 for k = 0, 0.125 for k = 2; E[N] = p_rr/(1 − p_rr) = 1"),
        ("5.2", "p-rr", 1.0, "= ∞"),
    ] {
        let formula = at(question(id).unwrap(), &[(name, value)]).formula;
        assert!(formula.contains(part), "{formula}");
    }
    // light along the horizon: 0.99 ε²/(4/3 ε³ − ε⁴) at ε = 0.1
    let why = question("3.6").unwrap().at(&Values::default()).unwrap().answer;
    assert!(why.contains("and 8.027027 times uniform's at ε = 0.1"), "{why}");
}

#[test]
fn a_parameter_outside_its_domain_names_the_question() {
    for (id, name, value) in [
        ("1.2", "rate", "-1"),
        ("1.2", "u", "1.5"),
        ("2.1", "x-high", "-5"),
        ("3.4", "albedo", "1.5"),
        ("3.6", "width", "0"),
        ("4.2", "wall-albedo", "2"),
        ("5.3", "visibility", "-0.1"),
        ("5.1", "p-rr", "0"),
    ] {
        let question = question(id).unwrap();
        let mut options = Values::default();
        options.set(question, name, value).unwrap();
        let error = question.at(&options).unwrap_err().to_string();
        assert!(error.starts_with(&format!("question {id}: the ")), "{error}");
    }
}
