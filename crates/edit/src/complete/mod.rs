//! What may follow at the cursor, also in a text that is half written.

mod context;
mod facts;
mod library;

use std::path::Path;

use std::collections::BTreeMap;

use blocksim_block::{BlockInfo, ParameterInfo};
use blocksim_diagram::{PanelWord, Step, members, words};
use blocksim_syntax::run_at;

pub use context::{Context, context, is_of_reference};
pub use facts::{Blocks, Facts, Learned, Port};
pub use library::{Prose, about, all_kinds, kind, side};

use crate::declared::{Section, declared};

/// What a completion is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CompletionKind {
    /// A section of a diagram.
    Section,
    /// A kind of block.
    Kind,
    /// A name of a value: a parameter, a port.
    Member,
    /// A word that stands as a value.
    Word,
    /// A block, or a parameter of the diagram.
    Name,
    /// A file.
    File,
    /// A folder.
    Folder,
}

/// What may follow at a place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Completion {
    /// As it is listed.
    pub label: String,
    /// What it is.
    pub kind: CompletionKind,
    /// A few words beside it; may be empty.
    pub detail: String,
    /// Markdown that explains it; may be empty.
    pub doc: String,
    /// What is written.
    pub insert: String,
    /// Whether places to be filled in stand there as `$1` or `${1}`.
    pub has_places: bool,
}

/// Sections of a diagram and what they are for.
const SECTIONS: [(&str, &str); 10] = [
    ("title", "A name for people."),
    ("parameters", "Names for values, which `--set` can replace."),
    ("simulation", "End, method and times of the output."),
    ("inputs", "Signals that come in, if this is a subsystem."),
    ("outputs", "Signals that go out, if this is a subsystem."),
    ("ports", "Conserving ports, if this is a subsystem."),
    ("blocks", "Blocks by name, in the order of the signals."),
    ("connections", "Signals `a.y -> b.u` and joints `a.r <-> b.r`."),
    ("record", "Signals to record beside those of scopes."),
    ("panel", "What of the model is turned and shown while it runs."),
];

/// Settings of a simulation.
const SETTINGS: [(&str, &str); 5] = [
    ("stop_time", "When the run ends: a time, or `Auto(margin: \"0.5 s\")`."),
    ("solver", "The method, with tolerances or step."),
    ("output", "`Steps`, or `Every(\"1 ms\")`."),
    ("start", "`Given`: initial values as they are written; `Steady`: a steady state near them."),
    ("seed", "A whole number for blocks that draw random numbers."),
];

/// Where a run begins.
const STARTS: [(&str, &str); 2] = [
    ("Given", "At the initial values of the blocks."),
    ("Steady", "In a steady state near the initial values; `Steady(hold: ..., free: ...)` trims."),
];

/// What a steady start is to fulfil.
const STEADY: [(&str, &str); 3] = [
    ("hold", "Signals that have a value there: `{\"motor.w\": \"100 rad/s\"}`."),
    ("free", "Constants whose values are found: `[\"volts.value\"]`."),
    ("drift", "States, or blocks with all of theirs, that may go on moving: `[\"path.x\"]`."),
];

/// What may follow at a place of a text; `blocks` are those of the file as they were last known, `folder` that of the
/// file, `snippets` whether the editor fills in places to be written.
pub fn complete(
    text: &str,
    at: usize,
    blocks: Option<&Blocks>,
    choices: &BTreeMap<String, Vec<String>>,
    folder: &Path,
    snippets: bool,
    prose: Prose,
) -> Vec<Completion> {
    match context(text, at) {
        Context::Section { given } => {
            let missing = SECTIONS.iter().filter(|(name, _)| !given.contains(name));
            let item = |&(name, doc): &(&str, &str)| {
                item(name, CompletionKind::Section, "", doc, format!("{name}: "))
            };
            missing.map(item).collect()
        }
        Context::Kind => all_kinds().into_iter().map(|info| of_kind(info, snippets, prose)).collect(),
        Context::Parameter { kind: name, given } => {
            let parameters = kind(name).map(|info| info.parameters).unwrap_or_default();
            parameters.iter().filter(|parameter| !given.contains(&parameter.name)).map(of_parameter).collect()
        }
        Context::Member { kind, brackets, given } => {
            let missing = members(kind, &brackets).into_iter().filter(|name| !given.contains(name));
            missing.map(|name| item(name, CompletionKind::Member, "", "", format!("{name}: "))).collect()
        }
        Context::Word { kind, brackets, key } => {
            let words = words(kind, &brackets, key);
            words.into_iter().map(|word| of_word(word, (kind, &brackets, key), snippets)).collect()
        }
        Context::Alternative { given, before } => {
            let names = chosen_by(before).and_then(|name| choices.get(name)).map(Vec::as_slice);
            let missing = names.unwrap_or_default().iter().filter(|name| !given.contains(&name.as_str()));
            missing.map(|name| item(name, CompletionKind::Word, "alternative", "", name.clone())).collect()
        }
        Context::Setting { given } => keys(&SETTINGS, &given),
        Context::Steady { given } => keys(&STEADY, &given),
        Context::Start => STARTS
            .iter()
            .map(|&(word, doc)| item(word, CompletionKind::Word, "", doc, word.to_owned()))
            .collect(),
        Context::Connection { before } => connections(text, before, blocks),
        Context::Panel => PanelWord::ALL.into_iter().map(|word| of_element(word, snippets)).collect(),
        Context::PanelMember { word, given } => {
            let missing = word.members().iter().filter(|name| !given.contains(name));
            missing.map(|name| item(name, CompletionKind::Member, "", "", format!("{name}: "))).collect()
        }
        Context::PanelName { word } => panel_names(text, word, blocks),
        Context::File => files(folder, text, at),
        Context::Expression => declared(text)
            .iter()
            .filter(|declared| declared.section == Section::Parameter)
            .map(|declared| {
                item(declared.name, CompletionKind::Name, "parameter", "", declared.name.to_owned())
            })
            .collect(),
        Context::Other => Vec::new(),
    }
}

/// An element of a panel.
fn of_element(word: PanelWord, snippets: bool) -> Completion {
    let (name, places) = match word {
        PanelWord::Slider | PanelWord::Knob | PanelWord::Gauge => (word.name(), "(\"$1\", \"$2 .. $3\")"),
        PanelWord::Switch | PanelWord::Button | PanelWord::Lamp => (word.name(), "(\"$1\")"),
    };
    let insert = if snippets { format!("{name}{places}") } else { name.to_owned() };
    Completion { has_places: snippets, ..item(name, CompletionKind::Kind, "panel", word.what(), insert) }
}

/// Parameters that an element can change, or signals that it can show, of the diagram itself.
fn panel_names(text: &str, word: PanelWord, blocks: Option<&Blocks>) -> Vec<Completion> {
    if matches!(word, PanelWord::Gauge | PanelWord::Lamp) {
        let of_block = |(block, facts): (&String, &Facts)| {
            let outputs = facts.ports.iter().filter(|port| port.side == "output");
            let named = outputs.map(|port| {
                let name = format!("{block}.{}", port.name);
                item(&name, CompletionKind::Member, &side(port), &port.doc, name.clone())
            });
            named.collect::<Vec<_>>()
        };
        return blocks.into_iter().flatten().flat_map(of_block).collect();
    }
    let declared = declared(text);
    let of_diagram = declared.iter().filter(|declared| declared.section == Section::Parameter);
    let mut found: Vec<Completion> = of_diagram
        .map(|one| item(one.name, CompletionKind::Name, "parameter", "", one.name.to_owned()))
        .collect();
    for block in declared.iter().filter(|declared| declared.section == Section::Block) {
        let parameters = kind(block.kind).map(|info| info.parameters).unwrap_or_default();
        found.extend(parameters.iter().map(|parameter| {
            let name = format!("{}.{}", block.name, parameter.name);
            item(&name, CompletionKind::Member, &about(parameter), parameter.doc.trim(), name.clone())
        }));
    }
    found
}

/// A word that may stand as a value, with parentheses where it has members.
fn of_word(word: &str, (kind, brackets, key): (&str, &[Step], &str), snippets: bool) -> Completion {
    let mut inside = brackets.to_vec();
    inside.push(Step { key: key.to_owned(), word: word.to_owned(), sign: '(' });
    let has_members = !members(kind, &inside).is_empty();
    let insert = match (has_members, snippets) {
        (true, true) => format!("{word}($1)"),
        _ => word.to_owned(),
    };
    Completion { has_places: has_members && snippets, ..item(word, CompletionKind::Word, "", "", insert) }
}

/// The parameter that the last variant of a text is chosen by, if it stands before its alternatives.
fn chosen_by(before: &str) -> Option<&str> {
    let variant = &before[before.rfind("Variant(")?..];
    let rest = variant[variant.find("choice")? + "choice".len()..].trim_start().strip_prefix(':')?;
    rest.trim_start().strip_prefix('"')?.split('"').next()
}

/// Keys that are not given yet.
fn keys(all: &[(&str, &str)], given: &[&str]) -> Vec<Completion> {
    let missing = all.iter().filter(|(name, _)| !given.contains(name));
    let item = |&(name, doc): &(&str, &str)| item(name, CompletionKind::Member, "", doc, format!("{name}: "));
    missing.map(item).collect()
}

fn item(label: &str, kind: CompletionKind, detail: &str, doc: &str, insert: String) -> Completion {
    Completion {
        label: label.to_owned(),
        kind,
        detail: detail.to_owned(),
        doc: doc.to_owned(),
        insert,
        has_places: false,
    }
}

/// A kind with the parameters that must be given.
fn of_kind(info: &BlockInfo, snippets: bool, prose: Prose) -> Completion {
    let needed = info.parameters.iter().filter(|parameter| parameter.default.is_none());
    let insert = match snippets {
        true => {
            let places =
                needed.enumerate().map(|(n, parameter)| format!("{}: ${{{}}}", parameter.name, n + 1));
            let places = places.collect::<Vec<_>>().join(", ");
            if places.is_empty() { info.kind.to_owned() } else { format!("{}({places})", info.kind) }
        }
        false => info.kind.to_owned(),
    };
    Completion {
        has_places: snippets,
        ..item(info.kind, CompletionKind::Kind, info.category, &prose(info.doc.trim()), insert)
    }
}

fn of_parameter(parameter: &ParameterInfo) -> Completion {
    let doc = parameter.doc.trim();
    item(parameter.name, CompletionKind::Member, &about(parameter), doc, format!("{}: ", parameter.name))
}

/// Blocks, or ports of the block before the point.
fn connections(text: &str, before: &str, blocks: Option<&Blocks>) -> Vec<Completion> {
    let word = &before[run_at(before, before.len(), is_of_reference)];
    let declared = declared(text);
    match word.split_once('.') {
        None => {
            let of_blocks = declared.iter().filter(|declared| declared.section == Section::Block);
            let of_blocks = of_blocks
                .map(|block| item(block.name, CompletionKind::Name, block.kind, "", block.name.to_owned()));
            let has_inputs = declared.iter().any(|declared| declared.section == Section::Input);
            let own = has_inputs
                .then(|| item("in", CompletionKind::Name, "inputs of the diagram", "", "in".to_owned()));
            of_blocks.chain(own).collect()
        }
        Some(("in", _)) => {
            let inputs = declared.iter().filter(|declared| declared.section == Section::Input);
            inputs
                .map(|input| item(input.name, CompletionKind::Member, "input", "", input.name.to_owned()))
                .collect()
        }
        Some((block, _)) => {
            let ports = blocks
                .and_then(|blocks| blocks.get(block))
                .map(|facts| facts.ports.as_slice())
                .unwrap_or_default();
            // Behind an arrow inputs are meant, before it what drives them.
            let is_meant = |port: &&Port| match before.contains("->") && !before.contains("<->") {
                true => port.side == "input",
                false => port.side != "input",
            };
            let (first, rest): (Vec<&Port>, Vec<&Port>) = ports.iter().partition(is_meant);
            first
                .into_iter()
                .chain(rest)
                .map(|port| {
                    item(&port.name, CompletionKind::Member, &side(port), &port.doc, port.name.clone())
                })
                .collect()
        }
    }
}

/// Files and folders that a name could go on with.
fn files(folder: &Path, text: &str, at: usize) -> Vec<Completion> {
    let begun = text[..at].rfind('"').map_or("", |quote| &text[quote + 1..at]);
    let inside = begun.rfind('/').map_or("", |slash| &begun[..slash]);
    let mut entries: Vec<(String, bool)> = std::fs::read_dir(folder.join(inside))
        .into_iter()
        .flatten()
        .filter_map(|entry| {
            let path = entry.ok()?.path();
            let name = path.file_name()?.to_str()?.to_owned();
            let fits =
                path.is_dir() || path.extension().is_some_and(|ending| ending == "ron" || ending == "csv");
            (fits && !name.starts_with('.')).then(|| (name, path.is_dir()))
        })
        .collect();
    entries.sort();
    let item = |(name, is_folder): (String, bool)| match is_folder {
        true => item(&name, CompletionKind::Folder, "", "", format!("{name}/")),
        false => item(&name, CompletionKind::File, "", "", name.clone()),
    };
    entries.into_iter().map(item).collect()
}
