//! The notebooks are true: their cells compile and run in order as one program, and print what is stored in
//! them. No Jupyter is needed.
//!
//! All of them are compiled by one call of rustc, against the library that this very test is linked with.

use std::any::TypeId;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::SystemTime;

use serde_json::{Value, json};
use unbiased::workbook;

/// Begins what a cell prints.
const MARK: char = '\u{1e}';

struct Cell {
    id: String,
    code: bool,
    source: String,
    metadata: Value,
    outputs: Vec<Value>,
}

impl Cell {
    fn is(&self, tag: &str) -> bool {
        self.metadata["tags"].as_array().is_some_and(|tags| tags.iter().any(|own| own == tag))
    }

    /// What is stored as its output.
    fn stored(&self) -> Printed {
        let (mut shown, mut text) = (Printed::new(), String::new());
        for output in &self.outputs {
            match output["output_type"].as_str() {
                Some("stream") if output["name"] == "stdout" => text += &joined(&output["text"]),
                Some("execute_result") => {
                    let data = output["data"].as_object().unwrap().iter();
                    shown.extend(data.map(|(kind, content)| (kind.clone(), joined(content))));
                }
                other => panic!("cell {} has an output of type {other:?}: {output}", self.id),
            }
        }
        with_text(shown, &text)
    }
}

/// Content by media type; printed text under `stdout`.
type Printed = BTreeMap<String, String>;

fn with_text(mut shown: Printed, text: &str) -> Printed {
    if !text.trim_end().is_empty() {
        shown.insert("stdout".into(), text.trim_end().into());
    }
    shown
}

struct Notebook {
    name: String,
    section: char,
    bytes: usize,
    metadata: Value,
    cells: Vec<Cell>,
}

impl Notebook {
    fn code(&self) -> impl Iterator<Item = &Cell> {
        self.cells.iter().filter(|cell| cell.code)
    }

    fn tagged(&self, tag: &str) -> &Cell {
        self.cells
            .iter()
            .find(|cell| cell.is(tag))
            .unwrap_or_else(|| panic!("{}: no cell “{tag}”", self.name))
    }

    fn prose(&self) -> String {
        self.cells.iter().filter(|cell| !cell.code).map(|cell| cell.source.clone() + "\n").collect()
    }
}

/// Text, or its lines.
fn joined(lines: &Value) -> String {
    match lines {
        Value::String(text) => text.clone(),
        lines => lines.as_array().unwrap().iter().map(|line| line.as_str().unwrap()).collect(),
    }
}

fn notebooks() -> Vec<Notebook> {
    let mut paths: Vec<PathBuf> =
        fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "ipynb"));
    paths.sort();
    paths.iter().map(|path| read(path)).collect()
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("notebooks")
}

fn read(path: &Path) -> Notebook {
    let text = fs::read_to_string(path).unwrap();
    let json: Value = serde_json::from_str(&text).unwrap();
    let cells = json["cells"].as_array().unwrap().iter().map(|cell| Cell {
        id: cell["id"].as_str().unwrap().into(),
        code: cell["cell_type"] == "code",
        source: joined(&cell["source"]),
        metadata: cell["metadata"].clone(),
        outputs: cell["outputs"].as_array().cloned().unwrap_or_default(),
    });
    let name = path.file_name().unwrap().to_str().unwrap().to_owned();
    let section = name.chars().next().unwrap();
    Notebook { name, section, bytes: text.len(), metadata: json["metadata"].clone(), cells: cells.collect() }
}

/// A cell as statements: the kernel's own commands dropped, and what it ends in shown.
///
/// The last statement begins at the last line that is neither indented nor a closing bracket. It is a value
/// to be shown where it ends neither in `;` nor, unless it is a block, in `}`.
fn statements(cell: &str) -> String {
    let lines: Vec<&str> = cell.lines().filter(|line| !line.starts_with(':')).collect();
    let begins = |line: &&str| line.starts_with(|c: char| !c.is_whitespace() && !")]}".contains(c));
    let last = lines.iter().rposition(begins).unwrap_or(0);
    let (before, last) = (lines[..last].join("\n"), lines[last..].join("\n"));
    let shown = !last.trim_end().ends_with([';', '}']) || last.starts_with('{');
    if shown { format!("{before}\n({last}).evcxr_display();\n") } else { format!("{before}\n{last}\n") }
}

/// Estimators for the marked cells: one that is right, what to replace in it by what to make it wrong, and
/// what is said of the wrong one.
const TURNS: [(char, &str, [&str; 2], &str); 5] = [
    ('1', "-(1.0 - rng.uniform()).ln() / p.rate", ["/ p.rate", "* p.rate"], "multiplied by λ"),
    (
        '2',
        "let [[a, b], [c, d]] = p.ends();
         let (u, v) = (rng.uniform(), rng.uniform());
         p.rectangle.area() * p.f(a + (b - a) * u, c + (d - c) * v)",
        ["* v", "* u"],
        "the same U for x and y",
    ),
    (
        '3',
        "let cos_theta = (1.0 - rng.uniform()).sqrt();
         p.albedo * p.light(&Direction::polar(cos_theta, std::f64::consts::TAU * rng.uniform()).unwrap())",
        [".sqrt()", ""],
        "uniform directions, the cosine weight",
    ),
    (
        '4',
        "let (room, bounces) = (&p.room, p.bounces());
         let (mut vertex, mut throughput, mut light) = (room.point(), 1.0, 0.0);
         for bounce in 0..=*bounces.end() {
             if bounces.contains(&bounce) {
                 light += throughput * room.emitted(&vertex);
             }
             let direction = Hemisphere::Cosine.direction_of(rng.uniform(), rng.uniform()).unwrap();
             throughput *= room.albedo(&vertex);
             let Some(hit) = nearest_hit(&vertex, vertex.to_room(&direction)) else { break };
             vertex = hit;
         }
         light",
        ["albedo(&vertex)", "albedo(&room.point())"],
        "p's albedo at every vertex",
    ),
    (
        '5',
        "if rng.uniform() < p.p_rr { p.x(rng) / p.p_rr } else { 0.0 }",
        [" / p.p_rr", ""],
        "no compensation",
    ),
];

fn turn(notebook: &Notebook) -> (char, &'static str, [&'static str; 2], &'static str) {
    TURNS.into_iter().find(|(section, ..)| *section == notebook.section).expect("an estimator to try")
}

/// The cell to be filled in, filled in.
fn filled(notebook: &Notebook, body: &str) -> String {
    let empty = &notebook.tagged("your-turn").source;
    assert_eq!(empty.matches("f64::NAN").count(), 1, "{empty}");
    let [setup, check] = ["setup", "check"].map(|tag| statements(&notebook.tagged(tag).source));
    [setup, statements(&empty.replace("f64::NAN", body)), check].concat()
}

/// All notebooks as one program, which runs the part that it is told to.
fn program() -> String {
    let mut functions = String::new();
    let mut parts = String::new();
    let mut add = |name: String, body: &str| {
        functions +=
            &format!("fn {name}() -> Result<(), Box<dyn std::error::Error>> {{\n{body}\nOk(())\n}}\n");
        parts += &format!("Some(\"{name}\") => {name}(),\n");
    };
    for notebook in notebooks() {
        let cells = notebook
            .code()
            .map(|cell| format!("println!(\"{MARK}{}\");\n{}", cell.id, statements(&cell.source)));
        add(format!("cells_{}", notebook.section), &cells.collect::<String>());
        let (_, right, [good, bad], _) = turn(&notebook);
        add(format!("right_{}", notebook.section), &filled(&notebook, right));
        add(format!("wrong_{}", notebook.section), &filled(&notebook, &right.replace(good, bad)));
    }
    format!(
        "#![allow(warnings)]
        {functions}
        fn main() -> Result<(), Box<dyn std::error::Error>> {{
            match std::env::args().nth(1).as_deref() {{
                {parts}
                _ => {{
                    println!(\"{{:?}}\", std::any::TypeId::of::<unbiased::Estimate>());
                    Ok(())
                }}
            }}
        }}"
    )
}

/// The program, compiled once for all tests.
fn compiled() -> &'static Path {
    static ONCE: OnceLock<PathBuf> = OnceLock::new();
    ONCE.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("notebooks");
        fs::create_dir_all(&folder).unwrap();
        let (source, binary) = (folder.join("notebooks.rs"), folder.join("notebooks"));
        fs::write(&source, program()).unwrap();
        let tests = std::env::current_exe().unwrap();
        let libraries = tests.parent().unwrap();
        // every set of features has a library of its own here; the newest is tried first
        let mut candidates: Vec<(SystemTime, PathBuf)> = fs::read_dir(libraries)
            .unwrap()
            .map(|entry| entry.unwrap())
            .filter(|entry| {
                let name = entry.file_name().to_string_lossy().into_owned();
                name.starts_with("libunbiased-") && name.ends_with(".rlib")
            })
            .map(|entry| (entry.metadata().unwrap().modified().unwrap(), entry.path()))
            .collect();
        candidates.sort();
        let mut complaints = String::new();
        for (_, library) in candidates.iter().rev() {
            let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
            let output = Command::new(rustc)
                .args(["--edition=2024", "-Copt-level=1", "-Ccodegen-units=16", "--crate-name=notebooks"])
                .arg(format!("-Ldependency={}", libraries.display()))
                .arg(format!("--extern=unbiased={}", library.display()))
                .arg(&source)
                .arg("-o")
                .arg(&binary)
                .output()
                .unwrap();
            if !output.status.success() {
                complaints +=
                    &format!("{}:\n{}\n", library.display(), String::from_utf8_lossy(&output.stderr));
                continue;
            }
            // a type's number tells libraries apart that were built in different ways
            let own = format!("{:?}", TypeId::of::<unbiased::Estimate>());
            if run(&binary, "").trim() == own {
                return binary;
            }
            complaints += &format!("{}: not the library of this test\n", library.display());
        }
        panic!("the notebooks' cells do not compile:\n{complaints}")
    })
}

fn run(binary: &Path, part: &str) -> String {
    let output = Command::new(binary).arg(part).output().unwrap();
    let [out, error] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    assert!(output.status.success() && error.is_empty(), "{part}: {error}\nafter:\n{out}");
    out
}

/// What a program prints, cut at the marks, the shown content apart from the rest.
fn parsed(printed: &str) -> BTreeMap<String, Printed> {
    let cells = printed.split(MARK).skip(1).map(|part| {
        let (id, mut rest) = part.split_once('\n').unwrap();
        let (mut shown, mut text) = (Printed::new(), String::new());
        while let Some((before, after)) = rest.split_once("EVCXR_BEGIN_CONTENT ") {
            let (kind, after) = after.split_once('\n').unwrap();
            let (content, after) = after.split_once("\nEVCXR_END_CONTENT\n").unwrap();
            text += before;
            shown.insert(kind.into(), content.into());
            rest = after;
        }
        (id.into(), with_text(shown, &(text + rest)))
    });
    cells.collect()
}

#[test]
fn the_cells_print_what_is_stored() {
    let mut compared = 0;
    for notebook in notebooks() {
        let printed = parsed(&run(compiled(), &format!("cells_{}", notebook.section)));
        assert_eq!(printed.len(), notebook.code().count(), "{}", notebook.name);
        for cell in notebook.code().filter(|cell| !cell.is("timing")) {
            let (stored, printed) = (cell.stored(), &printed[&cell.id]);
            let name = &notebook.name;
            assert_eq!(
                stored, *printed,
                "{name}, cell {}: stored, printed; notebooks/run stores anew",
                cell.id
            );
            compared += usize::from(!stored.is_empty());
        }
    }
    assert!(compared >= 5 * 7, "only {compared} cells print anything");
}

#[test]
fn ones_own_estimator_is_missing_mistaken_or_right() {
    for notebook in notebooks() {
        let said = |part: &str| {
            let printed = run(compiled(), &format!("{part}_{}", notebook.section));
            parsed(&format!("{MARK}cell\n{printed}"))["cell"]["text/plain"].clone()
        };
        let right = said("right");
        assert!(right.starts_with("Unbiased within") && right.contains("Nothing wrong seen"), "{right}");
        let (_, _, _, mistake) = turn(&notebook);
        let wrong = said("wrong");
        assert!(wrong.starts_with("Not right.") && wrong.contains(mistake), "{wrong}");
        let unwritten = &notebook.tagged("check").stored()["text/plain"];
        assert!(unwritten.starts_with("Missing"), "{unwritten}");
    }
}

#[test]
fn the_notebooks_have_their_parts() {
    let notebooks = notebooks();
    let sections: String = notebooks.iter().map(|notebook| notebook.section).collect();
    assert_eq!(sections, "12345");
    for notebook in &notebooks {
        let name = &notebook.name;
        assert!(notebook.bytes <= 1_500_000, "{name}: {} bytes", notebook.bytes);
        let count = notebook.cells.len();
        assert!((12..=20).contains(&count), "{name}: {count} cells");
        // for the colours; without versions, which differ from machine to machine
        let language = json!({
            "kernelspec": {"display_name": "Rust", "language": "rust", "name": "rust"},
            "language_info": {"name": "rust", "mimetype": "text/rust", "file_extension": ".rs",
                "pygments_lexer": "rust", "codemirror_mode": "rust"},
        });
        assert_eq!(notebook.metadata, language, "{name}");
        // else a panic would pass for a success
        let setup = notebook.code().next().unwrap();
        assert!(setup.is("setup") && setup.source.starts_with(":preserve_vars_on_panic 0\n"), "{name}");
        for cell in notebook.code() {
            let dependencies: Vec<_> = cell.source.lines().filter(|line| line.starts_with(":dep")).collect();
            let allowed = if cell.is("setup") { vec![":dep unbiased = { path = \"..\" }"] } else { vec![] };
            assert_eq!(dependencies, allowed, "{name}, cell {}", cell.id);
            let lines = cell.source.lines().count();
            assert!(lines <= 16, "{name}, cell {}: {lines} lines", cell.id);
            assert!(cell.is("your-turn") || !cell.outputs.is_empty(), "{name}, cell {} was not run", cell.id);
        }
        for tag in ["your-turn", "check", "timing"] {
            notebook.tagged(tag);
        }
        let figures = notebook
            .code()
            .filter(|cell| cell.stored().get("text/html").is_some_and(|html| html.contains("<img ")));
        assert!(figures.count() >= 2, "{name}: few figures");
        let prose = notebook.prose();
        let parts =
            ["**Try:**", "## Your turn", "## An extreme", "## What a second buys", "**To take away:**"];
        for part in parts {
            assert!(prose.contains(part), "{name}: no “{part}”");
        }
        // the questions in the workbook's words, its answers in its formulas, the way to the worked answers
        for question in workbook::questions().filter(|question| question.id.starts_with(notebook.section)) {
            let (id, stated) = (question.id, question.at(&workbook::Options::default()).unwrap());
            let title = format!("\n## {id} {}\n", stated.title);
            for said in [Some(&title), Some(&stated.statement), stated.on_the_original.as_ref()] {
                assert!(said.is_none_or(|said| plain(&prose).contains(&plain(said))), "{id}: no “{said:?}”");
            }
            let (_, part) = prose.split_once(&format!("## {id} ")).unwrap();
            let answer = between(part, &format!("<summary>Answer to {id}</summary>"), "</details>");
            for latex in &stated.latex {
                // in the source it may be in two lines
                let latex = latex.split_whitespace().collect::<Vec<_>>().join(" ");
                assert!(answer.contains(&format!("$${latex}$$")), "{id}: no $${latex}$$");
            }
            let example = format!("../examples/{}.rs", question.example);
            assert!(prose.contains(&example), "{id}: no {example}");
        }
    }
}

/// What is between two others, for the first time; nothing where they are missing.
fn between<'t>(text: &'t str, from: &str, to: &str) -> &'t str {
    text.split_once(from).and_then(|(_, rest)| rest.split_once(to)).unwrap_or_default().0
}

/// The workbook's plain text and a notebook's LaTeX in one spelling, without spaces and brackets.
fn plain(text: &str) -> String {
    let letters = ["λ lambda", "ρ rho", "ω omega", "θ theta", "φ varphi", "π pi", "∫ int", "× times", "≥ ge"];
    let mut text = text.replace("\\,", "").replace("\\mathbf", "");
    for (letter, name) in letters.iter().filter_map(|letter| letter.split_once(' ')) {
        text = text.replace(&format!("\\{name}"), letter);
    }
    for (raised, spelt) in [("²", "^2"), ("⁻¹", "^−1"), ("-", "−")] {
        text = text.replace(raised, spelt);
    }
    text.retain(|c| !c.is_whitespace() && !"$\\(){}'′".contains(c));
    text
}

#[test]
fn formulas_are_latex() {
    for notebook in notebooks() {
        for cell in notebook.cells.iter().filter(|cell| !cell.code) {
            let uncoded: String = cell.source.split('`').step_by(2).collect();
            let parts = uncoded.replace("$$", "$");
            let parts: Vec<_> = parts.split('$').collect();
            assert!(parts.len() % 2 == 1, "{}, cell {}: an odd $", notebook.name, cell.id);
            for part in parts.iter().step_by(2) {
                let typed = part.contains(|c| ('Α'..='ω').contains(&c) || "²ₙᵢ∫√≤≥×−^=".contains(c));
                assert!(!typed, "{}, cell {}: {part}", notebook.name, cell.id);
            }
        }
    }
}

#[test]
fn a_prediction_is_asked_for_before_each_folded_output() {
    for notebook in notebooks() {
        let mut asked = false;
        for cell in &notebook.cells {
            let at = format!("{}, cell {}", notebook.name, cell.id);
            if !cell.code {
                asked = cell.source.contains("**Predict");
                continue;
            }
            let open = ["setup", "your-turn", "check", "open"].iter().any(|tag| cell.is(tag));
            // as JupyterLab and as the classic notebook spell it
            for folded in [&cell.metadata["jupyter"]["outputs_hidden"], &cell.metadata["collapsed"]] {
                assert_eq!(folded.as_bool(), (!open).then_some(true), "{at}: folded");
            }
            assert!(open || asked, "{at}: no prediction");
        }
    }
}

#[test]
fn everything_shown_is_described() {
    for notebook in notebooks() {
        assert!(
            !notebook.prose().contains("![](") && !notebook.prose().contains("<img"),
            "{}",
            notebook.name
        );
        for (cell, shown) in notebook.code().map(|cell| (&cell.id, cell.stored())) {
            assert_eq!(shown.contains_key("text/plain"), shown.contains_key("text/html"), "{cell}");
            assert!(
                shown.keys().all(|kind| ["stdout", "text/plain", "text/html"].contains(&&**kind)),
                "{cell}"
            );
            let html = shown.get("text/html").map_or("", |html| html);
            for image in html.split("<img ").skip(1) {
                assert!(between(image, "alt=\"", "\"").len() >= 40, "{cell}: {image:.200}");
            }
            assert_eq!(html.matches("<table").count(), html.matches("<caption").count(), "{cell}");
            assert!(!html.contains("<svg"), "{cell}");
        }
    }
}

#[test]
fn links_lead_somewhere() {
    let mut links = 0;
    for notebook in notebooks() {
        for link in notebook.prose().split("](").skip(1) {
            let (target, _) = link.split_once(')').unwrap();
            assert!(folder().join(target).exists(), "{}: {target}", notebook.name);
            links += 1;
        }
    }
    assert!(links >= 5 * 2);
}

/// The numbers of a text, without signs.
fn numbers(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_ascii_digit() && c != '.').map(|word| word.trim_matches('.'))
}

/// A decimal number in the text is in the code, in what a cell prints, or in the question itself.
#[test]
fn every_number_in_prose_is_produced_by_a_cell() {
    for notebook in notebooks() {
        let mut known: String = notebook.code().map(|cell| cell.source.clone() + "\n").collect();
        for cell in notebook.code().filter(|cell| !cell.is("timing")) {
            known += &cell.stored().into_values().collect::<Vec<_>>().join("\n");
        }
        let questions: Vec<_> = workbook::questions().collect();
        for question in &questions {
            let stated = question.at(&workbook::Options::default()).unwrap();
            known += &[stated.statement, stated.on_the_original.unwrap_or_default()].concat();
            known += &stated.latex.concat();
        }
        let known: BTreeSet<&str> = numbers(&known).collect();
        for number in numbers(&notebook.prose()) {
            let is_a_question = questions.iter().any(|question| question.id == number);
            if number.contains('.') && !is_a_question {
                assert!(known.contains(number), "{}: {number} comes from no cell", notebook.name);
            }
        }
    }
}
