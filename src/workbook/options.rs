//! The options of an example: how it is run, and the values of the questions' parameters.

use std::path::PathBuf;
use std::rc::Rc;
use std::time::Duration;

use super::progress::watched;
use super::shards::Shards;
use super::{Parameter, Question, Value};
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
    /// The folder for figures and pages; `worksheet/` by default.
    pub out: PathBuf,
    /// The number of threads; one per core by default. It does not change the results of the same draws.
    pub(super) threads: Option<usize>,
    /// Print one JSON object per line instead of text.
    pub(super) json: bool,
    /// Print what every row took, and all rows of a worksheet.
    pub(super) verbose: bool,
    pub(super) voice: Voice,
    pub(super) edition: Edition,
    /// Whether the other edition is made, too.
    pub(super) both: bool,
    /// Whether every figure is made as a slide, too.
    pub(super) slides: bool,
    /// Make only the first figure of each question: the one that a key has on paper.
    pub(super) one_figure: bool,
    /// The shard of every run to draw, and the number of shards. A shard makes no figures.
    pub(super) shard: Option<[u64; 2]>,
    /// The shards from which every run is merged, instead of drawing it.
    pub(super) shards: Option<Rc<Shards>>,
    /// A file of names, each of which gets its own worksheet.
    pub(super) variants: Option<PathBuf>,
    /// The worksheet's title.
    pub(super) title: String,
    /// Values of parameters; the last one of a name counts.
    pub(super) given: Vec<Given>,
    /// The question whose parameters are asked for by name.
    pub(super) question: Option<&'static Question>,
}

/// What is printed for people while a question is answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Voice {
    /// Nothing.
    Quiet,
    /// Only its title.
    Brief,
    /// The question, then every row when it is done.
    Full,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            budget: None,
            seed: 1,
            out: PathBuf::from("worksheet"),
            threads: None,
            json: false,
            verbose: false,
            voice: Voice::Full,
            edition: Edition::Solution,
            both: false,
            slides: false,
            one_figure: false,
            shard: None,
            shards: None,
            variants: None,
            title: String::new(),
            given: Vec::new(),
            question: None,
        }
    }
}

/// A question's own option, as given.
#[derive(Debug, Clone)]
pub(super) struct Given {
    /// The question, if the option names it, as `--5.2.p-rr` does; else it is for every question that has it.
    pub of: Option<&'static str>,
    pub name: &'static str,
    pub value: Value,
}

/// What the option `name` of one of these questions sets.
pub(super) fn parameter<'q>(
    questions: impl IntoIterator<Item = &'q Question>,
    name: &str,
    option: &str,
) -> Result<&'static Parameter> {
    let mut known = questions.into_iter().flat_map(|question| question.parameters);
    let unknown = || Error::Usage(format!("there is no option --{option}; --help lists them"));
    known.find(|parameter| parameter.name == name).ok_or_else(unknown)
}

impl Parameter {
    /// A value given for it.
    pub(super) fn read(&self, given: &str) -> Result<Value> {
        let kind = self.default.kind();
        let unread = || Error::Usage(format!("--{} takes {kind}, not \"{given}\"", self.name));
        self.default.read_alike(given).ok_or_else(unread)
    }
}

impl Options {
    /// Sets the question's own option `name` to a value as the command line takes it: "0.8", "4/5".
    ///
    /// # Errors
    /// If the question has no such option, or it does not take that.
    pub fn set(&mut self, question: &Question, name: &str, given: &str) -> Result<()> {
        let parameter = parameter([question], name, name)?;
        let value = parameter.read(given)?;
        self.given.push(Given { of: Some(question.id), name: parameter.name, value });
        Ok(())
    }

    /// Adds the questions' own options among `below`, where they are not set here.
    pub(super) fn put_below(&mut self, mut below: Self) {
        below.given.append(&mut self.given);
        self.given = below.given;
    }

    /// The same options, with the defaults of this question's own parameters.
    pub(super) fn for_question(&self, question: &'static Question) -> Self {
        Self { question: Some(question), ..self.clone() }
    }

    /// The value of the question's own option `name`: as given, else its default.
    pub(super) fn value(&self, name: &str) -> Option<Value> {
        let question = self.question?;
        let own = |given: &&Given| given.name == name && given.of.is_none_or(|of| of == question.id);
        let given = self.given.iter().rev().find(own).map(|given| given.value);
        let default = || question.parameters.iter().find(|parameter| parameter.name == name);
        given.or_else(|| default().map(|parameter| parameter.default))
    }

    /// The question's own options, with their values.
    pub(super) fn parameters(&self) -> impl Iterator<Item = (&'static Parameter, Value)> {
        let parameters = self.question.map_or(&[][..], |question| question.parameters).iter();
        parameters.filter_map(|parameter| Some((parameter, self.value(parameter.name)?)))
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
    pub(super) fn limit(&self, name: &str) -> Option<u32> {
        match self.value(name) {
            Some(Value::Limit(limit)) => limit,
            _ => None,
        }
    }

    /// The box room that section 4's options describe.
    pub(crate) fn scene(&self) -> Scene {
        let point = match self.value("point") {
            Some(Value::Point(point)) => point,
            _ => [f64::NAN; 3],
        };
        Scene {
            wall_albedo: self.number("wall-albedo"),
            cube_albedo: self.number("cube-albedo"),
            radiance: self.number("radiance"),
            light_half_width: self.number("light-half-width"),
            point,
            ..Scene::default()
        }
    }

    /// The value of an option that must be a whole number ≥ 0.
    pub(crate) fn whole_number(&self, name: &str) -> Result<u64> {
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
    pub(super) fn run(&self, estimator: &(impl Estimator + ?Sized), draws: u64) -> Result<Outcome> {
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
}

/// The most time for a row for which an error is asked, without the pilot run.
const MOST_TIME: Duration = Duration::from_secs(5);
