//! Speed against accuracy, drawn.

use super::plot::{Axis, Ink, Marker, Panel, Plot, Side, Width};
use super::{Edition, Figure};
use crate::error::Result;
use crate::trade::{Comparison, Measured, Nature};

/// Up to four rivals.
const STYLES: [(Ink, Marker); 4] = [
    (Ink::Blue, Marker::Disc),
    (Ink::Vermilion, Marker::Square),
    (Ink::Green, Marker::Triangle),
    (Ink::Purple, Marker::Cross),
];

/// The root mean square errors of up to four rivals against draws, against counted work and against seconds, with the factor in time between the best and the worst written
/// on the last. `name` is the file's, `title` says what is compared.
///
/// # Errors
/// If it cannot be drawn.
pub fn trade(name: &'static str, title: &str, comparison: &Comparison) -> Result<Figure> {
    let rivals: Vec<&Measured> =
        comparison.rivals.iter().filter(|rival| rival.nature != Nature::InfiniteVariance).take(4).collect();
    let scale = if comparison.truth == 0.0 { 1.0 } else { comparison.truth.abs() };
    let work =
        |rival: &Measured| if rival.evaluations > 0.0 { rival.evaluations } else { rival.random_numbers };
    let panels = vec![
        panel("Against draws", "draws", &rivals, scale, |_| 1.0),
        panel("Against work", "evaluations or rays", &rivals, scale, work),
        with_speed_up(
            panel("Against time", "seconds on one core", &rivals, scale, |rival| rival.seconds),
            &rivals,
            scale,
        ),
    ];
    let names: Vec<_> = rivals.iter().map(|rival| rival.name.as_str()).collect();
    Plot {
        name,
        title: title.into(),
        description: format!(
            "Root mean square error relative to the truth against draws, counted work and seconds, all axes logarithmic, for {}. The lines follow from the variance, bias, work and time of a draw as they were measured (seed {}); an arrow spans the factor in time between \
             the worst and the best at the same error.",
            names.join(", "),
            comparison.seed
        ),
        edition: Edition::Solution,
        width: Width::Page,
        height_mm: 70.0,
        columns: 3,
        panels,
    }
    .draw()
}

/// The error against `cost`, over five powers of ten.
fn panel(
    heading: &str,
    axis: &str,
    rivals: &[&Measured],
    scale: f64,
    cost: impl Fn(&Measured) -> f64,
) -> Panel {
    let least = rivals.iter().map(|rival| cost(rival)).fold(f64::INFINITY, f64::min);
    let low = 10f64.powf(least.log10().floor() + 1.0);
    let high = low * 9e4;
    let error = |rival: &Measured, c: f64| rival.rmse(rival.seconds * c / cost(rival)) / scale;
    let visible = |error: f64| error.is_finite() && error > 0.0;
    let ends =
        rivals.iter().flat_map(|rival| [error(rival, low), error(rival, high)]).filter(|e| visible(*e));
    let (bottom, top) =
        ends.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), e| (low.min(e), high.max(e)));
    // two powers of ten above the curves leave room for their names
    let room = if heading == "Against draws" { 100.0 } else { 1.0 };
    let (bottom, top) = if bottom < top {
        (10f64.powf(bottom.log10().floor()), room * 10f64.powf(top.log10().ceil()))
    } else {
        (1e-3, 1.0)
    };
    let mut panel = Panel::new(heading, Axis::log(axis, low, high), Axis::log("RMSE/truth", bottom, top));
    for (index, (rival, (ink, _))) in rivals.iter().zip(STYLES).enumerate() {
        panel.curve(&rival.name, ink, |c| if visible(error(rival, c)) { error(rival, c) } else { f64::NAN });
        // names where the curves have fallen away, in the first panel alone
        if heading == "Against draws" {
            let row = 0.97 - 0.075 * index as f64;
            panel.text(ink, [high, bottom * (top / bottom).powf(row)], Side::Left, &rival.name);
        }
    }
    panel
}

fn with_speed_up(mut panel: Panel, rivals: &[&Measured], scale: f64) -> Panel {
    let unbiased = || rivals.iter().filter(|rival| rival.nature == Nature::Unbiased && rival.varies());
    let cost = |rival: &Measured| rival.variance() * rival.seconds;
    let best = unbiased().min_by(|a, b| cost(a).total_cmp(&cost(b)));
    let worst = unbiased().max_by(|a, b| cost(a).total_cmp(&cost(b)));
    let (Some(best), Some(worst)) = (best, worst) else { return panel };
    let factor = cost(worst) / cost(best);
    if factor < 1.05 {
        return panel;
    }
    // at the error that the best reaches near the left end
    let at = panel.x.low * (panel.x.high / panel.x.low).powf(0.1);
    let error = best.rmse(at) / scale;
    panel.arrow(Ink::Black, [(at * factor).min(panel.x.high), error], [at, error]);
    let middle = at * factor.min(panel.x.high / at).sqrt();
    let places = if factor < 10.0 { 1 } else { 0 };
    panel.text(Ink::Black, [middle, error], Side::Above, &format!("× {factor:.places$}"));
    panel
}
