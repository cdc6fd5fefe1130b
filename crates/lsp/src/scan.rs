//! Words and brackets of a text that may be half written.

use std::ops::Range;

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
}

/// What stands one after the other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Event<'a> {
    /// `name:`, within these brackets; the range is that of the name, without quotes.
    Key(&'a str, Range<usize>),
    /// A word that is no key.
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

/// Reads a text to its end; `visit` gets each key and word with the brackets around it.
pub fn scan<'a>(text: &'a str, mut visit: impl FnMut(&[Open<'a>], Event<'a>)) -> Around<'a> {
    let mut around = Around::default();
    // The last word or quoted text, which may turn out to be a key or to stand before a bracket.
    let mut last: Option<(&'a str, Range<usize>, bool)> = None;
    let mut at = 0;
    while let Some(sign) = text[at..].chars().next() {
        let rest = &text[at..];
        let (length, is_end) = match sign {
            '/' if rest.starts_with("//") => before(rest, "\n", 0),
            '/' if rest.starts_with("/*") => before(rest, "*/", 2),
            '"' => quoted(rest),
            _ if is_word(sign) => {
                let length = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
                (length, false)
            }
            _ => (sign.len_utf8(), false),
        };
        match sign {
            '/' if rest.starts_with("//") || rest.starts_with("/*") => around.is_comment = is_end,
            '"' => {
                around.quoted = is_end.then_some(at + 1);
                let inside = at + 1..at + length - usize::from(!is_end);
                last = Some((&text[inside.clone()], inside, true));
            }
            ':' => {
                if let Some((name, place, _)) = last.take() {
                    visit(&around.open, Event::Key(name, place));
                    around.key = name;
                    around.open.iter_mut().last().into_iter().for_each(|open| open.keys.push(name));
                }
            }
            '(' | '[' | '{' => {
                let word = match last.take() {
                    Some((word, place, false)) => {
                        visit(&around.open, Event::Word(word, place));
                        word
                    }
                    _ => "",
                };
                let key = std::mem::take(&mut around.key);
                around.open.push(Open { sign, word, key, keys: Vec::new() });
            }
            ')' | ']' | '}' | ',' => {
                if let Some((word, place, false)) = last.take() {
                    visit(&around.open, Event::Word(word, place));
                }
                last = None;
                around.key = "";
                if sign != ',' {
                    around.open.pop();
                }
            }
            _ if is_word(sign) => last = Some((&rest[..length], at..at + length, false)),
            _ => {}
        }
        at += length;
    }
    around
}

/// Whether a sign belongs to a word. Numbers are words, too.
pub fn is_word(sign: char) -> bool {
    sign.is_alphanumeric() || sign == '_'
}

/// The signs around a place for which `is_of` holds: a word, a reference.
pub fn run_at(text: &str, at: usize, is_of: impl Fn(char) -> bool) -> Range<usize> {
    let before = text[..at].char_indices().rev().take_while(|(_, sign)| is_of(*sign)).last();
    let start = before.map_or(at, |(start, _)| start);
    let end = text[at..].find(|sign| !is_of(sign)).map_or(text.len(), |end| at + end);
    start..end
}

/// Length up to a mark with `more` of it, and whether the text ends before.
fn before(rest: &str, mark: &str, more: usize) -> (usize, bool) {
    rest.find(mark).map_or((rest.len(), true), |at| (at + more, false))
}

/// Length of a quoted text, and whether the text ends before it does. A line feed ends one that was forgotten to be
/// closed, so that what follows is still understood.
fn quoted(rest: &str) -> (usize, bool) {
    let mut escaped = false;
    for (at, sign) in rest.char_indices().skip(1) {
        match sign {
            '"' if !escaped => return (at + 1, false),
            '\n' => return (at, false),
            _ => escaped = sign == '\\' && !escaped,
        }
    }
    (rest.len(), true)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn around(text: &str) -> Around<'_> {
        scan(text, |_, _| ())
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
        let text = "Diagram(title: \"π\", blocks: {\"a\": Gain(k: 2)}, connections: [\"a.y -> b.u\"]))]}";
        for (at, _) in text.char_indices() {
            around(&text[..at]);
            around(&text[at..]);
        }
    }
}
