//! Mistakes in sampling the exponential distribution.

use std::f64::consts::LN_2;
use std::fmt;
use std::sync::LazyLock;

use super::Exponential;
use crate::check::{About, Exercise, Given, Listed, Problem};

/// The problem of sampling the exponential distribution with rate λ. An attempt returns one sample per draw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Samples {
    /// The rate λ.
    pub rate: f64,
    /// What is averaged over the samples.
    pub statistic: Statistic,
}

/// What is averaged over exponential samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Statistic {
    /// X: mean 1/λ.
    Mean,
    /// F(X): mean ½, as it is uniform for every λ. In \[0, 1\] for every sampler, right or wrong.
    Cdf,
    /// X clamped to \[0, 2/λ\]: mean (1 − e⁻²)/λ.
    Capped,
}

static PROBLEMS: [Samples; 6] = [
    Samples { rate: 1.0, statistic: Statistic::Mean },
    Samples { rate: 0.37, statistic: Statistic::Mean },
    Samples { rate: 2.5, statistic: Statistic::Mean },
    Samples { rate: 0.37, statistic: Statistic::Cdf },
    Samples { rate: 2.5, statistic: Statistic::Capped },
    // rates far from 1
    Samples { rate: 1e-3, statistic: Statistic::Cdf },
];

impl Problem for Samples {
    fn exercise() -> &'static Exercise {
        static EXERCISE: LazyLock<Exercise> = LazyLock::new(|| {
            Exercise::new(ABOUT, &[|p: &Samples, rng| -(1.0 - rng.uniform()).ln() / p.rate], mistakes())
        });
        &EXERCISE
    }

    fn all() -> &'static [Self] {
        &PROBLEMS
    }

    fn truth(&self) -> f64 {
        match self.statistic {
            Statistic::Mean => 1.0 / self.rate,
            Statistic::Cdf => 0.5,
            Statistic::Capped => -(-2.0f64).exp_m1() / self.rate,
        }
    }

    fn value(&self, x: f64) -> f64 {
        match self.statistic {
            _ if x.is_nan() => x,
            Statistic::Mean => x,
            Statistic::Cdf => Exponential::new(self.rate).map_or(f64::NAN, |law| law.cdf(x.max(0.0))),
            Statistic::Capped => x.clamp(0.0, 2.0 / self.rate),
        }
    }

    fn averages_draws(&self) -> bool {
        self.statistic == Statistic::Mean
    }

    fn given(&self) -> Vec<(&'static str, Given)> {
        let [statistic, _] = self.statistic.names();
        vec![("rate", Given::Number(self.rate)), ("average", Given::Word(statistic))]
    }

    fn factors(&self) -> Vec<(&'static str, f64)> {
        vec![("λ", self.rate)]
    }
}

impl Statistic {
    /// Its name for programs, and its name for people.
    fn names(self) -> [&'static str; 2] {
        match self {
            Self::Mean => ["x", "X"],
            Self::Cdf => ["cdf", "F(X)"],
            Self::Capped => ["capped", "min(X, 2/λ)"],
        }
    }
}

impl fmt::Display for Samples {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [_, statistic] = self.statistic.names();
        write!(f, "mean of {statistic}, λ = {}", self.rate)
    }
}

const ABOUT: About = About {
    id: "samples",
    name: "exponential samples",
    questions: &[("1.1", 0), ("1.2", 0)],
    draw: "A draw is a function of one sample X of the exponential distribution with this rate λ:\nx: X \
           itself; cdf: F(X) = 1 − e^(−λX), or 0 where X < 0; capped: X, but at least 0 and at most 2/λ.",
};

#[rustfmt::skip] // a list to be read
fn mistakes() -> &'static [Listed<Samples>] { &[
    (["1.1", "times-rate", "multiplied by λ", "−λ ln(1 − U)", DIVIDE],
        |p, rng| -p.rate * (1.0 - rng.uniform()).ln()),
    (["1.1", "no-rate", "λ forgotten", "−ln(1 − U)", DIVIDE], |_, rng| -(1.0 - rng.uniform()).ln()),
    (["1.1", "rate-squared", "divided by λ²", "−ln(1 − U)/λ²", "the mean is 1/λ; 1/λ² is the variance"],
        |p, rng| -(1.0 - rng.uniform()).ln() / (p.rate * p.rate)),
    (["1.1", "root-rate", "divided by √λ", "−ln(1 − U)/√λ", DIVIDE],
        |p, rng| -(1.0 - rng.uniform()).ln() / p.rate.sqrt()),
    (["1.1", "log10", "log base 10", "−log₁₀(1 − U)/λ", LOG],
        |p, rng| -(1.0 - rng.uniform()).log10() / p.rate),
    (["1.1", "log2", "log base 2", "−log₂(1 − U)/λ", LOG], |p, rng| -(1.0 - rng.uniform()).log2() / p.rate),
    (["1.1", "sign", "the sign forgotten", "ln(1 − U)/λ", "the logarithm of 1 − U is negative: −ln(1 − U)/λ"],
        |p, rng| (1.0 - rng.uniform()).ln() / p.rate),
    (["1.1", "median", "the median returned", "ln 2/λ", VARY], |p, _| LN_2 / p.rate),
    (["1.1", "mean", "the mean returned", "1/λ", VARY], |p, _| 1.0 / p.rate),
    (["1.1", "pdf-read", "p read at U", "λ e^(−λU)", INVERT],
        |p, rng| p.rate * (-p.rate * rng.uniform()).exp()),
    (["1.1", "cdf-read", "F read at U instead of inverted", "1 − e^(−λU)", INVERT],
        |p, rng| -(-p.rate * rng.uniform()).exp_m1()),
    (["1.1", "survival", "the survival function read at U", "e^(−λU)", INVERT],
        |p, rng| (-p.rate * rng.uniform()).exp()),
    (["1.1", "uniform", "uniform samples of length 1/λ", "U/λ", INVERT], |p, rng| rng.uniform() / p.rate),
    (["1.1", "uniform-mean", "uniform samples with the right mean", "2U/λ", INVERT],
        |p, rng| 2.0 * rng.uniform() / p.rate),
    (["1.1", "box-muller", "the square root of Box and Muller", "√(−2 ln(1 − U))/λ",
        "that is for normal samples"],
        |p, rng| (-2.0 * (1.0 - rng.uniform()).ln()).sqrt() / p.rate),
    (["1.1", "two-logs", "the logarithm of two uniform numbers", "−ln(U V)/λ",
        "one U a sample: the sum of two samples has density λ²x e^(−λx)"],
        |p, rng| -((1.0 - rng.uniform()) * (1.0 - rng.uniform())).ln() / p.rate),
    (["1.1", "floor", "1 − U kept above 1e-3 under the logarithm", "−ln max(1 − U, 1e-3)/λ", TAIL],
        |p, rng| -(1.0 - rng.uniform()).max(1e-3).ln() / p.rate),
    (["1.1", "floor-tenth", "1 − U kept above 0.1", "−ln max(1 − U, 0.1)/λ", TAIL],
        |p, rng| -(1.0 - rng.uniform()).max(0.1).ln() / p.rate),
    (["1.1", "one-plus", "ln(1 + U) for −ln(1 − U)", "ln(1 + U)/λ",
        "1 − F(x) = 1 − u: the minus stays under the logarithm"], |p, rng| rng.uniform().ln_1p() / p.rate),
    (["1.1", "log-below", "divided by the logarithm", "−1/(λ ln(1 − U)), at most 10/λ", DIVIDE],
        |p, rng| (-1.0 / (1.0 - rng.uniform()).ln()).min(10.0) / p.rate),
    (["1.1", "levels", "U on 2¹⁵ levels", "U = j/2¹⁵", "take a generator of 53 bits"],
        |p, rng| -(1.0 - (rng.uniform() * 32_768.0).floor() / 32_768.0).ln() / p.rate),
] }

const DIVIDE: &str = "solve 1 − e^(−λx) = u for x: divide by λ";
const LOG: &str = "e^(−λx) is undone by the natural logarithm";
const INVERT: &str = "solve F(x) = u for x: a sample is F⁻¹(U)";
const VARY: &str = "put U into F⁻¹: a sample has to vary";
const TAIL: &str = "with U in [0, 1) the logarithm is finite: no ε is needed";
