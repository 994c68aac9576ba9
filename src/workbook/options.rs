//! The command line that all examples share.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::mem;
use std::path::PathBuf;
use std::rc::Rc;
use std::time::Duration;

use lexopt::{Arg, Parser};

use super::appendix::Beside;
use super::progress::watched;
use super::shards::Shards;
use super::{Answer, Parameter, Question, Value, print};
use crate::error::{Error, Result};
use crate::estimator::Estimator;
use crate::numbers::parseable;
use crate::paths::room::Scene;
use crate::plot::Edition;
use crate::run::{Budget, Outcome, Run};

/// The options of an example.
#[derive(Debug, Clone)]
pub struct Options {
    /// When an estimator's run ends; `None` is each question's own number of draws.
    pub budget: Option<Budget>,
    /// The seed of all random numbers; 1 by default.
    pub seed: u64,
    /// The number of threads; one per core by default. It does not change the results of the same draws.
    pub threads: Option<usize>,
    /// The folder for figures and pages; `worksheet/` by default.
    pub out: PathBuf,
    /// Print one JSON object per line instead of text.
    pub json: bool,
    /// Print what every row took, and all rows of a worksheet.
    pub verbose: bool,
    /// The student's edition or the solution.
    pub edition: Edition,
    /// Whether the other edition is made, too.
    pub(super) both: bool,
    /// The shard of every run to draw, and the number of shards. A shard makes no figures.
    pub shard: Option<[u64; 2]>,
    /// Whether every figure is made as a slide, too.
    pub slides: bool,
    /// A file of names, each of which gets its own worksheet.
    pub(super) variants: Option<PathBuf>,
    /// Print only where files are.
    pub(super) quiet: bool,
    /// The worksheet's title.
    pub(super) title: String,
    /// Make only the first figure of each question: the one that a key has on paper.
    pub(super) one_figure: bool,
    /// The shards from which every run is merged, instead of drawing it.
    pub(super) shards: Option<Rc<Shards>>,
    given: Vec<Given>,
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
            verbose: false,
            edition: Edition::Solution,
            both: false,
            shard: None,
            slides: false,
            variants: None,
            quiet: false,
            title: String::new(),
            one_figure: false,
            shards: None,
            given: Vec::new(),
            question: None,
        }
    }
}

/// A question's own option, as given.
#[derive(Debug, Clone)]
struct Given {
    /// The question, if the option names it, as `--5.2.p-rr` does; else it is for every question that has it.
    of: Option<String>,
    name: &'static str,
    value: Value,
}

/// Whose command line it is.
#[derive(Clone, Copy)]
pub(super) enum Asked<'q> {
    /// Of these questions' example, or of the worksheet.
    Questions(&'q [&'static Question]),
    /// Of an appendix's example.
    Beside(&'static Beside),
}

/// What the command line asks for.
pub(super) enum Request {
    Help,
    Hint(Options),
    Run(Options),
}

impl Request {
    /// The options of a run; help and hints are printed here.
    pub fn options(self, asked: Asked<'_>) -> Result<Option<Options>> {
        match (self, asked) {
            (Self::Run(options), _) => Ok(Some(options)),
            (Self::Help, Asked::Questions(questions)) => print::help(questions).map(|()| None),
            (_, Asked::Beside(beside)) => print::help_beside(beside).map(|()| None),
            (Self::Hint(options), Asked::Questions(questions)) => {
                print::hints(questions, &options).map(|()| None)
            }
        }
    }

    /// Reads this program's command line, with the questions' own options and the common ones.
    pub fn read(asked: Asked<'_>) -> Result<Self> {
        Self::parse(Parser::from_env(), asked)
    }

    pub fn parse(mut line: Parser, asked: Asked<'_>) -> Result<Self> {
        let (mut options, mut hint, mut variant) = (Options::default(), false, None);
        let questions = match asked {
            Asked::Questions(questions) => questions,
            Asked::Beside(_) => &[],
        };
        while let Some(argument) = line.next().map_err(usage)? {
            let name = match argument {
                Arg::Short('h') => return Ok(Self::Help),
                Arg::Long(name) => name.to_owned(),
                other => return Err(usage(other.unexpected())),
            };
            if let Asked::Beside(beside) = asked {
                beside.take(&name)?;
            }
            match name.as_str() {
                "help" => return Ok(Self::Help),
                "hint" => hint = true,
                "json" => options.json = true,
                "verbose" => options.verbose = true,
                "slides" => options.slides = true,
                "draws" | "error" | "seconds" => read_budget(&mut line, &name, &mut options.budget)?,
                "seed" => options.seed = whole(&mut line, "--seed")?,
                "threads" => options.threads = Some(count(&mut line, "--threads")? as usize),
                "out" => options.out = line.value().map_err(usage)?.into(),
                "shard" => options.shard = Some(shard(&text(&mut line, "--shard")?)?),
                "merge" => {
                    let files: Vec<PathBuf> = line.values().map_err(usage)?.map(PathBuf::from).collect();
                    options.shards = Some(Rc::new(Shards::read(&files)?));
                }
                "variants" => options.variants = Some(line.value().map_err(usage)?.into()),
                "variant" => variant = Some(text(&mut line, "--variant")?),
                "edition" => (options.edition, options.both) = edition(&text(&mut line, "--edition")?)?,
                _ => {
                    let (of, own) = match name.rsplit_once('.') {
                        Some((id, own)) => (Some(id), own),
                        None => (None, name.as_str()),
                    };
                    let asked = questions.iter().copied().filter(|asked| of.is_none_or(|id| asked.id == id));
                    let parameter = parameter(asked, own, &name)?;
                    let value = parameter.read(&text(&mut line, &format!("--{name}"))?)?;
                    options.given.push(Given { of: of.map(str::to_owned), name: parameter.name, value });
                }
            }
        }
        if options.variants.is_some() && questions.len() == 1 {
            return Err(Error::Usage("--variants works with the example worksheet only".into()));
        }
        if let Some(name) = variant {
            options = options.variant(&name, questions.iter().copied())?;
        }
        if hint {
            return Ok(Self::Hint(options));
        }
        let cut = options.shard.is_some();
        if cut && options.shards.is_some() {
            return Err(Error::Usage("--shard and --merge cannot be combined: give one of them".into()));
        } else if (cut || options.shards.is_some()) && questions.len() != 1 {
            return Err(Error::Usage(
                "--shard and --merge work with the example of one question only".into(),
            ));
        } else if cut && !options.json {
            return Err(Error::Usage("--shard needs --json, which --merge reads".into()));
        } else if cut && !matches!(options.budget, None | Some(Budget::Draws(_))) {
            return Err(Error::Usage(
                "--shard excludes --error and --seconds: only a number of draws can be divided".into(),
            ));
        }
        Ok(Self::Run(options))
    }
}

/// What the option `name` of one of these questions sets.
pub(super) fn parameter(
    questions: impl IntoIterator<Item = &'static Question>,
    name: &str,
    option: &str,
) -> Result<&'static Parameter> {
    let mut known = questions.into_iter().flat_map(|question| question.parameters);
    let unknown = || Error::Usage(format!("there is no option --{option}; --help lists them"));
    known.find(|parameter| parameter.name == name).ok_or_else(unknown)
}

impl Parameter {
    /// A value given for it.
    fn read(&self, given: &str) -> Result<Value> {
        let kind = self.default.kind();
        let unread = || Error::Usage(format!("--{} takes {kind}, not \"{given}\"", self.name));
        self.default.read_alike(given).ok_or_else(unread)
    }
}

/// Reads the value of --draws, --error or --seconds, of which only one may be given.
pub(super) fn read_budget(line: &mut Parser, name: &str, budget: &mut Option<Budget>) -> Result<()> {
    let read = match name {
        "draws" => Budget::Draws(count(line, "--draws")?),
        "error" => Budget::StdError(positive(line, "--error")?),
        _ => Budget::Time(seconds(line)?),
    };
    // if the same option is given again, the last one counts, as for all options
    if budget.is_some_and(|given| mem::discriminant(&given) != mem::discriminant(&read)) {
        return Err(Error::Usage("--draws, --error and --seconds each end a run: give one of them".into()));
    }
    *budget = Some(read);
    Ok(())
}

/// The error for a command line that was not understood.
pub(super) fn usage(error: lexopt::Error) -> Error {
    Error::Usage(error.to_string())
}

pub(super) fn text(line: &mut Parser, name: &str) -> Result<String> {
    let value = line.value().map_err(usage)?;
    value.into_string().map_err(|_| Error::Usage(format!("the value of {name} is not text")))
}

pub(super) fn whole(line: &mut Parser, name: &str) -> Result<u64> {
    let given = text(line, name)?;
    whole_of(&given).ok_or_else(|| Error::Usage(format!("{name} takes a whole number, not \"{given}\"")))
}

/// A whole number, written 1000000, 1_000_000 or 1e6.
fn whole_of(given: &str) -> Option<u64> {
    let digits = given.bytes().next().is_some_and(|first| first.is_ascii_digit());
    let plain = given.replace('_', "");
    let exact = |number: &f64| number.fract() == 0.0 && (0.0..=9e15).contains(number);
    let scientific = || plain.parse().ok().filter(exact).map(|number| number as u64);
    plain.parse().ok().or_else(scientific).filter(|_| digits)
}

pub(super) fn count(line: &mut Parser, name: &str) -> Result<u64> {
    match whole(line, name)? {
        0 => Err(Error::Usage(format!("{name} takes a positive whole number, not 0"))),
        count => Ok(count),
    }
}

fn positive(line: &mut Parser, name: &str) -> Result<f64> {
    number_above_zero(&text(line, name)?, name)
}

fn number_above_zero(given: &str, name: &str) -> Result<f64> {
    let number = given.parse::<f64>().ok().filter(|number| *number > 0.0 && number.is_finite());
    number.ok_or_else(|| Error::Usage(format!("{name} takes a positive number, not \"{given}\"")))
}

/// A time that a clock can measure and a `Duration` can hold.
fn seconds(line: &mut Parser) -> Result<Duration> {
    let given = text(line, "--seconds")?;
    let seconds = number_above_zero(&given, "--seconds")?;
    let time = Duration::try_from_secs_f64(seconds).ok().filter(|time| !time.is_zero());
    time.ok_or_else(|| Error::Usage(format!("--seconds takes a number from 1e-9 to 1e19, not \"{given}\"")))
}

/// `3/8`
fn shard(given: &str) -> Result<[u64; 2]> {
    let parts = given.split_once('/').and_then(|(k, of)| Some([k.parse().ok()?, of.parse().ok()?]));
    parts
        .filter(|[k, of]| (1..=*of).contains(k))
        .ok_or_else(|| Error::Usage(format!("--shard takes one of 1/N to N/N, not \"{given}\"")))
}

/// The edition, and whether both are made.
fn edition(name: &str) -> Result<(Edition, bool)> {
    match name.to_lowercase().as_str() {
        "student" => Ok((Edition::Student, false)),
        "solution" => Ok((Edition::Solution, false)),
        "both" => Ok((Edition::Solution, true)),
        _ => Err(Error::Usage(format!("--edition is student, solution or both, not \"{name}\""))),
    }
}

impl Options {
    /// The same options, with the defaults of this question's own parameters.
    pub fn for_question(&self, question: &'static Question) -> Self {
        Self { question: Some(question), ..self.clone() }
    }

    /// Sets the question's own option `name` to a value as the command line takes it: "0.8", "4/5".
    ///
    /// # Errors
    /// If the question has no such option, or it does not take that.
    pub fn set(&mut self, question: &'static Question, name: &str, given: &str) -> Result<()> {
        let parameter = parameter([question], name, name)?;
        let given = Given { of: None, name: parameter.name, value: parameter.read(given)? };
        self.given.push(given);
        Ok(())
    }

    /// Adds other options with lower priority: what is set here takes precedence.
    pub(super) fn put_below(&mut self, mut below: Self) {
        below.given.append(&mut self.given);
        self.given = below.given;
    }

    /// The same options, but for this question alone.
    pub(super) fn for_alone(self, question: &Question) -> Self {
        let mut alone = Self::default();
        alone.take_for(question, self);
        alone
    }

    /// Adds other options, for this question alone.
    pub(super) fn take_for(&mut self, question: &Question, options: Self) {
        let of = |given| Given { of: Some(question.id.to_owned()), ..given };
        self.given.extend(options.given.into_iter().map(of));
    }

    /// The value of the question's own option `name`: as given, else its default.
    fn value(&self, name: &str) -> Option<Value> {
        let id = self.question.map(|question| question.id);
        let own = |given: &&Given| given.name == name && given.of.as_deref().is_none_or(|of| Some(of) == id);
        let given = self.given.iter().rev().find(own);
        let parameters = self.question.map_or(&[][..], |question| question.parameters);
        let default = || parameters.iter().find(|parameter| parameter.name == name);
        given.map(|given| given.value).or_else(|| default().map(|parameter| parameter.default))
    }

    /// The question's own options, with their values.
    pub(super) fn parameters(&self) -> impl Iterator<Item = (&'static str, Value)> {
        let parameters = self.question.map_or(&[][..], |question| question.parameters).iter();
        parameters.filter_map(|parameter| Some((parameter.name, self.value(parameter.name)?)))
    }

    /// The value of the question's own option `name`, a number: as given, else its default. NaN if the
    /// question has no such option.
    pub fn number(&self, name: &str) -> f64 {
        match self.value(name) {
            Some(Value::Number(number)) => number,
            _ => f64::NAN,
        }
    }

    /// The value of an option that is a count, or `None` for "all". `None`, too, if the question has no such
    /// option.
    pub fn limit(&self, name: &str) -> Option<u32> {
        match self.value(name) {
            Some(Value::Limit(limit)) => limit,
            _ => None,
        }
    }

    /// The value of an option that is a point. NaN if the question has no such option.
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

    /// The value of an option that must be a whole number ≥ 0.
    ///
    /// # Errors
    /// If it is anything else.
    pub fn whole_number(&self, name: &'static str) -> Result<u64> {
        let value = self.number(name);
        if value >= 0.0 && value < u64::MAX as f64 && value.fract() == 0.0 {
            Ok(value as u64)
        } else {
            Err(Error::Usage(format!("--{name} takes a whole number, not {}", parseable(value))))
        }
    }

    /// Runs an estimator until the budget in the options is spent, or for `draws` draws if there is none,
    /// with a progress bar on a terminal. If an error is asked for that takes more than five seconds of
    /// draws, the run is cut short, and the row says so.
    ///
    /// # Errors
    /// Those of [`Run::estimate`].
    pub fn run(&self, estimator: &(impl Estimator + ?Sized), draws: u64) -> Result<Outcome> {
        if let Some(shards) = &self.shards {
            return shards.next();
        }
        let time = match self.budget {
            Some(Budget::Time(time)) => Some(time),
            _ => None,
        };
        watched(!self.json, time, |progress| {
            let mut run = Run::new(self.seed).max_draws(u64::MAX).max_time(MOST_TIME).progress(progress);
            if let Some(threads) = self.threads {
                run = run.threads(threads);
            }
            if let Some([k, of]) = self.shard {
                run = run.shard(k, of);
            }
            run.estimate(estimator, self.budget.unwrap_or(Budget::Draws(draws)))
        })
    }

    /// Makes the folder for figures and pages before `work` starts, and removes it if it is still empty
    /// afterwards.
    pub(super) fn with_out(&self, work: impl FnOnce() -> Result<()>) -> Result<()> {
        let was_there = self.out.exists();
        std::fs::create_dir_all(&self.out).map_err(|error| Error::Write {
            path: self.out.display().to_string(),
            reason: error.to_string(),
        })?;
        work().inspect_err(|_| {
            if !was_there {
                // fails, as it should, if the folder is not empty
                let _ = std::fs::remove_dir(&self.out);
            }
        })
    }

    /// The names of the parameters that differ between rows from the question's options; the others can be
    /// given in the command that repeats the answer.
    pub(super) fn varied<'a>(&self, answers: impl IntoIterator<Item = &'a Answer>) -> Vec<Cow<'static, str>> {
        let parameters = answers.into_iter().flat_map(Answer::parameters);
        let as_given = |name: &str, value: Value| self.value(&name.replace('_', "-")) == Some(value);
        parameters.filter(|(name, value)| !as_given(name, *value)).map(|(name, _)| name.clone()).collect()
    }

    /// The question's own options that differ from their defaults: `u = 0.3`.
    pub(super) fn own(&self, question: &Question) -> String {
        let changed = question.parameters.iter().filter_map(|parameter| {
            let value = self.value(parameter.name)?;
            (value != parameter.default).then(|| format!("{} = {}", parameter.name, value.shortened()))
        });
        changed.collect::<Vec<_>>().join(", ")
    }

    /// The command that repeats these answers, and a remark if no single command does.
    pub(super) fn command<'a>(
        &self,
        question: &Question,
        answers: impl Iterator<Item = &'a Answer> + Clone,
    ) -> (String, Option<&'static str>) {
        let mut command = format!("cargo run --release --example {} --", question.example);
        for parameter in question.parameters {
            let value = self.value(parameter.name).unwrap_or(parameter.default);
            command += &format!(" --{} {value}", parameter.name);
        }
        let cut_short = answers.clone().any(|answer| answer.shortfall().is_some());
        let mut remark = None;
        command += &match self.budget {
            None => String::new(),
            Some(Budget::Draws(draws)) => format!(" --draws {draws}"),
            Some(Budget::StdError(error) | Budget::RelativeError(error)) if !cut_short => {
                format!(" --error {}", parseable(error))
            }
            // the clock decided the number of draws, and may decide otherwise next time
            Some(_) => {
                let draws = answers.filter_map(Answer::estimate).map(|estimate| estimate.draws());
                let draws: Vec<u64> = draws.collect::<BTreeSet<_>>().into_iter().collect();
                match draws[..] {
                    [] => String::new(),
                    [draws] => format!(" --draws {draws}"),
                    _ => {
                        remark = Some(
                            "where N is the number of draws of the row to be repeated: the clock ended each \
                             row after a different number",
                        );
                        " --draws N".into()
                    }
                }
            }
        };
        (command + &format!(" --seed {}", self.seed), remark)
    }
}

/// The most time for a row for which an error is asked, without the pilot run.
const MOST_TIME: Duration = Duration::from_secs(5);
