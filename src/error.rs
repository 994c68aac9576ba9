//! What can go wrong, with a one-sentence message each.

use crate::numbers::{parseable, rounded};

/// Why a question could not be answered.
///
/// Every variant says what was wrong, the value that was given and what is allowed, and displays as
/// one sentence without a full stop.
///
/// ```
/// let error = unbiased::inversion::Exponential::new(-1.0).unwrap_err();
/// assert_eq!(error.to_string(), "the rate λ must be positive and finite, not -1");
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A parameter lies outside its domain.
    #[error("{name} must be {allowed}, not {}", parseable(*.value))]
    Parameter {
        /// The parameter, as the worksheet calls it.
        name: &'static str,
        /// The value given.
        value: f64,
        /// The values that would have been accepted.
        allowed: &'static str,
    },
    /// A count lies outside its domain.
    #[error("{name} must be {allowed}, not {value}")]
    Count {
        /// What was counted.
        name: &'static str,
        /// The count given.
        value: u64,
        /// The counts that would have been accepted.
        allowed: &'static str,
    },
    /// A point is not in the part of the box room where it must be.
    #[error("the point ({}, {}, {}) {reason}", parseable(*.x), parseable(*.y), parseable(*.z))]
    Point {
        /// Its x coordinate in metres.
        x: f64,
        /// Its y coordinate.
        y: f64,
        /// Its z coordinate.
        z: f64,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// An estimator returned NaN or an infinity.
    #[error("draw {draw} of block {block} is {value} (seed {seed}): an estimate needs finite draws")]
    Draw {
        /// The run's seed.
        seed: u64,
        /// The block of draws, counted from 0.
        block: u64,
        /// The draw within its block, counted from 0.
        draw: u64,
        /// The value it had.
        value: f64,
    },
    /// An estimator that is tried on several probes returned NaN or an infinity.
    #[error("on the probe “{probe}” a draw is {value}: an estimate needs finite draws")]
    OnProbe {
        /// The probe.
        probe: String,
        /// Whether it is the very first draw.
        first: bool,
        /// The value it had.
        value: f64,
    },
    /// An estimator that is tried on several probes panicked.
    #[error("on the probe “{probe}” the estimator panics: {reason}")]
    Panic {
        /// The probe.
        probe: String,
        /// The panic's message and source location.
        reason: String,
    },
    /// A draw lies outside the range claimed for it.
    #[error("draw {draw} of block {block} is {} (seed {seed}), outside the range [{}, {}] claimed for \
             it", parseable(*.value), parseable(.range[0]), parseable(.range[1]))]
    OutOfRange {
        /// The check's seed.
        seed: u64,
        /// The block of draws, counted from 0.
        block: u64,
        /// The draw within its block, counted from 0.
        draw: u64,
        /// The value it had.
        value: f64,
        /// The range claimed.
        range: [f64; 2],
    },
    /// The shards given are not all the shards of one run.
    #[error("the shards do not make a run: {reason}")]
    Parts {
        /// What is wrong with them.
        reason: String,
    },
    /// An estimator cannot be integrated by quadrature over its random numbers.
    #[error("the estimator cannot be integrated: {reason}")]
    NotIntegrable {
        /// Why not.
        reason: String,
    },
    /// Too few draws for the statistic asked for.
    #[error("{statistic} needs at least {needed} draws, not {draws}")]
    TooFewDraws {
        /// What was asked for.
        statistic: &'static str,
        /// How many draws it needs.
        needed: u64,
        /// How many there are.
        draws: u64,
    },
    /// The std error asked for takes more draws than the run allows.
    #[error("{}, more than the limit of {limit}: ask for a larger error, allow more draws, or give a \
             time", takes(*.std_error, *.needed))]
    Budget {
        /// The standard error asked for.
        std_error: f64,
        /// The draws needed for it, from the pilot run's variance.
        needed: f64,
        /// The run's limit.
        limit: u64,
    },
    /// A time budget was given, but the clock does not advance.
    #[error("the clock stands still or goes back: give a number of draws instead of a time")]
    Clock,
    /// The function given is not a cumulative distribution function.
    #[error("the function given is not a cdf: {reason}")]
    NotACdf {
        /// Where and why it fails, with the values there.
        reason: String,
    },
    /// The worker threads could not be started.
    #[error("{threads} threads could not be started: {reason}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// What the system said.
        reason: String,
    },
    /// A file or folder could not be written.
    #[error("{path} could not be written: {reason}")]
    Write {
        /// The file or folder.
        path: String,
        /// What the system said.
        reason: String,
    },
    /// A figure or page could not be drawn.
    #[error("{what} could not be drawn: {reason}")]
    Draft {
        /// The figure, formula or page.
        what: String,
        /// What the drawing library said.
        reason: String,
    },
    /// A command line was not understood.
    #[error("{0}")]
    Usage(String),
}

/// A `Result` with this crate's [`Error`].
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// `value` if `ok`, else an error that names it.
pub(crate) fn require(name: &'static str, value: f64, ok: bool, allowed: &'static str) -> Result<f64> {
    if ok { Ok(value) } else { Err(Error::Parameter { name, value, allowed }) }
}

/// The same for a count.
pub(crate) fn require_count(name: &'static str, value: u64, ok: bool, allowed: &'static str) -> Result<u64> {
    if ok { Ok(value) } else { Err(Error::Count { name, value, allowed }) }
}

/// "a std error of 6e-4 takes about 1.2e9 draws"
pub(crate) fn takes(std_error: f64, draws: f64) -> String {
    let std_error = rounded(std_error, 3);
    if draws < 1e300 {
        format!("a std error of {std_error} takes about {} draws", rounded(draws, 2))
    } else {
        format!("a std error of {std_error} takes more than 1e300 draws")
    }
}
