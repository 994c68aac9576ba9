//! Is an estimator unbiased? Is a sampler distributed as claimed? And if not, which classic mistake does it look like?
//!
//! Verdicts here have proven error probabilities at every sample size: nothing rests on the central limit theorem, and
//! what is only approximate says so in its name.

mod distribution;
mod exactly;
mod unbiased;
mod wealth;

pub use distribution::{Agreement, CELLS, Place, directions, distributed_as};
pub use exactly::{Exact, exactly};
pub use unbiased::{Report, Unbiased, Verdict, unbiased};
