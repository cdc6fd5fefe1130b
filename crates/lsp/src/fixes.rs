//! Changes that mend problems, as an editor offers them.

use blocksim_block::problem::Problem;
use blocksim_diagram::SourceFile;
use lsp_types::{Diagnostic, Range as Span, TextEdit, Uri};
use serde_json::{Value, json};

use crate::position::span;

/// A problem with the change that mends it.
#[derive(Debug, Clone, PartialEq)]
pub struct Fix {
    diagnostic: Diagnostic,
    edit: TextEdit,
}

/// The change that a problem carries, if it is one of the file in which the problem is shown.
pub fn fix(problem: &Problem, diagnostic: &Diagnostic, files: &[SourceFile]) -> Option<Fix> {
    let edit = problem.remedy()?;
    let shown = problem.labels.first()?.place.file;
    let text = &files.get(edit.place.file.0 as usize)?.text;
    let fits = edit.place.file == shown && text.get(edit.place.span.clone()) == Some(edit.old.as_str());
    let edit = TextEdit { range: span(text, &edit.place.span), new_text: edit.new.clone() };
    fits.then(|| Fix { diagnostic: diagnostic.clone(), edit })
}

/// The changes that mend problems of a place, as the protocol writes them.
pub fn offered(fixes: &[Fix], uri: &Uri, place: &Span) -> Vec<Value> {
    let meets = |fix: &&Fix| {
        let range = fix.diagnostic.range;
        range.start <= place.end && place.start <= range.end
    };
    let action = |fix: &Fix| {
        let new = &fix.edit.new_text;
        let title = if fix.edit.range.start == fix.edit.range.end {
            format!("Add `{new}`")
        } else {
            format!("Write `{new}`")
        };
        json!({
            "title": title,
            "kind": "quickfix",
            "isPreferred": true,
            "diagnostics": [fix.diagnostic],
            "edit": { "changes": { uri.as_str(): [fix.edit] } },
        })
    };
    fixes.iter().filter(meets).map(action).collect()
}
