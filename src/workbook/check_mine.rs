//! The reader's door: one's own estimator, or a number worked out by hand, judged.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::process::ExitCode;
use std::time::Duration;

use lexopt::{Arg, Parser};

use super::{ended, options, print};
use crate::check::{self, Attempt, Measurement, Probe, Topic};
use crate::error::{Error, Result};
use crate::estimate::Estimate;
use crate::run::{Budget, Run, Shortfall};
use crate::stream::mix;

/// The `main` of an example that checks the reader's own estimators, one a topic, for the worksheet question in hand or that of `--question`.
///
/// Without other options it tries the estimator on all probes of its topic, and says what the ratios to the truth are and which classic mistakes they are consistent with.
/// `--question Q --answer TEXT` judges a number worked out by hand, and `--question Q --draws-from FILE` draws made by any other program, one a line (`-` for standard input).
pub fn check_mine(question: &str, mine: &[Attempt<'_>]) -> ExitCode {
    ended(Wish::read(question).and_then(|wish| wish.grant(mine)))
}

/// What the command line asks for.
struct Wish {
    question: String,
    answer: Option<String>,
    draws_from: Option<String>,
    probe: usize,
    budget: Option<Budget>,
    seed: u64,
    help: bool,
}

/// Draws on each probe where nothing else is asked for.
const DRAWS: u64 = 1_000_000;

/// What a probe may take where an error is asked for.
const MOST_TIME: Duration = Duration::from_secs(5);

impl Wish {
    fn read(question: &str) -> Result<Self> {
        let mut wish = Self {
            question: question.into(),
            answer: None,
            draws_from: None,
            probe: 1,
            budget: None,
            seed: 1,
            help: false,
        };
        let mut line = Parser::from_env();
        // of the options that are about one thing only, the last one given
        let (mut about_estimator, mut about_draws) = (None, None);
        while let Some(argument) = line.next().map_err(options::usage)? {
            match argument {
                Arg::Short('h') | Arg::Long("help") => wish.help = true,
                Arg::Long("question") => wish.question = options::text(&mut line, "--question")?,
                Arg::Long("answer") => wish.answer = Some(options::text(&mut line, "--answer")?),
                Arg::Long("draws-from") => wish.draws_from = Some(options::text(&mut line, "--draws-from")?),
                Arg::Long("probe") => {
                    about_draws = Some("--probe");
                    wish.probe = options::count(&mut line, "--probe")? as usize;
                }
                Arg::Long(name @ ("draws" | "error" | "seconds")) => {
                    let name = name.to_owned();
                    options::read_budget(&mut line, &name, &mut wish.budget)?;
                    about_estimator = Some(format!("--{name}"));
                }
                Arg::Long("seed") => {
                    about_estimator = Some("--seed".into());
                    wish.seed = options::whole(&mut line, "--seed")?;
                }
                other => return Err(options::usage(other.unexpected())),
            }
        }
        let given = |option: bool, name| option.then_some(name);
        let answer = given(wish.answer.is_some(), "--answer");
        let draws_from = given(wish.draws_from.is_some(), "--draws-from");
        let clash = |a: Option<&str>, b: Option<&str>| match (a, b) {
            (Some(a), Some(b)) => Err(Error::Usage(format!("{a} has no use for {b}: give one of them"))),
            _ => Ok(()),
        };
        clash(answer, draws_from)?;
        clash(answer.or(draws_from), about_estimator.as_deref())?;
        if wish.draws_from.is_none()
            && let Some(option) = about_draws
        {
            return Err(Error::Usage(format!("{option} says what the draws of --draws-from are for")));
        }
        Ok(wish)
    }

    fn grant(&self, mine: &[Attempt<'_>]) -> Result<()> {
        let said = if self.help {
            HELP.to_owned()
        } else if let Some(answer) = &self.answer {
            let judgement = check::judge_answer(&self.question, answer)?;
            let what = check::answers(&self.question).map_or("", |answer| answer.what);
            format!("{}, {what}: {judgement}", self.question)
        } else if let Some(file) = &self.draws_from {
            self.judge_draws(file)?
        } else {
            self.judge_mine(mine)?
        };
        writeln!(io::stdout(), "{said}").or_else(print::until_the_pipe_closes)
    }

    fn topic(&self) -> Result<Topic> {
        Topic::of_question(&self.question)
            .ok_or_else(|| Error::Usage(format!("question {} has no estimator to check", self.question)))
    }

    fn judge_mine(&self, mine: &[Attempt<'_>]) -> Result<String> {
        let asked = self.topic()?;
        let Some(mine) = mine.iter().find(|attempt| attempt.topic() == asked) else {
            let question = &self.question;
            let given: Vec<_> = mine.iter().map(|attempt| format!("“{}”", attempt.topic())).collect();
            return Err(Error::Usage(format!(
                "question {question} is about “{asked}”, what is written here about {}",
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
        let diagnosis = check::diagnose(&measurements)?;
        Ok(format!(
            "Question {}, {draws} draws a probe, seed {}.\n{cut_short}{diagnosis}",
            self.question, self.seed
        ))
    }

    /// The reader's estimator on every probe, and what the probe that is the furthest from the error asked for would have taken.
    fn measure(&self, mine: &Attempt<'_>) -> Result<(Vec<Measurement>, Option<Shortfall>)> {
        let probes = mine.topic().probes();
        let (mut measurements, mut shortfall) = (Vec::new(), None::<Shortfall>);
        let budget = match self.budget.unwrap_or(Budget::Draws(DRAWS)) {
            Budget::Draws(draws) => return Ok((check::measure(mine, draws, self.seed)?, None)),
            budget => budget,
        };
        for (index, probe) in (1..).zip(probes) {
            // ratios are judged, so the error asked for is theirs
            let budget = match budget {
                Budget::StdError(error) => Budget::StdError(error * probe.unit().abs()),
                other => other,
            };
            // as in `check::measure`
            let seed = mix(self.seed.wrapping_add(mix(index)));
            let run = Run::new(seed).max_draws(u64::MAX).max_time(MOST_TIME);
            let outcome = run.estimate(&mine.at(probe)?, budget)?;
            measurements.push(Measurement { probe: *probe, estimate: outcome.estimate });
            let as_ratio =
                |short: Shortfall| Shortfall { std_error: short.std_error / probe.unit().abs(), ..short };
            let further = |short: &Shortfall| shortfall.is_none_or(|before| short.draws > before.draws);
            shortfall = outcome.shortfall.map(as_ratio).filter(further).or(shortfall);
        }
        Ok((measurements, shortfall))
    }

    fn judge_draws(&self, file: &str) -> Result<String> {
        let probes = self.topic()?.probes();
        let Some(probe) = probes.get(self.probe - 1) else {
            return Err(Error::Usage(format!("--probe is 1 to {} for this question", probes.len())));
        };
        let estimate = if file == "-" {
            read_draws(io::stdin().lock())
        } else {
            let unread = |error: io::Error| Error::Usage(format!("{file} could not be read: {error}"));
            read_draws(BufReader::new(File::open(file).map_err(unread)?))
        }?;
        let diagnosis = check::diagnose(&[Measurement { probe: *probe, estimate }])?;
        let others: Vec<String> = probes.iter().enumerate().map(|(i, probe)| described(i, probe)).collect();
        Ok(format!(
            "Taken as {} draws for probe {}, whose truth is {}.\n{diagnosis}\nProbes of this question (--probe):\n{}",
            estimate.draws(),
            self.probe,
            print::shortened(probe.truth()),
            others.join("\n"),
        ))
    }
}

fn described(index: usize, probe: &Probe) -> String {
    format!("  {}. {probe}: the truth is {}", index + 1, print::shortened(probe.truth()))
}

/// Numbers, one a line; empty lines are passed over.
fn read_draws(lines: impl BufRead) -> Result<Estimate> {
    let mut estimate = Estimate::new();
    for (index, line) in lines.lines().enumerate() {
        let line = line.map_err(|error| Error::Usage(format!("the draws could not be read: {error}")))?;
        let word = line.trim();
        if word.is_empty() {
            continue;
        }
        match word.parse::<f64>() {
            Ok(draw) if draw.is_finite() => estimate.push(draw),
            _ => return Err(Error::Usage(format!("line {} is no draw: \"{word}\"", index + 1))),
        }
    }
    Ok(estimate)
}

const HELP: &str =
    "Checks your own estimator, written in examples/check_mine.rs, or a number worked out by hand.

    cargo run --release --example check_mine
    cargo run --release --example check_mine -- --question 1.2 --answer 0.602
    python my_estimator.py | cargo run --release --example check_mine -- --question 3.5 --draws-from -

Options
    --question Q         the worksheet's number (default: the one in the file)
    --answer TEXT        judge this number, fraction or expression: 1.386, 16/125, 2ρ/π
    --draws-from FILE    judge these draws, one a line (- for standard input), made for --probe
    --probe N            which of the question's probes the draws were made for (1)
    --draws N            draws of your estimator on each probe (1000000)
    --error E            instead: draws until the ratio to the truth has the std error E, by a pilot run: never
                         fewer than the pilot's, and about 5 s of them a probe at most
    --seconds S          instead: draws for S seconds a probe
    --seed S             their seed (1)";
