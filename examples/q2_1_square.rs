//! Question 2.1: how do 2n uniform numbers on [−2, 2] estimate ∫∫ f dx dy over the square?
//!
//! In n independent pairs: ⟨Fₙ⟩ = 16/n Σ f(Xᵢ, Yᵢ), since p(x, y) = p(x) p(y) = 1/16. Below for six functions
//! whose integrals are known, then with the same evaluations better placed, then with the classic mistakes.

use std::process::ExitCode;

use unbiased::rectangle::{Integrand, Rectangle};
use unbiased::workbook::{self, Answer, Options};
use unbiased::{Estimator, Result, f_over_p, figure, from_fn};

/// The answers, as the options ask.
pub fn answer(options: &Options) -> Result<Vec<Answer>> {
    let [[a, b], [c, d]] =
        [["x-low", "x-high"], ["y-low", "y-high"]].map(|ends| ends.map(|end| options.number(end)));
    let (rectangle, n) = (Rectangle::new([a, b], [c, d])?, options.whole_number("n")?);
    let (width, height, area) = (b - a, d - c, rectangle.area());

    let row = |what: &str, f: Integrand, estimator: &dyn Estimator, draws| -> Result<Answer> {
        let answer = Answer::new("2.1", &format!("∫∫ {f} dx dy{what}"))
            .parameter("x-low", a)
            .parameter("x-high", b)
            .parameter("y-low", c)
            .parameter("y-high", d)
            .outcome(&options.run(estimator, draws)?);
        Ok(match f.integral(&rectangle) {
            Some(truth) => answer.truth(truth),
            None => answer,
        })
    };

    let mut answers = vec![
        Answer::new("2.1", "how the error falls")
            .figure(figure::sampling_errors(rectangle, options.seed)?)
            .figure(figure::running_means(rectangle, options.seed)?),
    ];
    for f in Integrand::ALL {
        let estimator = from_fn(|rng| {
            let (x, y) = (a + width * rng.uniform(), c + height * rng.uniform());
            area * f.at(x, y)
        });
        let answer = row("", f, &estimator, 1_000_000)?;
        answers.push(if f.variance(&rectangle) == Some(f64::INFINITY) {
            answer
                .demonstration()
                .note("The mean is finite, the variance is not: this error bar means nothing.")
        } else {
            answer
        });
    }

    let f = Integrand::Gaussian;
    let bell = |x: f64, y: f64| f.at(x, y);
    let general = f_over_p(|&[x, y]: &[f64; 2]| bell(x, y), rectangle);
    answers.extend([
        row(", by the general formula", f, &general, 1_000_000)?,
        row(", all n² pairs", f, &rectangle.all_pairs(bell, n)?, 2000)?.parameter("n", n as f64),
        row(", a jittered n × n grid", f, &rectangle.jittered(bell, n)?, 2000)?.parameter("n", n as f64),
        row(", n² Sobol points", f, &rectangle.sobol(bell, n * n)?, 2000)?.parameter("n", n as f64),
    ]);

    let weighted = |weight: f64| rectangle.independent(move |x, y| weight / area * bell(x, y));
    let same_u = |f: Integrand| {
        from_fn(move |rng| {
            let u = rng.uniform();
            area * f.at(a + width * u, c + height * u)
        })
    };
    for (what, f, estimator) in [
        (", divided by all 2n values", f, &weighted(area / 2.0) as &dyn Estimator),
        (", one coordinate's density for the pair's", f, &weighted(width)),
        (", not divided by p", f, &weighted(1.0)),
        (", X's random number used for Y, too", Integrand::Product, &same_u(Integrand::Product)),
        (", X's random number used for Y, too", Integrand::Constant, &same_u(Integrand::Constant)),
    ] {
        answers.push(row(what, f, estimator, 1_000_000)?.demonstration());
    }
    Ok(answers)
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::main("2.1", answer)
}
