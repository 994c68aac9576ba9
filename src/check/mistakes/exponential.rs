//! Mistakes in sampling the exponential distribution.

use super::{Attempt, Mistake, Probe, Setup, Words, words};
use crate::inversion::Exponential;
use crate::stream::Stream;

/// What is averaged over exponential samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Statistic {
    /// X itself: 1/λ.
    Mean,
    /// F(X), which is uniform whatever λ: ½. It lies in [0, 1] for every sampler, right or wrong.
    Cdf,
    /// X, but at most 2/λ and at least 0: (1 − e⁻²)/λ. It lies in [0, 2/λ].
    Capped,
}

impl Statistic {
    /// What it is called.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mean => "mean of X",
            Self::Cdf => "mean of F(X)",
            Self::Capped => "mean of min(X, 2/λ)",
        }
    }

    /// Its mean over right samples.
    pub(super) fn mean(self, exponential: Exponential) -> f64 {
        match self {
            Self::Mean => exponential.mean(),
            Self::Cdf => 0.5,
            Self::Capped => -(-2.0f64).exp_m1() * exponential.mean(),
        }
    }

    pub(super) fn of(self, x: f64, rate: f64) -> f64 {
        match self {
            Self::Mean => x,
            Self::Cdf => -(-rate * x.max(0.0)).exp_m1(),
            Self::Capped if x.is_nan() => x,
            Self::Capped => x.clamp(0.0, 2.0 / rate),
        }
    }

    /// Its mean over c·X, with X right and c ≥ 0.
    fn mean_of_scaled(self, c: f64, rate: f64) -> f64 {
        match self {
            Self::Mean => c / rate,
            Self::Cdf => c / (1.0 + c),
            Self::Capped => -(-2.0 / c).exp_m1() * c / rate,
        }
    }
}

pub(super) fn probes() -> Vec<Probe> {
    use Statistic::{Capped, Cdf, Mean};
    [(0.37, Mean), (1.0, Mean), (2.5, Mean), (0.37, Cdf), (2.5, Capped)]
        .into_iter()
        .filter_map(|(rate, statistic)| Probe::exponential(rate, statistic).ok())
        .collect()
}

/// −ln(1 − U)
fn standard(rng: &mut Stream) -> f64 {
    -(1.0 - rng.uniform()).ln()
}

/// Samples that are c(λ) times what they should be.
fn scaled(words: Words, factor: fn(f64) -> f64) -> Mistake {
    let wrong = Attempt::exponential(move |rate, rng| factor(rate) * standard(rng) / rate);
    Mistake::new(words, 1, wrong, move |setup| match *setup {
        Setup::Exponential { rate, statistic } => statistic.mean_of_scaled(factor(rate), rate),
        _ => f64::NAN,
    })
}

/// The same value always.
fn constant(words: Words, value: fn(f64) -> f64) -> Mistake {
    let wrong = Attempt::exponential(move |rate, _| value(rate));
    Mistake::new(words, 1, wrong, move |setup| match *setup {
        Setup::Exponential { rate, statistic } => statistic.of(value(rate), rate),
        _ => f64::NAN,
    })
}

/// Any other function of (λ, U): by quadrature.
fn function(words: Words, of: fn(f64, f64) -> f64) -> Mistake {
    Mistake::by_quadrature(words, 1, Attempt::exponential(move |rate, rng| of(rate, rng.uniform())))
}

pub(super) fn mistakes() -> Vec<Mistake> {
    use std::f64::consts::{LN_2, LN_10};
    let divide = "solve 1 − e^(−λx) = u for x: the λ ends up below";
    let log = "e^(−λx) is undone by the natural logarithm";
    let invert = "solve F(x) = u for x: a sample is F⁻¹(U)";
    let vary = "put U into F⁻¹: a sample has to vary";
    vec![
        scaled(words("1.1", "multiplied by λ", "−λ ln(1 − U)", divide), |rate| rate * rate),
        scaled(words("1.1", "λ forgotten", "−ln(1 − U)", divide), |rate| rate),
        scaled(
            words("1.1", "divided by λ²", "−ln(1 − U)/λ²", "the mean is 1/λ; 1/λ² is the variance"),
            |rate| 1.0 / rate,
        ),
        scaled(words("1.1", "divided by √λ", "−ln(1 − U)/√λ", divide), f64::sqrt),
        scaled(words("1.2", "log base 10", "−log₁₀(1 − U)/λ", log), |_| 1.0 / LN_10),
        scaled(words("1.2", "log base 2", "−log₂(1 − U)/λ", log), |_| 1.0 / LN_2),
        function(
            words(
                "1.1",
                "the sign forgotten",
                "ln(1 − U)/λ",
                "the logarithm of 1 − U is negative: −ln(1 − U)/λ",
            ),
            |rate, u| (1.0 - u).ln() / rate,
        ),
        constant(words("1.1", "the median returned", "ln 2/λ", vary), |rate| LN_2 / rate),
        constant(words("1.1", "the mean returned", "1/λ", vary), |rate| 1.0 / rate),
        function(words("1.2", "p read at U", "λ e^(−λU)", invert), |rate, u| rate * (-rate * u).exp()),
        function(words("1.2", "F read at U instead of inverted", "1 − e^(−λU)", invert), |rate, u| {
            -(-rate * u).exp_m1()
        }),
        function(words("1.1", "the survival function read at U", "e^(−λU)", invert), |rate, u| {
            (-rate * u).exp()
        }),
        function(words("1.1", "uniform samples of length 1/λ", "U/λ", invert), |rate, u| u / rate),
        function(words("1.1", "uniform samples with the right mean", "2U/λ", invert), |rate, u| {
            2.0 * u / rate
        }),
        function(
            words(
                "1.1",
                "the square root of Box and Muller",
                "√(−2 ln(1 − U))/λ",
                "that is for normal samples",
            ),
            |rate, u| (-2.0 * (1.0 - u).ln()).sqrt() / rate,
        ),
        Mistake::new(
            words(
                "1.1",
                "the logarithm of two uniform numbers",
                "−ln(U V)/λ",
                "one U a sample: the sum of two samples has density λ²x e^(−λx)",
            ),
            2,
            Attempt::exponential(|rate, rng| (standard(rng) + standard(rng)) / rate),
            |setup| match *setup {
                Setup::Exponential { rate, statistic } => match statistic {
                    Statistic::Mean => 2.0 / rate,
                    Statistic::Cdf => 0.75,
                    // E min(G, c) of the gamma law with shape 2: 2 − (2 + c)e^(−c) at c = 2
                    Statistic::Capped => (2.0 - 4.0 * (-2.0f64).exp()) / rate,
                },
                _ => f64::NAN,
            },
        ),
        function(
            words(
                "1.1",
                "1 − U kept above 1e-3 under the logarithm",
                "−ln max(1 − U, 1e-3)/λ",
                "with U in [0, 1) the logarithm is finite: no ε is needed",
            ),
            |rate, u| -(1.0 - u).max(1e-3).ln() / rate,
        ),
        Mistake::new(
            words("1.1", "U on 2¹⁵ levels", "U = j/2¹⁵", "take a generator of 53 bits"),
            0, // so many steps are nothing for quadrature
            Attempt::exponential(|rate, rng| -(1.0 - (rng.uniform() * LEVELS).floor() / LEVELS).ln() / rate),
            |setup| match *setup {
                Setup::Exponential { rate, statistic } => {
                    let sample = |level: u32| statistic.of(-(f64::from(level) / LEVELS).ln() / rate, rate);
                    (1..=LEVELS as u32).map(sample).sum::<f64>() / LEVELS
                }
                _ => f64::NAN,
            },
        ),
    ]
}

const LEVELS: f64 = 32_768.0;
