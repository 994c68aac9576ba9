//! The questions of section 2, unbiased estimators.

use crate::error::Result;
use crate::question::{Letter, Number, Parameter, Question, Value, Values, Wrong};
use crate::question::{classic, slip};
use crate::rectangle::Rectangle;

const fn end(
    name: &'static str,
    default: f64,
    help: &'static str,
    variants: &'static [f64],
    letter: Letter,
) -> Parameter {
    Parameter { name, default: Value::Number(default), help, variants, letter: Some(letter) }
}

const LOW_ENDS: &[f64] = &[-4.0, -3.0, -2.5, -1.5, -1.0, -0.5, 0.5, 1.0, 1.5];
const HIGH_ENDS: &[f64] = &[2.0, 2.5, 3.0, 3.5, 4.5, 5.0, 6.0, 7.0];

fn ends(values: &Values) -> Result<[[f64; 2]; 2]> {
    let [x, y] = [["x-low", "x-high"], ["y-low", "y-high"]].map(|ends| ends.map(|end| values.number(end)));
    Rectangle::new(x, y).map(|_| [x, y])
}

fn sides(values: &Values) -> Result<[f64; 2]> {
    ends(values).map(|ends| ends.map(|[low, high]| high - low))
}

const W: Letter =
    Letter { names: &["w"], value: |values| sides(values).map(|[width, _]| width), generic: 1.7 };
const H: Letter =
    Letter { names: &["h"], value: |values| sides(values).map(|[_, height]| height), generic: 4.1 };
const X_LOW: Letter =
    Letter { names: &["x_low"], value: |values| ends(values).map(|[[low, _], _]| low), generic: 0.3 };
const X_HIGH: Letter =
    Letter { names: &["x_high"], value: |values| ends(values).map(|[[_, high], _]| high), generic: 2.0 };
const Y_LOW: Letter =
    Letter { names: &["y_low"], value: |values| ends(values).map(|[_, [low, _]]| low), generic: -1.1 };
const Y_HIGH: Letter =
    Letter { names: &["y_high"], value: |values| ends(values).map(|[_, [_, high]]| high), generic: 3.0 };

pub(crate) const QUESTIONS: &[Question] = &[Question {
    id: "2.1",
    title: "A double integral from uniform random numbers",
    statement: "A source of random numbers hands out 2n of them, n uniform on [«x_low», «x_high»] and n on \
                [«y_low», «y_high»], each independent of all the others. How do you estimate the integral of \
                a function f(x, y) over the rectangle [«x_low», «x_high»] × [«y_low», «y_high»] from them, \
                without bias? And which condition must f satisfy?",
    hint: "Each draw is f over the density of the point drawn. What is the density of a pair of independent \
           numbers?",
    formula: "⟨Fₙ⟩ = 1/n Σ f(Xᵢ, Yᵢ)/p(Xᵢ, Yᵢ) = «w h»/n Σ f(Xᵢ, Yᵢ), if ∫∫ |f| is finite",
    latex: &[
        r"p(x, y) = p(x)\,p(y) = \frac{1}{«w»} \cdot \frac{1}{«h»} = \frac{1}{«w h»}",
        r"\langle F_n \rangle = \frac1n \sum_{i=1}^n \frac{f(X_i, Y_i)}{p(X_i, Y_i)}
          = \frac{«w h»}{n} \sum_{i=1}^n f(X_i, Y_i)",
        r"E\left[\frac{f(X, Y)}{p(X, Y)}\right] = \iint \frac{f(x, y)}{p(x, y)}\, p(x, y)\,dx\,dy = F",
        r"\mathrm{Var}\,\langle F_n \rangle = \frac1n \left(«w h» \iint f^2\,dx\,dy - F^2\right)",
    ],
    answer: "Take the numbers in pairs. The two of a pair are independent, so the density of the pair is the \
             product of theirs, 1/«w h» all over the rectangle, and each f(Xᵢ, Yᵢ)/p(Xᵢ, Yᵢ) has the mean F: \
             p cancels in the integral. The average of n of them therefore has the mean F for every n, as \
             long as E|f| is finite. An error bar needs more, a finite E f²: 1/√(x² + y²) about the origin \
             has a finite mean, but an infinite variance. All n² pairs also give an unbiased estimate, at n \
             times the cost. The variance may fall; for f = g(x) + h(y) it does not. Spreading the points \
             evenly does better: one in each cell of a grid, or a scrambled Sobol set.",
    numbers: &[Number {
        part: "",
        symbol: "c",
        what: "the factor c",
        formula: "w h",
        over_n: Some("c/n Σ f(Xᵢ, Yᵢ)"),
        slips: &[
            classic(
                "one-density",
                "w or h",
                "divided by p(x) or p(y) alone, 1 over a side: p(x, y) = p(x) p(y)",
            ),
            classic("two-n", "w h/2", "divided by the number of values, 2n, instead of the number of pairs"),
            classic("no-density", "1", "no division by p: the mean of f, not its integral"),
            slip("times-density", "1/(w h)", "multiplied by p instead of divided"),
            slip("times-one-density", "1/w or 1/h", "multiplied by p(x), instead of divided by p(x) p(y)"),
            slip("sum", "w + h", "the sum of the two sides instead of their product"),
            slip("perimeter", "2(w + h)", "the perimeter instead of the area"),
            slip("square", "w² or h²", "one side squared: the other is not as long"),
            slip("one-density-two-n", "w/2 or h/2", "divided by p(x) alone, and by 2n"),
            slip("density-twice", "(w h)²", "divided by p twice"),
            slip("n-for-two-n", "2w h", "n counted as the 2n values"),
        ],
    }],
    wrong: &[
        Wrong {
            answer: "c/n Σ f(Xᵢ, Xᵢ)",
            slip: "X used again for Y: the points lie on a diagonal. f = xy then gets the mean of x² in \
                   place of that of xy, while f = 1 and, on a square, f = x² + y² look right",
        },
        Wrong {
            answer: "it is only right for large n",
            slip: "unbiased and consistent confused: the mean of the estimator is F even for n = 1",
        },
    ],
    on_the_original: Some(
        "p(x, y) = p(x) p(y) needs a reason: X and Y are independent. And the original allows any f: an \
         unbiased estimate needs a finite E|f|, an error bar a finite E f².",
    ),
    example: "q2_1_square",
    lines: 5,
    parameters: &[
        end("x-low", -2.0, "where the rectangle begins in x", LOW_ENDS, X_LOW),
        end("x-high", 2.0, "where it ends in x, above --x-low", HIGH_ENDS, X_HIGH),
        end("y-low", -2.0, "where it begins in y", LOW_ENDS, Y_LOW),
        end("y-high", 2.0, "where it ends in y, above --y-low", HIGH_ENDS, Y_HIGH),
        Parameter {
            name: "n",
            default: Value::Number(32.0),
            help: "values of each of x and y; also the grid's side, and the root of the number of Sobol \
                   points: 1 to 256",
            variants: &[],
            letter: None,
        },
    ],
    derived: &[W, H],
}];
