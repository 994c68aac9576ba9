//! A comparison as a table for people, and as CSV for programs.

use std::fmt;

use super::comparison::{Comparison, Crossing, Ranked};
use super::measured::{Measured, Nature, Reach};
use crate::doubt::Doubt;
use crate::numbers::{csv_field, duration, plus_minus, two_digits, unit};

impl Comparison {
    /// An explanation of the table's columns.
    pub const EXPLAINED: &str = "σ is the standard deviation of a draw (relative to the truth), the next \
                                 column the work of a draw, its time the median of 17 batches ± half the \
                                 difference of their quartiles. Efficiency is 1/(σ² × time) divided by the \
                                 best one's; rank is 1 + the number of rivals that are better by more than \
                                 three std errors of the difference, so that those of rank 1 are not told \
                                 apart from the best. The columns “to …” give the time on one core until the \
                                 root mean square error is this fraction of the truth, at least the time of \
                                 one draw, which for jittered and Sobol points is a whole replicate; “≥” \
                                 means that a bias too small to be seen may prevent it.";

    /// The names of the table's columns.
    pub fn columns(&self) -> Vec<&'static str> {
        let [sigma, to_2, to_3] = if self.truth == 0.0 {
            ["σ", "to 10⁻² (absolute)", "to 10⁻³"]
        } else {
            ["σ/truth", "to 1 %", "to 0.1 %"]
        };
        let work = self.unit_of_work();
        let measured = ["estimator", sigma, work, "time a draw", "rank", "efficiency"];
        [&measured[..], &[to_2, to_3, "to 10⁻⁴", "to 10⁻⁵", "remark"]].concat()
    }

    /// The table's cells, one row per rival: the unbiased ones by rank, then the biased ones.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let rows = self.remarked().into_iter().map(|(rival, place, remark)| {
            let sigma =
                if rival.varies() { two_digits(rival.variance().sqrt() / rival.scale()) } else { "0".into() };
            let (rank, efficiency) = place.map_or_else(Default::default, |place| {
                (place.rank.to_string(), two_digits(place.of_the_best))
            });
            let mut row =
                vec![rival.name.clone(), sigma, two_digits(self.work(rival)), time(rival), rank, efficiency];
            row.extend([1e-2, 1e-3, 1e-4, 1e-5].map(|error| rival.seconds_to(error).to_string()));
            row.push(remark);
            row
        });
        rows.collect()
    }

    /// The unit of work: evaluations if every rival counts them, else random numbers.
    pub fn unit_of_work(&self) -> &'static str {
        if self.counts_evaluations() { "evaluations" } else { "random numbers" }
    }

    /// The work of a draw, in that unit.
    pub fn work(&self, rival: &Measured) -> f64 {
        if self.counts_evaluations() { rival.evaluations } else { rival.random_numbers }
    }

    fn counts_evaluations(&self) -> bool {
        self.rivals.iter().all(|rival| rival.evaluations > 0.0)
    }

    /// The unbiased rivals by rank, then the biased ones, each with its remarks.
    pub(crate) fn remarked(&self) -> Vec<(&Measured, Option<Ranked<'_>>, String)> {
        let ranked = self.ranking().into_iter().map(|place| (place.rival, Some(place)));
        let biased =
            self.rivals.iter().filter(|rival| rival.nature == Nature::Biased).map(|rival| (rival, None));
        let all = ranked.chain(biased);
        all.map(|(rival, place)| {
            (rival, place, self.remark(rival, place.is_none_or(|place| place.set_apart)))
        })
        .collect()
    }

    fn remark(&self, rival: &Measured, set_apart: bool) -> String {
        let mut remarks = Vec::new();
        if rival.nature == Nature::Biased {
            remarks.extend(self.of_the_bias(rival));
        }
        remarks.extend(rival.doubt().map(|doubt| match doubt {
            Doubt::HeavyTail => doubt.to_string(),
            _ => doubt.mark().to_owned(),
        }));
        if !set_apart {
            remarks.push("not told apart from the one above".into());
        }
        remarks.join("; ")
    }

    fn of_the_bias(&self, rival: &Measured) -> Vec<String> {
        let (unit, factor) = if self.truth == 0.0 { ("", 1.0) } else { (" %", 100.0 / self.truth) };
        let (bias, reach) =
            (factor * rival.bias(), factor.abs() * rival.estimate.reach().unwrap_or(f64::INFINITY));
        let amount = plus_minus(bias, reach).replace('-', "−");
        let amount = format!("{amount}{unit} (95 %)");
        if !rival.bias_seen() {
            return vec![format!("no bias seen: {amount}")];
        }
        let mut said = vec![format!("bias {amount}")];
        match self.crossing(rival) {
            Some(Crossing::At { seconds, rmse }) => {
                let at = format!("{}{unit}", two_digits((factor * rmse).abs()));
                said.push(format!("overtaken by the best after {}, at {at}", duration(seconds)));
            }
            Some(Crossing::FromTheStart) => said.push("behind the best from the start".into()),
            Some(Crossing::Unknown) | None => {}
        }
        said
    }

    /// The comparison as CSV for other programs: the columns' names, then one line per rival, in the order
    /// given.
    ///
    /// Numbers have all digits, in the truth's unit and in seconds; `inf` means infinite or never reached; a
    /// cell is empty if the value is unknown or does not apply. `nature` is `unbiased`, `biased` or
    /// `infinite_variance`; `crossing`, when the best unbiased rival overtakes a biased one, is `at`,
    /// `from_the_start` or `unknown`.
    pub fn csv(&self) -> String {
        let mut csv = COLUMNS.map(|(name, _)| name).join(",") + "\n";
        let places = self.ranking();
        for rival in &self.rivals {
            let place = places.iter().find(|place| std::ptr::eq(place.rival, rival));
            let row = Row { rival, place, crossing: self.crossing(rival), slope: self.slope(rival) };
            csv += &COLUMNS.map(|(_, cell)| cell(&row)).join(",");
            csv.push('\n');
        }
        csv
    }
}

/// What a line of the CSV tells.
struct Row<'a> {
    rival: &'a Measured,
    place: Option<&'a Ranked<'a>>,
    crossing: Option<Crossing>,
    slope: Option<f64>,
}

/// A column of the CSV: its name, and its cell in a row.
type Column = (&'static str, fn(&Row<'_>) -> String);

const COLUMNS: [Column; 31] = [
    ("name", |row| csv_field(&row.rival.name)),
    ("series", |row| csv_field(row.rival.series.as_deref().unwrap_or_default())),
    ("nature", |row| row.nature().into()),
    ("draws", |row| row.rival.estimate.draws().to_string()),
    ("mean", |row| number(row.rival.estimate.mean())),
    ("std_error", |row| row.with_variance(row.rival.estimate.std_error())),
    ("truth", |row| number(row.rival.truth)),
    ("truth_error", |row| number(row.rival.truth_error)),
    ("bias", |row| row.of_bias(number(row.rival.bias()))),
    ("bias_error", |row| row.of_bias(number(row.rival.bias_error()))),
    ("bias_seen", |row| row.of_bias(row.rival.bias_seen().to_string())),
    ("variance", |row| number(row.rival.variance())),
    ("variance_error", |row| row.with_variance(Some(row.rival.variance_error))),
    ("heavy_tail", |row| row.rival.heavy_tail.to_string()),
    ("evaluations", |row| number(row.rival.evaluations)),
    ("random_numbers", |row| number(row.rival.random_numbers)),
    ("seconds", |row| number(row.rival.seconds)),
    ("seconds_low", |row| number(row.rival.seconds_range[0])),
    ("seconds_high", |row| number(row.rival.seconds_range[1])),
    ("efficiency", |row| number(row.rival.efficiency())),
    ("of_the_best", |row| row.place.map_or(String::new(), |place| place.of_the_best.to_string())),
    ("rank", |row| row.place.map_or(String::new(), |place| place.rank.to_string())),
    ("set_apart", |row| row.place.map_or(String::new(), |place| place.set_apart.to_string())),
    ("slope", |row| row.slope.map_or(String::new(), number)),
    ("seconds_to_1e-2", |row| row.seconds_to(1e-2)),
    ("seconds_to_1e-3", |row| row.seconds_to(1e-3)),
    ("seconds_to_1e-4", |row| row.seconds_to(1e-4)),
    ("seconds_to_1e-5", |row| row.seconds_to(1e-5)),
    ("crossing", |row| row.crossing().0.into()),
    ("crossing_seconds", |row| number(row.crossing().1)),
    ("crossing_error", |row| number(row.crossing().2)),
];

/// A number with all its digits, or nothing if it is not known.
fn number(value: f64) -> String {
    if value.is_nan() { String::new() } else { value.to_string() }
}

impl Row<'_> {
    fn nature(&self) -> &'static str {
        match self.rival.nature {
            Nature::Unbiased => "unbiased",
            Nature::Biased => "biased",
            Nature::InfiniteVariance => "infinite_variance",
        }
    }

    /// With an infinite variance its error bars are infinite, too.
    fn with_variance(&self, error: Option<f64>) -> String {
        let infinite = self.rival.nature == Nature::InfiniteVariance;
        number(if infinite { f64::INFINITY } else { error.unwrap_or(f64::NAN) })
    }

    fn of_bias(&self, cell: String) -> String {
        if self.rival.nature == Nature::Biased { cell } else { String::new() }
    }

    fn seconds_to(&self, error: f64) -> String {
        match self.rival.seconds_to(error) {
            Reach::After(seconds) => number(seconds),
            Reach::AtLeast(_) => String::new(),
            Reach::Never => number(f64::INFINITY),
        }
    }

    fn crossing(&self) -> (&'static str, f64, f64) {
        match self.crossing {
            Some(Crossing::At { seconds, rmse }) => ("at", seconds, rmse),
            Some(Crossing::FromTheStart) => ("from_the_start", f64::NAN, f64::NAN),
            Some(Crossing::Unknown) => ("unknown", f64::NAN, f64::NAN),
            None => ("", f64::NAN, f64::NAN),
        }
    }
}

/// A table with aligned columns, and an explanation of them below it.
impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut all = self.rows();
        all.insert(0, self.columns().into_iter().map(str::to_owned).collect());
        let width = |column: usize| {
            all.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.columns().len()).map(width).collect();
        for row in &all {
            let cells: Vec<String> =
                row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
            writeln!(f, "{}", cells.join("  ").trim_end())?;
        }
        write!(f, "{}", Self::EXPLAINED)
    }
}

/// `1.2 ms`, `never`, or `≥ 1.2 ms`
impl fmt::Display for Reach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::After(seconds) => f.write_str(&duration(*seconds)),
            Self::AtLeast(seconds) => write!(f, "≥ {}", duration(*seconds)),
            Self::Never => f.write_str("never"),
        }
    }
}

/// The time of a draw to three digits ± half the difference of its quartiles.
fn time(rival: &Measured) -> String {
    let (factor, unit) = unit(rival.seconds);
    let [low, high] = rival.seconds_range;
    let [time, spread] = [rival.seconds, 0.5 * (high - low)].map(|seconds| factor * seconds);
    let places = (2.0 - time.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{time:.places$} ± {spread:.places$} {unit}")
}
