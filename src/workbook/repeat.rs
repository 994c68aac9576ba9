//! The command that repeats what was answered.

use std::collections::BTreeSet;

use super::{Answer, Options};
use crate::numbers::parseable;
use crate::question::Question;
use crate::run::Budget;

/// The command that repeats these answers, and a remark if no single command does.
pub(super) fn command(
    question: &Question,
    answers: &[Answer],
    options: &Options,
) -> (String, Option<&'static str>) {
    let mut command = format!("cargo run --release --example {} --", question.example);
    for (parameter, value) in options.values.parameters() {
        command += &format!(" --{} {value}", parameter.name);
    }
    let outcomes = answers.iter().filter_map(|answer| answer.outcome.as_ref());
    let cut_short = outcomes.clone().any(|outcome| outcome.shortfall.is_some());
    let mut remark = None;
    command += &match options.budget {
        None => String::new(),
        Some(Budget::Draws(draws)) => format!(" --draws {draws}"),
        Some(Budget::StdError(error) | Budget::RelativeError(error)) if !cut_short => {
            format!(" --error {}", parseable(error))
        }
        // the clock decided the number of draws, and may decide otherwise next time
        Some(_) => {
            let draws: BTreeSet<u64> = outcomes.map(|outcome| outcome.estimate.draws()).collect();
            match (draws.first(), draws.len()) {
                (None, _) => String::new(),
                (Some(draws), 1) => format!(" --draws {draws}"),
                _ => {
                    remark = Some(
                        "where N is the number of draws of the row to be repeated: the clock ended each row \
                         after a different number",
                    );
                    " --draws N".into()
                }
            }
        }
    };
    (command + &format!(" --seed {}", options.seed), remark)
}
