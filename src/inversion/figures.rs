//! Figures of section 1.

use rand::distr::Distribution;

use crate::error::{Error, Result};
use crate::inversion::Exponential;
use crate::numbers::{equals, typeset};
use crate::plot::{Axis, Edition, Figure, Ink, Marker, Panel, Plot, Side};
use crate::stream::Stream;

/// The rate, if the density and the lengths can be drawn.
fn drawable(exponential: &Exponential) -> Result<f64> {
    let rate = exponential.rate();
    let ok = (1e-290..=1e290).contains(&rate);
    let allowed = "between 1e-290 and 1e290 to be drawn";
    if ok { Ok(rate) } else { Err(Error::Parameter { name: "the rate λ", value: rate, allowed }) }
}

/// Figure for 1.2: F, F⁻¹ and p, each on axes of its own, for x up to 5/λ. The solution adds arrows from u to
/// its sample; the student's edition has the curves alone.
///
/// # Errors
/// If u is not in \[0, 1\], or the rate is too large or too small to be drawn.
pub fn exponential(exponential: &Exponential, u: f64, edition: Edition) -> Result<Figure> {
    let rate = drawable(exponential)?;
    let x = exponential.inverse_cdf(u)?;
    let end = 5.0 / rate;
    let along = |name: &str| Axis::linear(name, 0.0, end);
    let share = |name: &str| Axis::linear(name, 0.0, 1.0);

    // the axis names must not give away the answer to 1.3
    let (lambda, given) = (typeset(rate, 12), typeset(u, 12));
    let heading = format!("CDF, λ = {lambda}");
    let mut cdf = Panel::new(&heading, along("x (dimensionless)"), share("F(x) (dimensionless)"));
    cdf.curve("F", Ink::Blue, |x| exponential.cdf(x));
    let mut inverse = Panel::new("Inverse CDF", share("u (dimensionless)"), along("F⁻¹(u) (dimensionless)"));
    inverse.curve("F⁻¹", Ink::Vermilion, |u| exponential.inverse_cdf(u).unwrap_or(f64::NAN));
    let density = Axis::linear("p(x) (dimensionless)", 0.0, 1.05 * rate);
    let mut pdf = Panel::new("PDF", along("x (dimensionless)"), density);
    pdf.curve("p", Ink::Green, |x| exponential.pdf(x));

    if edition == Edition::Solution {
        let (place, p) = (rate * x / 5.0, exponential.pdf(x));
        let answer = Sample { u, x, place, p, label: sample_label(rate, u, x) };
        answer.on_cdf(&mut cdf);
        answer.on_inverse(&mut inverse);
        answer.on_pdf(&mut pdf);
    }
    let (title, description) = match edition {
        Edition::Student => (
            format!(
                "Cumulative distribution, its inverse and density of the exponential distribution, λ = \
                 {lambda}"
            ),
            format!(
                "Three panels: F(x) and p(x) against x, and F⁻¹(u) against u, for λ = {lambda}, to be marked."
            ),
        ),
        Edition::Solution => (
            format!("Inverting F at u = {given} gives x {} (λ = {lambda})", equals(x, 4)),
            format!(
                "Three panels for λ = {lambda}: F(x) against x, F⁻¹(u) against u, p(x) against x. Arrows \
                 lead from u = {given} across to the curve of F and down to x {}, and up to the curve of F⁻¹ \
                 and across; p is marked there.{}",
                equals(x, 4),
                if x > end { " That x lies beyond the axes." } else { "" }
            ),
        ),
    };
    // the density stands below the cdf, with the same x axis
    let panels = vec![cdf, inverse, pdf];
    Plot { edition, columns: 2, ..Plot::of("1_2_exponential", 132.0, panels) }.draw(title, description)
}

/// The sample as text, such as “x = ln 4 ≈ 1.39”: with ln n if 1/(1 − u) is a whole number n, and with λ if λ
/// is not 1.
fn sample_label(rate: f64, u: f64, x: f64) -> String {
    let inverse = 1.0 / (1.0 - u);
    let whole = inverse.round();
    let number = equals(x, 3);
    if !(1.5..=1e6).contains(&whole) || (inverse - whole).abs() > 1e-9 * whole {
        return format!("x {number}");
    }
    if rate == 1.0 { format!("x = ln {whole} {number}") } else { format!("x = (ln {whole})/λ {number}") }
}

/// The sample for u, as it is marked; `place` is that of x on its axis.
struct Sample {
    u: f64,
    x: f64,
    place: f64,
    p: f64,
    label: String,
}

impl Sample {
    /// From u across to the curve, and down.
    fn on_cdf(&self, panel: &mut Panel) {
        let Self { u, x, place, ref label, .. } = *self;
        if place > 1.0 {
            panel.arrow(Ink::Black, [0.0, u], [panel.x.high, u]);
            panel.note(Ink::Black, [1.0, 0.5], Side::Left, &format!("{label}, beyond the axis →"));
        } else {
            panel.arrow(Ink::Black, [0.0, u], [x, u]).arrow(Ink::Black, [x, u], [x, 0.0]);
            panel.marks("sample", Ink::Black, Marker::Disc, [[x, u]]);
            self.say(panel, panel.spot(place, 0.07), Side::Right, label);
        }
        self.say(panel, [0.0, u], Side::UpperRight, &self.given());
    }

    /// From u up to the curve, and across.
    fn on_inverse(&self, panel: &mut Panel) {
        let Self { u, x, place, ref label, .. } = *self;
        if place > 1.0 {
            panel.arrow(Ink::Black, [u, 0.0], [u, panel.y.high]);
            panel.note(Ink::Black, [u - 0.1, 0.93], Side::Left, &format!("{label}, beyond the axis ↑"));
        } else {
            panel.arrow(Ink::Black, [u, 0.0], [u, x]).arrow(Ink::Black, [u, x], [0.0, x]);
            panel.marks("sample", Ink::Black, Marker::Disc, [[u, x]]);
            self.say(panel, panel.spot(0.0, place), Side::UpperRight, label);
        }
        self.say(panel, panel.spot(u, 0.07), Side::Left, &self.given());
    }

    /// The density at the sample.
    fn on_pdf(&self, panel: &mut Panel) {
        let Self { x, place, p, ref label, .. } = *self;
        if place > 1.0 {
            panel.note(Ink::Black, [1.0, 0.5], Side::Left, &format!("{label}, beyond the axis →"));
            return;
        }
        panel.arrow(Ink::Black, [x, 0.0], [x, p]).marks("sample", Ink::Black, Marker::Disc, [[x, p]]);
        self.say(panel, [x, p], Side::UpperRight, &format!("p(x) {}", equals(p, 3)));
    }

    fn given(&self) -> String {
        format!("U = {}", typeset(self.u, 12))
    }

    /// A text on this side of a point, or where there is room if the curves are near.
    fn say(&self, panel: &mut Panel, at: [f64; 2], side: Side, text: &str) {
        if (0.65..=0.89).contains(&self.u) {
            panel.text(Ink::Black, at, side, text);
        } else {
            panel.label(Ink::Black, at, text);
        }
    }
}

/// Figure for 1.1: ten numbers U with their samples F⁻¹(U), and the empirical cdf of `draws` samples compared
/// with F. The band contains all of F at a confidence level of 95 %.
///
/// The band is F̂ ± √(ln(2/0.05)/2n) (Dvoretzky, Kiefer & Wolfowitz 1956; Massart 1990), valid for every n.
///
/// # Errors
/// If there are no draws, or the rate is too large or too small to be drawn.
pub fn empirical_cdf(exponential: &Exponential, draws: usize, seed: u64) -> Result<Figure> {
    if draws == 0 {
        return Err(Error::TooFewDraws { statistic: "an empirical cdf", needed: 1, draws: 0 });
    }
    let rate = drawable(exponential)?;
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

    let along = || Axis::linear("x (dimensionless)", 0.0, end);
    let lambda = typeset(rate, 12);
    let mut carried = Panel::new(
        &format!("From U to X, λ = {lambda}"),
        along(),
        Axis::linear("U (dimensionless)", 0.0, 1.0),
    );
    let mut ten = Vec::new();
    for i in 0..10 {
        let u = 0.05 + 0.1 * f64::from(i);
        let x = exponential.inverse_cdf(u)?;
        carried.line("U to X", Ink::Grey, [[0.0, u], [x, u]]).arrow(Ink::Grey, [x, u], [x, 0.0]);
        ten.push([x, u]);
    }
    carried
        .curve("F", Ink::Black, |x| exponential.cdf(x))
        .marks("U and X", Ink::Blue, Marker::Disc, ten)
        .note(Ink::Blue, [0.52, 0.62], Side::Right, "ten U evenly apart:")
        .note(Ink::Blue, [0.52, 0.54], Side::Right, "across to F, down")
        .note(Ink::Blue, [0.52, 0.46], Side::Right, "to X = F⁻¹(U),")
        .note(Ink::Blue, [0.52, 0.38], Side::Right, "close together")
        .note(Ink::Blue, [0.52, 0.3], Side::Right, "where F is steep");

    let mut panel = Panel::new(
        &format!("{draws} samples, λ = {lambda}"),
        along(),
        Axis::linear("share of samples ≤ x", 0.0, 1.0),
    );
    panel
        .band(
            "95 % band",
            Ink::Blue,
            steps.iter().map(|&[x, y]| [x, (y - reach).max(0.0), (y + reach).min(1.0)]),
        )
        .line("empirical cdf", Ink::Blue, steps)
        .curve("F", Ink::Black, |x| exponential.cdf(x));
    let told = format!("band: ±{}, 95 % for all x", typeset(reach, 2));
    panel
        .note(Ink::Black, [0.4, 0.5], Side::Right, "thin: F(x) = 1 − exp(−λx)")
        .note(Ink::Blue, [0.4, 0.42], Side::Right, &format!("steps: samples, seed {seed}"))
        .note(Ink::Blue, [0.4, 0.34], Side::Right, &told);
    let title =
        format!("Exponential samples by inversion: ten step by step, and {draws} against the exact F");
    Plot::of("1_1_empirical_cdf", 66.0, vec![carried, panel]).draw(
        title,
        format!(
            "Two panels against x, λ = {lambda}. Left: ten evenly spaced U are carried across to the curve \
             of F and down to their samples, which lie closest where F is steepest, near 0. Right: the share \
             of {draws} samples at most x, as steps, with a band of ±{} that holds the whole of F with 95 % \
             confidence; F(x) = 1 − e^(−λx) runs inside the band (seed {seed}).",
            typeset(reach, 2)
        ),
    )
}

/// Figure for 1.1: P(X > x) on a logarithmic scale, up to the largest samples that uniform numbers in f32 and
/// f64 can give.
///
/// # Errors
/// If it cannot be drawn.
pub fn tails(exponential: &Exponential, draws: usize, seed: u64) -> Result<Figure> {
    let rate = exponential.rate();
    let mut rng = Stream::new(seed, 0);
    let mut samples: Vec<f64> =
        (0..draws).map(|_| rate * Distribution::<f64>::sample(exponential, &mut rng)).collect();
    samples.sort_by(|a, b| b.total_cmp(a));
    let ranks = (0..usize::BITS).map(|i| 1usize << i);
    let measured = ranks.filter_map(|rank| samples.get(rank - 1).map(|&x| [x, rank as f64 / draws as f64]));
    // the smallest 1 − u above 0 is one grid step
    let last = |bits: i32| f64::from(bits) * std::f64::consts::LN_2;
    let (end32, end64) = (last(24), last(53));

    let mut panel = Panel::new(
        "How far the tail reaches",
        Axis::linear("λx (dimensionless)", 0.0, 40.0),
        Axis::log("P(X > x)", 1e-18, 1.0),
    );
    panel
        .curve_between("e^(−λx)", Ink::Black, [0.0, 40.0], |x| (-x).exp())
        .upright("last f32 sample", Ink::Vermilion, end32)
        .upright("last f64 sample", Ink::Blue, end64)
        .marks("measured", Ink::Green, Marker::Ring, measured)
        .text(Ink::Black, [25.0, 1e-10], Side::Right, "exp(−λx)")
        .text(Ink::Vermilion, [end32, 1e-14], Side::Left, "f32 ends at")
        .text(Ink::Vermilion, [end32, 4e-16], Side::Left, "24 ln 2 = 16.636")
        .text(Ink::Blue, [end64, 1e-3], Side::Left, "f64 ends at")
        .text(Ink::Blue, [end64, 4e-5], Side::Left, "53 ln 2 = 36.737")
        .text(Ink::Green, [1.0, 1e-9], Side::Right, &format!("rings: {draws}"))
        .text(Ink::Green, [1.0, 4e-11], Side::Right, "samples");
    Plot::of("1_1_tails", 62.0, vec![panel]).draw(
        "The tail of inversion ends where the grid of uniform numbers ends",
        format!(
            "P(X > x) against λx on a logarithmic scale: the straight line e^(−λx), {draws} f64 samples on \
             it (seed {seed}), and the last samples possible: λx = 16.636 with f32 uniform numbers, 36.737 \
             with f64."
        ),
    )
}
