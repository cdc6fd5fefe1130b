//! Names across the files of models, as the protocol writes them.

use std::path::{Path, PathBuf};

use blocksim_block::CodePolicy;
use blocksim_edit::{Meant, Project, Refusal, Renaming, Spot, meant, renamable, renamed as renaming};
use lsp_types::{
    Hover, HoverContents, Location, MarkupContent, MarkupKind, PrepareRenameResponse, TextEdit, Uri,
    WorkspaceEdit,
};

use crate::models::{Models, candidates};
use crate::position::span;
use crate::texts::{Snapshot, Texts};
use crate::uri::uri_of;

/// Does something with the model that an open file belongs to.
pub fn with_project<T>(
    models: &mut Models,
    path: &Path,
    snapshot: &Snapshot,
    code: &dyn CodePolicy,
    what: impl FnOnce(&Project, &Models) -> T,
) -> T {
    let root = models.root(path, snapshot, code);
    let texts = Texts::new(snapshot, &models.disk, code);
    let others = |files: &[PathBuf]| candidates(files, &models.folders, snapshot);
    what(&Project { reader: &texts, model: &root, others: &others, shared: true }, models)
}

fn location(found: &Meant, (path, start, end): &Spot) -> Option<Location> {
    Some(Location::new(uri_of(path)?, span(found.text(path)?, &(*start..*end))))
}

/// Where it is declared what stands at a byte of a file.
pub fn definition(
    models: &mut Models,
    path: &Path,
    at: usize,
    snapshot: &Snapshot,
    code: &dyn CodePolicy,
) -> Vec<Location> {
    with_project(models, path, snapshot, code, |project, models| {
        let found = meant(project, &models.trees, path, at);
        found
            .iter()
            .flat_map(|found| found.declared.iter().filter_map(|spot| location(found, spot)))
            .collect()
    })
}

/// What is declared under the name at a byte of a file, as written.
pub fn described(
    models: &mut Models,
    path: &Path,
    at: usize,
    snapshot: &Snapshot,
    code: &dyn CodePolicy,
) -> Option<Hover> {
    let found = with_project(models, path, snapshot, code, |project, models| {
        meant(project, &models.trees, path, at)
    })?;
    let line = |spot: &Spot| {
        let (path, start, _) = spot;
        let text = found.text(path)?;
        let from = text[..*start].rfind('\n').map_or(0, |feed| feed + 1);
        let line = text[from..].lines().next().unwrap_or_default().trim();
        Some(format!("{}\n```ron\n{line}\n```", found.shown(spot)))
    };
    let value = found.declared.iter().filter_map(line).collect::<Vec<_>>().join("\n\n");
    let (path, start, end) = &found.here;
    let range = span(found.text(path)?, &(*start..*end));
    let contents = HoverContents::Markup(MarkupContent { kind: MarkupKind::Markdown, value });
    Some(Hover { contents, range: Some(range) })
}

/// Every place that names what stands at a byte of a file.
pub fn references(
    models: &mut Models,
    path: &Path,
    at: usize,
    with_declaration: bool,
    snapshot: &Snapshot,
    code: &dyn CodePolicy,
) -> Vec<Location> {
    let found =
        with_project(models, path, snapshot, code, |project, models| meant(project, &models.trees, path, at));
    let Some(found) = found else { return Vec::new() };
    let wanted = found.spots.iter().filter(|spot| with_declaration || !found.declared.contains(*spot));
    wanted.filter_map(|spot| location(&found, spot)).collect()
}

/// The name at a byte of a file, if it can be another one.
///
/// # Errors
/// It cannot.
pub fn prepared(
    models: &mut Models,
    path: &Path,
    at: usize,
    snapshot: &Snapshot,
    code: &dyn CodePolicy,
) -> Result<PrepareRenameResponse, Refusal> {
    let found = with_project(models, path, snapshot, code, |project, models| {
        renamable(project, &models.trees, path, at)
    })?;
    let (path, start, end) = &found.here;
    let text = found.text(path).unwrap_or_default();
    Ok(PrepareRenameResponse::RangeWithPlaceholder {
        range: span(text, &(*start..*end)),
        placeholder: found.name.clone(),
    })
}

/// The edits that give another name to what stands at a byte of a file.
///
/// # Errors
/// The name is not one, is taken, or something would mean something else.
pub fn renamed(
    models: &mut Models,
    path: &Path,
    at: usize,
    new: &str,
    snapshot: &Snapshot,
    code: &dyn CodePolicy,
) -> Result<WorkspaceEdit, Refusal> {
    let Renaming { meant, spots } = with_project(models, path, snapshot, code, |project, models| {
        renaming(project, &models.trees, path, at, new)
    })?;
    if spots.is_empty() {
        return Ok(WorkspaceEdit::default());
    }
    let mut changes: Vec<(Uri, Vec<TextEdit>)> = Vec::new();
    for (path, spots) in &spots {
        let text = meant.text(path).unwrap_or_default();
        let Some(uri) = uri_of(path) else {
            return Err(Refusal::new(format!("{} cannot be named to the editor", path.display())));
        };
        let edit =
            |spot: &std::ops::Range<usize>| TextEdit { range: span(text, spot), new_text: new.to_owned() };
        changes.push((uri, spots.iter().map(edit).collect()));
    }
    #[expect(clippy::mutable_key_type, reason = "the protocol's own type")]
    let changes = changes.into_iter().collect();
    Ok(WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() })
}
