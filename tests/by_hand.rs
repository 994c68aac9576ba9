//! Are numbers worked out by hand judged right, and is each known wrong answer recognised, whatever the
//! parameters?
//!
//! Nothing is random but the parameters and the texts; nothing is judged by chance.
#![cfg(feature = "workbook")]

mod common;

use std::collections::BTreeSet;
use std::f64::consts::{LN_2, PI};
use std::fs;

use common::programs::{folder, run_in};
use proptest::prelude::*;
use serde_json::Value;
use unbiased::question::{Number, Question, Values};
use unbiased::workbook::{Judgement, judge_answer, question, questions};
use unbiased::{Error, Stream};

fn numbers() -> impl Iterator<Item = (&'static Question, &'static Number)> {
    questions().flat_map(|question| question.numbers.iter().map(move |number| (question, number)))
}

fn number(name: &str) -> (&'static Question, &'static Number) {
    numbers().find(|(question, number)| format!("{}{}", question.id, number.part) == name).unwrap()
}

type Parameters = Vec<(&'static str, f64)>;

fn at(question: &Question, parameters: &[(&'static str, f64)]) -> Values {
    let mut options = Values::default();
    for (name, value) in parameters {
        options.set(question, name, &value.to_string()).unwrap();
    }
    options
}

/// What `check_mine` says to answers at these parameters: a row each, with verdict, mistake and reason.
fn judged(answers: &[(String, String, Parameters)], arguments: &[&str]) -> Vec<Value> {
    let rows = answers.iter().enumerate().map(|(student, (question, text, parameters))| {
        let given: Vec<_> = parameters.iter().map(|(name, value)| format!("{name}={value}")).collect();
        format!("{student},{question},\"{text}\",{}\n", given.join(" "))
    });
    let folder = folder();
    let csv = "student,question,answer,variant\n".to_owned() + &rows.collect::<String>();
    fs::write(folder.join("answers.csv"), csv).unwrap();
    let arguments = [&["--answers", "answers.csv", "--json"], arguments].concat();
    let mut rows = run_in(folder, "check_mine", &arguments, "").rows();
    rows.truncate(answers.len());
    rows
}

fn ids(judgement: &Judgement) -> Vec<&'static str> {
    match judgement {
        Judgement::LooksLike(slips) => slips.iter().map(|slip| slip.id).collect(),
        _ => Vec::new(),
    }
}

/// Nothing near the ends of its domain, where answers need more digits than are given here.
fn random_parameters(question: &Question, rng: &mut Stream) -> Parameters {
    let own = question.parameters.iter().map(|parameter| {
        let u = rng.uniform();
        let value = match parameter.name {
            "rate" | "radiance" => 0.2 + 3.0 * u,
            "x-low" | "y-low" => -4.0 * u,
            "x-high" | "y-high" => 0.3 + 4.0 * u,
            "n" => 32.0,
            _ => 0.1 + 0.8 * u,
        };
        (parameter.name, value)
    });
    own.collect()
}

#[test]
fn every_slip_is_found_again_at_any_parameters() {
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-6;
    let (mut answers, mut expected) = (Vec::new(), Vec::new());
    for (question, number) in numbers() {
        let name = format!("{}{}", question.id, number.part);
        let mut rng = Stream::new(common::seed(11), 0);
        for _ in 0..200 {
            let parameters = random_parameters(question, &mut rng);
            let options = at(question, &parameters);
            let values = |formula: &str| question.evaluate(formula, &options).unwrap();
            let mut ask = |value: f64, words: &str, alone: bool| {
                answers.push((name.clone(), format!("{value:.12}"), parameters.clone()));
                expected.push((words.to_owned(), alone));
            };
            let truths = values(number.formula);
            truths.iter().for_each(|truth| ask(*truth, "right to the digits given", true));
            let all: Vec<_> = number.slips.iter().map(|slip| (slip, values(slip.answer))).collect();
            for (slip, wrong) in &all {
                let wrong = wrong.iter().filter(|value| !truths.iter().any(|truth| close(*truth, **value)));
                for value in wrong {
                    let others = all.iter().filter(|(other, _)| other.id != slip.id);
                    let alone = !others.flat_map(|(_, values)| values).any(|other| close(*other, *value));
                    ask(*value, if alone { slip.id } else { slip.words }, alone);
                }
            }
        }
    }
    for ((words, alone), row) in expected.iter().zip(judged(&answers, &[])) {
        let reason = row["reason"].as_str().unwrap();
        let found =
            if *alone { row["mistake"] == **words || reason == words } else { reason.contains(words) };
        let single = !*alone || !reason.contains("; or ");
        assert!(found && single, "{words}: {row}");
    }
}

#[test]
fn truths_are_those_of_independent_closed_forms() {
    let mut rng = Stream::new(common::seed(12), 0);
    for (question, number) in numbers() {
        let parameters = random_parameters(question, &mut rng);
        let options = at(question, &parameters);
        let p = |wanted: &str| parameters.iter().find(|(name, _)| *name == wanted).unwrap().1;
        let geometric = |k: i32| (0..k).fold(1.0 - p("p-rr"), |pmf, _| pmf * p("p-rr"));
        // E[N] = Σ_{k ≥ 1} P(N ≥ k)
        let expected = || (1..2000).fold(0.0, |sum, k| sum + p("p-rr").powi(k));
        let truth = match (question.id, number.part) {
            // the x at which the survival e^(−λx) is 1 − u = 1/4
            ("1.1", "") => 2.0 * LN_2 / p("rate"),
            ("1.2", "") => (1.0 / (1.0 - p("u"))).ln() / p("rate"),
            ("2.1", "") => (p("x-high") - p("x-low")) * (p("y-high") - p("y-low")),
            ("3.1", "") => 0.0,
            // ρ/π · L · π
            ("3.2", "") => p("albedo") / PI * p("radiance") * PI,
            ("3.4", "") => p("albedo") / PI * (2.0 * PI),
            ("3.5", "") => p("albedo"),
            ("5.1", "(i)") => geometric(0),
            ("5.1", "(ii)") => geometric(2),
            ("5.1", "(iii)") | ("5.2", "") => expected(),
            other => panic!("{other:?} has no truth here"),
        };
        let found = question.evaluate(number.formula, &options).unwrap()[0];
        assert!(
            (found - truth).abs() <= 1e-12 * truth,
            "{}{}: {found} for {truth}",
            question.id,
            number.part
        );
    }
    for (name, truth) in
        [("1.2", 1.386294), ("2.1", 16.0), ("5.1(ii)", 0.128), ("5.1(iii)", 4.0), ("5.2", 0.25)]
    {
        let (question, number) = number(name);
        let found = question.evaluate(number.formula, &Values::default()).unwrap();
        assert!((found[0] - truth).abs() < 1e-6, "{name}: {found:?}");
    }
}

#[test]
fn formulas_are_compared_as_they_are_written() {
    for (question, number) in numbers() {
        let name = format!("{}{}", question.id, number.part);
        let ids: BTreeSet<_> = number.slips.iter().map(|slip| slip.id).collect();
        assert_eq!(ids.len(), number.slips.len(), "{name}: an id twice");
        for right in number.formula.split(" or ") {
            assert_eq!(judge_answer(&name, right).unwrap(), Judgement::Right, "{name}: {right}");
        }
        for slip in number.slips {
            for answer in slip.answer.split(" or ") {
                let judgement = judge_answer(&name, answer).unwrap();
                // L_i is 1 on the sheet, where it is not written
                let right_here = judgement == Judgement::Right && slip.id == "no-radiance";
                assert!(
                    right_here || self::ids(&judgement).contains(&slip.id),
                    "{name}: {answer}: {judgement}"
                );
            }
        }
    }
}

#[test]
fn right_answers_are_right_to_the_digits_given() {
    for (name, right) in [
        ("1.1", &["-ln(1-u)/λ", "−ln(U)/lambda", "-log(u)/λ", "1.386", "0.288", "-ln(1-u)", "2 ln(2)/λ"][..]),
        (
            "1.2",
            &[
                "1.386",
                "1.39",
                "1.4",
                "1.386294",
                "1.386e0",
                "13.86E-1",
                "1.38629436",
                "ln 4",
                "2 ln 2",
                "LN 4",
                "-ln(1-0.75)",
                "−ln(0.25)",
                "1,386",
                " 1.386 ",
                "1.38",
                "2*0.693",
                "log(4)",
                "-log(1-.75)",
                "x=1.386",
                "x = ln 4 ≈ 1.386",
                "1.386.",
                "138.6%",
                "ln4",
                "ln(2²)",
                "ln(2)·2",
                "ln 2**2",
                "-ln(1-u)/λ",
                "log2(4) ln 2",
                "log10(4) × ln 10",
                "3 ln(4)/3",
                "ln(exp(1.386))",
                "ln(4)⁻¹ ln(4)²",
                "2 ln √4",
                "2 * 6.931e-1",
                "ln 100 − ln 25",
                "log100 - log25",
                "½·ln[16]",
            ],
        ),
        ("2.1", &["16", "16.0", "4*4", "4^2", "4²", "1/(1/16)", "16/n", "c = 16/n", "w h", "w·h/n", "2^2^2"]),
        ("3.1", &["0", "0.0", "0.00", "L_e = 0", "1/10+2/10-3/10", "ρ - ρ"]),
        ("3.2", &["ρ", "rho", "1ρ", "0.8", "ρ/π*π", "π ρ/π", "ρ L_i", "ρ Li", "L_r = ρ·L", "0.8 L_i", "80%"]),
        ("3.4", &["2ρ", "2 rho", "2*rho", "ρ·2", "(ρ/π)/(1/(2π))", "2ρ/n", "1.6", "2·0.8", "2 pi rho/pi"]),
        ("3.5", &["ρ", "ρ/n", "0.8/n", "c = 4/5"]),
        ("5.1(i)", &["1/5", "0.2", "0.20", "1-4/5", "1-p", "1 − p_rr", "20 %", "1-q"]),
        ("5.1(ii)", &["16/125", "0.128", "0.13", "(4/5)^2/5", "(4/5)²*(1/5)", ".128", "12.8%", "p²(1-p)"]),
        ("5.1 (iii)", &["4", "4.0", "5-1", "(4/5)/(1/5)", "E[N] = 4", "p/(1-p)", "1/(1 − prr) − 1"]),
        ("5.2", &["1/4", "0.25", ".25", "5/4-1", "¼", "25%"]),
    ] {
        for text in right {
            assert_eq!(judge_answer(name, text).unwrap(), Judgement::Right, "{name}: {text}");
        }
    }
}

#[test]
fn parameters_are_the_questions_own() {
    for (name, text, parameters, right) in [
        ("3.2", "0.5", &[("albedo", 0.5)][..], true),
        ("3.2", "0.8", &[("albedo", 0.5)], false),
        ("3.2", "ρ", &[("albedo", 0.5)], true),
        ("3.2", "1.0", &[("albedo", 0.5), ("radiance", 2.0)], true),
        ("3.2", "ρ L_i", &[("albedo", 0.5), ("radiance", 2.0)], true),
        ("1.2", "0.7133", &[("rate", 0.5), ("u", 0.3)], true),
        ("1.2", "-ln(1-0.3)/0.5", &[("rate", 0.5), ("u", 0.3)], true),
        ("2.1", "1.7*4.1", &[("x-low", 0.0), ("x-high", 1.7), ("y-low", 0.0), ("y-high", 4.1)], true),
        ("5.1(iii)", "1", &[("p-rr", 0.5)], true),
        ("5.1(iii)", "4", &[("p-rr", 0.5)], false),
    ] {
        let row = &judged(&[(name.into(), text.into(), parameters.into())], &[])[0];
        assert_eq!(row["verdict"] == "right", right, "{name}: {text} at {parameters:?}: {row}");
    }
    for (name, parameters, part) in [
        ("1.2", ("rate", -1.0), "the rate λ must be positive and finite, not -1"),
        ("1.2", ("u", 2.0), "must be"),
        ("1.2", ("u", 1.0), "the answer to 1.2 is infinite at these parameters"),
        ("3.2", ("albedo", 2.0), "albedo"),
        ("3.2", ("radiance", f64::INFINITY), "the radiance must be finite"),
        ("5.1(iii)", ("p-rr", 1.0), "the answer to 5.1(iii) is infinite"),
        ("5.2", ("p-rr", 0.0), "must be"),
    ] {
        let row = &judged(&[(name.into(), "1".into(), vec![parameters])], &[])[0];
        let said = row["verdict"] == "not judged" && row["reason"].as_str().unwrap().contains(part);
        assert!(said, "{name} at {parameters:?}: {row}");
    }
    let mut options = Values::default();
    let error = options.set(question("3.2").unwrap(), "rate", "1").unwrap_err();
    assert_eq!(error.to_string(), "there is no option --rate; --help lists them");
}

#[test]
fn digits_can_be_asked_for() {
    for (name, text, digits, verdict) in [
        ("1.2", "1.3", None, "right"),
        ("1.2", "1.3", Some("3"), "undecided"),
        ("1.2", "1.38", Some("3"), "undecided"),
        ("1.2", "1.39", Some("3"), "right"),
        ("1.2", "1.386", Some("3"), "right"),
        ("1.2", "1.39", Some("4"), "undecided"),
        ("1.2", "ln 4", Some("9"), "right"),
        ("1.2", "1.4", Some("1"), "right"),
        ("1.2", "1.3863", Some("1000000"), "undecided"),
        ("5.1(i)", "0.2", Some("3"), "right"), // exactly
        ("5.1(ii)", "0.13", Some("3"), "undecided"),
        ("5.1(ii)", "0.1", None, "undecided"), // another answer is as near
        ("5.1(ii)", "12.8 %", Some("3"), "right"),
        ("3.1", "0.0", Some("3"), "right"),
    ] {
        let digits: Vec<&str> = digits.into_iter().flat_map(|digits| ["--digits", digits]).collect();
        let row = &judged(&[(name.into(), text.into(), Vec::new())], &digits)[0];
        assert_eq!(row["verdict"], verdict, "{name}: {text}, {digits:?}: {row}");
    }
    assert_eq!(Judgement::TooFewDigits { needed: 2 }.to_string(), "too few digits: give 2, rounded");
}

#[test]
fn wrong_answers_are_named() {
    for (name, text, words) in [
        ("1.1", "-λ ln(1-u)", "looks like: multiplied by λ instead of divided"),
        ("1.1", "ln(u)/λ", "looks like: the sign forgotten"),
        ("1.2", "0.602", "looks like: the logarithm to base 10"),
        ("1.2", "log10(4)", "looks like: the logarithm to base 10"),
        ("1.2", "log_2 4", "looks like: the logarithm to base 2"),
        (
            "1.2",
            "0.288",
            "looks like: −ln U instead of −ln(1 − U): a sample too, but not the point on this CDF",
        ),
        ("1.2", "0.528", "looks like: F read at x = u instead of inverted"),
        ("1.2", "0.472", "looks like: p read at x = u instead of F inverted"),
        ("1.2", "-1.386", "looks like: the sign forgotten"),
        ("1.2", "1.41", "not right, and none of the known slips: 1.0171 times the answer"),
        ("1.2", "1.387", "not right, and none of the known slips: 1.0005 times the answer"),
        ("1.2", "2*0.694", "not right, and none of the known slips: 1.0012 times the answer"),
        ("1.2", "1", "not right, and none of the known slips: 0.7213 times the answer"),
        ("2.1", "4", "looks like: divided by p(x) or p(y) alone, 1 over a side: p(x, y) = p(x) p(y)"),
        ("2.1", "1/16", "looks like: multiplied by p instead of divided"),
        ("2.1", "1/n", "looks like: no division by p: the mean of f, not its integral"),
        ("3.2", "2ρ L_i", "looks like: sin θ or cos θ forgotten in the integral"),
        ("3.4", "4ρ/n", "looks like: the pdf taken for 1/(4π), the whole sphere's: twice the truth"),
        ("3.4", "3ρ", "not right, and none of the known slips: 1.5000 times the answer"),
        ("3.4", "3ρ²", "not right, and none of the known slips"),
        ("5.1(i)", "4/5", "looks like: the chance of going on, not of ending"),
        ("5.1(ii)", "16/25", "looks like: p²: the factor 1 − p for the end is missing"),
        ("5.1(ii)", "0.129", "not right, and none of the known slips: 1.0078 times the answer"),
        ("5.1(iii)", "5", "looks like: 1/(1 − p) counts coins, N + 1: subtract 1"),
        ("5.1(iii)", "5/4", "looks like: p and 1 − p exchanged, and no 1 subtracted"),
        ("5.2", "4", "looks like: p and 1 − p exchanged"),
        ("5.2", "0.2", "looks like: p itself: the first bounce alone"),
        ("3.1", "7", "not right, and none of the known slips"),
    ] {
        assert_eq!(judge_answer(name, text).unwrap().to_string(), words, "{name}: {text}");
    }
}

#[test]
fn what_is_no_answer_is_an_error() {
    let (brackets, signs) = ("(".repeat(10_000), "-".repeat(100_000));
    for text in [
        "", " ", "abc", "1/0", "1 2 x", "1 2", "(1", "1)", "ln", "ln 0", "ln(-1)", "--", "1..2", "1,386.29",
        "∞", "nan", "inf", "1e999", "0.0^0.5", "ρ", "16/n", "2 = x", "log2", "^2", "²", "5 %%%%(", &brackets,
        &signs,
    ] {
        let error = judge_answer("1.2", text).unwrap_err();
        assert!(matches!(error, Error::Usage(_)), "{text}: {error}");
        assert!(error.to_string().chars().count() < 300, "{error}");
    }
    for (name, text, sentence) in [
        (
            "1.2",
            "foo",
            "the answer \"foo\" is not understood. Allowed are numbers, fractions, + − × / ^, brackets, ln, \
             log10, exp, √, π, e, and the question's letters λ and u",
        ),
        (
            "3.5",
            "ρ/n Σ L_i",
            "the answer \"ρ/n Σ L_i\" is not understood. Allowed are numbers, fractions, + − × / ^, \
             brackets, ln, log10, exp, √, π, e, and the question's letters ρ, L_i, a and n",
        ),
        ("2.1", "16 n", "the answer \"16 n\" is not a number over n: give the c of c/n Σ f(Xᵢ, Yᵢ), or c/n"),
        ("1.2", "1/0", "the answer \"1/0\" is not a finite number"),
        ("5.1", "4", "question 5.1 asks for 5.1(i), 5.1(ii), 5.1(iii): say which, not 5.1"),
        ("5.1(iv)", "4", "question 5.1 asks for 5.1(i), 5.1(ii), 5.1(iii): say which, not 5.1(iv)"),
        (
            "1.3",
            "1",
            "question 1.3 has no number to judge; these have: 1.1, 1.2, 2.1, 3.1, 3.2, 3.4, 3.5, 5.1(i), \
             5.1(ii), 5.1(iii), 5.2",
        ),
    ] {
        assert_eq!(judge_answer(name, text).unwrap_err().to_string(), sentence);
    }
}

proptest! {
    #![proptest_config(common::config(500))]

    #[test]
    fn no_answer_panics(
        text in ".{0,30}",
        near in "[-+*/^(). 0-9eπρuλlnLog√²⁻%=,½]{0,30}",
    ) {
        for (question, number) in numbers() {
            let name = format!("{}{}", question.id, number.part);
            for answer in [&text, &near] {
                let words =
                    judge_answer(&name, answer).map_or_else(|error| error.to_string(), |of| of.to_string());
                prop_assert!(!words.contains("NaN") || answer.contains("NaN"), "{}: {}", answer, words);
                prop_assert!(!words.contains('\n'));
            }
        }
    }
}
