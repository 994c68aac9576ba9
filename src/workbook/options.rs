//! The options of an example: how it is run, and the values of the questions' parameters.

use std::path::PathBuf;
use std::rc::Rc;
use std::time::Duration;

use super::progress::watched;
use super::shards::Shards;
use crate::error::{Error, Result};
use crate::estimator::Estimator;
use crate::plot::Edition;
use crate::question::{Question, Values};
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
    /// The values of the questions' parameters.
    pub(super) values: Values,
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
            values: Values::default(),
        }
    }
}

impl Options {
    /// The same options, with the values of this question's parameters.
    pub(super) fn for_question(&self, question: &'static Question) -> Self {
        Self { values: self.values.for_question(question), ..self.clone() }
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
