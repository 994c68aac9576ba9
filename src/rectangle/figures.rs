//! Figures of section 2.

use crate::error::Result;
use crate::estimator::{Estimator, from_fn};
use crate::numbers::typeset;
use crate::plot::{Axis, Figure, Ink, Marker, Panel, Plot, Side, extent};
use crate::rectangle::{Integrand, Rectangle};
use crate::run::{Budget, estimate};

/// The numbers of evaluations at which a curve is measured: 4ᵏ, from 4 to 4⁷.
const EVALUATIONS: [u64; 7] = [4, 16, 64, 256, 1024, 4096, 16384];

/// The x at which the labels of the curves begin.
const LAST_X: f64 = 30e3;

/// The number of estimates for each measured RMSE, which is then accurate to about 1/√(2 · 200) = 5 %.
const REPEATS: u64 = 200;

/// One curve: (evaluations, RMSE) measured, and the exact standard error where it is known.
struct Curve {
    label: String,
    ink: Ink,
    marker: Marker,
    measured: Vec<[f64; 2]>,
    exact: Option<Vec<[f64; 2]>>,
}

impl Curve {
    /// Measures the RMSE of the estimator `of(n)` about `truth` for each number of evaluations n.
    fn measure<E: Estimator>(
        (label, ink, marker): (&str, Ink, Marker),
        truth: f64,
        seed: u64,
        of: impl Fn(u64) -> Result<E>,
    ) -> Result<Self> {
        let mut measured = Vec::new();
        for n in EVALUATIONS {
            let repeats = estimate(&of(n)?, Budget::Draws(REPEATS), seed)?;
            // √(1/R Σ (Fᵢ − F)²), computed from the std error √(1/(R (R − 1)) Σ (Fᵢ − F̄)²), whose squares do
            // not overflow
            let spread = repeats.std_error().unwrap_or(0.0) * (REPEATS as f64 - 1.0).sqrt();
            measured.push([n as f64, spread.hypot(repeats.mean() - truth)]);
        }
        measured.retain(on_a_logarithmic_axis);
        Ok(Self { label: label.into(), ink, marker, measured, exact: None })
    }

    fn exact(mut self, std_error: impl Fn(f64) -> Option<f64>) -> Self {
        let points = EVALUATIONS.map(|n| std_error(n as f64).map(|error| [n as f64, error]));
        self.exact = points.into_iter().map(|point| point.filter(on_a_logarithmic_axis)).collect();
        self
    }

    fn end(&self) -> f64 {
        self.exact.as_ref().unwrap_or(&self.measured).last().map_or(1.0, |[_, y]| *y)
    }
}

fn on_a_logarithmic_axis([_, y]: &[f64; 2]) -> bool {
    *y > 0.0 && y.is_finite()
}

/// Figure for 2.1: RMSE against the number of evaluations, for the test set with independent pairs, and for
/// the Gaussian with each of the four point sets.
///
/// Lines are exact where a closed form exists, and join the measured points otherwise. Integrands whose
/// integral over this rectangle is not known are left out.
///
/// # Errors
/// If an estimator cannot be run on this rectangle.
pub fn sampling_errors(rectangle: Rectangle, seed: u64) -> Result<Figure> {
    let bell = |x: f64, y: f64| Integrand::Gaussian.at(x, y);
    let styles = [
        (Integrand::Paraboloid, Ink::Blue, Marker::Disc),
        (Integrand::Product, Ink::Vermilion, Marker::Ring),
        (Integrand::Disc, Ink::Green, Marker::Square),
        (Integrand::Gaussian, Ink::Purple, Marker::Triangle),
        (Integrand::InverseDistance, Ink::Black, Marker::Cross),
    ];
    let mut test_set = Vec::new();
    for (f, ink, marker) in styles {
        let Some(truth) = f.integral(&rectangle).filter(|truth| truth.is_finite()) else { continue };
        let variance = f.variance(&rectangle).filter(|variance| variance.is_finite());
        let infinite = f.variance(&rectangle) == Some(f64::INFINITY);
        let label = if infinite { format!("{f}\ninfinite variance") } else { f.to_string() };
        let curve = Curve::measure((&label, ink, marker), truth, seed, |n| Ok(mean_of(rectangle, f, n)))?;
        test_set.push(curve.exact(|n| Some((variance? / n).sqrt())));
    }
    let mut ways = Vec::new();
    if let Some(truth) = Integrand::Gaussian.integral(&rectangle) {
        let variance = Integrand::Gaussian.variance(&rectangle);
        let root = |n: u64| n.isqrt();
        let pairs = |n: f64| Integrand::Gaussian.all_pairs_variance(&rectangle, root(n as u64));
        let all_pairs = ("all pairs\nslope −1/4", Ink::Vermilion, Marker::Ring);
        let independent = ("independent\nslope −1/2", Ink::Blue, Marker::Disc);
        let jittered = ("jittered\nslope −1", Ink::Green, Marker::Square);
        let sobol = ("Sobol\nslope near −3/2", Ink::Purple, Marker::Triangle);
        ways = vec![
            Curve::measure(all_pairs, truth, seed, |n| rectangle.all_pairs(bell, root(n)))?
                .exact(|n| pairs(n).map(f64::sqrt)),
            Curve::measure(independent, truth, seed, |n| Ok(mean_of(rectangle, Integrand::Gaussian, n)))?
                .exact(|n| Some((variance? / n).sqrt())),
            Curve::measure(jittered, truth, seed, |n| rectangle.jittered(bell, root(n)))?,
            Curve::measure(sobol, truth, seed, |n| rectangle.sobol(bell, n))?,
        ];
    }
    for curves in [&mut test_set, &mut ways] {
        curves.retain(|curve| !curve.measured.is_empty());
    }
    let mut left = panel("Independent pairs", &test_set);
    guide(&mut left, &test_set);
    let right = panel("e^(−x²−y²), points placed four ways", &ways);
    let over = product(&rectangle);
    let title =
        "Errors against evaluations: four times the pairs halve the error, better placed points do more";
    Plot::of("2_1_rmse", 92.0, vec![left, right]).draw(
        title,
        format!(
            "Two panels on logarithmic axes, for {over}. Left: the root-mean-square error \
             of n independent pairs for each function of the test set, measured over {REPEATS} estimates \
             (marks), on the exact lines of slope −1/2; where the variance is infinite, as for 1/√(x² + y²) \
             about the origin, the marks follow no such line. Right: the Gaussian by independent pairs \
             (slope −1/2), all pairs (−1/4 in evaluations), jittered points (−1) and scrambled Sobol points \
             (nearly −3/2). Seed {seed}."
        ),
    )
}

/// “[a, b] × [c, d]”
fn product(rectangle: &Rectangle) -> String {
    let ends = [rectangle.x_range(), rectangle.y_range()];
    ends.map(|ends| format!("[{}]", ends.map(|end| typeset(end, 12)).join(", "))).join(" × ")
}

/// ⟨Fₙ⟩ = A/n Σ f(Xᵢ, Yᵢ) as one draw.
fn mean_of(rectangle: Rectangle, f: Integrand, n: u64) -> impl Estimator {
    let one = rectangle.independent(move |x, y| f.at(x, y));
    from_fn(move |rng| (0..n).map(|_| one.draw(rng)).sum::<f64>() / n as f64)
}

/// A panel that holds all curves, with room for their labels on the right.
fn panel(heading: &str, curves: &[Curve]) -> Panel {
    let all = curves.iter().flat_map(|curve| curve.measured.iter().chain(curve.exact.iter().flatten()));
    let [low, high] = extent(all.map(|[_, y]| *y)).map_or([0.1, 10.0], |[low, high]| [low * 0.3, high * 1.5]);
    let ticks = [(1.0, "1"), (10.0, "10"), (100.0, "10²"), (1000.0, "10³"), (1e4, "10⁴")];
    let mut panel = Panel::new(
        heading,
        Axis::log("evaluations of f (dimensionless)", 3.0, 8e6).with_ticks(ticks),
        Axis::log("RMSE (units of ∫∫ f dx dy)", low, high),
    );
    for curve in curves {
        let drawn = curve.exact.as_ref().unwrap_or(&curve.measured);
        let series = if curve.exact.is_some() { "exact" } else { "measured" };
        let name = curve.label.replace('\n', ", ");
        panel.line(&format!("{name}, {series}"), curve.ink, drawn.clone());
        panel.marks(&format!("{name}, measured"), curve.ink, curve.marker, curve.measured.clone());
    }
    // a label stands at its curve's end, or as close as the other labels allow; its marker says whose it is
    let mut by_height: Vec<_> = curves.iter().collect();
    by_height.sort_by(|a, b| a.end().total_cmp(&b.end()));
    const LINE: f64 = 0.05;
    let wanted: Vec<_> = by_height
        .iter()
        .map(|curve| (panel.y.place(curve.end()), LINE * curve.label.lines().count() as f64))
        .collect();
    for (curve, middle) in by_height.iter().zip(apart(&wanted)) {
        let end = [16_384.0, curve.end()];
        let [_, y] = panel.spot(0.0, middle);
        panel.line("name", Ink::Grey, [end, [LAST_X, y]]).marks(
            "",
            curve.ink,
            curve.marker,
            [[1.2 * LAST_X, y]],
        );
        let lines = curve.label.lines().count() as f64;
        for (line, text) in curve.label.lines().enumerate() {
            let [_, y] = panel.spot(0.0, middle + LINE * (0.5 * (lines - 1.0) - line as f64));
            panel.text(curve.ink, [1.25 * LAST_X, y], Side::Right, text);
        }
    }
    panel
}

/// Places labels, given as (wanted middle, height) and sorted, as close to the wanted middles as they fit
/// without overlap. Labels that would overlap form a block centred on the mean of their wanted positions.
fn apart(wanted: &[(f64, f64)]) -> Vec<f64> {
    // blocks of touching labels: their number, their height, and the sum of the block starts that they want
    let mut blocks: Vec<(usize, f64, f64)> = Vec::new();
    let begins = |&(count, _, sum): &(usize, f64, f64)| sum / count as f64;
    for &(middle, height) in wanted {
        let mut block = (1, height, middle - 0.5 * height);
        while let Some(below) = blocks.pop_if(|below| begins(below) + below.1 > begins(&block)) {
            block = (below.0 + block.0, below.1 + block.1, below.2 + block.2 - block.0 as f64 * below.1);
        }
        blocks.push(block);
    }
    let mut heights = wanted.iter().map(|(_, height)| height);
    let mut middles = Vec::new();
    for block in &blocks {
        let mut at = begins(block).clamp(0.0, (1.0 - block.1).max(0.0));
        for height in heights.by_ref().take(block.0) {
            middles.push(at + 0.5 * height);
            at += height;
        }
    }
    middles
}

/// A line of slope −1/2 below the curves.
fn guide(panel: &mut Panel, curves: &[Curve]) {
    if let Some([lowest, _]) = extent(curves.iter().map(Curve::end)) {
        let at = |n: f64| [n, 0.5 * lowest * (16384.0 / n).sqrt()];
        panel.line("slope −1/2", Ink::Grey, [at(4.0), at(16384.0)]);
        panel.text(Ink::Grey, at(600.0), Side::Left, "slope −1/2");
    }
}

/// Figure for 2.1: the running mean of A e^(−x²−y²) with its 95 % interval, for three seeds.
///
/// # Errors
/// If it cannot be drawn.
pub fn running_means(rectangle: Rectangle, seed: u64) -> Result<Figure> {
    let bell = rectangle.independent(|x, y| Integrand::Gaussian.at(x, y));
    let truth = Integrand::Gaussian.integral(&rectangle).unwrap_or(f64::NAN);
    // 0.4 standard deviations, the half width of the interval at about n = 25
    let spread = Integrand::Gaussian.variance(&rectangle).unwrap_or(1.0).sqrt();
    // the smallest range, for f nearly constant
    let least = 1e-4 * truth.abs();
    let reach = if spread.is_finite() && spread.max(least) > 0.0 { (0.4 * spread).max(least) } else { 1.0 };
    let (first, last) = (10.0, 1e5);
    let mut panels = Vec::new();
    for seed in (0..3).map(|i| seed.wrapping_add(i)) {
        let (mut means, mut band) = (Vec::new(), Vec::new());
        for i in 0..=80 {
            let n = (first * f64::powf(last / first, f64::from(i) / 80.0)).round();
            let estimate = estimate(&bell, Budget::Draws(n as u64), seed)?;
            let [low, high] = estimate.confidence_interval(0.95)?;
            means.push([n, estimate.mean()]);
            band.push([n, low, high]);
        }
        let x = Axis::log("n pairs (dimensionless)", first, last);
        let y = Axis::linear("mean of area × f(X, Y)", truth - reach, truth + reach);
        let mut panel = Panel::new(&format!("Seed {seed}"), x, y);
        panel.band("95 % interval", Ink::Blue, band).level("truth", Ink::Black, truth).line(
            "mean of n",
            Ink::Blue,
            means,
        );
        if panels.is_empty() {
            let truth = format!("thin line: {}", typeset(truth, 6));
            panel
                .note(Ink::Black, [1.0, 0.24], Side::Left, &truth)
                .note(Ink::Blue, [1.0, 0.15], Side::Left, "band: 95 % interval")
                .note(Ink::Blue, [1.0, 0.06], Side::Left, "from s/√n so far");
        }
        panels.push(panel);
    }
    let over = product(&rectangle);
    let title = "Three runs of the same estimator close in on the truth, as fast as their own error bars say";
    Plot::of("2_1_running_mean", 62.0, panels).draw(
        title,
        format!(
            "Three panels, one for each seed: the mean of n independent draws of area × e^(−X²−Y²) over \
             {over} against n from 10 to 100 000 on a logarithmic axis, with its 95 % interval, which \
             narrows as 1/√n; a thin line marks the truth, {}.",
            typeset(truth, 6)
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_move_no_further_than_they_must() {
        assert_eq!(apart(&[(0.2, 0.1), (0.5, 0.1)]), [0.2, 0.5]);
        let moved = apart(&[(0.2, 0.1), (0.5, 0.1), (0.5, 0.1), (0.5, 0.2)]);
        let middle = 0.5 * (moved[1] - 0.05 + moved[3] + 0.1);
        assert!(moved[0] == 0.2 && (0.45..0.55).contains(&middle), "{moved:?}");
        for (pair, gap) in moved.windows(2).zip([0.1, 0.1, 0.15]) {
            assert!(pair[1] - pair[0] >= gap - 1e-12, "{moved:?}");
        }
        let inside = apart(&[(0.0, 0.1), (1.0, 0.1)]);
        assert!((inside[0] - 0.05).abs() < 1e-12 && (inside[1] - 0.95).abs() < 1e-12, "{inside:?}");
    }
}
