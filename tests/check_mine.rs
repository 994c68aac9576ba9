//! What `check_mine` says, as a program: to one's own estimator, to draws of programs in other languages, to
//! answers worked out by hand, and to those of a class.
//!
//! Nothing here is left to chance: estimators have pinned seeds, and draws from elsewhere are samples by
//! inversion on a regular grid, or of generators with a seed.
#![cfg(feature = "workbook")]

mod common;

use std::path::Path;
use std::process::Command;

use common::programs::{Ran, folder, run_in};
use unbiased::workbook::exercise;

/// What `check_mine` says to these arguments and this standard input.
fn check_mine(arguments: &[&str], input: &str) -> (Option<i32>, String) {
    let Ran { code, out, err, .. } = run_in(folder(), "check_mine", arguments, input);
    (code, out + &err)
}

fn json(text: &str) -> Vec<serde_json::Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn written(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> String {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path.to_str().unwrap().into()
}

/// Samples by inversion on a regular grid of u.
fn samples(n: u32, f: &dyn Fn(f64) -> f64) -> String {
    (0..n).map(|i| format!("{}\n", f((f64::from(i) + 0.5) / f64::from(n)))).collect()
}

// ---- one's own estimator
// ----------------------------------------------------------------------------------------

#[test]
fn the_readers_estimator_is_judged_and_its_mistake_named() {
    for budget in [&["--draws", "200000"][..], &["--error", "2e-3"], &["--seconds", "0.5"]] {
        let (code, said) = check_mine(budget, "");
        assert_eq!(code, Some(0), "{said}");
        assert!(said.contains("consistent with:\n1. uniform directions, the cosine weight"), "{said}");
        assert!(said.contains(" draws a probe, seed 1.\nNot right"), "{said}");
        assert!(
            said.contains("To mend it: ") && said.contains("For instance on “L = cos θ, ρ = 0.8”"),
            "{said}"
        );
        assert!(said.lines().all(|line| line.chars().count() <= 79), "{said}");
    }
    let (code, said) = check_mine(&["--question", "4.3", "--draws", "200000", "--exit-code"], "");
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("seed 1.\nNothing wrong seen"), "{said}");
}

#[test]
fn a_program_gets_json_and_an_exit_code() {
    let (code, said) = check_mine(&["--draws", "100000", "--json", "--exit-code"], "");
    assert_eq!(code, Some(1));
    let [line] = &json(&said)[..] else { panic!("{said}") };
    assert_eq!((&line["verdict"], &line["seed"]), (&"wrong".into(), &1.into()));
    assert_eq!(line["mistakes"][0]["id"], "cosine-weight");
    let first = &line["probes"][0];
    assert!((first["ratio"].as_f64().unwrap() - 0.75).abs() < 0.01 && first["draws"] == 100_000);
    assert_eq!(line["counterexample"]["yours"], 0.2);
    // the right one, with 20 draws
    let few = ["--question", "4.3", "--draws", "20", "--json", "--exit-code"];
    let (code, said) = check_mine(&few, "");
    assert!(code == Some(2) && json(&said)[0]["verdict"] == "undecided", "{said}");
    for (answer, code) in [("1.386", 0), ("0.602", 1), ("1", 1), ("1.3", 0)] {
        let arguments = ["--question", "1.2", "--answer", answer, "--exit-code"];
        assert_eq!(check_mine(&arguments, "").0, Some(code), "{answer}");
    }
    let (_, said) = check_mine(&["--question", "1.2", "--answer", "0.602", "--json"], "");
    let line = &json(&said)[0];
    assert!(line["verdict"] == "wrong" && line["mistakes"][0]["id"] == "log10", "{said}");
    assert!((line["ratio"].as_f64().unwrap() - 10f64.ln().recip()).abs() < 1e-3);
}

#[test]
fn help_lists_every_option() {
    let (_, said) = check_mine(&["--help"], "");
    let options = "question answer digits draws-from probe probes template draws error seconds seed answers \
                   draws-in csv json exit-code";
    for option in options.split(' ') {
        let listed = |line: &str| line.trim_start().split(' ').next() == Some(&format!("--{option}"));
        assert!(said.lines().any(listed), "{option}");
    }
}

// ---- draws of other programs
// ------------------------------------------------------------------------------------

#[test]
fn the_sheets_own_numbers_are_probe_1() {
    let bounces = |p: f64| samples(20_000, &move |u| ((1.0 - u).ln() / p.ln()).floor());
    for (question, draws) in [
        ("1.1", samples(20_000, &|u| -(1.0 - u).ln())),
        ("5.1", bounces(0.8)),
        ("5.2", bounces(0.2)),
        // 3.5 under cos θ: ρ cos θ, with cos θ = √(1 − u); and under a constant light
        ("3.5", samples(20_000, &|u| 0.8 * (1.0 - u).sqrt())),
        ("3.2", samples(2000, &|_| 0.8)),
        ("2.1", samples(2000, &|_| 16.0)),
    ] {
        let (code, said) = check_mine(&["--question", question, "--draws-from", "-", "--exit-code"], &draws);
        assert!(code == Some(0) && said.contains("Nothing wrong seen"), "{question}: {said}");
    }
}

#[test]
fn draws_that_fit_another_probe_are_told_so() {
    let other = samples(20_000, &|u| -(1.0 - u).ln() / 0.37);
    let arguments = ["--question", "1.1", "--draws-from", "-"];
    let (_, said) = check_mine(&arguments, &other);
    let told = "The draws for probe 1 fit the truth of probe 2, “mean of X, λ = 0.37”:";
    assert!(said.replace('\n', " ").contains(told), "{said}");
    let (_, said) = check_mine(&[&arguments[..], &["--json"]].concat(), &other);
    assert_eq!(json(&said)[0]["probes"][0]["fits_probes"], serde_json::json!([2]));
    let (code, said) = check_mine(&[&arguments[..], &["--probe", "2", "--exit-code"]].concat(), &other);
    let taken = "for probe 2, “mean of X, λ = 0.37”, whose truth is 2.7";
    assert!(code == Some(0) && said.replace('\n', " ").contains(taken), "{said}");
    let (_, said) = check_mine(&arguments, &samples(20_000, &|u| -(1.0 - u).log10()));
    assert!(said.contains("1. log base 10"), "{said}");
    let (_, said) = check_mine(&arguments, &samples(20_000, &|u| -0.8 * (1.0 - u).ln()));
    assert!(said.contains("none of the 241 mistakes"), "{said}");
}

#[test]
fn several_probes_come_in_one_file_or_in_several() {
    let folder = folder();
    let rate = |rate: f64| samples(20_000, &move |u| -rate * (1.0 - u).ln());
    let files = [(1, 1.0), (2, 0.37), (3, 2.5)].map(|(probe, of)| (probe, rate(of)));
    let numbered = |(probe, draws): &(i32, String)| {
        draws.lines().map(|draw| format!("{probe} {draw}\n")).collect::<String>()
    };
    let one = written(&folder, "all.txt", files.each_ref().map(numbered).concat());
    let several: Vec<String> = files
        .iter()
        .map(|(probe, draws)| format!("{probe}={}", written(&folder, &format!("{probe}.txt"), draws)))
        .collect();
    for sources in [vec![one.as_str()], several.iter().map(String::as_str).collect()] {
        let (code, said) =
            check_mine(&[&["--question", "1.1", "--exit-code", "--draws-from"], &sources[..]].concat(), "");
        assert_eq!(code, Some(1), "{said}");
        assert!(said.contains("Draws: 20000 for probe 1, 20000 for probe 2, 20000 for probe 3."), "{said}");
        assert!(
            said.contains("1. multiplied by λ") && said.contains("Right on: mean of X, λ = 1."),
            "{said}"
        );
    }
}

#[test]
fn too_few_draws_are_no_verdict() {
    for (question, draws) in
        [("4.3", "0\n".repeat(10)), ("4.3", "0\n".repeat(1000)), ("3.5", "0.7\n0.71\n0.2\n".into())]
    {
        let (code, said) = check_mine(&["--question", question, "--draws-from", "-", "--exit-code"], &draws);
        assert!(code == Some(2) && !said.contains("Not right"), "{said}");
    }
}

/// The programs to begin with are run as they stand, and with a right estimator in the marked place, where
/// there is an interpreter or a compiler.
#[test]
fn programs_in_other_languages_run_right_and_wrong() {
    let python_right = [
        ("1.1", "    return AVERAGE[average](-math.log(1 - random.random()) / rate, rate)"),
        (
            "2.1",
            "    x, y = random.uniform(a, b), random.uniform(c, d)\n    return (b - a) * (d - c) * F[f](x, \
             y)",
        ),
        (
            "3.5",
            "    r2, phi = random.random(), 2 * math.pi * random.random()\n    r = math.sqrt(r2)\n    return \
             albedo * LIGHT[light](r * math.cos(phi), r * math.sin(phi), math.sqrt(1 - r2))",
        ),
        ("5", "    return (0.5 + random.random()) / p_rr if random.random() < p_rr else 0"),
        ("5.2", "    return math.floor(math.log(1 - random.random()) / math.log(p_rr))"),
    ];
    let cpp_right = [
        ("1.1", "    return value(average, -std::log(1 - uniform()) / rate, rate);"),
        (
            "2.1",
            "    double x = a + (b - a) * uniform(), y = c + (d - c) * uniform();\n    return (b - a) * (d - \
             c) * value(f, x, y);",
        ),
        (
            "3.5",
            "    double r2 = uniform(), r = std::sqrt(r2), phi = 2 * std::acos(-1.0) * \
             uniform();\n    return albedo * radiance(light, r * std::cos(phi), r * std::sin(phi), \
             std::sqrt(1 - r2));",
        ),
        ("5", "    double x = 0.5 + uniform();\n    return uniform() < p_rr ? x / p_rr : 0;"),
        ("5.2", "    return std::floor(std::log(1 - uniform()) / std::log(p_rr));"),
    ];
    let folder = folder();
    for (language, command, right) in [("python", "python3", python_right), ("cpp", "c++", cpp_right)] {
        if Command::new(command).arg("--version").output().is_err() {
            println!("there is no {command}: its programs are not run");
            continue;
        }
        for (question, estimator) in right {
            let (code, template) = check_mine(&["--question", question, "--template", language], "");
            assert_eq!(code, Some(0), "{template}");
            let lines = template.lines().count();
            assert!((15..=30).contains(&lines), "{question} in {language} has {lines} lines");
            assert!(template.lines().all(|line| line.chars().count() <= 120), "{template}");
            // what stands between the marks, and no more
            let (head, rest) = template.split_once("a classic mistake) ----\n").unwrap();
            let tail = rest.find(if language == "python" { "    # ---" } else { "    // ---" }).unwrap();
            let mended = format!("{head}a classic mistake) ----\n{estimator}\n{}", &rest[tail..]);
            for (program, wrong) in [(&template, true), (&mended, false)] {
                // a tenth of the draws will do
                let program = program.replace("100000", "20000");
                let (_, probes) = check_mine(&["--question", question, "--probes"], "");
                let probes = written(&folder, "probes.txt", probes);
                let run = if language == "python" {
                    vec!["python3".into(), written(&folder, "mine.py", &program)]
                } else {
                    let (source, binary) =
                        (written(&folder, "mine.cpp", &program), folder.join("mine").display().to_string());
                    let options = ["-std=c++11", "-Wall", "-Werror", "-O1", "-o", &binary, &source];
                    let built = Command::new("c++").args(options).output().unwrap();
                    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
                    vec![binary]
                };
                let input = std::fs::File::open(&probes).unwrap();
                let output = Command::new(&run[0]).args(&run[1..]).stdin(input).output().unwrap();
                assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
                let draws = written(&folder, "draws.txt", output.stdout);
                let arguments = ["--question", question, "--draws-from", &draws, "--exit-code"];
                let (code, said) = check_mine(&arguments, "");
                assert_eq!(code, Some(i32::from(wrong)), "{question} in {language}: {said}");
                assert!(!wrong || said.contains("consistent with:\n1. "), "{said}");
            }
        }
    }
}

#[test]
fn probes_say_all_that_a_program_needs() {
    for exercise in ["1.1", "2.1", "3.5", "4.3", "5", "5.1"].map(|of| exercise(of).unwrap()) {
        for question in exercise.questions() {
            let (_, text) = check_mine(&["--question", question, "--probes"], "");
            let (_, lines) = check_mine(&["--question", question, "--probes", "--json"], "");
            let lines = json(&lines);
            let data: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
            let names = text.lines().rfind(|line| line.starts_with("# probe")).unwrap();
            let names: Vec<&str> = names.split(' ').skip(2).collect();
            assert!(data.len() == exercise.probes.len() && lines.len() == data.len(), "{text}");
            for (number, ((data, line), probe)) in
                (1..).zip(data.iter().zip(&lines).zip(exercise.probes_of(question)))
            {
                let words: Vec<&str> = data.split(' ').collect();
                assert_eq!(words[0], number.to_string());
                assert_eq!(line["probe"], number);
                assert_eq!(line["truth"].as_f64(), Some(probe.truth));
                assert!(text.contains(&format!("#   {number}. {probe}: the truth is ")));
                assert_eq!(words.len(), 1 + names.len());
                for (name, word) in names.iter().zip(&words[1..]) {
                    let value = &line["parameters"][name];
                    assert!(value.as_f64() == word.parse().ok() || value == word, "{name}: {value} {word}");
                    // every word is explained
                    assert!(word.parse::<f64>().is_ok() || text.contains(&format!("{word}: ")), "{word}");
                }
            }
        }
    }
}

// ---- answers worked out by hand
// ---------------------------------------------------------------------------------

/// `by_hand.rs` has many more.
#[test]
fn numbers_worked_out_by_hand_are_judged_in_words() {
    for (arguments, words) in [
        (&["--question", "1.2", "--answer", "1.386"][..], "right to the digits given"),
        (&["--question", "1.2", "--answer", "0.602"], "logarithm to base 10"),
        (&["--question", "1.2", "--answer", "7"], "none of the known"),
        (&["--question", "5.1(ii)", "--answer", "16/125"], "right"),
        // its own parameters before and after it
        (&["--albedo", "0.5", "--question", "3.2", "--answer", "0.5"], "right to the digits given"),
        (&["--question", "3.2", "--answer", "1", "--albedo", "1/2"], "sin θ or cos θ forgotten"),
        (&["--question", "1.2", "--answer", "1.3", "--digits", "3"], "too few digits: give 3, rounded"),
    ] {
        let (code, said) = check_mine(arguments, "");
        assert!(code == Some(0) && said.contains(words), "{arguments:?}: {said}");
    }
}

// ---- a class
// ----------------------------------------------------------------------------------------------------

#[test]
fn a_class_is_judged_in_one_command() {
    let folder = folder();
    let answers = written(
        &folder,
        "answers.csv",
        "\u{feff}student,question,answer,variant\nAna,1.2,1.386,\nBo,1.2,0.602,\n\"Cy, \
         Jr\",1.2,.602,\nAna,3.2,0.5,albedo=0.5\nBo,3.2,7,\nAna,5.1(iii),5,\nBo,5.1(iii),four,\nAna,2.1,1,\n",
    );
    let draws = folder.join("draws");
    std::fs::create_dir_all(&draws).unwrap();
    written(&draws, "Ana_1.1.txt", samples(20_000, &|u| -(1.0 - u).ln()));
    written(&draws, "Bo_1.1.txt", samples(20_000, &|u| -(1.0 - u).log10()));
    written(&draws, "Cy_Jr_1.1.txt", "1\n2\n");
    written(&draws, "Di_1.1.txt", "1\nx\n");
    let both = ["--answers", &answers, "--draws-in", draws.to_str().unwrap()];
    let (code, said) = check_mine(&[&both[..], &["--json"]].concat(), "");
    assert_eq!(code, Some(0), "{said}");
    let lines = json(&said);
    let row = |student: &str, question: &str| {
        let found = lines.iter().find(|line| line["student"] == student && line["question"] == question);
        let line = found.unwrap_or_else(|| panic!("{said}"));
        let mistake = line["mistake"].as_str().unwrap_or("-").to_owned();
        (line["verdict"].as_str().unwrap().to_owned(), mistake, line["ratio"].as_f64())
    };
    let is = |found: (String, String, Option<f64>), verdict: &str, mistake: &str, ratio: Option<f64>| {
        assert_eq!((found.0.as_str(), found.1.as_str()), (verdict, mistake));
        match (found.2, ratio) {
            (Some(found), Some(ratio)) => assert!((found - ratio).abs() < 1e-3, "{found} {ratio}"),
            (found, ratio) => assert_eq!(found, ratio),
        }
    };
    is(row("Ana", "1.2"), "right", "-", Some(1.0));
    is(row("Bo", "1.2"), "wrong", "log10", Some(std::f64::consts::LOG10_E));
    is(row("Cy, Jr", "1.2"), "wrong", "log10", Some(std::f64::consts::LOG10_E));
    is(row("Ana", "3.2"), "right", "-", Some(1.0));
    is(row("Bo", "3.2"), "wrong", "-", Some(8.75));
    is(row("Bo", "5.1(iii)"), "not judged", "-", None);
    is(row("Ana", "1.1"), "right", "-", Some(1.0));
    is(row("Bo", "1.1"), "wrong", "log10", Some(std::f64::consts::LOG10_E));
    is(row("Cy_Jr", "1.1"), "undecided", "-", Some(1.5));
    is(row("Di", "1.1"), "not judged", "-", None);
    let summary: Vec<_> = lines.iter().filter(|line| line["students"].is_number()).collect();
    assert!(summary[0]["students"] == 2 && summary[0]["mistake"] == "log10", "{said}");

    let (_, table) = check_mine(&both, "");
    assert!(table.contains("12 answers: 3 right, 6 wrong, 1 undecided, 2 not judged."), "{table}");
    assert!(table.lines().all(|line| line.chars().count() <= 79), "{table}");
    let (_, csv) = check_mine(&[&both[..], &["--csv"]].concat(), "");
    assert!(csv.starts_with("student,question,verdict,mistake,ratio,reason\nAna,1.2,right,,"), "{csv}");
    assert_eq!(csv.lines().count(), 13);
    assert!(csv.contains("\n\"Cy, Jr\",1.2,wrong,log10,0.434"), "{csv}");
    let (code, _) = check_mine(&[&both[..], &["--exit-code"]].concat(), "");
    assert_eq!(code, Some(2));
}

/// The numbers of a student's own sheet.
#[test]
fn variants_are_known_by_name() {
    use unbiased::question::Values;
    use unbiased::workbook::question;
    let question = question("5.2").unwrap();
    let ada = Values::default().variant("Ada", [question]).unwrap();
    let [right, coins] =
        ["p_rr/(1 − p_rr)", "1/(1 − p_rr)"].map(|of| question.evaluate(of, &ada).unwrap()[0].to_string());
    for (answer, code) in [(&right, 0), (&coins, 1)] {
        let arguments = ["--question", "5.2", "--variant", "Ada", "--answer", answer, "--exit-code"];
        let (found, said) = check_mine(&arguments, "");
        assert_eq!(found, Some(code), "{said}");
    }
    let folder = folder();
    let text = format!("student,question,answer,variant\nAda,5.2,{right},Ada\nBo,5.2,{right},Bo\n");
    let (_, said) = check_mine(&["--answers", &written(&folder, "a.csv", text), "--csv"], "");
    assert!(said.contains("Ada,5.2,right") && said.contains("Bo,5.2,wrong"), "{said}");
}

#[test]
fn what_cannot_be_judged_is_said_in_one_sentence() {
    let folder = folder();
    let csv = |name: &str, text: &str| written(&folder, name, text);
    let missing = csv("missing.csv", "student,answer\nAna,1\n");
    let unknown = csv("unknown.csv", "student,question,answer\nAna,1.2,1\nBo,9.9,1\n");
    let twice = csv("twice.csv", "student,question,answer\nAna,1.2,1\nBo,1.2,1\nAna,1.2,2\n");
    let nobody = csv("nobody.csv", "student,question,answer\n,1.2,1\n");
    let variant = csv("variant.csv", "student,question,answer,variant\nAna,1.2,1,u=0.3 rate\n");
    let bytes = written(&folder, "bytes.csv", b"student,question,answer\nAna,1.2,\xff\xfe\n");
    let draws = folder.join("draws");
    std::fs::create_dir_all(&draws).unwrap();
    written(&draws, "nameless.txt", "1\n");
    let draws = draws.to_str().unwrap().to_owned();
    let from = |question: &'static str| ["--question", question, "--draws-from", "-"];
    for (arguments, input, part) in [
        (&["--question", "1.3"][..], "", "question 1.3 has no estimator to check; these have: 1.1, 1.2, 2.1"),
        (&["--question", "5.1"], "", "about “number of bounces”"),
        (&["--question", "1.2", "--answer", "many"], "", "the answer \"many\" is not understood"),
        (&["--question", "9.9", "--answer", "1"], "", "9.9"),
        (&from("1.1"), "1.0\nx\n", "line 2 of the draws is no draw: \"x\""),
        (&from("1.1"), "1.0\nNaN\n", "line 2 of the draws is no draw"),
        (&from("1.1"), "", "there are no draws to judge"),
        (&["--question", "1.1", "--draws-from", "no-such-file"], "", "could not be read"),
        (&["--question", "1.1", "--draws-from", "1=a.txt", "1=b.txt"], "", "two files of draws for probe 1"),
        (
            &[&from("1.1")[..], &["--probe", "99"]].concat(),
            "1\n",
            "is for probe 99; this question has probes 1 to 6",
        ),
        (&["--draws-from", "1=a", "2=b", "--probe", "1"], "", "--probe works with one file of draws only"),
        (&["--question", "4.3", "--template", "cpp"], "", "question 4.3 has no template program"),
        (&["--template", "cobol"], "", "--template is python or cpp, not \"cobol\""),
        (&["--colour"], "", "--colour"),
        (&["--draws", "10", "--error", "0.1"], "", "give one of them"),
        (
            &["--question", "1.2", "--answer", "1", "--draws", "10"],
            "",
            "--answer and --draws cannot be combined",
        ),
        (
            &["--question", "1.2", "--answer", "1", "--draws-from", "-"],
            "",
            "--answer and --draws-from cannot be combined",
        ),
        (
            &["--question", "1.1", "--seconds", "1", "--draws-from", "-"],
            "1\n2\n",
            "--draws-from and --seconds cannot be combined",
        ),
        (&["--question", "3.2", "--answer", "1", "--rate", "2"], "", "there is no option --rate"),
        (&["--question", "3.2", "--answer", "1", "--albedo", "2"], "", "the albedo ρ must be"),
        (&["--question", "5.1", "--answer", "4"], "", "5.1 asks for 5.1(i), 5.1(ii), 5.1(iii)"),
        (&["--albedo", "0.5"], "", "it needs --answer"),
        (&["--probe", "2"], "", "--probe needs --draws-from"),
        (&["--digits", "3"], "", "--digits needs --answer"),
        (&["--csv"], "", "--csv needs --answers or --draws-in"),
        (&["--answers", &missing], "", "has no column question; it needs student, question, answer"),
        (&["--answers", &unknown], "", "line 3: there is no question 9.9"),
        (&["--answers", &twice], "", "line 2 and line 4 both answer 1.2 for Ana: keep one of them"),
        (&["--answers", &nobody], "", "line 2: there is no student"),
        (&["--answers", &variant], "", "line 2: the variant \"rate\" is not of the form name=value"),
        (&["--answers", &bytes], "", "could not be read"),
        (&["--answers", "no-such.csv"], "", "no-such.csv could not be read"),
        (&["--draws-in", &draws], "", "nameless.txt is not named STUDENT_QUESTION.txt"),
        (&["--draws-in", "no-such-folder"], "", "no-such-folder could not be read"),
    ] {
        let (code, said) = check_mine(arguments, input);
        assert_eq!(code, Some(2), "{arguments:?}: {said}");
        assert!(said.contains(part) && said.trim().lines().count() == 1, "{arguments:?}: {said}");
    }
}
