//! Names of lines and where they stand.

use crate::text_width;

use super::figure::{Line, Style};

/// Font size of a legend, dots.
pub(crate) const SIZE: f64 = 11.0;
/// Length of the sample of a line, dots.
pub(crate) const SAMPLE: f64 = 22.0;
/// Height of a row, dots.
pub(crate) const ROW: f64 = 16.0;

/// A name and the place of its sample: left end, row.
pub(crate) struct Entry<'a> {
    pub line: &'a Line,
    pub x: f64,
    pub row: usize,
}

/// Places the names of lines from `left` on in rows that end before `right`. A line without a name, or with the name
/// and the look of an earlier one, has no entry.
pub(crate) fn entries(lines: &[Line], left: f64, right: f64) -> Vec<Entry<'_>> {
    let mut entries: Vec<Entry> = Vec::new();
    let (mut x, mut row) = (left, 0);
    let look = |line: &Line| (line.name.clone(), line.colour, line.style, line.thin);
    for line in lines.iter().filter(|line| !line.name.is_empty() && line.style != Style::Limit) {
        if entries.iter().any(|known| look(known.line) == look(line)) {
            continue;
        }
        let width = SAMPLE + 5.0 + text_width(&line.name, SIZE) + 14.0;
        if x > left && x + width - 14.0 > right {
            (x, row) = (left, row + 1);
        }
        entries.push(Entry { line, x, row });
        x += width;
    }
    entries
}

/// Rows that entries need.
pub(crate) fn rows(entries: &[Entry]) -> usize {
    entries.last().map_or(0, |entry| entry.row + 1)
}

/// The text, cut at its start where it is wider than `width`; the end of a path tells more than its beginning.
pub(crate) fn fitted(text: &str, size: f64, width: f64) -> String {
    if text_width(text, size) <= width {
        return text.to_owned();
    }
    let mut signs = text.chars();
    while signs.next().is_some() {
        let shorter = format!("…{}", signs.as_str());
        if text_width(&shorter, size) <= width {
            return shorter;
        }
    }
    String::new()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(name: &str) -> Line {
        Line { name: name.to_owned(), ..Line::default() }
    }

    #[test]
    fn names_go_on_in_the_next_row() {
        let lines = ["set", "actual", "a long name of a signal", ""].map(line);
        let placed = entries(&lines, 10.0, 140.0);
        let rows_of: Vec<usize> = placed.iter().map(|entry| entry.row).collect();
        assert_eq!((rows_of, rows(&placed)), (vec![0, 0, 1], 2));
        assert_eq!(placed[2].x, 10.0);
        assert_eq!(entries(&["a", "a"].map(line), 0.0, 99.0).len(), 1);
    }

    #[test]
    fn long_titles_lose_their_beginning() {
        assert_eq!(fitted("short", 12.0, 100.0), "short");
        let cut = fitted("control/joint1/scope", 12.0, 80.0);
        assert!(cut.starts_with('…') && cut.ends_with("scope") && text_width(&cut, 12.0) <= 80.0, "{cut}");
        assert_eq!(fitted("x", 12.0, 0.0), "");
    }
}
