//! Judges answers of readers: their own estimators, draws of any other program, or numbers worked out by
//! hand, of one reader or of a class.

mod arguments;
mod class;
mod draws;
mod mistakes;
mod programs;

use std::io::{self, Write};
use std::panic::{self, AssertUnwindSafe};
use std::process::ExitCode;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use serde_json::{Value, json};

use super::by_hand::{self, Judgement};
use super::progress::watched;
use super::terminal::{folded, stacked, width};
use super::{ended, print};
use crate::check::{self, Attempt, Candidate, Diagnosis, Exercise, Finding, Measurement, Probe, Problem};
use crate::error::{Error, Result};
use crate::numbers::shortened;
use crate::question::{Slip, Values};
use crate::run::{Budget, Run, Shortfall};
use crate::{inversion, lambertian, paths, rectangle, roulette};
use arguments::{Action, Arguments, HELP};
use draws::Source;
pub use mistakes::mistakes;

/// All exercises, in the order of the worksheet.
fn exercises() -> [&'static Exercise; 6] {
    [
        inversion::mistakes::Samples::exercise(),
        rectangle::mistakes::Integral::exercise(),
        lambertian::mistakes::Reflection::exercise(),
        paths::mistakes::LightOfPaths::exercise(),
        roulette::mistakes::Wrapped::exercise(),
        roulette::mistakes::NumberOfBounces::exercise(),
    ]
}

/// The exercise for a worksheet question ("3.5").
///
/// # Errors
/// If the question does not ask for an estimator.
pub fn exercise(question: &str) -> Result<&'static Exercise> {
    let mut all = exercises().into_iter();
    all.find(|exercise| exercise.questions().any(|of| of == question)).ok_or_else(|| {
        let questions: Vec<_> = exercises().iter().flat_map(|exercise| exercise.questions()).collect();
        Error::Usage(format!(
            "question {question} has no estimator to check; these have: {}",
            questions.join(", ")
        ))
    })
}

/// The `main` of an example that checks the reader's own estimators, one per exercise, for `question` or that
/// of `--question`.
///
/// Without other options it runs the estimator on all probes of its exercise, and prints the ratios to the
/// truth and the classic mistakes that are consistent with them. `--help` lists what else can be judged:
/// draws of a program in any language, numbers worked out by hand, the answers of a class.
pub fn check_mine(question: &str, mine: &[Attempt<'_>]) -> ExitCode {
    let judged =
        Arguments::read(question).and_then(|arguments| Ok((arguments.exit_code, arguments.run(mine)?)));
    match judged {
        Ok((true, verdict)) => ExitCode::from(verdict as u8),
        Ok((false, _)) => ExitCode::SUCCESS,
        Err(error) => ended(Err(error)),
    }
}

/// The verdict on an answer; its number is the exit code with `--exit-code`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Verdict {
    Right = 0,
    Wrong = 1,
    Undecided = 2,
}

impl Verdict {
    fn word(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Wrong => "wrong",
            Self::Undecided => "undecided",
        }
    }
}

impl From<Finding> for Verdict {
    fn from(finding: Finding) -> Self {
        match finding {
            Finding::NothingWrong => Self::Right,
            Finding::Known | Finding::Unknown => Self::Wrong,
            Finding::Unclear => Self::Undecided,
        }
    }
}

impl From<&Judgement> for Verdict {
    fn from(judgement: &Judgement) -> Self {
        match judgement {
            Judgement::Right => Self::Right,
            Judgement::TooFewDigits { .. } => Self::Undecided,
            Judgement::LooksLike(_) | Judgement::Unknown { .. } => Self::Wrong,
        }
    }
}

/// The draws on each probe unless something else is asked for.
const DRAWS: u64 = 1_000_000;

/// The most time for a probe if an error is asked for.
const MOST_TIME: Duration = Duration::from_secs(5);

impl Arguments {
    fn run(&self, mine: &[Attempt<'_>]) -> Result<Verdict> {
        let (said, verdict) = match &self.action {
            Action::Help => (HELP.to_owned(), Verdict::Right),
            Action::Probes => {
                let exercise = exercise(&self.question)?;
                let text = if self.json { programs::probes_json } else { programs::probes };
                (text(exercise, &self.question), Verdict::Right)
            }
            Action::Mistakes => {
                let table = mistakes(exercise(&self.question)?);
                let rows = stacked(&table, width()).join("\n");
                let plain = || format!("{}\n\n{rows}", folded(&table.caption, width()));
                (if self.json { table.json() } else { plain() }, Verdict::Right)
            }
            Action::Template(language) => {
                let exercise = exercise(&self.question)?;
                (programs::template(exercise, &self.question, *language)?, Verdict::Right)
            }
            Action::Answer(text) => self.judge_answer(text)?,
            Action::Draws(sources) => self.judge_draws(sources)?,
            Action::Mine => self.judge_mine(mine)?,
            Action::Class => {
                let report = class::Report::of(self)?;
                let text = match (self.json, self.csv) {
                    (true, _) => report.json(),
                    (_, true) => report.csv()?,
                    _ => report.to_string(),
                };
                (text, report.verdict())
            }
        };
        let text = match self.action {
            Action::Mine | Action::Answer(_) | Action::Draws(_) if !self.json => folded(&said, width()),
            _ => said,
        };
        writeln!(io::stdout(), "{text}").or_else(print::until_the_pipe_closes)?;
        Ok(verdict)
    }

    fn judge_mine(&self, mine: &[Attempt<'_>]) -> Result<(String, Verdict)> {
        let asked = exercise(&self.question)?;
        let Some(mine) = mine.iter().find(|attempt| std::ptr::eq(attempt.exercise, asked)) else {
            let (question, asked) = (&self.question, asked.name);
            let given: Vec<_> = mine.iter().map(|attempt| format!("“{}”", attempt.exercise.name)).collect();
            return Err(Error::Usage(format!(
                "question {question} is about “{asked}”, but the estimator in this file is about {}",
                given.join(" and ")
            )));
        };
        let (measurements, shortfall) = self.measure(mine)?;
        let draws = measurements.iter().map(|measurement| measurement.estimate.draws());
        let draws = match (draws.clone().min(), draws.max()) {
            (Some(fewest), Some(most)) if fewest < most => format!("{fewest} to {most}"),
            (fewest, _) => fewest.unwrap_or_default().to_string(),
        };
        let cut_short = shortfall.map_or(String::new(), |shortfall| {
            format!("Cut short: {shortfall} on a probe. Ask for a larger error, or give a time: --seconds.\n")
        });
        let diagnosis = check::diagnose(&measurements)?.shown_by(mine);
        let verdict = Verdict::from(diagnosis.finding);
        if self.json {
            return Ok((self.diagnosis_json(&diagnosis), verdict));
        }
        let (question, seed) = (&self.question, self.seed);
        Ok((
            format!("Question {question}, {draws} draws a probe, seed {seed}.\n{cut_short}{diagnosis}"),
            verdict,
        ))
    }

    /// Runs the reader's estimator on every probe. Also returns how far the slowest probe was from the error
    /// asked for, if it was cut short.
    fn measure(&self, mine: &Attempt<'_>) -> Result<(Vec<Measurement>, Option<Shortfall>)> {
        let mut measured = Vec::new();
        for probe in mine.exercise.probes_of(&self.question) {
            // ratios are judged, so the error asked for is that of the ratio
            let budget = match self.budget.unwrap_or(Budget::Draws(DRAWS)) {
                Budget::StdError(error) => Budget::StdError(error * probe.scale),
                other => other,
            };
            let seed = check::seed_of(probe, self.seed);
            let (measurement, outcome) = told_once(probe, || {
                watched(!self.json, None, |progress| {
                    let run = Run::new(seed).max_draws(u64::MAX).max_time(MOST_TIME).progress(progress);
                    mine.measure(probe, &run, budget)
                })
            })?;
            let as_ratio = |short: Shortfall| Shortfall { std_error: short.std_error / probe.scale, ..short };
            measured.push((measurement, outcome.shortfall.map(as_ratio)));
        }
        let (measurements, shortfalls): (_, Vec<_>) = measured.into_iter().unzip();
        let slowest = shortfalls.into_iter().flatten().max_by(|a, b| a.draws.total_cmp(&b.draws));
        Ok((measurements, slowest))
    }

    fn judge_answer(&self, text: &str) -> Result<(String, Verdict)> {
        let (_, number) = by_hand::asked(&self.question)?;
        let parameters = parameters(&self.question, self.variant.as_deref(), &self.own)?;
        let (judgement, ratio) = by_hand::judged(&self.question, text, &parameters, self.digits)?;
        let verdict = Verdict::from(&judgement);
        if !self.json {
            return Ok((format!("{}, {}: {judgement}", self.question, number.asked()), verdict));
        }
        let slip = |slip: &Slip| json!({ "id": slip.id, "name": slip.words });
        let line = json!({
            "question": self.question, "answer": text, "verdict": verdict.word(), "ratio": ratio,
            "mistakes": judgement.slips().iter().map(slip).collect::<Vec<_>>(),
            "reason": judgement.to_string(),
        });
        Ok((line.to_string(), verdict))
    }

    fn judge_draws(&self, sources: &[Source]) -> Result<(String, Verdict)> {
        let exercise = exercise(&self.question)?;
        let probes = exercise.probes_of(&self.question);
        let measurements = draws::measure(sources, &probes)?;
        let diagnosis = check::diagnose(&measurements)?;
        let verdict = Verdict::from(diagnosis.finding);
        if self.json {
            return Ok((self.diagnosis_json(&diagnosis), verdict));
        }
        let mut text = String::new();
        if let [only] = &measurements[..] {
            let (draws, probe, truth) = (only.estimate.draws(), only.probe, shortened(only.probe.truth));
            let number = number_of(probe, &probes);
            text +=
                &format!("Taken as {draws} draws for probe {number}, “{probe}”, whose truth is {truth}.\n");
        } else {
            let each = measurements.iter().map(|of| {
                let number = number_of(of.probe, &probes);
                format!("{} for probe {number}", of.estimate.draws())
            });
            text += &format!("Draws: {}.\n", each.collect::<Vec<_>>().join(", "));
        }
        for measurement in measurements.iter().filter(|_| verdict == Verdict::Wrong) {
            let fitting = fitting_elsewhere(measurement, &probes);
            if !fitting.is_empty() {
                let name = |probe: &&Probe| format!("{}, “{probe}”", number_of(probe, &probes));
                text += &format!(
                    "The draws for probe {} fit the truth of probe {}: were they made for that probe?\n",
                    number_of(measurement.probe, &probes),
                    fitting.iter().map(name).collect::<Vec<_>>().join("; or of ")
                );
            }
        }
        text += &diagnosis.to_string();
        text += &format!("\n--question {} --probes describes the probes.", self.question);
        Ok((text, verdict))
    }

    fn diagnosis_json(&self, diagnosis: &Diagnosis) -> String {
        let verdict = Verdict::from(diagnosis.finding);
        let mine = self.action == Action::Mine;
        let probes = diagnosis.exercise.probes_of(&self.question);
        let mistakes: Vec<Value> = diagnosis.candidates.iter().map(candidate_json).collect();
        let measured = diagnosis.measurements.iter().map(|of| {
            let ratio = of.ratio();
            let fitting = fitting_elsewhere(of, &probes).into_iter().map(|probe| number_of(probe, &probes));
            let fits: Vec<usize> = fitting.filter(|_| verdict == Verdict::Wrong && !mine).collect();
            json!({
                "probe": number_of(of.probe, &probes), "what": of.probe.to_string(), "fits_probes": fits,
                "truth": of.probe.truth, "estimate": of.estimate.mean(), "ratio": ratio.mean,
                "std_error": of.estimate.std_error(), "draws": of.estimate.draws(),
            })
        });
        let counterexample = diagnosis.counterexample.as_ref().map(|of| {
            let probe = number_of(of.probe, &probes);
            json!({ "probe": probe, "numbers": of.numbers, "yours": of.yours, "right": of.right })
        });
        json!({
            "question": self.question, "verdict": verdict.word(),
            "mistakes": mistakes, "compared": diagnosis.compared, "counterexample": counterexample,
            "probes": measured.collect::<Vec<_>>(),
            "seed": mine.then_some(self.seed),
        })
        .to_string()
    }
}

fn candidate_json(candidate: &Candidate) -> Value {
    let mistake = candidate.mistake;
    json!({
        "id": candidate.id(), "name": candidate.name(), "factor": candidate.factor,
        "formula": mistake.map(|of| of.formula), "mend": mistake.map(|of| of.mend),
    })
}

/// The question's own parameters: those given by name, else those of the variant, else the sheet's.
fn parameters(question: &str, variant: Option<&str>, given: &[(String, String)]) -> Result<Values> {
    // a question without a number gets its error message where it is judged
    let id = question.split('(').next().unwrap_or_default().trim();
    let question = super::question(id)?;
    let mut parameters = Values::default();
    if let Some(name) = variant {
        parameters = parameters.variant(name, [question])?;
    }
    for (name, value) in given {
        parameters.set(question, name, value)?;
    }
    Ok(parameters)
}

fn number_of(probe: &Probe, probes: &[&Probe]) -> usize {
    1 + probes.iter().position(|other| std::ptr::eq(*other, probe)).unwrap_or(0)
}

/// The other probes whose truths the draws fit, if they do not fit their own probe's.
fn fitting_elsewhere(of: &Measurement, probes: &[&'static Probe]) -> Vec<&'static Probe> {
    let fits = |probe: &&'static Probe| !of.is_right() && Measurement { probe, ..*of }.is_right();
    probes.iter().copied().filter(fits).collect()
}

/// Reports a panic in the reader's own code once, with the probe: it happens on many threads at once.
pub(crate) fn told_once<T>(probe: &Probe, work: impl FnOnce() -> Result<T>) -> Result<T> {
    let first = Arc::new(Mutex::new(None::<String>));
    let told = Arc::clone(&first);
    let before = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        let mut told = told.lock().unwrap_or_else(PoisonError::into_inner);
        told.get_or_insert_with(|| {
            let at = info
                .location()
                .map_or(String::new(), |place| format!(" ({}:{})", place.file(), place.line()));
            let said = info.payload();
            let said =
                said.downcast_ref::<&str>().copied().or(said.downcast_ref::<String>().map(String::as_str));
            format!("{}{at}", said.unwrap_or("of an unknown kind"))
        });
    }));
    let worked = panic::catch_unwind(AssertUnwindSafe(work));
    panic::set_hook(before);
    worked.unwrap_or_else(|_| {
        let reason = first.lock().unwrap_or_else(PoisonError::into_inner).take().unwrap_or_default();
        Err(Error::Panic { probe: probe.to_string(), reason })
    })
}
