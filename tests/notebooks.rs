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

use serde_json::Value;
use unbiased::workbook;

/// Begins what a cell prints.
const MARK: char = '\u{1e}';

struct Cell {
    id: String,
    code: bool,
    source: String,
    tags: Vec<String>,
    outputs: Vec<Value>,
}

impl Cell {
    fn is(&self, tag: &str) -> bool {
        self.tags.iter().any(|own| own == tag)
    }

    /// What is stored as printed, and as shown: by media type.
    fn stored(&self) -> Printed {
        let mut printed = Printed::default();
        for output in &self.outputs {
            match output["output_type"].as_str() {
                Some("stream") if output["name"] == "stdout" => printed.text += &joined(&output["text"]),
                Some("execute_result") => {
                    for (kind, content) in output["data"].as_object().unwrap() {
                        printed.shown.insert(kind.clone(), joined(content));
                    }
                }
                other => panic!("cell {} has an output of type {other:?}: {output}", self.id),
            }
        }
        printed.text.truncate(printed.text.trim_end().len());
        printed
    }
}

struct Notebook {
    name: String,
    section: char,
    bytes: u64,
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
}

#[derive(Debug, Default, PartialEq)]
struct Printed {
    text: String,
    shown: BTreeMap<String, String>,
}

fn joined(lines: &Value) -> String {
    match lines {
        Value::String(text) => text.clone(),
        Value::Array(lines) => lines.iter().map(|line| line.as_str().unwrap()).collect(),
        other => panic!("not text: {other}"),
    }
}

fn notebooks() -> Vec<Notebook> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("notebooks");
    let mut paths: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "ipynb"));
    paths.sort();
    paths.iter().map(|path| read(path)).collect()
}

fn read(path: &Path) -> Notebook {
    let text = fs::read_to_string(path).unwrap();
    let json: Value = serde_json::from_str(&text).unwrap();
    let cells = json["cells"].as_array().unwrap().iter().map(|cell| {
        let tags = cell["metadata"]["tags"].as_array().cloned().unwrap_or_default();
        Cell {
            id: cell["id"].as_str().unwrap().into(),
            code: cell["cell_type"] == "code",
            source: joined(&cell["source"]),
            tags: tags.iter().map(|tag| tag.as_str().unwrap().into()).collect(),
            outputs: cell["outputs"].as_array().cloned().unwrap_or_default(),
        }
    });
    let name = path.file_name().unwrap().to_str().unwrap().to_owned();
    let section = name.chars().next().unwrap();
    Notebook { name, section, bytes: text.len() as u64, cells: cells.collect() }
}

/// A cell as statements: the kernel's own commands dropped, and what it ends in shown.
///
/// The last statement begins at the last line that is neither indented nor a closing bracket; it is a value
/// to be shown where it ends neither in `;` nor, unless it is a block, in `}`.
fn statements(cell: &str) -> String {
    let lines: Vec<&str> = cell.lines().filter(|line| !line.starts_with(':')).collect();
    let begins = |line: &&str| line.starts_with(|c: char| !c.is_whitespace() && !")]}".contains(c));
    let last = lines.iter().rposition(begins).unwrap_or(0);
    let (before, last) = (lines[..last].join("\n"), lines[last..].join("\n"));
    let shown = !last.trim_end().ends_with([';', '}']) || last.starts_with('{');
    if shown { format!("{before}\n({last}).evcxr_display();\n") } else { format!("{before}\n{last}\n") }
}

fn function(name: &str, body: &str) -> String {
    format!("fn {name}() -> Result<(), Box<dyn std::error::Error>> {{\n{body}\nOk(())\n}}\n")
}

/// One's own estimators, to be written into the marked cells: right, and wrong, with what is said of the
/// wrong one.
const TURNS: [(char, &str, &str, &str); 5] = [
    ('1', "-(1.0 - rng.uniform()).ln() / p.rate", "-(1.0 - rng.uniform()).ln() * p.rate", "multiplied by λ"),
    (
        '2',
        "let [[a, b], [c, d]] = p.ends();
         p.rectangle.area() * p.f(a + (b - a) * rng.uniform(), c + (d - c) * rng.uniform())",
        "let [[a, b], [c, d]] = p.ends();
         let u = rng.uniform();
         p.rectangle.area() * p.f(a + (b - a) * u, c + (d - c) * u)",
        "the same U for x and y",
    ),
    (
        '3',
        "let cos_theta = (1.0 - rng.uniform()).sqrt();
         p.albedo * p.light(&Direction::polar(cos_theta, std::f64::consts::TAU * rng.uniform()).unwrap())",
        "let cos_theta = 1.0 - rng.uniform();
         p.albedo * p.light(&Direction::polar(cos_theta, std::f64::consts::TAU * rng.uniform()).unwrap())",
        "uniform directions, the cosine weight",
    ),
    ('4', PATHS, "// one albedo for all\nPATHS", "p's albedo at every vertex"),
    (
        '5',
        "if rng.uniform() < p.p_rr { p.x(rng) / p.p_rr } else { 0.0 }",
        "if rng.uniform() < p.p_rr { p.x(rng) } else { 0.0 }",
        "no compensation",
    ),
];

const PATHS: &str = "let (room, bounces) = (&p.room, p.bounces());
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
    light";

/// The cell to be filled in, filled in.
fn filled(notebook: &Notebook, body: &str) -> String {
    let body = body.replace("PATHS", &PATHS.replace("room.albedo(&vertex)", "room.albedo(&room.point())"));
    let empty = &notebook.tagged("your-turn").source;
    assert_eq!(empty.matches("f64::NAN").count(), 1, "{empty}");
    let cells = [
        &notebook.tagged("setup").source,
        &empty.replace("f64::NAN", &body),
        &notebook.tagged("check").source,
    ];
    cells.map(|cell| statements(cell)).concat()
}

/// All notebooks as one program, which runs the part that it is told to.
fn program() -> String {
    let mut functions = String::new();
    let mut parts = String::new();
    let mut add = |name: String, body: &str| {
        functions += &function(&name, body);
        parts += &format!("Some(\"{name}\") => {name}(),\n");
    };
    for notebook in notebooks() {
        let cells = notebook
            .code()
            .map(|cell| format!("println!(\"{MARK}{}\");\n{}", cell.id, statements(&cell.source)));
        add(format!("cells_{}", notebook.section), &cells.collect::<String>());
        let (_, right, wrong, _) =
            TURNS.iter().find(|(section, ..)| *section == notebook.section).expect("an estimator to try");
        add(format!("right_{}", notebook.section), &filled(&notebook, right));
        add(format!("wrong_{}", notebook.section), &filled(&notebook, wrong));
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
    let mut cells = BTreeMap::new();
    for part in printed.split(MARK).skip(1) {
        let (id, printed) = part.split_once('\n').unwrap();
        let mut cell = Printed::default();
        let mut rest = printed;
        while let Some((before, after)) = rest.split_once("EVCXR_BEGIN_CONTENT ") {
            let (kind, after) = after.split_once('\n').unwrap();
            let (content, after) = after.split_once("\nEVCXR_END_CONTENT\n").unwrap();
            cell.text += before;
            cell.shown.insert(kind.into(), content.into());
            rest = after;
        }
        cell.text += rest;
        cell.text.truncate(cell.text.trim_end().len());
        cells.insert(id.into(), cell);
    }
    cells
}

#[test]
fn the_cells_print_what_is_stored() {
    let mut compared = 0;
    for notebook in notebooks() {
        let printed = parsed(&run(compiled(), &format!("cells_{}", notebook.section)));
        assert_eq!(printed.len(), notebook.code().count(), "{}", notebook.name);
        for cell in notebook.code().filter(|cell| !cell.is("timing")) {
            let (stored, printed) = (cell.stored(), &printed[&cell.id]);
            assert!(
                stored == *printed,
                "{}, cell {}: stored is\n{stored:#?}\nprinted is\n{printed:#?}\n(notebooks/run stores anew)",
                notebook.name,
                cell.id
            );
            compared += usize::from(stored != Printed::default());
        }
    }
    assert!(compared >= 5 * 7, "only {compared} cells print anything");
}

#[test]
fn ones_own_estimator_is_missing_mistaken_or_right() {
    for (section, _, _, mistake) in TURNS {
        let said = |part: &str| {
            let printed = run(compiled(), &format!("{part}_{section}"));
            parsed(&format!("{MARK}cell\n{printed}")).remove("cell").unwrap().shown["text/plain"].clone()
        };
        let right = said("right");
        assert!(
            right.starts_with("Unbiased within") && right.contains("Nothing wrong seen"),
            "{section}: {right}"
        );
        let wrong = said("wrong");
        assert!(wrong.starts_with("Not right.") && wrong.contains(mistake), "{section}: {wrong}");
        let [notebook] = &notebooks().into_iter().filter(|n| n.section == section).collect::<Vec<_>>()[..]
        else {
            panic!("not one notebook of section {section}")
        };
        let unwritten = &notebook.tagged("check").stored().shown["text/plain"];
        assert!(unwritten.starts_with("Missing"), "{section}: {unwritten}");
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
        let figures = notebook.code().filter(|cell| cell.stored().shown.contains_key("image/svg+xml"));
        assert!(figures.count() >= 3, "{name}: few figures");
        let prose = prose(notebook);
        for part in [
            "**Predict",
            "knob",
            "## Your turn",
            "## An extreme",
            "## What a second buys",
            "**To take away:**",
        ] {
            assert!(prose.contains(part), "{name}: no “{part}”");
        }
        // the questions in the workbook's words, and the way to the worked answers
        for question in workbook::questions().filter(|question| question.id.starts_with(notebook.section)) {
            let stated = question.at(&workbook::Options::default()).unwrap();
            assert!(
                prose.contains(&format!("## {} {}\n", question.id, stated.title)),
                "{name}: {}",
                question.id
            );
            assert!(prose.contains(&stated.statement), "{name}: the statement of {}", question.id);
            if let Some(note) = &stated.on_the_original {
                assert!(prose.contains(note), "{name}: the note on {}", question.id);
            }
            assert!(
                prose.contains(&format!("../examples/{}.rs", question.example)),
                "{name}: {}",
                question.example
            );
        }
    }
}

fn prose(notebook: &Notebook) -> String {
    notebook.cells.iter().filter(|cell| !cell.code).map(|cell| cell.source.clone() + "\n").collect()
}

#[test]
fn links_lead_somewhere() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("notebooks");
    let mut links = 0;
    for notebook in notebooks() {
        for link in prose(&notebook).split("](").skip(1) {
            let (target, _) = link.split_once(')').unwrap();
            assert!(folder.join(target).exists(), "{}: {target}", notebook.name);
            links += 1;
        }
    }
    assert!(links >= 5 * 2);
}

/// A decimal number in the text is in the code, in what a cell prints, or in the question itself.
/// The numbers of a text, without signs.
fn numbers(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_ascii_digit() && c != '.').map(|word| word.trim_matches('.'))
}

#[test]
fn every_number_in_prose_is_produced_by_a_cell() {
    for notebook in notebooks() {
        let mut known: String = notebook.code().map(|cell| cell.source.clone() + "\n").collect();
        for cell in notebook.code().filter(|cell| !cell.is("timing")) {
            let stored = cell.stored();
            known += &stored.text;
            // not a figure's coordinates, among which any short number is found
            let read = stored.shown.iter().filter(|(kind, _)| kind.as_str() != "image/svg+xml");
            read.for_each(|(_, content)| known += &(content.clone() + "\n"));
        }
        let questions: Vec<_> = workbook::questions().collect();
        for question in &questions {
            let stated = question.at(&workbook::Options::default()).unwrap();
            known += &stated.statement;
            known += &stated.on_the_original.unwrap_or_default();
        }
        let known: BTreeSet<&str> = numbers(&known).collect();
        for number in numbers(&prose(&notebook)) {
            let is_a_question = questions.iter().any(|question| question.id == number);
            if number.contains('.') && !is_a_question {
                assert!(known.contains(number), "{}: {number} comes from no cell", notebook.name);
            }
        }
    }
}
