//! The worksheet as self-contained pages: the sheet to be filled in, its answer key, and the appendices.

mod key;
mod sheet;
mod text;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::{Answer, Appendix, Contents, Options};
use crate::error::Result;
use crate::plot::Figure;
use crate::question::Question;
use text::prose;

/// The questions with their answers, in order.
type Answered = [(&'static Question, Vec<Answer>)];

const STYLE: &str = include_str!("style.css");

/// `student.html`: the questions, and room for answers by hand.
pub(super) fn sheet(answered: &Answered, options: &Options) -> Result<String> {
    Ok(whole(
        "sheet",
        &format!("{} — worksheet", options.title),
        &html! {
            header {
                h1 { (options.title) " — worksheet" }
                p.fill { span { "Name" } span { "Date" } }
            }
            (questions(answered, options)?)
            main { (by_section(answered, |question, answers| sheet::article(question, answers, options))?) }
        },
    ))
}

/// `solution.html`: the answer key, with links to the appendices' pages.
pub(super) fn key(answered: &Answered, appendices: &[&Appendix], options: &Options) -> Result<String> {
    Ok(whole(
        "key",
        &format!("{} — answer key", options.title),
        &html! {
            header {
                h1 { (options.title) " — answer key" }
                (key::legend(options))
            }
            (questions(answered, options)?)
            @if !appendices.is_empty() {
                nav aria-label="Appendices" {
                    h2 { "Appendices" }
                    ul { @for appendix in appendices {
                        li { a href={ (appendix.example) ".html" } { (appendix.title) } }
                    } }
                }
            }
            main { (by_section(answered, |question, answers| key::article(question, answers, options))?) }
            footer { p { "Made with the crate unbiased "
                (env!("CARGO_PKG_VERSION")) "." } }
        },
    ))
}

/// `trade.html`, `extremes.html`: one page per appendix.
pub(super) fn appendix(appendix: &Appendix, made: &Contents) -> String {
    whole(
        "beside",
        appendix.title,
        &html! {
            header { h1 { (appendix.title) } }
            nav aria-label="Back" { a href="solution.html" { "The answer key" } }
            main {
                p { (prose(&made.text)) }
                @for table in &made.tables { (aligned(table)) }
                @for figure in &made.figures { (shown(figure)) }
            }
            footer { p.command { code { "cargo run --release --example " (appendix.example) } } }
        },
    )
}

/// A complete page, without scripts or anything loaded from elsewhere.
fn whole(class: &str, title: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body class=(class) { (body) }
        }
    };
    page.into_string()
}

/// Links to all questions.
fn questions(answered: &Answered, options: &Options) -> Result<Markup> {
    let title = |(question, _): &(&'static Question, Vec<Answer>)| {
        Ok((*question, question.at(&options.values)?.title))
    };
    let titles = answered.iter().map(title).collect::<Result<Vec<_>>>()?;
    Ok(html! {
        nav aria-label="Questions" {
            ul { @for (question, title) in &titles {
                li { a href={ "#" (id_of(question)) } { (question.id) " " (prose(title)) } }
            } }
        }
    })
}

/// An id that is valid in HTML, CSS and XML.
fn id_of(question: &Question) -> String {
    format!("q-{}", question.id.replace('.', "-"))
}

/// The articles, grouped under the headings of their sections.
fn by_section(
    answered: &Answered,
    article: impl Fn(&'static Question, &[Answer]) -> Result<Markup>,
) -> Result<Markup> {
    let mut articles = String::new();
    let mut section = None;
    for (question, answers) in answered {
        let number = question.id.split('.').next();
        if number != section {
            section = number;
            articles += &html! { h2 { (heading(number.unwrap_or_default())) } }.into_string();
        }
        articles += &article(question, answers)?.into_string();
    }
    Ok(PreEscaped(articles))
}

fn heading(section: &str) -> String {
    let name = match section {
        "1" => "The inversion method",
        "2" => "Unbiased estimators",
        "3" => "The diffuse cube",
        "4" => "Paths",
        "5" => "Russian roulette",
        _ => "",
    };
    format!("{section} {name}").trim().to_owned()
}

/// A figure with its title; its ids are made unique on the page.
fn shown(figure: &Figure) -> Markup {
    let name = figure.name();
    let svg = figure.svg().replace(&format!("\"{name}-"), &format!("\"figure-{name}-"));
    let svg = svg.replace(&format!(" {name}-desc\""), &format!(" figure-{name}-desc\""));
    html! { figure class=(if narrow(figure) { "narrow" } else { "full" }) {
        (PreEscaped(svg)) figcaption { (prose(figure.title())) }
    } }
}

/// Whether two such figures fit side by side.
fn narrow(figure: &Figure) -> bool {
    let width = figure.svg().split(" width=\"").nth(1).and_then(|rest| rest.split("mm\"").next());
    width.and_then(|width| width.parse().ok()).is_some_and(|width: f64| width < 100.0)
}

/// A table of plain text.
fn aligned(table: &super::Table) -> Markup {
    html! {
        table.many[table.columns.len() > 6 && table.width() > 100] {
            caption { (prose(&table.caption)) }
            thead { tr { @for name in &table.columns { th scope="col" { (name) } } } }
            tbody { @for row in &table.rows { tr {
                @for (index, (cell, name)) in row.iter().zip(&table.columns).enumerate() {
                    @if index == 0 { th scope="row" { (prose(cell)) } }
                    @else { td data-name=(name) { (prose(cell)) } }
                }
            } } }
        }
    }
}
