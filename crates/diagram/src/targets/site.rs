//! Where a value is written that does not stand in the text yet.

use std::ops::Range;

use blocksim_block::problem::{FileId, Place};

use super::{Site, Spelling};
use crate::ast::BlockAst;
use blocksim_syntax::{Name, Node};

/// A parameter of a block: behind the last one, or in parentheses of its own.
pub(super) fn parameter(block: &BlockAst, file: FileId, text: &str, name: &str) -> Site {
    behind(&block.parameters, &block.span, file, text, &format!("{name}: "), "")
}

/// A parameter that a subsystem is given: behind the last one in `with`, or in a `with` of its own.
pub(super) fn given(block: &BlockAst, file: FileId, text: &str, name: &str, spelling: Spelling) -> Site {
    // A default may be a text by what is around it; here nothing is.
    let (open, close) = if spelling == Spelling::Text { ("Text(", ")") } else { ("", "") };
    let with = block.parameters.iter().find(|(known, _)| known.text == "with").map(|(_, node)| node);
    match with.and_then(|with| Some((with, with.members()?))) {
        Some((with, members)) => {
            let quote =
                if text.get(with.span.clone()).is_some_and(|text| text.starts_with('{')) { "\"" } else { "" };
            behind(members, &with.span, file, text, &format!("{quote}{name}{quote}: {open}"), close)
        }
        None => {
            let before = format!("with: {{ \"{name}\": {open}");
            behind(&block.parameters, &block.span, file, text, &before, &format!("{close} }}"))
        }
    }
}

/// Behind the last member of what stands in brackets.
fn behind(
    members: &[(Name, Node)],
    around: &Range<usize>,
    file: FileId,
    text: &str,
    before: &str,
    after: &str,
) -> Site {
    let at = |at: usize, before: String, after: String| Site {
        place: Place { file, span: at..at },
        before,
        after,
    };
    if let Some((_, last)) = members.last() {
        return at(last.span.end, format!(", {before}"), after.to_owned());
    }
    let written = text.get(around.clone()).unwrap_or_default();
    match written.find(['(', '{']) {
        // Only comments and the label of a block can stand there, which is not among its parameters.
        Some(open) => {
            let inside = written[open + 1..].trim_end_matches([')', '}']).trim();
            let comma = if inside.is_empty() { "" } else { ", " };
            at(around.start + open + 1, before.to_owned(), format!("{after}{comma}"))
        }
        None => at(around.end, format!("({before}"), format!("{after})")),
    }
}
