//! The effect of each classic mistake of an exercise on each probe.

use super::super::Table;
use crate::check::{Exercise, Mistake, Probe};

/// The mean of each classic mistake divided by the truth, on each probe of its exercise.
///
/// A plain 1 is a mistake that the probe cannot detect. If the truth is 0 the ratio is to ∫ |f|, and 0 is
/// right.
pub fn mistakes(exercise: &Exercise) -> Table {
    let probes = &exercise.probes;
    let row = |mistake: &Mistake| {
        let name = std::iter::once(mistake.name.to_owned());
        name.chain(probes.iter().map(|probe| told(exercise, mistake, probe))).collect()
    };
    let numbered = (1..).zip(probes).map(|(number, probe)| format!("{number}: {probe}"));
    let caption = format!(
        "{}: the mean of each classic mistake over the truth, on the probes {}",
        exercise.name,
        numbered.collect::<Vec<_>>().join("; ")
    );
    let columns =
        std::iter::once("mistake".to_owned()).chain((1..=probes.len()).map(|number| number.to_string()));
    Table::new(&caption, columns, exercise.mistakes.iter().map(row))
}

/// The ratio to two or three digits, or a plain 1 or 0 if the probe does not detect the mistake.
fn told(exercise: &Exercise, mistake: &Mistake, probe: &Probe) -> String {
    let found = exercise.ratio(mistake, probe);
    let ratio = found.mean;
    let text = match ratio.abs() {
        _ if !probe.sees(found) => format!("{}", probe.right_ratio()),
        size if size.is_nan() => "–".into(),
        0.0 => "0".into(),
        // show the deviation if rounding would make it look right
        _ if (ratio - 1.0).abs() < 5e-3 && probe.right_ratio() == 1.0 => format!("1{:+.0e}", ratio - 1.0),
        size => {
            let most = if size < 0.1 { 3 } else { usize::from(size < 10.0) + 1 };
            let known = |places: &usize| 2.0 * found.error <= 0.5 * 0.1f64.powi(*places as i32);
            format!("{size:.0$}", (0..=most).rev().find(known).unwrap_or(0))
        }
    };
    let minus = if ratio < 0.0 { "−" } else { "" };
    format!("{minus}{}", text.trim_start_matches('-').replace('-', "−"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_exercise_has_its_table() {
        for exercise in super::super::exercises() {
            let table = mistakes(exercise);
            assert_eq!(table.rows.len(), exercise.mistakes.len());
            for row in &table.rows {
                assert_eq!(row.len(), 1 + exercise.probes.len());
                assert!(row.iter().all(|cell| !cell.is_empty() && !cell.contains("NaN")), "{row:?}");
            }
        }
    }
}
