//! Answers on standard output: text for people, JSON Lines for programs.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::answer::parameters_of;
use super::appendix::Beside;
use super::sheet::Voice;
use super::terminal::{command_lines, folded, labelled, stacked, width};
use super::{Answer, Appendix, Kind, Options, Question, Stated, shown};
use crate::error::{Error, Result};
use crate::numbers::{plus_minus, rounded, shortened, std_errors};
use crate::plot::{Edition, Figure};
use crate::run::Part;

/// Prints the question, before its rows are computed.
pub(super) fn heading(question: &'static Question, options: &Options, voice: Voice) -> Result<()> {
    let stated = question.at(options)?;
    if silent(options) {
        return Ok(());
    }
    if voice == Voice::Brief {
        return title(question.id, &stated.title, options);
    }
    let mut text = format!("\n{}  {}\n\n", question.id, stated.title);
    text += &paragraph(&stated.statement);
    if options.edition == Edition::Solution {
        text += &format!("\n{}", paragraph(&stated.answer));
        text += &format!("\n{}", labelled("    closed form  ", &stated.formula, width()));
        let own = options.own(question);
        if !own.is_empty() {
            text += &labelled("    below        ", &format!("{own}, instead of the sheet's"), width());
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
    let empty = answer.exact().is_none() && answer.found().is_none() && answer.sentence().is_none();
    if silent(options) || options.edition == Edition::Student || empty {
        return Ok(());
    }
    put(&format!("\n{}", solution(answer, options)))
}

/// Saves the figures, and prints what follows the rows. With --json, prints the rows.
pub(super) fn ending(
    question: &'static Question,
    answers: &[Answer],
    options: &Options,
    voice: Voice,
) -> Result<()> {
    let stated = question.at(options)?;
    if options.shard.is_some() {
        let mut shards = answers.iter().filter(|answer| answer.part().is_some());
        let printed = shards.try_for_each(|answer| json(&stated, answer, &[], options));
        return printed.or_else(until_the_pipe_closes);
    }
    let mut rows = Vec::new();
    for answer in answers.iter().filter(|answer| shown(answer, options.edition)) {
        let paths = save(answer.figures(options.edition), options)?;
        // in the student edition one row a question will do, and those with something to mark
        if options.edition == Edition::Solution || rows.is_empty() || !paths.is_empty() {
            rows.push((answer, paths));
        }
    }
    if options.json {
        let printed = rows.iter().try_for_each(|(answer, paths)| json(&stated, answer, paths, options));
        return printed.or_else(until_the_pipe_closes);
    } else if voice == Voice::Brief || options.quiet {
        return Ok(());
    }
    let mut text = String::new();
    if options.edition == Edition::Solution {
        if !stated.wrong.is_empty() {
            text += "\n    classic wrong answers\n";
        }
        for (answer, slip) in &stated.wrong {
            text += &labelled("    · ", &format!("{answer}: {slip}"), width());
        }
    }
    let drawn: String =
        rows.iter().flat_map(|(_, paths)| svgs(paths)).map(|path| figure_line(path)).collect();
    if !drawn.is_empty() {
        text += &format!("\n{drawn}");
    }
    if options.edition == Edition::Solution {
        let (command, remark) = options.command(question, answers.iter());
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

fn figure_line(path: &Path) -> String {
    format!("    figure       {}\n", path.display())
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
        let judged_by_z = rows.iter().filter(|row| row.agrees().is_some()).filter_map(Answer::z);
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
        let word = word.split(':').next().unwrap_or(word);
        match counts.iter_mut().find(|(known, _)| *known == word) {
            Some((_, count)) => *count += 1,
            None if word.is_empty() => {}
            None => counts.push((word, 1)),
        }
    }
    counts.iter().map(|(word, count)| format!("{count} {word}")).collect::<Vec<_>>().join(", ")
}

/// Saves an appendix's figures, and prints it if it is `wanted`.
pub(super) fn appendix(appendix: &Appendix, wanted: bool, options: &Options) -> Result<()> {
    let paths = save(&appendix.figures, options)?;
    if !wanted {
        return Ok(());
    }
    if options.json {
        let print = |(index, record)| {
            // the figures belong to the whole appendix, and are listed once
            let figures = if index == 0 { &paths[..] } else { &[] };
            writeln!(io::stdout(), "{}", serde_json::to_string(&Row::of(record, figures))?)
        };
        return appendix.records.iter().enumerate().try_for_each(print).or_else(until_the_pipe_closes);
    }
    let mut text = format!("\n{}\n\n{}", appendix.title, paragraph(&appendix.text));
    for table in &appendix.tables {
        text += &format!("\n{}\n", paragraph(&table.caption));
        for line in stacked(table, width() - 4) {
            text += &format!("{}\n", format!("    {line}").trim_end());
        }
    }
    text += "\n";
    text.extend(svgs(&paths).map(|path| figure_line(path)));
    put(&text)
}

fn svgs(paths: &[PathBuf]) -> impl Iterator<Item = &PathBuf> {
    paths.iter().filter(|path| path.extension().is_some_and(|ending| ending == "svg"))
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
    options.json || options.quiet
}

/// A closed pipe is no error, as the reader has seen enough; a full disk is one.
pub(super) fn until_the_pipe_closes(error: io::Error) -> Result<()> {
    match error.kind() {
        io::ErrorKind::BrokenPipe => Ok(()),
        _ => Err(Error::Write { path: "standard output".into(), reason: error.to_string() }),
    }
}

#[derive(Serialize)]
struct Row<'a> {
    question: &'a str,
    what: &'a str,
    kind: Kind,
    parameters: serde_json::Map<String, serde_json::Value>,
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

impl<'a> Row<'a> {
    fn of(answer: &'a Answer, figures: &'a [PathBuf]) -> Self {
        let estimate = answer.estimate();
        Self {
            question: answer.question(),
            what: answer.what(),
            kind: answer.kind(),
            parameters: parameters_of(answer),
            truth: answer.exact(),
            estimate: answer.found(),
            std_error: estimate.and_then(|estimate| estimate.std_error()),
            draws: estimate.map(|estimate| estimate.draws()),
            seed: answer.seed(),
            seconds: answer.seconds(),
            figures,
            part: answer.part(),
        }
    }

    /// The row without the answer, and with a title that does not give it away.
    fn without_answer(self, stated: &'a Stated) -> Self {
        Self {
            what: &stated.title,
            truth: None,
            estimate: None,
            std_error: None,
            draws: None,
            seed: None,
            seconds: None,
            ..self
        }
    }
}

fn json(stated: &Stated, answer: &Answer, figures: &[PathBuf], options: &Options) -> io::Result<()> {
    let row = Row::of(answer, figures);
    let row = if options.edition == Edition::Solution { row } else { row.without_answer(stated) };
    writeln!(io::stdout(), "{}", serde_json::to_string(&row)?)
}

fn solution(answer: &Answer, options: &Options) -> String {
    let width = width();
    let part = answer.question().find('(').and_then(|at| answer.question().get(at..));
    let mut title = part.map_or(String::new(), |part| format!("{part} "));
    title += answer.what();
    let otherwise = options.varied([answer]);
    for (name, value) in answer.parameters().iter().filter(|(name, _)| otherwise.contains(name)) {
        title += &format!(", {name} = {}", value.shortened());
    }
    let mut text = labelled("    ", &title, width);
    let verdict = answer.verdict();
    if let Some(truth) = answer.exact() {
        text += &format!("        truth    {}\n", shortened(truth));
    }
    if let Some(estimate) = answer.estimate() {
        let mut line = interval(answer);
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
        let why = answer.on_purpose().unwrap_or_default();
        let fits = 17 + line.chars().count() + 2 + why.chars().count() <= width;
        text += &match (why.is_empty(), fits) {
            (true, _) => format!("{label}{line}\n"),
            (_, true) => format!("{label}{line}: {why}\n"),
            _ => format!("{label}{line}:\n{}", labelled(&" ".repeat(17), why, width)),
        };
    } else if let Some(value) = answer.found() {
        text += &labelled("        found    ", &format!("{}   {verdict}", shortened(value)), width);
    }
    if options.verbose && answer.estimate().is_some() {
        text += &labelled("        cost     ", &cost(answer), width);
    }
    for sentence in
        cut_short(answer).into_iter().chain(answer.caution()).chain(answer.sentence().map(str::to_owned))
    {
        text += &labelled("        ", &sentence, width);
    }
    text
}

fn cost(answer: &Answer) -> String {
    let (cost, draws) = (answer.cost(), answer.estimate().map_or(0, |estimate| estimate.draws()));
    let mut text = format!("{draws} draws, {} random numbers", cost.random_numbers);
    if cost.evaluations > 0 {
        text += &format!(", {} evaluations", cost.evaluations);
    }
    text + &format!(", {:.3} s", answer.seconds().unwrap_or_default())
}

/// The remark for a row that did not reach the error asked for.
pub(super) fn cut_short(answer: &Answer) -> Option<String> {
    let (shortfall, reached) = (answer.shortfall()?, answer.estimate()?.std_error()?);
    Some(format!(
        "Cut short at a std error of {}: {shortfall}. Ask for a larger error, or give a time: --seconds.",
        rounded(reached, 2)
    ))
}

/// `mean ± half-width` of the 95 % interval
pub(super) fn interval(answer: &Answer) -> String {
    let Some(estimate) = answer.estimate() else { return String::new() };
    match estimate.reach() {
        Some(reach) => plus_minus(estimate.mean(), reach),
        None => estimate.to_string(),
    }
}

/// Text in lines that fit, indented.
fn paragraph(text: &str) -> String {
    labelled("    ", text, width())
}

/// Writes to standard output and flushes.
fn put(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).or_else(until_the_pipe_closes)
}

/// `--hint`
pub(super) fn hints(questions: &[&'static Question], options: &Options) -> Result<()> {
    let hint = |question: &&'static Question| {
        Ok(labelled(&format!("{}  ", question.id), &question.at(options)?.hint, width()))
    };
    put(&questions.iter().map(hint).collect::<Result<String>>()?)
}

/// Folds the help to the width of the terminal; descriptions are in a column of their own.
fn options_folded(text: &str) -> String {
    let lines = text.lines().map(|line| match line.char_indices().nth(OPTION) {
        Some((at, _)) if line.starts_with("    --") => {
            let (option, help) = line.split_at(at);
            labelled(option, help, width())
        }
        _ => folded(line, width()) + "\n",
    });
    lines.collect()
}

/// The width of the column of options in the help.
const OPTION: usize = 25;

/// `--help` of an appendix's example
pub(super) fn help_beside(beside: &Beside) -> Result<()> {
    let mut text = format!("{}\n\nOptions\n", beside.about);
    if let Some(seconds) = beside.seconds {
        text += &format!("    --seconds S          {seconds}\n");
    }
    text += "    --seed S             seed of all random numbers (1)
    --out DIR            folder for figures (worksheet)
    --slides             every figure as a slide, too, of 16 to 9 with large type
    --json               one JSON object a line
";
    put(&options_folded(&text))
}

/// `--help`
pub(super) fn help(questions: &[&'static Question]) -> Result<()> {
    let mut text = String::new();
    if let [question] = questions {
        let stated = question.at(&Options::default())?;
        text += &format!("{}  {}\n\n{}\n\n", question.id, stated.title, stated.statement);
    } else {
        text += "The worksheet: every question answered in closed form, by an estimator with its error bar, \
                 and by a figure.\n\n";
    }
    text += "Options
    --draws N            draws of every estimator (default: each question's own \
             number)
    --error E            draws until the std error is E, in the units of the answer, by \
             a pilot run: never fewer than the pilot's (10⁶ where they are cheap), and about 5 s of them a \
             row at most
    --seconds S          draws for S seconds an estimator";
    if questions.len() > 1 {
        text += " (0.1 s at most where many are compared, in the last part of the page)";
    }
    text += "\n    --seed S             seed of all random numbers (1)
    --threads T          threads (one a core; for the same draws the results are the same for any number)
    --out DIR            folder for figures and pages (worksheet)
    --slides             every figure as a slide, too, of 16 to 9 with large type
    --json               one JSON object a line
    --verbose            what every row took: draws, random numbers, evaluations, seconds
    --edition NAME       student, solution or both (solution)
    --variant NAME       the numbers of this variant; any text is a name
    --variants FILE      a worksheet for each name in a file, one a line, and one key (with worksheet)
    --shard K/N          only shard K of N of every run, for --merge (with --json)
    --merge FILE...      puts every run together from what its shards printed
    --hint               a hint that does not give the answer away
";
    for question in questions {
        for parameter in question.parameters {
            let owner = if questions.len() > 1 { format!("{}.", question.id) } else { String::new() };
            let option = format!("--{owner}{} {}", parameter.name, parameter.default.placeholder());
            text += &format!("    {option:<20} {} ({})\n", parameter.help, parameter.default);
        }
    }
    put(&options_folded(&text))
}
