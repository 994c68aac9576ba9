//! The rules of the house that a program can see. Where one is broken, the sentence says what to do.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// A source file, with its path from the crate's folder.
struct Source {
    path: String,
    text: String,
}

fn sources(folder: &str) -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (mut folders, mut files) = (vec![root.join(folder)], Vec::<PathBuf>::new());
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                files.push(path);
            }
        }
    }
    files.sort();
    let source = |path: PathBuf| Source {
        text: fs::read_to_string(&path).unwrap(),
        path: path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/"),
    };
    files.into_iter().map(source).collect()
}

impl Source {
    /// Its lines before its own tests, numbered.
    fn lines(&self) -> impl Iterator<Item = (usize, &str)> {
        let own = self
            .text
            .split("#[cfg(test)]\nmod tests")
            .next()
            .unwrap()
            .split("#[cfg(test)]\npub(crate) mod tests")
            .next();
        (1..).zip(own.unwrap().lines())
    }

    /// Its modules from the crate's root on: `["paths", "room", "face"]`.
    fn modules(&self) -> Vec<&str> {
        let path = self.path.trim_start_matches("src/").trim_end_matches(".rs").trim_end_matches("/mod");
        if path == "lib" { Vec::new() } else { path.split('/').collect() }
    }
}

/// The floors, bottom up. A module imports from its own floor's row if at all, and from those below.
const FLOORS: [&[&str]; 13] = [
    &["error", "numbers", "float", "fast", "quantile"],
    &["stream"],
    &["estimate", "doubt"],
    &["estimator"],
    &["placement", "run"],
    &["plot"],
    &["check", "trade"],
    &["inversion", "rectangle", "lambertian", "roulette"],
    &["paths"],
    &["mistakes", "figures"],
    &["questions"],
    &["workbook"],
    &["notebook"],
];

const TOPICS: [&str; 5] = ["inversion", "rectangle", "lambertian", "paths", "roulette"];

/// What lies above its topic: mistakes, figures and questions are met by the rest of a topic in no `use`.
fn floor(modules: &[&str]) -> usize {
    let above = match modules {
        [topic, part, ..] if TOPICS.contains(topic) => match *part {
            "side_view" => "figures",
            "way" => "mistakes",
            part => part,
        },
        _ => "",
    };
    let at = |name: &str| FLOORS.iter().position(|floor| floor.contains(&name));
    at(above).filter(|floor| *floor > at("paths").unwrap()).or_else(|| at(modules[0])).unwrap()
}

impl Source {
    /// The paths behind each `crate::` outside of comments and tests, those in braces one by one. What the
    /// crate's root gives again belongs to no floor and is left out.
    fn imports(&self) -> Vec<Vec<String>> {
        let code = self.lines().filter(|(_, line)| !line.trim_start().starts_with("//"));
        let code: Vec<&str> = code.map(|(_, line)| line).collect();
        let mut paths = Vec::new();
        for rest in code.join("\n").split("crate::").skip(1) {
            let mut depth = 0;
            let mut path = String::new();
            for c in rest.chars() {
                match c {
                    '{' => depth += 1,
                    '}' => depth -= 1,
                    _ => {}
                }
                let within = c.is_alphanumeric() || "_:".contains(c);
                match depth {
                    0 if c != '}' && !within => break,
                    // further braces hold what lies in one module
                    1 if c == ',' => paths.push(std::mem::take(&mut path)),
                    0 | 1 if within => path.push(c),
                    _ => {}
                }
            }
            paths.push(path);
        }
        let named = paths.into_iter().map(|path| path.split("::").map(str::to_owned).collect());
        named.filter(|named: &Vec<String>| FLOORS.iter().any(|floor| floor.contains(&&*named[0]))).collect()
    }
}

#[test]
fn nothing_imports_from_a_floor_above() {
    let mut broken = Vec::new();
    for source in sources("src") {
        let modules = source.modules();
        let Some(first) = modules.first() else { continue };
        for named in source.imports().into_iter().filter(|named| named[0] != *first) {
            let named: Vec<&str> = named.iter().map(String::as_str).collect();
            // questions are written in the workbook's own types, which know no question
            let written_in = floor(&modules) == floor(&["paths", "questions"]) && named[0] == "workbook";
            if floor(&named) > floor(&modules) && !written_in {
                broken.push(format!("{} imports crate::{}, of a floor above", source.path, named.join("::")));
            }
        }
    }
    assert!(broken.is_empty(), "{}\nMove what is shared to the lower floor; see FLOORS.", broken.join("\n"));
}

#[test]
fn the_general_parts_know_no_topic() {
    let topics = FLOORS.iter().position(|floor| floor.contains(&TOPICS[0])).unwrap();
    for source in sources("src") {
        if source.modules().is_empty() || floor(&source.modules()) >= topics {
            continue;
        }
        let known = source.imports().into_iter().find(|named| TOPICS.contains(&&*named[0]));
        assert!(
            known.is_none(),
            "{} knows {}: give it what it needs as an argument, or move it to the topic",
            source.path,
            known.unwrap()[0]
        );
    }
}

#[test]
fn lines_are_at_most_110_wide() {
    let mut wide = Vec::new();
    for source in ["src", "tests", "examples", "bench"].into_iter().flat_map(sources) {
        if source.path.contains("node_modules") || source.path.contains("/target/") {
            continue;
        }
        for (number, line) in (1..).zip(source.text.lines()) {
            let width = line.chars().count();
            if width > 110 {
                wide.push(format!("{}:{number} has {width}", source.path));
            }
        }
    }
    assert!(wide.is_empty(), "{}\nBreak the line: 110 columns, comments and strings, too.", wide.join("\n"));
}

#[test]
fn files_have_one_subject() {
    let files = sources("src");
    let length = |source: &Source| source.text.lines().count();
    let long: Vec<_> =
        files.iter().filter(|source| length(source) > 400).map(|source| &source.path).collect();
    for source in &files {
        assert!(
            length(source) <= 700,
            "{} has {} lines: cut it at its subjects",
            source.path,
            length(source)
        );
    }
    let most = files.len() / 6;
    assert!(long.len() <= most, "more than one file in six is longer than 400 lines: {long:#?}");
}

#[test]
fn modules_have_one_style() {
    let files: BTreeSet<String> = sources("src").into_iter().map(|source| source.path).collect();
    for path in &files {
        let folder = path.trim_end_matches(".rs").to_owned() + "/";
        let beside = files.iter().find(|other| other.starts_with(&folder));
        assert!(beside.is_none(), "{path} stands beside its folder: make it {folder}mod.rs");
    }
    for topic in TOPICS {
        for part in ["mod", "questions", "mistakes", "figures"] {
            let path = format!("src/{topic}/{part}.rs");
            assert!(files.contains(&path), "{path} is missing: each topic has the same four files");
        }
    }
}

#[test]
fn the_root_lists_its_modules_from_the_ground_up() {
    let root = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs")).unwrap();
    let listed: Vec<usize> = root
        .lines()
        .filter_map(|line| line.trim_start_matches("pub ").strip_prefix("mod ")?.strip_suffix(';'))
        .map(|name| floor(&[name]))
        .collect();
    assert!(listed.is_sorted(), "list the modules of src/lib.rs in the order of FLOORS: {listed:?}");
}

/// Outside of tests nothing ends the program: what cannot be is an error, too.
#[test]
fn nothing_panics_on_purpose() {
    for source in sources("src") {
        for (number, line) in source.lines().filter(|(_, line)| !line.trim_start().starts_with("//")) {
            for end in [".unwrap()", ".expect(", "panic!(", "unreachable!(", "todo!(", "unimplemented!("] {
                let Source { path, .. } = &source;
                assert!(!line.contains(end), "{path}:{number} has {end}…: return an Error, or match on it");
            }
            assert!(
                !line.contains("println!") || source.path == "src/workbook/mod.rs",
                "{}:{number} prints: the workbook's print.rs does that",
                source.path
            );
        }
    }
}

/// What is public: `module::Item`, `module::Type::method`. Fields and variants come with their types.
///
/// Modules that are not public do not hide what their parent gives again, so an item of theirs counts if its
/// name stands in a `pub use`.
fn public() -> BTreeMap<String, String> {
    let sources = sources("src");
    let all: BTreeMap<String, &Source> =
        sources.iter().map(|source| (source.modules().join("::"), source)).collect();
    let mut items = BTreeMap::new();
    for (path, source) in &all {
        let parts: Vec<&str> = path.split("::").filter(|part| !part.is_empty()).collect();
        // the last module on the way whose name is not public, and what its parent takes from it
        let mut shown: Option<BTreeSet<String>> = None;
        let mut home = String::new();
        for depth in 0..parts.len() {
            let parent = parts[..depth].join("::");
            let declared = &all[&parent].text;
            if declared.lines().any(|line| line == format!("pub mod {};", parts[depth])) {
                if shown.is_none() {
                    home = parts[..=depth].join("::");
                }
            } else {
                let own = taken_from(declared, parts[depth]);
                shown = Some(match shown {
                    None => own,
                    Some(before) => before.intersection(&own).cloned().collect(),
                });
            }
        }
        let visible = |name: &str| shown.as_ref().is_none_or(|shown| shown.contains(name));
        let at = |name: &str| if home.is_empty() { name.to_owned() } else { format!("{home}::{name}") };
        let mut block = None::<String>;
        for (_, line) in source.lines() {
            if let Some(of) = line.strip_prefix("impl") {
                let inherent = !of.contains(" for ");
                let name = of.split('>').next_back().filter(|rest| rest.len() > 2 && of.starts_with('<'));
                let name = name.unwrap_or(of).trim_start().split(['<', ' ', '{']).next().unwrap_or_default();
                block = (inherent && !name.is_empty()).then(|| name.to_owned());
            } else if line == "}" {
                block = None;
            }
            let (indent, rest) = match line.strip_prefix("    ") {
                Some(inside) => (true, inside),
                None => (false, line),
            };
            let Some(rest) = rest.strip_prefix("pub ") else { continue };
            let rest = rest.trim_start_matches("const fn ").trim_start_matches("fn ");
            let kinds = ["struct ", "enum ", "trait ", "const ", "static ", "type ", "mod "];
            let name = kinds.iter().find_map(|kind| rest.strip_prefix(kind)).unwrap_or(rest);
            let is_field = indent && name == rest && !line.contains("fn ");
            let name: String = name.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            if is_field || name == "use" || name.is_empty() {
                continue;
            }
            let signature = line.trim().trim_end_matches(" {").to_owned();
            match (&block, indent) {
                (Some(of), true) if visible(of) => items.insert(at(&format!("{of}::{name}")), signature),
                (None, false) if visible(&name) => items.insert(at(&name), signature),
                _ => None,
            };
        }
    }
    items
}

/// The names in `pub use module::…` and `pub use module::{…}`.
fn taken_from(text: &str, module: &str) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for part in text.split("pub use ").skip(1) {
        let part = part.split(';').next().unwrap();
        if let Some(list) = part.strip_prefix(&format!("{module}::")) {
            let list = list.trim_matches(['{', '}', '\n', ' ']);
            names.extend(list.split(',').map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()));
        }
    }
    names
}

/// Growth is a decision: `UNBIASED_PUBLIC=1 cargo test --release --test house` writes the list anew.
#[test]
fn what_is_public_is_listed() {
    let items = public();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/public.txt");
    let found: String = items.keys().map(|item| format!("{item}\n")).collect();
    if std::env::var_os("UNBIASED_PUBLIC").is_some() {
        fs::write(&path, &found).unwrap();
    }
    let listed = fs::read_to_string(&path).unwrap_or_default();
    let (listed, found): (BTreeSet<&str>, BTreeSet<&str>) =
        (listed.lines().collect(), found.lines().collect());
    let new: Vec<_> = found.difference(&listed).collect();
    let gone: Vec<_> = listed.difference(&found).collect();
    println!("{} public items", found.len());
    assert!(
        new.is_empty() && gone.is_empty(),
        "public now: {new:#?}\nno longer: {gone:#?}\nIs that meant? Then write the list anew: \
         UNBIASED_PUBLIC=1"
    );
}

#[test]
fn no_two_public_types_share_a_name() {
    let mut homes = BTreeMap::<String, Vec<String>>::new();
    for (item, signature) in public() {
        if ["pub struct", "pub enum", "pub trait"].iter().any(|kind| signature.starts_with(kind)) {
            homes.entry(item.rsplit("::").next().unwrap().to_owned()).or_default().push(item);
        }
    }
    homes.retain(|_, items| items.len() > 1);
    assert!(homes.is_empty(), "one name for one thing: {homes:#?}");
}
