//! Reasons not to trust an error bar, named alike wherever numbers are shown.

use std::fmt;

/// Why an error bar cannot be trusted. It displays as a clause; [`mark`](Self::mark) is a short label.
///
/// ```
/// use unbiased::{Doubt, Estimator, roulette::LightModel};
///
/// // p_rr = 0.2 is below ρ²
/// let paths = LightModel::new(0.8, 0.5)?.roulette(0.2)?;
/// assert_eq!(paths.doubt(), Some(Doubt::InfiniteVariance));
/// # Ok::<(), unbiased::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Doubt {
    /// The mean is finite, the variance is not.
    InfiniteVariance,
    /// A reason that follows from the parameters: the variance may be infinite, or most of it may come from
    /// draws so rare that a run may contain none of them.
    Reason(String),
    /// Most of the variance comes from a few of the draws.
    HeavyTail,
    /// All draws were the same.
    NeverVaried,
    /// Too few draws for a verdict.
    TooFewDraws,
}

impl Doubt {
    /// A short label, shown in place of a verdict.
    pub fn mark(&self) -> &'static str {
        match self {
            Self::InfiniteVariance => "infinite variance",
            Self::Reason(_) => "not judged",
            Self::HeavyTail => "heavy tail",
            Self::NeverVaried => "no variance",
            Self::TooFewDraws => "too few draws to judge",
        }
    }
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::InfiniteVariance => "the mean is finite, the variance is not: this error bar means nothing",
            Self::Reason(reason) => reason,
            Self::HeavyTail => "a few draws make up most of the variance, which may be infinite",
            Self::NeverVaried => "all draws were the same, so this error bar tells nothing",
            Self::TooFewDraws => "there are too few draws to judge",
        })
    }
}
