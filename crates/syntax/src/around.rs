//! Words and brackets of a text that may be half written.

use std::ops::Range;

use crate::token::{TokenKind, Tokens};

/// A bracket that is still open.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Open<'a> {
    /// `(`, `[` or `{`.
    pub sign: char,
    /// The word before it: `Gain` of `Gain(`; empty without.
    pub word: &'a str,
    /// The key that it is the value of: `blocks` of `blocks: {`; empty without.
    pub key: &'a str,
    /// Keys seen in it so far.
    pub keys: Vec<&'a str>,
    /// Commas in it so far.
    pub commas: usize,
}

/// What stands one after the other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Event<'a> {
    /// `name:`, within these brackets; the range is that of the name, without quotes.
    Key(&'a str, Range<usize>),
    /// A word that is not a key.
    Word(&'a str, Range<usize>),
}

/// What is around the end of a text.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Around<'a> {
    /// Open brackets, the outermost first.
    pub open: Vec<Open<'a>>,
    /// The key before the end, where a value is due; empty where a key is.
    pub key: &'a str,
    /// Where the quoted text begins in which the end is, behind the quote.
    pub quoted: Option<usize>,
    /// The end is in a comment.
    pub is_comment: bool,
}

/// Reads a text up to a byte; `visit` gets each key and word with the brackets around it. What follows decides where quoted
/// texts end.
pub fn scan<'a>(text: &'a str, end: usize, mut visit: impl FnMut(&[Open<'a>], Event<'a>)) -> Around<'a> {
    let mut around = Around::default();
    // The last word or quoted text, which may turn out to be a key or to stand before a bracket.
    let mut last: Option<(&'a str, Range<usize>, bool)> = None;
    for token in Tokens::of_draft(text).take_while(|token| token.start() < end) {
        // Whether the end is in it, or where it would go on.
        let is_within = end < token.end() || !token.is_closed && end == token.end();
        match token.kind {
            TokenKind::LineComment => around.is_comment = end <= token.end(),
            TokenKind::BlockComment => around.is_comment = is_within,
            TokenKind::Text => {
                around.quoted = is_within.then_some(token.start() + 1);
                let inside = token.start() + 1..(token.end() - usize::from(token.is_closed)).min(end);
                last = Some((&text[inside.clone()], inside, true));
            }
            TokenKind::Word => {
                let word = token.start()..token.end().min(end);
                last = Some((&text[word.clone()], word, false));
            }
            TokenKind::Colon => {
                if let Some((name, place, _)) = last.take() {
                    visit(&around.open, Event::Key(name, place));
                    around.key = name;
                    around.open.iter_mut().last().into_iter().for_each(|open| open.keys.push(name));
                }
            }
            TokenKind::Open => {
                let word = match last.take() {
                    Some((word, place, false)) => {
                        visit(&around.open, Event::Word(word, place));
                        word
                    }
                    _ => "",
                };
                let key = std::mem::take(&mut around.key);
                let sign = char::from(text.as_bytes()[token.start()]);
                around.open.push(Open { sign, word, key, keys: Vec::new(), commas: 0 });
            }
            TokenKind::Close | TokenKind::Comma => {
                if let Some((word, place, false)) = last.take() {
                    visit(&around.open, Event::Word(word, place));
                }
                around.key = "";
                if token.kind == TokenKind::Close {
                    around.open.pop();
                } else if let Some(open) = around.open.last_mut() {
                    open.commas += 1;
                }
            }
            _ => {}
        }
    }
    around
}

/// The signs around a place for which `is_of` holds: a word, a reference.
pub fn run_at(text: &str, at: usize, is_of: impl Fn(char) -> bool) -> Range<usize> {
    let before = text[..at].char_indices().rev().take_while(|(_, sign)| is_of(*sign)).last();
    let start = before.map_or(at, |(start, _)| start);
    let end = text[at..].find(|sign| !is_of(sign)).map_or(text.len(), |end| at + end);
    start..end
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::token::is_word;

    fn around(text: &str) -> Around<'_> {
        scan(text, text.len(), |_, _| ())
    }

    #[test]
    fn brackets_know_their_word_and_key_and_what_stands_in_them() {
        let found = around(r#"Diagram(blocks: { "a": Step(time: 1.0), "pid": Pid(kp: 2.0, lower: -1.0, "#);
        let open: Vec<(char, &str, &str)> =
            found.open.iter().map(|open| (open.sign, open.word, open.key)).collect();
        assert_eq!(open, [('(', "Diagram", ""), ('{', "", "blocks"), ('(', "Pid", "pid")]);
        assert_eq!(found.open[2].keys, ["kp", "lower"]);
        assert_eq!((found.key, found.quoted, found.is_comment), ("", None, false));
        assert_eq!(around("Pid(kp: ").key, "kp");
    }

    #[test]
    fn comments_and_quotes_hide_brackets() {
        assert_eq!(around("( // (\n \"(\" /* ( */ ").open.len(), 1);
        assert!(around("( // (").is_comment && around("/* *").is_comment && !around("// x\n").is_comment);
        let text = r#"connections: ["a.y -> b"#;
        assert_eq!(around(text).quoted.map(|from| &text[from..]), Some("a.y -> b"));
        assert_eq!(around(r#"["a \" ("#).open.len(), 1);
        assert_eq!(around("[\"forgotten\n(").open.len(), 2);
        assert_eq!(around("[\"\n(").open.len(), 2);
    }

    #[test]
    fn a_quoted_text_may_have_several_lines() {
        let law = "\n  x' = v\n  v' = -(x\n";
        let text = format!("Diagram(blocks: {{ \"a\": OdeSystem(law: \"{law}\", x: 1), \"b\": Gain");
        let mut keys = Vec::new();
        let found = scan(&text, text.len(), |_, event| {
            if let Event::Key(name, _) = event {
                keys.push(name);
            }
        });
        assert_eq!((found.open.len(), found.key), (2, "b"));
        assert_eq!(keys, ["blocks", "a", "law", "x", "b"]);
        // Within it, which only what follows can tell.
        let within = text.find("v'").unwrap();
        let found = scan(&text, within, |_, _| ());
        assert_eq!(found.quoted, text.find(law));
        assert_eq!(found.open.last().map(|open| open.word), Some("OdeSystem"));
        // The quote of the next line begins a text of its own.
        let text = "[\"a.y -> b\n    \"c.y -> d.u\", (";
        assert_eq!(scan(text, 9, |_, _| ()).quoted, Some(2));
        assert_eq!(around(text).open.len(), 2);
    }

    #[test]
    fn a_word_is_found_from_any_of_its_signs_and_from_its_end() {
        let text = "a + größe*b";
        for at in [4, 6, text.find('*').unwrap()] {
            assert_eq!(&text[run_at(text, at, is_word)], "größe");
        }
        assert_eq!(run_at(text, 2, is_word), 2..2);
    }

    #[test]
    fn nothing_that_is_typed_disturbs_it() {
        let text = "Diagram(title: \"π\", blocks: {\"a\": Gain(k: 2), \"b\": OdeSystem(law: \"\n\\\n\"\n)}, \
                    connections: [\"a.y -> b.u\"]))]}";
        for (at, _) in text.char_indices() {
            around(&text[..at]);
            around(&text[at..]);
            scan(text, at, |_, _| ());
        }
    }
}
