//! Mistakes in Russian roulette, and in counting its bounces.

use std::fmt;
use std::sync::LazyLock;

use super::Roulette;
use crate::check::{About, Exercise, Given, Listed, Problem};
use crate::stream::Stream;

/// The problem of playing roulette on X: a draw is one X_rr.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrapped {
    /// The continuation probability p_rr.
    pub p_rr: f64,
}

/// The problem of sampling the number of bounces under roulette: a draw is one N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NumberOfBounces {
    /// The continuation probability p_rr.
    pub p_rr: f64,
}

impl Wrapped {
    /// X = ½ + U, with a uniform number of its own. Its mean is 1, and it increases with U, so that a coin
    /// that reuses U is noticed.
    pub fn x(&self, rng: &mut Stream) -> f64 {
        0.5 + rng.uniform()
    }

    /// X/p_rr or 0.
    fn played(&self, rng: &mut Stream, goes_on: bool) -> f64 {
        let x = self.x(rng);
        if goes_on { x / self.p_rr } else { 0.0 }
    }

    /// X times `lives` with this probability, else times `dies`.
    fn coin(&self, rng: &mut Stream, chance: f64, lives: f64, dies: f64) -> f64 {
        let weight = if rng.uniform() < chance { lives } else { dies };
        weight * self.x(rng)
    }
}

/// N = ⌊ln U/ln p⌋ for U in (0, 1].
fn count(rng: &mut Stream, p: f64) -> f64 {
    ((1.0 - rng.uniform()).ln() / p.ln()).floor()
}

// the sheet's 4/5 and 1/5, a generic value, and an extreme one
const CHANCES: [f64; 4] = [0.8, 0.2, 0.83, 0.99];

static WRAPPED: LazyLock<[Wrapped; 4]> = LazyLock::new(|| CHANCES.map(|p_rr| Wrapped { p_rr }));
static BOUNCES: LazyLock<[NumberOfBounces; 4]> =
    LazyLock::new(|| CHANCES.map(|p_rr| NumberOfBounces { p_rr }));

impl Problem for Wrapped {
    fn exercise() -> &'static Exercise {
        static EXERCISE: LazyLock<Exercise> = LazyLock::new(|| {
            let right = |p: &Wrapped, rng: &mut Stream| {
                let goes_on = rng.uniform() < p.p_rr;
                p.played(rng, goes_on)
            };
            Exercise::new(ABOUT_WRAPPED, &[right], wrapper_mistakes())
        });
        &EXERCISE
    }

    fn all() -> &'static [Self] {
        &*WRAPPED
    }

    fn truth(&self) -> f64 {
        1.0
    }

    fn given(&self) -> Vec<(&'static str, Given)> {
        vec![("p_rr", Given::Number(self.p_rr))]
    }

    fn factors(&self) -> Vec<(&'static str, f64)> {
        vec![("p_rr", self.p_rr), ("1 − p_rr", 1.0 - self.p_rr)]
    }
}

impl Problem for NumberOfBounces {
    fn exercise() -> &'static Exercise {
        static EXERCISE: LazyLock<Exercise> = LazyLock::new(|| {
            let right = |p: &NumberOfBounces, rng: &mut Stream| count(rng, p.p_rr);
            Exercise::new(ABOUT_BOUNCES, &[right], bounce_mistakes())
        });
        &EXERCISE
    }

    fn all() -> &'static [Self] {
        &*BOUNCES
    }

    fn truth(&self) -> f64 {
        Roulette::new(self.p_rr).map_or(f64::NAN, |roulette| roulette.bounces().mean())
    }

    fn given(&self) -> Vec<(&'static str, Given)> {
        vec![("p_rr", Given::Number(self.p_rr))]
    }

    fn factors(&self) -> Vec<(&'static str, f64)> {
        vec![("p_rr", self.p_rr), ("1 − p_rr", 1.0 - self.p_rr)]
    }
}

impl fmt::Display for Wrapped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "X = ½ + U, p_rr = {}", self.p_rr)
    }
}

impl fmt::Display for NumberOfBounces {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "p_rr = {}", self.p_rr)
    }
}

const ABOUT_WRAPPED: About = About {
    id: "roulette",
    name: "Russian roulette",
    questions: &[("5", 0)],
    draw: "A draw is one X_rr: Russian roulette with this continuation probability p_rr, played on X = 1/2 + \
           U,\nU a uniform number of X's own. The mean of X is 1.",
};

const ABOUT_BOUNCES: About = About {
    id: "bounces",
    name: "number of bounces",
    questions: &[("5.1", 0), ("5.1(iii)", 0), ("5.2", 1)],
    draw: "A draw is one number of bounces N = 0, 1, 2, …: how often a path goes on before it ends, going on \
           with\nprobability p_rr each time.",
};

#[rustfmt::skip] // a list to be read
fn wrapper_mistakes() -> &'static [Listed<Wrapped>] { &[
    (["5", "no-compensation", "no compensation", "X or 0", COMPENSATE],
        |p, rng| p.coin(rng, p.p_rr, 1.0, 0.0)),
    (["5", "over-end", "divided by 1 − p_rr", "X/(1 − p) or 0", COMPENSATE],
        |p, rng| p.coin(rng, p.p_rr, 1.0 / (1.0 - p.p_rr), 0.0)),
    (["5", "times-p", "multiplied by p_rr", "X p or 0", COMPENSATE],
        |p, rng| p.coin(rng, p.p_rr, p.p_rr, 0.0)),
    (["5", "times-end", "multiplied by 1 − p_rr", "X (1 − p) or 0", COMPENSATE],
        |p, rng| p.coin(rng, p.p_rr, 1.0 - p.p_rr, 0.0)),
    (["5", "twice", "divided by p_rr twice", "X/p² or 0", "divide by p_rr once for each coin"],
        |p, rng| p.coin(rng, p.p_rr, 1.0 / (p.p_rr * p.p_rr), 0.0)),
    (["5", "root", "divided by √p_rr", "X/√p or 0", COMPENSATE],
        |p, rng| p.coin(rng, p.p_rr, 1.0 / p.p_rr.sqrt(), 0.0)),
    (["5", "flipped", "comparison flipped", "X/p if U > p, or 0", COMPARE],
        |p, rng| p.coin(rng, 1.0 - p.p_rr, 1.0 / p.p_rr, 0.0)),
    (["5", "flipped-bare", "comparison flipped, no compensation", "X if U > p, or 0", COMPARE],
        |p, rng| p.coin(rng, 1.0 - p.p_rr, 1.0, 0.0)),
    (["5", "two-coins", "two coins, one compensation", "X/p if U < p and V < p, or 0",
        "flip one coin a bounce"],
        |p, rng| p.coin(rng, p.p_rr * p.p_rr, 1.0 / p.p_rr, 0.0)),
    (["5", "ended-left-out", "ended paths left out of n", "X/p, the zeros dropped", END],
        |p, rng| p.coin(rng, 1.0, 1.0 / p.p_rr, 0.0)),
    (["5", "ended-keep", "ended paths keep X", "X/p or X", END],
        |p, rng| p.coin(rng, p.p_rr, 1.0 / p.p_rr, 1.0)),
    (["5", "ended-rest", "ended paths get the rest", "X or X/(1 − p)", END],
        |p, rng| p.coin(rng, p.p_rr, 1.0, 1.0 / (1.0 - p.p_rr))),
    (["5", "at-least-half", "the coin's chance at least ½, the weight still 1/p_rr",
        "X/p if U < max(p, ½), or 0", REAL], |p, rng| p.coin(rng, p.p_rr.max(0.5), 1.0 / p.p_rr, 0.0)),
    (["5", "at-most-95", "the coin's chance at most 0.95, the weight still 1/p_rr",
        "X/p if U < min(p, 0.95), or 0", REAL], |p, rng| p.coin(rng, p.p_rr.min(0.95), 1.0 / p.p_rr, 0.0)),
    (["5", "weight-95", "the weight at most 1/0.95", "X/min(p, 0.95) or 0", REAL],
        |p, rng| p.coin(rng, p.p_rr, 1.0 / p.p_rr.min(0.95), 0.0)),
    (["5", "integer", "p_rr rounded to an integer", "4/5 = 0 in integers", "write 4.0/5.0"],
        |p, rng| p.coin(rng, 0.0, 1.0, 0.0)),
    (["5", "same-u", "the coin reuses X's random number", "U < p, X = X(U)",
        "the coin needs a random number of its own"], |p, rng| {
            let goes_on = rng.clone().uniform() < p.p_rr;
            p.played(rng, goes_on)
        }),
] }

const COMPENSATE: &str = "divide what goes on by the probability p_rr of going on";
const END: &str = "an ended path is a draw of 0, and counts in n";
const COMPARE: &str = "go on where U < p_rr";
const REAL: &str = "divide by the probability that the coin really had";

#[rustfmt::skip] // a list to be read
fn bounce_mistakes() -> &'static [Listed<NumberOfBounces>] { &[
    (["5.1", "coins", "coins counted instead of bounces", "N + 1",
        "N counts bounces, one less than coins: E[N] = 1/(1 − p) − 1"], |p, rng| count(rng, p.p_rr) + 1.0),
    (["5.1", "exchanged", "p and 1 − p exchanged", "P(N = k) = (1 − p)ᵏ p",
        "p_rr is the chance of going on, 1 − p_rr that of ending"], |p, rng| count(rng, 1.0 - p.p_rr)),
    (["5.1", "exchanged-coins", "p and 1 − p exchanged, coins counted", "E = 1/p", "E[N] = p/(1 − p)"],
        |p, rng| count(rng, 1.0 - p.p_rr) + 1.0),
    (["5.1", "log10-above", "log base 10 above, ln below", "⌊log₁₀ U/ln p⌋",
        "the same logarithm above and below"],
        |p, rng| ((1.0 - rng.uniform()).log10() / p.p_rr.ln()).floor()),
    (["5.1", "nearest", "rounded to the nearest", "⌊ln U/ln p + ½⌋", DOWN],
        |p, rng| ((1.0 - rng.uniform()).ln() / p.p_rr.ln() + 0.5).floor()),
    (["5.1", "not-rounded", "not rounded", "ln U/ln p", DOWN],
        |p, rng| (1.0 - rng.uniform()).ln() / p.p_rr.ln()),
    (["5.1", "two-coins", "two coins a bounce", "P(N ≥ k) = p²ᵏ", "flip one coin a bounce"],
        |p, rng| count(rng, p.p_rr * p.p_rr)),
    (["5.1", "at-most-ten", "at most ten bounces", "min(N, 10)", CAP], |p, rng| count(rng, p.p_rr).min(10.0)),
    (["5.1", "at-most-hundred", "at most a hundred bounces", "min(N, 100)", CAP],
        |p, rng| count(rng, p.p_rr).min(100.0)),
    (["5.1", "at-most-95", "p_rr kept below 0.95", "min(p, 0.95)", "take p_rr as it is, up to 1"],
        |p, rng| count(rng, p.p_rr.min(0.95))),
    (["5.1", "at-least-half", "p_rr kept above ½", "max(p, ½)", "take p_rr as it is, down to 0"],
        |p, rng| count(rng, p.p_rr.max(0.5))),
    (["5.1", "one-coin", "one coin in all", "N = [U < p]", "flip again after every bounce"],
        |p, rng| f64::from(u8::from(1.0 - rng.uniform() < p.p_rr))),
    (["5.1", "one-less", "one bounce too few", "max(N − 1, 0)", "the first coin that goes on is a bounce"],
        |p, rng| (count(rng, p.p_rr) - 1.0).max(0.0)),
] }

const DOWN: &str = "N ≥ k exactly where U ≤ pᵏ: round down";
const CAP: &str = "roulette needs no cap: it ends by itself";
