//! The worksheet as one self-contained page.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use pulldown_latex::{Parser, RenderConfig, Storage, config::DisplayMode, push_mathml};

use super::answer::TOO_FEW;
use super::{Answer, Appendix, Options, Question, print, shown};
use crate::error::{Error, Result};
use crate::figure::Edition;
use crate::numbers::shortened;

/// The whole page: no script, nothing loaded from elsewhere.
pub(super) fn page(
    answered: &[(&'static Question, Vec<Answer>)],
    appendices: &[Appendix],
    options: &Options,
) -> Result<String> {
    let student = options.edition == Edition::Student;
    let title = "Monte Carlo and global illumination: the worksheet";
    let mut articles = Vec::new();
    for (question, answers) in answered {
        articles.push(article(question, answers, options)?);
    }
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    h1 { "Monte Carlo and global illumination" }
                    @if student {
                        p.fill { "Name" span {} "Date" span {} }
                    } @else {
                        p { "Every question three ways: in closed form, by an estimator with its 95 % interval, and in a picture. "
                            "z counts the standard errors between estimate and truth. All random numbers come from seed "
                            (options.seed) "." }
                    }
                }
                nav aria-label="Questions" {
                    @for (question, _) in answered {
                        a href={ "#q" (question.id) } { (question.id) } " "
                    }
                    @for appendix in appendices {
                        a href={ "#" (appendix.example) } { (appendix.title) } " "
                    }
                }
                main {
                    @for (index, article) in articles.iter().enumerate() {
                        @if let Some(heading) = section_heading(answered, index) { h2 { (heading) } }
                        (article)
                    }
                    @for appendix in appendices { (beside(appendix)) }
                }
                footer { p { "Made by " code { "cargo run --release --example worksheet" } ", crate unbiased " (env!("CARGO_PKG_VERSION")) "." } }
            }
        }
    };
    Ok(page.into_string())
}

/// The heading of a section, at its first question.
fn section_heading(answered: &[(&'static Question, Vec<Answer>)], index: usize) -> Option<String> {
    let section = |index: usize| answered.get(index).and_then(|(question, _)| question.id.split('.').next());
    let number = section(index)?;
    if index > 0 && section(index - 1) == Some(number) {
        return None;
    }
    let name = match number {
        "1" => "The inversion method",
        "2" => "Unbiased estimators",
        "3" => "The diffuse cube",
        "4" => "Paths",
        "5" => "Russian roulette",
        _ => "",
    };
    Some(format!("{number} {name}"))
}

fn article(question: &'static Question, answers: &[Answer], options: &Options) -> Result<Markup> {
    let options = options.for_question(question);
    let edition = options.edition;
    let formulas = question.latex.iter().map(|latex| mathml(latex)).collect::<Result<Vec<_>>>()?;
    let answers: Vec<&Answer> = answers.iter().filter(|answer| shown(answer, edition)).collect();
    let figures = answers.iter().flat_map(|answer| answer.figures(edition));
    let wrong =
        if edition == Edition::Solution { question.classic_wrong_answers(&options)? } else { Vec::new() };
    let (command, remark) = options.command(question, answers.iter().copied());
    Ok(html! {
        article id={ "q" (question.id) } {
            h3 { (question.id) " " (prose(question.title)) }
            p.statement { (prose(question.statement)) }
            @if edition == Edition::Solution {
                @for formula in &formulas { div.formula { (PreEscaped(formula)) } }
                p { (prose(question.answer)) }
                @if answers.iter().any(|answer| answer.found().is_some() || answer.exact().is_some()) {
                    (numbers(&answers, &options))
                }
                @for answer in &answers {
                    @if let Some(sentence) = print::cut_short(answer) { p { (answer.what()) ": " (sentence) } }
                    @if let Some(sentence) = answer.reason() { p { (answer.what()) ": " (prose(&sentence)) } }
                    @if let Some(sentence) = answer.sentence() { p { (prose(sentence)) } }
                }
            }
            div.figures {
                @for figure in figures {
                    figure { (PreEscaped(figure.svg())) figcaption { (figure.title()) } }
                }
            }
            @if edition == Edition::Student {
                div.space {}
            } @else {
                @if !wrong.is_empty() {
                    h4 { "Classic wrong answers" }
                    dl {
                        @for (answer, slip) in &wrong { dt { (prose(answer)) } dd { (prose(slip)) } }
                    }
                }
                @if let Some(note) = question.on_the_original {
                    aside { strong { "On the original sheet. " } (prose(note)) }
                }
                p.command { code { (command) } @if let Some(remark) = remark { " " (remark) } }
            }
        }
    })
}

/// What stands beside the questions.
fn beside(appendix: &Appendix) -> Markup {
    html! {
        article id=(appendix.example) {
            h2 { (appendix.title) }
            p { (prose(&appendix.text)) }
            @for table in &appendix.tables {
                div.wide { table {
                    caption { (prose(&table.caption)) }
                    thead { tr { @for name in &table.columns { th { (name) } } } }
                    tbody { @for row in &table.rows { tr { @for cell in row { td { (prose(cell)) } } } } }
                } }
            }
            @for figure in &appendix.figures {
                figure { (PreEscaped(figure.svg())) figcaption { (figure.title()) } }
            }
            p.command { code { "cargo run --release --example " (appendix.example) } }
        }
    }
}

fn numbers(answers: &[&Answer], options: &Options) -> Markup {
    let varied = options.varied(answers.iter().copied());
    html! {
        div.wide { table {
            thead { tr { th { "" } th { "what" } th { "truth" } th { "estimate ± 95 %" } th { "z" } th { "draws" } } }
            tbody {
                @for answer in answers {
                    @if answer.found().is_some() || answer.exact().is_some() {
                        tr class=(if answer.agrees().is_none() && answer.estimate().is_some() { "demonstration" } else { "" }) {
                            td { (answer.question()) }
                            td { (prose(answer.what()))
                                @for (name, value) in answer.parameters().iter().filter(|(name, _)| varied.contains(name)) { ", " (name) " = " (value.shortened()) } }
                            td.number { @if let Some(truth) = answer.exact() { (shortened(truth)) } }
                            td.number {
                                @if answer.estimate().is_some() { (print::interval(answer)) }
                                @else if let Some(value) = answer.found() { (shortened(value)) }
                            }
                            td.number {
                                @if answer.too_few_draws() { (TOO_FEW) }
                                @else if let Some(z) = answer.z() { (format!("{z:.2}").replace('-', "−")) }
                                @match answer.agrees() { Some(true) => " ✓", Some(false) => " ✗", None => "" } }
                            td.number { @if let Some(estimate) = answer.estimate() { (grouped(estimate.draws())) } }
                        }
                    }
                }
            }
        } }
    }
}

/// Whether it is shifted with the mark before it: ², which is numeric, has a place of its own.
fn shifts(c: char) -> bool {
    c.is_alphabetic() || c.is_ascii_digit()
}

/// Plain text with its x_i as subscripts, and its x^n and x^(…) as superscripts.
fn prose(text: &str) -> Markup {
    let mut html = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(['_', '^']) {
        let (before, mark) = rest.split_at(at);
        html += &escaped(before);
        let after = mark.get(1..).unwrap_or_default();
        let tag = if mark.starts_with('_') { "sub" } else { "sup" };
        let (shifted, left) = match after.strip_prefix('(').and_then(|inside| inside.split_once(')')) {
            Some(parts) if tag == "sup" => parts,
            _ => after.split_at(after.find(|c| !shifts(c)).unwrap_or(after.len())),
        };
        html += &format!("<{tag}>{}</{tag}>", escaped(shifted));
        rest = left;
    }
    PreEscaped(html + &escaped(rest))
}

fn escaped(text: &str) -> String {
    html! { (text) }.into_string()
}

/// Digits in threes.
fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let thirds = digits.bytes().enumerate().map(|(i, digit)| {
        let gap = if i > 0 && (digits.len() - i).is_multiple_of(3) { "\u{202f}" } else { "" };
        format!("{gap}{}", char::from(digit))
    });
    thirds.collect()
}

fn mathml(latex: &str) -> Result<String> {
    let storage = Storage::new();
    let failed = |reason: String| Error::Draft { what: format!("the formula {latex}"), reason };
    // pulldown-latex puts errors into its output; they are looked for first
    if let Some(Err(error)) = Parser::new(latex, &storage).find(|event| event.is_err()) {
        return Err(failed(error.to_string()));
    }
    let mut mathml = String::new();
    let config = RenderConfig { display_mode: DisplayMode::Block, ..RenderConfig::default() };
    push_mathml(&mut mathml, Parser::new(latex, &storage), config)
        .map_err(|error| failed(error.to_string()))?;
    Ok(mathml)
}

const STYLE: &str = "
:root { color-scheme: light; }
body { font: 1rem/1.5 system-ui, 'DejaVu Sans', sans-serif; color: #222; background: #fff; margin: 0 auto; max-width: 44rem; padding: 1rem; }
h1 { font-size: 1.6rem; line-height: 1.2; } h2 { font-size: 1.3rem; border-bottom: 1px solid #bbb; margin-top: 2.5rem; }
h3 { font-size: 1.05rem; margin-bottom: .3rem; } h4 { font-size: .95rem; margin-bottom: .3rem; }
nav { line-height: 2; } nav a { display: inline-block; padding: 0 .4rem; color: #005a8c; }
.statement { font-style: italic; }
.formula { overflow-x: auto; margin: .6rem 0; } math { font-size: 1.1rem; }
.figures { display: flex; flex-wrap: wrap; gap: 0 1rem; } figure { margin: 1rem 0; max-width: 100%; flex: 0 1 auto; } figure svg { max-width: 100%; height: auto; } caption { text-align: left; font-weight: 600; padding: 1rem 0 .3rem; } figcaption { font-size: .85rem; color: #444; max-width: 85mm; }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-size: .85rem; }
th, td { text-align: left; padding: .2rem .6rem .2rem 0; border-bottom: 1px solid #ddd; vertical-align: top; }
.number { font-variant-numeric: tabular-nums; white-space: nowrap; } sub, sup { line-height: 0; } tr.demonstration td { color: #666; }
dl { display: grid; grid-template-columns: minmax(5rem, max-content) 1fr; gap: .15rem 1rem; font-size: .9rem; margin: 0; }
dt { font-weight: 600; } dd { margin: 0; }
aside { border-left: 3px solid #d55e00; padding-left: .8rem; margin: 1rem 0; font-size: .9rem; }
.command { font-size: .8rem; overflow-x: auto; white-space: nowrap; }
.space { min-height: 9rem; background: repeating-linear-gradient(#fff 0 1.7rem, #ccc 1.7rem calc(1.7rem + 1px)); }
.fill span { display: inline-block; width: 12rem; border-bottom: 1px solid #222; margin: 0 1rem 0 .4rem; }
footer { font-size: .8rem; color: #444; margin-top: 3rem; }
@media (max-width: 30rem) { dl { grid-template-columns: 1fr; } dd { margin-bottom: .4rem; } }
@media print {
  @page { margin: 18mm; } body { font-size: 10pt; max-width: none; padding: 0; } nav, .command { display: none; }
  article, figure, table { break-inside: avoid; } h2, h3, h4 { break-after: avoid; }
}
";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prose_gets_subscripts_and_superscripts() {
        for (plain, html) in [
            ("p_rr = 4/5, L_i < 1", "p<sub>rr</sub> = 4/5, L<sub>i</sub> &lt; 1"),
            ("λ e^(−λx) dx", "λ e<sup>−λx</sup> dx"),
            ("cos^a θ", "cos<sup>a</sup> θ"),
            ("p_rr² (1 − p_rr)", "p<sub>rr</sub>² (1 − p<sub>rr</sub>)"),
            ("no marks", "no marks"),
            ("at the end_", "at the end<sub></sub>"),
        ] {
            assert_eq!(prose(plain).into_string(), html);
        }
    }

    #[test]
    fn counts_are_grouped_in_threes() {
        assert_eq!(
            [grouped(7), grouped(1000), grouped(1234567)],
            ["7", "1\u{202f}000", "1\u{202f}234\u{202f}567"]
        );
    }

    #[test]
    fn every_formula_becomes_mathml() {
        for question in crate::workbook::questions() {
            for latex in question.latex {
                assert!(mathml(latex).is_ok_and(|math| math.starts_with("<math")), "{latex}");
            }
        }
        assert!(mathml(r"\frac{1}").is_err());
    }
}
