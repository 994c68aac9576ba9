//! Text folded to the width of the terminal.

use super::Table;

/// The terminal's width in columns, or 79 if the output goes elsewhere.
pub(super) fn width() -> usize {
    let columns = console::Term::stdout().size_checked().map(|(_, columns)| usize::from(columns));
    columns.unwrap_or(79).clamp(40, 110)
}

/// Text in lines of at most `width` characters, broken between words. Continuation lines are indented to the
/// first word, after the number in a list.
pub(super) fn folded(text: &str, width: usize) -> String {
    let lines = text.lines().map(|line| {
        let blank = line.chars().take_while(|c| *c == ' ').count();
        let words = line.get(blank..).unwrap_or("");
        let number = words.split_once(". ").map_or(0, |(number, _)| {
            if number.chars().all(|c| c.is_ascii_digit()) { number.len() + 2 } else { 0 }
        });
        let hang = " ".repeat(blank + number);
        let (mut folded, mut length) = (" ".repeat(blank), blank);
        for (index, word) in words.split(' ').enumerate() {
            let more = word.chars().count();
            if index == 0 {
                length += more;
            } else if length + 1 + more > width && length > hang.len() {
                folded += "\n";
                folded += &hang;
                length = hang.len() + more;
            } else {
                folded.push(' ');
                length += 1 + more;
            }
            folded += word;
        }
        folded
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// Text after a label, in lines of at most `width` characters; continuation lines are indented to the first
/// word.
pub(super) fn labelled(label: &str, text: &str, width: usize) -> String {
    let blank = label.chars().count();
    let folded = folded(text, width.saturating_sub(blank).max(20));
    let mut lines = String::new();
    // a label is printed even without text
    for (index, line) in folded.split('\n').enumerate() {
        let before = if index == 0 { label.to_owned() } else { " ".repeat(blank) };
        lines += (before + line).trim_end();
        lines.push('\n');
    }
    lines
}

/// A command in lines of at most `width` characters, continued with backslashes.
pub(super) fn command_lines(command: &str, width: usize) -> String {
    let (mut lines, mut line) = (String::new(), String::from("    "));
    // keep an option and its value on one line
    for (index, word) in command.split(" --").enumerate() {
        let word = if index == 0 { word.to_owned() } else { format!("--{word}") };
        let length = line.chars().count();
        if index > 0 && length + 1 + word.chars().count() + 2 > width {
            lines += &format!("{line} \\\n");
            line = String::from("        ");
        } else if index > 0 {
            line.push(' ');
        }
        line += &word;
    }
    lines + &line + "\n"
}

/// A table in lines of at most `width` characters. Columns that do not fit go into further tables below,
/// which repeat the first column; columns wider than the page become lines of text.
pub(super) fn stacked(table: &Table, width: usize) -> Vec<String> {
    let cell = |row: &[String], column: usize| row.get(column).cloned().unwrap_or_default();
    let length = |column: usize| {
        let cells = table.rows.iter().map(|row| cell(row, column).chars().count());
        cells.chain(table.columns.get(column).map(|name| name.chars().count())).max().unwrap_or(0)
    };
    let first = length(0);
    let (mut groups, mut long): (Vec<Vec<usize>>, Vec<usize>) = (Vec::new(), Vec::new());
    let mut used = usize::MAX;
    let told = |column: &usize| table.rows.iter().any(|row| !cell(row, *column).is_empty());
    for column in (1..table.columns.len()).filter(told) {
        let more = 2 + length(column);
        if first + more > width || more > width / 2 {
            long.push(column);
        } else if used.saturating_add(more) <= width {
            used += more;
            if let Some(group) = groups.last_mut() {
                group.push(column);
            }
        } else {
            used = first + more;
            groups.push(vec![0, column]);
        }
    }
    let mut lines = Vec::new();
    for group in groups {
        if !lines.is_empty() {
            lines.push(String::new());
        }
        let columns = group.iter().filter_map(|column| table.columns.get(*column).cloned());
        let cells = |row: &Vec<String>| group.iter().map(|column| cell(row, *column)).collect();
        let part = Table::new("", columns, table.rows.iter().map(cells));
        lines.extend(part.lines());
    }
    for row in &table.rows {
        for text in long.iter().map(|column| cell(row, *column)).filter(|text| !text.is_empty()) {
            let text = labelled("", &format!("{}: {text}", cell(row, 0)), width);
            lines.extend(text.lines().map(str::to_owned));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_broken_between_words_and_hang() {
        for (text, lines) in [
            ("one two three", "one two\nthree"),
            ("1. one two three", "1. one\n   two\n   three"),
            ("  one two three", "  one two\n  three"),
            ("averyverylongword two", "averyverylongword\ntwo"),
            ("", ""),
            ("a  b\n\nc", "a  b\n\nc"),
        ] {
            assert_eq!(folded(text, 9), lines);
        }
    }

    #[test]
    fn commands_break_before_an_option() {
        let command = "run -- --rate 2 --seed 1";
        assert_eq!(command_lines(command, 79), "    run -- --rate 2 --seed 1\n");
        assert_eq!(command_lines(command, 22), "    run -- --rate 2 \\\n        --seed 1\n");
    }

    #[test]
    fn tables_that_are_too_wide_are_stacked() {
        let rows = vec![
            vec!["one".into(), "1".into(), "2".into(), String::new()],
            vec!["three".into(), "10".into(), "20".into(), "a long remark of its own".into()],
        ];
        let table = Table::new("", ["name", "first", "second", "remark"], rows);
        let narrow = [
            "name   first",
            "one    1",
            "three  10",
            "",
            "name   second",
            "one    2",
            "three  20",
            "three: a long remark",
            "of its own",
        ];
        assert_eq!(stacked(&table, 19), narrow);
    }
}
