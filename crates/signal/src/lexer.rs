//! Words, numbers and signs of an expression or a unit, each with its place.

use crate::ExprError;
use std::ops::Range;

/// Longest text that is read, in bytes.
const MAX_TEXT: usize = 65_536;

/// The smallest piece of an expression.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Token<'a> {
    /// A number, always finite and not negative.
    Number(f64),
    /// A name or a unit; also `%` and `°`.
    Word(&'a str),
    /// One of `+ - * / ^ ( ) [ ] , .`
    Sign(char),
    /// The end of the text.
    End,
}

/// A token and the bytes it covers.
#[derive(Debug, Clone)]
pub(crate) struct Lexeme<'a> {
    pub token: Token<'a>,
    pub span: Range<usize>,
}

/// Cuts a text into tokens; the last one is always [`Token::End`].
///
/// Where the text may compare, `< > <= >= == !=` are signs, too, those of two characters as `≤ ≥ = ≠`.
///
/// Errors: a text that is too long, a character that means nothing here, a number beyond the range of `f64`.
pub(crate) fn lex(text: &str, compares: bool) -> Result<Vec<Lexeme<'_>>, ExprError> {
    if text.len() > MAX_TEXT {
        return Err(ExprError::new(0..0, format!("expression is longer than {MAX_TEXT} bytes")));
    }
    let mut lexemes: Vec<Lexeme> = Vec::new();
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        let start = at;
        let rest = &text[at..];
        at += c.len_utf8();
        let token = if c.is_whitespace() {
            continue;
        } else if c.is_ascii_digit() || (c == '.' && starts_fraction(rest, lexemes.last(), start)) {
            at = start + number_length(rest);
            Token::Number(number(text, start..at)?)
        } else if is_word_start(c) {
            at = start + rest.find(|c| !is_word_part(c)).unwrap_or(rest.len());
            Token::Word(&text[start..at])
        } else if c == '%' {
            Token::Word(&text[start..at])
        } else if let Some(n) = superscript(c) {
            lexemes.push(Lexeme { token: Token::Sign('^'), span: start..at });
            Token::Number(n)
        } else if let Some((sign, length)) = comparison(rest).filter(|_| compares) {
            at = start + length;
            Token::Sign(sign)
        } else {
            Token::Sign(sign(c).ok_or_else(|| stray(text, c, start..at, compares))?)
        };
        lexemes.push(Lexeme { token, span: start..at });
    }
    lexemes.push(Lexeme { token: Token::End, span: text.len()..text.len() });
    Ok(lexemes)
}

fn is_word_start(c: char) -> bool {
    c.is_ascii_alphabetic() || matches!(c, '_' | 'µ' | 'μ' | 'Ω' | '\u{2126}' | '°')
}

fn is_word_part(c: char) -> bool {
    is_word_start(c) || c.is_ascii_digit()
}

fn superscript(c: char) -> Option<f64> {
    match c {
        '²' => Some(2.0),
        '³' => Some(3.0),
        _ => None,
    }
}

/// The sign a character stands for; typographic multiplication and minus signs are welcome.
fn sign(c: char) -> Option<char> {
    match c {
        '+' | '-' | '*' | '/' | '^' | '(' | ')' | '[' | ']' | ',' | '.' => Some(c),
        '·' | '⋅' | '×' => Some('*'),
        '−' => Some('-'),
        _ => None,
    }
}

/// The comparison at the start, and its bytes.
fn comparison(rest: &str) -> Option<(char, usize)> {
    const SIGNS: [(&str, char); 8] =
        [("<=", '≤'), (">=", '≥'), ("==", '='), ("!=", '≠'), ("≤", '≤'), ("≥", '≥'), ("<", '<'), (">", '>')];
    SIGNS.iter().find(|(text, _)| rest.starts_with(text)).map(|(text, sign)| (*sign, text.len()))
}

/// `.5` is a number, but not directly behind a name or a bracket, where the dot selects.
fn starts_fraction(rest: &str, before: Option<&Lexeme>, start: usize) -> bool {
    let digit = rest[1..].starts_with(|c: char| c.is_ascii_digit());
    let selects = before.is_some_and(|lexeme| {
        lexeme.span.end == start && matches!(lexeme.token, Token::Word(_) | Token::Sign(']' | ')'))
    });
    digit && !selects
}

/// Bytes of the number at the start: digits, fraction, and an exponent only if digits follow its `e`.
fn number_length(rest: &str) -> usize {
    let bytes = rest.as_bytes();
    let digits = |from: usize| from + bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut end = digits(0);
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let signed = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let first = end + 1 + signed;
        if bytes.get(first).is_some_and(u8::is_ascii_digit) {
            end = digits(first);
        }
    }
    end
}

fn number(text: &str, span: Range<usize>) -> Result<f64, ExprError> {
    match text[span.clone()].parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(ExprError::new(span, "number is beyond the range of 64-bit floating point")),
    }
}

fn stray(text: &str, c: char, span: Range<usize>, compares: bool) -> ExprError {
    let error = ExprError::new(span.clone(), format!("unexpected character `{}`", c.escape_debug()));
    match c {
        '"' | '\'' => error.help("an expression holds no quoted text; write the name without quotes"),
        '=' if compares => error.help("write == to compare; the text is the value itself, without `y =`"),
        '&' | '|' | '!' | '?' if compares => error.help("write and(a, b), or(a, b), not(a), if(a, b, c)"),
        '=' if text[..span.start].trim().is_empty() => {
            error.help("leave it out: the text is an expression already")
        }
        '=' | '<' | '>' | '!' | '&' | '|' | '?' => error.help("an expression computes; it does not compare"),
        ';' if text[span.end..].starts_with(|c: char| c.is_ascii_digit()) => {
            error.help("items are separated by `,`")
        }
        '{' | '}' => error.help("use ( ) to group and [ ] for lists"),
        '$' | '@' | '#' => error.help("a name is written as it is, without a sign before it"),
        _ => error.help(
            "an expression consists of numbers with units, names, + - * / ^, and functions such as sin(...)",
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(text: &str) -> Vec<Token<'_>> {
        lex(text, false).unwrap().into_iter().map(|lexeme| lexeme.token).collect()
    }

    #[test]
    fn numbers_take_an_exponent_only_with_digits() {
        use Token::*;
        assert_eq!(tokens("1e-3"), [Number(1e-3), End]);
        assert_eq!(tokens("2E3m"), [Number(2e3), Word("m"), End]);
        assert_eq!(tokens("2em"), [Number(2.0), Word("em"), End]);
        assert_eq!(tokens(".5 1."), [Number(0.5), Number(1.0), End]);
        assert_eq!(tokens("1e"), [Number(1.0), Word("e"), End]);
    }

    #[test]
    fn a_dot_behind_a_name_selects() {
        use Token::*;
        assert_eq!(tokens("a.b"), [Word("a"), Sign('.'), Word("b"), End]);
        assert_eq!(tokens("a.5"), [Word("a"), Sign('.'), Number(5.0), End]);
    }

    #[test]
    fn typographic_signs_are_understood() {
        use Token::*;
        assert_eq!(tokens("−2 kΩ·m²"), tokens("-2 kΩ*m^2"));
        assert_eq!(tokens("5 %"), [Number(5.0), Word("%"), End]);
    }

    #[test]
    fn spans_count_bytes() {
        let lexemes = lex("2 µm + x", false).unwrap();
        let spans: Vec<_> = lexemes.into_iter().map(|lexeme| lexeme.span).collect();
        assert_eq!(spans, [0..1, 2..5, 6..7, 8..9, 9..9]);
    }

    #[test]
    fn what_means_nothing_is_refused_with_its_place() {
        assert_eq!(lex("2 $ 3", false).unwrap_err().span, 2..3);
        assert_eq!(lex("1 + 1e999", false).unwrap_err().span, 4..9);
        assert!(lex(&"1+".repeat(MAX_TEXT), false).is_err());
    }
}
