//! Text of strangers on a terminal: names, titles and messages come from files, and must not move the cursor, hide lines or turn the
//! order of signs round.

use std::borrow::Cow;
use std::fmt::Write;

/// The text with every sign that acts on a terminal written out: `\u{1b}`. Ends of lines and tabs stay.
pub fn clean(text: &str) -> Cow<'_, str> {
    if !text.chars().any(acts) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    text.chars().for_each(|c| push(&mut out, c));
    Cow::Owned(out)
}

/// The same, but colours stay, for text that the program has coloured itself.
pub fn clean_but_colours(text: &str) -> Cow<'_, str> {
    if !text.chars().any(acts) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let length = colour(rest).unwrap_or(0);
        if length > 0 {
            out.push_str(&rest[..length]);
            rest = &rest[length..];
        } else {
            push(&mut out, c);
            rest = &rest[c.len_utf8()..];
        }
    }
    Cow::Owned(out)
}

fn push(out: &mut String, c: char) {
    if acts(c) {
        // Writing to a text does not fail.
        let _ = write!(out, "\\u{{{:x}}}", u32::from(c));
    } else {
        out.push(c);
    }
}

/// Control characters of ASCII and Latin-1, separators of lines and paragraphs, and marks that change the direction of text or are
/// not seen (Unicode Standard Annex 9, sections 2.1 to 2.6).
fn acts(c: char) -> bool {
    matches!(c,
        '\0'..='\u{8}' | '\u{b}'..='\u{1f}' | '\u{7f}'..='\u{9f}'
        | '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}'
        | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
}

/// Length of a sequence that sets a colour, bold or plain, at the start of the text; none hides what is written.
fn colour(text: &str) -> Option<usize> {
    let codes = text.strip_prefix("\x1b[")?;
    let (codes, _) = codes.split_once('m')?;
    let mut numbers =
        codes.split(';').map(|code| if code.is_empty() { Some(0) } else { code.parse::<u16>().ok() });
    let is_harmless = match numbers.next()?? {
        38 => numbers.all(|number| number.is_some_and(|number| number <= 255)),
        first => std::iter::once(Some(first))
            .chain(numbers)
            .all(|code| code.is_some_and(|code| matches!(code, 0..=4 | 22..=24 | 30..=37 | 39 | 90..=97))),
    };
    is_harmless.then_some("\x1b[".len() + codes.len() + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_acts_on_a_terminal_is_written_out() {
        assert_eq!(clean("a\x1b[2Jb\rc"), r"a\u{1b}[2Jb\u{d}c");
        assert_eq!(clean("kp\u{202e}pk\u{2066}\u{200f}"), r"kp\u{202e}pk\u{2066}\u{200f}");
        assert_eq!(clean("\u{9b}2J\u{7}\u{8}"), r"\u{9b}2J\u{7}\u{8}");
        assert_eq!(clean("eine Größe\n\tin µm, 角度"), "eine Größe\n\tin µm, 角度");
        assert!(matches!(clean("plain"), Cow::Borrowed(_)));
    }

    #[test]
    fn colours_stay_and_nothing_else_does() {
        let own = "\x1b[1m\x1b[91merror\x1b[0m \x1b[38;5;12m|\x1b[m";
        assert_eq!(clean_but_colours(own), own);
        for hidden in
            ["\x1b[8mhidden", "\x1b[2J", "\x1b]0;title\x07", "\x1b[1;8m", "\x1b[1A", "\x1b[38;5;999m"]
        {
            assert!(!clean_but_colours(hidden).contains('\x1b'), "{hidden:?}");
        }
    }
}
