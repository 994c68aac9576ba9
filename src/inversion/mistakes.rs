//! Mistakes in sampling the exponential distribution.

use std::fmt;
use std::sync::LazyLock;

use super::Exponential;
use crate::check::{About, Exercise, Given, Mistake, Problem, Words};
use crate::stream::Stream;

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
            let right = |p: &Samples, rng: &mut Stream| -(1.0 - rng.uniform()).ln() / p.rate;
            Exercise::new(ABOUT, &[right], mistakes())
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
        vec![("rate", Given::Number(self.rate)), ("average", Given::Word(self.statistic.word()))]
    }

    fn factors(&self) -> Vec<(&'static str, f64)> {
        vec![("λ", self.rate)]
    }
}

impl Statistic {
    fn word(self) -> &'static str {
        match self {
            Self::Mean => "x",
            Self::Cdf => "cdf",
            Self::Capped => "capped",
        }
    }
}

impl fmt::Display for Samples {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let statistic = match self.statistic {
            Statistic::Mean => "X",
            Statistic::Cdf => "F(X)",
            Statistic::Capped => "min(X, 2/λ)",
        };
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

/// A wrong sample: a function of the rate and one uniform number.
fn of(
    id: &'static str,
    name: &'static str,
    formula: &'static str,
    mend: &'static str,
    x: fn(f64, f64) -> f64,
) -> Mistake {
    let words = Words { id, question: "1.1", name, formula, mend };
    Mistake::new(words, move |p: &Samples, rng| x(p.rate, rng.uniform()))
}

/// A mistake that returns the same value in every draw.
fn fixed(
    id: &'static str,
    name: &'static str,
    formula: &'static str,
    mend: &'static str,
    x: fn(f64) -> f64,
) -> Mistake {
    let words = Words { id, question: "1.1", name, formula, mend };
    Mistake::new(words, move |p: &Samples, _| x(p.rate))
}

#[rustfmt::skip] // a list to be read
fn mistakes() -> Vec<Mistake> {
    use std::f64::consts::LN_2;
    let divide = "solve 1 − e^(−λx) = u for x: divide by λ";
    let log = "e^(−λx) is undone by the natural logarithm";
    let invert = "solve F(x) = u for x: a sample is F⁻¹(U)";
    let vary = "put U into F⁻¹: a sample has to vary";
    let sign = "the logarithm of 1 − U is negative: −ln(1 − U)/λ";
    let tail = "with U in [0, 1) the logarithm is finite: no ε is needed";
    let words = |id, name, formula, mend| Words { id, question: "1.1", name, formula, mend };
    vec![
        of("times-rate", "multiplied by λ", "−λ ln(1 − U)", divide, |rate, u| -rate * (1.0 - u).ln()),
        of("no-rate", "λ forgotten", "−ln(1 − U)", divide, |_, u| -(1.0 - u).ln()),
        of(
            "rate-squared",
            "divided by λ²",
            "−ln(1 − U)/λ²",
            "the mean is 1/λ; 1/λ² is the variance",
            |rate, u| -(1.0 - u).ln() / (rate * rate),
        ),
        of("root-rate", "divided by √λ", "−ln(1 − U)/√λ", divide, |rate, u| -(1.0 - u).ln() / rate.sqrt()),
        of("log10", "log base 10", "−log₁₀(1 − U)/λ", log, |rate, u| -(1.0 - u).log10() / rate),
        of("log2", "log base 2", "−log₂(1 − U)/λ", log, |rate, u| -(1.0 - u).log2() / rate),
        of("sign", "the sign forgotten", "ln(1 − U)/λ", sign, |rate, u| (1.0 - u).ln() / rate),
        fixed("median", "the median returned", "ln 2/λ", vary, |rate| LN_2 / rate),
        fixed("mean", "the mean returned", "1/λ", vary, |rate| 1.0 / rate),
        of("pdf-read", "p read at U", "λ e^(−λU)", invert, |rate, u| rate * (-rate * u).exp()),
        of("cdf-read", "F read at U instead of inverted", "1 − e^(−λU)", invert,
            |rate, u| -(-rate * u).exp_m1()),
        of("survival", "the survival function read at U", "e^(−λU)", invert, |rate, u| (-rate * u).exp()),
        of("uniform", "uniform samples of length 1/λ", "U/λ", invert, |rate, u| u / rate),
        of("uniform-mean", "uniform samples with the right mean", "2U/λ", invert, |rate, u| 2.0 * u / rate),
        of("box-muller", "the square root of Box and Muller", "√(−2 ln(1 − U))/λ",
            "that is for normal samples", |rate, u| (-2.0 * (1.0 - u).ln()).sqrt() / rate),
        Mistake::new(
            words(
                "two-logs",
                "the logarithm of two uniform numbers",
                "−ln(U V)/λ",
                "one U a sample: the sum of two samples has density λ²x e^(−λx)",
            ),
            |p: &Samples, rng| -((1.0 - rng.uniform()) * (1.0 - rng.uniform())).ln() / p.rate,
        ),
        of("floor", "1 − U kept above 1e-3 under the logarithm", "−ln max(1 − U, 1e-3)/λ", tail,
            |rate, u| -(1.0 - u).max(1e-3).ln() / rate),
        of("floor-tenth", "1 − U kept above 0.1", "−ln max(1 − U, 0.1)/λ", tail,
            |rate, u| -(1.0 - u).max(0.1).ln() / rate),
        of("one-plus", "ln(1 + U) for −ln(1 − U)", "ln(1 + U)/λ",
            "1 − F(x) = 1 − u: the minus stays under the logarithm", |rate, u| u.ln_1p() / rate),
        of("log-below", "divided by the logarithm", "−1/(λ ln(1 − U)), at most 10/λ", divide,
            |rate, u| (-1.0 / (1.0 - u).ln()).min(10.0) / rate),
        of("levels", "U on 2¹⁵ levels", "U = j/2¹⁵", "take a generator of 53 bits",
            |rate, u| -(1.0 - (u * 32_768.0).floor() / 32_768.0).ln() / rate),
    ]
}
