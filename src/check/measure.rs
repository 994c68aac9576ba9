//! Means of draws on the probes of an exercise.

use super::exercise::Probe;
use super::ratio::{APART, Ratio};
use crate::estimate::Estimate;

/// The relative error allowed to estimators in f32, however small their std error.
const ROUNDING: f64 = 1e-6;

/// The estimate from draws on one probe.
#[derive(Debug, Clone, Copy)]
pub struct Measurement {
    /// The probe.
    pub probe: &'static Probe,
    /// The estimate.
    pub estimate: Estimate,
    /// The skewness of the draws, E\[(X − μ)³\]/σ³; NaN if it is not known.
    pub skewness: f64,
}

impl Measurement {
    /// The mean divided by the probe's scale, with its std error.
    pub(crate) fn ratio(&self) -> Ratio {
        Ratio::of(&self.estimate, self.probe.scale)
    }

    /// Whether all draws were the same.
    pub(super) fn never_varied(&self) -> bool {
        self.estimate.variance().is_none_or(|variance| variance == 0.0)
    }

    /// How badly the measured mean fits `predicted`: nearly χ² with one degree of freedom if that is the
    /// draws' true mean.
    ///
    /// It is t², corrected where t is not nearly normal because draws are few or skewed. For example, let
    /// draws be 0 except for rare hits: one hit where ten are expected gives t = −9, although its probability
    /// is 5e-4. So, where that is smaller, t² is replaced by −2 times the log likelihood ratio of a gamma
    /// distribution with the draws' skewness γ, 2/κ² (−x − ln(1 − x)) for x = κt < 0 and κ = γ/√n. For rare
    /// hits that is the Poisson distribution's. Student's correction follows: ν ln(1 + t²/ν).
    pub(super) fn misfit(&self, predicted: Ratio) -> f64 {
        let found = self.ratio();
        if predicted.mean.is_nan() {
            return f64::INFINITY;
        }
        let floor = ROUNDING * predicted.mean.abs().max(1.0);
        let off = found.mean - predicted.mean;
        if self.never_varied() {
            // constant draws are no evidence for a mistake whose draws vary
            let fits = off.abs() <= floor.max(APART * predicted.error) && !predicted.varies();
            return if fits { 0.0 } else { f64::INFINITY };
        }
        let t = off / found.error.hypot(predicted.error).hypot(floor);
        let draws = self.estimate.draws() as f64;
        let skew =
            if self.skewness.is_nan() { t.signum() * -draws.sqrt() } else { self.skewness } / draws.sqrt();
        let x = skew * t;
        let square = if x < -1e-4 { 2.0 / (skew * skew) * (-x - (-x).ln_1p()) } else { t * t };
        let free = draws - 1.0;
        free * (square / free).ln_1p()
    }

    /// Whether the mean equals the truth, up to rounding.
    pub(super) fn is_the_truth(&self) -> bool {
        (self.ratio().mean - self.probe.right_ratio()).abs() <= ROUNDING
    }
}

/// The mean, variance and skewness of draws that are added one at a time, from another program for instance,
/// in constant memory.
#[derive(Debug, Clone, Copy, Default)]
pub struct Tally {
    estimate: Estimate,
    /// The first draw, and the sums of squares and cubes of the differences from it.
    pivot: f64,
    squares: f64,
    cubes: f64,
}

impl Tally {
    /// Adds a draw.
    pub fn push(&mut self, draw: f64) {
        if self.estimate.draws() == 0 {
            self.pivot = draw;
        }
        self.estimate.push(draw);
        let off = draw - self.pivot;
        self.squares += off * off;
        self.cubes += off * off * off;
    }

    /// The number of draws.
    pub fn draws(&self) -> u64 {
        self.estimate.draws()
    }

    /// The measurement, if the draws are those for this probe.
    pub fn on(&self, probe: &'static Probe) -> Measurement {
        let (n, shift) = (self.draws() as f64, self.estimate.mean() - self.pivot);
        let [second, third] = [self.squares / n, self.cubes / n];
        let central = third - shift * (3.0 * second - 2.0 * shift * shift);
        let skewness = central / (second - shift * shift).powf(1.5);
        Measurement { probe, estimate: self.estimate, skewness }
    }
}
