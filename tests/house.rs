//! The rules of the house that a program can see. Where one is broken, the sentence says what to do.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::iter::Peekable;
use std::path::{Path, PathBuf};
use std::str::Chars;

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
const FLOORS: [&[&str]; 14] = [
    &["error", "numbers", "float", "fast", "quantile"],
    &["stream"],
    &["estimate", "doubt"],
    &["estimator"],
    &["placement", "run"],
    &["plot"],
    &["check", "trade"],
    &["question"],
    &["inversion", "rectangle", "lambertian", "roulette"],
    &["paths"],
    &["mistakes", "figures"],
    &["questions"],
    &["workbook"],
    &["notebook"],
];

const TOPICS: [&str; 5] = ["inversion", "rectangle", "lambertian", "paths", "roulette"];

/// What the crate's root gives again belongs to no floor.
fn has_floor(named: &[String]) -> bool {
    FLOORS.iter().any(|floor| floor.contains(&&*named[0]))
}

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
    /// The paths behind each `crate::` and `super::` outside of comments and tests, those in braces one by
    /// one and all from the crate's root on. What a module only gives again is no import of its own.
    fn imports(&self) -> Vec<Vec<String>> {
        let is_code = |line: &str| !line.trim_start().starts_with("//") && !line.starts_with("pub use ");
        let code: Vec<&str> = self.lines().map(|(_, line)| line).filter(|line| is_code(line)).collect();
        let code = code.join("\n");
        let own: Vec<String> = self.modules().into_iter().map(str::to_owned).collect();
        let mut paths = Vec::new();
        for (at, _) in code.match_indices("crate::").chain(code.match_indices("super::")) {
            // not the second `super::` of a path
            if !code[..at].ends_with(|c: char| c == ':' || c.is_alphanumeric()) {
                expand(Vec::new(), &mut code[at..].chars().peekable(), &mut paths);
            }
        }
        let from_root = |path: Vec<String>| {
            let up = path.iter().take_while(|part| *part == "super").count();
            let base = if up == 0 { &[] } else { &own[..own.len().saturating_sub(up)] };
            base.iter().cloned().chain(path.into_iter().skip(up.max(1))).collect()
        };
        let mut paths: Vec<Vec<String>> = paths.into_iter().map(from_root).collect();
        // what is taken from an imported module where it is used: `use crate::fast;` and `fast::ln(x)`
        for module in paths.clone().iter().filter(|path| !path.is_empty()) {
            let (name, above) = module.split_last().unwrap();
            for (at, _) in code.match_indices(&format!("{name}::")) {
                if !code[..at].ends_with(|c: char| c == ':' || c == '_' || c.is_alphanumeric()) {
                    expand(above.to_vec(), &mut code[at..].chars().peekable(), &mut paths);
                }
            }
        }
        paths.retain(|path| !path.is_empty());
        paths
    }
}

/// The paths that begin here: `a::{b, c::{d, e}}` has `a::b`, `a::c::d` and `a::c::e`.
fn expand(mut path: Vec<String>, text: &mut Peekable<Chars<'_>>, paths: &mut Vec<Vec<String>>) {
    loop {
        while text.next_if(|c| c.is_whitespace()).is_some() {}
        let mut part = String::new();
        while let Some(c) = text.next_if(|c| c.is_alphanumeric() || *c == '_') {
            part.push(c);
        }
        if !part.is_empty() && part != "self" {
            path.push(part);
        }
        if text.next_if_eq(&':').is_some() {
            text.next();
        } else if text.next_if_eq(&'{').is_some() {
            loop {
                expand(path.clone(), text, paths);
                // what follows `as`
                while text.next_if(|c| !",{};".contains(*c) && *c != '}').is_some() {}
                if text.next() != Some(',') {
                    return;
                }
            }
        } else {
            return paths.push(path);
        }
    }
}

#[test]
fn nothing_imports_from_a_floor_above() {
    let mut broken = Vec::new();
    for source in sources("src") {
        let modules = source.modules();
        let Some(first) = modules.first() else { continue };
        for named in source.imports().into_iter().filter(|named| named[0] != *first && has_floor(named)) {
            let named: Vec<&str> = named.iter().map(String::as_str).collect();
            if floor(&named) > floor(&modules) {
                broken.push(format!("{} imports crate::{}, of a floor above", source.path, named.join("::")));
            }
        }
    }
    assert!(broken.is_empty(), "{}\nMove what is shared to the lower floor; see FLOORS.", broken.join("\n"));
}

/// Files that import from each other, on whatever way, have one subject or a third file between them. A
/// folder's `mod.rs` and what lies in the folder may name each other.
#[test]
fn no_files_import_in_a_circle() {
    let sources = sources("src");
    let all: BTreeMap<String, &Source> =
        sources.iter().map(|source| (source.modules().join("::"), source)).collect();
    let mut imports = BTreeMap::<String, BTreeSet<String>>::new();
    for (module, source) in &all {
        let named = source.imports().into_iter().map(|path| home(&all, String::new(), &path));
        let apart = |other: &String| !within(other, module) && !within(module, other);
        imports.insert(module.clone(), named.filter(apart).collect());
    }
    // what imports nothing that is left is in no circle, nor is what nothing left imports
    loop {
        let left: BTreeSet<String> = imports.keys().cloned().collect();
        let imported: BTreeSet<String> = imports.values().flatten().cloned().collect();
        imports.values_mut().for_each(|named| named.retain(|other| left.contains(other)));
        imports.retain(|module, named| !named.is_empty() && imported.contains(module));
        if imports.len() == left.len() {
            break;
        }
    }
    assert!(imports.is_empty(), "{imports:#?}\nMove what both need to a file of its own, or join the files.");
}

/// Whether a module is another or lies in its folder.
fn within(module: &str, other: &str) -> bool {
    module == other
        || module.strip_prefix(other).is_some_and(|rest| rest.starts_with("::") || other.is_empty())
}

/// The module whose file has what a path from this module on names.
fn home(all: &BTreeMap<String, &Source>, module: String, path: &[String]) -> String {
    let below = |name: &str| if module.is_empty() { name.to_owned() } else { format!("{module}::{name}") };
    let Some((first, rest)) = path.split_first() else { return module };
    if all.contains_key(&below(first)) {
        return home(all, below(first), rest);
    }
    let text = &all[&module].text.replace("pub(crate) use ", "pub use ");
    let children = all.keys().filter_map(|other| other.strip_prefix(&below("")));
    let mut children = children.filter(|child| !child.contains("::"));
    match children.find(|child| taken_from(text, child).contains(first)) {
        Some(child) => home(all, below(child), path),
        None => module,
    }
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
    for source in sources("src") {
        let lines = source.text.lines().count();
        assert!(lines <= 400, "{} has {lines} lines: cut it at its subjects", source.path);
    }
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

/// Docs are read top down: what it is, an example, then when it fails.
#[test]
fn examples_stand_before_errors() {
    for source in sources("src") {
        let mut errors = false;
        for (number, line) in source.lines() {
            let doc = line.trim_start().strip_prefix("///");
            errors = doc.is_some_and(|doc| errors || doc.trim() == "# Errors");
            let example = errors && doc.is_some_and(|doc| doc.trim().starts_with("```"));
            assert!(!example, "{}:{number}: move the example before # Errors", source.path);
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
