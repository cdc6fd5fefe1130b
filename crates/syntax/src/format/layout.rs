//! How wide pieces are, and what stands on one line.

use super::WIDTH;
use super::pieces::{Group, Item, Value};

/// How the inside of brackets is laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// On one line.
    Flat,
    /// All on the line of the bracket up to the last item, whose bracket spans lines: `Variant(of: {` ... `})`.
    Hugging,
    /// Between lines of its brackets, lines as the author ended them.
    Broken,
    /// The same; lines are filled.
    Filled,
    /// The same; a line for each item.
    Listed,
}

/// Columns of what stands around the items: brackets, and blanks in braces that hold something.
fn around(group: &Group) -> usize {
    let blanks = if group.open == "{" && !group.items.is_empty() { 2 } else { 0 };
    columns(group.word) + 2 + blanks
}

/// Columns of a text on one line.
pub(super) fn columns(text: &str) -> usize {
    text.chars().count()
}

/// Columns of an item on one line, if it may stand on one.
pub(super) fn width_of_item(item: &Item) -> Option<usize> {
    let has_lines = !item.above.is_empty() || !item.after.is_empty();
    (!has_lines).then(|| width_of_line(item))?
}

/// The same, whatever stands above it and behind its comma.
pub(super) fn width_of_line(item: &Item) -> Option<usize> {
    let value = match &item.value {
        Value::Atom(text) => (!text.contains('\n')).then(|| columns(text))?,
        Value::Group(group) => width_of_group(group)?,
    };
    Some(width_before_value(item) + value + words(&item.behind))
}

fn words(comments: &[&str]) -> usize {
    comments.iter().map(|text| columns(text) + 1).sum()
}

/// Columns up to the value.
fn width_before_value(item: &Item) -> usize {
    words(&item.before) + item.key.map_or(0, |key| columns(key) + 2) + words(&item.between)
}

fn width_of_group(group: &Group) -> Option<usize> {
    let is_open =
        group.is_broken || !group.end.is_empty() || group.items.iter().skip(1).any(|item| item.begins_line);
    if is_open {
        return None;
    }
    let items: Option<usize> = group.items.iter().map(|item| item.width).sum();
    Some(around(group) + items? + 2 * group.items.len().saturating_sub(1))
}

/// Whether a value takes several lines however long they may be.
pub(super) fn spans_lines(value: &Value) -> bool {
    matches!(value, Value::Group(group) if width_of_group(group).is_none())
}

/// Columns of the first line of an item that spans several.
pub(super) fn width_of_head(item: &Item) -> usize {
    let value = match &item.value {
        Value::Atom(text) => columns(text.lines().next().unwrap_or_default()),
        Value::Group(group) if may_hug(group) => {
            let (last, earlier) = group.items.split_last().expect("an item to hug");
            let earlier: usize = earlier.iter().map(|item| item.width.unwrap_or(0) + 2).sum();
            columns(group.word) + 1 + earlier + width_of_head(last)
        }
        Value::Group(group) => columns(group.word) + 1,
    };
    width_before_value(item) + value
}

/// Whether the last item alone spans lines, and the author began none before it.
fn may_hug(group: &Group) -> bool {
    let Some((last, earlier)) = group.items.split_last() else { return false };
    let is_plain = !group.is_broken && group.open != "{" && group.end.is_empty();
    let begins = group.items.iter().skip(1).any(|item| item.begins_line);
    let last_spans = last.width.is_none()
        && last.above.is_empty()
        && last.after.is_empty()
        && last.behind.is_empty()
        && matches!(last.value, Value::Group(_));
    is_plain && !begins && last_spans && earlier.iter().all(|item| item.width.is_some())
}

/// The form of brackets whose word begins in `column`, whose items are indented by `indent`, and behind which `reserve`
/// signs must stand on the same line.
pub(super) fn form(group: &Group, column: usize, indent: usize, reserve: usize) -> Form {
    if let Some(width) = width_of_group(group) {
        if column + width + reserve <= WIDTH || group.items.is_empty() {
            return Form::Flat;
        }
        let inside: usize = group.items.iter().map(|item| item.width.unwrap_or(0)).sum();
        if indent + inside + 2 * (group.items.len() - 1) < WIDTH {
            return Form::Broken;
        }
        let fills = (is_row(group) && !has_connections(group)) || is_call(group, indent);
        return if fills { Form::Filled } else { Form::Listed };
    }
    if may_hug(group) {
        let (last, earlier) = group.items.split_last().expect("an item to hug");
        let earlier: usize = earlier.iter().map(|item| item.width.unwrap_or(0) + 2).sum();
        if column + columns(group.word) + 1 + earlier + width_of_head(last) <= WIDTH {
            return Form::Hugging;
        }
    }
    if is_row(group) && has_long_line(group, indent) { Form::Filled } else { Form::Broken }
}

/// Numbers or texts in a row, without names and comments.
fn is_row(group: &Group) -> bool {
    let is_plain = |item: &Item| {
        item.key.is_none() && item.width.is_some() && !item.is_apart && matches!(item.value, Value::Atom(_))
    };
    group.end.is_empty() && group.items.iter().all(is_plain)
}

/// Texts such as `"a.y -> b.u"`, which are read one by one.
fn has_connections(group: &Group) -> bool {
    group.items.iter().any(|item| matches!(item.value, Value::Atom(text) if text.contains("->")))
}

/// Parameters of something, each short enough for a line.
fn is_call(group: &Group, indent: usize) -> bool {
    let fits = |item: &Item| item.width.is_some_and(|width| indent + width < WIDTH);
    group.open == "(" && group.items.iter().all(|item| item.key.is_some() && fits(item))
}

fn has_long_line(group: &Group, indent: usize) -> bool {
    let mut column = indent;
    for (n, item) in group.items.iter().enumerate() {
        if n > 0 && item.begins_line {
            column = indent;
        }
        column += item.width.unwrap_or(0) + 1;
        // A single item cannot be helped.
        if column > WIDTH && column > indent + item.width.unwrap_or(0) + 1 {
            return true;
        }
        column += 1;
    }
    false
}
