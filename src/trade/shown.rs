//! A comparison as a table for people, and as CSV and JSON for programs.

use std::fmt;

use serde::ser::{SerializeMap, SerializeSeq, SerializeStruct};
use serde::{Serialize, Serializer};

use super::comparison::{Comparison, Ranked};
use super::measured::{Crossing, Measured, Nature, Reach};
use crate::doubt::Doubt;
use crate::numbers::{duration, plus_minus, two_digits, unit};

/// The errors for which a table gives the times.
const ERRORS: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-5];

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
        let (sigma, to) = if self.truth == 0.0 {
            ("σ", ["to 10⁻² (absolute)", "to 10⁻³", "to 10⁻⁴", "to 10⁻⁵"])
        } else {
            ("σ/truth", ["to 1 %", "to 0.1 %", "to 10⁻⁴", "to 10⁻⁵"])
        };
        let mut columns = vec!["estimator", sigma, self.unit_of_work(), "time a draw", "rank", "efficiency"];
        columns.extend(to);
        columns.push("remark");
        columns
    }

    /// The table's cells, one row per rival: the unbiased ones by rank, then the biased ones.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let rows = self.remarked().into_iter().map(|(rival, place, remark)| {
            let sigma =
                if rival.varies() { two_digits(rival.variance().sqrt() / self.scale()) } else { "0".into() };
            let (rank, efficiency) = place.map_or_else(Default::default, |place| {
                (place.rank.to_string(), two_digits(place.of_the_best))
            });
            let mut row =
                vec![rival.name.clone(), sigma, two_digits(self.work(rival)), time(rival), rank, efficiency];
            row.extend(ERRORS.map(|error| rival.seconds_to(error).to_string()));
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
            Some(Crossing::Never | Crossing::Unknown) | None => {}
        }
        said
    }

    /// The comparison as CSV for other programs: the columns' names, then one line per rival.
    ///
    /// Numbers have all digits, in the truth's unit and in seconds; `inf` means infinite or never reached; a
    /// cell is empty if the value is unknown or does not apply. `nature` is `unbiased`, `biased` or
    /// `infinite_variance`; `crossing`, when the best unbiased rival overtakes a biased one, is `at`,
    /// `from_the_start`, `never` or `unknown`.
    ///
    /// ```
    /// use unbiased::from_fn;
    /// use unbiased::trade::{Rival, Trade};
    ///
    /// let rival = Rival::new("U", from_fn(|rng| rng.uniform()));
    /// let found = Trade::new(1, 0.5)?.seconds_each(0.01)?.compare(&[rival])?;
    /// assert!(found.csv().starts_with("name,series,nature,draws,mean,"));
    /// // serde gives the same columns
    /// let json = serde_json::to_value(&found)?;
    /// assert_eq!(json["rivals"][0]["name"], "U");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn csv(&self) -> String {
        let mut csv = NAMES.join(",") + "\n";
        for record in self.records() {
            let cells: Vec<String> = record.iter().map(Cell::to_string).collect();
            csv += &cells.join(",");
            csv.push('\n');
        }
        csv
    }

    /// The cells of CSV and JSON, one record per rival, in the order given.
    fn records(&self) -> Vec<Record<'_>> {
        let places = self.ranking();
        let place = |rival: &Measured| places.iter().find(|place| std::ptr::eq(place.rival, rival));
        self.rivals.iter().map(|rival| record(self, rival, place(rival))).collect()
    }
}

/// The columns of CSV and JSON.
const NAMES: [&str; 31] = [
    "name",
    "series",
    "nature",
    "draws",
    "mean",
    "std_error",
    "truth",
    "truth_error",
    "bias",
    "bias_error",
    "bias_seen",
    "variance",
    "variance_error",
    "heavy_tail",
    "evaluations",
    "random_numbers",
    "seconds",
    "seconds_low",
    "seconds_high",
    "efficiency",
    "of_the_best",
    "rank",
    "set_apart",
    "slope",
    "seconds_to_1e-2",
    "seconds_to_1e-3",
    "seconds_to_1e-4",
    "seconds_to_1e-5",
    "crossing",
    "crossing_seconds",
    "crossing_error",
];

/// One cell per column.
type Record<'a> = [Cell<'a>; 31];

fn record<'a>(comparison: &Comparison, rival: &'a Measured, place: Option<&Ranked<'_>>) -> Record<'a> {
    let finite = rival.nature != Nature::InfiniteVariance;
    let biased = rival.nature == Nature::Biased;
    let number = |value: f64| if value.is_nan() { Cell::Nothing } else { Cell::Number(value) };
    // with an infinite variance the error bar is infinite, too
    let with_variance = |value: f64| number(if finite { value } else { f64::INFINITY });
    let of_bias = |cell: Cell<'a>| if biased { cell } else { Cell::Nothing };
    let of_place = |cell: fn(&Ranked<'_>) -> Cell<'a>| place.map_or(Cell::Nothing, cell);
    let reach = |error: f64| match rival.seconds_to(error) {
        Reach::After(seconds) => number(seconds),
        Reach::AtLeast(_) => Cell::Nothing,
        Reach::Never => Cell::Number(f64::INFINITY),
    };
    let (crossing, [at, error]) = match comparison.crossing(rival) {
        None => (Cell::Nothing, [Cell::Nothing, Cell::Nothing]),
        Some(Crossing::At { seconds, rmse }) => (Cell::Text("at"), [number(seconds), number(rmse)]),
        Some(Crossing::FromTheStart) => (Cell::Text("from_the_start"), [Cell::Nothing, Cell::Nothing]),
        Some(Crossing::Never) => (Cell::Text("never"), [Cell::Nothing, Cell::Nothing]),
        Some(Crossing::Unknown) => (Cell::Text("unknown"), [Cell::Nothing, Cell::Nothing]),
    };
    let [low, high] = rival.seconds_range;
    let [to_2, to_3, to_4, to_5] = ERRORS.map(reach);
    [
        Cell::Text(&rival.name),
        rival.series.as_deref().map_or(Cell::Nothing, Cell::Text),
        Cell::Text(rival.nature.key()),
        Cell::Count(rival.estimate.draws()),
        number(rival.estimate.mean()),
        with_variance(rival.estimate.std_error().unwrap_or(f64::NAN)),
        number(rival.truth),
        number(rival.truth_error),
        of_bias(number(rival.bias())),
        of_bias(number(rival.bias_error())),
        of_bias(Cell::Flag(rival.bias_seen())),
        number(rival.variance()),
        with_variance(rival.variance_error),
        Cell::Flag(rival.heavy_tail),
        number(rival.evaluations),
        number(rival.random_numbers),
        number(rival.seconds),
        number(low),
        number(high),
        number(rival.efficiency()),
        of_place(|place| Cell::Number(place.of_the_best)),
        of_place(|place| Cell::Count(place.rank as u64)),
        of_place(|place| Cell::Flag(place.set_apart)),
        comparison.slope(rival).map_or(Cell::Nothing, number),
        to_2,
        to_3,
        to_4,
        to_5,
        crossing,
        at,
        error,
    ]
}

/// A value for programs.
enum Cell<'a> {
    Text(&'a str),
    Count(u64),
    Number(f64),
    Flag(bool),
    Nothing,
}

/// As a CSV field (RFC 4180).
impl fmt::Display for Cell<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) if text.contains([',', '"', '\n', '\r']) => {
                write!(f, "\"{}\"", text.replace('"', "\"\""))
            }
            Self::Text(text) => f.write_str(text),
            Self::Count(count) => write!(f, "{count}"),
            Self::Number(number) => write!(f, "{number}"),
            Self::Flag(flag) => write!(f, "{flag}"),
            Self::Nothing => Ok(()),
        }
    }
}

impl Serialize for Cell<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Text(text) => serializer.serialize_str(text),
            Self::Count(count) => serializer.serialize_u64(*count),
            Self::Number(number) => serializer.serialize_f64(*number),
            Self::Flag(flag) => serializer.serialize_bool(*flag),
            Self::Nothing => serializer.serialize_none(),
        }
    }
}

/// The fields are `seed`, `truth`, `truth_error` and `rivals`; each rival has the columns of
/// [`Comparison::csv`]. In JSON, which has no infinity, infinite values are null, as are empty cells.
impl Serialize for Comparison {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut fields = serializer.serialize_struct("Comparison", 4)?;
        fields.serialize_field("seed", &self.seed)?;
        fields.serialize_field("truth", &self.truth)?;
        fields.serialize_field("truth_error", &self.truth_error)?;
        fields.serialize_field("rivals", &Records(self.records()))?;
        fields.end()
    }
}

struct Records<'a>(Vec<Record<'a>>);

impl Serialize for Records<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut list = serializer.serialize_seq(Some(self.0.len()))?;
        for record in &self.0 {
            list.serialize_element(&Fields(record))?;
        }
        list.end()
    }
}

struct Fields<'a>(&'a Record<'a>);

impl Serialize for Fields<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, cell) in NAMES.iter().zip(self.0) {
            map.serialize_entry(name, cell)?;
        }
        map.end()
    }
}

/// A table with aligned columns, and an explanation of them below it.
impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let heading = self.columns().into_iter().map(str::to_owned).collect();
        let all: Vec<Vec<String>> = std::iter::once(heading).chain(self.rows()).collect();
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
