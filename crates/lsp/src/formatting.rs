//! A text laid out as `blocksim fmt` does it.

use blocksim_syntax::format;
use lsp_types::TextEdit;

use crate::position::span;

/// The edits that lay a text out; nothing for one that is no RON, whose problems are published anyway. Only the lines between
/// the first and the last that change are replaced, so that the cursor elsewhere stays where it is.
pub fn laid_out(text: &str) -> Option<Vec<TextEdit>> {
    let formatted = format(text).ok()?;
    if formatted == text {
        return Some(Vec::new());
    }
    Some(vec![lines(text, &formatted)])
}

/// The edit that makes one text of another: it replaces the lines between the first and the last that change.
pub fn lines(text: &str, new: &str) -> TextEdit {
    let before = same(text.split_inclusive('\n'), new.split_inclusive('\n'));
    let (old, rest) = (&text[before..], &new[before..]);
    let after = same(old.split_inclusive('\n').rev(), rest.split_inclusive('\n').rev());
    let new_text = rest[..rest.len() - after].to_owned();
    TextEdit { range: span(text, &(before..text.len() - after)), new_text }
}

/// Length of the lines that two texts have in common.
fn same<'a>(a: impl Iterator<Item = &'a str>, b: impl Iterator<Item = &'a str>) -> usize {
    a.zip(b).take_while(|(a, b)| a == b).map(|(a, _)| a.len()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_lines_that_change_are_replaced() {
        let edits = laid_out("(\n    a: 1,\n  b:2,\n    c: 3,\n)\n").expect("RON");
        assert_eq!(edits.len(), 1);
        let range = edits[0].range;
        assert_eq!((range.start.line, range.end.line, &*edits[0].new_text), (2, 3, "    b: 2,\n"));
        assert_eq!(laid_out("(a: 1)\n"), Some(Vec::new()));
        assert_eq!(laid_out("(a: "), None);
    }

    #[test]
    fn lines_that_repeat_are_not_counted_twice() {
        let edits = laid_out("[\n    1,\n\n\n    1,\n]\n").expect("RON");
        assert_eq!((edits[0].range.start.line, &*edits[0].new_text), (3, ""));
    }
}
