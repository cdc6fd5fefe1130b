//! Places: the protocol counts lines and UTF-16 units, the compiler bytes.

use std::ops::Range;

use lsp_types::{Position, Range as Span, TextDocumentContentChangeEvent};

/// The place of a byte; the end of the text for one behind it.
pub fn position(text: &str, at: usize) -> Position {
    let at = (0..=at.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
    let before = &text[..at];
    let line = before.matches('\n').count();
    let start = before.rfind('\n').map_or(0, |feed| feed + 1);
    Position::new(line as u32, before[start..].encode_utf16().count() as u32)
}

/// The byte of a place; the end of its line, or of the text, for one behind it.
pub fn offset(text: &str, place: Position) -> usize {
    let line = place.line as usize;
    let start = match line {
        0 => 0,
        _ => text.match_indices('\n').nth(line - 1).map_or(text.len(), |(feed, _)| feed + 1),
    };
    let end = text[start..].find('\n').map_or(text.len(), |feed| start + feed);
    let mut units = 0;
    for (at, sign) in text[start..end].char_indices() {
        if units >= place.character as usize {
            return start + at;
        }
        units += sign.len_utf16();
    }
    end
}

/// The text after a change of the editor; a change without a place brings the whole text.
pub fn changed(text: &str, change: &TextDocumentContentChangeEvent) -> String {
    let Some(range) = change.range else { return change.text.clone() };
    let (start, end) = (offset(text, range.start), offset(text, range.end));
    let mut new = String::with_capacity(text.len() + change.text.len());
    new.push_str(&text[..start]);
    new.push_str(&change.text);
    new.push_str(&text[end.max(start)..]);
    new
}

/// A range of bytes as the protocol writes it.
pub fn span(text: &str, bytes: &Range<usize>) -> Span {
    Span::new(position(text, bytes.start), position(text, bytes.end))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_replace_what_they_name_over_signs_of_any_width() {
        let change = |text: &str, place: Option<[u32; 4]>, new: &str| {
            let range = place.map(|[a, b, c, d]| Span::new(Position::new(a, b), Position::new(c, d)));
            changed(text, &TextDocumentContentChangeEvent { range, range_length: None, text: new.to_owned() })
        };
        let text = "a\nπ = 𝛑;\r\nend";
        assert_eq!(change(text, Some([1, 4, 1, 6]), "3"), "a\nπ = 3;\r\nend");
        assert_eq!(change(text, Some([0, 1, 1, 0]), ""), "aπ = 𝛑;\r\nend");
        assert_eq!(change(text, Some([9, 0, 9, 9]), "!"), "a\nπ = 𝛑;\r\nend!");
        assert_eq!(change(text, None, "new"), "new");
        // An editor that names an end before the start loses nothing.
        assert_eq!(change("abc", Some([0, 2, 0, 1]), "-"), "ab-c");
    }

    #[test]
    fn places_go_there_and_back_over_signs_of_any_width() {
        let text = "a\nπ = 𝛑;\r\nend";
        for (at, _) in text.char_indices().chain([(text.len(), ' ')]) {
            if text.as_bytes().get(at) != Some(&b'\n') {
                assert_eq!(offset(text, position(text, at)), at, "{at}");
            }
        }
        assert_eq!(position(text, text.find(';').unwrap()), Position::new(1, 6));
        assert_eq!(offset(text, Position::new(0, 9)), 1, "no further than the line");
        assert_eq!(offset(text, Position::new(9, 0)), text.len());
        assert_eq!(position(text, 999), Position::new(2, 3));
    }
}
