//! What `--help` and `--hint` print.

use super::print::put;
use super::terminal::{folded, labelled, width};
use super::{Appendix, Options};
use crate::error::Result;
use crate::question::{Question, Values};

/// `--hint`
pub(super) fn hints(questions: &[&'static Question], options: &Options) -> Result<()> {
    let hint = |question: &&'static Question| {
        Ok(labelled(&format!("{}  ", question.id), &question.at(&options.values)?.hint, width()))
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
pub(super) fn of_appendix(appendix: &Appendix) -> Result<()> {
    let mut text = format!("{}\n\nOptions\n", appendix.about);
    if let Some(seconds) = appendix.seconds {
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
pub(super) fn of_questions(questions: &[&'static Question]) -> Result<()> {
    let mut text = String::new();
    if let [question] = questions {
        let stated = question.at(&Values::default())?;
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
