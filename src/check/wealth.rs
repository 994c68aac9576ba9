//! Betting against a mean: wealth that cannot grow if the mean is what is claimed.
//!
//! For draws Y ≥ 0 of mean m, 1 + f(Y/m − 1) is a fair bet of the fraction f of one's wealth: its mean is 1.
//! The product over draws is a non-negative martingale, so the probability that it ever reaches 1/α is at
//! most α (Ville 1939), whenever one looks and whatever the distribution. Bets of several sizes are made side
//! by side and the wealth is their mean. (Waudby-Smith & Ramdas 2024, "Estimating means of bounded random
//! variables by betting".)

/// Sizes of bet made side by side.
pub(super) const BETS: usize = 10;

/// The largest fraction bet: what is left after losing it all is 0.1, so wealth never vanishes.
const BOLDEST: f64 = 0.9;

/// A growth of each bet's wealth, as logarithms.
pub(super) type Growth = [f64; BETS];

/// Bets that draws in [0, largest] have a larger mean than `mean`.
#[derive(Debug, Clone)]
pub(super) struct Bets {
    mean: f64,
    fractions: [f64; BETS],
    /// How many factors can be multiplied before their product could leave f64.
    run: usize,
}

impl Bets {
    /// Against `mean` > 0, with fractions from `timid` to 0.9 in geometric steps.
    pub fn against(mean: f64, largest: f64, timid: f64) -> Self {
        let step = (timid / BOLDEST).powf(1.0 / (BETS - 1) as f64);
        let fractions = std::array::from_fn(|bet| BOLDEST * step.powi(bet as i32));
        // a factor lies in [0.1, 1 + 0.9·largest/mean], and 2^±900 is well inside f64
        let bits = (1.0 + largest / mean).log2().max(10f64.log2());
        Self { mean, fractions, run: ((900.0 / bits) as usize).clamp(1, 64) }
    }

    /// What the draws y, given through `shifted`, multiply each bet's wealth by.
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

/// The wealth of all bets so far.
#[derive(Debug, Clone, Default)]
pub(super) struct Wealth {
    logs: [Sum; BETS],
}

impl Wealth {
    pub fn grow(&mut self, growth: &Growth) {
        for (log, growth) in self.logs.iter_mut().zip(growth) {
            log.add(*growth);
        }
    }

    /// ln of the mean wealth of the bets.
    pub fn log_mean(&self) -> f64 {
        let logs = self.logs.map(|log| log.value());
        let largest = logs.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = logs.into_iter().map(|log| (log - largest).exp()).sum();
        largest + (sum / BETS as f64).ln()
    }
}

/// A compensated sum (Neumaier 1974).
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    sum: f64,
    lost: f64,
}

impl Sum {
    fn add(&mut self, x: f64) {
        let sum = self.sum + x;
        let (large, small) = if self.sum.abs() >= x.abs() { (self.sum, x) } else { (x, self.sum) };
        self.lost += (large - sum) + small;
        self.sum = sum;
    }

    fn value(self) -> f64 {
        self.sum + self.lost
    }
}
