//! What stands under the cursor.

use blocksim_block::BlockInfo;
use lsp_types::{Hover, HoverContents, MarkupContent, MarkupKind};

use crate::context::{Context, context, is_of_reference};
use crate::library::{Prose, about, kind, side};
use crate::models::Blocks;
use crate::names::{Section, declared};
use crate::position::span;
use crate::scan::{is_word, run_at};

/// What stands at a place of a text, if it is known.
pub fn hover(text: &str, at: usize, blocks: Option<&Blocks>, prose: Prose) -> Option<Hover> {
    let here = run_at(text, at, is_word);
    let word = &text[here.clone()];
    let (said, place) = match context(text, here.start) {
        Context::Connection { .. } => {
            let reference = run_at(text, at, is_of_reference);
            (of_reference(text, &text[reference.clone()], blocks)?, reference)
        }
        Context::Kind => (page(kind(word)?, prose), here),
        Context::Parameter { kind: name, .. } => {
            let parameter = kind(name)?.parameters.iter().find(|parameter| parameter.name == word)?;
            let doc = prose(parameter.doc.trim());
            (format!("`{name}.{word}` ({})\n\n{doc}", about(parameter)), here)
        }
        Context::Expression => (of_parameter(text, word)?, here),
        _ => return None,
    };
    let contents = HoverContents::Markup(MarkupContent { kind: MarkupKind::Markdown, value: said });
    Some(Hover { contents, range: Some(span(text, &place)) })
}

/// The page of a kind with its parameters.
fn page(info: &BlockInfo, prose: Prose) -> String {
    let mut page = format!("**{}** ({})\n\n{}", info.kind, info.category, prose(info.doc.trim()));
    if !info.parameters.is_empty() {
        page.push_str("\n\n| parameter | | |\n|---|---|---|\n");
    }
    for parameter in info.parameters {
        let doc = prose(parameter.doc.trim()).replace('\n', " ").replace('|', "\\|");
        page.push_str(&format!("| `{}` | {} | {doc} |\n", parameter.name, about(parameter)));
    }
    page
}

/// A block of this file and its port.
fn of_reference(text: &str, reference: &str, blocks: Option<&Blocks>) -> Option<String> {
    let (name, port) = reference.split_once('.').unwrap_or((reference, ""));
    let declared = declared(text);
    let block =
        declared.iter().find(|declared| declared.section == Section::Block && declared.name == name)?;
    let mut said = format!("`{name}`: {}", block.kind);
    let ports = blocks.and_then(|blocks| blocks.get(name)).map(Vec::as_slice).unwrap_or_default();
    let port = port.split(['.', '[']).next().unwrap_or_default();
    if let Some(port) = ports.iter().find(|known| known.name == port) {
        said.push_str(&format!("\n\n`{}` ({})", port.name, side(port)));
        if !port.doc.is_empty() {
            said.push_str(&format!(": {}", port.doc));
        }
    }
    Some(said)
}

/// The line that declares a parameter of the diagram.
fn of_parameter(text: &str, word: &str) -> Option<String> {
    let declared = declared(text);
    let parameter = declared.iter().find(|d| d.section == Section::Parameter && d.name == word)?;
    let line = text[parameter.place.start - 1..].lines().next().unwrap_or_default();
    Some(format!("```ron\n{}\n```", line.trim_end()))
}
