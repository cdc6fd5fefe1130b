//! Changes of whole diagrams, as an editor offers them: blocks that go with their wires, blocks that become a subsystem.
//!
//! What is offered follows from the text at once; what it comes to is worked out when somebody chooses it.

use std::path::{Path, PathBuf};

use blocksim_block::CodePolicy;
use blocksim_edit::{Change, Refusal, Section, TextChange, declared, delete, instance_of, wrap};
use lsp_types::{Range as Span, Uri};
use serde_json::{Value, json};

use crate::formatting::lines;
use crate::meanings::with_project;
use crate::models::Models;
use crate::position::position;
use crate::texts::Snapshot;
use crate::uri::uri_of;

/// What an editor can do with the answer.
#[derive(Debug, Clone, Copy, Default)]
pub struct Takes {
    /// It asks for the changes of an action when that is chosen.
    pub later: bool,
    /// It makes files.
    pub new_files: bool,
}

/// What can be done with the blocks that are declared on the lines of a range.
pub fn offered(text: &str, uri: &Uri, range: &Span, takes: Takes) -> Vec<Value> {
    if !takes.later {
        return Vec::new();
    }
    let on_lines = |at: usize| (range.start.line..=range.end.line).contains(&position(text, at).line);
    let declared = declared(text);
    let chosen = declared.iter().filter(|one| one.section == Section::Block && on_lines(one.place.start));
    let names: Vec<&str> = chosen.map(|one| one.name).filter(|name| !name.is_empty()).collect();
    let Some(first) = names.first() else { return Vec::new() };
    let what = if names.len() == 1 { format!("`{first}`") } else { format!("{} blocks", names.len()) };
    let action = |title: String, kind: &str, does: &str| json!({ "title": title, "kind": kind, "data": { "uri": uri.as_str(), "does": does, "blocks": names } });
    let wires = if names.len() == 1 { "its wires" } else { "their wires" };
    let mut all = vec![action(format!("Delete {what} with {wires}"), "refactor.rewrite", "delete")];
    if takes.new_files && names.len() > 1 {
        all.push(action(format!("Group {what} in a subsystem"), "refactor.extract", "wrap"));
    }
    all
}

/// The changes of an action that was chosen, for the file that it is about.
///
/// # Errors
/// What is against it.
pub fn chosen(
    models: &mut Models,
    path: &Path,
    data: &Value,
    snapshot: &Snapshot,
    code: &dyn CodePolicy,
) -> Result<Value, Refusal> {
    let names = data["blocks"].as_array().into_iter().flatten().filter_map(Value::as_str);
    let names: Vec<String> = names.map(str::to_owned).collect();
    let change = with_project(models, path, snapshot, code, |project, _| {
        let level = instance_of(project, path)?;
        let below = |name: String| if level.is_empty() { name } else { format!("{level}/{name}") };
        let blocks: Vec<String> = names.into_iter().map(below).collect();
        match data["does"].as_str() {
            Some("delete") => delete(project, &blocks),
            Some("wrap") => wrap(project, &blocks, ""),
            _ => Err(Refusal::new("this is not something that can be done")),
        }
    })?;
    edit(&change, snapshot)
}

/// A change as the protocol writes it: files that are made, and lines that are replaced.
fn edit(change: &Change, snapshot: &Snapshot) -> Result<Value, Refusal> {
    let uri = |path: &PathBuf| {
        uri_of(path).ok_or_else(|| Refusal::new(format!("{} cannot be named to the editor", path.display())))
    };
    let version = |path: &PathBuf| snapshot.open.get(path).map(|document| document.version);
    let mut all = Vec::new();
    for TextChange { path, old, new } in &change.texts {
        let name = uri(path)?;
        if old.is_none() {
            all.push(json!({ "kind": "create", "uri": name.as_str() }));
        }
        let edit = lines(old.as_deref().unwrap_or_default(), new);
        all.push(json!({
            "textDocument": { "uri": name.as_str(), "version": version(path) },
            "edits": [edit],
        }));
    }
    Ok(json!({ "documentChanges": all }))
}
