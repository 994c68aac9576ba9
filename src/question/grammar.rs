//! The grammar of answers: numbers, the question's letters, and operations.
//!
//! A number is known only to its last digit, and so is everything computed from it: "2*0.693" is 1.386 ±
//! 0.001.

use std::f64::consts::{E, LN_2, LN_10, PI};

/// A number between `value - below` and `value + above`; both are 0 if it is exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Known {
    pub value: f64,
    pub below: f64,
    pub above: f64,
}

impl Known {
    fn exactly(value: f64) -> Self {
        Self { value, below: 0.0, above: 0.0 }
    }

    /// A function of this number, from its value and slope here.
    pub fn through(self, value: f64, slope: f64) -> Self {
        let (below, above) = if slope < 0.0 { (self.above, self.below) } else { (self.below, self.above) };
        // an exact number stays exact, however steep the function
        let reach = |reach: f64| if reach == 0.0 { 0.0 } else { reach * slope.abs() };
        Self { value, below: reach(below), above: reach(above) }
    }

    /// A function of two numbers, from its value and slopes here.
    fn of_two(value: f64, (a, slope_a): (Self, f64), (b, slope_b): (Self, f64)) -> Self {
        let (a, b) = (a.through(value, slope_a), b.through(value, slope_b));
        Self { value, below: a.below + b.below, above: a.above + b.above }
    }

    fn power(self, exponent: Self) -> Self {
        let (a, b) = (self.value, exponent.value);
        let value = a.powf(b);
        Self::of_two(value, (self, b * a.powf(b - 1.0)), (exponent, value * a.ln()))
    }
}

/// A token of an answer.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Token {
    /// A number. Unlike a letter, it must not follow a factor without a multiplication sign.
    Number(Known),
    Constant(f64),
    /// Which of the question's letters.
    Letter(usize),
    /// A function, and its slope.
    Function(fn(f64) -> f64, fn(f64) -> f64),
    /// A superscript.
    Power(i32),
    /// One of + - * / ^ ( ) %
    Sign(char),
}

const LN: Token = Token::Function(f64::ln, |x| 1.0 / x);
const LOG10: Token = Token::Function(f64::log10, |x| 1.0 / (x * LN_10));
const LOG2: Token = Token::Function(f64::log2, |x| 1.0 / (x * LN_2));
const EXP: Token = Token::Function(f64::exp, f64::exp);
const SQRT: Token = Token::Function(f64::sqrt, |x| 0.5 / x.sqrt());

/// Words of more than one letter may also be written in capitals.
const WORDS: [(&str, Token); 16] = [
    ("ln", LN),
    ("log", LN),
    ("log10", LOG10),
    ("log_10", LOG10),
    ("log₁₀", LOG10),
    ("lg", LOG10),
    ("log2", LOG2),
    ("log_2", LOG2),
    ("log₂", LOG2),
    ("exp", EXP),
    ("sqrt", SQRT),
    ("√", SQRT),
    ("pi", Token::Constant(PI)),
    ("π", Token::Constant(PI)),
    ("e", Token::Constant(E)),
    ("𝑒", Token::Constant(E)),
];

/// The longest answer in characters, which also limits the nesting of brackets.
const LONGEST: usize = 200;

/// Splits an answer into tokens, without what stands before its last "=" or "≈". `None` if something in it is
/// no token.
///
/// `letters` are the question's letters, each with all its spellings. A decimal may be rounded at its last
/// digit, with an error of half a unit, or cut off there, with an error of up to one; numbers listed in
/// `exact` are exact.
pub(crate) fn read(text: &str, letters: &[&[&str]], exact: &[f64]) -> Option<Vec<Token>> {
    let answer = text.rsplit(['=', '≈', '~']).next()?;
    let answer = answer.trim_end_matches(|c: char| c.is_whitespace() || ".,;".contains(c));
    let chars: Vec<char> = answer.chars().take(LONGEST + 1).collect();
    if chars.len() > LONGEST {
        return None;
    }
    let mut tokens = Vec::new();
    let mut rest = &chars[..];
    while let [first, after @ ..] = rest {
        let (token, left) = match first {
            c if c.is_whitespace() => {
                rest = after;
                continue;
            }
            '0'..='9' | '.' | ',' => number(rest, exact)?,
            '*' if after.first() == Some(&'*') => (Token::Sign('^'), after.get(1..)?),
            '+' | '*' | '/' | '^' | '(' | ')' | '%' => (Token::Sign(*first), after),
            '-' | '−' | '–' => (Token::Sign('-'), after),
            '·' | '×' | '⋅' | '∙' => (Token::Sign('*'), after),
            '÷' | '⁄' | '∕' => (Token::Sign('/'), after),
            '[' | '{' => (Token::Sign('('), after),
            ']' | '}' => (Token::Sign(')'), after),
            '¼' => (Token::Number(Known::exactly(0.25)), after),
            '½' => (Token::Number(Known::exactly(0.5)), after),
            '¾' => (Token::Number(Known::exactly(0.75)), after),
            _ => superscript(rest).or_else(|| word(rest, letters))?,
        };
        tokens.push(token);
        rest = left;
    }
    Some(tokens)
}

/// Digits with a point or comma among them, and an exponent.
fn number<'c>(chars: &'c [char], exact: &[f64]) -> Option<(Token, &'c [char])> {
    let digits = |from: usize| chars.iter().skip(from).take_while(|c| c.is_ascii_digit()).count();
    let (whole, mut end, mut places) = (digits(0), digits(0), 0);
    if matches!(chars.get(whole), Some('.' | ',')) {
        places = digits(whole + 1);
        end += 1 + places;
    }
    if matches!(chars.get(end), Some('e' | 'E')) {
        let sign = usize::from(matches!(chars.get(end + 1), Some('+' | '-' | '−')));
        let length = digits(end + 1 + sign);
        // an e without digits after it is Euler's number
        if length > 0 {
            end += 1 + sign + length;
        }
    }
    let (number, rest) = chars.split_at_checked(end)?;
    let text: String = number.iter().collect::<String>().replace(',', ".").replace('−', "-");
    let value: f64 = text.parse().ok()?;
    let known_exactly = places == 0 || exact.contains(&value);
    let exponent = text.split_once(['e', 'E']).map_or(Some(0.0), |(_, exponent)| exponent.parse().ok())?;
    let unit = if known_exactly { 0.0 } else { 10f64.powf(exponent - places as f64) };
    Some((Token::Number(Known { value, below: 0.5 * unit, above: unit }), rest))
}

/// ², ⁻¹
fn superscript(chars: &[char]) -> Option<(Token, &[char])> {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let (sign, digits) = match chars {
        ['⁻', digits @ ..] => (-1, digits),
        digits => (1, digits),
    };
    let value = |c: &char| DIGITS.iter().position(|digit| digit == c);
    let length = digits.iter().take_while(|c| value(c).is_some()).count();
    let (power, rest) = digits.split_at_checked(length).filter(|_| (1..=3).contains(&length))?;
    let power = power.iter().filter_map(value).fold(0, |power, digit| 10 * power + digit as i32);
    Some((Token::Power(sign * power), rest))
}

/// The longest word or letter that comes next.
fn word<'c>(chars: &'c [char], letters: &[&[&str]]) -> Option<(Token, &'c [char])> {
    let spelt = letters.iter().enumerate().flat_map(|(index, spellings)| {
        spellings.iter().map(move |spelling| (*spelling, Token::Letter(index)))
    });
    let fitting = WORDS.into_iter().chain(spelt).filter_map(|(word, token)| {
        let length = word.chars().count();
        let (next, rest) = chars.split_at_checked(length)?;
        let same = |(a, b): (char, &char)| a == *b || length > 1 && a.eq_ignore_ascii_case(b);
        // log100 is the logarithm of 100, not log10 of 0
        let number_follows = rest.first().is_some_and(|c| c.is_ascii_digit() || ".,".contains(*c));
        let cut = word.ends_with(|c: char| c.is_ascii_digit()) && number_follows;
        (word.chars().zip(next).all(same) && !cut).then_some((length, token, rest))
    });
    fitting.max_by_key(|(length, ..)| *length).map(|(_, token, rest)| (token, rest))
}

/// The value of an answer for these values of the letters, finite or not; `None` if it cannot be understood.
pub(crate) fn evaluate(tokens: &[Token], letters: &[f64]) -> Option<Known> {
    let mut rest = Expression { tokens, letters };
    rest.sum().filter(|_| rest.tokens.is_empty())
}

/// The tokens still to be read: a sum of products of powers.
struct Expression<'t> {
    tokens: &'t [Token],
    letters: &'t [f64],
}

impl Expression<'_> {
    fn take(&mut self, wanted: char) -> bool {
        match self.tokens {
            [Token::Sign(sign), rest @ ..] if *sign == wanted => {
                self.tokens = rest;
                true
            }
            _ => false,
        }
    }

    fn sum(&mut self) -> Option<Known> {
        let mut sum = self.product()?;
        loop {
            let sign = if self.take('+') {
                1.0
            } else if self.take('-') {
                -1.0
            } else {
                return Some(sum);
            };
            let term = self.product()?;
            // without this, 1/10 + 2/10 − 3/10 would not be 0
            let rounding = f64::EPSILON * (sum.value.abs() + term.value.abs());
            sum = Known::of_two(sum.value + sign * term.value, (sum, 1.0), (term, sign));
            (sum.below, sum.above) = (sum.below + rounding, sum.above + rounding);
        }
    }

    fn product(&mut self) -> Option<Known> {
        let mut product = self.power()?;
        loop {
            let divided = self.take('/');
            let without_a_sign = matches!(
                self.tokens,
                [Token::Constant(_) | Token::Letter(_) | Token::Function(..) | Token::Sign('('), ..]
            );
            if !(divided || self.take('*') || without_a_sign) {
                return Some(product);
            }
            let mut factor = self.power()?;
            if divided {
                factor = factor.through(1.0 / factor.value, -1.0 / (factor.value * factor.value));
            }
            let value = product.value * factor.value;
            product = Known::of_two(value, (product, factor.value), (factor, product.value));
        }
    }

    fn power(&mut self) -> Option<Known> {
        let mut base = self.atom()?;
        loop {
            if let [Token::Power(power), rest @ ..] = self.tokens {
                self.tokens = rest;
                base = base.power(Known::exactly(f64::from(*power)));
            } else if self.take('%') {
                base = base.through(base.value / 100.0, 0.01);
            } else if self.take('^') {
                // right-associative: the exponent's own powers come first
                base = base.power(self.power()?);
            } else {
                return Some(base);
            }
        }
    }

    fn atom(&mut self) -> Option<Known> {
        let [first, rest @ ..] = self.tokens else { return None };
        self.tokens = rest;
        match first {
            Token::Number(number) => Some(*number),
            Token::Constant(value) => Some(Known::exactly(*value)),
            Token::Letter(index) => self.letters.get(*index).copied().map(Known::exactly),
            Token::Function(function, slope) => {
                // ln(4)² is the square of ln 4, ln 4² the logarithm of 16
                let bracket = matches!(self.tokens, [Token::Sign('('), ..]);
                let argument = if bracket { self.atom() } else { self.power() }?;
                Some(argument.through(function(argument.value), slope(argument.value)))
            }
            Token::Sign('-') => self.power().map(|x| x.through(-x.value, -1.0)),
            Token::Sign('+') => self.power(),
            Token::Sign('(') => {
                let inside = self.sum()?;
                self.take(')').then_some(inside)
            }
            Token::Sign(_) | Token::Power(_) => None,
        }
    }
}
