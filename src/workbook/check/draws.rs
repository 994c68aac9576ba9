//! Draws made by another program, read from text: one draw per line, or a probe's number and a draw.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};

use crate::check::{Measurement, Probe, Tally};
use crate::error::{Error, Result};

/// A source of draws, and the probe that they were made for, if the command line says so.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// The number of the probe, from 1.
    pub probe: Option<usize>,
    /// A file, or `-` for standard input.
    pub file: String,
}

impl Source {
    /// `2=b.txt`, or a file alone.
    pub fn read(text: &str) -> Self {
        match text.split_once('=').map(|(probe, file)| (probe.parse(), file)) {
            Some((Ok(probe), file)) => Self { probe: Some(probe), file: file.into() },
            _ => Self { probe: None, file: text.into() },
        }
    }
}

/// The longest line that can hold a draw.
const LONGEST: u64 = 4096;

/// Judges the draws of all sources on their probes, in memory that does not grow with them.
pub fn measure(sources: &[Source], probes: &[&'static Probe]) -> Result<Vec<Measurement>> {
    let mut tallies = vec![Tally::default(); probes.len()];
    let mut given: Vec<usize> = Vec::new();
    for Source { probe, .. } in sources {
        let probe = probe.unwrap_or(1);
        if given.contains(&probe) {
            return Err(Error::Usage(format!("there are two files of draws for probe {probe}")));
        }
        given.push(probe);
    }
    for source in sources {
        if source.file == "-" {
            read(io::stdin().lock(), source, &mut tallies)?;
        } else {
            let unread = |error: io::Error| unread(&source.file, &error);
            read(BufReader::new(File::open(&source.file).map_err(unread)?), source, &mut tallies)?;
        }
    }
    let made = probes.iter().zip(&tallies).filter(|(_, tally)| tally.draws() > 0);
    let measured: Vec<_> = made.map(|(probe, tally)| tally.on(probe)).collect();
    if measured.is_empty() {
        return Err(Error::Usage("there are no draws to judge".into()));
    }
    Ok(measured)
}

fn unread(file: &str, error: &io::Error) -> Error {
    let file = if file == "-" { "standard input" } else { file };
    Error::Usage(format!("{file} could not be read: {error}"))
}

fn read(mut lines: impl BufRead, source: &Source, tallies: &mut [Tally]) -> Result<()> {
    let (mut line, mut number, mut numbered) = (Vec::new(), 0u64, None);
    loop {
        line.clear();
        let mut some = lines.by_ref().take(LONGEST);
        if some.read_until(b'\n', &mut line).map_err(|error| unread(&source.file, &error))? == 0 {
            return Ok(());
        }
        number += 1;
        let bad = |reason: String| Err(Error::Usage(format!("line {number} of the draws {reason}")));
        if line.len() as u64 == LONGEST {
            return bad("is too long to be a draw".into());
        }
        let Some(text) = decoded(&mut line) else { return bad("is not text".into()) };
        let text = text.trim();
        if text.is_empty() || text.starts_with('#') {
            continue;
        }
        let words: Vec<&str> =
            text.split(|c: char| c.is_whitespace() || c == ';').filter(|w| !w.is_empty()).collect();
        let (named, draw) = match words[..] {
            [draw] => (None, draw),
            [probe, draw] => (Some(probe), draw),
            _ => return bad(format!("is neither a draw nor a probe and a draw: \"{text}\"")),
        };
        if *numbered.get_or_insert(named.is_some()) != named.is_some() {
            return bad("names a probe where others do not, or the other way round".into());
        }
        let probe = match named.map(str::parse::<usize>) {
            Some(Ok(probe)) if source.probe.is_some_and(|other| other != probe) => {
                let other = source.probe.unwrap_or_default();
                return bad(format!("is for probe {probe}, in a file for probe {other}"));
            }
            Some(Ok(probe)) => probe,
            Some(Err(_)) => return bad(format!("names no probe: \"{text}\"")),
            None => source.probe.unwrap_or(1),
        };
        let count = tallies.len();
        let Some(tally) = probe.checked_sub(1).and_then(|index| tallies.get_mut(index)) else {
            return bad(format!("is for probe {probe}; this question has probes 1 to {count}"));
        };
        match draw_of(draw) {
            Some(draw) => tally.push(draw),
            None => return bad(format!("is no draw: \"{text}\"")),
        }
    }
}

/// A number, possibly with a decimal comma.
fn draw_of(word: &str) -> Option<f64> {
    let draw = word.parse().or_else(|_| word.replacen(',', ".", 1).parse::<f64>()).ok()?;
    draw.is_finite().then_some(draw)
}

/// Decodes UTF-8, and UTF-16 without a byte-order mark if all of it is ASCII: PowerShell writes both.
fn decoded(line: &mut Vec<u8>) -> Option<&str> {
    const MARKS: [&[u8]; 3] = [b"\xef\xbb\xbf", b"\xff\xfe", b"\xfe\xff"];
    for mark in MARKS {
        if line.starts_with(mark) {
            line.drain(..mark.len());
        }
    }
    line.retain(|byte| *byte != 0);
    std::str::from_utf8(line).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::Problem;
    use crate::roulette::mistakes::NumberOfBounces;

    fn probes() -> Vec<&'static Probe> {
        NumberOfBounces::exercise().probes_of("5.1")
    }

    fn tallied(text: &[u8], probe: Option<usize>) -> std::result::Result<Vec<(usize, u64, f64)>, String> {
        let mut tallies = vec![Tally::default(); 4];
        let source = Source { probe, file: "-".into() };
        read(text, &source, &mut tallies).map_err(|error| error.to_string())?;
        let all = (1..).zip(&tallies).zip(probes());
        let some = all.filter(|((_, tally), _)| tally.draws() > 0);
        Ok(some.map(|((at, tally), probe)| (at, tally.draws(), tally.on(probe).estimate.mean())).collect())
    }

    #[test]
    fn draws_are_read_from_whatever_programs_write() {
        for text in [
            &b"1\n2\n\n3\n"[..],
            b"1\r\n2\r\n3",
            b"\xef\xbb\xbf1\n2\n3\n",
            b"\xff\xfe1\0\n\x002\0\n\x003\0\n\0",
            b"\xfe\xff\x001\0\n\x002\0\n\x003\0\n",
            b"# a remark\n 1,0\n\t2e0\n3.0  \n",
        ] {
            assert_eq!(tallied(text, None), Ok(vec![(1, 3, 2.0)]), "{text:?}");
        }
        assert_eq!(tallied(b"1\n2\n3\n", Some(4)), Ok(vec![(4, 3, 2.0)]));
        assert_eq!(tallied(b"1 1\n1;3\n3\t5\n", None), Ok(vec![(1, 2, 2.0), (3, 1, 5.0)]));
        assert_eq!(tallied(b"2 7\n", Some(2)), Ok(vec![(2, 1, 7.0)]));
    }

    #[test]
    fn what_is_no_draw_is_said_with_its_line() {
        for (text, reason) in [
            (&b"1\nx\n"[..], "line 2 of the draws is no draw: \"x\""),
            (b"1\nNaN\n", "line 2 of the draws is no draw: \"NaN\""),
            (b"inf\n", "line 1 of the draws is no draw: \"inf\""),
            (b"\x80\n", "line 1 of the draws is not text"),
            (b"1\n1 2\n", "line 2 of the draws names a probe where others do not, or the other way round"),
            (b"1 2 3\n", "line 1 of the draws is neither a draw nor a probe and a draw: \"1 2 3\""),
            (b"5 2\n", "line 1 of the draws is for probe 5; this question has probes 1 to 4"),
            (b"0 2\n", "line 1 of the draws is for probe 0; this question has probes 1 to 4"),
            (b"a 2\n", "line 1 of the draws names no probe: \"a 2\""),
            (&b"1".repeat(5000), "line 1 of the draws is too long to be a draw"),
        ] {
            assert_eq!(tallied(text, None), Err(reason.to_owned()));
        }
        let mixed = "line 1 of the draws is for probe 2, in a file for probe 1";
        assert_eq!(tallied(b"2 7\n", Some(1)), Err(mixed.into()));
        let twice = ["1=a", "1=b"].map(Source::read);
        let error = measure(&twice, &probes()).unwrap_err().to_string();
        assert_eq!(error, "there are two files of draws for probe 1");
    }
}
