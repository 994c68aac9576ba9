//! The command line that all examples share.

use std::cell::OnceCell;
use std::io::IsTerminal;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use lexopt::{Arg, Parser};

use super::{Answer, Question, Value, print};
use crate::box_room::Scene;
use crate::error::{Error, Result};
use crate::figure::Edition;
use crate::run::{Budget, Estimator, Outcome, Run};

/// The options of an example.
#[derive(Debug, Clone)]
pub struct Options {
    /// When an estimator's run is over, instead of after each question's own number of draws.
    pub budget: Option<Budget>,
    /// The seed of every random number; 1 if none is given.
    pub seed: u64,
    /// Threads to run on; one a core if none is given. The results are the same.
    pub threads: Option<usize>,
    /// Where figures and pages go; `worksheet/` if none is given.
    pub out: PathBuf,
    /// One JSON object a line instead of text.
    pub json: bool,
    /// For whom.
    pub edition: Edition,
    given: Vec<(String, Value)>,
    question: Option<&'static Question>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            budget: None,
            seed: 1,
            threads: None,
            out: PathBuf::from("worksheet"),
            json: false,
            edition: Edition::Solution,
            given: Vec::new(),
            question: None,
        }
    }
}

/// What the command line asks for.
pub(super) enum Request {
    Help,
    Hint,
    Run(Options),
}

impl Request {
    /// The options of a run; help and hints are printed at once.
    pub fn options(self, questions: &[&Question]) -> Result<Option<Options>> {
        match self {
            Self::Help => print::help(questions).map(|()| None),
            Self::Hint => print::hints(questions).map(|()| None),
            Self::Run(options) => Ok(Some(options)),
        }
    }

    /// Reads this program's command line, with the options of these questions beside the common ones.
    pub fn read(questions: &[&'static Question]) -> Result<Self> {
        Self::parse(Parser::from_env(), questions)
    }

    pub fn parse(mut line: Parser, questions: &[&'static Question]) -> Result<Self> {
        let mut options = Options::default();
        while let Some(argument) = line.next().map_err(usage)? {
            let name = match argument {
                Arg::Short('h') => return Ok(Self::Help),
                Arg::Long(name) => name.to_owned(),
                other => return Err(usage(other.unexpected())),
            };
            match name.as_str() {
                "help" => return Ok(Self::Help),
                "hint" => return Ok(Self::Hint),
                "json" => options.json = true,
                "draws" => options.budget = Some(Budget::Draws(count(&mut line, "--draws")?)),
                "error" => options.budget = Some(Budget::StdError(positive(&mut line, "--error")?)),
                "seconds" => {
                    let seconds = positive(&mut line, "--seconds")?;
                    let time = Duration::try_from_secs_f64(seconds);
                    let too_long = |_| Error::Usage(format!("--seconds takes fewer than {seconds} seconds"));
                    options.budget = Some(Budget::Time(time.map_err(too_long)?));
                }
                "seed" => options.seed = whole(&mut line, "--seed")?,
                "threads" => options.threads = Some(count(&mut line, "--threads")? as usize),
                "out" => options.out = line.value().map_err(usage)?.into(),
                "edition" => options.edition = edition(&text(&mut line, "--edition")?)?,
                _ => {
                    let mut known = questions.iter().flat_map(|question| question.parameters);
                    let Some(parameter) = known.find(|parameter| parameter.name == name) else {
                        return Err(Error::Usage(format!("there is no option --{name}; --help lists them")));
                    };
                    let given = text(&mut line, &format!("--{name}"))?;
                    let value = parameter.default.read_alike(&given).ok_or_else(|| {
                        Error::Usage(format!("--{name} takes {}, not \"{given}\"", parameter.default.kind()))
                    })?;
                    options.given.push((name, value));
                }
            }
        }
        Ok(Self::Run(options))
    }
}

/// A command line that was not understood.
pub(super) fn usage(error: lexopt::Error) -> Error {
    Error::Usage(error.to_string())
}

pub(super) fn text(line: &mut Parser, name: &str) -> Result<String> {
    let value = line.value().map_err(usage)?;
    value.into_string().map_err(|_| Error::Usage(format!("the value of {name} is not text")))
}

pub(super) fn whole(line: &mut Parser, name: &str) -> Result<u64> {
    let given = text(line, name)?;
    given.parse().map_err(|_| Error::Usage(format!("{name} takes a whole number, not \"{given}\"")))
}

pub(super) fn count(line: &mut Parser, name: &str) -> Result<u64> {
    match whole(line, name)? {
        0 => Err(Error::Usage(format!("{name} takes a positive whole number, not 0"))),
        count => Ok(count),
    }
}

fn positive(line: &mut Parser, name: &str) -> Result<f64> {
    let given = text(line, name)?;
    let number = given.parse::<f64>().ok().filter(|number| *number > 0.0 && number.is_finite());
    number.ok_or_else(|| Error::Usage(format!("{name} takes a positive number, not \"{given}\"")))
}

fn edition(name: &str) -> Result<Edition> {
    match name {
        "student" => Ok(Edition::Student),
        "solution" => Ok(Edition::Solution),
        _ => Err(Error::Usage(format!("--edition is student or solution, not \"{name}\""))),
    }
}

impl Options {
    /// The same options, with the defaults of this question's own parameters.
    pub fn for_question(&self, question: &'static Question) -> Self {
        Self { question: Some(question), ..self.clone() }
    }

    /// The value of the question's own option `name`: as given, or its default.
    fn value(&self, name: &str) -> Option<Value> {
        let given = self.given.iter().rev().find(|(given, _)| given == name);
        let parameters = self.question.map_or(&[][..], |question| question.parameters);
        let default = || parameters.iter().find(|parameter| parameter.name == name);
        given.map(|(_, value)| *value).or_else(|| default().map(|parameter| parameter.default))
    }

    /// The number of the question's own option `name`: as given, or its default. NaN if the question has no such option.
    pub fn number(&self, name: &str) -> f64 {
        match self.value(name) {
            Some(Value::Number(number)) => number,
            _ => f64::NAN,
        }
    }

    /// The same of an option that is a count or "all", which is None. None, too, if the question has no such option.
    pub fn limit(&self, name: &str) -> Option<u32> {
        match self.value(name) {
            Some(Value::Limit(limit)) => limit,
            _ => None,
        }
    }

    /// The same of an option that is a point. NaN if the question has no such option.
    pub fn point(&self, name: &str) -> [f64; 3] {
        match self.value(name) {
            Some(Value::Point(point)) => point,
            _ => [f64::NAN; 3],
        }
    }

    /// The box room that section 4's options describe.
    pub fn scene(&self) -> Scene {
        Scene {
            wall_albedo: self.number("wall-albedo"),
            cube_albedo: self.number("cube-albedo"),
            radiance: self.number("radiance"),
            light_half_width: self.number("light-half-width"),
            point: self.point("point"),
            ..Scene::default()
        }
    }

    /// The number of an option where only a whole one ≥ 0 will do.
    ///
    /// # Errors
    /// If it is anything else.
    pub fn whole_number(&self, name: &'static str) -> Result<u64> {
        let value = self.number(name);
        if value >= 0.0 && value < u64::MAX as f64 && value.fract() == 0.0 {
            Ok(value as u64)
        } else {
            Err(Error::Usage(format!("--{name} takes a whole number, not {value}")))
        }
    }

    /// Runs an estimator until the budget that the options name is spent, `draws` times where they name none, with a progress bar on a terminal.
    ///
    /// # Errors
    /// Those of [`Run::estimate`].
    pub fn run(&self, estimator: &(impl Estimator + ?Sized), draws: u64) -> Result<Outcome> {
        let start = Instant::now();
        let bar = OnceCell::new();
        let watched = std::io::stderr().is_terminal() && !self.json;
        let progress = |done: u64, total: Option<u64>| {
            if watched && start.elapsed() > Duration::from_secs(1) {
                bar.get_or_init(|| progress_bar(total)).set_position(done);
            }
        };
        let mut run = Run::new(self.seed).progress(&progress);
        if let Some(threads) = self.threads {
            run = run.threads(threads);
        }
        let outcome = run.estimate(estimator, self.budget.unwrap_or(Budget::Draws(draws)));
        if let Some(bar) = bar.get() {
            bar.finish_and_clear();
        }
        outcome
    }

    /// Does what needs the folder for figures and pages: the folder is made first, before anything is computed for it, and goes
    /// away again if nothing came of it.
    pub(super) fn with_out(&self, work: impl FnOnce() -> Result<()>) -> Result<()> {
        let was_there = self.out.exists();
        std::fs::create_dir_all(&self.out).map_err(|error| Error::Write {
            path: self.out.display().to_string(),
            reason: error.to_string(),
        })?;
        work().inspect_err(|_| {
            if !was_there {
                // fails, as it should, if there is something in it
                let _ = std::fs::remove_dir(&self.out);
            }
        })
    }

    /// The names of those parameters that some row has otherwise than the question's options: the others stand in the command
    /// that repeats the answer.
    pub(super) fn varied<'a>(&self, answers: impl IntoIterator<Item = &'a Answer>) -> Vec<&'static str> {
        let parameters = answers.into_iter().flat_map(Answer::parameters);
        let as_given = |name: &str, value: Value| self.value(&name.replace('_', "-")) == Some(value);
        parameters.filter(|(name, value)| !as_given(name, *value)).map(|(name, _)| *name).collect()
    }

    /// The question's own options that are not at their defaults: `u = 0.3`.
    pub(super) fn own(&self, question: &Question) -> String {
        let changed = question.parameters.iter().filter_map(|parameter| {
            let value = self.value(parameter.name)?;
            (value != parameter.default).then(|| format!("{} = {}", parameter.name, value.shortened()))
        });
        changed.collect::<Vec<_>>().join(", ")
    }

    /// The command that repeats this answer.
    pub(super) fn command(&self, question: &Question) -> String {
        let mut command = format!("cargo run --release --example {} --", question.example);
        for parameter in question.parameters {
            let value = self.value(parameter.name).unwrap_or(parameter.default);
            command += &format!(" --{} {value}", parameter.name);
        }
        match self.budget {
            Some(Budget::Draws(draws)) => command += &format!(" --draws {draws}"),
            Some(Budget::StdError(error) | Budget::RelativeError(error)) => {
                command += &format!(" --error {error}")
            }
            Some(Budget::Time(time)) => command += &format!(" --seconds {}", time.as_secs_f64()),
            None => {}
        }
        command + &format!(" --seed {}", self.seed)
    }
}

fn progress_bar(total: Option<u64>) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:40} {human_pos} of {human_len} draws, {eta} to go");
    let bar = ProgressBar::new(total.unwrap_or(0));
    style.map(|style| bar.clone().with_style(style)).unwrap_or(bar)
}
