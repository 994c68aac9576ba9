//! Figures of section 3.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, LN_10, TAU};

use rand::distr::Distribution;

use crate::check::{Look, Unbiased};
use crate::error::Result;
use crate::estimator::from_fn;
use crate::lambertian::hemisphere::Hemisphere::{self, Cosine, Uniform};
use crate::lambertian::{CosinePower, Lambertian, Light, RingLight};
use crate::numbers::power_of_ten;
use crate::plot::{Axis, Figure, Ink, Marker, Panel, Plot, Side};
use crate::run::{Budget, estimate};
use crate::stream::Stream;

/// Figure for 3.2: the integrand cos θ sin θ with its area ½, and what is integrated if a factor is
/// forgotten.
///
/// # Errors
/// If it cannot be drawn.
pub fn integrand() -> Result<Figure> {
    let ticks = [(0.0, "0"), (FRAC_PI_4, "π/4"), (FRAC_PI_2, "π/2")];
    let mut panel = Panel::new(
        "What is integrated over θ",
        Axis::linear("θ (radians)", 0.0, FRAC_PI_2).with_ticks(ticks),
        Axis::linear("integrand (dimensionless)", 0.0, 1.0),
    );
    let filled = (0..=120).map(|i| FRAC_PI_2 * f64::from(i) / 120.0).map(|t| [t, 0.0, t.cos() * t.sin()]);
    panel
        .band("area of cos θ sin θ", Ink::Blue, filled)
        .curve("cos θ sin θ", Ink::Blue, |t| t.cos() * t.sin())
        .curve("cos θ", Ink::Vermilion, f64::cos)
        .curve("sin θ", Ink::Green, f64::sin)
        .text(Ink::Blue, [FRAC_PI_4, 0.28], Side::Centre, "cos θ sin θ: area ½")
        .text(Ink::Vermilion, [0.03, 0.76], Side::Right, "cos θ: area 1")
        .text(Ink::Vermilion, [0.03, 0.67], Side::Right, "(sin θ forgotten)")
        .text(Ink::Green, [1.54, 0.76], Side::Left, "sin θ: area 1")
        .text(Ink::Green, [1.54, 0.67], Side::Left, "(cos θ forgotten)");
    Plot::of("3_2_integrand", 62.0, vec![panel]).draw(
        "cos θ sin θ has area ½; with a factor forgotten the area is 1",
        "Three curves over θ from 0 to π/2: cos θ sin θ, filled, has area ½; cos θ alone, where the sin θ of \
         the solid angle is forgotten, and sin θ alone, where cos θ is forgotten, have area 1 each.",
    )
}

/// Figures for 3.4 and 3.5: sampled directions from above and from the side.
///
/// # Errors
/// If it cannot be drawn.
pub fn directions(hemisphere: Hemisphere, count: usize, seed: u64) -> Result<Figure> {
    let (name, word, ink, rule) = match hemisphere {
        Uniform => ("3_4_directions", "uniform", Ink::Blue, "cos θ = 1 − U"),
        Cosine => ("3_5_directions", "cosine-weighted", Ink::Vermilion, "cos θ = √(1 − U)"),
    };
    let mut rng = Stream::new(seed, 0);
    let vectors: Vec<_> = (0..count).map(|_| hemisphere.sample(&mut rng).vector()).collect();
    let ticks = || [(-1.0, "−1"), (0.0, "0"), (1.0, "1")];
    let across = |name: &str| Axis::linear(name, -1.6, 1.6).with_ticks(ticks());
    let arc = |from: f64, to: f64| {
        (0..=120).map(move |i| from + (to - from) * f64::from(i) / 120.0).map(|t| [t.cos(), t.sin()])
    };

    let mut top = Panel::new(
        "From above",
        across("x (dimensionless)"),
        Axis::linear("y (dimensionless)", -1.0, 1.0).with_ticks(ticks()),
    );
    top.line("horizon", Ink::Grey, arc(0.0, TAU));
    top.marks(word, ink, Marker::Dot, vectors.iter().map(|v| [v.x, v.y]));

    let mut side = Panel::new(
        "From the side",
        across("x (dimensionless)"),
        Axis::linear("z (dimensionless)", -0.5, 1.5).with_ticks([(0.0, "0"), (1.0, "1")]),
    );
    side.line("hemisphere", Ink::Grey, arc(0.0, TAU / 2.0));
    side.line("surface", Ink::Black, [[-1.6, 0.0], [1.6, 0.0]]);
    side.marks(word, ink, Marker::Dot, vectors.iter().map(|v| [v.x, v.z]));
    side.arrow(Ink::Black, [0.0, 1.0], [0.0, 1.4]);
    side.text(Ink::Black, [0.03, 1.3], Side::Right, "normal");
    side.text(Ink::Black, [0.0, -0.25], Side::Centre, &format!("{rule}, φ = 2πV"));
    Plot::of(name, 62.2, vec![top, side]).draw(
        format!("{count} {word} directions, from above and from the side"),
        format!(
            "{count} points on the unit hemisphere drawn with {rule} and φ = 2πV (seed {seed}), seen from \
             above, inside the circle of the horizon, and from the side, above the surface. {}",
            match hemisphere {
                Uniform =>
                    "From the side they fill all heights alike; from above they crowd towards the rim.",
                Cosine => "From above they fill the disc evenly; few are near the horizon.",
            }
        ),
    )
}

/// f/p against θ for a white surface under constant incoming radiance 1.
fn reason() -> Panel {
    let ticks = [(0.0, "0"), (FRAC_PI_4, "π/4"), (FRAC_PI_2, "π/2")];
    let mut panel = Panel::new(
        "Why, for the uniform light (a = 0)",
        Axis::linear("θ (radians)", 0.0, FRAC_PI_2).with_ticks(ticks),
        Axis::linear("f/p (W m⁻² sr⁻¹)", 0.0, 2.2),
    );
    panel
        .curve("uniform: f/p = 2 cos θ", Ink::Blue, |t| 2.0 * t.cos())
        .level("cosine: f/p = 1", Ink::Vermilion, 1.0)
        .note(Ink::Blue, [0.42, 0.88], Side::Right, "uniform directions: 2 cos θ,")
        .note(Ink::Blue, [0.42, 0.79], Side::Right, "varies from draw to draw")
        .note(Ink::Vermilion, [0.02, 0.35], Side::Right, "cosine directions: 1,")
        .note(Ink::Vermilion, [0.02, 0.26], Side::Right, "the mean itself in every draw")
        .note(Ink::Vermilion, [0.02, 0.17], Side::Right, "p is proportional to f");
    panel
}

/// Figure for 3.6: f/p against θ for both densities, and their variances against the exponent a of the
/// incoming radiance cos^a θ, exact and measured.
///
/// # Errors
/// If it cannot be drawn.
pub fn variance_against_exponent(draws: u64, seed: u64) -> Result<Figure> {
    let white = Lambertian::new(1.0)?;
    let exact =
        |hemisphere, a| CosinePower::new(a).map_or(f64::NAN, |light| light.variance(white, hemisphere));
    let measured = |hemisphere, exponents: &[f64]| -> Result<Vec<[f64; 2]>> {
        let of = |&a: &f64| Ok([a, measured_variance(CosinePower::new(a)?, hemisphere, draws, seed)?]);
        exponents.iter().map(of).collect()
    };
    let ticks = [(-1.0, "−1"), (-0.5, "−½"), (0.0, "0"), (1.0, "1"), (2.0, "2"), (3.0, "3"), (4.0, "4")];
    let mut panel = Panel::new(
        "Light cosᵃ θ, ρ = 1",
        Axis::linear("exponent a (dimensionless)", -1.5, 4.0).with_ticks(ticks),
        Axis::linear("variance of a draw", 0.0, 0.6),
    );
    panel
        .curve_between("uniform", Ink::Blue, [-1.4999, 4.0], |a| exact(Uniform, a))
        .curve_between("cosine", Ink::Vermilion, [-0.9999, 4.0], |a| exact(Cosine, a))
        .marks(
            "uniform, measured",
            Ink::Blue,
            Marker::Disc,
            measured(Uniform, &[-1.0, -0.75, 0.5, 1.0, 2.0, 3.0])?,
        )
        .marks(
            "cosine, measured",
            Ink::Vermilion,
            Marker::Square,
            measured(Cosine, &[-0.25, 0.5, 1.0, 2.0, 3.0])?,
        )
        .marks("equal", Ink::Black, Marker::Ring, [[-0.5, 2.0 / 9.0]])
        .marks("at a = 0 and −1", Ink::Black, Marker::Ring, [[0.0, 1.0 / 3.0], [0.0, 0.0], [-1.0, 0.0]])
        .text(Ink::Black, [-0.45, 0.215], Side::Right, "equal, 2/9")
        .text(Ink::Black, [0.02, 0.375], Side::Left, "1/3")
        .text(Ink::Black, [0.02, 0.12], Side::Right, "cosine: 0")
        .text(Ink::Blue, [2.3, 0.4], Side::Centre, "uniform")
        .text(Ink::Vermilion, [2.5, 0.045], Side::Centre, "cosine")
        .text(Ink::Vermilion, [-0.6, 0.56], Side::Right, "cosine: ∞ as a → −1");
    Plot::of("3_6_variance", 66.0, vec![reason(), panel]).draw(
        "Cosine-weighted directions win for a > −½, uniform ones below",
        format!(
            "Left: f/p against θ under a uniform light; 2 cos θ for uniform directions, 1 everywhere for \
                 cosine-weighted ones, whose p is proportional to f. Right: variance of one draw against the \
                 exponent a of the light cos^a θ. Uniform: 0 at a = −1, 1/3 at a = 0. Cosine: infinite as a \
                 → −1, 0 at a = 0. Both are 2/9 at a = −½. Points: variances of {draws} draws, seed \
                 {seed}."
        ),
    )
}

/// The variance of a draw for a white surface under this light.
fn measured_variance(light: impl Light + Copy, hemisphere: Hemisphere, draws: u64, seed: u64) -> Result<f64> {
    let estimator = Lambertian::new(1.0)?.estimator(move |w| light.incoming(w), hemisphere);
    Ok(estimate(&estimator, Budget::Draws(draws), seed)?.variance().unwrap_or(f64::NAN))
}

/// Figure for 3.6: the variance of cosine directions over that of uniform ones, against the width of a ring
/// of light along the horizon.
///
/// # Errors
/// If it cannot be drawn.
pub fn variance_against_ring(draws: u64, seed: u64) -> Result<Figure> {
    let white = Lambertian::new(1.0)?;
    let exact = |width| {
        RingLight::new(width)
            .map_or(f64::NAN, |ring| ring.variance(white, Cosine) / ring.variance(white, Uniform))
    };
    let mut measured = Vec::new();
    for width in [0.02, 0.05, 0.1, 0.2, 0.4, 0.6, 0.75, 0.9] {
        let of = |hemisphere| measured_variance(RingLight::new(width)?, hemisphere, draws, seed);
        measured.push([width, of(Cosine)? / of(Uniform)?]);
    }
    let ticks = [(0.0, "0"), (0.25, "0.25"), (0.5, "0.5"), (0.75, "0.75"), (1.0, "1")];
    let mut panel = Panel::new(
        "Light only where cos θ < ε",
        Axis::linear("width ε of the ring (dimensionless)", 0.0, 1.0).with_ticks(ticks),
        Axis::log("Var cosine / Var uniform", 0.05, 100.0),
    );
    panel
        .level("equal", Ink::Grey, 1.0)
        .curve_between("ratio", Ink::Vermilion, [0.008, 0.999], exact)
        .marks("measured", Ink::Vermilion, Marker::Square, measured)
        .marks("crossing", Ink::Black, Marker::Ring, [[0.75, 1.0], [0.1, 297.0 / 37.0]])
        .text(Ink::Black, [0.12, 9.0], Side::Right, "8.03 at ε = 0.1")
        .text(Ink::Black, [0.79, 2.6], Side::Centre, "equal at ε = ¾")
        .text(Ink::Grey, [0.02, 0.66], Side::Right, "above: uniform is better")
        .text(Ink::Grey, [0.02, 0.37], Side::Right, "below: cosine is better");
    Plot::of("3_6_ring", 66.0, vec![panel]).draw(
        "Light from near the horizon: cosine-weighted directions lose for ε < ¾",
        format!(
            "The variance of cosine-weighted directions divided by that of uniform ones, against the width ε \
             of the ring of light cos θ < ε: 8.03 at ε = 0.1, 1 at ε = ¾, and less for wider rings. Points: \
             variances of {draws} draws, seed {seed}."
        ),
    )
}

/// Relative differences below this count as none: half of the smaller bias shown.
const DELTA: f64 = 5e-3;

/// The wealth of bets against an estimator's mean as draws come in, for three estimators of the radiance
/// reflected under L = cos θ: a right one, one that is 1 % off, and the classic mistake, uniform directions
/// with the cosine weight. A second panel has the bets that certify the right one.
///
/// # Errors
/// If it cannot be drawn.
pub fn betting(seed: u64) -> Result<Figure> {
    let (truth, range) = (2.0 / 3.0, [0.0, 2.1]);
    let weighted = |factor: f64, power: i32| {
        from_fn(move |rng| factor * Hemisphere::Uniform.sample(rng).cos_theta().powi(power))
    };
    let check = Unbiased::new(truth, range)?.within(DELTA)?.seed(seed);
    // ρ = 1: 2 L cos θ is right, L alone is what cosine directions would need
    let (right, right_looks) = check.trace(&weighted(2.0, 2))?;
    let (off, off_looks) = check.trace(&weighted(2.02, 2))?;
    let (classic, classic_looks) = check.trace(&weighted(1.0, 1))?;
    let [right_draws, off_draws, classic_draws] =
        [right, off, classic].map(|report| report.estimate.draws() as f64);

    let most = right_draws.max(off_draws);
    let end = 10f64.powf(most.log10().ceil()).max(1e6);
    let along = || Axis::log("draws", 100.0, end);
    let wealth_axis = || {
        let powers = (-3..=21).step_by(3).map(|power| (f64::from(power), power_of_ten(power)));
        Axis::linear("wealth (1 at the start)", -4.0, 21.0).with_ticks(powers)
    };

    let mut against = Panel::new("Bets against the truth", along(), wealth_axis());
    against.level("1/α", Ink::Black, 12.0);
    let path = |looks: &[Look], wealth: fn(&Look) -> f64| {
        thinned(looks).map(|look| [look.draws as f64, wealth(look) / LN_10]).collect::<Vec<_>>()
    };
    let truth_bets: fn(&Look) -> f64 = |look| look.against_truth;
    for (series, ink, looks) in [
        ("right", Ink::Blue, &right_looks),
        ("1 % too large", Ink::Green, &off_looks),
        ("uniform directions, cosine weight", Ink::Vermilion, &classic_looks),
    ] {
        let points = path(looks, truth_bets);
        let last = points.last().copied();
        against.line(series, ink, points).marks(&format!("{series}: verdict"), ink, Marker::Disc, last);
    }
    let classic_label = 1.4 * classic_draws;
    against
        .text(Ink::Black, [classic_label, 14.3], Side::Right, "1/α: biased, wrong with")
        .text(Ink::Black, [classic_label, 13.0], Side::Right, "probability 10⁻¹² at most")
        .text(Ink::Vermilion, [classic_label, 10.6], Side::Right, "uniform directions,")
        .text(Ink::Vermilion, [classic_label, 9.3], Side::Right, "cosine weight: refuted")
        .text(Ink::Vermilion, [classic_label, 8.0], Side::Right, &format!("after {classic_draws} draws"))
        .text(Ink::Green, [0.2 * off_draws, 5.2], Side::Left, "1 % too large: refuted")
        .text(Ink::Green, [0.2 * off_draws, 3.9], Side::Left, &format!("after {off_draws} draws"))
        .text(Ink::Blue, [220.0, -1.9], Side::Right, "right: never refuted");

    let mut certificate = Panel::new("Certifying the right estimator", along(), wealth_axis());
    certificate
        .level("1/β", Ink::Black, 6.0)
        .line("bets against 0.5 % less", Ink::Blue, path(&right_looks, |look| look.against_too_low))
        .line("bets against 0.5 % more", Ink::Purple, path(&right_looks, |look| look.against_too_high))
        .text(Ink::Black, [100.0, 11.4], Side::Right, "1/β: unbiased within 0.5 %")
        .text(Ink::Black, [100.0, 10.1], Side::Right, "once both have passed it; each")
        .text(Ink::Black, [100.0, 8.8], Side::Right, "wrong with probability 10⁻⁶")
        .text(Ink::Black, [100.0, 7.5], Side::Right, &format!("at most; here {right_draws} draws"))
        .text(Ink::Blue, [220.0, 4.2], Side::Right, "solid: against 0.5 % less")
        .text(Ink::Purple, [220.0, 2.9], Side::Right, "dotted: against 0.5 % more");

    Plot::of("check_wealth", 76.0, vec![against, certificate]).draw(
        format!(
            "Betting against a mean: the classic mistake is refuted after {classic_draws} draws, a bias of 1 \
             % after {off_draws}, and the right estimator certified within 0.5 % after {right_draws}"
        ),
        format!(
            "Two panels, wealth against draws, both logarithmic, seed {seed}. Left, bets against the mean \
             2/3: those on uniform directions with the cosine weight reach 10¹² after {classic_draws} draws, \
             those on an estimator 1 % too large after {off_draws}, those on a right one never. Right, for \
             the right estimator: bets against means 0.5 % less and 0.5 % more both pass 10⁶ by \
             {right_draws} draws."
        ),
    )
}

/// Keeps looks whose numbers of draws are at least 2 % apart, and the last one.
fn thinned(looks: &[Look]) -> impl Iterator<Item = &Look> {
    let last = looks.last().map_or(0, |look| look.draws);
    let mut next = 0.0;
    looks.iter().filter(move |look| {
        let draws = look.draws as f64;
        let kept = draws >= next || look.draws == last;
        if kept {
            next = 1.02 * draws;
        }
        kept
    })
}
