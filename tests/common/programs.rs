//! The examples as programs: running them, and reading what they print.

use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};

use serde_json::Value;

/// An empty folder that nothing else writes to.
pub fn folder() -> PathBuf {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let test = module_path!().split("::").next().unwrap();
    let name = format!("{test}-{}", COUNT.fetch_add(1, Ordering::Relaxed));
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// What a program has done: it ran in this folder, and has printed this.
pub struct Ran {
    pub folder: PathBuf,
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

/// Runs an example in an empty folder; its figures and pages are in `worksheet/` there.
pub fn run(example: &str, arguments: &[&str]) -> Ran {
    run_in(folder(), example, arguments, "")
}

/// Runs an example in this folder, with this on its standard input.
pub fn run_in(folder: impl Into<PathBuf>, example: &str, arguments: &[&str], input: &str) -> Ran {
    let folder = folder.into();
    // cargo puts examples beside the folder of the tests
    let tests = std::env::current_exe().unwrap();
    let program = tests.parent().and_then(Path::parent).unwrap().join("examples").join(example);
    let mut command = Command::new(&program);
    command.args(arguments).current_dir(&folder);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap_or_else(|error| panic!("{}: {error}", program.display()));
    // a program that refuses its arguments may have ended before it could read
    match child.stdin.take().unwrap().write_all(input.as_bytes()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => panic!("{error}"),
        _ => {}
    }
    let output = child.wait_with_output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    Ran { folder, code: output.status.code(), out, err }
}

impl Ran {
    /// Itself, if nothing went wrong.
    pub fn well(self) -> Self {
        assert!(self.code == Some(0) && self.err.is_empty(), "{:?}: {}", self.code, self.err);
        self
    }

    /// The lines of JSON that it printed.
    pub fn rows(&self) -> Vec<Value> {
        assert_eq!(self.code, Some(0), "{}", self.err);
        let row = |line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}"));
        self.out.lines().map(row).collect()
    }

    /// The files that it made in `worksheet/`, by their names.
    pub fn files(&self) -> Vec<(String, PathBuf)> {
        let paths = fs::read_dir(self.folder.join("worksheet")).unwrap().map(|entry| entry.unwrap().path());
        paths.map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), path)).collect()
    }

    /// The text of one of these.
    pub fn file(&self, name: &str) -> String {
        fs::read_to_string(self.folder.join("worksheet").join(name)).unwrap()
    }
}

/// Text with its lines joined, wherever they were broken.
pub fn unfolded(text: &str) -> String {
    text.replace(" \\\n", " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A row without what differs from run to run.
pub fn lasting(mut row: Value) -> Value {
    for name in ["seconds", "figures"] {
        row.as_object_mut().unwrap().remove(name);
    }
    row
}

/// The examples of questions, by their files.
pub fn examples() -> Vec<String> {
    let files = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples")).unwrap();
    let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
    let names = names.filter_map(|name| Some(name.strip_suffix(".rs")?.to_owned()));
    let mut names: Vec<_> = names.filter(|name| name.starts_with('q')).collect();
    names.sort();
    names
}
