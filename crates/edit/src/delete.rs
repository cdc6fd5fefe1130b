//! Blocks that go, with their wires.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::PathBuf;

use blocksim_block::problem::Place;
use blocksim_diagram::Trees;
use blocksim_syntax::read;

use crate::change::{Change, Draft};
use crate::ends::{End, written};
use crate::mentions;
use crate::names::meant;
use crate::project::{Level, Project, split};
use crate::refusal::{Refusal, line_of};
use crate::text::{Entries, Splice, Wire, Wires, spliced};

/// Deletes blocks of one diagram with their wires and with the entries of `record`, `panel` and `simulation` that name them. Ports that
/// nothing is connected to any more are named in the notes.
///
/// # Errors
/// There is no such block, something handed outward comes from one, or its file is shared.
pub fn delete(project: &Project, paths: &[String]) -> Result<Change, Refusal> {
    let Some(first) = paths.first() else { return Err(Refusal::new("no block is named")) };
    let opened = project.open()?;
    let level = opened.level(split(first).0)?;
    project.may_change(&level)?;
    let names = names(&level, paths)?;
    let is_gone = |block: &str| names.contains(block);
    let handed = level.model.ast.outputs.iter().chain(&level.model.ast.ports);
    if let Some((name, reference)) = handed.into_iter().find(|(_, reference)| is_gone(&reference.block)) {
        return Err(Refusal::new(format!(
            "this diagram hands `{}` outward, which comes from `{}`",
            name.text, reference.block
        ))
        .help(format!("connect another block to `out.{}` first, or remove it from the text", name.text)));
    }
    let (text, old) = (&*level.file.text, &level.file);
    let mut wires = wires(&level)?;
    let lost = disconnect(&mut wires, &level, is_gone);
    let mut splices = wires.finish().0;
    if let Some(blocks) = level.section("blocks")
        && let Some(entries) = Entries::of(text, blocks)
    {
        let at = |at: usize| level.model.ast.blocks.get(at).is_some_and(|block| is_gone(&block.name.text));
        splices.extend(entries.without(at));
    }
    let mut draft = Draft::default();
    let others = other_spots(project, &level, &names, false);
    let mut removed = mentions::Gone::default();
    for (path, (text, spots)) in &others {
        let Ok(root) = read(text) else { continue };
        let (gone, entries) = mentions::without(text, &root, spots);
        removed.extend(entries);
        if *path == old.path {
            splices.extend(gone);
        } else if let Some(new) = spliced(text, gone) {
            draft.put(path.clone(), text, new);
        }
    }
    let new = spliced(text, splices)
        .ok_or_else(|| Refusal::new("the entries of this text meet in a strange way"))?;
    draft.put(old.path.clone(), text, new);
    let shown: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    let mut change = draft.finish(format!("{} deleted", listed(&shown)));
    if !lost.is_empty() {
        let lost: Vec<String> = lost.iter().map(|end| format!("`{end}`")).collect();
        change.notes.push(format!("not connected any more: {}", lost.join(", ")));
    }
    change.notes.extend(removed.described());
    Ok(change)
}

/// `a`, `a and b`, `a, b and c`.
pub(crate) fn listed(all: &[String]) -> String {
    match all {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// The names of blocks that are given by paths, which must be of one diagram.
pub(crate) fn names(level: &Level, paths: &[String]) -> Result<BTreeSet<String>, Refusal> {
    let mut names = BTreeSet::new();
    for path in paths {
        let (at, name) = split(path);
        if at != level.model.path {
            return Err(
                Refusal::new("the blocks are of different diagrams").help("choose blocks of one level")
            );
        }
        level.block(name)?;
        names.insert(name.to_owned());
    }
    Ok(names)
}

/// The connections of a diagram.
pub(crate) fn wires<'l>(level: &'l Level) -> Result<Wires<'l>, Refusal> {
    Wires::of(&level.file.text, level.section("connections")).map_err(|at| {
        Refusal::new(format!(
            "the connection at {} is written in a way that cannot be changed here",
            line_of(&level.file, at)
        ))
        .help("write it as a plain text such as \"a.y -> b.u\"")
    })
}

/// Takes the ends at some blocks out; inputs and conserving ports that are connected to nothing any more.
fn disconnect(wires: &mut Wires, level: &Level, is_gone: impl Fn(&str) -> bool) -> BTreeSet<String> {
    let is_gone = |end: &str| is_gone(end.split('.').next().unwrap_or_default());
    let mut lost: BTreeSet<String> = BTreeSet::new();
    let mut leaving: Vec<String> = Vec::new();
    for at in 0..wires.len() {
        let ends = wires.ends(at);
        match wires.wire(at) {
            Wire::Signal if ends.first().is_some_and(|source| is_gone(source)) => {
                lost.extend(ends[1..].iter().filter(|end| !is_gone(end)).map(|end| (*end).to_owned()));
                wires.take(at);
            }
            Wire::Signal => wires.remove(at, |_, end| is_gone(end)),
            Wire::Conserving => {
                lost.extend(ends.iter().filter(|end| !is_gone(end)).map(|end| (*end).to_owned()));
                leaving.extend(ends.iter().filter(|end| is_gone(end)).map(|end| (*end).to_owned()));
            }
        }
    }
    leaving.iter().for_each(|end| wires.leave(end));
    keep_unconnected(&mut lost, wires, level);
    lost
}

/// Leaves the ends that no connection has and that the diagram does not hand outward.
fn keep_unconnected(ends: &mut BTreeSet<String>, wires: &Wires, level: &Level) {
    let joined = (0..wires.len()).flat_map(|at| wires.ends(at)).map(str::to_owned);
    let handed = level.model.ast.ports.iter().map(|(_, reference)| written(reference));
    let connected: BTreeSet<String> = joined.chain(handed).collect();
    ends.retain(|end| !connected.contains(end));
}

/// Where blocks of a diagram are named outside of its connections and what it hands outward: by file, with its text.
pub(crate) fn other_spots(
    project: &Project,
    level: &Level,
    names: &BTreeSet<String>,
    with_comments: bool,
) -> BTreeMap<PathBuf, (String, Vec<Range<usize>>)> {
    let trees = Trees::default();
    let mut found: BTreeMap<PathBuf, (String, Vec<Range<usize>>)> = BTreeMap::new();
    let own = ["blocks", "connections", "outputs", "ports"];
    let own: Vec<Range<usize>> =
        own.iter().filter_map(|name| Some(level.section(name)?.span.clone())).collect();
    for name in names {
        let Some(block) = level.model.block(name) else { continue };
        let Place { span, .. } = &block.place;
        let Some(meant) = meant(project, &trees, &level.file.path, span.start + 1) else { continue };
        let comments = if with_comments { meant.in_comments(project) } else { Vec::new() };
        for (path, start, end) in meant.spots.iter().chain(&comments) {
            let is_own = *path == level.file.path && own.iter().any(|own| own.contains(start));
            if !is_own {
                let (_, spots) = found
                    .entry(path.clone())
                    .or_insert_with(|| (meant.text(path).unwrap_or_default().to_owned(), Vec::new()));
                spots.push(*start..*end);
            }
        }
    }
    found
}

/// Deletes a wire: one end of it, or all that it joins. An input loses its driver, a conserving port leaves what it is joined
/// to, and an output loses all that it drives.
///
/// # Errors
/// There is no such port, or nothing is connected to it.
pub fn disconnect_end(project: &Project, end: &str) -> Result<Change, Refusal> {
    let opened = project.open()?;
    let (path, text) = crate::ends::split_end(end);
    let level = opened.level(path)?;
    project.may_change(&level)?;
    let end = End::read(&level, text)?;
    end.kind(&level)?;
    let Some(written) = end.written() else {
        return Err(Refusal::new(format!("`{}` is what this diagram hands outward", end.shown()))
            .help("connect another block to it, or remove it from the text"));
    };
    let mut wires = wires(&level)?;
    let mut lost: BTreeSet<String> = BTreeSet::new();
    let mut count = 0;
    for at in 0..wires.len() {
        let ends: Vec<String> = wires.ends(at).into_iter().map(str::to_owned).collect();
        let Some(place) = ends.iter().position(|known| *known == written) else { continue };
        match (wires.wire(at), place) {
            (Wire::Signal, 0) => {
                count += ends.len() - 1;
                lost.extend(ends[1..].iter().cloned());
                wires.take(at);
            }
            (Wire::Signal, _) => {
                count += 1;
                lost.insert(written.clone());
                wires.remove(at, |_, known| known == written);
            }
            (Wire::Conserving, _) => {
                count += 1;
                lost.extend(ends);
            }
        }
    }
    if count == 0 {
        return Err(Refusal::new(format!("nothing is connected to `{written}`")));
    }
    wires.leave(&written);
    keep_unconnected(&mut lost, &wires, &level);
    let mut draft = Draft::default();
    let splices: Vec<Splice> = wires.finish().0;
    let new = spliced(&level.file.text, splices)
        .ok_or_else(|| Refusal::new("the connections of this text meet in a strange way"))?;
    draft.put(level.file.path.clone(), &level.file.text, new);
    let mut change = draft.finish(format!("`{written}` disconnected"));
    if !lost.is_empty() {
        let lost: Vec<String> = lost.iter().map(|end| format!("`{end}`")).collect();
        change.notes.push(format!("not connected any more: {}", lost.join(", ")));
    }
    if let End::Block { block, .. } = &end {
        change.block = Some(level.path_of(block));
    }
    Ok(change)
}
