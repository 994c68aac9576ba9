//! Reads the command line that all examples share.

use std::mem;
use std::path::PathBuf;
use std::rc::Rc;
use std::time::Duration;

use lexopt::{Arg, Parser};

use super::shards::Shards;
use super::{Appendix, Options, help};
use crate::error::{Error, Result};
use crate::plot::Edition;
use crate::question::{Given, Question, parameter};
use crate::run::Budget;

/// Reads this program's command line, for the example of these questions, or of an appendix. `--help` and
/// `--hint` are answered here; then there is nothing to run.
pub(super) fn read(questions: &[&'static Question], appendix: Option<&Appendix>) -> Result<Option<Options>> {
    let (mut options, mut hint, mut variant) = (Options::default(), false, None);
    let mut line = Parser::from_env();
    while let Some(argument) = line.next().map_err(usage)? {
        let name = match argument {
            Arg::Short('h') => "help".to_owned(),
            Arg::Long(name) => name.to_owned(),
            other => return Err(usage(other.unexpected())),
        };
        if let Some(appendix) = appendix {
            appendix.check_option(&name)?;
        }
        match name.as_str() {
            "help" => {
                appendix.map_or_else(|| help::of_questions(questions), help::of_appendix)?;
                return Ok(None);
            }
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
                let (id, own) = name.rsplit_once('.').map_or((None, &*name), |(id, own)| (Some(id), own));
                let asked = || questions.iter().copied().filter(|asked| id.is_none_or(|id| asked.id == id));
                let parameter = parameter(asked(), own, &name)?;
                let value = parameter.read(&text(&mut line, &format!("--{name}"))?)?;
                let of = id.and_then(|_| asked().next()).map(|question| question.id);
                options.values.give(Given { of, name: parameter.name, value });
            }
        }
    }
    if options.variants.is_some() && questions.len() == 1 {
        return refused("--variants works with the example worksheet only");
    }
    if let Some(name) = variant {
        options.values = options.values.variant(&name, questions.iter().copied())?;
    }
    let (cut, merged) = (options.shard.is_some(), options.shards.is_some());
    if hint {
        return help::hints(questions, &options).map(|()| None);
    } else if cut && merged {
        return refused("--shard and --merge cannot be combined: give one of them");
    } else if (cut || merged) && questions.len() != 1 {
        return refused("--shard and --merge work with the example of one question only");
    } else if cut && !options.json {
        return refused("--shard needs --json, which --merge reads");
    } else if cut && !matches!(options.budget, None | Some(Budget::Draws(_))) {
        return refused("--shard excludes --error and --seconds: only a number of draws can be divided");
    }
    Ok(Some(options))
}

fn refused<T>(sentence: &str) -> Result<T> {
    Err(Error::Usage(sentence.into()))
}

/// Reads the value of --draws, --error or --seconds, of which only one may be given.
pub(super) fn read_budget(line: &mut Parser, name: &str, budget: &mut Option<Budget>) -> Result<()> {
    let read = match name {
        "draws" => Budget::Draws(count(line, "--draws")?),
        "error" => Budget::StdError(positive(&text(line, "--error")?, "--error")?),
        _ => Budget::Time(seconds(&text(line, "--seconds")?)?),
    };
    // if the same option is given again, the last one counts, as for all options
    if budget.is_some_and(|given| mem::discriminant(&given) != mem::discriminant(&read)) {
        return refused("--draws, --error and --seconds each end a run: give one of them");
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

/// A whole number, written 1000000, 1_000_000 or 1e6.
pub(super) fn whole(line: &mut Parser, name: &str) -> Result<u64> {
    let given = text(line, name)?;
    let digits = given.bytes().next().is_some_and(|first| first.is_ascii_digit());
    let plain = given.replace('_', "");
    let exact = |number: &f64| number.fract() == 0.0 && (0.0..=9e15).contains(number);
    let scientific = || plain.parse().ok().filter(exact).map(|number| number as u64);
    let whole = plain.parse().ok().or_else(scientific).filter(|_| digits);
    whole.ok_or_else(|| Error::Usage(format!("{name} takes a whole number, not \"{given}\"")))
}

pub(super) fn count(line: &mut Parser, name: &str) -> Result<u64> {
    match whole(line, name)? {
        0 => Err(Error::Usage(format!("{name} takes a positive whole number, not 0"))),
        count => Ok(count),
    }
}

fn positive(given: &str, name: &str) -> Result<f64> {
    let number = given.parse::<f64>().ok().filter(|number| *number > 0.0 && number.is_finite());
    number.ok_or_else(|| Error::Usage(format!("{name} takes a positive number, not \"{given}\"")))
}

/// A time that a clock can measure and a `Duration` can hold.
fn seconds(given: &str) -> Result<Duration> {
    let seconds = positive(given, "--seconds")?;
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
