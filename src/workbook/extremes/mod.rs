//! Figures about numerical stability: where the obvious code loses digits.

use crate::error::Result;
use crate::estimate::Estimate;
use crate::fast;
use crate::inversion::Exponential;
use crate::plot::{Axis, Figure, Ink, Marker, Panel, Plot, Side};
use crate::stream::Stream;

/// u, −ln(1 − u) and 1 − e^(−u) to 32 digits, and the nearest u on the grid of 2⁻⁵³ with −ln(1 − u) there,
/// computed by `extremes.py`.
const TRUTHS: &str = include_str!("extremes.csv");

/// One implementation of a function, and how it is drawn.
type Form<'a> = (&'a str, Ink, Marker, &'a dyn Fn(f64) -> f64);

/// Figure: the errors of three implementations of each of −ln(1 − u) and 1 − e^(−x), in units of the last
/// place, against the argument.
///
/// ```
/// let figure = unbiased::workbook::extremes::errors_in_ulps()?;
/// assert!(figure.csv().contains("inverse_cdf, by ln_1p"));
/// # Ok::<(), unbiased::Error>(())
/// ```
///
/// # Errors
/// If it cannot be drawn.
pub fn errors_in_ulps() -> Result<Figure> {
    let exponential = Exponential::new(1.0)?;
    let mut quantile = ulp_panel("−ln(1 − u)", "u");
    let mut cdf = ulp_panel("1 − exp(−x)", "x");
    // on the grid, where uniform numbers are, 1 − u is exact
    let fast = errors(|u| -fast::ln(1.0 - u), |[.., u, high, low]| [u, high, low]);
    quantile.marks("−ln(1 − u), fast, on the grid", Ink::Green, Marker::Triangle, fast);
    let forms: [Form<'_>; 2] = [
        ("−ln(1 − u)", Ink::Vermilion, Marker::Cross, &|u| -(1.0 - u).ln()),
        ("inverse_cdf, by ln_1p", Ink::Blue, Marker::Dot, &|u| -(-u).ln_1p()),
    ];
    for (label, ink, marker, form) in forms {
        quantile.marks(label, ink, marker, errors(form, |[u, high, low, ..]| [u, high, low]));
    }
    let forms: [Form<'_>; 3] = [
        ("1 − exp(−x)", Ink::Vermilion, Marker::Cross, &|x| 1.0 - (-x).exp()),
        ("2 exp(−x/2) sinh(x/2)", Ink::Green, Marker::Triangle, &|x| {
            2.0 * (-0.5 * x).exp() * (0.5 * x).sinh()
        }),
        ("cdf, by exp_m1", Ink::Blue, Marker::Dot, &|x| exponential.cdf(x)),
    ];
    for (label, ink, marker, form) in forms {
        cdf.marks(label, ink, marker, errors(form, |[x, _, _, high, low, ..]| [x, high, low]));
    }
    quantile.text(Ink::Vermilion, [1e-8, 1e10], Side::Right, "× −ln(1 − u)").text(
        Ink::Blue,
        [1e-17, 12.0],
        Side::Right,
        "● −ln_1p(−u)",
    );
    quantile.text(Ink::Green, [1e-17, 250.0], Side::Right, "▲ fast, for u = k·2⁻⁵³");
    cdf.text(Ink::Vermilion, [1e-8, 1e10], Side::Right, "× 1 − exp(−x)")
        .text(Ink::Green, [1e-17, 250.0], Side::Right, "▲ 2 exp(−x/2) sinh(x/2)")
        .text(Ink::Blue, [1e-17, 12.0], Side::Right, "● −exp_m1(−x)");
    Plot::of("extremes_ulps", 72.0, vec![quantile, cdf]).draw(
        "Near 0 the obvious formulas lose all digits; ln_1p and exp_m1 lose none",
        "Errors in units of the last place, logarithmic, against u and x from 1e-18 to 1. −ln(1 − u) and \
             1 − exp(−x) are off by one part in 1e16 of 1, which for a small argument is all of it: up to \
             1e16 units of the last place, where the result is 0. ln_1p and exp_m1 stay within one \
             everywhere, the fast logarithm does where u is a whole number of 2⁻⁵³, as uniform numbers are, \
             and so does the product with sinh, within two. Errors below 0.05 are drawn there.",
    )
}

fn ulp_panel(heading: &str, argument: &str) -> Panel {
    let ticks = [(0.1, "0.1"), (1.0, "1"), (1e4, "10⁴"), (1e8, "10⁸"), (1e12, "10¹²"), (1e16, "10¹⁶")];
    Panel::new(
        heading,
        Axis::log(argument, 1e-18, 1.0),
        Axis::log("error (units of the last place)", 0.03, 1e17).with_ticks(ticks),
    )
}

/// The argument and the error of `form` there, in units of the last place of the truth; `of` selects both
/// from a row of the table.
fn errors(form: impl Fn(f64) -> f64, of: impl Fn([f64; 8]) -> [f64; 3]) -> Vec<[f64; 2]> {
    let rows = TRUTHS.lines().skip(1).filter_map(|line| {
        let fields: Vec<f64> = line.split(',').map(str::parse).collect::<Result<_, _>>().ok()?;
        <[f64; 8]>::try_from(fields).ok()
    });
    rows.map(|row| {
        let [u, high, low] = of(row);
        let ulp = high.next_up() - high;
        let error = ((form(u) - high) - low).abs() / ulp;
        [u, error.max(0.05)]
    })
    .collect()
}

/// Figure: the relative error of the running mean of 10¹⁰ + U, compared with the exact mean of the same
/// draws, summed in f32, in f64, and by [`Estimate`].
///
/// ```
/// let figure = unbiased::workbook::extremes::running_mean_errors(1)?;
/// assert_eq!(figure.title(), "A sum that rounds drifts away from the mean");
/// # Ok::<(), unbiased::Error>(())
/// ```
///
/// # Errors
/// If it cannot be drawn.
pub fn running_mean_errors(seed: u64) -> Result<Figure> {
    const SHIFT: f64 = 1e10;
    const DRAWS: u64 = 4_000_000;
    let mut rng = Stream::new(seed, 0);
    let (mut single, mut double, mut kept, mut exact) = (0.0f32, 0.0f64, Estimate::new(), 0u128);
    let mut points = [const { Vec::new() }; 3];
    let mut next = 10;
    for n in 1..=DRAWS {
        // on the grid that 10¹⁰ + U has in f64, so that the exact sum is an integer
        let step = (rng.uniform() * GRID).floor();
        let draw = SHIFT + step / GRID;
        exact += step as u128;
        single += draw as f32;
        double += draw;
        kept.push(draw);
        if n == next {
            let count = n as f64;
            // the mean minus 10¹⁰ + (Σ steps)/(n·grid); 10¹⁰ is subtracted first, which is exact
            let beyond = exact as f64 / GRID / count;
            let error = |mean: f64| ((mean - SHIFT) - beyond).abs() / SHIFT;
            for (points, mean) in
                points.iter_mut().zip([f64::from(single) / count, double / count, kept.mean()])
            {
                points.push([count, error(mean).max(1e-18)]);
            }
            next = (count * 1.15).ceil() as u64;
        }
    }
    let [in_f32, ..] = &points;
    let worst = 100.0 * in_f32.iter().fold(0.0, |worst: f64, [_, error]| worst.max(*error));
    let last = 100.0 * in_f32.last().map_or(0.0, |[_, error]| *error);
    let mut panel = Panel::new(
        "The running mean of 10¹⁰ + U",
        Axis::log("draws n", 10.0, 1e7),
        Axis::log("error/mean (dimensionless)", 2e-21, 10.0),
    );
    panel.curve("std error", Ink::Black, |n| (1.0f64 / 12.0).sqrt() / n.sqrt() / SHIFT);
    let series = [("f32", Ink::Vermilion), ("f64", Ink::Green), ("Estimate", Ink::Blue)];
    for (points, (label, ink)) in points.into_iter().zip(series) {
        panel.line(label, ink, points);
    }
    panel
        .text(Ink::Vermilion, [12.0, 1e-3], Side::Right, "summed in f32")
        .text(Ink::Black, [12.0, 1e-10], Side::Right, "std error of the mean")
        .text(Ink::Green, [12.0, 3e-14], Side::Right, "in f64")
        .text(Ink::Blue, [12.0, 2e-20], Side::Right, "as an Estimate");
    Plot::of("extremes_mean", 72.0, vec![panel]).draw(
        "A sum that rounds drifts away from the mean",
        format!(
            "The error of the running mean of 10¹⁰ + U relative to the mean, both axes logarithmic, over \
                 {DRAWS} draws (seed {seed}). Summed in f32 it reaches {worst:.1} %, and is {last:.1} % at \
                 the end; in f64 it drifts too; the mean that an Estimate keeps stays at the rounding of its \
                 last digit. The thin line is the standard error, below which an error does not matter. \
                 Errors below 1e-18 are drawn there."
        ),
    )
}

/// 10¹⁰ + U has steps of 2⁻¹⁹ in f64.
const GRID: f64 = 524_288.0;
