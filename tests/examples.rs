//! Every example runs, prints JSON that parses, agrees with its truths, and says clearly what it does not
//! understand.

mod common;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use unbiased::workbook::{self, Options};

use serde_json::Value;

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

/// A folder of this test's own under the build's.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    folder
}

fn run(example: &str, arguments: &[&str]) -> Output {
    // cargo puts examples beside the folder of the tests, and builds them before it runs any
    let tests = std::env::current_exe().unwrap();
    let program = tests.parent().and_then(Path::parent).unwrap().join("examples").join(example);
    Command::new(&program)
        .args(arguments)
        .output()
        .unwrap_or_else(|error| panic!("{}: {error}", program.display()))
}

/// The question examples, by their files.
fn examples() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let names = files.filter(|path| path.extension().is_some_and(|ending| ending == "rs"));
    let mut names: Vec<_> =
        names.map(|path| path.file_stem().unwrap().to_string_lossy().into_owned()).collect();
    names.retain(|name| name.starts_with('q'));
    names.sort();
    names
}

fn rows(output: &Output) -> Vec<Value> {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}")))
        .collect()
}

/// The whole worksheet, run once for all tests.
fn worksheet() -> &'static (PathBuf, Vec<Value>) {
    static ONCE: OnceLock<(PathBuf, Vec<Value>)> = OnceLock::new();
    ONCE.get_or_init(|| {
        let out = folder("worksheet");
        let output = run("worksheet", &["--json", "--out", out.to_str().unwrap()]);
        (out, rows(&output))
    })
}

fn student() -> &'static (PathBuf, Vec<Value>, String) {
    static ONCE: OnceLock<(PathBuf, Vec<Value>, String)> = OnceLock::new();
    ONCE.get_or_init(|| {
        let out = folder("student");
        let arguments = ["--edition", "student", "--out", out.to_str().unwrap()];
        let json = run("worksheet", &[&arguments[..], &["--json"]].concat());
        let text = run("worksheet", &[&arguments[..], &["--verbose"]].concat());
        (out.clone(), rows(&json), String::from_utf8(text.stdout).unwrap())
    })
}

fn without_seconds(mut row: Value) -> Value {
    row.as_object_mut().unwrap().remove("seconds");
    row
}

/// Whether a file may differ from run to run: it holds timings, as the page does, or is a PDF, whose library
/// numbers its objects in the order of a hash map.
fn changes(name: &str) -> bool {
    name.ends_with(".pdf")
        || name.ends_with(".html")
        || name.contains("seconds")
        || name.starts_with("trade_")
}

#[test]
fn the_worksheet_takes_in_every_example() {
    let of_examples: BTreeSet<String> = examples().iter().map(|name| name[1..4].replace('_', ".")).collect();
    let (_, rows) = worksheet();
    let of_rows: BTreeSet<String> =
        rows.iter().map(|row| row["question"].as_str().unwrap()[..3].to_owned()).collect();
    assert_eq!(of_examples, of_rows);
    let of_table: BTreeSet<String> =
        unbiased::workbook::questions().map(|question| question.id.to_owned()).collect();
    assert_eq!(of_examples, of_table);
    for question in unbiased::workbook::questions() {
        assert!(examples().contains(&question.example.to_owned()), "{}", question.example);
    }
}

#[test]
fn every_row_has_all_keys_and_every_answer_its_truth() {
    let (_, rows) = worksheet();
    assert!(rows.len() >= 30);
    for row in rows {
        let object = row.as_object().unwrap();
        assert_eq!(object.keys().collect::<BTreeSet<_>>(), KEYS.map(String::from).iter().collect(), "{row}");
        assert!(["answer", "demonstration"].contains(&row["kind"].as_str().unwrap()));
        assert!(row["parameters"].is_object() && row["figures"].is_array());
        for figure in row["figures"].as_array().unwrap() {
            assert!(fs::metadata(figure.as_str().unwrap()).unwrap().len() > 0, "{figure}");
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

#[test]
fn each_example_alone_says_what_the_worksheet_says() {
    let (_, all) = worksheet();
    for example in examples() {
        let id = example[1..4].replace('_', ".");
        let out = folder(&example);
        let alone = rows(&run(&example, &["--json", "--out", out.to_str().unwrap()]));
        let mut expected = all.iter().filter(|row| row["question"].as_str().unwrap().starts_with(&id));
        for row in alone {
            let (mut here, mut there) =
                (without_seconds(row), without_seconds(expected.next().unwrap().clone()));
            let files = |row: &mut Value| {
                let paths = row.as_object_mut().unwrap().remove("figures").unwrap();
                let names = paths.as_array().unwrap().iter().map(|path| path.as_str().unwrap().to_owned());
                names.map(PathBuf::from).collect::<Vec<_>>()
            };
            for (a, b) in files(&mut here).iter().zip(files(&mut there)) {
                assert_eq!(a.file_name(), b.file_name());
                if changes(&a.file_name().unwrap().to_string_lossy()) {
                    continue;
                }
                assert!(fs::read(a).unwrap() == fs::read(&b).unwrap(), "{} differs", a.display());
            }
            assert_eq!(here, there);
        }
        assert!(expected.next().is_none());
    }
}

#[test]
fn the_number_of_threads_cannot_be_seen() {
    let of = |example: &str, threads| {
        let out = folder(&format!("threads-{example}-{threads}"));
        let output = run(
            example,
            &["--json", "--draws", "100000", "--threads", threads, "--out", out.to_str().unwrap()],
        );
        let figures = |mut row: Value| {
            row.as_object_mut().unwrap().remove("figures");
            without_seconds(row)
        };
        rows(&output).into_iter().map(figures).collect::<Vec<_>>()
    };
    for example in ["q1_1_exponential", "q1_3_axes"] {
        let one = of(example, "1");
        for threads in ["2", "3", "8"] {
            assert_eq!(of(example, threads), one);
        }
    }
}

#[test]
fn the_worksheet_is_the_same_bytes_every_time() {
    let files = |folder: &Path| -> BTreeMap<String, Vec<u8>> {
        let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        paths
            .map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), fs::read(path).unwrap()))
            .collect()
    };
    let (first, _) = worksheet();
    let again = folder("again");
    rows(&run("worksheet", &["--json", "--out", again.to_str().unwrap()]));
    let (first, again) = (files(first), files(&again));
    assert_eq!(first.keys().collect::<Vec<_>>(), again.keys().collect::<Vec<_>>());
    for (name, bytes) in first.iter().filter(|(name, _)| !changes(name)) {
        assert!(again[name] == *bytes, "{name} differs");
    }
    // and as committed, where the repository is at hand
    let committed = Path::new(env!("CARGO_MANIFEST_DIR")).join("figures");
    if committed.exists() {
        let committed = files(&committed);
        for (name, bytes) in first.iter().filter(|(name, _)| name.ends_with(".svg") || name.ends_with(".csv"))
        {
            if changes(name) {
                continue;
            }
            assert!(committed.get(name) == Some(bytes), "figures/{name} is not what is drawn now");
        }
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
    let (out, rows, printed) = student();
    let page = fs::read_to_string(out.join("student.html")).unwrap();
    let mut texts = vec![("page", text_of(&page)), ("terminal", printed.clone())];
    for entry in fs::read_dir(out).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
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
        for question in unbiased::workbook::questions() {
            let stated = question.at(&Options::default()).unwrap();
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
    let (out, rows) = worksheet();
    let [key, trade, extremes] = ["solution", "trade", "extremes"]
        .map(|name| fs::read_to_string(out.join(format!("{name}.html"))).unwrap());
    for question in unbiased::workbook::questions() {
        let id = question.id.replace('.', "-");
        assert!(key.contains(&format!("id=\"q-{id}\"")), "{}", question.id);
        let link = format!("href=\"#q-{id}\">{} ", question.id);
        assert!(key.contains(&link), "the navigation does not name {}", question.id);
    }
    assert!(!out.join("student.html").exists() && !out.join("index.html").exists());
    for name in ["trade", "extremes"] {
        assert!(key.contains(&format!("href=\"{name}.html\"")), "{name}");
    }
    let files = fs::read_dir(out).unwrap().map(|entry| entry.unwrap().path());
    let drawn = files.filter(|path| path.extension().is_some_and(|ending| ending == "svg")).count();
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
    assert!(key.matches("<math").count() >= unbiased::workbook::questions().count());
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
    let out = folder("both");
    for (edition, example) in [("Both", "worksheet"), ("BOTH", "q1_2_one_sample")] {
        let output = run(example, &["--edition", edition, "--draws", "2000", "--out", out.to_str().unwrap()]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        for name in ["1_2_exponential.svg", "1_2_exponential_student.svg"] {
            fs::remove_file(out.join(name)).unwrap();
        }
    }
    for (name, kind) in [("student", "worksheet"), ("solution", "answer key")] {
        let page = fs::read_to_string(out.join(format!("{name}.html"))).unwrap();
        for tag in ["title", "h1"] {
            let title = format!("<{tag}>Monte Carlo and global illumination — {kind}</{tag}>");
            assert!(page.contains(&title), "{title}");
        }
    }
    // the sheet is the one that is made alone
    let (alone, _, _) = student();
    let sheet = |folder: &Path| fs::read_to_string(folder.join("student.html")).unwrap();
    assert!(sheet(alone) == sheet(&out));
}

#[test]
fn slides_are_made_where_they_are_asked_for() {
    let out = folder("slides");
    for (example, figures) in [("q1_2_one_sample", 1), ("extremes", 2)] {
        let rows = rows(&run(example, &["--slides", "--json", "--out", out.to_str().unwrap()]));
        let named: Vec<&str> = rows
            .iter()
            .flat_map(|row| row["figures"].as_array().unwrap())
            .filter_map(Value::as_str)
            .collect();
        let slides = named.iter().filter(|path| path.ends_with("_slide.svg"));
        assert_eq!(slides.count(), figures, "{example}: {named:?}");
        assert!(named.iter().all(|path| Path::new(path).exists() && !path.ends_with("_slide.csv")));
    }
}

#[test]
fn figures_are_accessible_and_sized_for_print() {
    let (out, _) = worksheet();
    let mut seen = 0;
    for entry in fs::read_dir(out).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|ending| ending != "svg") {
            continue;
        }
        seen += 1;
        let svg = fs::read_to_string(&path).unwrap();
        let name = path.display();
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
    assert!(seen >= 3, "{seen}");
}

#[test]
fn bad_input_gets_one_sentence_an_exit_code_and_leaves_nothing_behind() {
    for (example, arguments, code, part) in [
        ("q1_1_exponential", &["--rate", "0"][..], 2, "the rate λ must be positive and finite, not 0"),
        ("q1_1_exponential", &["--rate", "nan"], 2, "not NaN"),
        ("q1_1_exponential", &["--rate", "inf"], 2, "not inf"),
        ("q1_1_exponential", &["--rate", "fast"], 2, "--rate takes a number, not \"fast\""),
        ("q1_1_exponential", &["--rate", "1/x"], 2, "--rate takes a number, not \"1/x\""),
        ("q1_1_exponential", &["--rate"], 2, "missing argument"),
        ("q1_2_one_sample", &["--u", "1.5"], 2, "the probability u must be in [0, 1], not 1.5"),
        ("q1_3_axes", &["--draws", "0"], 2, "--draws takes a positive whole number, not 0"),
        ("q1_3_axes", &["--draws", "-5"], 2, "whole number"),
        ("q1_3_axes", &["--draws", "1.5"], 2, "whole number"),
        ("q1_3_axes", &["--draws", "1e-3"], 2, "whole number"),
        ("q1_3_axes", &["--draws", "1e300"], 2, "whole number"),
        ("q1_3_axes", &["--draws", "_"], 2, "whole number"),
        ("q1_3_axes", &["--draws", "inf"], 2, "whole number"),
        ("q4_1_two_bounces", &["--point", "9,9,9"], 2, "the point (9, 9, 9)"),
        ("q1_3_axes", &["--threads", "0"], 2, "--threads takes a positive whole number"),
        ("q1_3_axes", &["--seed", "x"], 2, "--seed takes a whole number"),
        (
            "q1_3_axes",
            &["--edition", "teacher"],
            2,
            "--edition is student, solution or both, not \"teacher\"",
        ),
        ("q1_3_axes", &["--u", "0.5"], 2, "there is no option --u"),
        ("q1_3_axes", &["solve"], 2, "unexpected argument"),
        ("q2_1_square", &["--x-low", "2"], 2, "must be"),
        ("q2_1_square", &["--y-high", "inf"], 2, "must be"),
        (
            "q2_1_square",
            &["--x-low=-1e300", "--x-high=1e300", "--y-low=-1e300", "--y-high=1e300"],
            2,
            "must be",
        ),
        ("q2_1_square", &["--n", "0"], 2, "must be"),
        ("q2_1_square", &["--n", "2.5"], 2, "--n takes a whole number, not 2.5"),
        ("q3_2_uniform_sky", &["--albedo", "1.1"], 2, "albedo"),
        ("q3_2_uniform_sky", &["--albedo=-0.1"], 2, "albedo"),
        (
            "q3_4_brdf_directions",
            &["--radiance", "nan"],
            2,
            "question 3.4: the radiance must be finite, not NaN",
        ),
        ("worksheet", &["--5.2.p-rr", "0"], 2, "question 5.2: "),
        ("worksheet", &["--1.1.p-rr", "0.5"], 2, "there is no option --1.1.p-rr"),
        ("q3_5_cosine_directions", &["--a=-2"], 2, "the exponent a must be above -2"),
        ("q3_6_variance", &["--width", "0"], 2, "width"),
        ("q5_1_bounces", &["--p-rr", "0"], 2, "p_rr"),
        ("q5_1_bounces", &["--p-rr", "1.2"], 2, "p_rr"),
        ("q5_1_bounces", &["--p-rr", "1"], 2, "never end"),
        ("q5_2_few_bounces", &["--albedo", "1"], 2, "albedo"),
        ("q5_3_more_bounces", &["--visibility", "2"], 2, "must be"),
        ("q5_3_more_bounces", &["--max-k", "1e12"], 2, "must be"),
        ("worksheet", &["--color"], 2, "there is no option --color"),
        (
            "q1_3_axes",
            &["--error", "1e-4", "--seconds", "2"],
            2,
            "--draws, --error and --seconds each end a run",
        ),
        ("q1_3_axes", &["--draws", "10", "--error", "1e-4"], 2, "give one of them"),
        ("worksheet", &["--seconds", "1", "--draws", "10"], 2, "give one of them"),
        ("q1_3_axes", &["--error", "0"], 2, "--error takes a positive number, not \"0\""),
        ("q1_3_axes", &["--error", "inf"], 2, "--error takes a positive number, not \"inf\""),
        ("q1_3_axes", &["--seconds", "nan"], 2, "--seconds takes a positive number, not \"nan\""),
        ("q1_3_axes", &["--seconds", "1e30"], 2, "--seconds takes a number from 1e-9 to 1e19, not \"1e30\""),
        ("q1_3_axes", &["--seconds", "1e-320"], 2, "from 1e-9 to 1e19, not \"1e-320\""),
        ("q2_1_square", &["--n", "1e300"], 2, "--n takes a whole number, not 1e300"),
        ("trade", &["--draws", "10"], 2, "trade takes no --draws: it compares estimators on one core"),
        ("trade", &["--error", "1e-2"], 2, "trade takes no --error"),
        ("trade", &["--threads", "1"], 2, "trade takes no --threads"),
        ("trade", &["--edition", "student"], 2, "trade takes no --edition"),
        ("trade", &["--hint"], 2, "trade takes no --hint"),
        ("extremes", &["--draws", "5"], 2, "extremes takes no --draws: it evaluates each formula once"),
        ("extremes", &["--seconds", "5"], 2, "extremes takes no --seconds"),
        ("extremes", &["--rate", "5"], 2, "there is no option --rate"),
    ] {
        let out = folder("bad");
        let output = run(example, &[&["--out", out.to_str().unwrap()], arguments].concat());
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{example} {arguments:?}: {message}");
        assert!(
            message.contains(part) && message.trim().lines().count() == 1,
            "{example} {arguments:?}: {message}"
        );
        assert!(!out.exists(), "{example} {arguments:?}");
        // a run that fails has begun with the question
        assert!(output.stdout.is_empty() || code == 1, "{example} {arguments:?}");
    }
}

#[test]
fn a_folder_that_cannot_be_written_is_one_sentence() {
    let file = folder("a-file");
    fs::create_dir_all(file.parent().unwrap()).unwrap();
    fs::write(&file, "not a folder").unwrap();
    let inside = file.join("inside");
    let output = run("q1_2_one_sample", &["--out", inside.to_str().unwrap()]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("could not be written") && message.trim().lines().count() == 1, "{message}");
    assert!(output.stdout.is_empty());
}

#[test]
fn help_lists_every_option() {
    for (example, own) in
        [("q1_2_one_sample", &["--rate", "--u"][..]), ("worksheet", &["--1.1.rate", "--1.2.u"])]
    {
        for flag in ["--help", "-h"] {
            let output = run(example, &[flag]);
            let text = String::from_utf8(output.stdout).unwrap();
            assert!(output.status.success());
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
        let text = String::from_utf8(run(example, &["--help"]).stdout).unwrap();
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
    let out = folder_of_its_own();
    let sky = |draws| run("q3_2_uniform_sky", &["--draws", draws, "--out", out.to_str().unwrap()]);
    let printed = [run("check_mine", &[]), sky("10000"), sky("1000000")].map(|output| output.stdout);
    let printed = printed.map(|bytes| String::from_utf8(bytes).unwrap()).concat();
    let quotes = include_str!("../README.md").split("```text\n").skip(1);
    let quotes: Vec<&str> = quotes.filter_map(|rest| Some(rest.split_once("```")?.0)).collect();
    assert!(quotes.len() >= 3);
    for line in quotes.iter().flat_map(|quote| quote.lines()) {
        assert!(printed.lines().any(|of| of == line), "{line}");
    }
}

/// A folder that no other test has, of those that run beside this one.
fn folder_of_its_own() -> PathBuf {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    folder(&format!("own-{}", COUNT.fetch_add(1, Ordering::Relaxed)))
}

/// The rows of an example under these options that hold an estimate.
fn numbers(example: &str, options: &[&str]) -> Vec<Value> {
    let out = folder_of_its_own();
    let rows = rows(&run(example, &[options, &["--json", "--out", out.to_str().unwrap()]].concat()));
    rows.into_iter().filter(|row| row["draws"].is_u64()).collect()
}

/// What an example prints, wherever its lines are broken.
fn said(example: &str, options: &[&str]) -> String {
    let out = folder_of_its_own();
    let output = run(example, &[options, &["--out", out.to_str().unwrap()]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    unfolded(&String::from_utf8(output.stdout).unwrap())
}

fn unfolded(text: &str) -> String {
    text.replace(" \\\n", " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

fn has_word(text: &str, word: &str) -> bool {
    text.split(|c: char| !c.is_alphanumeric()).any(|other| other == word)
}

/// Lines longer than a narrow terminal's.
fn too_long(text: &str) -> Vec<&str> {
    text.lines().filter(|line| line.chars().count() > 79).collect()
}

/// Figures go to a folder of a short name, since a path cannot be broken.
#[test]
fn no_line_is_wider_than_a_narrow_terminal() {
    let folder = folder_of_its_own();
    fs::create_dir_all(&folder).unwrap();
    let tests = std::env::current_exe().unwrap();
    let programs = tests.parent().and_then(Path::parent).unwrap().join("examples");
    let mut names = examples();
    names.extend(["worksheet", "trade", "extremes"].map(String::from));
    for name in names {
        let lines = |arguments: &[&str]| {
            let output =
                Command::new(programs.join(&name)).args(arguments).current_dir(&folder).output().unwrap();
            assert!(output.status.success(), "{name} {arguments:?}");
            let text = String::from_utf8(output.stdout).unwrap();
            assert!(too_long(&text).is_empty(), "{name} {arguments:?}: {:#?}", too_long(&text));
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
    let same = |mut row: Value| {
        row.as_object_mut().unwrap().remove("figures");
        without_seconds(row)
    };
    let [share] = &numbers("q1_3_axes", &["--seconds", "0.05"])[..] else { panic!() };
    assert!(share["draws"].as_u64().unwrap() >= 2 && share["seconds"].as_f64().unwrap() > 0.0, "{share}");
    let draws = share["draws"].to_string();
    let [again] = &numbers("q1_3_axes", &["--draws", &draws])[..] else { panic!() };
    assert_eq!(same(share.clone()), same(again.clone()));
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
    for question in unbiased::workbook::questions() {
        let stated = question.at(&Options::default()).unwrap();
        let output = run(question.example, &["--hint"]);
        let text = String::from_utf8(output.stdout).unwrap();
        let hint = unfolded(&format!("{} {}", question.id, stated.hint));
        assert!(output.status.success() && unfolded(&text) == hint, "{text}");
        assert!(!letters(&text).contains(&letters(&stated.formula)), "{}", question.id);
    }
    let all = String::from_utf8(run("worksheet", &["--hint"]).stdout).unwrap();
    let ids = all.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    assert_eq!(ids.count(), unbiased::workbook::questions().count());
}

/// Those that are right at these parameters are not among them: multiplying by λ at λ = 1.
#[test]
fn classic_wrong_answers_have_values_at_the_parameters() {
    let out = folder("wrong");
    let list = |example: &str, arguments: &[&str]| {
        let common = ["--draws", "1000", "--out", out.to_str().unwrap()];
        let output = run(example, &[arguments, &common].concat());
        let text = String::from_utf8(output.stdout).unwrap();
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
    let out = folder("people");
    let output = run(
        "q1_1_exponential",
        &["--rate", "2.5", "--draws", "5000", "--seed", "9", "--verbose", "--out", out.to_str().unwrap()],
    );
    let text = unfolded(&String::from_utf8(output.stdout).unwrap());
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
    ] {
        assert!(text.contains(part), "{part:?} is missing in\n{text}");
    }
    assert!(
        text.contains("cargo run --release --example q1_1_exponential -- --rate 2.5 --draws 5000 --seed 9")
    );
}

/// With numbers of a student's own, estimators agree with their truths, and these with the key.
#[test]
fn a_variants_truths_are_those_of_its_estimators() {
    for name in ["Ada", "Łukasz Żółć"] {
        let seed = common::seed(77).to_string();
        let options = ["--variant", name, "--draws", "20000", "--seed", &seed, "--json", "--out"];
        // 4.3 takes seconds for its figures, and its rows take sets of points as draws
        let some = examples().into_iter().filter(|example| !example.starts_with("q4_3"));
        let rows: Vec<Value> = some
            .flat_map(|example| {
                let out = folder_of_its_own();
                rows(&run(&example, &[&options[..], &[out.to_str().unwrap()]].concat()))
            })
            .collect();
        let options = Options::default().variant(name, workbook::questions()).unwrap();
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
        for question in workbook::questions() {
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
