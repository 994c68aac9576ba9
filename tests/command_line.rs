//! What the examples say on a terminal: to their options, to bad input, and about what cannot be judged.
#![cfg(feature = "workbook")]

mod common;

use std::collections::BTreeSet;
use std::fs;

use common::programs::{Ran, examples, folder, lasting, run, run_in, unfolded};
use serde_json::Value;
use unbiased::question::Values;
use unbiased::workbook::questions;

#[test]
fn bad_input_gets_one_sentence_an_exit_code_and_leaves_nothing_behind() {
    for (example, arguments, part) in [
        ("q1_1_exponential", &["--rate", "0"][..], "the rate λ must be positive and finite, not 0"),
        ("q1_1_exponential", &["--rate", "nan"], "not NaN"),
        ("q1_1_exponential", &["--rate", "inf"], "not inf"),
        ("q1_1_exponential", &["--rate", "fast"], "--rate takes a number, not \"fast\""),
        ("q1_1_exponential", &["--rate", "1/x"], "--rate takes a number, not \"1/x\""),
        ("q1_1_exponential", &["--rate"], "missing argument"),
        ("q1_2_one_sample", &["--u", "1.5"], "the probability u must be in [0, 1], not 1.5"),
        ("q1_3_axes", &["--draws", "0"], "--draws takes a positive whole number, not 0"),
        ("q1_3_axes", &["--draws", "-5"], "whole number"),
        ("q1_3_axes", &["--draws", "1.5"], "whole number"),
        ("q1_3_axes", &["--draws", "1e-3"], "whole number"),
        ("q1_3_axes", &["--draws", "1e300"], "whole number"),
        ("q1_3_axes", &["--draws", "_"], "whole number"),
        ("q1_3_axes", &["--draws", "inf"], "whole number"),
        ("q4_1_two_bounces", &["--point", "9,9,9"], "the point (9, 9, 9)"),
        ("q1_3_axes", &["--threads", "0"], "--threads takes a positive whole number"),
        ("q1_3_axes", &["--seed", "x"], "--seed takes a whole number"),
        ("q1_3_axes", &["--edition", "teacher"], "--edition is student, solution or both, not \"teacher\""),
        ("q1_3_axes", &["--u", "0.5"], "there is no option --u"),
        ("q1_3_axes", &["solve"], "unexpected argument"),
        ("q2_1_square", &["--x-low", "2"], "must be"),
        ("q2_1_square", &["--y-high", "inf"], "must be"),
        ("q2_1_square", &["--x-low=-1e300", "--x-high=1e300", "--y-low=-1e300", "--y-high=1e300"], "must be"),
        ("q2_1_square", &["--n", "0"], "must be"),
        ("q2_1_square", &["--n", "2.5"], "--n takes a whole number, not 2.5"),
        ("q3_2_uniform_sky", &["--albedo", "1.1"], "albedo"),
        ("q3_2_uniform_sky", &["--albedo=-0.1"], "albedo"),
        (
            "q3_4_brdf_directions",
            &["--radiance", "nan"],
            "question 3.4: the radiance must be finite, not NaN",
        ),
        ("worksheet", &["--5.2.p-rr", "0"], "question 5.2: "),
        ("worksheet", &["--1.1.p-rr", "0.5"], "there is no option --1.1.p-rr"),
        ("q3_5_cosine_directions", &["--a=-2"], "the exponent a must be above -2"),
        ("q3_6_variance", &["--width", "0"], "width"),
        ("q5_1_bounces", &["--p-rr", "0"], "p_rr"),
        ("q5_1_bounces", &["--p-rr", "1.2"], "p_rr"),
        ("q5_1_bounces", &["--p-rr", "1"], "never end"),
        ("q5_2_few_bounces", &["--albedo", "1"], "albedo"),
        ("q5_3_more_bounces", &["--visibility", "2"], "must be"),
        ("q5_3_more_bounces", &["--max-k", "1e12"], "must be"),
        ("worksheet", &["--color"], "there is no option --color"),
        (
            "q1_3_axes",
            &["--error", "1e-4", "--seconds", "2"],
            "--draws, --error and --seconds each end a run",
        ),
        ("q1_3_axes", &["--draws", "10", "--error", "1e-4"], "give one of them"),
        ("worksheet", &["--seconds", "1", "--draws", "10"], "give one of them"),
        ("q1_3_axes", &["--error", "0"], "--error takes a positive number, not \"0\""),
        ("q1_3_axes", &["--error", "inf"], "--error takes a positive number, not \"inf\""),
        ("q1_3_axes", &["--seconds", "nan"], "--seconds takes a positive number, not \"nan\""),
        ("q1_3_axes", &["--seconds", "1e30"], "--seconds takes a number from 1e-9 to 1e19, not \"1e30\""),
        ("q1_3_axes", &["--seconds", "1e-320"], "from 1e-9 to 1e19, not \"1e-320\""),
        ("q2_1_square", &["--n", "1e300"], "--n takes a whole number, not 1e300"),
        ("trade", &["--draws", "10"], "trade takes no --draws: it compares estimators on one core"),
        ("trade", &["--error", "1e-2"], "trade takes no --error"),
        ("trade", &["--threads", "1"], "trade takes no --threads"),
        ("trade", &["--edition", "student"], "trade takes no --edition"),
        ("trade", &["--hint"], "trade takes no --hint"),
        ("extremes", &["--draws", "5"], "extremes takes no --draws: it evaluates each formula once"),
        ("extremes", &["--seconds", "5"], "extremes takes no --seconds"),
        ("extremes", &["--rate", "5"], "there is no option --rate"),
    ] {
        let Ran { folder, code, out, err } = run(example, arguments);
        assert!(code == Some(2) && out.is_empty(), "{example} {arguments:?}: {err}");
        assert!(err.contains(part) && err.trim().lines().count() == 1, "{example} {arguments:?}: {err}");
        assert_eq!(fs::read_dir(folder).unwrap().count(), 0, "{example} {arguments:?}");
    }
}

#[test]
fn a_folder_that_cannot_be_written_is_one_sentence() {
    let folder = folder();
    fs::write(folder.join("file"), "not a folder").unwrap();
    let Ran { code, out, err, .. } = run_in(folder, "q1_2_one_sample", &["--out", "file/inside"], "");
    assert!(code == Some(1) && out.is_empty(), "{err}");
    assert!(err.contains("could not be written") && err.trim().lines().count() == 1, "{err}");
}

#[test]
fn help_lists_every_option() {
    for (example, own) in
        [("q1_2_one_sample", &["--rate", "--u"][..]), ("worksheet", &["--1.1.rate", "--1.2.u"])]
    {
        for flag in ["--help", "-h"] {
            let text = run(example, &[flag]).well().out;
            let listed: BTreeSet<_> = options(&text, "    ").collect();
            let common: BTreeSet<_> = options(include_str!("../README.md"), "| `").collect();
            assert!(!common.is_empty() && common.is_subset(&listed), "{example}: {common:?}, {listed:?}");
            let of_questions: BTreeSet<_> = listed.difference(&common).copied().collect();
            assert!(own.iter().all(|option| of_questions.contains(option)), "{example}: {of_questions:?}");
            assert!(example == "worksheet" || of_questions.len() == own.len(), "{of_questions:?}");
        }
    }
    // those beside the questions list what they take, and nothing else
    for (example, listed) in [
        ("trade", &["--seconds", "--seed", "--out", "--slides", "--json"][..]),
        ("extremes", &["--seed", "--out", "--slides", "--json"]),
    ] {
        let text = run(example, &["--help"]).well().out;
        assert_eq!(options(&text, "    ").collect::<Vec<_>>(), listed);
    }
}

/// The options that lines of a text begin with, after this.
fn options<'a>(text: &'a str, before: &'a str) -> impl Iterator<Item = &'a str> {
    let lines = text.lines().filter_map(move |line| line.strip_prefix(before));
    lines.filter(|rest| rest.starts_with("--")).filter_map(|rest| rest.split([' ', '`']).next())
}

/// What the README shows of a run is what the commands beside it print.
#[test]
fn the_readme_quotes_what_is_printed() {
    let sky = |draws| run("q3_2_uniform_sky", &["--draws", draws]);
    let printed = [run("check_mine", &[]), sky("10000"), sky("1000000")].map(|ran| ran.well().out).concat();
    let quotes = include_str!("../README.md").split("```text\n").skip(1);
    let quotes: Vec<&str> = quotes.filter_map(|rest| Some(rest.split_once("```")?.0)).collect();
    assert!(quotes.len() >= 3);
    for line in quotes.iter().flat_map(|quote| quote.lines()) {
        assert!(printed.lines().any(|of| of == line), "{line}");
    }
}

/// The rows of an example under these options that hold an estimate.
fn numbers(example: &str, options: &[&str]) -> Vec<Value> {
    let rows = run(example, &[options, &["--json"]].concat()).rows();
    rows.into_iter().filter(|row| row["draws"].is_u64()).collect()
}

/// What an example prints, wherever its lines are broken.
fn said(example: &str, options: &[&str]) -> String {
    unfolded(&run(example, options).well().out)
}

fn has_word(text: &str, word: &str) -> bool {
    text.split(|c: char| !c.is_alphanumeric()).any(|other| other == word)
}

#[test]
fn no_line_is_wider_than_a_narrow_terminal() {
    let mut names = examples();
    names.extend(["worksheet", "trade", "extremes"].map(String::from));
    for name in names {
        let lines = |arguments: &[&str]| {
            let text = run(&name, arguments).well().out;
            let too_long: Vec<_> = text.lines().filter(|line| line.chars().count() > 79).collect();
            assert!(too_long.is_empty(), "{name} {arguments:?}: {too_long:#?}");
            text.lines().count()
        };
        let beside = ["trade", "extremes"].contains(&name.as_str());
        let printed = lines(if beside { &[] } else { &["--draws", "2000"] });
        lines(&["--help"]);
        assert!(name != "worksheet" || printed < 60, "{printed} lines");
        if !beside {
            lines(&["--hint"]);
            lines(&["--edition", "student"]);
        }
        // 4.3 takes seconds for its figures
        if name.starts_with('q') && !name.starts_with("q4_3") {
            lines(&["--verbose", "--seconds", "0.001"]);
        }
    }
}

/// A draw would take a second, and a billion of them are asked for.
#[test]
fn the_student_edition_runs_no_estimator() {
    let arguments = ["--edition", "student", "--draws", "1000000000"];
    let start = std::time::Instant::now();
    for (example, own) in [("q5_1_bounces", &["--p-rr", "0.999999"][..]), ("q4_3_paths", &[])] {
        assert!(numbers(example, &[&arguments, own].concat()).is_empty());
    }
    assert!(start.elapsed().as_secs() < 5);
}

#[test]
fn whole_numbers_are_taken_as_they_are_written() {
    let mut estimates = ["2000", "2e3", "2_000", "2E3"].map(|draws| {
        let [share] = &numbers("q1_3_axes", &["--draws", draws])[..] else { panic!() };
        assert_eq!(share["draws"].as_u64(), Some(2000));
        share["estimate"].as_f64()
    });
    estimates.sort_by(|a, b| a.partial_cmp(b).unwrap());
    assert_eq!(estimates.first(), estimates.last());
}

/// What has no error bar to judge by says so, and nothing that cannot be done is begun.
#[test]
fn words_stand_where_no_mark_can() {
    for (example, options, part) in [
        ("q1_1_exponential", &["--draws", "1000"][..], "wrong on purpose: x = −λ ln(1 − u)"),
        ("q2_1_square", &["--draws", "1000"], "infinite variance"),
        ("q3_5_cosine_directions", &["--a", "-1.5", "--draws", "2000"], "infinite variance"),
        ("q4_2_three_bounces", &["--draws", "1000"], "no closed form"),
        ("q5_1_bounces", &["--p-rr", "0.999999999999"], "Left out: a draw takes about 1e12 random numbers."),
        ("q5_3_more_bounces", &["--visibility", "0", "--draws", "1000"], "With v = 0 there is no light."),
    ] {
        let text = said(example, options);
        assert!(text.contains(part) && !has_word(&text, "NaN"), "{part} is missing in\n{text}");
    }
    for row in numbers("q3_5_cosine_directions", &["--a", "-1.5", "--draws", "2000"]) {
        assert_eq!(row["kind"], "demonstration", "{row}");
    }
}

/// Each of its rows has a tenth of a second; a draw of some takes a million random numbers.
#[test]
fn a_row_keeps_its_time() {
    let rows = numbers("q5_1_bounces", &["--p-rr", "0.999999", "--seconds", "0.1"]);
    assert!(rows.len() == 8 && rows.iter().all(|row| row["seconds"].as_f64().unwrap() < 5.0), "{rows:?}");
}

/// The pilot of 2²⁰ draws knows their variance to 0.1 %, and 7 of these is below 1 %.
#[test]
fn an_error_asked_for_is_reached() {
    let [share] = &numbers("q1_3_axes", &["--error", "2e-4"])[..] else { panic!() };
    let reached = share["std_error"].as_f64().unwrap();
    assert!((reached / 2e-4 - 1.0).abs() <= 0.01, "{share}");
    assert!(share["draws"].as_u64().unwrap() > 1 << 20, "{share}");
    let text = said("q1_3_axes", &["--error", "0.0002"]);
    assert!(text.contains("--error 0.0002 --seed 1") && text.contains('✓'), "{text}");
    // easily reached: as many draws as the pilot's, enough for every mark
    let text = said("q3_6_variance", &["--error", "1e-2"]);
    assert!(!text.contains('✗') && !text.contains("too few") && !has_word(&text, "inf"), "{text}");
    let text = said("q3_6_variance", &["--error", "1e300"]);
    assert!(text.contains("--error 1e300 --seed 1"), "{text}");
    // without variance a pilot ends after 2²⁴ draws
    let [dark] = &numbers("q3_1_emission", &["--error", "1e-9"])[..] else { panic!() };
    assert_eq!(dark["draws"].as_u64(), Some(1 << 20), "{dark}");
}

/// Takes the five seconds that a row has.
#[test]
fn an_error_out_of_reach_is_a_remark_on_its_row() {
    let text = said("q1_3_axes", &["--error", "1e-300"]);
    for part in [
        "Cut short at a std error of ",
        "a std error of 1e-300 takes more than 1e300 draws",
        "--seconds",
        "✓",
    ] {
        assert!(text.contains(part), "{part:?} is missing in\n{text}");
    }
    assert!(text.contains(" --draws ") && !text.contains(" --error "), "what repeats it:\n{text}");
    assert!(!has_word(&text, "inf"), "{text}");
}

#[test]
fn a_time_is_spent_and_its_draws_repeat_the_result() {
    let [share] = &numbers("q1_3_axes", &["--seconds", "0.05"])[..] else { panic!() };
    assert!(share["draws"].as_u64().unwrap() >= 2 && share["seconds"].as_f64().unwrap() > 0.0, "{share}");
    let draws = share["draws"].to_string();
    let [again] = &numbers("q1_3_axes", &["--draws", &draws])[..] else { panic!() };
    assert_eq!(lasting(share.clone()), lasting(again.clone()));
    // the command that is printed does so: with the draws of one row, or saying where they stand
    let text = said("q1_3_axes", &["--seconds", "0.05", "--verbose"]);
    let count = text.split(" draws, ").next().and_then(|before| before.split_whitespace().last()).unwrap();
    assert!(text.contains(&format!("--draws {count} --seed 1")) && !text.contains("--seconds"), "{text}");
    let text = said("q1_1_exponential", &["--seconds", "0.02"]);
    assert!(text.contains("--draws N --seed 1 where N is the number of draws of the row"), "{text}");
}

#[test]
fn too_few_draws_are_not_judged() {
    for (example, rows) in [("q3_6_variance", 7), ("q1_3_axes", 1)] {
        for draws in ["1", "2", "999"] {
            let text = said(example, &["--draws", draws]);
            assert_eq!(text.matches("too few draws to judge").count(), rows, "{text}");
            assert!(!text.contains('✓') && !text.contains('✗') && !has_word(&text, "inf"), "{text}");
        }
    }
    let text = said("q3_6_variance", &["--draws", "1000"]);
    assert!(text.contains('✓') && !text.contains("too few"), "{text}");
    // a ring that no draw will hit: 0 ± 0 is no evidence, for all its draws
    let text = said("q3_6_variance", &["--width", "1e-9", "--draws", "200000"]);
    assert_eq!(text.matches("no variance Careful").count(), 2, "{text}");
    assert!(!text.contains('✗'), "{text}");
}

#[test]
fn every_example_has_a_hint_that_does_not_tell() {
    for question in questions() {
        let stated = question.at(&Values::default()).unwrap();
        let text = said(question.example, &["--hint"]);
        assert_eq!(text, unfolded(&format!("{} {}", question.id, stated.hint)));
        assert!(!text.contains(&unfolded(&stated.formula)), "{}", question.id);
    }
    let all = run("worksheet", &["--hint"]).well().out;
    let ids = all.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    assert_eq!(ids.count(), questions().count());
}

/// Those that are right at these parameters are not among them: multiplying by λ at λ = 1.
#[test]
fn classic_wrong_answers_have_values_at_the_parameters() {
    let list = |example: &str, arguments: &[&str]| {
        let text = run(example, &[arguments, &["--draws", "1000"]].concat()).well().out;
        text.split_once("classic wrong answers\n").map(|(_, list)| unfolded(list)).unwrap_or_default()
    };
    for (example, arguments, line) in [
        ("q1_1_exponential", &["--rate", "2"][..], "· x(0.75) = −λ ln(1 − u) = 2.773: multiplied by λ"),
        ("q1_2_one_sample", &["--u", "0.3"], "· x = −log₁₀(1 − u)/λ = 0.1549: the logarithm to base 10"),
        ("q2_1_square", &["--x-high", "1"], "· c = w or h = 3 or 4 in c/n Σ f(Xᵢ, Yᵢ): "),
        ("q2_1_square", &[], "· c = w or h = 4 in c/n Σ f(Xᵢ, Yᵢ): "),
        ("q2_1_square", &[], "· c = 1 in c/n Σ f(Xᵢ, Yᵢ): no division by p"),
        ("q5_2_few_bounces", &["--p-rr", "0.6"], "· E[N] = (1 − p_rr)/p_rr = 0.6667: p and 1 − p exchanged"),
        ("q5_3_more_bounces", &[], "· it removes bias: roulette is unbiased"),
    ] {
        let list = list(example, arguments);
        assert!(list.contains(line), "{line} is missing in\n{list}");
    }
    for (example, arguments, slip) in [
        ("q1_1_exponential", &["--rate", "1"][..], "multiplied by λ"),
        ("q5_2_few_bounces", &["--p-rr", "0.5"], ": p and 1 − p exchanged ·"),
        ("q1_1_exponential", &["--edition", "student"], "·"),
    ] {
        let list = list(example, arguments);
        assert!(!list.contains(slip), "{slip} is in\n{list}");
    }
}

#[test]
fn people_see_the_interval_the_z_and_the_command_that_repeats_it() {
    let arguments = ["--rate", "2.5", "--draws", "5000", "--seed", "9", "--verbose"];
    let text = said("q1_1_exponential", &arguments);
    for part in [
        "closed form",
        "rate = 2.5, instead of the sheet's",
        "truth 0.4",
        "(95 %)",
        "z = ",
        "✓",
        "5000 draws",
        "seed 9",
        ".svg",
        "cargo run --release --example q1_1_exponential -- --rate 2.5 --draws 5000 --seed 9",
    ] {
        assert!(text.contains(part), "{part:?} is missing in\n{text}");
    }
}
