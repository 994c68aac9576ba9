//! The Monte Carlo and global illumination workbook: every question in closed form, by an estimator with its
//! error bar, and in a picture.
//!
//! All of it is one formula,
//!
//! > ⟨Fₙ⟩ = 1/n Σ f(Xᵢ)/p(Xᵢ),
//!
//! and the crate reads as it: a [`Density`] to draw from, an integrand, an [`Estimator`] made of the two by
//! [`f_over_p`], a [run](estimate()) of it, and an [`Estimate`] with its error.
//!
//! ```
//! use unbiased::{Budget, estimate, lambertian::{Lambertian, lambertian::hemisphere::Hemisphere}};
//!
//! // radiance reflected by a surface of albedo 0.8 under a sky of radiance cos θ: 2ρ/3
//! let cube = Lambertian::new(0.8)?;
//! let by_uniform = cube.estimator(|w| w.cos_theta(), Hemisphere::Uniform);
//! let by_cosine = cube.estimator(|w| w.cos_theta(), Hemisphere::Cosine);
//! let [uniform, cosine] = [
//!     estimate(&by_uniform, Budget::Draws(100_000), 1)?,
//!     estimate(&by_cosine, Budget::Draws(100_000), 1)?,
//! ];
//! assert!(uniform.z(1.6 / 3.0).unwrap().abs() < 4.0);
//! assert!(cosine.z(1.6 / 3.0).unwrap().abs() < 4.0);
//! assert!(cosine.std_error() < uniform.std_error());
//! # Ok::<(), unbiased::Error>(())
//! ```
//!
//! # From worksheet to modules
//!
//! | section | module | holds |
//! |---|---|---|
//! | 1 The inversion method | [`inversion`] | the exponential distribution, and any cdf inverted |
//! | 2 Unbiased estimators | [`rectangle`] | independent, paired, jittered and Sobol points on a rectangle |
//! | 3 The diffuse cube | [`lambertian`] | directions, a Lambertian surface, lights with exact variances |
//! | 4 Paths | [`paths`], [`paths::room`] | the one scene, its closed forms, and paths through it |
//! | 5 Russian roulette | [`roulette`] | bounce counts, the wrapper X_rr, and what roulette costs and buys |
//!
//! Whether an estimator is unbiased, and which classic mistake it looks like if not, is what [`check`] says;
//! `examples/check_mine.rs` is the place to try one's own.
//!
//! What a second of each buys is what [`trade`] measures.
//!
//! Underneath lie [`estimator`], [`placement`], [`run`], [`estimate`](mod@estimate), [`stream`] and
//! [`error`]; above, with the feature `workbook` (on by default), `plot` and `workbook`. The files in
//! `examples/` are the answers to read, one a question.
//!
//! # Conventions
//!
//! U is uniform on [0, 1); ρ is an albedo, f_r = ρ/π the BRDF, θ the angle to the surface normal, ω_i points
//! towards the light. A draw is one *independent* unbiased value: a jittered sweep or a scrambled Sobol set
//! counts as one draw. Random numbers come from [`Stream`], a named generator with an explicit seed; the same
//! seed gives the same bits for any number of threads.
//!
//! # Features
//!
//! - `workbook` (default): figures as SVG and CSV, the examples' command line, the page.
//! - `notebook` (default): figures, estimates and verdicts show as pictures and HTML in Jupyter.
//! - `png`, `pdf`: figures in those formats, too.

// from the ground up
pub mod error;
mod numbers;
mod float;
mod quantile;
pub mod fast;
pub mod stream;
pub mod estimate;
mod doubt;
pub mod estimator;
pub mod placement;
pub mod run;
#[cfg(feature = "workbook")]
pub mod plot;
pub mod check;
pub mod trade;
pub mod inversion;
pub mod rectangle;
pub mod lambertian;
pub mod roulette;
pub mod paths;
#[cfg(feature = "workbook")]
pub mod workbook;
#[cfg(feature = "notebook")]
pub mod notebook;

pub use doubt::Doubt;
pub use error::{Error, Result};
pub use estimate::Estimate;
pub use estimator::{Density, Estimator, f_over_p, from_fn, from_uniforms};
pub use run::{Budget, Clock, Cost, Outcome, Part, Progress, Run, Shortfall, estimate, merge};
pub use stream::Stream;

/// The README's code runs as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
