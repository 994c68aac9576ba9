//! The figure of a comparison.

use crate::error::Result;
use crate::numbers::two_digits;
use crate::plot::Marker::{self, Cross, Disc, Ring, Square, Triangle};
use crate::plot::{Axis, Figure, Ink, Panel, Plot, Side, extent};
use crate::trade::{Comparison, Measured, Nature};

/// For each rival an ink, in turn, which implies a dash pattern, and a marker: all differ even in grey.
const INKS: [Ink; 4] = [Ink::Blue, Ink::Vermilion, Ink::Green, Ink::Purple];
const MARKERS: [Marker; 16] = [
    Disc, Square, Triangle, Cross, Ring, Cross, Square, Triangle, Square, Triangle, Disc, Ring, Triangle,
    Disc, Cross, Square,
];

/// The most letters of a name that fit beside a panel.
const LETTERS: usize = 20;

/// The ratio of the ends of the axes of draws, work and time.
const SPAN: f64 = 9e4;

/// A rival with its style.
type Drawn<'a> = (&'a Measured, (Ink, Marker));

/// The root mean square errors √(β² + σ² t/T) of the rivals against draws, work and seconds, and their
/// efficiencies 1/(σ² t), in a panel that also names the lines. An arrow in the panel of seconds spans the
/// factor between the slowest and the fastest at the same error, if it is real and at least 2.
///
/// Work is evaluations if every rival counts them, else random numbers. A rival without a line, for example
/// of infinite variance, is named as well; if a bias is not seen, the line ends at the error below which the
/// bias may dominate. At most sixteen rivals are drawn; the description names those left out. `name` is the
/// file name, `title` says what is compared.
///
/// # Errors
/// If it cannot be drawn.
pub fn comparison(name: &'static str, title: &str, comparison: &Comparison) -> Result<Figure> {
    let ranked: Vec<&Measured> = comparison.remarked().into_iter().map(|(rival, ..)| rival).collect();
    let styles = INKS.into_iter().cycle().zip(MARKERS);
    let drawn: Vec<Drawn<'_>> = ranked.iter().copied().zip(styles).collect();
    let lines: Vec<Drawn<'_>> = drawn
        .iter()
        .copied()
        .filter(|(rival, _)| rival.nature != Nature::InfiniteVariance && rival.varies())
        .collect();
    let axis = if comparison.truth == 0.0 { "RMSE" } else { "RMSE/truth" };
    let against = |heading: &str, unit: &str, cost: &dyn Fn(&Measured) -> f64| {
        panel([heading, unit, axis], &lines, cost)
    };
    let mut time = against("Against time", "seconds on one core", &|rival| rival.seconds);
    speed_up(&mut time, comparison);
    let unit = match comparison.unit_of_work() {
        "evaluations" => "evaluations or rays",
        unit => unit,
    };
    let panels = vec![
        against("Against draws", "draws", &|_| 1.0),
        against("Against work", unit, &|rival| comparison.work(rival)),
        time,
        efficiencies(&drawn, comparison),
    ];
    let names: Vec<&str> = ranked.iter().map(|rival| rival.name.as_str()).collect();
    let (names, left_out) = names.split_at(drawn.len());
    let names = names.join(", ");
    let left_out = if left_out.is_empty() {
        String::new()
    } else {
        format!(" Not drawn, as there are only sixteen kinds of lines: {}.", left_out.join(", "))
    };
    Plot { columns: 2, ..Plot::of(name, 126.0, panels) }.draw(
        title,
        format!(
            "Root mean square error{} against draws, counted work and seconds, all axes logarithmic, and the \
         efficiency as a part of the best one's, for {names}.{left_out} The lines follow from the variance, \
         bias, work and time of a draw as they were measured (seed {}); a line ends where a bias too small \
         to be seen may be larger than the error. An arrow spans the factor in time between the slowest and \
         the fastest without bias at the same error, if the difference is more than three std errors, and at \
         least a factor of 2. Estimators without variance, or of infinite variance, have no line.",
            if comparison.truth == 0.0 { "" } else { " relative to the truth" },
            comparison.seed
        ),
    )
}

/// The error after `spent` units of `cost`, relative to the truth; NaN where a bias that is not seen may be
/// as large.
fn error(rival: &Measured, cost: &dyn Fn(&Measured) -> f64, spent: f64) -> f64 {
    let error = rival.rmse(rival.seconds * spent / cost(rival));
    let known = if rival.bias_seen() { 0.0 } else { rival.bias_range()[1] };
    if error > known && error.is_finite() { error / rival.scale() } else { f64::NAN }
}

/// The errors against `cost`, over five powers of ten.
fn panel([heading, unit, axis]: [&str; 3], lines: &[Drawn<'_>], cost: &dyn Fn(&Measured) -> f64) -> Panel {
    let costs = extent(lines.iter().map(|(rival, _)| cost(rival)));
    let low = costs.map_or(1.0, |[least, _]| 10f64.powf(least.log10().floor() + 1.0));
    let high = low * SPAN;
    let ends = lines.iter().flat_map(|(rival, _)| [low, high].map(|spent| error(rival, cost, spent)));
    let [bottom, top] = match extent(ends) {
        Some([low, high]) if low < high => [10f64.powf(low.log10().floor()), 10f64.powf(high.log10().ceil())],
        _ => [1e-3, 1.0],
    };
    let mut panel = Panel::new(heading, Axis::log(unit, low, high), Axis::log(axis, bottom, top));
    for (index, (rival, (ink, marker))) in lines.iter().enumerate() {
        panel.curve(&rival.name, *ink, |spent| error(rival, cost, spent));
        // one marker per power of ten, shifted from rival to rival so that all show on coinciding lines
        let first = 0.2 + 0.8 * (index as f64 + 0.5) / lines.len() as f64;
        let marked = (0..5).map(|power| low * 10f64.powf(f64::from(power) + first));
        let points: Vec<_> = marked
            .map(|spent| [spent, error(rival, cost, spent)])
            .filter(|[_, error]| error.is_finite())
            .collect();
        panel.marks(&rival.name, *ink, *marker, points);
    }
    panel
}

/// Draws the arrow from the slowest rival's line to the fastest's, at an error that is reached early.
fn speed_up(panel: &mut Panel, comparison: &Comparison) {
    let ranking = comparison.ranking();
    // without those whose variance may be infinite
    let mut lines = ranking.iter().filter(|place| {
        let rival = place.rival;
        rival.nature == Nature::Unbiased && rival.varies() && !rival.heavy_tail
    });
    let Some(best) = lines.next() else { return };
    let Some(worst) = lines.rfind(|place| place.rank > best.rank) else { return };
    let factor = best.rival.efficiency() / worst.rival.efficiency();
    let at = panel.x.low * (panel.x.high / panel.x.low).powf(0.1);
    let error = error(best.rival, &|rival| rival.seconds, at);
    // a shorter arrow would be only a head
    if !(factor.is_finite() && factor >= 2.0 && (panel.y.low..panel.y.high).contains(&error)) {
        return;
    }
    let end = at * factor;
    let (from, text) = if end <= panel.x.high {
        (end, format!("× {}", two_digits(factor)))
    } else {
        // the end is outside the panel: a lower bound, rounded down to a power of ten
        let shown = 10f64.powf((panel.x.high / at).log10().floor());
        (panel.x.high, format!("> × {}", two_digits(shown)))
    };
    panel.arrow(Ink::Black, [from, error], [at, error]);
    panel.label(Ink::Black, [(at * from).sqrt(), error], &text);
}

/// Efficiency divided by the best one's, one row per rival, each with its name, line and marker.
fn efficiencies(drawn: &[Drawn<'_>], comparison: &Comparison) -> Panel {
    let ranking = comparison.ranking();
    let best =
        ranking.iter().find(|place| place.rival.varies()).map_or(f64::NAN, |place| place.rival.efficiency());
    let part = |rival: &Measured| {
        let part = rival.efficiency() / best;
        (part.is_finite() && part > 0.0).then_some(part)
    };
    let [least, most] = extent(drawn.iter().filter_map(|(rival, _)| part(rival))).unwrap_or([1.0; 2]);
    let most = most.max(1.0);
    let least = least.min(0.3 * most);
    // so that even the shortest line shows its dash pattern
    let low = most * (least / most).powf(1.5);
    let row = |index: usize| (drawn.len() - index) as f64;
    let ticks = drawn.iter().enumerate().map(|(index, (rival, _))| (row(index), shortened(&rival.name)));
    let y = Axis::linear("", 0.4, drawn.len() as f64 + 0.6).with_ticks(ticks);
    // in points: the names take part of 213, and the text beside the longest line 66
    let width = 213.0 - y.label_width();
    let high = low * (most / low).powf(width / (width - 66.0));
    let x = Axis::log("efficiency/best", low, high);
    // at most three ticks, where the lines are
    let all: Vec<_> = x.ticks.iter().filter(|(at, _)| *at <= most).cloned().collect();
    let x = x.with_ticks(all.iter().rev().step_by(all.len().div_ceil(3).max(1)).cloned());
    let mut panel = Panel::new("Efficiency", x, y);
    for (index, (rival, (ink, marker))) in drawn.iter().enumerate() {
        let y = row(index);
        match part(rival) {
            Some(part) => {
                let mind = match (rival.nature, rival.doubt()) {
                    (Nature::Biased, _) => ", biased".into(),
                    (_, Some(doubt)) => format!(", {}", doubt.mark()),
                    _ => String::new(),
                };
                panel
                    .line(&rival.name, *ink, [[low, y], [part, y]])
                    .marks(&rival.name, *ink, *marker, [[part, y]])
                    .text(Ink::Black, [part, y], Side::Right, &format!("{}{mind}", two_digits(part)));
            }
            None => {
                let why = rival.doubt().map_or("none", |doubt| doubt.mark());
                panel.text(Ink::Black, [low, y], Side::Right, why);
            }
        }
    }
    panel
}

/// A name that fits beside the panel: its beginning and its end.
fn shortened(name: &str) -> String {
    let letters: Vec<char> = name.chars().collect();
    match (letters.get(..LETTERS / 2), letters.get(letters.len().saturating_sub(LETTERS / 2 - 1)..)) {
        (Some(start), Some(end)) if letters.len() > LETTERS => {
            start.iter().chain(&['…']).chain(end).collect()
        }
        _ => name.into(),
    }
}
