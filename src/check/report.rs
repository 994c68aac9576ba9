//! What a check of a mean finds.

use std::fmt;

use crate::estimate::Estimate;

/// The verdict of a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The mean is not the truth; this is wrong with probability at most α.
    Biased,
    /// The mean is within δ of the truth; this is wrong with probability at most 2β = 2e-6.
    Unbiased,
    /// Neither could be shown with the draws allowed. Do not count it as a pass.
    Undecided,
}

/// A check's verdict, with its mean and settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Report {
    /// The verdict.
    pub verdict: Verdict,
    /// The mean claimed.
    pub truth: f64,
    /// The estimate from all draws.
    pub estimate: Estimate,
    /// The tolerance, |δμ| unless the truth is 0: a smaller difference counts as none.
    pub tolerance: f64,
    /// The probability of calling a right estimator biased.
    pub alpha: f64,
    /// The seed of all draws.
    pub seed: u64,
}

/// The bettors' wealth after some of a check's draws, as natural logarithms, which start at 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// The draws so far.
    pub draws: u64,
    /// ln of the average wealth of the two who bet that the mean is larger or smaller than the truth:
    /// *biased* once it reaches ln(1/α).
    pub against_truth: f64,
    /// ln of the wealth of the bettor that the mean is larger than truth − tolerance: a lower mean is
    /// excluded once it reaches ln(1/β).
    pub against_too_low: f64,
    /// ln of the wealth of the bettor that the mean is smaller than truth + tolerance; stays 0 if the range
    /// has no upper end.
    pub against_too_high: f64,
}

/// The verdict in a sentence.
impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { truth, estimate, tolerance, alpha, .. } = *self;
        let draws = estimate.draws();
        match self.verdict {
            Verdict::Unbiased => {
                write!(
                    f,
                    "unbiased within {tolerance:.1e}: {estimate} after {draws} draws, the truth is {truth}"
                )
            }
            Verdict::Biased => {
                let ratio = estimate.mean() / truth;
                let error = estimate.std_error().unwrap_or(f64::INFINITY) / truth.abs();
                write!(
                    f,
                    "biased: {estimate} after {draws} draws, {ratio:.3} ± {error:.3} times the truth \
                     {truth}; a right estimator would be called biased with probability {alpha:.0e} at most"
                )
            }
            Verdict::Undecided => write!(
                f,
                "undecided after {draws} draws: {estimate}, the truth is {truth} and the tolerance is \
                 {tolerance:.1e}"
            ),
        }
    }
}
