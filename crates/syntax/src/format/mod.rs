//! The usual layout of a text: blanks, indentation, commas and lines of at most [`WIDTH`] columns.
//!
//! Where a line ends is the author's choice as long as it fits; everything else follows from rules. No word, number
//! or comment is changed, and names keep their order.

mod layout;
mod pieces;
mod reader;
mod tokens;
mod write;

#[cfg(test)]
mod tests;

use crate::token::{TokenKind, Tokens};
use crate::{Name, Node, Shape, SyntaxError, read};

/// Columns of a line; only a single word, a text or a comment may be longer.
pub const WIDTH: usize = 120;

/// Lays a text out anew. What is read of it stays the same, and so does each comment; a text that is laid out already
/// comes back as it is.
///
/// # Errors
/// The first place that is no RON.
pub fn format(text: &str) -> Result<String, SyntaxError> {
    let before = read(text)?;
    let file = reader::file(text);
    let formatted = write::written(&file, if text.contains("\r\n") { "\r\n" } else { "\n" });
    // Whatever a text may hold that was not thought of: it is rather left alone than changed.
    let kept =
        read(&formatted).is_ok_and(|after| same(&before, &after)) && comments(text) == comments(&formatted);
    if kept {
        return Ok(formatted);
    }
    let start = before.span.start;
    Err(SyntaxError::new(start..start, "this text cannot be laid out without changing it")
        .help("it was left as it is; write each value on a line of its own, and comments above them"))
}

/// Whether two trees hold the same, wherever it stands.
fn same(a: &Node, b: &Node) -> bool {
    let members = |a: &[(Name, Node)], b: &[(Name, Node)]| {
        a.len() == b.len() && a.iter().zip(b).all(|((n, a), (m, b))| n.text == m.text && same(a, b))
    };
    let items = |a: &[Node], b: &[Node]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b));
    let word = |word: &Option<Name>| word.as_ref().map(|word| word.text.clone());
    match (&a.value, &b.value) {
        (Shape::Number(a), Shape::Number(b)) => a.to_bits() == b.to_bits(),
        (Shape::List(a), Shape::List(b)) => items(a, b),
        (Shape::Tuple(n, a), Shape::Tuple(m, b)) => word(n) == word(m) && items(a, b),
        (Shape::Map(a), Shape::Map(b)) => members(a, b),
        (Shape::Struct(n, a), Shape::Struct(m, b)) => word(n) == word(m) && members(a, b),
        (a @ (Shape::Bool(_) | Shape::Text(_) | Shape::Word(_)), b) => a == b,
        _ => false,
    }
}

/// All comments, sorted; a comment of a line without the blanks at its end.
fn comments(text: &str) -> Vec<&str> {
    let all = Tokens::new(text).filter(|token| token.kind.is_comment() || token.kind == TokenKind::Attribute);
    let mut comments: Vec<&str> = all.map(|token| token.of(text).trim_end()).collect();
    comments.sort_unstable();
    comments
}
