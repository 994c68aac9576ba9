//! The questions of section 2, unbiased estimators.

use super::by_hand::{classic, slip};
use super::{Letter, Number, Options, Parameter, Question, Value, Wrong};
use crate::error::Result;
use crate::rectangle::Rectangle;

const fn end(name: &'static str, default: f64, help: &'static str) -> Parameter {
    Parameter { name, default: Value::Number(default), help }
}

fn sides(options: &Options) -> Result<[f64; 2]> {
    let [x, y] = [["x-low", "x-high"], ["y-low", "y-high"]].map(|ends| ends.map(|end| options.number(end)));
    Rectangle::new(x, y).map(|_| [x, y].map(|[low, high]| high - low))
}

const W: Letter =
    Letter { names: &["w"], value: |options| sides(options).map(|[width, _]| width), generic: 1.7 };
const H: Letter =
    Letter { names: &["h"], value: |options| sides(options).map(|[_, height]| height), generic: 4.1 };

pub(super) const QUESTIONS: &[Question] = &[Question {
    id: "2.1",
    title: "A double integral from uniform random numbers",
    statement: "A source of random numbers hands out 2n of them, each uniform on [−2, 2] and independent of all \
                the others. How do you estimate the integral of a function f(x, y) over the square [−2, 2] × \
                [−2, 2] from them, without bias? And what does that ask of f?",
    hint: "Each draw is f over the density of the point drawn. What is the density of a pair of independent numbers?",
    formula: "⟨Fₙ⟩ = 1/n Σ f(Xᵢ, Yᵢ)/p(Xᵢ, Yᵢ) = 16/n Σ f(Xᵢ, Yᵢ), if ∫∫ |f| is finite",
    latex: &[
        r"p(x, y) = p(x)\,p(y) = \frac14 \cdot \frac14 = \frac1{16}",
        r"\langle F_n \rangle = \frac1n \sum_{i=1}^n \frac{f(X_i, Y_i)}{p(X_i, Y_i)} = \frac{16}{n} \sum_{i=1}^n f(X_i, Y_i)",
        r"E\left[\frac{f(X, Y)}{p(X, Y)}\right] = \int_{-2}^{2} \int_{-2}^{2} \frac{f(x, y)}{p(x, y)}\, p(x, y)\,dx\,dy = F",
        r"\mathrm{Var}\,\langle F_n \rangle = \frac1n \left(16 \iint f^2\,dx\,dy - F^2\right)",
    ],
    answer: "Take the numbers in pairs. The two of a pair are independent, so the density of the pair is the \
             product of theirs, 1/16 all over the square, and each f(Xᵢ, Yᵢ)/p(Xᵢ, Yᵢ) has the mean F: p cancels \
             in the integral. The average of n of them therefore has the mean F for every n, as long as E|f| is \
             finite. An error bar takes more, a finite E f²: 1/√(x² + y²) has a mean, 14.102, and no variance. \
             The 2n numbers also make n² pairs that are not independent: unbiased as well, for n times the \
             evaluations, with a variance that is no less at all where f is a sum of a function of x and one of \
             y. Spreading the points evenly does better: one in each cell of a grid, or a scrambled Sobol set.",
    numbers: &[Number {
        part: "",
        symbol: "c",
        what: "the factor c",
        formula: "w h",
        over_n: Some("c/n Σ f(Xᵢ, Yᵢ)"),
        letters: &[W, H],
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
            slip: "X used again for Y: the points lie on the diagonal. On [−2, 2]² f = xy then gives \
                   64/3 instead of 0, while f = 1 and f = x² + y² look right",
        },
        Wrong {
            answer: "it is only right for large n",
            slip: "unbiased and consistent confused: the mean of the estimator is F even for n = 1",
        },
    ],
    on_the_original: Some(
        "p(x, y) = p(x) p(y) needs its reason: X and Y are independent. And the original takes any f: being \
         unbiased asks for a finite E|f|, an error bar for a finite E f².",
    ),
    example: "q2_1_square",
    module: "rectangle",
    parameters: &[
        end("x-low", -2.0, "where the rectangle begins in x"),
        end("x-high", 2.0, "where it ends in x, above --x-low"),
        end("y-low", -2.0, "where it begins in y"),
        end("y-high", 2.0, "where it ends in y, above --y-low"),
        end(
            "n",
            32.0,
            "values of each of x and y; also the grid's side, and the root of the number of Sobol points: 1 to 256",
        ),
    ],
}];
