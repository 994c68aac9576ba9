//! A question with its answer in the key: on paper only what settles it, on a screen all rows and figures,
//! too.

use maud::{Markup, html};

use super::super::check::{exercise, mistakes};
use super::super::{Answer, Options, print, repeat};
use super::text::{formula, grouped, prose};
use super::{aligned, narrow, shown};
use crate::check::Exercise;
use crate::error::Result;
use crate::numbers::{shortened, std_errors};
use crate::plot::Edition;
use crate::question::Question;

/// The explanation of the marks.
pub(super) fn legend(options: &Options) -> Markup {
    html! {
        div.legend {
            p { strong { "✓" } " estimate and exact value agree: they differ by at most "
                "four standard errors. "
                strong { "✗" } " they do not. "
                strong { "± " } "is a 95 % interval; z is the difference in standard errors." }
            p { strong { "wrong on purpose" } " shows what a mistake does; with "
                strong { "infinite variance" }
                " an error bar means nothing. Neither is checked, and neither gets a mark." }
            p { "All random numbers come from seed " (options.seed) "." }
        }
    }
}

pub(super) fn article(question: &'static Question, answers: &[Answer], options: &Options) -> Result<Markup> {
    let options = options.for_question(question);
    let stated = question.at(&options.values)?;
    let formulas = stated.latex.iter().map(|latex| formula(latex)).collect::<Result<Vec<_>>>()?;
    let (command, remark) = repeat::command(question, answers, &options);
    let rows: Vec<&Answer> = answers.iter().filter(|answer| answer.is_a_number()).collect();
    let figures: Vec<_> = answers.iter().flat_map(|answer| answer.figures(Edition::Solution)).collect();
    // on paper one figure is enough: beside the text, or below it if it is as wide
    let (first, others) = figures.split_at(figures.len().min(1));
    let (aside, below): (Vec<_>, Vec<_>) = first.iter().partition(|figure| narrow(figure));
    Ok(html! {
        article id=(super::id_of(question)) {
            h3 { (question.id) " " (prose(&stated.title)) }
            p.statement { em { (prose(&stated.statement)) } }
            @for figure in aside { div.aside { (shown(figure)) } }
            @for formula in &formulas { (formula) }
            p.why { (prose(&stated.answer)) }
            @for answer in answers.iter().filter(|answer| !answer.is_a_number()) {
                @if let Some(sentence) = &answer.note { p.why { (prose(sentence)) } }
            }
            @for row in settling(&rows) { (in_a_line(question, row)) }
            @for figure in below { (shown(figure)) }
            @if !stated.wrong.is_empty() {
                h4 { "Classic wrong answers" }
                dl { @for (answer, slip) in &stated.wrong { dt { (prose(answer)) } dd { (prose(slip)) } } }
            }
            @if let Some(note) = &stated.on_the_original {
                p.original { strong { "On the original sheet. " } (prose(note)) }
            }
            details {
                summary { (all_of_it(rows.len(), others.len())) }
                @if !rows.is_empty() { (table(question, &rows, &options)) }
                @for answer in &rows {
                    @if let Some(sentence) = print::cut_short(answer) {
                        p { (answer.what) ": " (sentence) }
                    }
                    @if let Some(sentence) = &answer.note { p { (prose(sentence)) } }
                }
                div.figures { @for figure in others { (shown(figure)) } }
                @if let Some(exercise) = asked_last(question) { (aligned(&mistakes(exercise))) }
                p.command { code { (command) } @if let Some(remark) = remark { " " (remark) } }
            }
        }
    })
}

/// The exercise for which this is the last question.
fn asked_last(question: &Question) -> Option<&'static Exercise> {
    let exercise = exercise(question.id).ok()?;
    exercise.questions().last().filter(|last| *last == question.id).map(|_| exercise)
}

/// The first checked row for each part of the question.
fn settling<'a>(rows: &[&'a Answer]) -> Vec<&'a Answer> {
    let mut settling: Vec<&Answer> = Vec::new();
    for row in rows.iter().filter(|row| row.unjudged.is_none()) {
        if settling.iter().all(|before| before.question != row.question) {
            settling.push(row);
        }
    }
    settling
}

/// A row in one line: `(i) P(N = 0): exactly 0.2, estimated 0.20002 ± 0.00078 ✓`
fn in_a_line(question: &Question, row: &Answer) -> Markup {
    html! {
        p.check {
            (part(question, row)) (prose(&row.what)) ": "
            @if let Some(truth) = row.truth { "exactly " (shortened(truth)) }
            @if let Some(estimate) = row.estimate() {
                @if row.truth.is_some() { ", " }
                "estimated " (print::interval(estimate)) " " (row.verdict())
            } @else if let (None, Some(value)) = (row.truth, row.found()) { (shortened(value)) }
        }
    }
}

/// `(i) ` for a row of 5.1(i)
fn part(question: &Question, row: &Answer) -> String {
    match row.question.strip_prefix(question.id) {
        Some("") | None => String::new(),
        Some(part) => format!("{part} "),
    }
}

fn all_of_it(rows: usize, figures: usize) -> String {
    let count = |count: usize, one: &str| match count {
        0 => None,
        1 => Some(format!("1 {one}")),
        _ => Some(format!("{count} {one}s")),
    };
    let counts = [count(rows, "row"), count(figures, "further figure")];
    let counts: Vec<String> = counts.into_iter().flatten().chain(["how to run it".into()]).collect();
    format!("In full: {}", counts.join(", "))
}

/// All rows.
fn table(question: &Question, rows: &[&Answer], options: &Options) -> Markup {
    // one row's own parameter is named in every row
    let parameters = || rows.iter().flat_map(|row| &row.parameters);
    let varied = |name: &str| {
        parameters().any(|(other, value)| other == name && !print::as_given(other, *value, options))
    };
    html! {
        table {
            caption { "Question " (question.id) ", every row" }
            thead { tr {
                @for name in ["what", "exact value", "estimate ± 95 %", "z", "draws", "verdict"] {
                    th scope="col" { (name) }
                }
            } }
            tbody { @for row in rows { tr {
                th scope="row" {
                    (part(question, row)) (prose(&row.what))
                    @for (name, value) in row.parameters.iter().filter(|(name, _)| varied(name)) {
                        ", " (prose(name)) " = " (value.shortened())
                    }
                }
                td.number data-name="exact value" { @if let Some(truth) = row.truth { (shortened(truth)) } }
                td.number data-name="estimate ± 95 %" {
                    @if let Some(estimate) = row.estimate() { (print::interval(estimate)) }
                    @else if let Some(value) = row.found() { (shortened(value)) }
                }
                td.number data-name="z" {
                    @if let Some(z) = row.z().filter(|_| row.doubt().is_none()) { (std_errors(z)) }
                }
                td.number data-name="draws" {
                    @if let Some(estimate) = row.estimate() { (grouped(estimate.draws())) }
                }
                td data-name="verdict" { (row.verdict()) }
            } } }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_folded_away_is_counted() {
        assert_eq!(all_of_it(8, 1), "In full: 8 rows, 1 further figure, how to run it");
        assert_eq!(all_of_it(0, 2), "In full: 2 further figures, how to run it");
        assert_eq!(all_of_it(1, 0), "In full: 1 row, how to run it");
    }
}
