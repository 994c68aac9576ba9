//! What draws come to on the probes of an exercise.

use super::exercise::Probe;
use crate::estimate::Estimate;

/// A mean over a probe's scale, with its std error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ratio {
    /// The ratio.
    pub mean: f64,
    /// Its std error; 0 where all draws are alike.
    pub error: f64,
}

/// Estimators in f32 are right to about this, relative to the truth, however small their std error.
const ROUNDING: f64 = 1e-6;

/// Ratios that differ by less than this look alike to the draws that people take.
const ALIKE: f64 = 1e-3;

/// Std errors by which two means found by points certainly differ.
const APART: f64 = 6.0;

impl Ratio {
    pub(super) const UNKNOWN: Self = Self { mean: f64::NAN, error: 0.0 };

    pub(super) const fn exact(mean: f64) -> Self {
        Self { mean, error: 0.0 }
    }

    pub(super) fn of(estimate: &Estimate, scale: f64) -> Self {
        Self { mean: estimate.mean() / scale, error: estimate.std_error().unwrap_or(f64::INFINITY) / scale }
    }

    pub(super) fn times(self, factor: f64) -> Self {
        Self { mean: factor * self.mean, error: factor.abs() * self.error }
    }

    /// Whether it is another ratio than `other`, by so much that draws can show it.
    pub fn differs(self, other: Self) -> bool {
        let size = self.mean.abs().min(other.mean.abs()).max(1.0);
        let known = APART * self.error.hypot(other.error);
        let alike = (self.mean - other.mean).abs() <= known.max(ALIKE * size);
        !alike
    }

    /// Whether draws with this ratio vary; points show it, whatever the integrand.
    fn varies(self) -> bool {
        self.error > 1e-13 * self.mean.abs()
    }
}

/// What draws on one probe came to.
#[derive(Debug, Clone, Copy)]
pub struct Measurement {
    /// The probe.
    pub probe: &'static Probe,
    /// The mean found.
    pub estimate: Estimate,
    /// The skewness of the draws, E\[(X − μ)³\]/σ³; NaN where it is not known.
    pub skewness: f64,
}

impl Measurement {
    /// The mean found over the probe's scale, with its std error.
    pub fn ratio(&self) -> Ratio {
        Ratio::of(&self.estimate, self.probe.scale())
    }

    /// Whether all draws are the same.
    pub fn never_varied(&self) -> bool {
        self.estimate.variance().is_none_or(|variance| variance == 0.0)
    }

    /// How badly draws whose mean is `predicted` fit what was found: near χ² with one degree of freedom if
    /// they are its draws.
    ///
    /// It is t², for a t that is not near normal where draws are few or skew. Say they are 0 but for a few
    /// hits: with one hit where ten were due, t = −9, and yet the chance of it is 5e-4. So t² is replaced by
    /// what the likelihood of a gamma law with the draws' skewness makes of it, where that is less, 2/κ²
    /// (ln(1 + x) …) with x = κt and κ = γ/√n, which is Poisson's for hits; and the result by Student's, ν
    /// ln(1 + t²/ν).
    pub(super) fn misfit(&self, predicted: Ratio) -> f64 {
        let found = self.ratio();
        if predicted.mean.is_nan() {
            return f64::INFINITY;
        }
        let floor = ROUNDING * predicted.mean.abs().max(1.0);
        let off = found.mean - predicted.mean;
        if self.never_varied() {
            // that varying draws never do is not to be seen as evidence for them
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

    /// Whether all draws are what a right estimator's mean is.
    pub(super) fn is_the_truth(&self) -> bool {
        (self.ratio().mean - self.probe.right_ratio()).abs() <= ROUNDING
    }
}

/// Draws that come one after the other, from another program for instance: their mean, spread and skewness in
/// constant memory.
#[derive(Debug, Clone, Copy, Default)]
pub struct Tally {
    estimate: Estimate,
    /// The first draw, and the sums of the squares and cubes of the distance to it.
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

    /// How many there were.
    pub fn draws(&self) -> u64 {
        self.estimate.draws()
    }

    /// What they came to, taken for draws on this probe.
    pub fn on(&self, probe: &'static Probe) -> Measurement {
        let (n, shift) = (self.draws() as f64, self.estimate.mean() - self.pivot);
        let [second, third] = [self.squares / n, self.cubes / n];
        let central = third - shift * (3.0 * second - 2.0 * shift * shift);
        let skewness = central / (second - shift * shift).powf(1.5);
        Measurement { probe, estimate: self.estimate, skewness }
    }
}
