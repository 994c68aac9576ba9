//! The Monte Carlo and global illumination workbook: every question answered in closed form, by an estimator
//! with its error bar, and by a figure.
//!
//! Everything is an instance of one formula,
//!
//! > ⟨Fₙ⟩ = 1/n Σ f(Xᵢ)/p(Xᵢ),
//!
//! and the crate has a type for each part of it: a [`Density`] to draw from, an [`Estimator`] made from an
//! integrand and a density by [`f_over_p`], a [run](estimate()) of that estimator, and the [`Estimate`] with
//! its standard error.
//!
//! ```
//! use unbiased::{Budget, estimate, lambertian::{Lambertian, hemisphere::Hemisphere}};
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
//! | section | module | contains |
//! |---|---|---|
//! | 1 The inversion method | [`inversion`] | the exponential distribution, and any cdf inverted |
//! | 2 Unbiased estimators | [`rectangle`] | independent, paired, jittered and Sobol points on a rectangle |
//! | 3 The diffuse cube | [`lambertian`] | directions, a Lambertian surface, lights with exact variances |
//! | 4 Paths | [`paths`], [`paths::room`] | the scene, its closed forms, and paths through it |
//! | 5 Russian roulette | [`roulette`] | bounce counts, the wrapper X_rr, variance and work |
//!
//! [`check`] tests whether an estimator is unbiased and, if not, names the classic mistakes that it looks
//! like; try your own in `examples/check_mine.rs`. [`trade`] measures which estimator is the most accurate
//! for a given computing time.
//!
//! These modules build on [`estimator`], [`placement`], [`run`], [`estimate`](mod@estimate), [`stream`] and
//! [`error`]. With the feature `workbook` (on by default) there are also `plot` (figures), `question` (a
//! question's texts, parameters and numbers) and `workbook` (the examples' command line, worksheets and
//! keys). The files in `examples/` are the worked answers, one file per question.
//!
//! # Conventions
//!
//! U is uniform on [0, 1); ρ is an albedo, f_r = ρ/π the BRDF, θ the angle to the surface normal; ω_i points
//! towards the light. A draw is one *independent* unbiased value: a whole jittered or scrambled Sobol point
//! set counts as one draw. Random numbers come from [`Stream`], a named generator with an explicit seed; the
//! same seed gives the same bits for any number of threads.
//!
//! # Features
//!
//! - `workbook` (default): figures as SVG and CSV, the examples' command line, the HTML page.
//! - `notebook` (default): figures, estimates and verdicts are shown as images and HTML in Jupyter.
//! - `png`, `pdf`: figures in those formats, too.
//!
//! # Glossary
//!
//! - **albedo** ρ: the fraction of the incoming light that a surface reflects, in [0, 1].
//! - **bias**: the mean of an estimator minus the truth.
//! - **block**: consecutive draws of a run that share one [`Stream`]; blocks are computed in parallel.
//! - **BRDF** f_r: reflected radiance per incoming irradiance; ρ/π for a Lambertian surface.
//! - **confidence level**: the probability that an interval contains the truth; 95 % where none is given.
//! - **density** or **pdf** p: probability per unit of the sampled domain; here a [`Density`].
//! - **diagnosis**: the list of classic mistakes whose ratios fit what was measured; [`check::diagnose()`].
//! - **draw**: one independent value of an estimator; an estimate is the mean of many draws.
//! - **estimator**: a function of uniform random numbers whose mean is meant to be the truth; [`Estimator`].
//! - **evaluation**: one call of the integrand, one ray or one path vertex: the unit of work in a [`Cost`].
//! - **exercise**: an estimator to be written, with its probes and classic mistakes; [`check::Exercise`].
//! - **mistake**: a classic wrong estimator of an exercise, with the way to correct it; [`check::Mistake`].
//! - **next-event estimation** ("light sampled"): at each path vertex, sampling a point on the emitter.
//! - **placement**: replacing independent random numbers by jittered or Sobol points; [`placement`].
//! - **probe**: a problem with known truth, on which an estimator is tried; [`check::Probe`].
//! - **radiance** L: light per area perpendicular to its direction and per solid angle, in W m⁻² sr⁻¹.
//! - **ratio**: a mean divided by the truth: 1 for an unbiased estimator; [`check::Ratio`].
//! - **replicate**: one randomised point set, taken as a whole; it counts as one draw.
//! - **roulette** (Russian roulette): ending a path at random and dividing by the probability of going on.
//! - **seed**: the number that, with the number of draws, determines all random numbers of a run.
//! - **shard**: one of several parts of a run, computed separately and merged later; [`Part`].
//! - **standard error** (std error): the standard deviation of a mean, estimated by s/√n.
//! - **stream**: the random numbers of one block; [`Stream`].
//! - **throughput**: the product of BRDF · cosine/pdf factors along a path, which multiplies the light found.
//! - **truth**: the exact value to be estimated, known in closed form or by quadrature.
//! - **variant**: a worksheet with other parameters, drawn from a seed, for each student.
//! - **z**: (mean − truth)/(standard error); near a standard normal number if the estimator is unbiased.

#![warn(clippy::missing_errors_doc)]

// each module uses only those above it
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
#[cfg(feature = "workbook")]
pub mod question;
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
