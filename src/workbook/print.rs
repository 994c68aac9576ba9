//! Answers on standard output: text for people, JSON Lines for programs.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::answer::parameters_of;
use super::appendix::Beside;
use super::{Answer, Appendix, Kind, Options, Question, Stated, shown};
use crate::error::{Error, Result};
use crate::figure::Edition;
use crate::numbers::{plus_minus, rounded, shortened};
use crate::run::Part;

/// Prints the answers to one question and saves their figures.
pub(super) fn answers(question: &'static Question, answers: &[Answer], options: &Options) -> Result<()> {
    let stated = question.at(options)?;
    if options.shard.is_some() {
        let mut shards = answers.iter().filter(|answer| answer.part().is_some());
        let printed = shards.try_for_each(|answer| json(&stated, answer, &[], options));
        return printed.or_else(until_the_pipe_closes);
    }
    let mut rows = Vec::new();
    for answer in answers.iter().filter(|answer| shown(answer, options.edition)) {
        let mut paths = Vec::new();
        for figure in answer.figures(options.edition) {
            paths.extend(figure.save(&options.out)?);
        }
        // in the student edition one row a question will do, and those with something to mark
        if options.edition == Edition::Solution || rows.is_empty() || !paths.is_empty() {
            rows.push((answer, paths));
        }
    }
    if options.quiet {
        return Ok(());
    }
    let printed = if options.json {
        rows.iter().try_for_each(|(answer, paths)| json(&stated, answer, paths, options))
    } else {
        text(question, &stated, &rows, options)
    };
    printed.or_else(until_the_pipe_closes)
}

/// Saves an appendix's figures, and prints it unless it is not `wanted`.
pub(super) fn appendix(appendix: &Appendix, wanted: bool, options: &Options) -> Result<()> {
    let mut paths = Vec::new();
    for figure in &appendix.figures {
        paths.extend(figure.save(&options.out)?);
    }
    if !wanted {
        return Ok(());
    }
    let print = || -> io::Result<()> {
        let out = &mut io::stdout().lock();
        if options.json {
            for (index, record) in appendix.records.iter().enumerate() {
                // the figures belong to all of it, and are named once
                let figures = if index == 0 { &paths[..] } else { &[] };
                writeln!(out, "{}", serde_json::to_string(&Row::of(record, figures))?)?;
            }
            return Ok(());
        }
        writeln!(out, "\n{}\n", appendix.title)?;
        wrapped(out, &appendix.text)?;
        for table in &appendix.tables {
            writeln!(out, "\n    {}\n", table.caption)?;
            for line in table.lines() {
                writeln!(out, "    {line}")?;
            }
        }
        writeln!(out)?;
        for svg in svgs(&paths) {
            writeln!(out, "    figure       {}", svg.display())?;
        }
        Ok(())
    };
    print().or_else(until_the_pipe_closes)
}

fn svgs(paths: &[PathBuf]) -> impl Iterator<Item = &PathBuf> {
    paths.iter().filter(|path| path.extension().is_some_and(|ending| ending == "svg"))
}

/// A last line of the worksheet: where a page is.
pub(super) fn page(path: &Path, options: &Options) -> Result<()> {
    if options.json || options.quiet {
        return Ok(());
    }
    writeln!(io::stdout(), "\nPage: {}", path.display()).or_else(until_the_pipe_closes)
}

/// A line for people.
pub(super) fn line(text: &str) -> Result<()> {
    writeln!(io::stdout(), "{text}").or_else(until_the_pipe_closes)
}

/// A reader that has seen enough is no error; a full disk is.
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

    /// Nothing of the answer, and a name that does not tell it.
    fn untold(self, stated: &'a Stated) -> Self {
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
    let row = if options.edition == Edition::Solution { row } else { row.untold(stated) };
    writeln!(io::stdout(), "{}", serde_json::to_string(&row)?)
}

fn text(
    question: &Question,
    stated: &Stated,
    rows: &[(&Answer, Vec<PathBuf>)],
    options: &Options,
) -> io::Result<()> {
    let out = &mut io::stdout().lock();
    writeln!(out, "\n{}  {}\n", question.id, stated.title)?;
    wrapped(out, &stated.statement)?;
    if options.edition == Edition::Solution {
        writeln!(out, "\n    closed form  {}", stated.formula)?;
        let own = options.own(question);
        if !own.is_empty() {
            writeln!(out, "    below        {own}, instead of the sheet's")?;
        }
    }
    let varied = options.varied(rows.iter().map(|(answer, _)| *answer));
    for (answer, paths) in rows {
        if options.edition == Edition::Solution {
            writeln!(out)?;
            solution(out, answer, &varied)?;
        }
        for svg in svgs(paths) {
            writeln!(out, "    figure       {}", svg.display())?;
        }
    }
    let solved = options.edition == Edition::Solution;
    if solved && !stated.wrong.is_empty() {
        writeln!(out, "\n    classic wrong answers")?;
    }
    for (answer, slip) in stated.wrong.iter().filter(|_| solved) {
        wrapped(out, &format!("· {answer}: {slip}"))?;
    }
    if options.edition == Edition::Solution {
        let (command, remark) = options.command(question, rows.iter().map(|(answer, _)| *answer));
        writeln!(out, "\n    again        {command}")?;
        if let Some(remark) = remark {
            writeln!(out, "                 {remark}")?;
        }
    }
    Ok(())
}

fn solution(out: &mut impl Write, answer: &Answer, varied: &[&str]) -> io::Result<()> {
    write!(out, "    {}  {}", answer.question(), answer.what())?;
    for (name, value) in answer.parameters().iter().filter(|(name, _)| varied.contains(name)) {
        write!(out, ", {name} = {}", value.shortened())?;
    }
    writeln!(out)?;
    if let Some(truth) = answer.exact() {
        writeln!(out, "        truth    {}", shortened(truth))?;
    }
    if let Some(estimate) = answer.estimate() {
        write!(out, "        estimate {}", interval(answer))?;
        if estimate.draws() > 1 {
            write!(out, " (95 %)")?;
        }
        let too_few = answer.too_few_draws();
        if let Some(z) = answer.z().filter(|z| !too_few || z.is_finite()) {
            write!(out, "   z = {z:.2}")?;
        }
        if too_few {
            write!(out, "   {TOO_FEW}")?;
        }
        match answer.agrees() {
            Some(true) => write!(out, "   ✓")?,
            Some(false) => write!(out, "   ✗")?,
            None => {}
        }
        let cost = answer.cost();
        write!(out, "\n        cost     {} draws, {} random numbers", estimate.draws(), cost.random_numbers)?;
        if cost.evaluations > 0 {
            write!(out, ", {} evaluations", cost.evaluations)?;
        }
        if answer.pilot_never_varied() {
            write!(out, ", the pilot run never varied")?;
        }
        let seed = answer.seed().unwrap_or_default();
        writeln!(out, ", {:.3} s, seed {seed}", answer.seconds().unwrap_or_default())?;
    } else if let Some(value) = answer.found() {
        writeln!(out, "        found    {}", shortened(value))?;
    }
    for note in cut_short(answer).as_deref().into_iter().chain(answer.sentence()) {
        wrapped(out, note)?;
    }
    Ok(())
}

/// Instead of ✓ or ✗.
pub(super) const TOO_FEW: &str = "too few draws to judge";

/// What a row says that did not reach the error asked for.
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

/// Text in lines of at most 96 characters, indented.
fn wrapped(out: &mut impl Write, text: &str) -> io::Result<()> {
    let mut line = String::from("   ");
    for word in text.split_whitespace() {
        if line.chars().count() + 1 + word.chars().count() > 96 {
            writeln!(out, "{line}")?;
            line = String::from("   ");
        }
        line.push(' ');
        line.push_str(word);
    }
    writeln!(out, "{line}")
}

/// `--hint`
pub(super) fn hints(questions: &[&'static Question], options: &Options) -> Result<()> {
    for question in questions {
        let hint = question.at(options)?.hint;
        writeln!(io::stdout(), "{}  {hint}", question.id).or_else(until_the_pipe_closes)?;
    }
    Ok(())
}

/// `--help` of an example beside the questions
pub(super) fn help_beside(beside: &Beside) -> Result<()> {
    let mut text = format!("{}\n\nOptions\n", beside.about);
    if let Some(seconds) = beside.seconds {
        text += &format!("    --seconds S          {seconds}\n");
    }
    text += "    --seed S             seed of all random numbers (1)
    --out DIR            folder for figures (worksheet)
    --json               one JSON object a line
";
    write!(io::stdout(), "{text}").or_else(until_the_pipe_closes)
}

/// `--help`
pub(super) fn help(questions: &[&'static Question]) -> Result<()> {
    let mut text = String::new();
    if let [question] = questions {
        let stated = question.at(&Options::default())?;
        text += &format!("{}  {}\n\n{}\n\n", question.id, stated.title, stated.statement);
    } else {
        text += "The worksheet: every question in closed form, by an estimator with its error bar, and in a picture.\n\n";
    }
    text += "Options
    --draws N            draws of every estimator (default: each question's own number)
    --error E            draws until the std error is E, in the units of the answer, by a pilot run: never fewer
                         than the pilot's (10⁶ where they are cheap), and about 5 s of them a row at most
    --seconds S          draws for S seconds an estimator
";
    if questions.len() > 1 {
        text += "                         (0.1 s at most where many are compared, in the last part of the page)\n";
    }
    text += "    --seed S             seed of all random numbers (1)
    --threads T          threads (one a core; for the same draws the results are the same for any number)
    --out DIR            folder for figures and pages (worksheet)
    --json               one JSON object a line
    --edition NAME       student, solution or both (solution)
    --shard K/N          only shard K of N of every run, for --merge (with --json)
    --merge FILE...      puts every run together from what its shards printed
    --variant NAME       numbers of a variant's own: any text names one
    --variants FILE      a worksheet for each name in a file, one a line, and one key (with worksheet)
    --hint               a nudge that does not tell the answer
";
    for question in questions {
        for parameter in question.parameters {
            let owner = if questions.len() > 1 { format!("{}.", question.id) } else { String::new() };
            let option = format!("--{owner}{} {}", parameter.name, parameter.default.placeholder());
            text += &format!("    {option:<20} {} ({})\n", parameter.help, parameter.default);
        }
    }
    write!(io::stdout(), "{text}").or_else(until_the_pipe_closes)
}
