//! Shows values in a Jupyter notebook with [evcxr](https://github.com/evcxr/evcxr)'s Rust kernel.
//!
//! A cell that ends in a [`Figure`], an [`Estimate`], a verdict of [`check`], a [`Table`] or a [`Comparison`]
//! shows it as HTML, or as plain text if the viewer cannot show HTML: the kernel calls the type's
//! `evcxr_display`. A figure is an image with its title and description as alternative text. The worksheet's
//! five notebooks are in `notebooks/`.

use std::fmt;
use std::io::{self, Write as _};

use base64::prelude::{BASE64_STANDARD, Engine as _};
use maud::{Markup, html};
pub use rand::distr::Distribution;

use crate::check::{self, Agreement, Attempt, Diagnosis, Exact, Finding, Report, Verdict};
use crate::error::{Error, Result};
use crate::estimate::Estimate;
use crate::numbers::{duration, shortened, std_errors, two_digits};
use crate::plot::Figure;
use crate::run::{Budget, Outcome, Run};
use crate::trade::Comparison;
use crate::workbook::{Judgement, Table, interval, told_once};

/// How a value looks in a notebook; as plain text it displays.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shown {
    plain: String,
    html: String,
}

impl Shown {
    fn new(plain: impl Into<String>, markup: Markup) -> Self {
        Self { plain: plain.into(), html: markup.into_string() }
    }

    /// A sentence after a mark: ✓ for true, ✗ for false, ? for none.
    fn verdict(good: Option<bool>, sentence: impl ToString) -> Self {
        let sentence = sentence.to_string();
        let markup = said(good, &sentence);
        Self::new(sentence, markup)
    }
}

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.plain)
    }
}

/// The method that the kernel calls on a cell's last value. It is inherent because a trait would have to be
/// imported in every notebook.
macro_rules! displayed {
    ($($kind:ty => $shown:expr),* $(,)?) => {
        $(impl $kind {
            /// Shows it below a notebook's cell.
            pub fn evcxr_display(&self) {
                let shown: fn(&Self) -> Shown = $shown;
                let Shown { plain, html } = shown(self);
                // the marker lines that the kernel looks for
                let marked = |kind: &str, content: &str| {
                    format!("EVCXR_BEGIN_CONTENT {kind}\n{}\nEVCXR_END_CONTENT\n", content.trim())
                };
                let out = marked("text/plain", &plain) + &marked("text/html", &html);
                // standard output is closed: nothing can be done
                let _ = io::stdout().write_all(out.as_bytes());
            }
        })*
    };
}

displayed! {
    Shown => Shown::clone,
    Figure => figure,
    Estimate => |estimate| with_work(estimate, &format!("{} draws", estimate.draws())),
    Outcome => outcome,
    Exact => |of| {
        let said = format!("mean {:.9}, variance {:.9}, by quadrature", of.mean, of.variance);
        Shown::new(&said, html! { (said) })
    },
    Table => table,
    Comparison => comparison,
    Diagnosis => diagnosis,
    Agreement => |agreement| Shown::verdict(Some(agreement.agrees), agreement),
    Report => |report| {
        let good = match report.verdict {
            Verdict::Unbiased => Some(true),
            Verdict::Biased => Some(false),
            Verdict::Undecided => None,
        };
        Shown::verdict(good, report)
    },
    Judgement => |judgement| {
        let good = match judgement {
            Judgement::Right => Some(true),
            Judgement::TooFewDigits { .. } => None,
            Judgement::LooksLike(_) | Judgement::Unknown { .. } => Some(false),
        };
        Shown::verdict(good, judgement)
    },
}

fn figure(figure: &Figure) -> Shown {
    // not inline SVG: viewers give it no alternative text, and some do not show it
    let image = format!("data:image/svg+xml;base64,{}", BASE64_STANDARD.encode(figure.svg()));
    let alt = format!("{}. {}", figure.title(), figure.description());
    Shown::new(figure.title(), html! { img alt=(alt) src=(image); })
}

fn outcome(outcome: &Outcome) -> Shown {
    let Outcome { estimate, seed, cost, .. } = outcome;
    // seconds are left out: they differ from run to run
    let work = format!(
        "{} draws, {} random numbers, {} evaluations, seed {seed}",
        estimate.draws(),
        cost.random_numbers,
        cost.evaluations
    );
    with_work(estimate, &work)
}

/// An estimate, and the work behind it.
fn with_work(estimate: &Estimate, work: &str) -> Shown {
    let (interval, level) = (interval(estimate), if estimate.reach().is_some() { "95 %, " } else { "" });
    Shown::new(
        format!("{interval} ({level}{work})"),
        html! { b { (interval) } span style=(FAINT) { " (" (level) (work) ")" } },
    )
}

fn diagnosis(diagnosis: &Diagnosis) -> Shown {
    let good = match diagnosis.finding {
        Finding::NothingWrong => Some(true),
        Finding::Known | Finding::Unknown => Some(false),
        Finding::Unclear => None,
    };
    let plain = diagnosis.to_string();
    let (first, rest) = plain.split_once('\n').unwrap_or((&plain, ""));
    let indent = |line: &str| if line.starts_with("  ") { "margin-left: 2em" } else { "margin-left: 1em" };
    let markup = html! {
        (said(good, first))
        @for line in rest.lines() { div style=(indent(line)) { (line.trim_start()) } }
    };
    Shown::new(&plain, markup)
}

fn table(table: &Table) -> Shown {
    let plain = format!("{}\n{}", table.caption, table.lines().join("\n"));
    let markup = html! {
        table {
            caption style="text-align: left" { (table.caption) }
            thead { tr { @for name in &table.columns { th style=(LEFT) { (name) } } } }
            tbody { @for row in &table.rows { tr { @for cell in row { td style=(LEFT) { (cell) } } } } }
        }
    };
    Shown::new(plain, markup)
}

/// The time of a draw, the error after a second, the time to reach an error, the efficiency and remarks: the
/// unbiased rivals by rank, then the biased ones.
fn comparison(found: &Comparison) -> Shown {
    let relative = found.truth != 0.0;
    let rows = found.remarked().into_iter().map(|(rival, place, remark)| {
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
    table(&Table::new("What a second buys, on one core of the machine that ran this", columns, rows))
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
        vec![(*name).into(), minus(interval(estimate)), ratio, z, estimate.draws().to_string()]
    });
    let caption = minus(format!("The truth is {}", shortened(truth)));
    Table::new(&caption, ["what", "mean ± 95 %", "over the truth", "std errors off", "draws"], rows)
}

/// Draws per probe: ratios are then accurate to about 0.25 %.
const DRAWS: u64 = 200_000;

/// Half-width, in std errors, of the interval reported for a ratio.
const CERTAIN: f64 = 5.0;

/// Tries an estimator on all probes of its exercise, with 200,000 draws each: it is missing, or consistent
/// with a classic mistake, or unbiased up to a stated difference.
///
/// ```
/// use unbiased::check::Attempt;
/// use unbiased::inversion::mistakes::Samples;
/// use unbiased::notebook::check_mine;
///
/// let unwritten = Attempt::new(|_: &Samples, _| f64::NAN);
/// assert!(check_mine(&unwritten)?.to_string().starts_with("Missing: "));
///
/// let multiplied = Attempt::new(|p: &Samples, rng| -p.rate * (1.0 - rng.uniform()).ln());
/// assert!(check_mine(&multiplied)?.to_string().contains("1. multiplied by λ"));
/// # Ok::<(), unbiased::Error>(())
/// ```
///
/// # Errors
/// If a draw other than the first is not finite.
pub fn check_mine(mine: &Attempt<'_>) -> Result<Shown> {
    let on = |probe| {
        let run = Run::new(check::seed_of(probe, 1));
        told_once(probe, || mine.measure(probe, &run, Budget::Draws(DRAWS))).map(|(measured, _)| measured)
    };
    let measured: Vec<_> = match mine.exercise.probes.iter().map(on).collect() {
        Err(Error::OnProbe { first: true, value, .. }) if value.is_nan() => {
            let what = mine.exercise.name;
            let missing = format!("Missing: there is no estimator of “{what}” yet; its draw is NaN.");
            return Ok(Shown::verdict(None, missing));
        }
        measured => measured?,
    };
    let found = check::diagnose(&measured)?.shown_by(mine);
    let Shown { plain, html } = diagnosis(&found);
    if found.finding != Finding::NothingWrong {
        return Ok(Shown { plain, html });
    }
    // the largest relative difference from the truth within five std errors of the means
    let off = found.measurements.iter().map(|measurement| {
        let ratio = measurement.ratio();
        (ratio.mean - measurement.probe.right_ratio()).abs() + CERTAIN * ratio.error
    });
    let sentence = format!(
        "Unbiased within {:.2} % on every probe, {CERTAIN} std errors counted in.",
        100.0 * off.fold(0.0, f64::max)
    );
    let html = said(Some(true), &sentence).into_string() + &html;
    Ok(Shown { plain: format!("{sentence}\n{plain}"), html })
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
    let style = format!("border-left: 4px solid {colour}; padding-left: 0.6em");
    html! { div style=(style) { b { (mark) } " " (sentence) } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lambertian::hemisphere::Hemisphere;
    use crate::lambertian::mistakes::Reflection;
    use crate::roulette::mistakes::NumberOfBounces;
    use crate::stream::Stream;

    #[test]
    fn figures_have_alternative_text_and_tables_are_escaped() {
        let drawn = crate::lambertian::figures::integrand().unwrap();
        let Shown { plain, html } = figure(&drawn);
        let image = format!("src=\"data:image/svg+xml;base64,{}\"", BASE64_STANDARD.encode(drawn.svg()));
        assert!(html.contains(&image));
        assert!(html.starts_with("<img alt=\"cos θ sin θ has area ½"), "{html}");
        assert!(html.contains(&format!(". {}\"", drawn.description())));
        assert_eq!(plain, drawn.title());

        let Shown { plain, html } = table(&against(0.0, &[("<b>", Estimate::from_draws(&[-1.0, 2.0]))]));
        assert!(html.contains("&lt;b&gt;") && !html.contains("<b>"), "{html}");
        assert!(plain.contains("0 ± 19"), "{plain}");
        let four = with_work(&Estimate::from_draws(&[1.0, 2.0, 3.0, 4.0]), "4 draws");
        assert_eq!(four.to_string(), "2.5 ± 2.1 (95 %, 4 draws)");
    }

    #[test]
    fn the_three_states_of_ones_own_estimator() {
        let state = |attempt: &Attempt<'_>| check_mine(attempt).unwrap().to_string();
        assert!(state(&Attempt::new(|_: &NumberOfBounces, _| f64::NAN)).starts_with("Missing"));
        let wrong = |p: &Reflection, rng: &mut _| p.albedo * p.light(&Hemisphere::Uniform.sample(rng));
        let said = state(&Attempt::new(wrong));
        assert!(
            said.starts_with("Not right.") && said.contains("uniform directions, the cosine weight"),
            "{said}"
        );
        let right = |p: &Reflection, rng: &mut _| p.albedo * p.light(&Hemisphere::Cosine.sample(rng));
        // the largest spread of a ratio is √15: five std errors are below 4.4 %
        let said = state(&Attempt::new(right));
        let within = said.strip_prefix("Unbiased within ").and_then(|said| said.split_once(" %")).unwrap().0;
        assert!((0.01..=6.0).contains(&within.parse().unwrap()), "{said}");
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
