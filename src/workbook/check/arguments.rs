//! The command line of `check_mine`.

use lexopt::{Arg, Parser};

use super::super::{command_line, questions};
use super::draws::Source;
use super::programs::Language;
use crate::error::{Error, Result};
use crate::question::parameter;
use crate::run::Budget;

/// What is to be judged or printed.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) enum Action {
    #[default]
    Mine,
    Help,
    Probes,
    Mistakes,
    Template(Language),
    Answer(String),
    Draws(Vec<Source>),
    Class,
}

/// What the command line asks for.
#[derive(Default)]
pub(super) struct Arguments {
    pub question: String,
    pub action: Action,
    /// A file of a class's answers, and a folder of their draws.
    pub answers: Option<String>,
    pub draws_in: Option<String>,
    pub own: Vec<(String, String)>,
    pub variant: Option<String>,
    pub digits: Option<u32>,
    pub budget: Option<Budget>,
    pub seed: u64,
    pub json: bool,
    pub csv: bool,
    pub exit_code: bool,
}

impl Arguments {
    pub fn read(question: &str) -> Result<Self> {
        let mut line = Parser::from_env();
        let mut arguments = Self { question: question.into(), seed: 1, ..Self::default() };
        let (mut probe, mut about_estimator) = (None, None);
        let mut actions: Vec<(&'static str, Action)> = Vec::new();
        while let Some(argument) = line.next().map_err(command_line::usage)? {
            let name = match argument {
                Arg::Short('h') | Arg::Long("help") => {
                    arguments.action = Action::Help;
                    return Ok(arguments);
                }
                Arg::Long(name) => name.to_owned(),
                other => return Err(command_line::usage(other.unexpected())),
            };
            match name.as_str() {
                "question" => arguments.question = command_line::text(&mut line, "--question")?,
                "json" => arguments.json = true,
                "csv" => arguments.csv = true,
                "exit-code" => arguments.exit_code = true,
                "probes" => actions.push(("--probes", Action::Probes)),
                "mistakes" => actions.push(("--mistakes", Action::Mistakes)),
                "template" => {
                    let language = Language::read(&command_line::text(&mut line, "--template")?)?;
                    actions.push(("--template", Action::Template(language)));
                }
                "answer" => {
                    actions.push(("--answer", Action::Answer(command_line::text(&mut line, "--answer")?)))
                }
                "variant" => arguments.variant = Some(command_line::text(&mut line, "--variant")?),
                "digits" => {
                    arguments.digits = Some(command_line::count(&mut line, "--digits")?.min(15) as u32)
                }
                "draws-from" => {
                    let files: Vec<_> = line.values().map_err(command_line::usage)?.collect();
                    let text = |file: std::ffi::OsString| file.into_string().ok();
                    let files: Option<Vec<String>> = files.into_iter().map(text).collect();
                    let files =
                        files.ok_or_else(|| Error::Usage("the value of --draws-from is not text".into()))?;
                    let sources = files.iter().map(|file| Source::read(file)).collect();
                    actions.push(("--draws-from", Action::Draws(sources)));
                }
                "probe" => probe = Some(command_line::count(&mut line, "--probe")? as usize),
                "answers" => {
                    arguments.answers = Some(command_line::text(&mut line, "--answers")?);
                    actions.push(("--answers", Action::Class));
                }
                "draws-in" => {
                    arguments.draws_in = Some(command_line::text(&mut line, "--draws-in")?);
                    actions.push(("--draws-in", Action::Class));
                }
                "draws" | "error" | "seconds" => {
                    command_line::read_budget(&mut line, &name, &mut arguments.budget)?;
                    about_estimator = Some(format!("--{name}"));
                }
                "seed" => {
                    about_estimator = Some("--seed".into());
                    arguments.seed = command_line::whole(&mut line, "--seed")?;
                }
                _ => {
                    parameter(questions(), &name, &name)?;
                    let value = command_line::text(&mut line, &format!("--{name}"))?;
                    arguments.own.push((name, value));
                }
            }
        }
        arguments.action = one_of(actions, about_estimator.as_deref())?;
        match (&mut arguments.action, probe) {
            (Action::Draws(sources), Some(probe)) => match &mut sources[..] {
                [Source { probe: unnamed @ None, .. }] => *unnamed = Some(probe),
                _ => return Err(Error::Usage("--probe works with one file of draws only".into())),
            },
            (_, Some(_)) => {
                return Err(Error::Usage("--probe needs --draws-from".into()));
            }
            _ => {}
        }
        let judged = matches!(arguments.action, Action::Answer(_) | Action::Class);
        if let (false, Some((name, _))) = (judged, arguments.own.first()) {
            return Err(Error::Usage(format!(
                "--{name} is for numbers worked out by hand: it needs --answer or --answers"
            )));
        }
        let beside = [("digits", arguments.digits.is_some()), ("variant", arguments.variant.is_some())];
        if let (false, Some((name, _))) = (judged, beside.iter().find(|(_, given)| *given)) {
            return Err(Error::Usage(format!("--{name} needs --answer or --answers")));
        }
        if arguments.csv && (arguments.json || !matches!(arguments.action, Action::Class)) {
            return Err(Error::Usage("--csv needs --answers or --draws-in, and excludes --json".into()));
        }
        Ok(arguments)
    }
}

/// The one action asked for; for a class, answers, draws or both.
fn one_of(actions: Vec<(&'static str, Action)>, about_estimator: Option<&str>) -> Result<Action> {
    let apart = |before: &str, name: &str| {
        Err(Error::Usage(format!("{before} and {name} cannot be combined: give one of them")))
    };
    let mut given = None::<(&'static str, Action)>;
    for (name, action) in actions {
        match given {
            // if the same option is given again, the last one counts
            Some((before, other)) if before != name && (other != Action::Class || action != other) => {
                return apart(before, name);
            }
            _ => given = Some((name, action)),
        }
    }
    match (given, about_estimator) {
        (Some((name, _)), Some(other)) => apart(name, other),
        (given, _) => Ok(given.map_or(Action::Mine, |(_, action)| action)),
    }
}

pub(super) const HELP: &str =
    "Checks your own estimator, written in examples/check_mine.rs, or numbers worked out by hand.

    cargo run --release --example check_mine
    cargo run --release --example check_mine -- --question 1.2 --answer 0.602

A program in another language reads the question's probes, and writes a probe's number and a draw a
line (CHECK stands for cargo run --release --example check_mine -- --question 3.5):

    CHECK --template python > mine.py
    CHECK --probes | python3 mine.py | CHECK --draws-from -

Options
    --question Q         the worksheet's number (default: the one in the file)
    --draws N            draws of your estimator on each probe (1000000)
    --error E            instead: draws until the ratio to the truth has the std error E, by a pilot
                         run: never fewer than the pilot's, and about 5 s of them a probe at most
    --seconds S          instead: draws for S seconds a probe
    --seed S             their seed (1)
    --answer TEXT        judge this number, fraction or expression: 1.386, 16/125, 2ρ/π
    --digits N           require at least N significant digits
    --albedo X, …        the question's own parameters, as in its example
    --variant NAME       or the parameters of the variant of this name
    --probes             describe the question's probes, for people and programs
    --mistakes           what each classic mistake does to each probe: its mean over the truth
    --template LANG      a program to fill in: python or cpp
    --draws-from FILE    judge these draws (- for standard input), one a line, or a probe's number
                         and a draw a line; or several files: 1=a.txt 2=b.txt
    --probe N            which probe the draws of one file are for (1)
    --answers FILE       judge a class: CSV with the columns student, question, answer
    --draws-in FOLDER    and their draws, in files STUDENT_QUESTION.txt
    --csv                the report on a class as CSV
    --json               JSON, one object a line
    --exit-code          exit with 0 for right, 1 for wrong, 2 for undecided";
