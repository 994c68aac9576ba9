//! Answers on standard output: text for people, JSON Lines for programs.

use std::io::{self, Write};
use std::iter;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::{Map, Value};

use super::answer::Unjudged;
use super::options::Voice;
use super::terminal::{command_lines, labelled, stacked, width};
use super::{Answer, Appendix, Contents, Options, repeat};
use crate::error::{Error, Result};
use crate::estimate::Estimate;
use crate::numbers::{plus_minus, rounded, shortened, std_errors};
use crate::plot::{Edition, Figure};
use crate::question::{Question, Stated};
use crate::run::Part;

/// Prints the question, before its rows are computed.
pub(super) fn heading(question: &'static Question, options: &Options) -> Result<()> {
    let stated = question.at(&options.values)?;
    if silent(options) {
        return Ok(());
    }
    if options.voice == Voice::Brief {
        return title(question.id, &stated.title, options);
    }
    let mut text = format!("\n{}  {}\n\n", question.id, stated.title);
    text += &paragraph(&stated.statement);
    if options.edition == Edition::Solution {
        text += &format!("\n{}", paragraph(&stated.answer));
        text += &format!("\n{}", labelled("    closed form  ", &stated.formula, width()));
        let changed = options.values.parameters().filter(|(parameter, value)| *value != parameter.default);
        let own: Vec<_> =
            changed.map(|(parameter, value)| format!("{} = {}", parameter.name, value.shortened())).collect();
        if !own.is_empty() {
            let own = format!("{}, instead of the sheet's", own.join(", "));
            text += &labelled("    below        ", &own, width());
        }
    }
    put(&text)
}

/// Prints the question's number and title on one line.
pub(super) fn title(id: &str, title: &str, options: &Options) -> Result<()> {
    if silent(options) { Ok(()) } else { put(&format!("{}\n", format!("{id}  {title}").trim_end())) }
}

/// Prints a row.
pub(super) fn row(answer: &Answer, options: &Options) -> Result<()> {
    let empty = !answer.is_a_number() && answer.note.is_none();
    if silent(options) || options.edition == Edition::Student || empty {
        return Ok(());
    }
    put(&format!("\n{}", solution(answer, options)))
}

/// Saves the figures, and prints what follows the rows. With --json, prints the rows.
pub(super) fn ending(question: &'static Question, answers: &[Answer], options: &Options) -> Result<()> {
    let stated = question.at(&options.values)?;
    let student = options.edition == Edition::Student;
    let mut rows = Vec::new();
    for answer in answers.iter().filter(|answer| answer.shown_in(options.edition)) {
        let paths = save(answer.figures(options.edition), options)?;
        let wanted = match options.shard {
            Some(_) => answer.outcome.as_ref().is_some_and(|outcome| outcome.part.is_some()),
            // in the student edition one row a question will do, and those with something to mark
            None => !student || rows.is_empty() || !paths.is_empty(),
        };
        if wanted {
            rows.push((answer, paths));
        }
    }
    if options.json {
        let lines = rows.iter().map(|(answer, paths)| Line::of(answer, paths, student.then_some(&stated)));
        return json(lines);
    } else if options.voice != Voice::Full {
        return Ok(());
    }
    let mut text = String::new();
    if !student && !stated.wrong.is_empty() {
        text += "\n    classic wrong answers\n";
        for (answer, slip) in &stated.wrong {
            text += &labelled("    · ", &format!("{answer}: {slip}"), width());
        }
    }
    let drawn: String = rows.iter().flat_map(|(_, paths)| figure_lines(paths)).collect();
    if !drawn.is_empty() {
        text += &format!("\n{drawn}");
    }
    if !student {
        let (command, remark) = repeat::command(question, answers, options);
        text += "\n    again\n";
        text += &command_lines(&command, width());
        if let Some(remark) = remark {
            text += &paragraph(&format!("{remark} (--verbose tells it)"));
        }
    }
    put(&text)
}

/// Saves figures, as slides, too, if they are asked for.
fn save<'f>(figures: impl IntoIterator<Item = &'f Figure>, options: &Options) -> Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for figure in figures {
        paths.extend(figure.save(&options.out)?);
        if options.slides {
            paths.extend(figure.slide().save(&options.out)?);
        }
    }
    Ok(paths)
}

/// A line for each figure; its other files have the same name.
fn figure_lines(paths: &[PathBuf]) -> impl Iterator<Item = String> {
    let drawn = paths.iter().filter(|path| path.extension().is_some_and(|ending| ending == "svg"));
    drawn.map(|path| format!("    figure       {}\n", path.display()))
}

/// Prints one line per question, once the whole worksheet is done.
pub(super) fn summary(answered: &[(&Question, Vec<Answer>)], options: &Options) -> Result<()> {
    if silent(options) || options.edition == Edition::Student {
        return Ok(());
    }
    let mut text = String::from("\n       right rows   largest |z|   seconds   besides\n");
    for (question, rows) in answered {
        let judged: Vec<bool> = rows.iter().filter_map(Answer::right).collect();
        let right = judged.iter().filter(|right| **right).count();
        let mark = match judged.len() {
            0 => "–",
            all if all == right => "✓",
            _ => "✗",
        };
        let of = if judged.is_empty() { "–".into() } else { format!("{right} of {}", judged.len()) };
        let judged_by_z = rows.iter().filter(|row| row.right().is_some()).filter_map(Answer::z);
        let largest = judged_by_z.map(f64::abs).reduce(f64::max);
        let largest = largest.map_or("–".into(), |z| format!("{z:.2}"));
        let seconds = rows.iter().filter_map(Answer::seconds).fold(0.0, |sum, seconds| sum + seconds);
        let line = format!("{:<4} {mark} {of:>10}   {largest:>11}   {seconds:>7.2}   ", question.id);
        text += &labelled(&line, &besides(rows), width());
    }
    put(&text)
}

/// How many rows are not judged, and why.
fn besides(rows: &[Answer]) -> String {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for word in rows.iter().filter(|row| row.right().is_none()).map(Answer::verdict) {
        match counts.iter_mut().find(|(known, _)| *known == word) {
            Some((_, count)) => *count += 1,
            None if word.is_empty() => {}
            None => counts.push((word, 1)),
        }
    }
    counts.iter().map(|(word, count)| format!("{count} {word}")).collect::<Vec<_>>().join(", ")
}

/// Saves an appendix's figures, and prints it.
pub(super) fn appendix(appendix: &Appendix, made: &Contents, options: &Options) -> Result<()> {
    let paths = save(&made.figures, options)?;
    if options.json {
        // the figures belong to the whole appendix, and are listed once
        let figures = iter::once(&paths[..]).chain(iter::repeat(&[][..]));
        return json(made.records.iter().zip(figures).map(|(record, paths)| Line::of(record, paths, None)));
    } else if options.voice != Voice::Full {
        return Ok(());
    }
    let mut text = format!("\n{}\n\n{}", appendix.title, paragraph(&made.text));
    for table in &made.tables {
        text += &format!("\n{}\n", paragraph(&table.caption));
        for line in stacked(table, width() - 4) {
            text += &format!("{}\n", format!("    {line}").trim_end());
        }
    }
    text += "\n";
    text.extend(figure_lines(&paths));
    put(&text)
}

/// Prints where a page is.
pub(super) fn page(path: &Path, options: &Options) -> Result<()> {
    if silent(options) { Ok(()) } else { put(&format!("\nPage: {}\n", path.display())) }
}

/// Prints a line of text.
pub(super) fn line(text: &str) -> Result<()> {
    put(&format!("{text}\n"))
}

/// Whether no text for people is printed.
fn silent(options: &Options) -> bool {
    options.json || options.voice == Voice::Quiet
}

/// A closed pipe is no error, as the reader has seen enough; a full disk is one.
pub(super) fn until_the_pipe_closes(error: io::Error) -> Result<()> {
    match error.kind() {
        io::ErrorKind::BrokenPipe => Ok(()),
        _ => Err(Error::Write { path: "standard output".into(), reason: error.to_string() }),
    }
}

/// A row for programs.
#[derive(Serialize)]
struct Line<'a> {
    question: &'a str,
    what: &'a str,
    kind: &'static str,
    parameters: Map<String, Value>,
    truth: Option<f64>,
    estimate: Option<f64>,
    std_error: Option<f64>,
    draws: Option<u64>,
    seed: Option<u64>,
    seconds: Option<f64>,
    figures: &'a [PathBuf],
    #[serde(skip_serializing_if = "Option::is_none")]
    part: Option<&'a Part>,
}

impl<'a> Line<'a> {
    /// For a student, only the question's title stands for what is answered.
    fn of(answer: &'a Answer, figures: &'a [PathBuf], for_a_student: Option<&'a Stated>) -> Self {
        let told = for_a_student.is_none();
        let estimate = answer.estimate();
        let outcome = answer.outcome.as_ref();
        Self {
            question: &answer.question,
            what: for_a_student.map_or(&answer.what, |stated| &stated.title),
            kind: if answer.unjudged.is_none() { "answer" } else { "demonstration" },
            parameters: answer.parameters_json(),
            truth: answer.truth.filter(|_| told),
            estimate: answer.found().filter(|_| told),
            std_error: estimate.and_then(Estimate::std_error),
            draws: estimate.map(Estimate::draws),
            seed: outcome.map(|outcome| outcome.seed),
            seconds: answer.seconds(),
            figures,
            part: outcome.and_then(|outcome| outcome.part.as_ref()),
        }
    }
}

fn json<'a>(mut lines: impl Iterator<Item = Line<'a>>) -> Result<()> {
    let printed = lines.try_for_each(|line| writeln!(io::stdout(), "{}", serde_json::to_string(&line)?));
    printed.or_else(until_the_pipe_closes)
}

fn solution(answer: &Answer, options: &Options) -> String {
    let width = width();
    let part = answer.question.find('(').and_then(|at| answer.question.get(at..));
    let mut title = part.map_or(String::new(), |part| format!("{part} "));
    title += &answer.what;
    for (name, value) in answer.parameters.iter().filter(|(name, value)| !as_given(name, *value, options)) {
        title += &format!(", {name} = {}", value.shortened());
    }
    let mut text = labelled("    ", &title, width);
    let verdict = answer.verdict();
    if let Some(truth) = answer.truth {
        text += &format!("        truth    {}\n", shortened(truth));
    }
    if let Some(estimate) = answer.estimate() {
        let mut line = interval(estimate);
        if estimate.draws() > 1 {
            line += " (95 %)";
        }
        if let Some(z) = answer.z().filter(|z| answer.doubt().is_none() || z.is_finite()) {
            line += &format!("   z = {}", std_errors(z));
        }
        if 17 + line.chars().count() + 3 + verdict.chars().count() < width {
            line += &format!("   {verdict}");
        } else {
            text += &format!("        estimate {line}\n");
            line = verdict.into();
        }
        let label = if line == verdict { " ".repeat(17) } else { "        estimate ".into() };
        text += &match &answer.unjudged {
            Some(Unjudged::WrongOnPurpose(why)) => {
                let fits = 17 + line.chars().count() + 2 + why.chars().count() <= width;
                if fits {
                    format!("{label}{line}: {why}\n")
                } else {
                    format!("{label}{line}:\n{}", labelled(&" ".repeat(17), why, width))
                }
            }
            _ => format!("{label}{line}\n"),
        };
    } else if let Some(value) = answer.found() {
        text += &labelled("        found    ", &format!("{}   {verdict}", shortened(value)), width);
    }
    if let Some(outcome) = answer.outcome.as_ref().filter(|_| options.verbose) {
        let (cost, draws) = (outcome.cost, outcome.estimate.draws());
        let mut took = format!("{draws} draws, {} random numbers", cost.random_numbers);
        if cost.evaluations > 0 {
            took += &format!(", {} evaluations", cost.evaluations);
        }
        took += &format!(", {:.3} s", outcome.elapsed.as_secs_f64());
        text += &labelled("        cost     ", &took, width);
    }
    for sentence in [cut_short(answer), answer.caution(), answer.note.clone()].into_iter().flatten() {
        text += &labelled("        ", &sentence, width);
    }
    text
}

/// The remark for a row that did not reach the error asked for.
pub(super) fn cut_short(answer: &Answer) -> Option<String> {
    let outcome = answer.outcome.as_ref()?;
    let (shortfall, reached) = (outcome.shortfall?, outcome.estimate.std_error()?);
    Some(format!(
        "Cut short at a std error of {}: {shortfall}. Ask for a larger error, or give a time: --seconds.",
        rounded(reached, 2)
    ))
}

/// Whether a row's parameter is the question's own: others cannot be given in the command that repeats it.
pub(super) fn as_given(name: &str, value: crate::question::Value, options: &Options) -> bool {
    options.values.value(&name.replace('_', "-")) == Some(value)
}

/// `mean ± half-width` of the 95 % interval
pub(crate) fn interval(estimate: &Estimate) -> String {
    estimate.reach().map_or_else(|| estimate.to_string(), |reach| plus_minus(estimate.mean(), reach))
}

/// Text in lines that fit, indented.
fn paragraph(text: &str) -> String {
    labelled("    ", text, width())
}

/// Writes to standard output and flushes.
pub(super) fn put(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).or_else(until_the_pipe_closes)
}
