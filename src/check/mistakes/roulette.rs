//! Mistakes in Russian roulette.

use super::{Attempt, Mistake, Probe, Setup, Words, words};
use crate::stream::Stream;

/// The X that roulette is played on: its mean is 1, and it rises with its own random number, so that a coin that reuses that number shows.
pub(super) fn x(rng: &mut Stream) -> f64 {
    0.5 + rng.uniform()
}

const CHANCES: [f64; 3] = [0.2, 0.8, 0.83];

pub(super) fn wrapper_probes() -> Vec<Probe> {
    CHANCES.into_iter().filter_map(|p| Probe::roulette(p).ok()).collect()
}

pub(super) fn bounce_probes() -> Vec<Probe> {
    CHANCES.into_iter().filter_map(|p| Probe::bounces(p).ok()).collect()
}

/// X times `lives` with this probability, times `dies` else, both functions of p.
fn coin(words: Words, chance: fn(f64) -> f64, lives: fn(f64) -> f64, dies: fn(f64) -> f64) -> Mistake {
    let wrong = Attempt::roulette(move |x, p, rng| {
        let weight = if rng.uniform() < chance(p) { lives(p) } else { dies(p) };
        if weight == 0.0 { 0.0 } else { weight * x(rng) }
    });
    Mistake::new(words, 2, wrong, move |setup| match *setup {
        Setup::Roulette { p_rr: p } => chance(p) * lives(p) + (1.0 - chance(p)) * dies(p),
        _ => f64::NAN,
    })
}

pub(super) fn wrapper_mistakes() -> Vec<Mistake> {
    let compensate = "divide what goes on by the probability p_rr of going on";
    let once = "divide by p_rr once, where the coin falls";
    let end = "an ended path is a draw of 0, and counts in n";
    let compare = "go on where U < p_rr";
    let p = |p: f64| p;
    let zero = |_: f64| 0.0;
    vec![
        coin(words("5", "no compensation", "X or 0", compensate), p, |_| 1.0, zero),
        coin(words("5", "divided by 1 − p_rr", "X/(1 − p) or 0", compensate), p, |p| 1.0 / (1.0 - p), zero),
        coin(words("5", "multiplied by p_rr", "X p or 0", compensate), p, |p| p, zero),
        coin(words("5", "multiplied by 1 − p_rr", "X (1 − p) or 0", compensate), p, |p| 1.0 - p, zero),
        coin(words("5", "divided by p_rr twice", "X/p² or 0", once), p, |p| 1.0 / (p * p), zero),
        coin(words("5", "divided by √p_rr", "X/√p or 0", compensate), p, |p| 1.0 / p.sqrt(), zero),
        coin(words("5", "comparison flipped", "X/p if U > p, or 0", compare), |p| 1.0 - p, |p| 1.0 / p, zero),
        coin(
            words("5", "comparison flipped, no compensation", "X if U > p, or 0", compare),
            |p| 1.0 - p,
            |_| 1.0,
            zero,
        ),
        coin(
            words(
                "5",
                "two coins, one compensation",
                "X/p if U < p and V < p, or 0",
                "flip one coin a bounce",
            ),
            |p| p * p,
            |p| 1.0 / p,
            zero,
        ),
        coin(
            words("5", "ended paths left out of n", "X/p, the zeros dropped", end),
            |_| 1.0,
            |p| 1.0 / p,
            zero,
        ),
        coin(words("5", "ended paths keep X", "X/p or X", end), p, |p| 1.0 / p, |_| 1.0),
        coin(words("5", "ended paths get the rest", "X or X/(1 − p)", end), p, |_| 1.0, |p| 1.0 / (1.0 - p)),
        coin(
            words(
                "5",
                "the coin's chance at least ½, the weight still 1/p_rr",
                "X/p if U < max(p, ½), or 0",
                "divide by the chance that the coin really had",
            ),
            |p| p.max(0.5),
            |p| 1.0 / p,
            zero,
        ),
        coin(
            words("5", "p_rr rounded to an integer", "4/5 = 0 in integers", "write 4.0/5.0"),
            zero,
            |_| 1.0,
            zero,
        ),
        Mistake::new(
            words(
                "5",
                "the coin reuses X's random number",
                "U < p, X = X(U)",
                "the coin needs a random number of its own",
            ),
            1,
            Attempt::roulette(|x, p, rng| {
                let goes_on = rng.clone().uniform() < p;
                let x = x(rng);
                if goes_on { x / p } else { 0.0 }
            }),
            |setup| match *setup {
                // E[½ + U; U < p]/p
                Setup::Roulette { p_rr: p } => 0.5 + 0.5 * p,
                _ => f64::NAN,
            },
        ),
    ]
}

/// Bounces whose number is drawn from one U, `mean` being the mean.
fn count(words: Words, draw: fn(f64, f64) -> f64, mean: fn(f64) -> f64) -> Mistake {
    let wrong = Attempt::bounces(move |p, rng| draw(p, 1.0 - rng.uniform()));
    // so many steps are nothing for quadrature
    Mistake::new(words, 0, wrong, move |setup| match *setup {
        Setup::Bounces { p_rr } => mean(p_rr),
        _ => f64::NAN,
    })
}

/// N = ⌊ln U/ln p⌋ for U in (0, 1].
fn right_count(p: f64, u: f64) -> f64 {
    (u.ln() / p.ln()).floor()
}

pub(super) fn bounce_mistakes() -> Vec<Mistake> {
    use std::f64::consts::LN_10;
    let failures = "N counts bounces, one less than coins: E[N] = 1/(1 − p) − 1";
    let ends = "p_rr is the chance of going on, 1 − p_rr that of ending";
    let down = "N ≥ k exactly where U ≤ pᵏ: round down";
    /// E[N] of a coin that goes on with this probability
    fn mean(p: f64) -> f64 {
        p / (1.0 - p)
    }
    vec![
        count(
            words("5.1", "coins counted instead of bounces", "N + 1", failures),
            |p, u| right_count(p, u) + 1.0,
            |p| 1.0 / (1.0 - p),
        ),
        count(
            words("5.1", "p and 1 − p exchanged", "P(N = k) = (1 − p)ᵏ p", ends),
            |p, u| right_count(1.0 - p, u),
            |p| mean(1.0 - p),
        ),
        count(
            words("5.1", "p and 1 − p exchanged, coins counted", "E = 1/p", "E[N] = p/(1 − p)"),
            |p, u| right_count(1.0 - p, u) + 1.0,
            |p| 1.0 / p,
        ),
        count(
            words(
                "5.1",
                "log base 10 above, ln below",
                "⌊log₁₀ U/ln p⌋",
                "the same logarithm above and below",
            ),
            |p, u| (u.log10() / p.ln()).floor(),
            |p| mean(p.powf(LN_10)),
        ),
        count(
            words("5.1", "rounded to the nearest", "⌊ln U/ln p + ½⌋", down),
            |p, u| (u.ln() / p.ln() + 0.5).floor(),
            |p| p.sqrt() / (1.0 - p),
        ),
        count(words("5.1", "not rounded", "ln U/ln p", down), |p, u| u.ln() / p.ln(), |p| -1.0 / p.ln()),
        count(
            words("5.1", "two coins a bounce", "P(N ≥ k) = p²ᵏ", "flip one coin a bounce"),
            |p, u| right_count(p * p, u),
            |p| mean(p * p),
        ),
        count(
            words("5.1", "at most ten bounces", "min(N, 10)", "roulette needs no cap: it ends by itself"),
            |p, u| right_count(p, u).min(10.0),
            |p| mean(p) * (1.0 - p.powi(10)),
        ),
        count(
            words("5.1", "one coin in all", "N = [U < p]", "flip again after every bounce"),
            |p, u| f64::from(u8::from(u < p)),
            |p| p,
        ),
        count(
            words("5.1", "one bounce too few", "max(N − 1, 0)", "the first coin that goes on is a bounce"),
            |p, u| (right_count(p, u) - 1.0).max(0.0),
            |p| p * mean(p),
        ),
    ]
}
