//! Numbers worked out by hand, the wrong ones that people arrive at, and how.

use std::f64::consts::{E, LN_2, PI};
use std::fmt;

use crate::error::{Error, Result};

/// A question whose answer is a number (or a number times ρ), with the classic wrong answers.
#[derive(Debug, Clone, PartialEq)]
pub struct HandAnswer {
    /// The sheet's number.
    pub question: &'static str,
    /// What is asked for, and in which unit.
    pub what: &'static str,
    /// The right answer as a formula.
    pub formula: &'static str,
    /// Its value; ρ stands for 0.61.
    pub truth: f64,
    /// The wrong answers, each of a different value.
    pub slips: Vec<Slip>,
}

/// A wrong answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slip {
    /// Its value.
    pub value: f64,
    /// How it comes about.
    pub slip: &'static str,
}

/// What an answer worked out by hand looks like.
#[derive(Debug, Clone, PartialEq)]
pub enum Judgement {
    /// Right to the digits given.
    Right,
    /// Near, but with too few digits to tell.
    TooFewDigits,
    /// A known wrong answer, to the digits given; the nearest first.
    LooksLike(Vec<Slip>),
    /// Wrong, and none of the known ones.
    Unknown {
        /// The value given, divided by the truth.
        ratio: f64,
    },
}

/// ρ is a letter in answers; this value collides with no other answer.
const RHO: f64 = 0.61;

/// The classic answers, right and wrong, to a question ("1.2", "5.1(ii)"), if it asks for a number.
///
/// ```
/// use unbiased::check;
///
/// let answer = check::answers("5.1(ii)").unwrap();
/// assert_eq!(answer.truth, 16.0 / 125.0);
/// assert!(answer.slips.iter().any(|slip| slip.value == 16.0 / 25.0)); // the end of the path forgotten
/// ```
pub fn answers(question: &str) -> Option<HandAnswer> {
    all().into_iter().find(|answer| answer.question == question)
}

/// What the answer `text` to a question looks like: right to the digits given, or one of the known slips.
///
/// The text is a number, a fraction, or an expression of numbers, π, ρ, e, ln, √, + − * / ^ and brackets: `1.386`, `16/125`, `2 ln 2`, `2ρ/π`. What is written without
/// a decimal point counts as exact; decimals may be rounded, or cut off, at the last digit.
///
/// # Errors
/// If no number is known for the question, or the text is not understood.
///
/// ```
/// use unbiased::check::{self, Judgement};
///
/// assert_eq!(check::judge_answer("1.2", "1.386")?, Judgement::Right);
/// assert_eq!(check::judge_answer("1.2", "0.602")?.to_string(), "looks like: the logarithm to base 10");
/// assert_eq!(check::judge_answer("3.2", "ρ")?, Judgement::Right);
/// # Ok::<(), unbiased::Error>(())
/// ```
pub fn judge_answer(question: &str, text: &str) -> Result<Judgement> {
    let Some(HandAnswer { truth, slips, .. }) = answers(question) else {
        let known: Vec<_> = all().iter().map(|answer| answer.question).collect();
        let reason = format!("question {question} has no number to judge; these have: {}", known.join(", "));
        return Err(Error::Usage(reason));
    };
    let (value, step) = parse(text)?;
    let fits = |target: f64| {
        let off = (value - target).abs();
        let rounding = 1e-9 * target.abs().max(1e-300);
        let cut_off = value.abs() < target.abs() && value * target >= 0.0 && off < step;
        (off <= 0.5 * step + rounding || cut_off).then_some(off)
    };
    let mut near: Vec<(f64, Slip)> =
        slips.iter().filter_map(|slip| Some((fits(slip.value)?, *slip))).collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    let nearest = near.first().map_or(f64::INFINITY, |(off, _)| *off);
    let exact = 1e-9 * value.abs();
    // half a unit of the last digit: 5 % of the answer is no answer
    let too_coarse = step > 0.1 * truth.abs() && (value - truth).abs() > exact;
    Ok(match fits(truth) {
        Some(_) if too_coarse && nearest > exact => Judgement::TooFewDigits,
        Some(off) if off <= nearest => Judgement::Right,
        _ if !near.is_empty() => Judgement::LooksLike(near.into_iter().map(|(_, slip)| slip).collect()),
        _ => Judgement::Unknown { ratio: value / truth },
    })
}

/// The judgement in words.
impl fmt::Display for Judgement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Right => f.write_str("right to the digits given"),
            Self::TooFewDigits => f.write_str("too few digits to tell: give one or two more"),
            Self::LooksLike(slips) => {
                let slips: Vec<_> = slips.iter().map(|slip| slip.slip).collect();
                write!(f, "looks like: {}", slips.join("; or "))
            }
            Self::Unknown { ratio } if ratio.is_finite() => {
                write!(f, "not right, and none of the known slips: {ratio:.4} times the answer")
            }
            Self::Unknown { .. } => f.write_str("not right, and none of the known slips"),
        }
    }
}

fn all() -> Vec<HandAnswer> {
    let u = 0.75f64;
    let (p, q) = (0.8, 0.2);
    let new = |question, what, formula, truth, slips: &[(f64, &'static str)]| HandAnswer {
        question,
        what,
        formula,
        truth,
        slips: slips.iter().map(|&(value, slip)| Slip { value, slip }).collect(),
    };
    vec![
        new(
            "1.2",
            "the sample for U = 0.75 at λ = 1",
            "ln 4",
            2.0 * LN_2,
            &[
                (-u.ln(), "−ln U instead of −ln(1 − U)"),
                (-(1.0 - u).log10(), "the logarithm to base 10"),
                (-(1.0 - u).log2(), "the logarithm to base 2"),
                (-u.log10(), "the logarithm to base 10, and of U instead of 1 − U"),
                (-(-u).exp_m1(), "F read at x = 0.75 instead of inverted"),
                ((-u).exp(), "p read at x = 0.75 instead of F inverted"),
                ((1.0 - u).ln(), "the sign forgotten"),
                (u.ln(), "ln U: 1 − U is needed, and the sign"),
                (1.0 - u, "1 − U, the density at the sample, not the sample"),
                (u, "U itself"),
                ((1.0 + u).ln(), "ln(1 + U) instead of −ln(1 − U)"),
                (1.0 / (1.0 - u), "1/(1 − U): the logarithm forgotten"),
            ],
        ),
        new(
            "2.1",
            "the number c in ⟨Fₙ⟩ = c/n Σ f(Xᵢ, Yᵢ)",
            "16",
            16.0,
            &[
                (4.0, "divided by p(x) = 1/4 alone: p(x, y) = p(x) p(y)"),
                (1.0, "no division by p: the area forgotten"),
                (1.0 / 16.0, "multiplied by p instead of divided"),
                (1.0 / 4.0, "multiplied by p(x), instead of divided by p(x) p(y)"),
                (8.0, "the sum of two widths, or divided by the 2n values instead of the n pairs"),
                (2.0, "half of one width: divided by p(x) = 1/4 alone, and by 2n"),
                (256.0, "divided by p twice"),
                (32.0, "n counted as the 2n values"),
            ],
        ),
        new(
            "3.1",
            "the emitted radiance L_e",
            "0",
            0.0,
            &[
                (1.0, "wood does not glow: what it reflects is not emitted"),
                (RHO, "ρ says what is reflected, not what is emitted"),
            ],
        ),
        new(
            "3.2",
            "the reflected radiance L_r, as a multiple of L_i",
            "ρ",
            RHO,
            &[
                (2.0 * RHO, "sin θ or cos θ forgotten in the integral"),
                (PI * RHO, "the 1/π of the BRDF forgotten"),
                (RHO / PI, "the BRDF alone: the integral of cos θ over the hemisphere is π, not 1"),
                (2.0 * PI * RHO, "the 1/π of the BRDF forgotten, and cos θ or sin θ"),
                (0.5 * RHO, "φ over half a turn only, or ∫ sin θ cos θ dθ = ½ without its 2"),
                (2.0 * RHO / 3.0, "cos θ twice"),
                (PI * RHO / 2.0, "∫ cos² θ dθ: cos θ put for sin θ in the measure"),
                (1.0, "ρ forgotten"),
                (PI, "ρ/π forgotten"),
                (PI * PI * RHO, "neither sin θ nor cos θ, nor the BRDF's 1/π"),
                (0.0, "that is L_e, the emitted radiance"),
            ],
        ),
        new(
            "3.4",
            "the factor c in c/n Σ L_i cos θ",
            "2ρ",
            2.0 * RHO,
            &[
                (RHO, "the pdf taken for 1/π: over the hemisphere it is 1/(2π)"),
                (4.0 * RHO, "the pdf taken for 1/(4π), the whole sphere's"),
                (2.0 * PI * RHO, "the 1/π of the BRDF forgotten"),
                (2.0 * RHO / PI, "1/π twice"),
                (RHO / PI, "no division by the pdf"),
                (RHO / (2.0 * PI * PI), "multiplied by the pdf instead of divided"),
                (2.0, "ρ forgotten"),
                (2.0 * PI, "the BRDF forgotten"),
            ],
        ),
        new(
            "3.5",
            "the factor c in c/n Σ L_i",
            "ρ",
            RHO,
            &[
                (2.0 * RHO, "the uniform estimator's factor: here p = cos θ/π"),
                (PI * RHO, "the 1/π of the BRDF forgotten"),
                (RHO / PI, "the pdf's 1/π forgotten, or no division by the pdf"),
                (RHO / (PI * PI), "multiplied by the pdf instead of divided"),
                (1.0, "ρ forgotten"),
                (PI, "the BRDF forgotten"),
            ],
        ),
        new(
            "5.1(i)",
            "P(N = 0) for p_rr = 4/5",
            "1/5",
            q,
            &[
                (p, "the chance of going on, not of ending"),
                (p * q, "one bounce and then the end: that is N = 1"),
                (1.0, "p⁰ = 1: the factor 1 − p for the end is missing"),
                (0.0, "a path that ends at once has N = 0, which is possible"),
                (p * p, "two bounces"),
            ],
        ),
        new(
            "5.1(ii)",
            "P(N = 2) for p_rr = 4/5",
            "16/125",
            16.0 / 125.0,
            &[
                (16.0 / 25.0, "p²: the factor 1 − p for the end is missing"),
                (4.0 / 125.0, "p and 1 − p exchanged"),
                (4.0 / 25.0, "p(1 − p), that is N = 1: coins counted instead of bounces"),
                (64.0 / 625.0, "p³(1 − p), that is N = 3: one bounce too many"),
                (64.0 / 125.0, "p³: N is 2 or more but one, and the end is missing"),
                (48.0 / 125.0, "the binomial 3p²(1 − p): the end comes last, in one way only"),
                (1.0 / 25.0, "(1 − p)²: p and 1 − p exchanged, the end missing"),
                (61.0 / 125.0, "P(N ≤ 2), not P(N = 2)"),
                (32.0 / 125.0, "2p²(1 − p): the order is fixed, it counts once"),
            ],
        ),
        new(
            "5.1(iii)",
            "E[N] for p_rr = 4/5",
            "4",
            4.0,
            &[
                (5.0, "1/(1 − p) counts coins, N + 1: subtract 1"),
                (1.0 / 4.0, "p and 1 − p exchanged"),
                (5.0 / 4.0, "p and 1 − p exchanged, and no 1 subtracted"),
                (4.0 / 5.0, "p itself: the first bounce alone"),
                (1.0 / 5.0, "1 − p, the chance of ending"),
                (20.0, "the variance p/(1 − p)²"),
                (3.0, "1 subtracted twice"),
                (6.0, "1 added instead of subtracted"),
            ],
        ),
        new(
            "5.2",
            "E[N] for p_rr = 1/5",
            "1/4",
            0.25,
            &[
                (5.0 / 4.0, "1/(1 − p) counts coins, N + 1: subtract 1"),
                (4.0, "p and 1 − p exchanged"),
                (5.0, "p and 1 − p exchanged, and no 1 subtracted"),
                (1.0 / 5.0, "p itself: the first bounce alone"),
                (4.0 / 5.0, "1 − p, the chance of ending"),
                (5.0 / 16.0, "the variance p/(1 − p)²"),
                (-3.0 / 4.0, "1 subtracted twice"),
            ],
        ),
    ]
}

/// The value of an expression, and the unit of its last decimal; 0 where it is exact.
fn parse(text: &str) -> Result<(f64, f64)> {
    let clean = text.trim().trim_end_matches('.').replace('−', "-").replace(['·', '×'], "*");
    let not_understood = || Error::Usage(format!("the answer “{text}” is not a number or an expression"));
    // a plain decimal, with a comma perhaps
    let decimal = if clean.contains('.') { clean.clone() } else { clean.replace(',', ".") };
    let (mantissa, exponent) = decimal.split_once(['e', 'E']).unwrap_or((&decimal, "0"));
    let digits = mantissa.trim_start_matches(['+', '-']);
    if digits.chars().all(|c| c.is_ascii_digit() || c == '.')
        && let (Ok(value), Ok(exponent)) = (decimal.parse::<f64>(), exponent.parse::<i32>())
    {
        let places = digits.split_once('.').map(|(_, places)| places.len() as f64);
        let step = places.map_or(0.0, |places| 10f64.powf(f64::from(exponent) - places));
        return finite(value).map(|value| (value, step)).ok_or_else(not_understood);
    }
    let spelled = clean
        .replace("sqrt", "√")
        .replace("rho", "ρ")
        .replace("pi", "π")
        .replace("ln", "ℓ")
        .replace("**", "^");
    let chars: Vec<char> = spelled.chars().filter(|c| !c.is_whitespace()).collect();
    let mut rest = Expression { chars: &chars, depth: 0 };
    let value = rest.sum().filter(|_| rest.chars.is_empty()).and_then(finite).ok_or_else(not_understood)?;
    Ok((value, 0.0))
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// What is left of an expression to be read: sums of products of powers.
struct Expression<'c> {
    chars: &'c [char],
    depth: u32,
}

impl Expression<'_> {
    fn take(&mut self, wanted: char) -> bool {
        match self.chars {
            [first, rest @ ..] if *first == wanted => {
                self.chars = rest;
                true
            }
            _ => false,
        }
    }

    fn sum(&mut self) -> Option<f64> {
        let mut sum = self.product()?;
        loop {
            if self.take('+') {
                sum += self.product()?;
            } else if self.take('-') {
                sum -= self.product()?;
            } else {
                return Some(sum);
            }
        }
    }

    fn product(&mut self) -> Option<f64> {
        let mut product = self.power()?;
        loop {
            if self.take('*') {
                product *= self.power()?;
            } else if self.take('/') {
                product /= self.power()?;
            } else if matches!(self.chars, [c, ..] if c.is_ascii_digit() || "(πρeℓ√".contains(*c)) {
                product *= self.power()?; // 2ρ, 2 ln 2
            } else {
                return Some(product);
            }
        }
    }

    fn power(&mut self) -> Option<f64> {
        let base = self.atom()?;
        Some(match self.chars {
            ['^', rest @ ..] => {
                self.chars = rest;
                base.powf(self.atom()?)
            }
            ['²', rest @ ..] => {
                self.chars = rest;
                base * base
            }
            _ => base,
        })
    }

    fn atom(&mut self) -> Option<f64> {
        // an answer is short; what nests deeper is none
        self.depth += 1;
        if self.depth > 100 {
            return None;
        }
        let [first, rest @ ..] = self.chars else { return None };
        let all = self.chars;
        self.chars = rest;
        match first {
            '-' => Some(-self.power()?),
            '(' => {
                let inside = self.sum()?;
                self.take(')').then_some(inside)
            }
            'π' => Some(PI),
            'ρ' => Some(RHO),
            'e' => Some(E),
            'ℓ' => Some(self.power()?.ln()),
            '√' => Some(self.power()?.sqrt()),
            _ => {
                let length = all.iter().take_while(|c| c.is_ascii_digit() || **c == '.').count();
                let (number, rest) = all.split_at_checked(length)?;
                self.chars = rest;
                number.iter().collect::<String>().parse().ok()
            }
        }
    }
}
