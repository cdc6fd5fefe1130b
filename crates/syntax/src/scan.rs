//! White space, comments, words and texts, as far as they matter for places.

use std::ops::Range;

/// Length of white space, comments and attributes at the start.
pub(super) fn skip(text: &str) -> usize {
    skip_with(text, false)
}

/// The same, commas too.
pub(super) fn skip_with(text: &str, commas: bool) -> usize {
    let mut at = 0;
    loop {
        let rest = &text[at..];
        let white =
            rest.len() - rest.trim_start_matches(|c: char| c.is_whitespace() || (commas && c == ',')).len();
        if white > 0 {
            at += white;
        } else if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
        } else if rest.starts_with("/*") {
            at += block_comment(rest);
        } else if rest.starts_with("#![") {
            at += rest.find(']').map_or(rest.len(), |end| end + 1);
        } else {
            return at;
        }
    }
}

/// Length of a comment that may hold others.
pub(crate) fn block_comment(text: &str) -> usize {
    let (mut depth, mut at) = (0usize, 0);
    while at < text.len() {
        let rest = &text[at..];
        if rest.starts_with("/*") {
            (depth, at) = (depth + 1, at + 2);
        } else if rest.starts_with("*/") {
            (depth, at) = (depth - 1, at + 2);
            if depth == 0 {
                return at;
            }
        } else {
            at += rest.chars().next().map_or(1, char::len_utf8);
        }
    }
    text.len()
}

/// Without white space and comments at the end. A value has no comment markers outside of texts, so the text is
/// walked from the start.
pub(super) fn trim_end(raw: &str) -> &str {
    let (mut at, mut end) = (0, 0);
    while at < raw.len() {
        let rest = &raw[at..];
        let skipped = skip(rest);
        if skipped > 0 {
            at += skipped;
            continue;
        }
        at += token(rest);
        end = at;
    }
    &raw[..end]
}

/// Length of a text, a character or a single character of anything else.
pub(crate) fn token(rest: &str) -> usize {
    if let Some(length) = raw_string(rest) {
        return length;
    }
    let first = rest.chars().next().map_or(1, char::len_utf8);
    if rest.starts_with('"') {
        let mut escaped = false;
        for (i, c) in rest.char_indices().skip(1) {
            match c {
                _ if escaped => escaped = false,
                '\\' => escaped = true,
                '"' => return i + 1,
                _ => {}
            }
        }
        return rest.len();
    }
    first
}

pub(super) fn is_raw_string(text: &str) -> bool {
    raw_string(text).is_some()
}

/// Length of `r"..."` or `r#"..."#`.
fn raw_string(text: &str) -> Option<usize> {
    let rest = text.strip_prefix('r')?;
    let hashes = rest.len() - rest.trim_start_matches('#').len();
    let body = rest[hashes..].strip_prefix('"')?;
    let close = format!("\"{}", "#".repeat(hashes));
    let end = body.find(&close)?;
    Some(1 + hashes + 1 + end + close.len())
}

pub(super) fn word_length(text: &str) -> usize {
    // A letter is a letter in any language: a word is never cut at an umlaut.
    let starts = text.chars().next().is_some_and(|c| c.is_alphabetic() || c == '_');
    if !starts {
        return 0;
    }
    text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len())
}

/// Byte of a line and a column, both counted from 1, columns in characters.
pub(super) fn byte_of(text: &str, line: usize, column: usize) -> usize {
    let start = if line <= 1 {
        0
    } else {
        text.match_indices('\n').nth(line - 2).map_or(text.len(), |(newline, _)| newline + 1)
    };
    let rest = &text[start..];
    start + rest.char_indices().nth(column.saturating_sub(1)).map_or(rest.len(), |(byte, _)| byte)
}

/// `1,05` just before or at a place where reading failed.
pub(super) fn decimal_comma(text: &str, at: usize) -> Option<Range<usize>> {
    let bytes = text.as_bytes();
    let line = text[..at].rfind('\n').map_or(0, |newline| newline + 1);
    let end = text[at..].find('\n').map_or(text.len(), |newline| at + newline);
    let mut comma = (line..end).filter(|i| {
        bytes[*i] == b','
            && *i > line
            && bytes[*i - 1].is_ascii_digit()
            && bytes.get(*i + 1).is_some_and(u8::is_ascii_digit)
    });
    // The nearest one to the left of, or at, the place.
    let comma = comma.rfind(|i| *i <= at + 1)?;
    let digits = |c: &u8| c.is_ascii_digit() || *c == b'.';
    let start = comma - bytes[line..comma].iter().rev().take_while(|c| digits(c)).count();
    let stop = comma + 1 + bytes[comma + 1..end].iter().take_while(|c| c.is_ascii_digit()).count();
    Some(start..stop)
}
