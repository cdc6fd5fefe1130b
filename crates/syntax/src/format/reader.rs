//! A text taken apart into pieces.

use super::layout;
use super::pieces::{Comment, File, Group, Item, Value};
use super::tokens::{Placed, tokens};
use crate::token::TokenKind;

/// Takes a text apart that has been read before.
pub(super) fn file(text: &str) -> File<'_> {
    let mut reader = Reader { tokens: tokens(text), at: 0 };
    let (mut items, end) = reader.items();
    File { value: (!items.is_empty()).then(|| items.swap_remove(0)), end }
}

struct Reader<'a> {
    tokens: Vec<Placed<'a>>,
    at: usize,
}

impl<'a> Reader<'a> {
    fn peek(&self) -> Option<Placed<'a>> {
        self.tokens.get(self.at).copied()
    }

    fn take(&mut self, is_wanted: impl Fn(&Placed) -> bool) -> Option<Placed<'a>> {
        let token = self.peek().filter(is_wanted)?;
        self.at += 1;
        Some(token)
    }

    fn comments(&mut self) -> Vec<Placed<'a>> {
        let start = self.at;
        while self.peek().is_some_and(|token| token.is_comment()) {
            self.at += 1;
        }
        self.tokens[start..self.at].to_vec()
    }

    /// The first token that is no comment.
    fn kind_ahead(&self) -> Option<TokenKind> {
        self.tokens[self.at..].iter().find(|token| !token.is_comment()).map(|token| token.kind)
    }

    /// Items up to a closing bracket or the end, and the comments behind the last.
    fn items(&mut self) -> (Vec<Item<'a>>, Vec<Comment<'a>>) {
        let mut items: Vec<Item<'a>> = Vec::new();
        // Comments that stand before the comma on lines of their own.
        let mut late = Vec::new();
        loop {
            let mut above: Vec<Comment<'a>> = std::mem::take(&mut late);
            above.extend(self.comments().into_iter().map(comment));
            let Some(first) = self.peek().filter(|token| token.is_atom() || token.kind == TokenKind::Open)
            else {
                return (items, above);
            };
            let mut item = self.item(first, above);
            let mut here = self.comments();
            let below = here.split_off(here.iter().take_while(|token| token.feeds == 0).count());
            let has_comma = self.take(|token| token.kind == TokenKind::Comma).is_some();
            let goes_on = has_comma || (below.is_empty() && self.peek().is_some_and(|next| next.feeds == 0));
            if goes_on && !here.iter().any(Placed::stands_alone) {
                item.behind.extend(here.iter().map(|token| token.text));
            } else {
                item.after.extend(here.into_iter().map(comment));
            }
            late.extend(below.into_iter().map(comment));
            if has_comma && late.is_empty() {
                self.rest_of_line(&mut item);
            }
            item.width = layout::width_of_item(&item);
            items.push(item);
        }
    }

    /// Comments behind a comma up to the end of the line; one before another value belongs to that.
    fn rest_of_line(&mut self, item: &mut Item<'a>) {
        let start = self.at;
        let found = self.comments();
        let here = found.iter().take_while(|token| token.feeds == 0).count();
        let ends = found.len() > here
            || self.peek().is_none_or(|next| next.feeds > 0 || next.kind == TokenKind::Close);
        let ends = ends || found[..here].iter().any(Placed::stands_alone);
        let taken = if ends { here } else { 0 };
        item.after.extend(found[..taken].iter().copied().map(comment));
        self.at = start + taken;
    }

    fn item(&mut self, first: Placed<'a>, above: Vec<Comment<'a>>) -> Item<'a> {
        let mut key = None;
        let mut head = Vec::new();
        if first.is_atom() {
            self.at += 1;
            if self.kind_ahead() == Some(TokenKind::Colon) {
                key = Some(first.text);
                head.extend(self.comments());
                self.at += 1;
                head.extend(self.comments());
            } else {
                self.at -= 1;
            }
        }
        let value = self.value(&mut head);
        // Of the comments above, the last ones may stand on the line of the value.
        let (mut above, mut before) = (above, Vec::new());
        let mut begins_line = first.feeds > 0;
        let mut is_apart = first.feeds > 1;
        while !begins_line
            && let Some(last) = above.last()
            && !last.token.stands_alone()
        {
            begins_line = last.token.feeds > 0;
            is_apart = last.token.feeds > 1;
            before.insert(0, last.token.text);
            above.pop();
        }
        let mut between: Vec<&str> = Vec::new();
        if head.iter().any(Placed::stands_alone) {
            above.extend(head.into_iter().map(comment));
        } else {
            between = head.iter().map(|token| token.text).collect();
        }
        let (behind, after) = (Vec::new(), Vec::new());
        Item { above, before, key, between, value, behind, after, begins_line, is_apart, width: None }
    }

    /// A value; comments before its bracket come to `head`.
    fn value(&mut self, head: &mut Vec<Placed<'a>>) -> Value<'a> {
        let mut word = "";
        if let Some(atom) = self.take(|token| token.is_atom()) {
            if self.kind_ahead() != Some(TokenKind::Open) {
                return Value::Atom(atom.text);
            }
            word = atom.text;
            head.extend(self.comments());
        }
        let Some(open) = self.take(|token| token.kind == TokenKind::Open) else { return Value::Atom(word) };
        let is_broken = self.peek().is_some_and(|next| next.feeds > 0 && next.kind != TokenKind::Close);
        let (items, end) = self.items();
        let close = self.take(|token| token.kind == TokenKind::Close).map_or("", |token| token.text);
        Value::Group(Group { word, open: open.text, close, items, end, is_broken })
    }
}

fn comment(token: Placed<'_>) -> Comment<'_> {
    Comment { token, is_apart: token.feeds > 1 }
}
