//! Mistakes in Russian roulette, and in counting its bounces.

use std::fmt;
use std::sync::LazyLock;

use super::Roulette;
use crate::check::{About, Exercise, Given, Mistake, Problem, Words};
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
}

// the sheet's 4/5 and 1/5, a generic value, and an extreme one
const CHANCES: [f64; 4] = [0.8, 0.2, 0.83, 0.99];

static WRAPPED: [Wrapped; 4] = wrapped();
static BOUNCES: [NumberOfBounces; 4] = bounces();

const fn wrapped() -> [Wrapped; 4] {
    let [a, b, c, d] = CHANCES;
    [Wrapped { p_rr: a }, Wrapped { p_rr: b }, Wrapped { p_rr: c }, Wrapped { p_rr: d }]
}

const fn bounces() -> [NumberOfBounces; 4] {
    let [a, b, c, d] = CHANCES;
    [
        NumberOfBounces { p_rr: a },
        NumberOfBounces { p_rr: b },
        NumberOfBounces { p_rr: c },
        NumberOfBounces { p_rr: d },
    ]
}

impl Problem for Wrapped {
    fn exercise() -> &'static Exercise {
        static EXERCISE: LazyLock<Exercise> = LazyLock::new(|| {
            let right = |p: &Wrapped, rng: &mut Stream| {
                let goes_on = rng.uniform() < p.p_rr;
                let x = p.x(rng);
                if goes_on { x / p.p_rr } else { 0.0 }
            };
            Exercise::new(ABOUT_WRAPPED, &[right], wrapper_mistakes())
        });
        &EXERCISE
    }

    fn all() -> &'static [Self] {
        &WRAPPED
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
            let right = |p: &NumberOfBounces, rng: &mut Stream| right_count(p.p_rr, 1.0 - rng.uniform());
            Exercise::new(ABOUT_BOUNCES, &[right], bounce_mistakes())
        });
        &EXERCISE
    }

    fn all() -> &'static [Self] {
        &BOUNCES
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

type Text = &'static str;

/// X times `lives` with this probability, else times `dies`; all are functions of p.
fn coin(
    [id, name, formula, mend]: [Text; 4],
    chance: fn(f64) -> f64,
    lives: fn(f64) -> f64,
    dies: fn(f64) -> f64,
) -> Mistake {
    Mistake::new(Words { id, question: "5", name, formula, mend }, move |p: &Wrapped, rng| {
        let weight = if rng.uniform() < chance(p.p_rr) { lives(p.p_rr) } else { dies(p.p_rr) };
        weight * p.x(rng)
    })
}

#[rustfmt::skip] // a list to be read
fn wrapper_mistakes() -> Vec<Mistake> {
    let compensate = "divide what goes on by the probability p_rr of going on";
    let once = "divide by p_rr once for each coin";
    let end = "an ended path is a draw of 0, and counts in n";
    let compare = "go on where U < p_rr";
    let real = "divide by the probability that the coin really had";
    let p = |p: f64| p;
    let zero = |_: f64| 0.0;
    vec![
        coin(["no-compensation", "no compensation", "X or 0", compensate], p, |_| 1.0, zero),
        coin(["over-end", "divided by 1 − p_rr", "X/(1 − p) or 0", compensate], p, |p| 1.0 / (1.0 - p), zero),
        coin(["times-p", "multiplied by p_rr", "X p or 0", compensate], p, |p| p, zero),
        coin(["times-end", "multiplied by 1 − p_rr", "X (1 − p) or 0", compensate], p, |p| 1.0 - p, zero),
        coin(["twice", "divided by p_rr twice", "X/p² or 0", once], p, |p| 1.0 / (p * p), zero),
        coin(["root", "divided by √p_rr", "X/√p or 0", compensate], p, |p| 1.0 / p.sqrt(), zero),
        coin(["flipped", "comparison flipped", "X/p if U > p, or 0", compare], |p| 1.0 - p, |p| 1.0 / p,
            zero),
        coin(["flipped-bare", "comparison flipped, no compensation", "X if U > p, or 0", compare],
            |p| 1.0 - p, |_| 1.0, zero),
        coin(["two-coins", "two coins, one compensation", "X/p if U < p and V < p, or 0",
            "flip one coin a bounce"], |p| p * p, |p| 1.0 / p, zero),
        coin(["ended-left-out", "ended paths left out of n", "X/p, the zeros dropped", end], |_| 1.0,
            |p| 1.0 / p, zero),
        coin(["ended-keep", "ended paths keep X", "X/p or X", end], p, |p| 1.0 / p, |_| 1.0),
        coin(["ended-rest", "ended paths get the rest", "X or X/(1 − p)", end], p, |_| 1.0,
            |p| 1.0 / (1.0 - p)),
        coin(["at-least-half", "the coin's chance at least ½, the weight still 1/p_rr",
            "X/p if U < max(p, ½), or 0", real], |p| p.max(0.5), |p| 1.0 / p, zero),
        coin(["at-most-95", "the coin's chance at most 0.95, the weight still 1/p_rr",
            "X/p if U < min(p, 0.95), or 0", real], |p| p.min(0.95), |p| 1.0 / p, zero),
        coin(["weight-95", "the weight at most 1/0.95", "X/min(p, 0.95) or 0", real], p,
            |p| 1.0 / p.min(0.95), zero),
        coin(["integer", "p_rr rounded to an integer", "4/5 = 0 in integers", "write 4.0/5.0"], zero, |_| 1.0,
            zero),
        Mistake::new(
            Words {
                id: "same-u",
                question: "5",
                name: "the coin reuses X's random number",
                formula: "U < p, X = X(U)",
                mend: "the coin needs a random number of its own",
            },
            |p: &Wrapped, rng| {
                let goes_on = rng.clone().uniform() < p.p_rr;
                let x = p.x(rng);
                if goes_on { x / p.p_rr } else { 0.0 }
            },
        ),
    ]
}

/// N = ⌊ln U/ln p⌋ for U in (0, 1].
fn right_count(p: f64, u: f64) -> f64 {
    (u.ln() / p.ln()).floor()
}

/// A number of bounces that is a function of p and one U in (0, 1].
fn count([id, name, formula, mend]: [Text; 4], n: fn(f64, f64) -> f64) -> Mistake {
    let words = Words { id, question: "5.1", name, formula, mend };
    Mistake::new(words, move |p: &NumberOfBounces, rng| n(p.p_rr, 1.0 - rng.uniform()))
}

#[rustfmt::skip] // a list to be read
fn bounce_mistakes() -> Vec<Mistake> {
    let failures = "N counts bounces, one less than coins: E[N] = 1/(1 − p) − 1";
    let ends = "p_rr is the chance of going on, 1 − p_rr that of ending";
    let down = "N ≥ k exactly where U ≤ pᵏ: round down";
    let cap = "roulette needs no cap: it ends by itself";
    let same = "the same logarithm above and below";
    vec![
        count(["coins", "coins counted instead of bounces", "N + 1", failures],
            |p, u| right_count(p, u) + 1.0),
        count(["exchanged", "p and 1 − p exchanged", "P(N = k) = (1 − p)ᵏ p", ends],
            |p, u| right_count(1.0 - p, u)),
        count(["exchanged-coins", "p and 1 − p exchanged, coins counted", "E = 1/p", "E[N] = p/(1 − p)"],
            |p, u| right_count(1.0 - p, u) + 1.0),
        count(["log10-above", "log base 10 above, ln below", "⌊log₁₀ U/ln p⌋", same],
            |p, u| (u.log10() / p.ln()).floor()),
        count(["nearest", "rounded to the nearest", "⌊ln U/ln p + ½⌋", down],
            |p, u| (u.ln() / p.ln() + 0.5).floor()),
        count(["not-rounded", "not rounded", "ln U/ln p", down], |p, u| u.ln() / p.ln()),
        count(["two-coins", "two coins a bounce", "P(N ≥ k) = p²ᵏ", "flip one coin a bounce"],
            |p, u| right_count(p * p, u)),
        count(["at-most-ten", "at most ten bounces", "min(N, 10)", cap], |p, u| right_count(p, u).min(10.0)),
        count(["at-most-hundred", "at most a hundred bounces", "min(N, 100)", cap],
            |p, u| right_count(p, u).min(100.0)),
        count(["at-most-95", "p_rr kept below 0.95", "min(p, 0.95)", "take p_rr as it is, up to 1"],
            |p, u| right_count(p.min(0.95), u)),
        count(["at-least-half", "p_rr kept above ½", "max(p, ½)", "take p_rr as it is, down to 0"],
            |p, u| right_count(p.max(0.5), u)),
        count(["one-coin", "one coin in all", "N = [U < p]", "flip again after every bounce"],
            |p, u| f64::from(u8::from(u < p))),
        count(["one-less", "one bounce too few", "max(N − 1, 0)", "the first coin that goes on is a bounce"],
            |p, u| (right_count(p, u) - 1.0).max(0.0)),
    ]
}
