//! Why a text is no RON, as far as its brackets, texts and signs tell: the mistake itself, where the reader sees only that it
//! cannot go on.

use std::ops::Range;

use crate::read::{Remedy, SyntaxError};
use crate::scan::{block_comment, skip, token, word_length};

/// A mistake, and the byte at which it shows.
pub(super) struct Mistake {
    pub at: usize,
    pub error: SyntaxError,
}

/// The first mistake of a text that its signs tell.
pub(super) fn first(text: &str) -> Option<Mistake> {
    let (mut at, mut open) = (0, Vec::<usize>::new());
    // Of each open bracket, whether what stands between it has names, as far as it is known.
    let mut named = Vec::<Option<bool>>::new();
    let mut before = None;
    // The first text that goes on behind its line: where one is never closed, most likely it is this.
    let mut long: Option<Range<usize>> = None;
    loop {
        if let Some(start) = unclosed_comment(text, at) {
            let error =
                SyntaxError::new(start..start + 2, "this comment has no end").help("close it with `*/`");
            return Some(Mistake { at: text.len(), error });
        }
        at += skip(&text[at..]);
        let rest = &text[at..];
        let Some(sign) = rest.chars().next() else { break };
        let length = length(rest);
        if let (Some('(' | ','), Some(named)) = (before, named.last_mut())
            && open.last().is_some_and(|opener| text[*opener..].starts_with('('))
            && let Some(mistake) = mixed(text, *open.last()?, at, named)
        {
            return Some(mistake);
        }
        before = Some(sign);
        match sign {
            '(' | '[' | '{' => {
                open.push(at);
                named.push(None);
            }
            ')' | ']' | '}' => match open.pop() {
                Some(opener) if closer(text, opener) == sign => {
                    named.pop();
                }
                opener => return Some(mismatch(text, opener, at)),
            },
            ':' if open.last().is_some_and(|opener| text[*opener..].starts_with('[')) => {
                let opener = open.pop()?;
                let error = SyntaxError::new(at..at + 1, "values in a list have no names")
                    .beside(opener..opener + 1, "this `[` is still open")
                    .help("close the list with `]` before the name");
                return Some(Mistake { at, error });
            }
            '#' => return Some(swap(at, "#", "//", "`#` begins no comment", "a comment begins with `//`")),
            ';' => {
                return Some(swap(at, ";", ",", "`;` separates nothing here", "values are separated by `,`"));
            }
            '=' => {
                let help = "a name and its value are separated by `:`, as in `stop_time: \"1 s\"`";
                return Some(swap(at, "=", ":", "`=` gives no value here", help));
            }
            '"' if !is_closed(&rest[..length]) => {
                let place = long.unwrap_or(at..text.len());
                return Some(Mistake { at: place.start, error: endless(text, place.start) });
            }
            '"' if rest[..length].contains('\n') => {
                long.get_or_insert(at..at + length);
            }
            _ => {}
        }
        at += length;
    }
    let opener = open.pop()?;
    let error =
        SyntaxError::new(opener..opener + 1, format!("this `{}` is never closed", &text[opener..=opener]))
            .help(format!("a `{}` is missing behind what belongs to it", closer(text, opener)));
    Some(Mistake { at: text.len(), error })
}

/// A value at `at` between the parentheses that `opener` opens which has a name where those before it have none, or none where
/// those have some.
fn mixed(text: &str, opener: usize, at: usize, named: &mut Option<bool>) -> Option<Mistake> {
    if text[at..].starts_with('"') {
        let name = length(&text[at..]);
        let behind = &text[at + name..];
        if behind[skip(behind)..].starts_with(':') {
            let error = SyntaxError::new(at..at + name, "names in parentheses are written without quotes")
                .beside(opener..opener + 1, "this `(` is still open")
                .help("close it with `)` before the name, or write the name without quotes");
            return Some(Mistake { at, error });
        }
    }
    let word = word_length(&text[at..]);
    let behind = &text[at + word..];
    let behind = &behind[skip(behind)..];
    let has_name = word > 0 && behind.starts_with(':');
    // A word before anything else has lost its `:`, which is told where that is missing.
    let is_value = word == 0 || behind.starts_with([',', '(', ')']);
    if text[at..].starts_with(')') || !has_name && !is_value {
        return None;
    }
    if *named.get_or_insert(has_name) == has_name {
        return None;
    }
    let help = "name all values between these parentheses, or none";
    let error = if has_name {
        let name = &text[at..at + word];
        SyntaxError::new(at..at + word, format!("`{name}` has a name, but the value before it has none"))
    } else {
        SyntaxError::new(at..at + word.max(1), "this value has no name, but the one before it has")
    };
    Some(Mistake { at, error: error.help(help) })
}

/// Length of a word, a text, a character between quotes or a single sign.
fn length(rest: &str) -> usize {
    if rest.starts_with('\'') {
        let body = if rest.starts_with("'\\") { 3 } else { 2 };
        return rest.char_indices().skip(body).find(|(_, sign)| *sign == '\'').map_or(1, |(end, _)| end + 1);
    }
    word_length(rest).max(token(rest))
}

/// A text that begins at a byte and is not closed on its line.
fn endless(text: &str, start: usize) -> SyntaxError {
    let line = text[start..].lines().next().map_or(1, str::len);
    SyntaxError::new(start..start + line, "this text has no end").help("close it with `\"`")
}

/// Where a comment begins that has no end, if the next thing is one.
fn unclosed_comment(text: &str, at: usize) -> Option<usize> {
    let rest = &text[at..];
    let start = at + (rest.len() - rest.trim_start().len());
    let rest = &text[start..];
    let is_open = rest.starts_with("/*") && block_comment(rest) == rest.len() && !rest.ends_with("*/");
    is_open.then_some(start)
}

/// Whether a text ends with the quotes that it begins with.
fn is_closed(text: &str) -> bool {
    let body = text.strip_prefix('"').unwrap_or(text);
    let Some(body) = body.strip_suffix('"') else { return false };
    // The last quotes may be escaped.
    (body.len() - body.trim_end_matches('\\').len()).is_multiple_of(2)
}

fn closer(text: &str, opener: usize) -> char {
    match text.as_bytes()[opener] {
        b'(' => ')',
        b'[' => ']',
        _ => '}',
    }
}

/// A closing bracket that closes nothing, or something else.
fn mismatch(text: &str, opener: Option<usize>, at: usize) -> Mistake {
    let found = &text[at..=at];
    let error = match opener {
        None => SyntaxError::new(at..at + 1, format!("this `{found}` closes nothing"))
            .help("take it away, or open what it is to close"),
        Some(opener) => {
            let missing = closer(text, opener);
            SyntaxError::new(at..at + 1, format!("`{missing}` is missing before this `{found}`"))
                .beside(opener..opener + 1, format!("this `{}` is still open", &text[opener..=opener]))
                .help(format!("close it with `{missing}`"))
        }
    };
    Mistake { at, error }
}

/// A sign that stands for another one.
fn swap(at: usize, old: &str, new: &str, message: &str, help: &str) -> Mistake {
    let span: Range<usize> = at..at + old.len();
    let remedy = Remedy { span: span.clone(), old: old.to_owned(), new: new.to_owned() };
    let error = SyntaxError { remedy: Some(Box::new(remedy)), ..SyntaxError::new(span, message).help(help) };
    Mistake { at, error }
}

#[cfg(test)]
mod tests {
    use crate::read;

    /// Message, the marked text, what stands beside, and the help.
    fn told(text: &str) -> String {
        let error = read(text).expect_err("a mistake");
        let beside =
            error.beside.map_or(String::new(), |(place, said)| format!(" | `{}` {said}", &text[place]));
        let help = error.help.unwrap_or_default();
        format!("{}: `{}`{beside} | {help}", error.message, &text[error.span])
    }

    #[test]
    fn brackets_are_named_where_they_were_opened() {
        assert_eq!(
            told("(a: [1, 2, b: (c: 1)\n)"),
            "values in a list have no names: `:` | `[` this `[` is still open | close the list with `]` before the name"
        );
        assert_eq!(
            told("(a: [1, 2)"),
            "`]` is missing before this `)`: `)` | `[` this `[` is still open | close it with `]`"
        );
        assert_eq!(
            told("(a: Scope(inputs: [\"x\"] }, b: 1)"),
            "`)` is missing before this `}`: `}` | `(` this `(` is still open | close it with `)`"
        );
        assert_eq!(
            told("(a: {\"b\": 1,\n c: 2,\n"),
            "this `{` is never closed: `{` | a `}` is missing behind what belongs to it"
        );
        assert_eq!(
            told("(a: 1))"),
            "this `)` closes nothing: `)` | take it away, or open what it is to close"
        );
    }

    #[test]
    fn names_for_some_values_only_are_told() {
        assert_eq!(
            told("Choice([\"a\", \"b\"], defalt: \"a\")"),
            "`defalt` has a name, but the value before it has none: `defalt` | name all values between these parentheses, or none"
        );
        assert_eq!(
            told("(a: 1, Sine(b: 2), c: 3)"),
            "this value has no name, but the one before it has: `Sine` | name all values between these parentheses, or none"
        );
        assert_eq!(
            told("{\"a\": Sine(b: 1, \"c\": Scope}"),
            "names in parentheses are written without quotes: `\"c\"` | `(` this `(` is still open | close it with `)` before the name, or write the name without quotes"
        );
        assert_eq!(told("(a: 1, b 2)").split(": ").next(), Some("a `:` is missing here"));
    }

    #[test]
    fn signs_of_other_languages_are_known() {
        assert_eq!(told("(\n  # on\n  a: 1)"), "`#` begins no comment: `#` | a comment begins with `//`");
        assert_eq!(told("(a=1)").split(": ").next(), Some("`=` gives no value here"));
        assert_eq!(told("(a: 1; b: 2)").split(": ").next(), Some("`;` separates nothing here"));
        for (text, mended) in [("(a=1)", "(a:1)"), ("(a: 1; b: 2)", "(a: 1, b: 2)")] {
            let remedy = read(text).unwrap_err().remedy.expect("a remedy");
            let mut text = text.to_owned();
            text.replace_range(remedy.span, &remedy.new);
            assert_eq!(text, mended);
        }
    }

    #[test]
    fn a_text_or_a_comment_without_end_is_marked_where_it_begins() {
        assert_eq!(told("(a: [\"ä],\n b: 1)"), "this text has no end: `\"ä],` | close it with `\"`");
        assert_eq!(told("(a: \"x\\\")").split(": ").next(), Some("this text has no end"));
        assert_eq!(told("(a: 1, /* ö \n b: 2)"), "this comment has no end: `/*` | close it with `*/`");
    }

    #[test]
    fn whatever_is_cut_off_or_left_out_is_told_at_a_place_of_the_text() {
        let text = "Gän(ö: [1, \"ü\", 'ß'], /* é */ b: {\"ñ\": Terminatorö(a: 1,5)}, c: r#\"à\"#) // û";
        assert!(read(text).is_err(), "a decimal comma");
        let places: Vec<usize> = text.char_indices().map(|(at, _)| at).collect();
        for (n, from) in places.iter().enumerate() {
            for to in [text.len(), places.get(n + 1).copied().unwrap_or(text.len())] {
                let cut = format!("{}{}", &text[..*from], &text[to..]);
                if let Err(error) = read(&cut) {
                    assert!(cut.get(error.span).is_some(), "{cut}");
                    assert!(
                        error.remedy.is_none_or(|remedy| cut.get(remedy.span) == Some(&remedy.old)),
                        "{cut}"
                    );
                    assert!(error.beside.is_none_or(|(place, _)| cut.get(place).is_some()), "{cut}");
                }
            }
        }
    }

    #[test]
    fn what_is_no_mistake_of_signs_is_left_to_the_reader() {
        assert!(super::first("(a: \"# = ; )\", b: r#\"]\"#, c: [1, /* ( */ 2], d: 'x') // }").is_none());
        assert!(super::first("(a: ')', b: '\"')").is_none());
    }
}
