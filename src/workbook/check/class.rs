//! Judges a whole class: numbers worked out by hand from a CSV file, and draws from a folder.

use std::collections::{BTreeMap, HashMap};
use std::fmt;
use std::path::Path;

use serde_json::json;

use super::super::Table;
use super::super::by_hand;
use super::super::terminal::{folded, width};
use super::arguments::Arguments;
use super::draws::{self, Source};
use super::{Verdict, exercise};
use crate::check::{self, Finding, Probe};
use crate::error::{Error, Result};
use crate::question::Values;

/// The judgement of each student's answers, in the order of the files.
pub struct Report {
    rows: Vec<Row>,
}

#[derive(Default)]
struct Row {
    student: String,
    question: String,
    /// `None` if the answer cannot be judged at all.
    verdict: Option<Verdict>,
    /// A mistake's name for programs, and for people.
    mistake: Option<(String, String)>,
    /// The ratio to the truth.
    ratio: Option<f64>,
    /// The judgement in one sentence.
    reason: String,
}

impl Row {
    fn of(student: &str, question: &str, judged: Result<Self>) -> Self {
        let judged = judged.unwrap_or_else(|error| Self { reason: error.to_string(), ..Self::default() });
        Self { student: student.into(), question: question.into(), ..judged }
    }

    fn ratio(&self, places: usize) -> String {
        self.ratio.map_or(String::new(), |ratio| format!("{ratio:.places$}"))
    }

    fn mistake_id(&self) -> Option<&str> {
        self.mistake.as_ref().map(|(id, _)| id.as_str())
    }

    fn word(&self) -> &'static str {
        self.verdict.map_or("not judged", Verdict::word)
    }
}

impl Report {
    /// Judges a CSV file with the columns student, question, answer and optionally variant, and a folder of
    /// files `STUDENT_QUESTION.txt` of draws.
    pub fn of(arguments: &Arguments) -> Result<Self> {
        let mut rows = Vec::new();
        if let Some(path) = &arguments.answers {
            read_answers(path, arguments, &mut rows)?;
        }
        if let Some(path) = &arguments.draws_in {
            read_folder(Path::new(path), &mut rows)?;
        }
        Ok(Self { rows })
    }

    /// Undecided if any row is, else wrong if any row is.
    pub fn verdict(&self) -> Verdict {
        let worst = self.rows.iter().map(|row| row.verdict.unwrap_or(Verdict::Undecided));
        worst.max().unwrap_or(Verdict::Undecided)
    }

    /// How many students made each mistake, most frequent first: question, name for programs, name, number of
    /// students.
    fn summary(&self) -> Vec<(&str, &str, &str, usize)> {
        let mut counts = BTreeMap::<_, usize>::new();
        for row in &self.rows {
            if let Some((id, name)) = &row.mistake {
                *counts.entry((row.question.as_str(), id.as_str(), name.as_str())).or_default() += 1;
            }
        }
        let counted = counts.into_iter().map(|((question, id, name), count)| (question, id, name, count));
        let mut summary: Vec<_> = counted.collect();
        summary.sort_by_key(|(question, _, _, count)| (std::cmp::Reverse(*count), *question));
        summary
    }

    /// One object per line: the rows, then the summary.
    pub fn json(&self) -> String {
        let rows = self.rows.iter().map(|row| {
            json!({
                "student": row.student, "question": row.question, "verdict": row.word(),
                "mistake": row.mistake_id(), "ratio": row.ratio, "reason": row.reason,
            })
        });
        let summary = self.summary().into_iter().map(|(question, id, name, students)| {
            json!({ "question": question, "mistake": id, "name": name, "students": students })
        });
        rows.chain(summary).map(|line| line.to_string()).collect::<Vec<_>>().join("\n")
    }

    /// The rows as CSV, without the summary.
    pub fn csv(&self) -> Result<String> {
        let rows = self.rows.iter().map(|row| {
            let [student, question, reason] = [&row.student, &row.question, &row.reason].map(String::clone);
            let mistake = row.mistake_id().unwrap_or_default().to_owned();
            vec![student, question, row.word().into(), mistake, row.ratio(6), reason]
        });
        let columns = ["student", "question", "verdict", "mistake", "ratio", "reason"];
        Ok(Table::new("", columns, rows).csv()?.trim_end().into())
    }
}

/// As tables: the rows, then the summary.
impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rows = self.rows.iter().map(|row| {
            let unnamed = if row.verdict == Some(Verdict::Wrong) { "unknown" } else { "" };
            let mistake = row.mistake_id().unwrap_or(unnamed).into();
            vec![row.student.clone(), row.question.clone(), row.word().into(), mistake, row.ratio(4)]
        });
        let table = Table::new("", ["student", "question", "verdict", "mistake", "ratio"], rows);
        let counted = self.summary().into_iter().map(|(question, id, name, count)| {
            vec![count.to_string(), question.into(), id.into(), name.into()]
        });
        let summary = Table::new("", ["students", "question", "mistake", ""], counted);
        let count = |verdict| self.rows.iter().filter(|row| row.verdict == verdict).count();
        writeln!(f, "{}\n", cut(&table))?;
        if !summary.rows.is_empty() {
            writeln!(f, "{}\n", cut(&summary))?;
        }
        for row in self.rows.iter().filter(|row| matches!(row.verdict, None | Some(Verdict::Undecided))) {
            let (student, question, verdict, reason) = (&row.student, &row.question, row.word(), &row.reason);
            writeln!(f, "{}", folded(&format!("{student}, {question}: {verdict}: {reason}"), width()))?;
        }
        write!(
            f,
            "{} answers: {} right, {} wrong, {} undecided, {} not judged.",
            self.rows.len(),
            count(Some(Verdict::Right)),
            count(Some(Verdict::Wrong)),
            count(Some(Verdict::Undecided)),
            count(None)
        )
    }
}

/// A table's lines, cut to the width of the terminal.
fn cut(table: &Table) -> String {
    let width = width();
    let fitting = |line: String| {
        let long = line.chars().count() > width;
        if long { line.chars().take(width - 1).chain(['…']).collect() } else { line }
    };
    table.lines().into_iter().map(fitting).collect::<Vec<_>>().join("\n")
}

/// Where each student's answer to each question was read.
type Places = HashMap<(String, String), String>;

fn once(places: &mut Places, student: &str, question: &str, place: String) -> Result<()> {
    match places.insert((student.into(), question.into()), place.clone()) {
        Some(before) => Err(Error::Usage(format!(
            "{before} and {place} both answer {question} for {student}: keep one of them"
        ))),
        None => Ok(()),
    }
}

fn read_answers(path: &str, arguments: &Arguments, rows: &mut Vec<Row>) -> Result<()> {
    let unread = |error: &dyn fmt::Display| Error::Usage(format!("{path} could not be read: {error}"));
    let text = std::fs::read(path).map_err(|error| unread(&error))?;
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&text);
    // spreadsheets with a decimal comma separate columns by semicolons
    let head = text.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let delimiter = if head.contains(&b';') && !head.contains(&b',') { b';' } else { b',' };
    let mut reader =
        csv::ReaderBuilder::new().trim(csv::Trim::All).delimiter(delimiter).flexible(true).from_reader(text);
    let headers = reader.headers().map_err(|error| unread(&error))?.clone();
    let column = |name: &str| headers.iter().position(|header| header.eq_ignore_ascii_case(name));
    let needed = |name: &str| {
        let missing =
            || Error::Usage(format!("{path} has no column {name}; it needs student, question, answer"));
        column(name).ok_or_else(missing)
    };
    let [student, question, answer] = [needed("student")?, needed("question")?, needed("answer")?];
    let variant = column("variant");
    let mut places = Places::new();
    for record in reader.records() {
        let record = record.map_err(|error| unread(&error))?;
        let line = record.position().map_or(0, csv::Position::line);
        let at = |message: String| Error::Usage(format!("{path}, line {line}: {message}"));
        let field = |place: usize, name: &str| {
            let text = record.get(place).filter(|text| !text.is_empty());
            text.ok_or_else(|| at(format!("there is no {name}")))
        };
        let (student, question) = (field(student, "student")?, field(question, "question")?);
        once(&mut places, student, question, format!("line {line}"))?;
        let mut parameters: Vec<_> =
            arguments.own.iter().filter(|(name, _)| has(question, name)).cloned().collect();
        let cell = variant.and_then(|place| record.get(place)).unwrap_or("").trim();
        let (mut name, mut assignments) = (arguments.variant.as_deref(), "");
        if cell.contains('=') {
            assignments = cell;
        } else if !cell.is_empty() {
            name = Some(cell);
        }
        for assignment in assignments.split_whitespace() {
            let Some((name, value)) = assignment.split_once('=') else {
                return Err(at(format!("the variant \"{assignment}\" is not of the form name=value")));
            };
            parameters.push((name.into(), value.into()));
        }
        let parameters =
            super::parameters(question, name, &parameters).map_err(|error| at(error.to_string()))?;
        let text = record.get(answer).unwrap_or("");
        rows.push(Row::of(student, question, judged(question, text, &parameters, arguments.digits)));
    }
    Ok(())
}

/// Whether a question has this parameter.
fn has(question: &str, name: &str) -> bool {
    let id = question.split('(').next().unwrap_or_default();
    super::super::question(id).is_ok_and(|question| question.parameters.iter().any(|of| of.name == name))
}

fn judged(question: &str, text: &str, parameters: &Values, digits: Option<u32>) -> Result<Row> {
    let (judgement, ratio) = by_hand::judged(question, text, parameters, digits)?;
    let first = judgement.slips().first();
    Ok(Row {
        verdict: Some(Verdict::from(&judgement)),
        mistake: first.map(|slip| (slip.id.to_owned(), slip.words.to_owned())),
        ratio,
        reason: judgement.to_string(),
        ..Row::default()
    })
}

/// Reads draws of each student and question from files `STUDENT_QUESTION.txt`, with lines as for
/// `--draws-from`.
fn read_folder(folder: &Path, rows: &mut Vec<Row>) -> Result<()> {
    let unread =
        |error: std::io::Error| Error::Usage(format!("{} could not be read: {error}", folder.display()));
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unread)? {
        let path = entry.map_err(unread)?.path();
        if path.is_file() {
            files.push(path);
        }
    }
    files.sort();
    let mut places = Places::new();
    for path in files {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let stem = name.strip_suffix(".txt").or(name.strip_suffix(".csv")).unwrap_or(&name);
        let Some((student, question)) = stem.rsplit_once('_').filter(|(student, _)| !student.is_empty())
        else {
            return Err(Error::Usage(format!("{name} is not named STUDENT_QUESTION.txt")));
        };
        let exercise = exercise(question).map_err(|error| Error::Usage(format!("{name}: {error}")))?;
        once(&mut places, student, question, name.clone())?;
        let source = Source { probe: None, file: path.display().to_string() };
        rows.push(Row::of(student, question, drawn(source, &exercise.probes_of(question))));
    }
    Ok(())
}

fn drawn(source: Source, probes: &[&'static Probe]) -> Result<Row> {
    let diagnosis = check::diagnose(&draws::measure(&[source], probes)?)?;
    let first = diagnosis.candidates.first();
    Ok(Row {
        verdict: Some(Verdict::from(diagnosis.finding)),
        mistake: first.map(|candidate| (candidate.id(), candidate.name())),
        ratio: diagnosis.measurements.first().map(|of| of.ratio().mean),
        reason: match (diagnosis.finding, first) {
            (Finding::Known, Some(candidate)) => candidate.name(),
            _ => diagnosis.to_string().lines().next().unwrap_or_default().into(),
        },
        ..Row::default()
    })
}
