//! What stands under the cursor.

use blocksim_block::BlockInfo;
use blocksim_syntax::{Name, Node};
use lsp_types::{Hover, HoverContents, MarkupContent, MarkupKind};

use crate::position::span;
use blocksim_edit::Blocks;
use blocksim_edit::{Context, context, is_of_reference};
use blocksim_edit::{Declared, Section, declared};
use blocksim_edit::{Prose, about, kind, side};
use blocksim_syntax::{is_word, run_at};

/// What stands at a place of a text, if it is known.
pub fn hover(text: &str, at: usize, blocks: Option<&Blocks>, prose: Prose) -> Option<Hover> {
    let here = run_at(text, at, is_word);
    let word = &text[here.clone()];
    // The name of a block where it is declared.
    let declared = declared(text);
    let is_here = |known: &&Declared| known.section == Section::Block && known.place == here;
    if let Some(block) = declared.iter().find(is_here) {
        let markdown = of_block(text, block, blocks, prose);
        return Some(Hover { contents: contents(markdown), range: Some(span(text, &here)) });
    }
    let (markdown, place) = match context(text, here.start) {
        Context::Connection { .. } => {
            let reference = run_at(text, at, is_of_reference);
            let dot = text[reference.clone()].find('.').map(|dot| reference.start + dot);
            let block = declared.iter().find(|known| {
                known.section == Section::Block
                    && text[reference.clone()].split('.').next() == Some(known.name)
            });
            match (block, dot) {
                (Some(block), dot) if dot.is_none_or(|dot| at <= dot) => {
                    (of_block(text, block, blocks, prose), reference.start..dot.unwrap_or(reference.end))
                }
                _ => (of_reference(text, &text[reference.clone()], blocks)?, reference),
            }
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
    Some(Hover { contents: contents(markdown), range: Some(span(text, &place)) })
}

fn contents(value: String) -> HoverContents {
    HoverContents::Markup(MarkupContent { kind: MarkupKind::Markdown, value })
}

/// A block with its kind, its parameters as set and its ports.
fn of_block(text: &str, block: &Declared, blocks: Option<&Blocks>, prose: Prose) -> String {
    let facts = blocks.and_then(|blocks| blocks.get(block.name)).cloned().unwrap_or_default();
    let info = kind(block.kind);
    let category = info.map(|info| format!(" ({})", info.category)).unwrap_or_default();
    let mut markdown = format!("**{}**: {}{category}", block.name, block.kind);
    if let Some(chosen) = &facts.chosen {
        markdown.push_str(&format!(", here `{chosen}`"));
    }
    if let Some(info) = info {
        let doc = prose(info.doc.trim());
        markdown.push_str(&format!("\n\n{}", doc.split("\n\n").next().unwrap_or_default()));
    }
    let written = written(text, block.name);
    if !written.is_empty() {
        markdown.push_str("\n\n| parameter | written | value |\n|---|---|---|\n");
    }
    for (name, value) in written {
        let known = facts.values.iter().find(|(known, _)| *known == name);
        let number = known.map(|(_, number)| number.as_str()).unwrap_or_default();
        markdown.push_str(&format!("| `{name}` | `{}` | {number} |\n", value.replace('|', "\\|")));
    }
    if !facts.ports.is_empty() {
        markdown.push_str("\n\n| port | | |\n|---|---|---|\n");
    }
    for port in &facts.ports {
        let doc = prose(port.doc.trim()).replace('\n', " ").replace('|', "\\|");
        markdown.push_str(&format!("| `{}` | {} | {} |\n", port.name, side(port), doc.trim()));
    }
    markdown
}

/// Most signs of a value that are shown.
const LONGEST: usize = 60;

/// Parameters of a block as the text sets them; none while the text cannot be read.
fn written(text: &str, block: &str) -> Vec<(String, String)> {
    let Ok(root) = blocksim_syntax::read(text) else { return Vec::new() };
    let member = |node: &'_ Node, name: &str| -> Option<Node> {
        node.members()?.iter().find(|(known, _)| known.text == name).map(|(_, node)| node.clone())
    };
    let Some(block) = member(&root, "blocks").and_then(|blocks| member(&blocks, block)) else {
        return Vec::new();
    };
    let one = |(name, node): &(Name, Node)| {
        let value = text.get(node.span.clone()).unwrap_or_default();
        let line = value.split_whitespace().collect::<Vec<_>>().join(" ");
        let cut: String = line.chars().take(LONGEST).collect();
        let dots = if cut.len() < line.len() { " ..." } else { "" };
        (name.text.clone(), format!("{cut}{dots}"))
    };
    block.members().unwrap_or_default().iter().map(one).collect()
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
    let mut markdown = format!("`{name}`: {}", block.kind);
    let facts = blocks.and_then(|blocks| blocks.get(name));
    let ports = facts.map(|facts| facts.ports.as_slice()).unwrap_or_default();
    let port = port.split(['.', '[']).next().unwrap_or_default();
    if let Some(port) = ports.iter().find(|known| known.name == port) {
        markdown.push_str(&format!("\n\n`{}` ({})", port.name, side(port)));
        if !port.doc.is_empty() {
            markdown.push_str(&format!(": {}", port.doc));
        }
    }
    Some(markdown)
}

/// The line that declares a parameter of the diagram.
fn of_parameter(text: &str, word: &str) -> Option<String> {
    let declared = declared(text);
    let parameter = declared.iter().find(|d| d.section == Section::Parameter && d.name == word)?;
    let line = text[parameter.place.start - 1..].lines().next().unwrap_or_default();
    Some(format!("```ron\n{}\n```", line.trim_end()))
}
