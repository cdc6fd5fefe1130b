//! What the sheets of a workbook share: texts, and which styles show dates.

use std::collections::BTreeSet;

use crate::BookError;
use crate::archive_read::Archive;
use crate::xml::{Piece, attribute, each};

/// Texts that cells refer to by number.
pub(crate) fn strings(archive: &Archive) -> Result<Vec<String>, BookError> {
    const PART: &str = "xl/sharedStrings.xml";
    let mut found: Vec<String> = Vec::new();
    if !archive.has(PART) {
        return Ok(found);
    }
    let (mut in_text, mut in_guide) = (false, false);
    each(PART, &archive.text(PART)?, |piece| {
        match piece {
            Piece::Start(tag, _) if tag == "si" => found.push(String::new()),
            Piece::Start(tag, _) if tag == "rPh" => in_guide = true,
            Piece::End(tag) if tag == "rPh" => in_guide = false,
            Piece::Start(tag, _) if tag == "t" => in_text = true,
            Piece::End(tag) if tag == "t" => in_text = false,
            Piece::Text(text) if in_text && !in_guide => {
                found.iter_mut().next_back().into_iter().for_each(|last| last.push_str(&text));
            }
            _ => {}
        }
        Ok(())
    })?;
    Ok(found)
}

/// Numbers of the styles that show a number as a date or a time.
pub(crate) fn date_styles(archive: &Archive) -> Result<BTreeSet<usize>, BookError> {
    const PART: &str = "xl/styles.xml";
    let mut dates = BTreeSet::new();
    if !archive.has(PART) {
        return Ok(dates);
    }
    let mut formats: BTreeSet<u32> = BTreeSet::new();
    let (mut in_cells, mut style) = (false, 0);
    each(PART, &archive.text(PART)?, |piece| {
        match piece {
            Piece::Start(tag, attributes) if tag == "numFmt" => {
                let id = attribute(&attributes, "numFmtId").and_then(|id| id.parse().ok());
                if let (Some(id), Some(code)) = (id, attribute(&attributes, "formatCode"))
                    && shows_date(code)
                {
                    formats.insert(id);
                }
            }
            Piece::Start(tag, _) if tag == "cellXfs" => in_cells = true,
            Piece::End(tag) if tag == "cellXfs" => in_cells = false,
            Piece::Start(tag, attributes) if tag == "xf" && in_cells => {
                let id = attribute(&attributes, "numFmtId").and_then(|id| id.parse().ok()).unwrap_or(0);
                // Built-in formats of dates and times: ECMA-376 part 1, 18.8.30.
                if matches!(id, 14..=22 | 45..=47) || formats.contains(&id) {
                    dates.insert(style);
                }
                style += 1;
            }
            _ => {}
        }
        Ok(())
    })?;
    Ok(dates)
}

/// Whether a format has letters of dates outside of quotes and brackets.
fn shows_date(code: &str) -> bool {
    let (mut quoted, mut bracketed, mut escaped) = (false, false, false);
    for c in code.chars() {
        match c {
            _ if escaped => escaped = false,
            '\\' | '_' | '*' => escaped = true,
            '"' => quoted = !quoted,
            _ if quoted => {}
            '[' => bracketed = true,
            ']' => bracketed = false,
            'd' | 'D' | 'm' | 'M' | 'y' | 'Y' | 'h' | 'H' | 's' | 'S' if !bracketed => return true,
            _ => {}
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_of_dates_are_told_from_formats_of_numbers() {
        for date in ["dd.mm.yyyy", "d-mmm", "h:mm", "[$-407]d. mmmm yyyy"] {
            assert!(shows_date(date), "{date}");
        }
        for number in ["0.00", "#,##0", "0.00E+00", "0.0\" mm\"", "[Red]0", "0\\d"] {
            assert!(!shows_date(number), "{number}");
        }
    }
}
