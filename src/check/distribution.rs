//! Is a sampler distributed as claimed? Confidence bands for the cdf that hold for every number of draws.

use std::fmt;

use rand::distr::Distribution;

use crate::error::{Result, require};
use crate::estimator::Estimator;
use crate::float::is_probability;
use crate::stream::Stream;

/// The result of comparing draws with their claimed distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    /// Whether the draws are consistent with the distribution claimed. `false` is wrong with probability at
    /// most α; `true` does not exclude the deviations that `unseen` names.
    pub agrees: bool,
    /// The largest statistic found, divided by the largest one allowed: above 1 the draws do not agree.
    pub strain: f64,
    /// The comparison that gave the largest statistic: "the cdf at 0.5". Cells are counted from 0.
    pub place: String,
    /// Draws taken.
    pub draws: usize,
    /// The probability of calling a right sampler wrong.
    pub alpha: f64,
    /// What this check cannot see.
    pub unseen: &'static str,
}

/// Intervals into which [`points`] divides each of the two uniform numbers.
const CELLS: usize = 8;

/// Compares the distribution of an estimator's draws with a claimed cdf.
///
/// The empirical cdf of n draws stays within √(ln(2/α)/2n) of the true one, everywhere at once, with
/// probability at least 1 − α, for every n and every distribution, including discrete ones (Dvoretzky, Kiefer
/// & Wolfowitz 1956; Massart 1990). The number of draws is chosen so that a deviation of D = `deviation` in
/// the cdf is detected with probability 1 − 1e-6: n = (√(ln(2/α)/2) + √(ln(1e6)/2))²/D², 41 / D² at α =
/// 1e-12. Draws may be infinite: the claimed cdf's value at −∞ is the probability of −∞, and 1 minus its
/// value at the largest finite number that of +∞.
///
/// ```
/// use unbiased::{check, inversion::Exponential};
///
/// let exponential = Exponential::new(0.37)?;
/// assert!(check::distributed_as(&exponential, |x| exponential.cdf(x), 0.01, 1e-12, 1)?.agrees);
/// let claimed = Exponential::new(0.4)?;
/// assert!(!check::distributed_as(&exponential, |x| claimed.cdf(x), 0.01, 1e-12, 1)?.agrees);
/// # Ok::<(), unbiased::Error>(())
/// ```
///
/// # Errors
/// If the deviation is not in (0, 1], α not in (0, 1), a draw is NaN, or the claimed cdf leaves \[0, 1\] by
/// more than 2⁻⁴⁰.
pub fn distributed_as(
    sampler: &(impl Estimator + ?Sized),
    cdf: impl Fn(f64) -> f64,
    deviation: f64,
    alpha: f64,
    seed: u64,
) -> Result<Agreement> {
    let draws = draws_for(deviation, alpha)?;
    let mut rng = Stream::new(seed, 0);
    let mut samples = vec![0.0; draws];
    sampler.fill(&mut rng, &mut samples);
    let (found, at) = largest_deviation(&mut samples, cdf)?;
    Ok(Agreement {
        agrees: found <= band(draws, alpha),
        strain: found / band(draws, alpha),
        place: format!("the cdf at {at:.6}"),
        draws,
        alpha,
        unseen: "a deviation of the cdf smaller than asked for, dependence between draws",
    })
}

/// Compares the distribution of two-dimensional points with a claimed density. `unwarp` maps a point to two
/// numbers that are independent and uniform if the points have that density: for example the cdf of the first
/// coordinate, and that of the second given the first. Each is compared by the band of [`distributed_as`],
/// and both together over 8 × 8 cells.
///
/// A cell of probability p that contains a fraction p̂ of the n points is rejected if n·kl(p̂‖p) > ln(2k/α),
/// with k the number of cells and kl the relative entropy of two Bernoulli distributions. This is Chernoff's
/// bound, valid for every n and p, which Pearson's χ² is not at such levels. Each of the three comparisons
/// uses α/3.
///
/// ```
/// use std::f64::consts::TAU;
/// use unbiased::lambertian::hemisphere::{Direction, Hemisphere::{Cosine, Uniform}};
/// use unbiased::check;
///
/// let claimed = |w: &Direction| [w.cos_theta().powi(2), w.phi() / TAU];
/// assert!(check::points(&Cosine, claimed, 0.01, 1e-12, 1)?.agrees);
/// assert!(!check::points(&Uniform, claimed, 0.01, 1e-12, 1)?.agrees);
/// # Ok::<(), unbiased::Error>(())
/// ```
///
/// # Errors
/// If the deviation is not in (0, 1], α not in (0, 1), or a number that `unwarp` returns is NaN.
pub fn points<P>(
    sampler: &impl Distribution<P>,
    unwarp: impl Fn(&P) -> [f64; 2],
    deviation: f64,
    alpha: f64,
    seed: u64,
) -> Result<Agreement> {
    let part = alpha / 3.0;
    let draws = draws_for(deviation, part)?;
    let mut rng = Stream::new(seed, 0);
    let [mut firsts, mut seconds] = [(); 2].map(|()| Vec::with_capacity(draws));
    let mut counts = [[0u64; CELLS]; CELLS];
    for _ in 0..draws {
        let [u, v] = unwarp(&sampler.sample(&mut rng));
        let cell = |number: f64| ((number * CELLS as f64) as usize).min(CELLS - 1);
        counts[cell(u)][cell(v)] += 1;
        firsts.push(u);
        seconds.push(v);
    }
    let uniform = |number: f64| number.clamp(0.0, 1.0);
    let mut strains = Vec::new();
    for (which, numbers) in [("first", &mut firsts), ("second", &mut seconds)] {
        let (found, at) = largest_deviation(numbers, uniform)?;
        strains
            .push((found / band(draws, part), format!("the cdf of the {which} uniform number at {at:.6}")));
    }
    let cells = (CELLS * CELLS) as f64;
    for (row, counts) in counts.iter().enumerate() {
        for (column, count) in counts.iter().enumerate() {
            let entropy = draws as f64 * relative_entropy(*count as f64 / draws as f64, 1.0 / cells);
            let place = format!("the cell ({row}, {column}) of the two uniform numbers");
            strains.push((entropy / (2.0 * cells / part).ln(), place));
        }
    }
    let (strain, place) = strains.into_iter().max_by(|(a, _), (b, _)| a.total_cmp(b)).unwrap_or_default();
    Ok(Agreement {
        agrees: strain <= 1.0,
        strain,
        place,
        draws,
        alpha,
        unseen: "structure finer than a cell that leaves both numbers uniform, dependence between points",
    })
}

/// Draws with which a deviation is detected with probability 1 − 1e-6.
fn draws_for(deviation: f64, alpha: f64) -> Result<usize> {
    require("the deviation to be seen", deviation, deviation > 0.0 && deviation <= 1.0, "in (0, 1]")?;
    require("the false-alarm probability α", alpha, alpha > 0.0 && alpha < 1.0, "strictly between 0 and 1")?;
    let reach = (0.5 * (2.0 / alpha).ln()).sqrt() + (0.5 * 1e6f64.ln()).sqrt();
    let draws = (reach / deviation).powi(2).ceil();
    Ok(require("the number of draws it takes", draws, draws <= 1e9, "at most 1e9")? as usize)
}

/// The half-width of the band.
fn band(draws: usize, alpha: f64) -> f64 {
    ((2.0 / alpha).ln() / (2.0 * draws as f64)).sqrt()
}

/// sup |Fₙ − F| and where it is. Equal draws are handled together (−0 equals 0), and F at the next smaller
/// number serves as its left limit, so that cdfs with jumps are compared on both sides of each. F(+∞) is
/// taken to be 1 without calling `cdf`; a `cdf(−∞)` of NaN is taken to be 0.
fn largest_deviation(samples: &mut [f64], cdf: impl Fn(f64) -> f64) -> Result<(f64, f64)> {
    samples.sort_unstable_by(f64::total_cmp);
    let n = samples.len() as f64;
    let probability = |x: f64| {
        let f = if x == f64::INFINITY { 1.0 } else { cdf(x) };
        let f = if x == f64::NEG_INFINITY && f.is_nan() { 0.0 } else { f };
        require("the claimed cdf", f, is_probability(f), "in [0, 1]")
    };
    // the first draw becomes the worst if no draw deviates
    let mut worst = (f64::NEG_INFINITY, f64::NAN);
    let mut below = 0;
    for ties in samples.chunk_by(|a, b| a == b) {
        let [x, ..] = *ties else { continue };
        let x = x + 0.0; // −0 is 0
        require("a draw", x, !x.is_nan(), "a number")?;
        let up_to = below + ties.len();
        let below_x = if x == f64::NEG_INFINITY { 0.0 } else { probability(x.next_down())? };
        let left = (below as f64 / n - below_x).abs();
        let right = (up_to as f64 / n - probability(x)?).abs();
        let here = left.max(right);
        if here > worst.0 {
            worst = (here, x);
        }
        below = up_to;
    }
    Ok(worst)
}

/// kl(a‖b) of two Bernoulli distributions with probabilities a and b.
fn relative_entropy(a: f64, b: f64) -> f64 {
    let term = |a: f64, b: f64| if a == 0.0 { 0.0 } else { a * (a / b).ln() };
    term(a, b) + term(1.0 - a, 1.0 - b)
}

/// The result as a sentence.
impl fmt::Display for Agreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = if self.agrees { "as claimed" } else { "not as claimed" };
        let Self { strain, place, draws, alpha, unseen, .. } = self;
        write!(
            f,
            "distributed {verdict}: the largest difference, in {place}, is {strain:.2} of the one allowed \
             (α = {alpha:.0e}, {draws} draws); not seen: {unseen}"
        )
    }
}
