//! Tokens with the blanks between them, which say how the author has laid a text out.

use crate::token::{TokenKind, Tokens};

/// A token and where it stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Placed<'a> {
    pub kind: TokenKind,
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

impl Placed<'_> {
    /// Whether it takes part in the layout only: a comment, or an attribute, which needs a line of its own as well.
    pub(super) fn is_comment(&self) -> bool {
        self.kind.is_comment() || self.kind == TokenKind::Attribute
    }

    /// Whether it is a word, a number or a quoted text.
    pub(super) fn is_atom(&self) -> bool {
        !self.is_comment()
            && !matches!(self.kind, TokenKind::Open | TokenKind::Close | TokenKind::Comma | TokenKind::Colon)
    }

    /// Whether nothing may follow on its line.
    pub(super) fn stands_alone(&self) -> bool {
        matches!(self.kind, TokenKind::LineComment | TokenKind::Attribute) || self.text.contains('\n')
    }
}

/// Takes a text apart.
pub(super) fn tokens(text: &str) -> Vec<Placed<'_>> {
    let mut tokens = Vec::new();
    let (mut behind, mut column, mut indent) = (0, 0, 0);
    for token in Tokens::new(text) {
        let between = &text[behind..token.start()];
        // Mostly there is one blank or none.
        let (feeds, gap) = match between {
            "" => (0, 0),
            " " => (0, 1),
            _ => {
                let line = between.rfind('\n').map_or(0, |feed| feed + 1);
                (between.matches('\n').take(2).count() as u8, between[line..].chars().count())
            }
        };
        if feeds > 0 || tokens.is_empty() {
            (column, indent) = (0, gap);
        }
        column += gap;
        let shown = token.of(text).trim_end();
        tokens.push(Placed { kind: token.kind, text: shown, feeds, gap, column, indent });
        column = match shown.rfind('\n') {
            Some(feed) => shown[feed + 1..].chars().count(),
            None => column + shown.chars().count(),
        };
        behind = token.end();
    }
    tokens
}
