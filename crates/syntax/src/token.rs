//! Words, numbers, quoted texts, signs and comments, one after the other: what the reader, the formatter and an editor take a text
//! apart with.
//!
//! Every text has tokens, whether it is RON or not: they cover all of it but white space.

use std::ops::Range;

/// What a token is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TokenKind {
    /// Letters of any language, digits and `_`.
    Word,
    /// What begins with a digit, a point or a plus or minus, up to the next sign that cannot belong to a number.
    Number,
    /// `"text"`
    Text,
    /// `r"text"` or `r#"text"#`
    RawText,
    /// `'c'`
    Character,
    /// `(`, `[` or `{`
    Open,
    /// `)`, `]` or `}`
    Close,
    /// `,`
    Comma,
    /// `:`
    Colon,
    /// `// ...`, without the line feed.
    LineComment,
    /// `/* ... */`, which may hold others.
    BlockComment,
    /// `#![enable(...)]`
    Attribute,
    /// Any other sign, which RON does not know.
    Other,
}

impl TokenKind {
    /// Whether it is a comment.
    pub fn is_comment(self) -> bool {
        matches!(self, TokenKind::LineComment | TokenKind::BlockComment)
    }
}

/// A part of a text. It is so small because the reader hands on one for every word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Token {
    start: u32,
    end: u32,
    /// What it is.
    pub kind: TokenKind,
    /// Whether a quoted text or a comment has its end; true of all others.
    pub is_closed: bool,
}

impl Token {
    /// Its first byte.
    pub fn start(&self) -> usize {
        self.start as usize
    }

    /// The byte behind it.
    pub fn end(&self) -> usize {
        self.end as usize
    }

    /// Start and end in bytes.
    pub fn span(&self) -> Range<usize> {
        self.start()..self.end()
    }

    /// Its letters in the text that it is part of.
    pub fn of<'a>(&self, text: &'a str) -> &'a str {
        &text[self.span()]
    }
}

/// What some editors of Windows begin a text in UTF-8 with; it is no part of the text.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// Most bytes of a text.
pub(crate) const LONGEST: usize = u32::MAX as usize;

/// The tokens of a text; of one of 4 GiB none.
#[derive(Debug, Clone)]
pub struct Tokens<'a> {
    text: &'a str,
    at: usize,
    is_draft: bool,
    /// The fewest signs `#` of a raw text that was found to have no end: the next one of as many has none either.
    endless_raw: usize,
}

impl<'a> Tokens<'a> {
    /// Those of a text that should be RON: a quoted text goes on to its second quote.
    pub fn new(text: &'a str) -> Self {
        Self {
            text: if text.len() < LONGEST { text } else { "" },
            at: 0,
            is_draft: false,
            endless_raw: usize::MAX,
        }
    }

    /// Those of a text that somebody is writing: where a quoted text spans lines and its second quote rather begins another one, it
    /// ends with its line, so that what follows is still understood.
    pub fn of_draft(text: &'a str) -> Self {
        Self { is_draft: true, ..Self::new(text) }
    }

    /// Passes white space.
    fn skip_white_space(&mut self) {
        let bytes = self.text.as_bytes();
        if self.at == 0 && self.text.starts_with(BYTE_ORDER_MARK) {
            self.at = BYTE_ORDER_MARK.len_utf8();
        }
        while let Some(byte) = bytes.get(self.at) {
            match byte {
                b' ' | b'\t'..=b'\r' => self.at += 1,
                0..=127 => return,
                _ => match self.text[self.at..].chars().next().filter(|sign| is_white_space(*sign)) {
                    Some(sign) => self.at += sign.len_utf8(),
                    None => return,
                },
            }
        }
    }

    /// Length of `r"..."` or `r#"..."#`, if one with an end begins here.
    fn raw_text(&mut self, rest: &str) -> Option<usize> {
        let behind = rest.strip_prefix('r')?;
        let hashes = behind.bytes().take_while(|byte| *byte == b'#').count();
        let body = behind[hashes..].strip_prefix('"')?;
        if hashes >= self.endless_raw {
            return None;
        }
        let mut at = 0;
        while let Some(quote) = body[at..].find('"') {
            at += quote + 1;
            if body[at..].bytes().take_while(|byte| *byte == b'#').take(hashes).count() == hashes {
                return Some(1 + hashes + 1 + at + hashes);
            }
        }
        self.endless_raw = hashes;
        None
    }
}

impl Iterator for Tokens<'_> {
    type Item = Token;

    fn next(&mut self) -> Option<Token> {
        self.skip_white_space();
        let start = self.at;
        let first = *self.text.as_bytes().get(start)?;
        let sign = match first {
            b',' => Some(TokenKind::Comma),
            b':' => Some(TokenKind::Colon),
            b'(' | b'[' | b'{' => Some(TokenKind::Open),
            b')' | b']' | b'}' => Some(TokenKind::Close),
            _ => None,
        };
        if let Some(kind) = sign {
            self.at += 1;
            return Some(Token { kind, start: start as u32, end: self.at as u32, is_closed: true });
        }
        let rest = &self.text[start..];
        let token = |kind, length| (kind, length, true);
        let (kind, length, is_closed) = match first {
            b'A'..=b'Z' | b'a'..=b'z' | b'_' => match self.raw_text(rest) {
                Some(length) => token(TokenKind::RawText, length),
                None => token(TokenKind::Word, word(rest)),
            },
            b'"' if self.is_draft => draft(rest),
            b'"' => text(rest),
            b'0'..=b'9' | b'-' | b'+' | b'.' => token(TokenKind::Number, number(rest)),
            b'/' if rest.starts_with("//") => {
                token(TokenKind::LineComment, rest.find('\n').unwrap_or(rest.len()))
            }
            b'/' if rest.starts_with("/*") => {
                let (length, is_closed) = block_comment(rest);
                (TokenKind::BlockComment, length, is_closed)
            }
            b'#' if rest.starts_with("#![") => match rest.find(']') {
                Some(end) => token(TokenKind::Attribute, end + 1),
                None => token(TokenKind::Other, 1),
            },
            b'\'' => match character(rest) {
                Some(length) => token(TokenKind::Character, length),
                None => token(TokenKind::Other, 1),
            },
            _ => match word(rest) {
                0 => token(TokenKind::Other, rest.chars().next().map_or(1, char::len_utf8)),
                length => token(TokenKind::Word, length),
            },
        };
        self.at += length;
        Some(Token { kind, start: start as u32, end: self.at as u32, is_closed })
    }
}

/// White space between tokens, as the specification of RON has it: Unicode's `Pattern_White_Space`.
fn is_white_space(sign: char) -> bool {
    matches!(sign, ' ' | '\t'..='\r' | '\u{85}' | '\u{200e}' | '\u{200f}' | '\u{2028}' | '\u{2029}')
}

/// Whether a sign belongs to a word.
pub fn is_word(sign: char) -> bool {
    sign.is_alphanumeric() || sign == '_'
}

/// Length of a word at the start; 0 where none begins.
fn word(rest: &str) -> usize {
    let plain = rest.bytes().position(|byte| !(byte.is_ascii_alphanumeric() || byte == b'_'));
    let plain = plain.unwrap_or(rest.len());
    if rest.as_bytes().get(plain).is_none_or(u8::is_ascii) {
        return plain;
    }
    let starts = rest.chars().next().is_some_and(|sign| sign.is_alphabetic() || sign == '_');
    // A letter is a letter in any language: a word is never cut at an umlaut.
    if starts { rest.find(|sign| !is_word(sign)).unwrap_or(rest.len()) } else { 0 }
}

fn number(rest: &str) -> usize {
    let is_of = |byte: u8| byte.is_ascii_alphanumeric() || b"+-._".contains(&byte);
    rest.bytes().position(|byte| !is_of(byte)).unwrap_or(rest.len())
}

/// A quoted text up to its second quote.
fn text(rest: &str) -> (TokenKind, usize, bool) {
    let bytes = rest.as_bytes();
    let mut at = 1;
    loop {
        match bytes.get(at) {
            None => return (TokenKind::Text, rest.len(), false),
            Some(b'"') => return (TokenKind::Text, at + 1, true),
            Some(b'\\') => at += 2,
            Some(_) => at += 1,
        }
    }
}

/// A quoted text of a draft. It may have several lines if what follows its second quote can follow a text.
fn draft(rest: &str) -> (TokenKind, usize, bool) {
    let (kind, length, is_closed) = text(rest);
    let Some(line) = rest[..length].find('\n') else { return (kind, length, is_closed) };
    let next = rest[length..].trim_start();
    let is_closing = next.is_empty() || next.starts_with([',', ':', ')', ']', '}', '/']);
    if is_closed && is_closing { (kind, length, true) } else { (kind, line, false) }
}

/// Length of a character between quotes on one line.
fn character(rest: &str) -> Option<usize> {
    let mut signs = rest.char_indices().skip(1);
    let (_, first) = signs.next()?;
    if first == '\\' {
        signs.next()?;
        let mut rest = signs.take_while(|(_, sign)| *sign != '\n');
        return rest.find(|(_, sign)| *sign == '\'').map(|(at, _)| at + 1);
    }
    signs.next().filter(|(_, sign)| *sign == '\'').map(|(at, _)| at + 1)
}

/// Length of a comment that may hold others, and whether it has an end.
fn block_comment(rest: &str) -> (usize, bool) {
    let bytes = rest.as_bytes();
    let (mut open, mut at) = (0_usize, 0);
    while at < bytes.len() {
        match bytes[at..] {
            [b'/', b'*', ..] => (open, at) = (open + 1, at + 2),
            [b'*', b'/', ..] => {
                (open, at) = (open - 1, at + 2);
                if open == 0 {
                    return (at, true);
                }
            }
            _ => at += 1,
        }
    }
    (rest.len(), false)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(text: &str) -> Vec<(TokenKind, &str)> {
        Tokens::new(text).map(|token| (token.kind, token.of(text))).collect()
    }

    #[test]
    fn a_text_is_taken_apart() {
        use TokenKind::*;
        let text =
            "#![enable(x)]\nGröße(a: -1.5e3, /* b /* c */ */ 'd', '\\'', r#\"e\"f\"#, \"g\\\"h\", // i\n)";
        assert_eq!(
            tokens(text),
            [
                (Attribute, "#![enable(x)]"),
                (Word, "Größe"),
                (Open, "("),
                (Word, "a"),
                (Colon, ":"),
                (Number, "-1.5e3"),
                (Comma, ","),
                (BlockComment, "/* b /* c */ */"),
                (Character, "'d'"),
                (Comma, ","),
                (Character, "'\\''"),
                (Comma, ","),
                (RawText, "r#\"e\"f\"#"),
                (Comma, ","),
                (Text, "\"g\\\"h\""),
                (Comma, ","),
                (LineComment, "// i"),
                (Close, ")"),
            ]
        );
    }

    #[test]
    fn what_has_no_end_goes_on_to_the_end_of_the_text() {
        for text in ["\"a", "\"a\\", "/* a", "/* /* */"] {
            let all: Vec<Token> = Tokens::new(text).collect();
            assert_eq!(all.len(), 1, "{text}");
            assert_eq!((all[0].span(), all[0].is_closed), (0..text.len(), false), "{text}");
        }
    }

    #[test]
    fn many_raw_texts_without_end_take_no_time() {
        let text = "r#\" ".repeat(100_000);
        assert_eq!(Tokens::new(&text).filter(|token| token.kind == TokenKind::Word).count(), 50_000);
        let all: Vec<TokenKind> = Tokens::new("r##\"a\"# r#\"b\"#").map(|token| token.kind).collect();
        assert_eq!(all.last(), Some(&TokenKind::RawText));
    }

    #[test]
    fn a_forgotten_quote_of_a_draft_ends_with_its_line() {
        let first =
            |text: &'static str| Tokens::of_draft(text).next().map(|token| (token.of(text), token.is_closed));
        assert_eq!(first("\"a\nb\", c"), Some(("\"a\nb\"", true)));
        assert_eq!(first("\"a\n \"b\", c"), Some(("\"a", false)));
        assert_eq!(first("\"a\nb"), Some(("\"a", false)));
    }

    #[test]
    fn a_byte_order_mark_is_passed_at_the_start_alone() {
        let kinds =
            |text: &str| Tokens::new(text).map(|token| (token.start(), token.kind)).collect::<Vec<_>>();
        assert_eq!(kinds("\u{feff}a"), [(3, TokenKind::Word)]);
        assert_eq!(kinds("\u{feff} // a"), [(4, TokenKind::LineComment)]);
        assert_eq!(kinds("\u{feff}"), []);
        assert_eq!(kinds("a \u{feff}"), [(0, TokenKind::Word), (2, TokenKind::Other)]);
        assert!(crate::read("\u{feff}(a: 1)").is_ok() && crate::read("\u{feff}\u{feff}(a: 1)").is_err());
    }

    #[test]
    fn tokens_cover_all_but_white_space_of_any_text() {
        let signs: Vec<char> =
            "()[]{}\"\\,:/*\n\r\t 09.-+eE_aT#r'bπ!\u{85}\u{a0}\u{200e}=;".chars().collect();
        let mut state = 1_u64;
        for _ in 0..20_000 {
            let mut text = String::new();
            for _ in 0..12 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                text.push(signs[(state >> 33) as usize % signs.len()]);
            }
            for tokens in [Tokens::new(&text), Tokens::of_draft(&text)] {
                let mut at = 0;
                for token in tokens {
                    assert!(text[at..token.start()].chars().all(is_white_space), "{text:?}");
                    assert!(token.end() > token.start() && text.get(token.span()).is_some(), "{text:?}");
                    at = token.end();
                }
                assert!(text[at..].chars().all(is_white_space), "{text:?}");
            }
        }
    }
}
