//! Shows values in a Jupyter notebook with [evcxr](https://github.com/evcxr/evcxr)'s Rust kernel.
//!
//! A cell that ends in a [`Figure`], an [`Estimate`], a verdict of [`check`], a [`Table`] or a [`Comparison`]
//! shows it as HTML, or as plain text if the viewer cannot show HTML: the kernel calls the type's
//! `evcxr_display`. A figure is an image with its title and description as alternative text. The worksheet's
//! five notebooks are in `notebooks/`.

use std::fmt::Write as _;
use std::io::{self, Write as _};

use base64::prelude::{BASE64_STANDARD, Engine as _};
use maud::{Markup, html};
pub use rand::distr::Distribution;

use crate::check::{self, Agreement, Attempt, Diagnosis, Exact, Exercise, Finding, Report, Verdict};
use crate::error::{Error, Result};
use crate::estimate::Estimate;
use crate::numbers::{duration, plus_minus, shortened, std_errors, two_digits};
use crate::plot::Figure;
use crate::run::{Budget, Outcome, Run};
use crate::trade::Comparison;
use crate::workbook::{Judgement, Table, told_once};

/// How a value looks in a notebook.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shown {
    plain: String,
    html: String,
}

impl Shown {
    fn new(plain: String, markup: Markup) -> Self {
        Self { plain, html: markup.into_string() }
    }

    /// A sentence after a mark: ✓ for true, ✗ for false, ? for none.
    fn verdict(good: Option<bool>, sentence: &str) -> Self {
        Self::new(sentence.into(), said(good, sentence))
    }

    /// As plain text, for viewers that cannot show HTML.
    pub fn plain(&self) -> &str {
        &self.plain
    }

    /// As HTML.
    pub fn html(&self) -> &str {
        &self.html
    }

    /// Writes it to standard output between the marker lines that the kernel looks for.
    fn print(&self) {
        let mut out = String::new();
        for (kind, content) in [("text/plain", &self.plain), ("text/html", &self.html)] {
            // writing to a String cannot fail
            let _ = writeln!(out, "EVCXR_BEGIN_CONTENT {kind}\n{}\nEVCXR_END_CONTENT", content.trim());
        }
        // standard output is closed: nothing can be done
        let _ = io::stdout().write_all(out.as_bytes());
    }
}

/// A value that a notebook can show.
///
/// ```
/// use unbiased::{Estimate, notebook::Show};
///
/// assert_eq!(Estimate::from_draws(&[1.0, 2.0, 3.0, 4.0]).show().plain(), "2.5 ± 2.1 (95 %, 4 draws)");
/// ```
pub trait Show {
    /// How it looks.
    fn show(&self) -> Shown;
}

/// The kernel calls a method of this name on a cell's last value. It is inherent because a trait would have
/// to be imported in every notebook.
macro_rules! displayed {
    ($($kind:ty),*) => {
        $(impl $kind {
            /// Shows it below a notebook's cell.
            pub fn evcxr_display(&self) {
                self.show().print();
            }
        })*
    };
}

displayed!(
    Figure, Estimate, Outcome, Report, Diagnosis, Judgement, Agreement, Exact, Table, Comparison, Checked
);

impl Show for Figure {
    fn show(&self) -> Shown {
        // not inline SVG: viewers give it no alternative text, and some do not show it
        let image = format!("data:image/svg+xml;base64,{}", BASE64_STANDARD.encode(self.svg()));
        let alt = format!("{}. {}", self.title(), self.description());
        Shown::new(self.title().into(), html! { img alt=(alt) src=(image); })
    }
}

impl Show for Estimate {
    fn show(&self) -> Shown {
        interval(self, &format!("{} draws", self.draws()))
    }
}

impl Show for Outcome {
    fn show(&self) -> Shown {
        let Self { estimate, seed, cost, .. } = self;
        // seconds are left out: they differ from run to run
        let work = format!(
            "{} draws, {} random numbers, {} evaluations, seed {seed}",
            estimate.draws(),
            cost.random_numbers,
            cost.evaluations
        );
        interval(estimate, &work)
    }
}

/// An estimate, and the work behind it.
fn interval(estimate: &Estimate, work: &str) -> Shown {
    let (interval, level) = match estimate.reach() {
        Some(reach) => (plus_minus(estimate.mean(), reach), "95 %, "),
        None => (estimate.to_string(), ""),
    };
    Shown::new(
        format!("{interval} ({level}{work})"),
        html! { b { (interval) } span style=(FAINT) { " (" (level) (work) ")" } },
    )
}

impl Show for Report {
    fn show(&self) -> Shown {
        let good = match self.verdict {
            Verdict::Unbiased => Some(true),
            Verdict::Biased => Some(false),
            Verdict::Undecided => None,
        };
        Shown::verdict(good, &self.to_string())
    }
}

impl Show for Judgement {
    fn show(&self) -> Shown {
        let good = match self {
            Self::Right => Some(true),
            Self::TooFewDigits { .. } => None,
            Self::LooksLike(_) | Self::Unknown { .. } => Some(false),
        };
        Shown::verdict(good, &self.to_string())
    }
}

impl Show for Agreement {
    fn show(&self) -> Shown {
        Shown::verdict(Some(self.agrees), &self.to_string())
    }
}

impl Show for Exact {
    fn show(&self) -> Shown {
        let said = format!("mean {:.9}, variance {:.9}, by quadrature", self.mean, self.variance);
        Shown::new(said.clone(), html! { (said) })
    }
}

impl Show for Diagnosis {
    fn show(&self) -> Shown {
        let plain = self.to_string();
        let markup = html! {
            @for (index, line) in plain.lines().enumerate() {
                @if index == 0 {
                    (said(good(self), line))
                } @else {
                    div style=(if line.starts_with("  ") { "margin-left: 2em" } else { "margin-left: \
                        1em" }) { (line.trim_start()) }
                }
            }
        };
        Shown::new(plain, markup)
    }
}

impl Show for Table {
    fn show(&self) -> Shown {
        let plain = format!("{}\n{}", self.caption, self.lines().join("\n"));
        let markup = html! {
            table {
                caption style="text-align: left" { (self.caption) }
                thead { tr { @for name in &self.columns { th style=(LEFT) { (name) } } } }
                tbody { @for row in &self.rows { tr { @for cell in row { td style=(LEFT) { (cell) } } } } }
            }
        };
        Shown::new(plain, markup)
    }
}

/// The time of a draw, the error after a second, the time to reach an error, the efficiency and remarks: the
/// unbiased rivals by rank, then the biased ones.
impl Show for Comparison {
    fn show(&self) -> Shown {
        let relative = self.truth != 0.0;
        let rows = self.remarked().into_iter().map(|(rival, place, remark)| {
            let to = |error| rival.seconds_to(error).to_string();
            let after = rival.rmse(1.0) / rival.scale();
            let after = match after {
                error if error.is_infinite() => "∞".into(),
                error if relative => format!("{} %", two_digits(100.0 * error)),
                error => two_digits(error),
            };
            let efficiency = place.map_or(String::new(), |place| two_digits(place.of_the_best));
            vec![rival.name.clone(), duration(rival.seconds), after, to(1e-3), to(1e-4), efficiency, remark]
        });
        let [to_3, to_4] =
            if relative { ["to 0.1 %", "to 0.01 %"] } else { ["to 10⁻³ (absolute)", "to 10⁻⁴"] };
        let columns = ["estimator", "a draw", "error after 1 s", to_3, to_4, "efficiency", "remark"];
        Table::new("What a second buys, on one core of the machine that ran this", columns, rows).show()
    }
}

/// A table of several estimates of one truth.
///
/// ```
/// use unbiased::{Budget, estimate, from_fn, notebook};
///
/// let one = estimate(&from_fn(|rng| 2.0 * rng.uniform()), Budget::Draws(1000), 1)?;
/// let table = notebook::against(1.0, &[("2U", one)]);
/// assert_eq!(table.rows.len(), 1);
/// # Ok::<(), unbiased::Error>(())
/// ```
pub fn against(truth: f64, estimates: &[(&str, Estimate)]) -> Table {
    let minus = |number: String| number.replace('-', "−");
    let rows = estimates.iter().map(|(name, estimate)| {
        let ratio =
            if truth == 0.0 { String::new() } else { minus(format!("{:.3}", estimate.mean() / truth)) };
        let z = estimate.z(truth).map_or_else(String::new, std_errors);
        vec![
            (*name).into(),
            minus(
                estimate
                    .reach()
                    .map_or_else(|| estimate.to_string(), |reach| plus_minus(estimate.mean(), reach)),
            ),
            ratio,
            z,
            estimate.draws().to_string(),
        ]
    });
    let caption = minus(format!("The truth is {}", shortened(truth)));
    Table::new(&caption, ["", "mean ± 95 %", "over the truth", "std errors off", "draws"], rows)
}

/// The result of checking your own estimator.
#[derive(Debug, Clone)]
pub enum Checked {
    /// The estimator is not written yet: its first draw is NaN.
    Missing(&'static Exercise),
    /// The diagnosis from its ratios to the truth.
    Found(Diagnosis),
}

/// Draws per probe: ratios are then accurate to about 0.25 %.
const DRAWS: u64 = 200_000;

/// Half-width, in std errors, of the interval reported for a ratio.
const CERTAIN: f64 = 5.0;

/// Tries an estimator on all probes of its exercise, with 200,000 draws each: it is missing, or consistent
/// with a classic mistake, or unbiased up to a stated difference.
///
/// ```
/// use unbiased::check::{Attempt, Finding};
/// use unbiased::inversion::mistakes::Samples;
/// use unbiased::notebook::{Checked, check_mine};
///
/// let unwritten = Attempt::new(|_: &Samples, _| f64::NAN);
/// assert!(matches!(check_mine(&unwritten)?, Checked::Missing(_)));
///
/// let multiplied = Attempt::new(|p: &Samples, rng| -p.rate * (1.0 - rng.uniform()).ln());
/// let Checked::Found(diagnosis) = check_mine(&multiplied)? else { panic!() };
/// assert_eq!(diagnosis.finding, Finding::Known);
/// # Ok::<(), unbiased::Error>(())
/// ```
///
/// # Errors
/// If a draw other than the first is not finite.
pub fn check_mine(mine: &Attempt<'_>) -> Result<Checked> {
    let on = |probe| {
        let run = Run::new(check::seed_of(probe, 1));
        told_once(probe, || mine.measure(probe, &run, Budget::Draws(DRAWS)))
    };
    let measured: Result<Vec<_>> = mine.exercise.probes.iter().map(on).collect();
    match measured {
        Ok(measured) => {
            let measured: Vec<_> = measured.into_iter().map(|(measurement, _)| measurement).collect();
            Ok(Checked::Found(check::diagnose(&measured)?.shown_by(mine)))
        }
        Err(Error::OnProbe { first: true, value, .. }) if value.is_nan() => {
            Ok(Checked::Missing(mine.exercise))
        }
        Err(error) => Err(error),
    }
}

impl Checked {
    /// If nothing is wrong: the largest relative difference from the truth, over all probes, within five std
    /// errors of the measured means.
    pub fn within(&self) -> Option<f64> {
        match self {
            Self::Found(diagnosis) if diagnosis.finding == Finding::NothingWrong => {
                let measurements = diagnosis.measurements.iter();
                let off = measurements.map(|measurement| {
                    let ratio = measurement.ratio();
                    (ratio.mean - measurement.probe.right_ratio()).abs() + CERTAIN * ratio.error
                });
                Some(off.fold(0.0, f64::max))
            }
            _ => None,
        }
    }
}

impl Show for Checked {
    fn show(&self) -> Shown {
        let diagnosis = match self {
            Self::Missing(exercise) => {
                let what = exercise.name;
                return Shown::verdict(
                    None,
                    &format!("Missing: there is no estimator of “{what}” yet; its draw is NaN."),
                );
            }
            Self::Found(diagnosis) => diagnosis,
        };
        let Shown { plain, html } = diagnosis.show();
        let Some(within) = self.within() else { return Shown { plain, html } };
        let sentence = format!(
            "Unbiased within {:.2} % on every probe, {CERTAIN} std errors counted in.",
            100.0 * within
        );
        let html = said(Some(true), &sentence).into_string() + &html;
        Shown { plain: format!("{sentence}\n{plain}"), html }
    }
}

fn good(diagnosis: &Diagnosis) -> Option<bool> {
    match diagnosis.finding {
        Finding::NothingWrong => Some(true),
        Finding::Known | Finding::Unknown => Some(false),
        Finding::Unclear => None,
    }
}

const LEFT: &str = "text-align: left";
const FAINT: &str = "opacity: 0.7";

/// A sentence after its mark; the bar's colour only repeats the mark.
fn said(good: Option<bool>, sentence: &str) -> Markup {
    let (mark, colour) = match good {
        Some(true) => ("✓", "#009E73"),
        Some(false) => ("✗", "#D55E00"),
        None => ("?", "#888888"),
    };
    html! { div style=(format!("border-left: 4px solid {colour}; padding-left: \
    0.6em")) { b { (mark) } " " (sentence) } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lambertian::hemisphere::Hemisphere;
    use crate::lambertian::mistakes::Reflection;
    use crate::roulette::mistakes::NumberOfBounces;
    use crate::stream::Stream;

    #[test]
    fn every_kind_has_plain_text_and_html() {
        let figure = crate::lambertian::figures::integrand().unwrap();
        let shown = figure.show();
        let image = format!("src=\"data:image/svg+xml;base64,{}\"", BASE64_STANDARD.encode(figure.svg()));
        assert!(shown.html().contains(&image));
        assert!(shown.html().starts_with("<img alt=\"cos θ sin θ has area ½"), "{}", shown.html());
        assert!(shown.html().contains(&format!(". {}\"", figure.description())));
        assert_eq!(shown.plain(), figure.title());

        let table = against(0.0, &[("<b>", Estimate::from_draws(&[-1.0, 2.0]))]);
        let shown = table.show();
        assert!(shown.html().contains("&lt;b&gt;") && !shown.html().contains("<b>"), "{}", shown.html());
        assert!(shown.plain().contains("0 ± 19"), "{}", shown.plain());
    }

    #[test]
    fn numbers_are_short() {
        for (seconds, shown) in
            [(1.4e-9, "1.4 ns"), (2.51e-5, "25 µs"), (0.9, "900 ms"), (1.25, "1.2 s"), (3500.4, "3500 s")]
        {
            assert_eq!(duration(seconds), shown);
        }
        for (x, shown) in [(0.0, "0"), (0.00012345, "0.00012"), (-13.4, "-13"), (f64::INFINITY, "∞")] {
            assert_eq!(two_digits(x), shown);
        }
    }

    #[test]
    fn the_three_states_of_ones_own_estimator() {
        let state = |attempt: &Attempt<'_>| check_mine(attempt).unwrap().show().plain().to_owned();
        assert!(state(&Attempt::new(|_: &NumberOfBounces, _| f64::NAN)).starts_with("Missing"));
        let wrong = |p: &Reflection, rng: &mut _| p.albedo * p.light(&Hemisphere::Uniform.sample(rng));
        let said = state(&Attempt::new(wrong));
        assert!(
            said.starts_with("Not right.") && said.contains("uniform directions, the cosine weight"),
            "{said}"
        );
        let right = |p: &Reflection, rng: &mut _| p.albedo * p.light(&Hemisphere::Cosine.sample(rng));
        let checked = check_mine(&Attempt::new(right)).unwrap();
        // the largest spread of a ratio is √15: five std errors are below 4.4 %
        let within = checked.within().unwrap();
        assert!(within > 0.0 && within <= 0.06, "{within}");
        assert!(checked.show().plain().starts_with("Unbiased within"));
        // NaN in a later draw is a fault of the estimator, not a missing one
        let late = |_: &NumberOfBounces, rng: &mut Stream| {
            if rng.random_numbers() > 5 { f64::NAN } else { rng.uniform() }
        };
        let late = check_mine(&Attempt::new(late)).unwrap_err().to_string();
        assert_eq!(late, "on the probe “p_rr = 0.8” a draw is NaN: an estimate needs finite draws");
        let panics = |_: &NumberOfBounces, _: &mut Stream| panic!("no such thing");
        let told = check_mine(&Attempt::new(panics)).unwrap_err().to_string();
        assert!(
            told.starts_with("on the probe “p_rr = 0.8” the estimator panics: no such thing (src"),
            "{told}"
        );
    }
}
