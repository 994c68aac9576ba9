//! Text as wide as the terminal.

/// The columns of the terminal, or 79 where output goes elsewhere.
pub(super) fn width() -> usize {
    let columns = console::Term::stdout().size_checked().map(|(_, columns)| usize::from(columns));
    columns.unwrap_or(79).clamp(40, 110)
}

/// Text in lines of at most `width` characters, broken between words. What follows in a broken line stands
/// under its first word, behind the number of a list.
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
}
