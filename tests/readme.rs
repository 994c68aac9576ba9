//! Is the README true? Its questions, figures and counts are the workbook's, and its links lead somewhere.
//!
//! Its options and quotes are held to what is printed in `examples.rs`; its Rust code is a doctest of the
//! library. Nothing here is random.
#![cfg(feature = "workbook")]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use unbiased::question::Values;
use unbiased::workbook::{exercise, questions};

const README: &str = include_str!("../README.md");

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// What the links in a text lead to.
fn links(text: &str) -> impl Iterator<Item = &str> {
    text.split("](").skip(1).filter_map(|rest| Some(rest.split_once(')')?.0))
}

#[test]
fn links_lead_somewhere() {
    let headings = README.lines().filter_map(|line| line.strip_prefix("## "));
    let anchors: Vec<String> = headings.map(|of| of.to_lowercase().replace(' ', "-")).collect();
    for link in links(README) {
        let found = match link.split_once('#') {
            Some(("", anchor)) => anchors.iter().any(|of| of == anchor),
            _ => link.starts_with("https://") || root().join(link).exists(),
        };
        assert!(found, "{link}");
    }
}

#[test]
fn the_table_is_that_of_the_questions_and_has_every_figure() {
    let mut linked = BTreeSet::new();
    for question in questions() {
        let title = question.at(&Values::default()).unwrap().title;
        let row = format!("| {} {title} |", question.id);
        let row = README.lines().find(|line| line.starts_with(&row)).unwrap_or_else(|| panic!("{row}"));
        let [example, topic, figures @ ..] = &links(row).collect::<Vec<_>>()[..] else { panic!("{row}") };
        assert_eq!(*example, format!("examples/{}.rs", question.example));
        assert!(root().join(topic).join("mistakes.rs").exists(), "{topic}");
        linked.extend(figures.iter().map(|figure| figure.trim_start_matches("figures/").to_owned()));
    }
    // those of the appendices belong to no question
    let of_questions =
        |name: &String| name.ends_with(".svg") && name.starts_with(|c: char| c.is_ascii_digit());
    let files = fs::read_dir(root().join("figures")).unwrap();
    let drawn = files.map(|file| file.unwrap().file_name().into_string().unwrap());
    // what is drawn of seconds is on no two machines the same, and is not committed
    let drawn = drawn.filter(|name| of_questions(name) && !name.contains("seconds"));
    linked.retain(of_questions);
    assert_eq!(linked, drawn.collect());
}

#[test]
fn the_mistakes_are_counted() {
    let exercises = ["1.1", "2.1", "3.5", "4.3", "5", "5.1"].map(|of| exercise(of).unwrap());
    let mistakes: usize = exercises.iter().map(|exercise| exercise.mistakes.len()).sum();
    let words: Vec<&str> = README.split_whitespace().collect();
    assert!(words.join(" ").contains(&format!("which of {mistakes} classic mistakes")), "{mistakes}");
    assert!(words.contains(&"sixteen") && questions().count() == 16);
}
