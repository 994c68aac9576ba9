//! Tests of a mean by betting: the wealth is not expected to grow if the mean is as claimed.
//!
//! For draws Y ≥ 0 of mean m, the factor 1 + f(Y/m − 1) has mean 1: it is a fair bet of the fraction f of the
//! wealth. The product over draws is a non-negative martingale, so the probability that it ever reaches 1/α
//! is at most α (Ville 1939), for any distribution and any stopping rule. Bets with several fractions are
//! made in parallel, and the wealth is the mean of theirs. (Waudby-Smith & Ramdas 2024, "Estimating means of
//! bounded random variables by betting".)

use crate::float::two_sum;

/// How many fractions are bet in parallel.
pub(super) const BETS: usize = 10;

/// The largest fraction bet: at least 0.1 of the wealth is left after a loss, so it never becomes 0.
const LARGEST: f64 = 0.9;

/// The logarithm of the factor by which each bet's wealth grows.
pub(super) type Growth = [f64; BETS];

/// Bets that draws in [0, largest] have a mean larger than `mean`.
#[derive(Debug, Clone)]
pub(super) struct Bets {
    mean: f64,
    fractions: [f64; BETS],
    /// How many factors can be multiplied without over- or underflow.
    run: usize,
}

impl Bets {
    /// Bets against `mean` > 0, with fractions from `smallest` to 0.9 in geometric steps.
    pub fn against(mean: f64, largest: f64, smallest: f64) -> Self {
        let step = (smallest / LARGEST).powf(1.0 / (BETS - 1) as f64);
        let fractions = std::array::from_fn(|bet| LARGEST * step.powi(bet as i32));
        // a factor lies in [0.1, 1 + 0.9·largest/mean], and 2^±900 is well inside f64
        let bits = (1.0 + largest / mean).log2().max(10f64.log2());
        Self { mean, fractions, run: ((900.0 / bits) as usize).clamp(1, 64) }
    }

    /// The growth of each bet's wealth by the draws y = `shifted(draw)`.
    pub fn growth(&self, draws: &[f64], shifted: impl Fn(f64) -> f64) -> Growth {
        let mut growth = [0.0; BETS];
        let mut ratios = [0.0; 64];
        for run in draws.chunks(self.run) {
            let ratios = &mut ratios[..run.len()];
            for (ratio, draw) in ratios.iter_mut().zip(run) {
                *ratio = shifted(*draw) / self.mean;
            }
            for (growth, fraction) in growth.iter_mut().zip(self.fractions) {
                *growth += product(ratios, fraction).ln();
            }
        }
        growth
    }
}

/// Π (1 + f(rᵢ − 1)), in eight interleaved lanes.
fn product(ratios: &[f64], fraction: f64) -> f64 {
    let kept = 1.0 - fraction;
    let mut lanes = [1.0; 8];
    let (eights, rest) = ratios.as_chunks::<8>();
    for eight in eights {
        for (lane, ratio) in lanes.iter_mut().zip(eight) {
            *lane *= kept + fraction * ratio;
        }
    }
    for (lane, ratio) in lanes.iter_mut().zip(rest) {
        *lane *= kept + fraction * ratio;
    }
    lanes.iter().product()
}

/// The logarithm of each bet's wealth so far, with the rounding error of its sum.
#[derive(Debug, Clone, Default)]
pub(super) struct Wealth {
    logs: [(f64, f64); BETS],
}

impl Wealth {
    pub fn grow(&mut self, growth: &Growth) {
        for ((log, lost), growth) in self.logs.iter_mut().zip(growth) {
            let (sum, error) = two_sum(*log, *growth);
            (*log, *lost) = (sum, *lost + error);
        }
    }

    /// ln of the mean wealth of the bets.
    pub fn log_mean(&self) -> f64 {
        let logs = self.logs.map(|(log, lost)| log + lost);
        let largest = logs.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = logs.into_iter().map(|log| (log - largest).exp()).sum();
        largest + (sum / BETS as f64).ln()
    }
}
