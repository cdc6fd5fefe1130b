//! Another name for a block, or for a port of a diagram.

use blocksim_block::problem::Place;
use blocksim_diagram::{Content, ModelBlock, Trees};

use crate::change::{Change, Draft};
use crate::ends::{End, split_end};
use crate::names::renamed;
use crate::project::{Project, below, split};
use crate::refusal::Refusal;

/// Gives a block another name, wherever it is named: in connections, in what a diagram hands outward, in paths of `record`,
/// `panel` and `simulation`, and in comments that show how to `--set` it; of all models that share the file. `path` may name an input of a
/// diagram (`arm/in.angle`) or what it hands outward (`arm/out.torque`) as well.
///
/// # Errors
/// The name is not one or taken, or something would mean something else.
pub fn rename(project: &Project, path: &str, new: &str) -> Result<Change, Refusal> {
    let opened = project.open()?;
    let (level_path, end) = if path.contains('.') { split_end(path) } else { split(path) };
    let level = opened.level(level_path)?;
    let ast = &level.model.ast;
    let (old, place) = if end.contains('.') {
        let (name, names) = match End::read(&level, end)? {
            End::Input(name) => (name, ast.inputs.iter().map(|(name, _)| name).collect::<Vec<_>>()),
            End::Output(name) => (name, ast.outputs.iter().map(|(name, _)| name).collect()),
            End::Port(name) => (name, ast.ports.iter().map(|(name, _)| name).collect()),
            End::Block { .. } => {
                return Err(Refusal::new("the ports of a block have the names that its kind gives them"));
            }
        };
        let known = names.into_iter().find(|known| known.text == name);
        let place = known.map(|known| ast.place(&known.span));
        (name, place.ok_or_else(|| Refusal::new("there is no such port"))?)
    } else {
        let block = level.block(end)?;
        (block.name.clone(), block.place.clone())
    };
    let at = within(&place, &level.file.text);
    let renaming = renamed(project, &Trees::default(), &level.file.path, at, new)?;
    let mut draft = Draft::default();
    for (path, text) in renaming.texts(new) {
        draft.put(path.clone(), renaming.meant.text(&path).unwrap_or_default(), text);
    }
    let count: usize = renaming.spots.values().map(Vec::len).sum();
    if count == 0 {
        return Ok(Change { summary: format!("`{old}` has this name already"), ..Change::default() });
    }
    let places = if count == 1 { "1 place".to_owned() } else { format!("{count} places") };
    let mut change = draft.finish(format!("`{old}` is `{new}` now, in {places}"));
    if let Some(block) = level.model.block(end) {
        change.notes.extend(other_numbers(block));
        change.block = Some(below(level_path, new));
    }
    if level.instances.len() > 1 {
        change.notes.push(format!(
            "`{}` is the file of {} blocks: it has the name in all of them",
            level.file.path.display(),
            level.instances.len()
        ));
    }
    Ok(change)
}

/// The first letter of a name at a place, which may have quotes.
fn within(place: &Place, text: &str) -> usize {
    let start = place.span.start;
    start + usize::from(text.as_bytes().get(start) == Some(&b'"'))
}

/// That random numbers are others under another path.
pub(crate) fn other_numbers(block: &ModelBlock) -> Option<String> {
    let mut open = vec![block];
    while let Some(next) = open.pop() {
        if next.kind == "Noise" {
            return Some(format!(
                "the random numbers of `{}` follow from its path, so they are others now",
                next.path
            ));
        }
        if let Content::Diagram(inside) = &next.content {
            open.extend(&inside.blocks);
        }
    }
    None
}
