//! Brackets and what stands in them, each with its comments.

use super::tokens::Placed;

/// A comment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Comment<'a> {
    pub token: Placed<'a>,
    /// An empty line stands above it.
    pub is_apart: bool,
}

/// A value, its name if it has one, and the comments that belong to it.
#[derive(Debug)]
pub(super) struct Item<'a> {
    /// Comments on lines of their own above it.
    pub above: Vec<Comment<'a>>,
    /// Comments on its line, before it.
    pub before: Vec<&'a str>,
    pub key: Option<&'a str>,
    /// Comments between its name and itself.
    pub between: Vec<&'a str>,
    pub value: Value<'a>,
    /// Comments behind it and before the comma.
    pub behind: Vec<&'a str>,
    /// Comments behind the comma, up to the end of the line.
    pub after: Vec<Comment<'a>>,
    /// The author began a line with it.
    pub begins_line: bool,
    /// An empty line stands above it.
    pub is_apart: bool,
    /// Columns on one line, if it may stand on one.
    pub width: Option<usize>,
}

/// What has brackets, and what has none.
#[derive(Debug)]
pub(super) enum Value<'a> {
    Atom(&'a str),
    Group(Group<'a>),
}

/// Brackets.
#[derive(Debug)]
pub(super) struct Group<'a> {
    /// `Gain` of `Gain(...)`; empty without.
    pub word: &'a str,
    pub open: &'a str,
    pub close: &'a str,
    pub items: Vec<Item<'a>>,
    /// Comments behind the last item.
    pub end: Vec<Comment<'a>>,
    /// The author ended the line behind the bracket.
    pub is_broken: bool,
}

/// A whole text.
#[derive(Debug)]
pub(super) struct File<'a> {
    pub value: Option<Item<'a>>,
    /// Comments below it.
    pub end: Vec<Comment<'a>>,
}
