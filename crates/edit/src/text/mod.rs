//! Changes of a text that leave everything else in it as it is.

mod entries;
mod wires;

use std::ops::Range;

pub(crate) use entries::{Entries, indentation, line_feed};
pub(crate) use wires::{Wire, Wires};

/// Bytes of a text that are replaced.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Splice {
    /// What is replaced; nothing where it is empty.
    pub span: Range<usize>,
    /// What stands there then.
    pub new: String,
}

impl Splice {
    pub(crate) fn new(span: Range<usize>, new: impl Into<String>) -> Splice {
        Splice { span, new: new.into() }
    }
}

/// The text with all changes; `None` where two of them meet.
pub(crate) fn spliced(text: &str, mut splices: Vec<Splice>) -> Option<String> {
    splices.sort_by_key(|splice| (splice.span.start, splice.span.end));
    let mut new = String::with_capacity(text.len());
    let mut at = 0;
    for splice in splices {
        new.push_str(text.get(at..splice.span.start)?);
        new.push_str(&splice.new);
        at = splice.span.end;
    }
    new.push_str(text.get(at..)?);
    Some(new)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_made_in_any_order_unless_they_meet() {
        let made = |all: &[(Range<usize>, &str)]| {
            spliced("abcdef", all.iter().map(|(span, new)| Splice::new(span.clone(), *new)).collect())
        };
        assert_eq!(made(&[(4..5, "E"), (0..2, ""), (3..3, "+")]).as_deref(), Some("c+dEf"));
        assert_eq!(made(&[(1..3, ""), (2..4, "")]), None);
        assert_eq!(made(&[(1..3, "x"), (3..4, "y")]).as_deref(), Some("axyef"));
        assert_eq!(made(&[]).as_deref(), Some("abcdef"));
    }
}
