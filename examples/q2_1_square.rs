//! Question 2.1: how do 2n uniform numbers on [−2, 2] estimate ∫∫ f dx dy over the square?
//!
//! As n independent pairs: ⟨Fₙ⟩ = 16/n Σ f(Xᵢ, Yᵢ), since p(x, y) = p(x) p(y) = 1/16. Used for six functions
//! whose integrals are known, then with the same number of evaluations at better placed points, then with the
//! classic mistakes.

use unbiased::rectangle::figures;
use unbiased::rectangle::{Integrand, Rectangle};
use unbiased::workbook::{self, Row, Sheet};
use unbiased::{Doubt, Result, f_over_p, from_fn};

/// The six functions, the better placed points, the mistakes.
pub fn answer(sheet: &Sheet) -> Result<()> {
    let [a, b, c, d] = ["x-low", "x-high", "y-low", "y-high"].map(|end| sheet.number(end));
    let (rectangle, n) = (Rectangle::new([a, b], [c, d])?, sheet.whole_number("n")?);
    let (width, height, area) = (b - a, d - c, rectangle.area());
    let f = Integrand::Gaussian;
    let bell = |x: f64, y: f64| f.at(x, y);
    let all_pairs = rectangle.all_pairs(bell, n)?;
    let jittered = rectangle.jittered(bell, n)?;
    let sobol = rectangle.sobol(bell, n * n)?;

    let seed = sheet.seed();
    sheet.row("how the error falls");
    sheet.figure(|| figures::sampling_errors(rectangle, seed))?;
    sheet.figure(|| figures::running_means(rectangle, seed))?;
    for f in Integrand::ALL {
        let estimator = from_fn(|rng| {
            let (x, y) = (a + width * rng.uniform(), c + height * rng.uniform());
            area * f.at(x, y)
        });
        let infinite = f.variance(&rectangle) == Some(f64::INFINITY);
        row(sheet, "", f, &rectangle)
            .doubt(infinite.then_some(Doubt::InfiniteVariance))
            .estimate(&estimator)?;
    }

    let general = f_over_p(|&[x, y]: &[f64; 2]| bell(x, y), rectangle);
    row(sheet, ", by the general formula", f, &rectangle).estimate(&general)?;
    row(sheet, ", all n² pairs", f, &rectangle).draws(2000).estimate(&all_pairs)?;
    row(sheet, ", a jittered n × n grid", f, &rectangle).draws(2000).estimate(&jittered)?;
    row(sheet, ", n² Sobol points", f, &rectangle).draws(2000).estimate(&sobol)?;

    for (what, weight, why) in [
        (", divided by all 2n values", area / 2.0, "the sum has n terms, not 2n"),
        (", one coordinate's density for the pair's", width, "p(x, y) = p(x) p(y)"),
        (", not divided by p", 1.0, "a mean of f alone, not of f/p"),
    ] {
        let weighted = rectangle.independent(move |x, y| weight / area * bell(x, y));
        row(sheet, what, f, &rectangle).wrong_on_purpose(why).estimate(&weighted)?;
    }
    for f in [Integrand::Product, Integrand::Constant] {
        let same_u = from_fn(|rng| {
            let u = rng.uniform();
            area * f.at(a + width * u, c + height * u)
        });
        row(sheet, ", X's random number used for Y, too", f, &rectangle)
            .wrong_on_purpose("all points lie on the diagonal; a constant cannot show it")
            .estimate(&same_u)?;
    }
    Ok(())
}

fn row<'s>(sheet: &'s Sheet, how: &str, f: Integrand, rectangle: &Rectangle) -> Row<'s> {
    sheet.row(format!("∫∫ {f} dx dy{how}")).truth(f.integral(rectangle))
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> std::process::ExitCode {
    workbook::main("2.1", answer)
}
