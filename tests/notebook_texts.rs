//! The notebooks' parts, formulas, links and numbers: the workbook's questions in its words, and nothing that
//! no cell gives.
#![cfg(feature = "workbook")]

mod common;

use std::collections::BTreeSet;

use common::notebook::{folder, notebooks};
use serde_json::json;
use unbiased::workbook;

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
            let (id, stated) = (question.id, question.at(&unbiased::question::Values::default()).unwrap());
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
            let stated = question.at(&unbiased::question::Values::default()).unwrap();
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
