//! Reads the notebooks: their cells, and what is stored as their outputs.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

pub struct Cell {
    pub id: String,
    pub code: bool,
    pub source: String,
    pub metadata: Value,
    pub outputs: Vec<Value>,
}

impl Cell {
    pub fn is(&self, tag: &str) -> bool {
        self.metadata["tags"].as_array().is_some_and(|tags| tags.iter().any(|own| own == tag))
    }

    /// What is stored as its output.
    pub fn stored(&self) -> Printed {
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
pub type Printed = BTreeMap<String, String>;

pub fn with_text(mut shown: Printed, text: &str) -> Printed {
    if !text.trim_end().is_empty() {
        shown.insert("stdout".into(), text.trim_end().into());
    }
    shown
}

pub struct Notebook {
    pub name: String,
    pub section: char,
    pub bytes: usize,
    pub metadata: Value,
    pub cells: Vec<Cell>,
}

impl Notebook {
    pub fn code(&self) -> impl Iterator<Item = &Cell> {
        self.cells.iter().filter(|cell| cell.code)
    }

    pub fn tagged(&self, tag: &str) -> &Cell {
        self.cells
            .iter()
            .find(|cell| cell.is(tag))
            .unwrap_or_else(|| panic!("{}: no cell “{tag}”", self.name))
    }

    pub fn prose(&self) -> String {
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

pub fn notebooks() -> Vec<Notebook> {
    let mut paths: Vec<PathBuf> =
        fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "ipynb"));
    paths.sort();
    paths.iter().map(|path| read(path)).collect()
}

pub fn folder() -> PathBuf {
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
