//! Words, signs and comments of a text, with the blanks between them.

use crate::scan::{block_comment, token};

/// What a token is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A word, a number or a quoted text.
    Atom,
    /// `(`, `[` or `{`.
    Open,
    /// `)`, `]` or `}`.
    Close,
    Comma,
    Colon,
    /// `// ...`, or an attribute such as `#![enable(...)]`, which needs a line of its own as well.
    Line,
    /// `/* ... */`
    Block,
}

impl Kind {
    pub(super) fn is_comment(self) -> bool {
        matches!(self, Kind::Line | Kind::Block)
    }
}

/// A token and where it stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Token<'a> {
    pub kind: Kind,
    pub text: &'a str,
    /// Line feeds between the token before and this one; 2 stands for more.
    pub feeds: u8,
    /// Signs between the token before, or the line's begin, and this one.
    pub gap: usize,
    /// Column, counted from 0.
    pub column: usize,
    /// Blanks at the begin of its line.
    pub indent: usize,
}

/// Takes a text apart. It has to be RON; of any other text tokens of some kind come out, too.
pub(super) fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut tokens = Vec::new();
    let (mut at, mut column, mut indent) = (0, 0, 0);
    let (mut feeds, mut gap) = (0u8, 0);
    while let Some(sign) = text[at..].chars().next() {
        let rest = &text[at..];
        if sign == '\n' {
            (feeds, gap, column, indent) = ((feeds + 1).min(2), 0, 0, 0);
            at += 1;
            continue;
        }
        if sign.is_whitespace() {
            (gap, column) = (gap + 1, column + 1);
            at += sign.len_utf8();
            continue;
        }
        if column == gap && (feeds > 0 || tokens.is_empty()) {
            indent = gap;
        }
        let (kind, length) = kind_and_length(rest);
        let mut shown = &rest[..length];
        if kind == Kind::Line {
            shown = shown.trim_end();
        }
        tokens.push(Token { kind, text: shown, feeds, gap, column, indent });
        column = match shown.rfind('\n') {
            Some(feed) => shown[feed + 1..].chars().count(),
            None => column + shown.chars().count(),
        };
        (feeds, gap) = (0, 0);
        at += length;
    }
    tokens
}

fn kind_and_length(rest: &str) -> (Kind, usize) {
    let line = || rest.find('\n').unwrap_or(rest.len());
    match rest.as_bytes()[0] {
        b'(' | b'[' | b'{' => (Kind::Open, 1),
        b')' | b']' | b'}' => (Kind::Close, 1),
        b',' => (Kind::Comma, 1),
        b':' => (Kind::Colon, 1),
        b'/' if rest.starts_with("//") => (Kind::Line, line()),
        b'/' if rest.starts_with("/*") => (Kind::Block, block_comment(rest)),
        b'#' if rest.starts_with("#!") => (Kind::Line, rest.find(']').map_or(rest.len(), |end| end + 1)),
        _ => (Kind::Atom, atom(rest)),
    }
}

/// Length of a word, a number, a quoted text or a character.
fn atom(rest: &str) -> usize {
    if rest.starts_with('\'') {
        let mut signs = rest.char_indices().skip(1);
        let first = signs.next();
        // The quote that ends it is not the one after a backslash.
        let from = if first.is_some_and(|(_, sign)| sign == '\\') { 3 } else { 1 };
        let end = rest.char_indices().filter(|(at, _)| *at >= from).skip(usize::from(from == 1));
        return end.into_iter().find(|(_, sign)| *sign == '\'').map_or(rest.len(), |(at, _)| at + 1);
    }
    let first = token(rest);
    if rest.starts_with('"') || (rest.starts_with('r') && first > 1) {
        return first;
    }
    // Such as `b"bytes"` or `br"raw"`: the word goes on to the end of the text.
    let word = rest
        .find(|c: char| c.is_whitespace() || ",:()[]{}\"'".contains(c) || c == '/')
        .unwrap_or(rest.len())
        .max(first);
    match rest[word..].chars().next() {
        Some('"' | '\'') => word + atom(&rest[word..]),
        _ => word,
    }
}
