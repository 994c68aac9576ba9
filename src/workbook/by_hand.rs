//! Numbers worked out by hand: the answers that questions ask for, and known wrong answers with the slip
//! behind each.
//!
//! Every answer, right or wrong, is stored as the formula that people read. Its value is computed from that
//! formula, at the question's parameters.

use std::fmt;

use super::grammar::{self, Known, Token};
use super::{Options, Question, questions};
use crate::error::{Error, Result};
use crate::numbers::{rounded, shortened};

/// A number that a question asks for.
#[derive(Debug, Clone, Copy)]
pub struct Number {
    /// The part of the question that asks for it, "(ii)"; empty if the question asks for one number only.
    pub part: &'static str,
    /// Its symbol.
    pub symbol: &'static str,
    /// A description in words.
    pub what: &'static str,
    /// The right answer for all parameters: a formula in the letters, or several with " or " between them.
    pub formula: &'static str,
    /// If it is the factor c of an estimator c/n Σ …, that estimator; then c/n is accepted, too.
    pub over_n: Option<&'static str>,
    /// The wrong answers.
    pub slips: &'static [Slip],
}

/// A wrong answer that is a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Slip {
    /// Its name for programs, unique among the wrong answers to the question.
    pub id: &'static str,
    /// The wrong answer for all parameters: a formula, or several with " or " between them.
    pub answer: &'static str,
    /// The slip that leads to it.
    pub words: &'static str,
    /// Whether it is also listed with the solution.
    pub classic: bool,
}

/// A wrong answer that is only used to judge answers.
pub(crate) const fn slip(id: &'static str, answer: &'static str, words: &'static str) -> Slip {
    Slip { id, answer, words, classic: false }
}

/// A wrong answer that is also listed with the solution.
pub(crate) const fn classic(id: &'static str, answer: &'static str, words: &'static str) -> Slip {
    Slip { id, answer, words, classic: true }
}

/// The judgement of an answer worked out by hand.
#[derive(Debug, Clone, PartialEq)]
pub enum Judgement {
    /// Right to the digits given.
    Right,
    /// Close, but with too few digits.
    TooFewDigits {
        /// How many significant digits are enough.
        needed: u32,
    },
    /// A known wrong answer, to the digits given; if several fit, the nearest first.
    LooksLike(Vec<Slip>),
    /// Wrong, and no known wrong answer.
    Unknown {
        /// The answer divided by the right one, if that is a number.
        ratio: Option<f64>,
    },
}

/// Judges the answer `text` to a question ("1.2", "5.1(ii)") at the sheet's parameters: right to the digits
/// given, one of the known slips, or neither.
///
/// The text is a number, a fraction, or an expression: `1.386`, `16/125`, `12.8 %`, `2 ln 2`, `x = -log(1 -
/// 0.75)`, `2ρ/n`. Numbers without a decimal point are exact; decimals may be rounded or cut off at the last
/// digit. Letters are compared as letters: `ρ` is right if the answer is ρ, whatever its value.
///
/// ```
/// use unbiased::workbook::{Judgement, judge_answer};
///
/// assert_eq!(judge_answer("1.2", "1.386")?, Judgement::Right);
/// assert_eq!(judge_answer("1.2", "0.602")?.to_string(), "looks like: the logarithm to base 10");
/// assert_eq!(judge_answer("3.2", "ρ")?, Judgement::Right);
/// # Ok::<(), unbiased::Error>(())
/// ```
///
/// # Errors
/// If the question asks for no number, or for several and the part is missing, or the text is not understood.
pub fn judge_answer(question: &str, text: &str) -> Result<Judgement> {
    judged(question, text, &Options::default(), None).map(|(judgement, _)| judgement)
}

/// The same at the parameters in `options`, with the ratio to the right answer, if there is one. With
/// `digits`, at least that many significant digits are required, unless the answer is exact.
///
/// It is an error, too, if a parameter is outside its domain or the right answer is infinite.
pub(super) fn judged(
    question: &str,
    text: &str,
    options: &Options,
    digits: Option<u32>,
) -> Result<(Judgement, Option<f64>)> {
    let (question, number) = asked(question)?;
    let answer = Answered::new(question, number, text, &options.for_question(question))?;
    let (given, letters) = answer.with_letters(1.0)?;
    let truths = question.with_letters(number.formula, &letters)?;
    if !truths.iter().all(|truth| truth.is_finite()) {
        let id = question.id;
        return Err(Error::Usage(format!(
            "the answer to {id}{} is infinite at these parameters",
            number.part
        )));
    }
    // an answer with letters has a ratio only if that is the same for all values of the letters
    let (elsewhere, others) = answer.with_letters(0.9)?;
    let there = question.with_letters(number.formula, &others)?;
    // if there are several right answers, the nearest one
    let ratios = truths.iter().zip(&there).map(|(here, there)| [given.value / here, elsewhere.value / there]);
    let off = |ratio: f64| (ratio - 1.0).abs();
    let [here, there] = ratios.min_by(|a, b| off(a[0]).total_cmp(&off(b[0]))).unwrap_or([f64::INFINITY; 2]);
    let ratio = Some(here).filter(|here| here.is_finite() && same(*here, there));

    let mut near = Vec::new();
    for slip in number.slips {
        let mut wrong = question.with_letters(slip.answer, &letters)?;
        wrong.retain(|value| truths.iter().all(|truth| !same(*value, *truth)));
        if let Some(off) = nearest(&given, &wrong) {
            near.push((off, *slip));
        }
    }
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    let nearest_slip = near.first().map_or(f64::INFINITY, |(off, _)| *off);
    let near_right = nearest(&given, &truths);
    let exact = truths.iter().any(|truth| same(given.value, *truth));
    let coarse = |off: f64| !exact && too_coarse(&given, off, &truths, digits);
    let judgement = match near_right {
        Some(off) if coarse(off) && nearest_slip > SAME * given.value.abs() => {
            Judgement::TooFewDigits { needed: digits.unwrap_or(2).max(1) }
        }
        Some(off) if exact || off <= nearest_slip => Judgement::Right,
        _ if near.is_empty() => Judgement::Unknown { ratio },
        _ => Judgement::LooksLike(near.into_iter().map(|(_, slip)| slip).collect()),
    };
    Ok((judgement, ratio))
}

/// Numbers closer than this, relatively, are equal up to rounding.
const SAME: f64 = 1e-9;

fn same(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= SAME * a.abs().max(b.abs())
}

/// The distance from the nearest of these values to the numbers that `given` may stand for.
fn nearest(given: &Known, values: &[f64]) -> Option<f64> {
    let off = values.iter().filter_map(|value| {
        let off = value - given.value;
        let cut_off = off < given.above;
        (same(*value, given.value) || cut_off && off >= -given.below - SAME * value.abs())
            .then_some(off.abs())
    });
    off.min_by(f64::total_cmp)
}

/// Whether a number that is `off` from the right one has too few digits to count as right: off by more than
/// half a unit of the digits asked for, or by more than 5 %.
fn too_coarse(given: &Known, off: f64, truths: &[f64], digits: Option<u32>) -> bool {
    let truth = truths.iter().fold(0.0, |largest: f64, truth| largest.max(truth.abs()));
    let last_digit = |digits: u32| 10f64.powf(truth.log10().floor() + 1.0 - f64::from(digits.max(1)));
    // a value this close to 0 is 0 up to rounding
    let unit = digits.map_or(0.1 * truth, last_digit).max(1e-12) * (1.0 + SAME);
    given.below.max(given.above) > unit || digits.is_some() && off > 0.5 * unit
}

/// The number that a question, or a part of one, asks for.
pub(super) fn asked(question: &str) -> Result<(&'static Question, &'static Number)> {
    let wanted: String = question.split_whitespace().collect();
    let named = |question: &Question, number: &Number| format!("{}{}", question.id, number.part);
    let all =
        || questions().flat_map(|question| question.numbers.iter().map(move |number| (question, number)));
    if let Some(found) = all().find(|(question, number)| named(question, number) == wanted) {
        return Ok(found);
    }
    let id = wanted.split('(').next().unwrap_or_default();
    let parts: Vec<_> = all().filter(|(question, _)| question.id == id).map(|(q, n)| named(q, n)).collect();
    Err(Error::Usage(if parts.is_empty() {
        let all: Vec<_> = all().map(|(question, number)| named(question, number)).collect();
        format!("question {wanted} has no number to judge; these have: {}", all.join(", "))
    } else {
        format!("question {id} asks for {}: say which, not {wanted}", parts.join(", "))
    }))
}

impl Number {
    /// A description of what is asked for: "the factor c in c/n Σ L_i".
    pub(super) fn asked(&self) -> String {
        self.over_n.map_or(self.what.into(), |sum| format!("{} in {sum}", self.what))
    }
}

impl Question {
    /// The values of a formula in its letters, or of several with " or " between them, at the parameters in
    /// `options`.
    ///
    /// # Errors
    /// If a parameter is outside its domain, or the formula cannot be read.
    pub fn evaluate(&'static self, formula: &str, options: &Options) -> Result<Vec<f64>> {
        let options = options.for_question(self);
        self.with_letters(formula, &self.values(&options)?)
    }

    fn with_letters(&self, formula: &str, letters: &[f64]) -> Result<Vec<f64>> {
        formula.split(" or ").map(|formula| self.value(formula, letters)).collect()
    }
}

/// A parsed answer.
struct Answered<'a> {
    question: &'static Question,
    number: &'static Number,
    text: &'a str,
    tokens: Vec<Token>,
    /// The letters' values at the question's parameters.
    letters: Vec<f64>,
}

impl<'a> Answered<'a> {
    fn new(
        question: &'static Question,
        number: &'static Number,
        text: &'a str,
        options: &Options,
    ) -> Result<Self> {
        let letters = question.values(options)?;
        let parameters = question.parameters.iter().map(|parameter| options.number(parameter.name).abs());
        let exact: Vec<f64> = parameters.chain(letters.iter().copied()).collect();
        let mut spellings: Vec<_> = question.letters().map(|letter| letter.names).collect();
        spellings.extend(number.over_n.map(|_| N));
        let tokens = grammar::read(text, &spellings, &exact);
        let answer = Self { question, number, text, tokens: tokens.unwrap_or_default(), letters };
        // an answer without tokens is no number, either
        answer.with_letters(1.0).map(|_| answer)
    }

    /// The value of the answer and the letters' values. Letters that occur in the answer get generic numbers
    /// times `scale`, the others the parameters.
    fn with_letters(&self, scale: f64) -> Result<(Known, Vec<f64>)> {
        let holds = |index: usize| {
            self.tokens.iter().any(|token| matches!(token, Token::Letter(letter) if *letter == index))
        };
        let own = self.question.letters().zip(&self.letters).enumerate();
        let letters: Vec<f64> = own
            .map(|(index, (letter, value))| if holds(index) { scale * letter.generic } else { *value })
            .collect();
        let at = |n: f64| grammar::evaluate(&self.tokens, &[&letters[..], &[n]].concat());
        let n = scale * 7.3;
        let given = at(n).ok_or_else(|| self.not_understood())?;
        if !given.value.is_finite() || !(given.below + given.above).is_finite() {
            return Err(self.refused("is not a finite number"));
        }
        let Some(sum) = self.number.over_n.filter(|_| holds(letters.len())) else {
            return Ok((given, letters));
        };
        // c/n stands for c
        let (c, elsewhere) = (n * given.value, at(2.0 * n).map(|given| 2.0 * n * given.value));
        if !elsewhere.is_some_and(|elsewhere| same(c, elsewhere)) {
            return Err(self.refused(&format!("is not a number over n: give the c of {sum}, or c/n")));
        }
        Ok((given.through(c, n), letters))
    }

    fn not_understood(&self) -> Error {
        let letters = self.question.letters().filter_map(|letter| letter.names.first().copied());
        let letters: Vec<_> = letters.chain(self.number.over_n.map(|_| "n")).collect();
        let letters = match &letters[..] {
            [] => String::new(),
            [one] => format!(", and the question's letter {one}"),
            [all @ .., last] => format!(", and the question's letters {} and {last}", all.join(", ")),
        };
        self.refused(&format!(
            "is not understood. Allowed are numbers, fractions, + − × / ^, brackets, ln, log10, exp, √, π, \
             e{letters}"
        ))
    }

    fn refused(&self, why: &str) -> Error {
        const MOST: usize = 40;
        let plain = |c: char| if c.is_control() { ' ' } else { c };
        let mut text: String = self.text.chars().take(MOST).map(plain).collect();
        if self.text.chars().nth(MOST).is_some() {
            text.push('…');
        }
        Error::Usage(format!("the answer \"{text}\" {why}"))
    }
}

const N: &[&str] = &["n"];

impl Judgement {
    /// The known wrong answers that it looks like.
    pub(super) fn slips(&self) -> &[Slip] {
        if let Self::LooksLike(slips) = self { slips } else { &[] }
    }
}

/// The judgement in words.
impl fmt::Display for Judgement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Right => f.write_str("right to the digits given"),
            Self::TooFewDigits { needed: 1 } => f.write_str("too few digits: give one, rounded"),
            Self::TooFewDigits { needed } => write!(f, "too few digits: give {needed}, rounded"),
            Self::LooksLike(slips) => {
                let slips: Vec<_> = slips.iter().map(|slip| slip.words).collect();
                write!(f, "looks like: {}", slips.join("; or "))
            }
            Self::Unknown { ratio: Some(ratio) } => {
                write!(f, "not right, and none of the known slips: {ratio:.4} times the answer")
            }
            Self::Unknown { ratio: None } => f.write_str("not right, and none of the known slips"),
        }
    }
}

impl Question {
    /// Its classic wrong answers, each with its slip. Those that are numbers have their values at the
    /// question's parameters, and are left out if they are right there.
    pub(super) fn classic_wrong_answers(
        &'static self,
        options: &Options,
    ) -> Result<Vec<(String, &'static str)>> {
        let mut all = Vec::new();
        for number in self.numbers {
            let truths = self.evaluate(number.formula, options)?;
            for slip in number.slips.iter().filter(|slip| slip.classic) {
                let mut values = self.evaluate(slip.answer, options)?;
                if !values.iter().any(|value| truths.iter().any(|truth| same(*value, *truth))) {
                    values.dedup_by(|a, b| same(*a, *b));
                    all.push((number.equation(slip.answer, &values), slip.words));
                }
            }
        }
        all.extend(self.wrong.iter().map(|wrong| (wrong.answer.into(), wrong.slip)));
        Ok(all)
    }
}

impl Number {
    /// `E[N] = 1/(1 − p_rr) = 5`
    fn equation(&self, formula: &str, values: &[f64]) -> String {
        let values = values
            .iter()
            .filter(|value| value.is_finite())
            .map(|value| shortened(rounded(*value, 4).parse().unwrap_or(*value)).replace('-', "−"));
        let values = values.collect::<Vec<_>>().join(" or ");
        let value =
            if values.is_empty() || values == formula { String::new() } else { format!(" = {values}") };
        let place = self.over_n.map_or(String::new(), |sum| format!(" in {sum}"));
        format!("{} = {formula}{value}{place}", self.symbol)
    }
}
