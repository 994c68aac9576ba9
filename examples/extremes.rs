//! Where the obvious code breaks: textbook formulas, inputs at which they fail, and the crate's results
//! there.
//!
//! The truths are computed by another program, with more digits than `f64` has. Errors are in units of the
//! last place (ulps) of the truth.

use std::process::ExitCode;

use glam::DVec3;
use unbiased::inversion::Exponential;
use unbiased::lambertian::hemisphere::Hemisphere;
use unbiased::paths::room::form_factor;
use unbiased::roulette::{LightModel, Roulette};
use unbiased::workbook::{self, Answer, Appendix, Contents, Options, Table, extremes};
use unbiased::{Estimate, Result};

/// One formula at one input: its question, how it is written, and the input; what it gives, the truth, and
/// what the crate gives.
type Extreme = ([&'static str; 3], [f64; 3]);

/// The appendix that shows them.
pub const APPENDIX: Appendix = Appendix {
    example: "extremes",
    title: "Where the obvious code breaks",
    about: "Where the obvious code breaks: textbook formulas, inputs at which they fail in floating point, \
            and what the crate gives there.",
    seconds: None,
    why: "it evaluates each formula once, and has no student edition and no hint",
    make,
};

fn make(options: &Options) -> Result<Contents> {
    let extremes = extremes()?;
    let mut rows = Vec::new();
    let mut records = Vec::new();
    for ([question, obvious, input], [gives, truth, here]) in extremes {
        let cells =
            [obvious.into(), input.into(), show(gives), ulps(gives, truth), show(here), ulps(here, truth)];
        rows.push(cells.to_vec());
        let what = format!("{obvious} at {input}");
        records.push(
            Answer::new(question, &format!("{what}, as written")).demonstration().truth(truth).value(gives),
        );
        records.push(Answer::new(question, &format!("{what}, in the crate")).truth(truth).value(here));
    }
    Ok(Contents {
        text: "Each formula is right on paper and fails in floating point somewhere: a difference of nearly \
               equal numbers keeps none of their digits, a square overflows, a sum loses small terms. An \
               error is counted in ulps, units of the last place of the truth, which was computed with \
               another program."
            .into(),
        tables: vec![Table::new(
            "The obvious code, what it gives, and what the crate gives",
            ["as written", "at", "gives", "off by (ulps)", "the crate", "off by (ulps)"],
            rows,
        )],
        records,
        figures: vec![extremes::errors_in_ulps()?, extremes::running_mean_errors(options.seed)?],
    })
}

fn extremes() -> Result<Vec<Extreme>> {
    let exponential = Exponential::new(1.0)?;
    let slow = Exponential::new(0.37)?;
    let nearly_one: f64 = 1.0 - 1e-12;
    let cosine: f64 = (1.0 - 1e-20f64).sqrt();
    let p: f64 = 0.999_999;
    let rare: f64 = 0.999_999_999_9;
    // 1000 draws in quarters above a billion, whose variance is 1000/999 · 5/64
    let draws: Vec<f64> = (0..1000).map(|i| 1e9 + f64::from(i % 4) / 4.0).collect();
    let count = draws.len() as f64;
    let mean = draws.iter().sum::<f64>() / count;
    let squares = draws.iter().map(|x| x * x).sum::<f64>() / count;
    let far = [3e200, 1e200];
    let far_squares = far.iter().map(|x| x * x).sum::<f64>() / 2.0;
    // a light of 2 µm, 3 m above
    let tiny =
        [[-1e-6, -1e-6], [1e-6, -1e-6], [1e-6, 1e-6], [-1e-6, 1e-6]].map(|[x, y]| DVec3::new(x, y, 3.0));
    Ok(vec![
        (
            ["1.1", "−ln(1 − u)", "u = 1e-10"],
            [-(1.0 - 1e-10f64).ln(), 1.000_000_000_05e-10, exponential.inverse_cdf(1e-10)?],
        ),
        (
            ["1.1", "−ln(1 − u)", "u = 1e-20"],
            [-(1.0 - 1e-20f64).ln(), 1e-20, exponential.inverse_cdf(1e-20)?],
        ),
        (
            ["1.2", "1 − exp(−λx)", "λ = 0.37, x = 1e-12"],
            [1.0 - (-0.37e-12f64).exp(), 3.699_999_999_999_315_4e-13, slow.cdf(1e-12)],
        ),
        (
            ["1.2", "1 − F(x)", "λ = 0.37, x = 100"],
            [1.0 - slow.cdf(100.0), 8.533_047_625_744_069e-17, slow.survival(100.0)],
        ),
        (
            ["3.5", "√(1 − cos² θ)", "U = 1e-20"],
            [(1.0 - cosine * cosine).sqrt(), 1e-10, Hemisphere::Cosine.direction_of(1e-20, 0.0)?.sin_theta()],
        ),
        (
            ["4.3", "Σ Θᵢ Γᵢ·n/(2π)", "a light of 2 µm, 3 m away"],
            [
                plain_form_factor(&tiny),
                1.414_710_605_261_082_2e-13,
                form_factor(&tiny, DVec3::ZERO, DVec3::Z),
            ],
        ),
        (
            ["5.1", "exp(k ln p)·(1 − p)", "p = 0.999999, k = 10⁸"],
            [
                (1e8 * p.ln()).exp() * (1.0 - p),
                3.719_889_966_158_222_4e-50,
                Roulette::new(p)?.bounces().pmf(100_000_000),
            ],
        ),
        (
            ["5.1", "1 − p^(k + 1)", "1 − p = 10⁻¹⁰, k = 3"],
            [1.0 - rare.powi(4), 4.000_000_330_361_484e-10, Roulette::new(rare)?.bounces().cdf(3)],
        ),
        (
            ["5.3", "(1 − ρ^(K+1))/(1 − ρ)", "1 − ρ = 10⁻¹², K = 10"],
            [
                (1.0 - nearly_one.powi(11)) / (1.0 - nearly_one),
                10.999_999_999_945_002,
                LightModel::new(nearly_one, 1.0)?.truncated(10)?.mean(),
            ],
        ),
        (
            ["2.1", "E[X²] − E[X]²", "X = 10⁹, 10⁹ + ¼, …"],
            [
                (squares - mean * mean) * count / (count - 1.0),
                78.125 / 999.0,
                Estimate::from_draws(&draws).variance().unwrap_or(f64::NAN),
            ],
        ),
        (
            ["2.1", "√(variance/n)", "X = 3·10²⁰⁰, 10²⁰⁰"],
            [
                (far_squares - 4e200 * 1e200).sqrt(),
                1e200,
                Estimate::from_draws(&far).std_error().unwrap_or(f64::NAN),
            ],
        ),
    ])
}

/// The form factor of a polygon as textbooks have it.
fn plain_form_factor(corners: &[DVec3; 4]) -> f64 {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let sum: f64 = edges
        .map(|(a, b)| {
            (a.dot(*b) / (a.length() * b.length())).clamp(-1.0, 1.0).acos() * a.cross(*b).normalize().z
        })
        .sum();
    sum.abs() / std::f64::consts::TAU
}

fn show(value: f64) -> String {
    let text = if (1e-3..1e6).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") };
    text.replace("-0e0", "0").replace("0e0", "0").replace('-', "−").replace("inf", "∞")
}

/// How many units of the last place `value` is off.
fn ulps(value: f64, truth: f64) -> String {
    match ((value - truth) / (truth.next_up() - truth)).abs() {
        off if off < 1e4 => format!("{off:.0}"),
        off if off.is_finite() => format!("{off:.0e}"),
        _ => "all".into(),
    }
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::appendix(&APPENDIX)
}
