//! Names in paths from the top: patterns of `record`, signals and states of `simulation`.

use std::collections::BTreeMap;

use blocksim_block::problem::Place;
use blocksim_signal::Value;

use super::gather::Gathered;
use super::of_parameter;
use crate::ast::PanelWord;
use crate::flatten::record::matches;
use crate::model::{Content, Model};
use blocksim_syntax::{Node, Shape};

/// Finds what the paths at the top name.
pub(super) fn paths(gathered: &mut Gathered, top: &Model, shared: &BTreeMap<String, Option<Value>>) {
    let ast = top.ast.clone();
    for pattern in ast.record.iter().flat_map(|entry| &entry.signals) {
        // The place of a text begins with its quote.
        path(gathered, top, &pattern.text, &ast.place(&pattern.span), Last::Port);
    }
    for element in &ast.panel {
        let Some((text, span)) = element.about() else { continue };
        let place = ast.place(span);
        let shows = matches!(element.kind, PanelWord::Gauge | PanelWord::Lamp);
        let last = if shows { Last::Port } else { Last::Parameter };
        let first = text.split(['.', '[', '/']).next().unwrap_or_default();
        let may_be = !shows && !text.contains('/') && of_parameter(shared, text);
        match ast.parameters.iter().find(|(name, _)| name.text == first && may_be) {
            Some((name, _)) => parameter(gathered, first, &place, &ast.place(&name.span)),
            None => path(gathered, top, text, &place, last),
        }
    }
    let Some(settings) = &ast.simulation else { return };
    let member = |node: &Node, wanted: &str| {
        node.members()?.iter().find(|(name, _)| name.text == wanted).map(|(_, node)| node.clone())
    };
    let mut named: Vec<(String, Place)> = Vec::new();
    let start = member(settings, "start");
    let start = |name: &str| start.as_ref().and_then(|start| member(start, name));
    for map in [start("hold"), member(settings, "atol")].into_iter().flatten() {
        let keys = map.members().unwrap_or_default().iter();
        named.extend(keys.map(|(name, _)| (name.text.clone(), ast.place(&name.span))));
    }
    for list in [start("free"), start("drift")].into_iter().flatten() {
        let Shape::List(items) = list.value else { continue };
        for item in items {
            if let Shape::Text(text) = item.value {
                named.push((text, ast.place(&item.span)));
            }
        }
    }
    named.iter().for_each(|(text, place)| path(gathered, top, text, place, Last::Port));
}

/// What stands behind the block of a path.
#[derive(Debug, Clone, Copy)]
enum Last {
    Port,
    Parameter,
}

/// The first name of a text between quotes is that of a parameter.
fn parameter(gathered: &mut Gathered, name: &str, whole: &Place, declared: &Place) {
    let Some(symbol) = gathered.symbol(declared) else { return };
    let start = whole.span.start + 1;
    let place = Place { file: whole.file, span: start..start + name.len() };
    gathered.mention(&place, name, symbol);
}

/// Finds what a path such as `arm/base/motor.w[0]` names, with stars or without; `whole` is its place with quotes.
fn path(gathered: &mut Gathered, top: &Model, text: &str, whole: &Place, last: Last) {
    let quote = usize::from(whole.span.len() == text.len() + 2);
    let place = |start: usize, name: &str| {
        let start = whole.span.start + quote + start;
        Place { file: whole.file, span: start..start + name.len() }
    };
    let mut levels = vec![top];
    let mut at = 0;
    for part in text.split('/') {
        let (block, behind) = part.split_once('.').map_or((part, None), |(block, rest)| (block, Some(rest)));
        let (block, _) = block.split_once('[').unwrap_or((block, ""));
        let is_pattern = block.contains('*');
        let mut below = Vec::new();
        // `**` reaches across levels.
        let here = if block.contains("**") { with_inner(&levels) } else { std::mem::take(&mut levels) };
        for level in here {
            for found in level.blocks.iter().filter(|found| matches(block, &found.name)) {
                match (is_pattern, gathered.symbol(&found.place)) {
                    (false, _) => gathered.block(&place(at, block), &found.place),
                    (true, Some(symbol)) if block.chars().any(|sign| sign != '*') => {
                        gathered.pattern(&place(at, block), block, symbol);
                    }
                    _ => {}
                }
                if let Some(port) = behind.map(|rest| rest.split(['.', '[']).next().unwrap_or_default()) {
                    let here = place(at + part.len() - behind.map_or(0, str::len), port);
                    match last {
                        Last::Port => gathered.port(&here, port, &found.place),
                        Last::Parameter => gathered.given(&here, port, &found.place),
                    }
                }
                if let Content::Diagram(inside) = &found.content {
                    below.push(&**inside);
                }
            }
        }
        levels = below;
        at += part.len() + 1;
    }
}

/// Diagrams and all inside them.
fn with_inner<'m>(levels: &[&'m Model]) -> Vec<&'m Model> {
    let mut all = levels.to_vec();
    let mut next = 0;
    while next < all.len() {
        for block in &all[next].blocks {
            if let Content::Diagram(inside) = &block.content {
                all.push(inside);
            }
        }
        next += 1;
    }
    all
}
