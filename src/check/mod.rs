//! Is an estimator unbiased? Is a sampler distributed as claimed? If not, which classic mistake does it look
//! like?
//!
//! Verdicts of [`unbiased`] and [`distributed_as`] have proven error probabilities at every sample size; they
//! do not rely on the central limit theorem. A [diagnosis](diagnose()) does: it treats means as approximately
//! normal, with a correction for few or skewed draws.
//!
//! This module does not depend on the topics: each topic defines its [`Exercise`]s in its module `mistakes`.

mod attempt;
mod counterexample;
mod diagnose;
mod distribution;
mod exactly;
mod exercise;
mod measure;
mod ratio;
mod report;
mod unbiased;
mod wealth;

#[cfg(feature = "workbook")]
pub(crate) use attempt::seed_of;
pub use attempt::{Attempt, measure};
pub use counterexample::Counterexample;
pub use diagnose::{Candidate, Diagnosis, Finding, diagnose};
pub use distribution::{Agreement, distributed_as, points};
pub use exactly::{Exact, exactly};
pub(crate) use exercise::{About, Listed};
pub use exercise::{Exercise, Given, Mistake, Probe, Problem};
pub use measure::{Measurement, Tally};
pub use ratio::Ratio;
pub use report::{Look, Report, Verdict};
pub use unbiased::{Unbiased, unbiased};
