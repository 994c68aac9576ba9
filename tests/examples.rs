//! Every example runs, prints JSON that parses, and agrees with its truths; the worksheet's pages hold all of
//! it, and the student's edition none of the answers.
#![cfg(feature = "workbook")]

mod common;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use common::programs::{Ran, examples, lasting, run, run_in};
use serde_json::Value;
use unbiased::question::Values;
use unbiased::workbook::questions;

const KEYS: [&str; 11] = [
    "question",
    "what",
    "kind",
    "parameters",
    "truth",
    "estimate",
    "std_error",
    "draws",
    "seed",
    "seconds",
    "figures",
];

/// The whole worksheet, run once for all tests.
fn worksheet() -> &'static (Ran, Vec<Value>) {
    static ONCE: OnceLock<(Ran, Vec<Value>)> = OnceLock::new();
    ONCE.get_or_init(|| {
        let ran = run("worksheet", &["--json"]).well();
        let rows = ran.rows();
        (ran, rows)
    })
}

/// The student's edition, with the rows that it prints as JSON.
fn student() -> &'static (Ran, Vec<Value>) {
    static ONCE: OnceLock<(Ran, Vec<Value>)> = OnceLock::new();
    ONCE.get_or_init(|| {
        let ran = run("worksheet", &["--edition", "student", "--verbose"]).well();
        let rows = run_in(&ran.folder, "worksheet", &["--edition", "student", "--json"], "").rows();
        (ran, rows)
    })
}

/// Whether a file may differ from run to run: it holds timings, as the page does, or is a PDF, whose library
/// numbers its objects in the order of a hash map.
fn changes(name: &str) -> bool {
    name.ends_with(".pdf")
        || name.ends_with(".html")
        || name.contains("seconds")
        || name.starts_with("trade_")
}

/// The question's number in an example's name, or in a row.
fn id(name: &str) -> String {
    name.trim_start_matches('q').get(..3).unwrap().replace('_', ".")
}

#[test]
fn the_worksheet_takes_in_every_example() {
    let of_examples: BTreeSet<String> = examples().iter().map(|name| id(name)).collect();
    let of_rows = worksheet().1.iter().map(|row| id(row["question"].as_str().unwrap())).collect();
    assert_eq!(of_examples, of_rows);
    assert_eq!(of_examples, questions().map(|question| question.id.to_owned()).collect());
    for question in questions() {
        assert!(examples().contains(&question.example.to_owned()), "{}", question.example);
    }
}

#[test]
fn every_row_has_all_keys_and_every_answer_its_truth() {
    let (ran, rows) = worksheet();
    assert!(rows.len() >= 30);
    for row in rows {
        let object = row.as_object().unwrap();
        assert_eq!(object.keys().collect::<BTreeSet<_>>(), KEYS.map(String::from).iter().collect(), "{row}");
        assert!(["answer", "demonstration"].contains(&row["kind"].as_str().unwrap()));
        assert!(row["parameters"].is_object());
        for figure in row["figures"].as_array().unwrap() {
            let path = ran.folder.join(figure.as_str().unwrap());
            assert!(fs::metadata(path).unwrap().len() > 0, "{figure}");
        }
        if let Some(std_error) = row["std_error"].as_f64() {
            let (estimate, draws) = (row["estimate"].as_f64().unwrap(), row["draws"].as_u64().unwrap());
            assert!(draws > 0 && row["seed"].as_u64() == Some(1) && row["seconds"].as_f64().unwrap() >= 0.0);
            if row["kind"] == "answer" {
                // without a closed form there is nothing to compare with
                let Some(truth) = row["truth"].as_f64() else { continue };
                let rounding = 8.0 * f64::EPSILON * truth.abs();
                assert!((estimate - truth).abs() <= 4.0 * std_error + rounding, "z beyond 4: {row}");
            }
        } else if let (Some(estimate), Some(truth)) = (row["estimate"].as_f64(), row["truth"].as_f64()) {
            // found numerically, not estimated
            assert!((estimate - truth).abs() <= 1e-12 * truth.abs(), "{row}");
        }
    }
}

/// And as the figures committed show, where the repository is at hand.
#[test]
fn each_example_alone_says_and_draws_what_the_worksheet_does() {
    let (together, all) = worksheet();
    for example in examples() {
        let alone = run(&example, &["--json"]).well();
        let expected = all.iter().filter(|row| id(row["question"].as_str().unwrap()) == id(&example));
        let (here, there): (Vec<_>, Vec<_>) =
            (alone.rows().into_iter().map(lasting).collect(), expected.cloned().map(lasting).collect());
        assert_eq!(here, there);
        for (name, path) in alone.files().into_iter().filter(|(name, _)| !changes(name)) {
            let same =
                fs::read(path).unwrap() == fs::read(together.folder.join("worksheet").join(&name)).unwrap();
            assert!(same, "{name} differs");
        }
    }
    let committed = Path::new(env!("CARGO_MANIFEST_DIR")).join("figures");
    let drawn = together.files().into_iter().filter(|(name, _)| !changes(name));
    for (name, path) in drawn.filter(|(name, _)| name.ends_with(".svg") || name.ends_with(".csv")) {
        let same = || fs::read(committed.join(&name)).ok() == fs::read(path).ok();
        assert!(!committed.exists() || same(), "figures/{name} is not what is drawn now");
    }
}

#[test]
fn the_number_of_threads_cannot_be_seen() {
    for example in ["q1_1_exponential", "q1_3_axes"] {
        let [one, others @ ..] = ["1", "2", "3", "8"].map(|threads| {
            let rows = run(example, &["--json", "--draws", "100000", "--threads", threads]).rows();
            rows.into_iter().map(lasting).collect::<Vec<_>>()
        });
        assert!(others.iter().all(|other| *other == one));
    }
}

/// What a reader sees or hears of a page: its text without the tags, titles and descriptions included.
fn text_of(html: &str) -> String {
    let body = html.split_once("<body").map_or(html, |(_, body)| body);
    let mut text = String::new();
    let mut inside = false;
    for c in body.chars() {
        match c {
            '<' => inside = true,
            '>' => {
                inside = false;
                text.push(' ');
            }
            c if !inside => text.push(c),
            _ => {}
        }
    }
    text
}

/// Letters and digits alone: the same whether or not some stand in subscripts.
fn letters(text: &str) -> String {
    text.chars().filter(|c| c.is_alphanumeric()).collect()
}

#[test]
fn the_student_edition_contains_no_answer() {
    let (ran, rows) = student();
    let page = ran.file("student.html");
    let mut texts = vec![("page", text_of(&page)), ("terminal", ran.out.clone())];
    for (name, path) in ran.files() {
        assert!(name == "student.html" || name.contains("_student."), "{name}");
        match path.extension().and_then(|ending| ending.to_str()) {
            Some("svg") => texts.push(("figure", text_of(&fs::read_to_string(&path).unwrap()))),
            Some("csv") => texts.push(("csv", fs::read_to_string(&path).unwrap())),
            _ => {}
        }
    }
    for row in rows {
        for key in ["truth", "estimate", "std_error", "draws", "seed", "seconds"] {
            assert!(row[key].is_null(), "{key} in {row}");
        }
        assert_eq!(row["kind"], "answer", "a demonstration names a mistake: {row}");
        texts.push(("json", row["what"].as_str().unwrap().to_owned()));
    }
    let (_, solved) = worksheet();
    for (place, text) in &texts {
        for question in questions() {
            let stated = question.at(&Values::default()).unwrap();
            let wrong = stated.wrong.into_iter().map(|(_, slip)| slip);
            let secrets =
                [stated.formula, stated.answer].into_iter().chain(stated.on_the_original).chain(wrong);
            for secret in secrets {
                assert!(
                    !letters(text).contains(&letters(&secret)),
                    "{}: the {place} says {secret:?}",
                    question.id
                );
            }
        }
        if *place == "csv" {
            continue; // the curves to be marked have numbers of their own
        }
        // numbers that nobody would write by chance: four digits or more
        let truths = solved.iter().filter_map(|row| row["truth"].as_f64());
        for truth in truths.filter(|truth| (truth * 1000.0).fract().abs() > 1e-9) {
            let shown = format!("{truth:.3}");
            assert!(!text.contains(&shown), "the {place} says {shown}");
        }
    }
    assert!(!page.contains("<math"), "formulas are answers");
}

#[test]
fn the_pages_have_everything_and_need_nothing() {
    let (ran, rows) = worksheet();
    let [key, trade, extremes] = ["solution.html", "trade.html", "extremes.html"].map(|name| ran.file(name));
    for question in questions() {
        let id = question.id.replace('.', "-");
        assert!(key.contains(&format!("id=\"q-{id}\"")), "{}", question.id);
        let link = format!("href=\"#q-{id}\">{} ", question.id);
        assert!(key.contains(&link), "the navigation does not name {}", question.id);
    }
    let files = ran.files();
    assert!(files.iter().all(|(name, _)| name != "student.html" && name != "index.html"));
    for name in ["trade", "extremes"] {
        assert!(key.contains(&format!("href=\"{name}.html\"")), "{name}");
    }
    let drawn = files.iter().filter(|(name, _)| name.ends_with(".svg")).count();
    let named = rows.iter().flat_map(|row| row["figures"].as_array().unwrap());
    assert!(named.filter(|path| path.as_str().unwrap().ends_with(".svg")).count() <= drawn);
    assert_eq!(
        [&key, &trade, &extremes].map(|page| page.matches("<svg").count()).iter().sum::<usize>(),
        drawn
    );
    // what is of interest beside a question is not the figure printed with it
    for name in ["2_1_running_mean", "check_wealth"] {
        let before = key.split(&format!("figure-{name}-title")).next().unwrap();
        let [opened, closed] = ["<details>", "</details>"].map(|tag| before.matches(tag).count());
        assert_eq!(opened, closed + 1, "{name} is printed");
    }
    assert!(key.matches("<math").count() >= questions().count());
    for page in [&key, &trade, &extremes] {
        for tag in ["<script", "<link", "<img", "<iframe", "@import", "url(\"", "url(h"] {
            assert!(!page.contains(tag), "{tag}");
        }
        // ids are unique, or titles and descriptions would be read out for the wrong figure, and names in XML
        let ids: Vec<&str> = page.split(" id=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
        assert_eq!(ids.iter().collect::<BTreeSet<_>>().len(), ids.len());
        assert!(ids.iter().all(|id| id.starts_with(|c: char| c.is_ascii_alphabetic())), "{ids:?}");
        assert!(!page.contains("<th>") && !page.contains("nbsp"));
        assert_eq!(page.matches("<table").count(), page.matches("<caption").count());
    }
    // what is not checked is said in words
    let shown = rows.iter().filter(|row| row["kind"] == "demonstration" && row["estimate"].is_f64()).count();
    let words = ["wrong on purpose", "infinite variance", "not judged"];
    let said = words.map(|word| key.matches(&format!(">{word}</td>")).count());
    assert_eq!(said.iter().sum::<usize>(), shown);
}

#[test]
fn both_editions_are_made_by_one_command_and_say_which_they_are() {
    let both = run("worksheet", &["--edition", "Both", "--draws", "2000"]).well();
    let one = run("q1_2_one_sample", &["--edition", "BOTH"]).well();
    for name in ["1_2_exponential.svg", "1_2_exponential_student.svg"] {
        assert!(both.file(name) == one.file(name), "{name}");
    }
    for (name, kind) in [("student.html", "worksheet"), ("solution.html", "answer key")] {
        let page = both.file(name);
        for tag in ["title", "h1"] {
            let title = format!("<{tag}>Monte Carlo and global illumination — {kind}</{tag}>");
            assert!(page.contains(&title), "{title}");
        }
    }
    // the sheet is the one that is made alone
    assert!(both.file("student.html") == student().0.file("student.html"));
}

#[test]
fn slides_are_made_where_they_are_asked_for() {
    for (example, figures) in [("q1_2_one_sample", 1), ("extremes", 2)] {
        let ran = run(example, &["--slides", "--json"]).well();
        let rows = ran.rows();
        let named: Vec<_> = rows
            .iter()
            .flat_map(|row| row["figures"].as_array().unwrap())
            .filter_map(Value::as_str)
            .collect();
        let slides = named.iter().filter(|path| path.ends_with("_slide.svg"));
        assert_eq!(slides.count(), figures, "{example}: {named:?}");
        assert!(named.iter().all(|path| ran.folder.join(path).exists() && !path.ends_with("_slide.csv")));
    }
}

#[test]
fn figures_are_accessible_and_sized_for_print() {
    for (name, path) in worksheet().0.files().iter().filter(|(name, _)| name.ends_with(".svg")) {
        let svg = fs::read_to_string(path).unwrap();
        for part in ["<title ", "<desc ", "role=\"img\"", "aria-labelledby="] {
            assert!(svg.contains(part), "{name}: {part}");
        }
        assert!(["85", "150", "170"].iter().any(|mm| svg.contains(&format!("width=\"{mm}mm\""))), "{name}");
        // as words: "infinite" may stand in a text
        let mut words = svg.split(|c: char| !c.is_alphanumeric());
        assert!(words.all(|word| word != "NaN" && word != "inf"), "{name}");
        // 8 pt on a lattice of 960 to the inch is 106.7 units
        for size in svg.split("font-size=\"").skip(1).filter_map(|rest| rest.split('"').next()) {
            assert!(size.parse::<f64>().unwrap() >= 106.0, "{name}: text of {size} units");
        }
        let csv = fs::read_to_string(path.with_extension("csv")).unwrap();
        assert!(csv.starts_with("panel,series,x,y,low,high\n") && csv.lines().count() > 1, "{name}");
    }
}

/// With numbers of a student's own, estimators agree with their truths, and these with the key.
#[test]
fn a_variants_truths_are_those_of_its_estimators() {
    for name in ["Ada", "Łukasz Żółć"] {
        let seed = common::seed(77).to_string();
        let given = ["--variant", name, "--draws", "20000", "--seed", &seed, "--json"];
        // 4.3 takes seconds for its figures, and its rows take sets of points as draws
        let some = examples().into_iter().filter(|example| !example.starts_with("q4_3"));
        let rows: Vec<Value> = some.flat_map(|example| run(&example, &given).rows()).collect();
        let options = Values::default().variant(name, questions()).unwrap();
        let answers: Vec<&Value> = rows.iter().filter(|row| row["kind"] == "answer").collect();
        let mut compared = 0;
        for row in &answers {
            let of = |key: &str| row[key].as_f64();
            if let (Some(truth), Some(estimate), Some(error)) = (of("truth"), of("estimate"), of("std_error"))
            {
                let z = common::deviations(7.5);
                assert!((estimate - truth).abs() <= z * error + 1e-12 * truth.abs(), "{name}: {row}");
                compared += 1;
            }
        }
        assert!(compared > 30, "{name}: {compared}");
        let mut in_the_key = Vec::new();
        for question in questions() {
            for number in question.numbers.iter().filter(|number| number.over_n.is_none()) {
                let id = format!("{}{}", question.id, number.part);
                let found = answers.iter().filter(|row| row["question"] == id.as_str());
                let truths: Vec<f64> = found.filter_map(|row| row["truth"].as_f64()).collect();
                let key = question.evaluate(number.formula, &options).unwrap();
                if truths.iter().any(|truth| key.iter().any(|key| (key - truth).abs() <= 1e-12 * key.abs())) {
                    in_the_key.push(id);
                }
            }
        }
        assert_eq!(in_the_key, ["1.2", "3.1", "3.2", "5.1(i)", "5.1(ii)", "5.1(iii)", "5.2"], "{name}");
    }
}
