//! The questions of section 1, the inversion method.

use crate::inversion::Exponential;
use crate::question::{Letter, Number, Parameter, Question, Slip, Value, Wrong};
use crate::question::{classic, slip};

const RATE: Parameter = Parameter {
    name: "rate",
    default: Value::Number(1.0),
    help: "the rate λ > 0",
    variants: &[0.2, 0.25, 0.3, 0.4, 0.6, 0.75, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0],
    letter: Some(Letter {
        names: &["λ", "lambda"],
        value: |values| Exponential::new(values.number("rate")).map(|exponential| exponential.rate()),
        generic: 0.37,
    }),
};
const U: Letter = Letter {
    names: &["u", "U"],
    value: |values| {
        let u = values.number("u");
        Exponential::new(values.number("rate"))?.inverse_cdf(u).map(|_| u)
    },
    generic: 0.7313,
};
const LOG10: Slip = classic("log10", "−log₁₀(1 − u)/λ", "the logarithm to base 10");
const LOG2: Slip = slip("log2", "−log₂(1 − u)/λ", "the logarithm to base 2");
const SIGN: Slip = slip("sign", "ln(1 − u)/λ", "the sign forgotten");
const TIMES_RATE: Slip = slip("times-rate", "−λ ln(1 − u)", "multiplied by λ instead of divided");
const CDF_READ: Slip = classic("cdf-read", "1 − e^(−λu)", "F read at x = u instead of inverted");
const PDF_READ: Slip = classic("pdf-read", "λ e^(−λu)", "p read at x = u instead of F inverted");
const U_ITSELF: Slip = slip("u", "u", "U itself");

pub(crate) const QUESTIONS: &[Question] = &[
    Question {
        id: "1.1",
        title: "Sampling the exponential distribution",
        statement: "U is uniform on [0, 1). Which function of U is a sample of the exponential distribution \
                    with rate λ, whose density is p(x) = λ e^(−λx) for x ≥ 0? And how is any other \
                    one-dimensional distribution sampled, given its cdf F?",
        hint: "Integrate the density to get F(x), set F(x) equal to u, and solve for x. What happens at u = \
               1?",
        formula: "x = F⁻¹(u) = −ln(1 − u)/λ;  E[X] = 1/λ, Var X = 1/λ²",
        latex: &[
            r"F(x) = \int_0^x \lambda e^{-\lambda t}\,dt = 1 - e^{-\lambda x}",
            r"x = F^{-1}(u) = -\frac{\ln(1-u)}{\lambda}",
            r"F^-(u) = \inf\{x : F(x) \ge u\}",
        ],
        answer: "Set F(x) = u and solve for x. A uniform number lands between F(x) and F(x + dx) with \
                 probability p(x) dx, which is what sampling p means. Where F has no inverse in closed form, \
                 or has jumps and flats, F⁻(u) = inf{x : F(x) ≥ u} takes its place and is found by \
                 bisection. Whether λ divides or multiplies shows only where λ is not 1.",
        numbers: &[Number {
            part: "",
            symbol: "x(0.75)",
            what: "a sample for the uniform number u; for a number take u = 0.75",
            formula: "−ln(1 − u)/λ or −ln u/λ",
            over_n: None,
            slips: &[
                Slip { classic: true, ..TIMES_RATE },
                Slip { classic: true, ..SIGN },
                LOG10,
                PDF_READ,
                CDF_READ,
                LOG2,
                U_ITSELF,
                slip("times-rate-of-u", "−λ ln u", "multiplied by λ instead of divided"),
                slip("sign-of-u", "ln u/λ", "the sign forgotten"),
                slip("log10-of-u", "−log₁₀(u)/λ", "the logarithm to base 10"),
            ],
        }],
        wrong: &[],
        on_the_original: Some(
            "The original takes U from [0, 1], where U = 1 would give an infinite sample: U lies in [0, 1). \
             It also writes F⁻¹(x); the argument of an inverse cdf is a probability, u.",
        ),
        example: "q1_1_exponential",
        lines: 5,
        parameters: &[RATE],
        derived: &[Letter { value: |_| Ok(0.75), ..U }],
    },
    Question {
        id: "1.2",
        title: "One sample, read off the graph",
        statement: "For λ = «λ» the graphs show the CDF, the inverse CDF and the PDF. If U = «u», which \
                    value is sampled? Mark the point on the CDF.",
        hint: "F is drawn with x along the bottom. On which axis does a probability such as «u» stand?",
        formula: "x = −ln(1 − u)/λ = «−ln(1 − u)/λ», where p(x) = λ(1 − u) = «λ(1 − u)»",
        latex: &[
            r"x = -\frac{\ln(1 - u)}{\lambda} = -\frac{\ln(1 - «u»)}{«λ»} \approx «−ln(1 − u)/λ»",
            r"p(x) = \lambda e^{-\lambda x} = \lambda (1 - u) = «λ(1 − u)»",
        ],
        answer: "Start at «u» on the vertical axis of the CDF, go across to the curve and down to x. The \
                 same point lies on the inverse CDF, above u = «u».",
        numbers: &[Number {
            part: "",
            symbol: "x",
            what: "the sample for the uniform number u",
            formula: "−ln(1 − u)/λ",
            over_n: None,
            slips: &[
                classic(
                    "ln-u",
                    "−ln u/λ",
                    "−ln U instead of −ln(1 − U): a sample too, but not the point on this CDF",
                ),
                LOG10,
                CDF_READ,
                PDF_READ,
                U_ITSELF,
                SIGN,
                TIMES_RATE,
                LOG2,
                slip("log10-of-u", "−log₁₀(u)/λ", "the logarithm to base 10, and of U instead of 1 − U"),
                slip("sign-of-u", "ln u/λ", "ln U: 1 − U is needed, and the sign"),
                slip("pdf", "λ(1 − u)", "the density at the sample, not the sample"),
                slip("one-plus-u", "ln(1 + u)/λ", "ln(1 + U) instead of −ln(1 − U)"),
                slip("no-log", "1/(λ(1 − u))", "1/(1 − U): the logarithm forgotten"),
            ],
        }],
        wrong: &[],
        on_the_original: Some(
            "F and p take x, F⁻¹ takes u: the inverse is drawn against an axis of its own here.",
        ),
        example: "q1_2_one_sample",
        lines: 2,
        parameters: &[
            RATE,
            Parameter {
                name: "u",
                default: Value::Number(0.75),
                help: "the uniform number u in [0, 1]",
                variants: &[0.1, 0.15, 0.2, 0.3, 0.35, 0.4, 0.6, 0.65, 0.7, 0.8, 0.85, 0.9, 0.95],
                letter: Some(U),
            },
        ],
        derived: &[],
    },
    Question {
        id: "1.3",
        title: "The axes of a CDF",
        statement: "What does the x-axis of the CDF's (blue) curve stand for?",
        hint: "F takes something and gives a probability. What does it take?",
        formula: "x: a value that can be sampled; F(x): the probability of a sample at most x",
        latex: &[r"F(x) = P(X \le x)"],
        answer: "The values that can be sampled, here all x ≥ 0. The height of the curve is the probability \
                 that a sample is at most x.",
        numbers: &[],
        wrong: &[
            Wrong {
                answer: "a probability",
                slip: "that is the vertical axis, or the horizontal one of F⁻¹",
            },
            Wrong { answer: "the random number U", slip: "U is on the vertical axis of F" },
        ],
        on_the_original: Some(
            "The same letter x stands for a value in F(x) and for a probability in F⁻¹(x) there; here that \
             is u.",
        ),
        example: "q1_3_axes",
        lines: 2,
        parameters: &[RATE],
        derived: &[],
    },
];
