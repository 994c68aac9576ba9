//! Plain text, counts and LaTeX as HTML.

use std::mem;

use maud::{Markup, PreEscaped, html};
use pulldown_latex::{Parser, RenderConfig, Storage, push_mathml};

use crate::error::{Error, Result};

/// Plain text as HTML, with x_i as subscripts, and x^n and x^(…) as superscripts.
pub(super) fn prose(text: &str) -> Markup {
    let mut html = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(['_', '^']) {
        let (before, mark) = rest.split_at(at);
        html += &escaped(before);
        let after = mark.get(1..).unwrap_or_default();
        if mark.starts_with('_') && ends_in_a_name(before) {
            html.push('_');
            rest = after;
            continue;
        }
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

/// Whether a character belongs to the sub- or superscript; not ², which is numeric but a superscript itself.
fn shifts(c: char) -> bool {
    c.is_alphabetic() || c.is_ascii_digit()
}

/// Whether a `_` after this belongs to a program's name such as `ln_1p`: a letter with a subscript stands
/// alone.
fn ends_in_a_name(before: &str) -> bool {
    let reversed = || before.chars().rev();
    let letters = reversed().take_while(char::is_ascii_alphabetic).count();
    letters > 1 && reversed().nth(letters).is_none_or(|c| !c.is_alphabetic())
}

fn escaped(text: &str) -> String {
    html! { (text) }.into_string()
}

/// A count with its digits in groups of three.
pub(super) fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let thirds = digits.bytes().enumerate().map(|(i, digit)| {
        let gap = if i > 0 && (digits.len() - i).is_multiple_of(3) { "\u{202f}" } else { "" };
        format!("{gap}{}", char::from(digit))
    });
    thirds.collect()
}

/// A displayed formula, which may be broken at `\quad` and before each relation.
pub(super) fn formula(latex: &str) -> Result<Markup> {
    let mut parts = Vec::new();
    for part in pieces(latex) {
        parts.push(part.iter().map(|piece| mathml(piece)).collect::<Result<Vec<_>>>()?);
    }
    Ok(html! {
        div.formula {
            @for part in &parts {
                span.part { @for piece in part { (PreEscaped(piece)) " " } } " "
            }
        }
    })
}

/// Relations before which a formula may be broken. The new piece starts with `{}`, which keeps the space
/// around the relation.
const RELATIONS: [&str; 7] = ["=", r"\approx", r"\to", r"\xrightarrow", r"\propto", r"\le", r"\ge"];

/// LaTeX split at `\quad` into parts, and these before relations into pieces, outside of all brackets.
fn pieces(latex: &str) -> Vec<Vec<String>> {
    let mut parts = Vec::new();
    let (mut part, mut piece) = (Vec::new(), String::new());
    let mut depth = 0i32;
    let mut rest = latex;
    while let Some(first) = rest.chars().next() {
        let length = match rest.strip_prefix('\\') {
            None => first.len_utf8(),
            Some(name) => match name.find(|c: char| !c.is_ascii_alphabetic()) {
                Some(0) => 1 + name.chars().next().map_or(0, char::len_utf8),
                Some(end) => 1 + end,
                None => rest.len(),
            },
        };
        let (token, after) = rest.split_at(length);
        match token {
            "{" | "(" | "[" | r"\{" | r"\lVert" => depth += 1,
            "}" | ")" | "]" | r"\}" | r"\rVert" => depth -= 1,
            _ => {}
        }
        match token {
            r"\quad" | r"\qquad" if depth == 0 => {
                part.push(mem::take(&mut piece));
                parts.push(mem::take(&mut part));
            }
            relation if depth == 0 && RELATIONS.contains(&relation) => {
                part.push(mem::replace(&mut piece, format!("{{}} {relation}")));
            }
            _ => piece += token,
        }
        rest = after;
    }
    part.push(piece);
    parts.push(part);
    for part in &mut parts {
        part.retain(|piece| !piece.trim().is_empty());
    }
    parts.retain(|part| !part.is_empty());
    parts
}

fn mathml(latex: &str) -> Result<String> {
    let storage = Storage::new();
    let failed = |reason: String| Error::Draft { what: format!("the formula {latex}"), reason };
    // pulldown-latex writes errors into its output, so look for them first
    if let Some(Err(error)) = Parser::new(latex, &storage).find(|event| event.is_err()) {
        return Err(failed(error.to_string()));
    }
    let mut mathml = String::new();
    push_mathml(&mut mathml, Parser::new(latex, &storage), RenderConfig::default())
        .map_err(|error| failed(error.to_string()))?;
    // a space in LaTeX is written with its & escaped
    let mathml = mathml.replace("&amp;nbsp;", "\u{a0}");
    Ok(mathml.replacen("<math display=\"inline\"", "<math displaystyle=\"true\"", 1))
}

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
            ("L̂_r, dω_i and ρL_i", "L̂<sub>r</sub>, dω<sub>i</sub> and ρL<sub>i</sub>"),
            ("ln_1p and −exp_m1", "ln_1p and −exp_m1"),
            ("no marks", "no marks"),
            ("at the end_", "at the end_"),
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
            for latex in &question.at(&crate::question::Values::default()).unwrap().latex {
                let html = formula(latex).unwrap().into_string();
                assert!(html.contains("<math displaystyle=\"true\">") && !html.contains("nbsp"), "{latex}");
            }
        }
        assert!(formula(r"\frac{1}").is_err());
    }

    #[test]
    fn formulas_break_outside_of_brackets_only() {
        assert_eq!(
            pieces(r"P(N = k) = \frac{a = b}{c} = 1, \qquad x \to y"),
            [&["P(N = k) ", r"{} = \frac{a = b}{c} ", "{} = 1, "][..], &[" x ", r"{} \to y"]]
        );
        assert_eq!(pieces(r"x \leftarrow y"), [[r"x \leftarrow y"]]);
    }
}
