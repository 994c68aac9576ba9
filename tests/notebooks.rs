//! The notebooks are true: their cells compile and run in order as one program, and print what is stored in
//! them. No Jupyter is needed.
//!
//! All of them are compiled by one call of rustc, against the library that this very test is linked with.

mod common;

use std::any::TypeId;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::SystemTime;

use common::notebook::{Notebook, Printed, notebooks, with_text};

/// Begins what a cell prints.
const MARK: char = '\u{1e}';

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
