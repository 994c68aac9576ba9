//! Figures of section 1.

use rand::distr::Distribution;

use super::plot::{Axis, Ink, Marker, Panel, Plot, Side, Width};
use super::{Edition, Figure};
use crate::error::{Error, Result};
use crate::inversion::Exponential;
use crate::stream::Stream;

/// 1.2: F, F⁻¹ and p, each against its own axis. The solution marks the sample that `u` gives.
///
/// # Errors
/// If u is not in \[0, 1\].
pub fn exponential(exponential: &Exponential, u: f64, edition: Edition) -> Result<Figure> {
    let rate = exponential.rate();
    let x = exponential.inverse_cdf(u)?;
    // five mean lengths; a sample further out than that widens the axis to it
    let end = (5.0 / rate).max(if x.is_finite() { 1.15 * x } else { 0.0 });
    let along = || Axis::linear("x (dimensionless)", 0.0, end);
    let share = |name: &str| Axis::linear(name, 0.0, 1.0);

    let mut cdf = Panel::new("CDF", along(), share("F(x), a probability"));
    cdf.curve("F", Ink::Blue, |x| exponential.cdf(x));
    let mut inverse = Panel::new("Inverse CDF", share("u, a probability"), Axis::linear("F⁻¹(u)", 0.0, end));
    inverse.curve("F⁻¹", Ink::Vermilion, |u| exponential.inverse_cdf(u).unwrap_or(f64::NAN));
    let mut pdf = Panel::new("PDF", along(), Axis::linear("p(x), per unit of x", 0.0, 1.05 * rate));
    pdf.curve("p", Ink::Green, |x| exponential.pdf(x));

    if edition == Edition::Solution && x.is_finite() {
        let p = exponential.pdf(x);
        let beside = if x > 0.6 * end { Side::Left } else { Side::Right };
        for (panel, at) in [(&mut cdf, [x, u]), (&mut inverse, [u, x]), (&mut pdf, [x, p])] {
            panel.line("sample", Ink::Black, [[0.0, at[1]], at, [at[0], 0.0]]);
            panel.marks("sample", Ink::Black, Marker::Disc, [at]);
        }
        cdf.text(Ink::Black, [x, u - 0.06], beside, &format!("({x:.3}, {u:.3})"));
        let side = if u > 0.5 { Side::Left } else { Side::Right };
        inverse.text(Ink::Black, [u, x + 0.05 * end], side, &format!("({u:.3}, {x:.3})"));
        pdf.text(Ink::Black, [x, p + 0.04 * rate], beside, &format!("({x:.3}, {p:.3})"));
    }
    let (title, description) = match edition {
        Edition::Student => (
            format!(
                "Cumulative distribution, its inverse and density of the exponential distribution, λ = {rate}"
            ),
            format!(
                "Three panels: F(x) and p(x) against x, and F⁻¹(u) against u, for λ = {rate}, to be marked."
            ),
        ),
        Edition::Solution => (
            format!("Inverting F at u = {u} gives x = {x:.3} (λ = {rate})"),
            format!(
                "Three panels for λ = {rate}: F(x) against x, F⁻¹(u) against u, p(x) against x. A line runs from u = {u} to the curve \
                 of F and down to x = {x:.3}; the same point is marked on F⁻¹ and on p."
            ),
        ),
    };
    let panels = vec![cdf, inverse, pdf];
    Plot {
        name: "1_2_exponential",
        title,
        description,
        edition,
        width: Width::Page,
        height_mm: 60.0,
        columns: 3,
        panels,
    }
    .draw()
}

/// 1.1: the empirical cdf of `draws` samples beside F, in the band that holds all of F with 95 % confidence.
///
/// The band is F̂ ± √(ln(2/0.05)/2n) (Dvoretzky, Kiefer & Wolfowitz 1956; Massart 1990), valid for every n.
///
/// # Errors
/// If there are no draws.
pub fn empirical_cdf(exponential: &Exponential, draws: usize, seed: u64) -> Result<Figure> {
    if draws == 0 {
        return Err(Error::TooFewDraws { statistic: "an empirical cdf", needed: 1, draws: 0 });
    }
    let rate = exponential.rate();
    let mut rng = Stream::new(seed, 0);
    let mut samples: Vec<f64> = (0..draws).map(|_| exponential.sample(&mut rng)).collect();
    samples.sort_by(f64::total_cmp);
    let n = draws as f64;
    let reach = ((2.0f64 / 0.05).ln() / (2.0 * n)).sqrt();
    let end = 6.0 / rate;
    // each sample twice: before and after its step
    let mut steps = vec![[0.0, 0.0]];
    for (i, &x) in samples.iter().enumerate() {
        steps.extend([[x, i as f64 / n], [x, (i + 1) as f64 / n]]);
    }
    steps.push([end.max(samples.last().copied().unwrap_or(0.0)), 1.0]);

    let mut panel = Panel::new(
        &format!("{draws} samples, λ = {rate}"),
        Axis::linear("x (dimensionless)", 0.0, end),
        Axis::linear("share of samples ≤ x", 0.0, 1.0),
    );
    panel
        .band(
            "95 % band",
            Ink::Blue,
            steps.iter().map(|&[x, y]| [x, (y - reach).max(0.0), (y + reach).min(1.0)]),
        )
        .line("empirical cdf", Ink::Blue, steps)
        .curve("F", Ink::Black, |x| exponential.cdf(x))
        .text(Ink::Black, [2.1 / rate, 0.62], Side::Right, "thin line: F(x) = 1 − exp(−λx)")
        .text(Ink::Blue, [2.1 / rate, 0.52], Side::Right, &format!("steps: samples, seed {seed}"))
        .text(Ink::Blue, [2.1 / rate, 0.42], Side::Right, &format!("band: ±{reach:.3}, 95 % for all x"));
    Plot {
        name: "1_1_empirical_cdf",
        title: format!("{draws} exponential samples by inversion against the exact F"),
        description: format!(
            "The share of {draws} samples at most x, as steps, with a band of ±{reach:.3} that holds the whole of F with 95 % \
             confidence; F(x) = 1 − e^(−λx) runs inside the band. λ = {rate}, seed {seed}."
        ),
        edition: Edition::Solution,
        width: Width::Column,
        height_mm: 62.0,
        columns: 1,
        panels: vec![panel],
    }
    .draw()
}

/// 1.1: log survival, down to the last sample that f32's and f64's uniform numbers can give.
///
/// # Errors
/// If it cannot be drawn.
pub fn tails(exponential: &Exponential, draws: usize, seed: u64) -> Result<Figure> {
    let rate = exponential.rate();
    let mut rng = Stream::new(seed, 0);
    let mut samples: Vec<f64> =
        (0..draws).map(|_| rate * Distribution::<f64>::sample(exponential, &mut rng)).collect();
    samples.sort_by(|a, b| b.total_cmp(a));
    let measured = (0..)
        .map(|i| 1usize << i)
        .take_while(|&rank| rank <= draws)
        .filter_map(|rank| samples.get(rank - 1).map(|&x| [x, rank as f64 / draws as f64]));
    // the smallest 1 − u above 0 is one step of the grid
    let last = |bits: i32| f64::from(bits) * std::f64::consts::LN_2;
    let (end32, end64) = (last(24), last(53));

    let mut panel = Panel::new(
        "How far the tail reaches",
        Axis::linear("λx (dimensionless)", 0.0, 40.0),
        Axis::log("P(X > x)", 1e-18, 1.0),
    );
    panel
        .curve_between("e^(−λx)", Ink::Black, 0.0, 40.0, |x| (-x).exp())
        .upright("last f32 sample", Ink::Vermilion, end32)
        .upright("last f64 sample", Ink::Blue, end64)
        .marks("measured", Ink::Green, Marker::Ring, measured)
        .text(Ink::Black, [25.0, 1e-10], Side::Right, "exp(−λx)")
        .text(Ink::Vermilion, [end32, 1e-14], Side::Left, "f32 ends at")
        .text(Ink::Vermilion, [end32, 1e-15], Side::Left, "24 ln 2 = 16.636")
        .text(Ink::Blue, [end64, 1e-3], Side::Left, "f64 ends at")
        .text(Ink::Blue, [end64, 1e-4], Side::Left, "53 ln 2 = 36.737")
        .text(Ink::Green, [1.0, 1e-9], Side::Right, &format!("rings: {draws}"))
        .text(Ink::Green, [1.0, 1e-10], Side::Right, "samples");
    Plot {
        name: "1_1_tails",
        title: "The tail of inversion ends where the grid of uniform numbers ends".into(),
        description: format!(
            "P(X > x) against λx on a logarithmic scale: the straight line e^(−λx), {draws} f64 samples on it (seed {seed}), and the last \
             samples possible: λx = 16.636 with f32 uniform numbers, 36.737 with f64."
        ),
        edition: Edition::Solution,
        width: Width::Column,
        height_mm: 62.0,
        columns: 1,
        panels: vec![panel],
    }
    .draw()
}
