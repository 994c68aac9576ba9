//! Monte Carlo workbook.

pub mod density;
pub mod error;
pub mod estimate;
#[cfg(feature = "workbook")]
pub mod figure;
pub mod hemisphere;
pub mod inversion;
pub mod lambertian;
pub mod rectangle;
pub mod roulette;
pub mod run;
pub mod stream;
#[cfg(feature = "workbook")]
pub mod workbook;

pub use density::{Density, Ratio, ratio};
pub use error::{Error, Result};
pub use estimate::Estimate;
pub use run::{Budget, Cost, Estimator, FromFn, Outcome, Progress, Run, estimate, from_fn};
pub use stream::Stream;
