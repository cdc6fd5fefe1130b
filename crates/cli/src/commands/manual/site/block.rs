//! The page of a kind of block.

use blocksim_block::{BlockInfo, in_diagram};
use blocksim_diagram::HIERARCHY;
use blocksim_site::{Page, Part, escape_html};

use super::{BLOCK_EXAMPLES, example};
use crate::commands::blocks::port_rows;
use crate::terminal::prose::first_sentence;

/// Pictures of a page by path.
type Pictures = Vec<(String, Vec<u8>)>;

/// All kinds by category and name, those of the hierarchy first.
pub fn kinds() -> Vec<&'static BlockInfo> {
    static OF_HIERARCHY: [BlockInfo; 2] = HIERARCHY;
    OF_HIERARCHY.iter().chain(blocksim_block::kinds()).collect()
}

/// All kinds with their first sentences.
pub fn overview(kinds: &[&BlockInfo]) -> Page {
    let mut text = "# Blocks\n\nEvery kind of block, with its equation, parameters, ports, its drawing and a run of its example.\n".to_owned();
    let mut category = "";
    for info in kinds {
        if info.category != category {
            category = info.category;
            text.push_str(&format!("\n## {category}\n\n| kind | |\n|---|---|\n"));
        }
        text.push_str(&format!("| `{}` | {} |\n", info.kind, cell(&sentence(info.doc))));
    }
    let name = "All blocks".to_owned();
    Page {
        path: "blocks/index".to_owned(),
        group: "Blocks".to_owned(),
        name,
        parts: vec![Part::Markdown(text)],
    }
}

/// The first sentence of a comment as Markdown, formulas included.
fn sentence(doc: &str) -> String {
    let paragraph: Vec<&str> = doc.trim().lines().take_while(|line| !line.trim().is_empty()).collect();
    let text = paragraph.join(" ");
    // Formulas may hold points; the plain sentence says how many words it has.
    let words = first_sentence(doc).split_whitespace().count();
    if text.contains('$') { text } else { text.split_whitespace().take(words).collect::<Vec<_>>().join(" ") }
}

/// A text as a cell of a table.
fn cell(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|")
}

/// The page of a kind and its pictures.
pub fn page(info: &BlockInfo) -> (Page, Pictures) {
    let mut text = format!("# {}\n\n*{}*\n\n{}\n", info.kind, info.category, info.doc.trim());
    let ports = port_rows(info);
    if !ports.is_empty() {
        text.push_str("\n## Ports\n\nOf the example, with nothing connected.\n\n| name | | carries | unit | default | |\n|---|---|---|---|---|---|\n");
    }
    for (cells, doc) in ports {
        let cells: Vec<String> = cells.iter().map(|text| cell(text)).collect();
        text.push_str(&format!("| `{}` | {} | {} |\n", cells[0], cells[1..].join(" | "), cell(doc)));
    }
    if !info.parameters.is_empty() {
        text.push_str("\n## Parameters\n\n| name | unit | range | default | |\n|---|---|---|---|---|\n");
    }
    for parameter in info.parameters {
        let unit = if parameter.unit.is_empty() { "-" } else { parameter.unit };
        let range = match parameter.range() {
            range if range.is_empty() => "-".to_owned(),
            range => cell(&range),
        };
        let default = match parameter.default {
            None => "required".to_owned(),
            Some(default) => {
                in_diagram(default).map_or_else(|| "-".to_owned(), |text| format!("`{}`", cell(&text)))
            }
        };
        text.push_str(&format!(
            "| `{}` | {} | {range} | {default} | {} |\n",
            parameter.name,
            cell(unit),
            cell(parameter.doc)
        ));
    }
    let mut parts = vec![Part::Markdown(text)];
    let mut pictures = Vec::new();
    parts.push(Part::Markdown("## Example\n".to_owned()));
    match BLOCK_EXAMPLES.iter().find(|(kind, _)| *kind == info.kind) {
        Some((kind, diagram)) => shown(kind, diagram, &mut parts, &mut pictures),
        None => {
            let said = "The example above names other files, so it is not drawn and not run here; \
                        [the language](../language.md) shows it at work.\n";
            parts.push(Part::Markdown(said.to_owned()));
        }
    }
    let group = format!("Blocks: {}", info.category);
    (Page { path: format!("blocks/{}", info.kind), group, name: info.kind.to_owned(), parts }, pictures)
}

/// The diagram around the example, drawn and run.
fn shown(kind: &str, diagram: &str, parts: &mut Vec<Part>, pictures: &mut Pictures) {
    match example::shown(kind, diagram) {
        Ok(shown) => {
            let [light, dark] = ["light", "dark"].map(|theme| format!("pictures/{kind}-{theme}.svg"));
            parts.push(Part::Html(format!(
                "<figure>{}<figcaption>The example with what it needs to run</figcaption></figure>\n\
                 <figure><img class=\"on-light\" src=\"../{light}\" alt=\"Run of the example\" loading=\"lazy\">\
                 <img class=\"on-dark\" src=\"../{dark}\" alt=\"Run of the example\" loading=\"lazy\">\
                 <figcaption>Its run</figcaption></figure>",
                shown.drawing
            )));
            pictures.push((light, shown.light.into_bytes()));
            pictures.push((dark, shown.dark.into_bytes()));
        }
        Err(reason) => {
            let mut safe = String::new();
            // A string takes everything.
            let _ = escape_html(&mut safe, &reason);
            parts.push(Part::Html(format!("<p>The example does not run: {safe}</p>")));
        }
    }
    parts.push(Part::Markdown(format!("```ron\n{diagram}```\n")));
}
