//! Why a text is not RON, as far as its brackets, texts and signs show it: the mistake itself, where the reader sees only that it
//! cannot go on.

use std::ops::Range;

use crate::error::SyntaxError;
use crate::parse::{endless_comment, parse};
use crate::token::{Token, TokenKind, Tokens};

/// An error of the reader, or the mistake that it comes from.
pub(crate) fn explained(text: &str, error: SyntaxError) -> SyntaxError {
    if let Some(error) = decimal_comma(text, error.span.start) {
        return error;
    }
    let tokens: Vec<Token> = Tokens::new(text).filter(|token| !token.kind.is_comment()).collect();
    // A mistake behind the place where reading failed is another one.
    let mistake = first(text).filter(|mistake| end_before(&tokens, mistake.at) <= error.span.end);
    match mistake {
        Some(mistake) => mistake.error,
        None if error.remedy.is_some() => error,
        None => {
            bare_unit(text, &tokens, &error).or_else(|| missing_comma(text, &tokens, &error)).unwrap_or(error)
        }
    }
}

/// The byte behind the last token that begins before a byte.
fn end_before(tokens: &[Token], at: usize) -> usize {
    let count = tokens.partition_point(|token| token.start() < at);
    tokens[..count].last().map_or(0, |token| token.end().min(at))
}

/// A comma that is missing before the place where reading failed: with it, reading gets further.
fn missing_comma(text: &str, tokens: &[Token], error: &SyntaxError) -> Option<SyntaxError> {
    let start = error.span.start;
    let end = end_before(tokens, start);
    let begins_anew = end < start && text[start..].starts_with(|c: char| !",:)]}".contains(c));
    if !begins_anew || text[..end].ends_with(['(', '[', '{', ',', ':']) {
        return None;
    }
    let with_comma = format!("{},{}", &text[..end], &text[end..]);
    if parse(&with_comma).is_err_and(|other| other.span.start <= start + 1) {
        return None;
    }
    let error = SyntaxError::new(error.span.clone(), "a comma is missing before this");
    Some(error.help("write `,` between two values").remedy(text, end..end, ","))
}

/// A number with its unit, which needs quotes: `5 deg`, where reading failed at the unit.
fn bare_unit(text: &str, tokens: &[Token], error: &SyntaxError) -> Option<SyntaxError> {
    let unit = tokens.partition_point(|token| token.start() < error.span.start);
    let number = tokens[..unit].last().filter(|token| token.kind == TokenKind::Number)?;
    let unit = tokens.get(unit).filter(|token| token.kind == TokenKind::Word || token.of(text) == "%")?;
    let behind = &text[unit.start()..];
    let end = behind.find([',', ')', ']', '}', '\n']).unwrap_or(behind.len());
    let written = text[number.start()..unit.start() + end].trim_end();
    let is_unit = |sign: char| sign.is_alphanumeric() || " */^%°µ().-".contains(sign);
    if written.contains("//") || !written.chars().all(is_unit) {
        return None;
    }
    let span = number.start()..number.start() + written.len();
    let error = SyntaxError::new(span.clone(), "a number with a unit stands between quotes");
    let quoted = format!("\"{written}\"");
    Some(error.help(format!("write {quoted}")).remedy(text, span, quoted))
}

/// `1,05` just before or at a place where reading failed.
fn decimal_comma(text: &str, at: usize) -> Option<SyntaxError> {
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
    let written = &text[start..stop];
    let new = written.replace(',', ".");
    let error = SyntaxError::new(start..stop, format!("`{written}` is not a number"));
    // Thousands are separated so as well.
    let before = comma - start;
    if stop - comma == 4 && before <= 3 && !written.starts_with('0') && !written.contains('.') {
        let joined = written.replace(',', "");
        return Some(error.help(format!("write {new} or {joined}, whichever is meant")));
    }
    Some(error.help(format!("decimal comma? write {new}")).remedy(text, start..stop, new))
}

/// A mistake, and the byte at which it shows.
struct Mistake {
    at: usize,
    error: SyntaxError,
}

/// The first mistake of a text that its signs show.
fn first(text: &str) -> Option<Mistake> {
    let mut open = Vec::<Bracket>::new();
    let mut before = None;
    // The first text that goes on behind its line: where one is never closed, most likely it is this.
    let mut long: Option<Token> = None;
    let mut tokens = Tokens::new(text).filter(|token| token.kind != TokenKind::LineComment).peekable();
    while let Some(token) = tokens.next() {
        if token.kind == TokenKind::BlockComment {
            if token.is_closed {
                continue;
            }
            return Some(Mistake { at: text.len(), error: endless_comment(token) });
        }
        let mut behind = tokens.clone().filter(|token| !token.kind.is_comment());
        if let Some(inner) = open.last().filter(|inner| inner.sign == "{")
            && token.kind == TokenKind::Word
            && behind.clone().next().is_some_and(|next| next.kind == TokenKind::Colon)
        {
            return Some(Mistake { at: token.start(), error: inner.without_quotes(text, token) });
        }
        if let (Some(TokenKind::Open | TokenKind::Comma), Some(inner)) = (before, open.last_mut())
            && let Some(error) = inner.mixed(text, token, behind.next())
        {
            return Some(Mistake { at: token.start(), error });
        }
        before = Some(token.kind);
        let at = token.start();
        match token.kind {
            TokenKind::Open => open.push(Bracket { at, sign: token.of(text), named: None }),
            TokenKind::Close => match open.pop() {
                Some(opener) if opener.closer() == token.of(text) => {}
                opener => return Some(mismatch(text, opener.as_ref(), at)),
            },
            TokenKind::Colon if open.last().is_some_and(|open| open.sign == "[") => {
                let opener = open.pop()?;
                let error = SyntaxError::new(at..at + 1, "values in a list have no names")
                    .beside(opener.span(), "this `[` is still open")
                    .help("close the list with `]` before the name");
                return Some(Mistake { at, error });
            }
            TokenKind::Text if !token.is_closed => {
                let start = long.map_or(at, |long| long.start());
                return Some(Mistake { at: start, error: endless(text, start) });
            }
            TokenKind::Text if token.of(text).contains('\n') => {
                long.get_or_insert(token);
            }
            TokenKind::Other => {
                if let Some(mistake) = foreign(text, token) {
                    return Some(mistake);
                }
            }
            _ => {}
        }
    }
    let opener = open.pop()?;
    let error = SyntaxError::new(opener.span(), format!("this `{}` is never closed", opener.sign))
        .help(format!("a `{}` is missing behind what belongs to it", opener.closer()));
    Some(Mistake { at: text.len(), error })
}

/// A sign that other languages have for something.
fn foreign(text: &str, token: Token) -> Option<Mistake> {
    let (new, message, help) = match token.of(text) {
        "#" => ("//", "`#` begins no comment", "a comment begins with `//`"),
        ";" => (",", "`;` separates nothing here", "values are separated by `,`"),
        "=" => (
            ":",
            "`=` gives no value here",
            "a name and its value are separated by `:`, as in `stop_time: \"1 s\"`",
        ),
        _ => return None,
    };
    let error = SyntaxError::new(token.span(), message).help(help).remedy(text, token.span(), new);
    Some(Mistake { at: token.start(), error })
}

/// A bracket that is still open.
struct Bracket<'a> {
    at: usize,
    sign: &'a str,
    /// Whether what stands in it has names, as far as it is known.
    named: Option<bool>,
}

impl Bracket<'_> {
    fn closer(&self) -> &'static str {
        match self.sign {
            "(" => ")",
            "[" => "]",
            _ => "}",
        }
    }

    fn span(&self) -> Range<usize> {
        self.at..self.at + 1
    }

    /// A value between parentheses which has a name where those before it have none, or none where those have some.
    fn mixed(&mut self, text: &str, first: Token, next: Option<Token>) -> Option<SyntaxError> {
        let is_named = next.is_some_and(|next| next.kind == TokenKind::Colon);
        if self.sign != "(" || first.kind == TokenKind::Close {
            return None;
        }
        if first.kind == TokenKind::Text && is_named {
            let error = SyntaxError::new(first.span(), "names in parentheses are written without quotes")
                .beside(self.span(), "this `(` is still open")
                .help("close it with `)` before the name, or write the name without quotes");
            return Some(error);
        }
        let is_word = first.kind == TokenKind::Word;
        let has_name = is_word && is_named;
        // A word before anything else has lost its `:`, which is reported where that is missing.
        let is_value = !is_word || next.is_some_and(|next| [",", "(", ")"].contains(&next.of(text)));
        if !has_name && !is_value || *self.named.get_or_insert(has_name) == has_name {
            return None;
        }
        let help = "name all values between these parentheses, or none";
        let message = match has_name {
            true => format!("`{}` has a name, but the value before it has none", first.of(text)),
            false => "this value has no name, but the one before it has".to_owned(),
        };
        Some(SyntaxError::new(first.span(), message).help(help))
    }

    /// A name between braces without quotes: perhaps they were to end before it.
    fn without_quotes(&self, text: &str, name: Token) -> SyntaxError {
        let error = SyntaxError::new(name.span(), "names between braces are written in quotes")
            .beside(self.span(), "this `{` is still open");
        if !is_balanced(text) {
            return error.help("close it with `}` before the name, or write the name in quotes");
        }
        let quoted = format!("\"{}\"", name.of(text));
        error.help(format!("write {quoted}")).remedy(text, name.span(), quoted)
    }
}

/// Whether each bracket of a text is closed by its own.
fn is_balanced(text: &str) -> bool {
    let mut open = Vec::new();
    for token in Tokens::new(text) {
        match token.kind {
            TokenKind::Open => open.push(Bracket { at: token.start(), sign: token.of(text), named: None }),
            TokenKind::Close if open.pop().is_none_or(|opener| opener.closer() != token.of(text)) => {
                return false;
            }
            _ => {}
        }
    }
    open.is_empty()
}

/// A text that begins at a byte and is not closed on its line.
fn endless(text: &str, start: usize) -> SyntaxError {
    let line = text[start..].lines().next().map_or(1, str::len);
    SyntaxError::new(start..start + line, "this text has no end").help("close it with `\"`")
}

/// A closing bracket that closes nothing, or something else.
fn mismatch(text: &str, opener: Option<&Bracket>, at: usize) -> Mistake {
    let found = &text[at..=at];
    let error = match opener {
        None => SyntaxError::new(at..at + 1, format!("this `{found}` closes nothing"))
            .help("take it away, or open what it is to close"),
        Some(opener) => {
            let missing = opener.closer();
            SyntaxError::new(at..at + 1, format!("`{missing}` is missing before this `{found}`"))
                .beside(opener.span(), format!("this `{}` is still open", opener.sign))
                .help(format!("close it with `{missing}`"))
        }
    };
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
            "names between braces are written in quotes: `c` | `{` this `{` is still open | close it with `}` before the name, or write the name in quotes"
        );
        assert_eq!(
            told("(a: {\"b\": 1,\n \"c\": 2,\n"),
            "this `{` is never closed: `{` | a `}` is missing behind what belongs to it"
        );
        for comma in ["", ","] {
            let text = format!("(blocks: {{ \"b\": Gain(k: 1){comma}\n connections: [])");
            assert!(
                told(&text).starts_with("names between braces are written in quotes: `connections` | `{`"),
                "{}",
                told(&text)
            );
        }
        assert_eq!(
            told("(a: {b: 1})"),
            "names between braces are written in quotes: `b` | `{` this `{` is still open | write \"b\""
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
