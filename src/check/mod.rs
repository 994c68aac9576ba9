//! Is an estimator unbiased? Is a sampler distributed as claimed? And if not, which classic mistake does it look like?
//!
//! Verdicts here have proven error probabilities at every sample size: nothing rests on the central limit theorem, and
//! what is only approximate says so in its name.

mod diagnose;
mod distribution;
mod exactly;
mod mistakes;
mod unbiased;
mod wealth;

pub use diagnose::{Diagnosis, Finding, Group, Measurement, diagnose, measure, measure_on};
pub use distribution::{Agreement, CELLS, Place, directions, distributed_as};
pub use exactly::{Exact, exactly};
pub use mistakes::{
    Attempt, HandAnswer, Judgement, Mistake, Probe, Sky, Slip, Statistic, Surface, Topic, answers,
    judge_answer,
};
pub use unbiased::{Look, Report, Unbiased, Verdict, unbiased};
