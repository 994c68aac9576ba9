//! A worksheet of another course: one of the workbook's questions with other numbers, and two new ones.
//!
//! ```sh
//! cargo run --release --example own_worksheet -- --edition both --out my_sheet
//! ```
//!
//! A question consists of texts and numbers, `Question`, and a function that answers it. A part of a text
//! between « and » is a formula in the question's letters, and is replaced by its value. So `--B.1.length
//! 0.5` changes statement, closed form, wrong answers and estimate at once, and `--variant NAME` gives each
//! student their own numbers.

use std::f64::consts::{FRAC_1_PI, PI};
use std::process::ExitCode;

use unbiased::lambertian::hemisphere::Hemisphere;
use unbiased::question::{Letter, Number, Parameter, Question, Slip, Value};
use unbiased::workbook::{self, Sheet, Worksheet};
use unbiased::{Error, Result, f_over_p, from_uniforms};

#[path = "q5_2_few_bounces.rs"]
mod q5_2;

const LENGTH: Parameter = Parameter {
    name: "length",
    default: Value::Number(0.8),
    help: "the needle's length in units of the lines' distance, in (0, 1]",
    variants: &[0.3, 0.4, 0.6, 0.7, 0.75, 0.9],
    letter: Some(Letter {
        names: &["l"],
        value: |values| {
            let l = values.number("length");
            let outside = Error::Parameter { name: "the length l", value: l, allowed: "in (0, 1]" };
            if l > 0.0 && l <= 1.0 { Ok(l) } else { Err(outside) }
        },
        generic: 0.73,
    }),
};

static NEEDLE: Question = Question {
    id: "B.1",
    title: "Buffon's needle",
    statement: "A needle «l» times as long as the distance of the lines on a floor is thrown. With which \
                probability does it cross a line?",
    hint: "Where does its middle lie between two lines, and at which angle? Integrate over both.",
    formula: "P = 2l/π = «2l/π»",
    latex: &[r"P = \frac{2}{\pi}\int_0^{\pi/2} l \cos\varphi\,d\varphi = \frac{2l}{\pi} \approx «2l/π»"],
    answer: "The middle is uniform between two lines, the angle φ uniform. At φ the needle reaches l cos φ \
             across the lines, and crosses one with that probability.",
    numbers: &[Number {
        part: "",
        symbol: "P",
        what: "the probability P of crossing a line",
        formula: "2l/π",
        over_n: None,
        slips: &[
            Slip {
                id: "half",
                answer: "l/π",
                words: "the factor 2 forgotten, for the two halves of the needle",
                classic: true,
            },
            Slip { id: "no-angle", answer: "l", words: "the angle forgotten", classic: true },
        ],
    }],
    wrong: &[],
    on_the_original: None,
    example: "own_worksheet",
    lines: 5,
    parameters: &[LENGTH],
    derived: &[],
};

fn needle(sheet: &Sheet) -> Result<()> {
    let l = sheet.number("length");
    let crosses = from_uniforms(|[u, v]| if u < l * (0.5 * PI * v).cos() { 1.0 } else { 0.0 });
    sheet.row("share of crossings").truth(2.0 * l * FRAC_1_PI).estimate(&crosses)?;
    Ok(())
}

const ANGLE: Parameter = Parameter {
    name: "angle",
    default: Value::Number(30.0),
    help: "the angle α between the disc's centre and its rim, seen from below, in degrees, in (0, 90]",
    variants: &[15.0, 20.0, 25.0, 40.0, 50.0, 70.0],
    letter: Some(Letter {
        names: &["α", "alpha"],
        value: |values| {
            let angle = values.number("angle");
            let outside = Error::Parameter { name: "the angle α", value: angle, allowed: "in (0, 90]" };
            if angle > 0.0 && angle <= 90.0 { Ok(angle) } else { Err(outside) }
        },
        generic: 37.0,
    }),
};

/// sin² α as a letter, since formulas cannot contain a sine.
const SIN_SQUARED: Letter = Letter {
    names: &["s"],
    value: |values| Ok(values.number("angle").to_radians().sin().powi(2)),
    generic: 0.43,
};

static DISC: Question = Question {
    id: "B.2",
    title: "A disc light above",
    statement: "A round light of radiance 1 hangs above a table. From the point under its centre its rim is \
                seen at «α» degrees to the vertical. What is the irradiance E there?",
    hint: "Which part of the sky is lit, and how does cos θ weigh it?",
    formula: "E = π sin² α = «π s»",
    latex: &[r"E = \int_0^{2\pi}\!\!\int_0^{\alpha} \cos\theta \sin\theta\,d\theta\,d\varphi
          = \pi \sin^2\alpha \approx «π s»"],
    answer: "The light fills the cone θ < α. Cosine directions hit it with probability sin² α, and each hit \
             contributes π.",
    numbers: &[Number {
        part: "",
        symbol: "E",
        what: "the irradiance E",
        formula: "π s",
        over_n: None,
        slips: &[
            Slip { id: "no-pi", answer: "s", words: "the π of the hemisphere forgotten", classic: true },
            Slip {
                id: "solid-angle",
                answer: "2π (1 − √(1 − s))",
                words: "the solid angle: cos θ forgotten",
                classic: true,
            },
        ],
    }],
    wrong: &[],
    on_the_original: None,
    example: "own_worksheet",
    lines: 5,
    parameters: &[ANGLE],
    derived: &[SIN_SQUARED],
};

fn disc(sheet: &Sheet) -> Result<()> {
    let (sin, cos) = sheet.number("angle").to_radians().sin_cos();
    let row = |what| sheet.row(what).truth(PI * sin * sin);
    let lit = |cos_theta: f64| if cos_theta > cos { cos_theta } else { 0.0 };
    row("by cosine directions").estimate(&f_over_p(|w| lit(w.cos_theta()), Hemisphere::Cosine))?;
    row("by uniform directions").estimate(&f_over_p(|w| lit(w.cos_theta()), Hemisphere::Uniform))?;
    Ok(())
}

fn main() -> ExitCode {
    let Ok(bounces) = workbook::question("5.2") else { return ExitCode::FAILURE };
    Worksheet::new("Light and chance")
        .question(&NEEDLE, needle)
        .question(&DISC, disc)
        .question_at(bounces, q5_2::answer, &[("p-rr", "0.35"), ("albedo", "0.5")])
        .run()
}
