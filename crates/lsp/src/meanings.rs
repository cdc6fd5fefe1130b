//! Names across the files of models: where they are declared, every place that names the same, other names for them.
//!
//! A new name is tried out before it is offered: the models are read with the changed texts, and every name in them must mean
//! what it has meant. So no name is captured by another diagram, by a unit or by a pattern.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};

use blocksim_block::CodePolicy;
use blocksim_block::problem::{Place, Problem, Severity};
use blocksim_diagram::{Meaning, Mentions, SourceFile, Sources, Trees, mentions};
use lsp_types::{
    Hover, HoverContents, Location, MarkupContent, MarkupKind, PrepareRenameResponse, TextEdit, Uri,
    WorkspaceEdit,
};

use crate::models::{Models, files_that_name};
use crate::position::{position, span};
use crate::texts::{Snapshot, Texts};
use crate::uri::uri_of;

/// Why something is not done.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refusal(pub String);

/// A name in a text: file, first byte, byte behind it.
type Spot = (PathBuf, usize, usize);

/// The names of a model.
struct Names {
    files: Vec<SourceFile>,
    names: Mentions,
    problems: Vec<Problem>,
}

impl Names {
    fn of(root: &Path, texts: &Texts, trees: &Trees) -> Names {
        let sources = Sources::with_trees(texts, trees);
        let (names, problems) = mentions(&sources, root);
        Names { files: sources.all(), names, problems }
    }

    fn spot(&self, place: &Place) -> Spot {
        let Range { start, end } = place.span;
        (self.files[place.file.0 as usize].path.clone(), start, end)
    }

    fn has(&self, path: &Path) -> bool {
        self.files.iter().any(|file| file.path == path)
    }

    /// Symbols that one of the spots names.
    fn symbols_at(&self, spots: &BTreeSet<Spot>) -> BTreeSet<usize> {
        let named = self
            .names
            .all
            .iter()
            .filter(|one| one.pattern.is_none() && spots.contains(&self.spot(&one.place)));
        named.flat_map(|one| one.symbols.iter().copied()).collect()
    }
}

/// What a name stands for, with all the places and models that name it.
struct Meant {
    meaning: Meaning,
    name: String,
    /// Where it stands, without patterns.
    spots: BTreeSet<Spot>,
    declared: BTreeSet<Spot>,
    /// The one that the request is about.
    here: Spot,
    models: BTreeMap<PathBuf, Names>,
}

impl Meant {
    fn text(&self, path: &Path) -> Option<&str> {
        let mut files = self.models.values().flat_map(|names| &names.files);
        files.find(|file| file.path == path).map(|file| &*file.text)
    }

    fn location(&self, (path, start, end): &Spot) -> Option<Location> {
        Some(Location::new(uri_of(path)?, span(self.text(path)?, &(*start..*end))))
    }
}

/// `segment.ron:12`.
fn shown(path: &Path, text: &str, at: usize) -> String {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    format!("{name}:{}", position(text, at).line + 1)
}

/// What stands at a byte of an open file, with all that names the same in the models that have one of the files.
fn meant(
    models: &mut Models,
    path: &Path,
    at: usize,
    snapshot: &Snapshot,
    code: &dyn CodePolicy,
) -> Option<Meant> {
    let root = models.root(path, snapshot, code);
    let texts = Texts::new(snapshot, &models.disk, code);
    let first = Names::of(&root, &texts, &models.trees);
    let file = first.files.iter().position(|file| file.path == path)?;
    let mention = first.names.at(blocksim_block::problem::FileId(file as u32), at)?;
    let symbol = &first.names.symbols[*mention.symbols.first()?];
    let (meaning, name, here) = (symbol.meaning, symbol.name.clone(), first.spot(&mention.place));
    let mut found = Meant {
        meaning,
        name,
        spots: BTreeSet::from([here.clone()]),
        declared: BTreeSet::new(),
        here,
        models: BTreeMap::from([(root, first)]),
    };
    // What one model names may be named by others, in further files.
    let mut searched: BTreeSet<PathBuf> = BTreeSet::new();
    loop {
        let before = found.spots.len();
        for names in found.models.values() {
            for symbol in names.symbols_at(&found.spots) {
                let spots = names.names.of(symbol).filter(|one| one.pattern.is_none());
                found.spots.extend(spots.map(|one| names.spot(&one.place)));
                let declared = names.names.symbols[symbol].declared.iter();
                found.declared.extend(declared.map(|place| names.spot(place)));
            }
        }
        let files: BTreeSet<PathBuf> = found.spots.iter().map(|(path, ..)| path.clone()).collect();
        let new: Vec<PathBuf> = files.into_iter().filter(|file| searched.insert(file.clone())).collect();
        if found.spots.len() == before && new.is_empty() {
            return (!snapshot.is_stale()).then_some(found);
        }
        for root in files_that_name(&new, &models.folders, &texts) {
            if let Entry::Vacant(entry) = found.models.entry(root) {
                let names = Names::of(entry.key(), &texts, &models.trees);
                if new.iter().any(|file| names.has(file)) {
                    entry.insert(names);
                }
            }
        }
    }
}

/// Where it is declared what stands at a byte of a file.
pub fn definition(
    models: &mut Models,
    path: &Path,
    at: usize,
    snapshot: &Snapshot,
    code: &dyn CodePolicy,
) -> Vec<Location> {
    let Some(found) = meant(models, path, at, snapshot, code) else { return Vec::new() };
    found.declared.iter().filter_map(|spot| found.location(spot)).collect()
}

/// What is declared under the name at a byte of a file, as written.
pub fn described(
    models: &mut Models,
    path: &Path,
    at: usize,
    snapshot: &Snapshot,
    code: &dyn CodePolicy,
) -> Option<Hover> {
    let found = meant(models, path, at, snapshot, code)?;
    let line = |(path, start, _): &Spot| {
        let text = found.text(path)?;
        let from = text[..*start].rfind('\n').map_or(0, |feed| feed + 1);
        let line = text[from..].lines().next().unwrap_or_default().trim();
        Some(format!("{}\n```ron\n{line}\n```", shown(path, text, *start)))
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
    let Some(found) = meant(models, path, at, snapshot, code) else { return Vec::new() };
    let wanted = found.spots.iter().filter(|spot| with_declaration || !found.declared.contains(*spot));
    wanted.filter_map(|spot| found.location(spot)).collect()
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
    let found = renamable(models, path, at, snapshot, code)?;
    let (path, start, end) = &found.here;
    let text = found.text(path).unwrap_or_default();
    Ok(PrepareRenameResponse::RangeWithPlaceholder {
        range: span(text, &(*start..*end)),
        placeholder: found.name.clone(),
    })
}

/// What stands at a byte of a file, unless something is against another name.
fn renamable(
    models: &mut Models,
    path: &Path,
    at: usize,
    snapshot: &Snapshot,
    code: &dyn CodePolicy,
) -> Result<Meant, Refusal> {
    let Some(found) = meant(models, path, at, snapshot, code) else {
        let sorts =
            "blocks, parameters of diagrams, and inputs, outputs and ports of subsystems can be renamed";
        return Err(Refusal(format!("there is no such name here: {sorts}")));
    };
    for (root, names) in &found.models {
        // A plug-in that is not loaded hides no names.
        let hides =
            |problem: &&Problem| problem.severity == Severity::Error && !problem.code.starts_with("plugin_");
        if let Some(problem) = names.problems.iter().find(hides) {
            let label = problem.labels.first();
            let place = label.map(|label| {
                let file = &names.files[label.place.file.0 as usize];
                format!("{}: ", shown(&file.path, &file.text, label.place.span.start))
            });
            return Err(Refusal(format!(
                "first correct the errors of {}, which may hide names: {}{}",
                root.file_name().unwrap_or_default().to_string_lossy(),
                place.unwrap_or_default(),
                problem.message
            )));
        }
        for symbol in names.symbols_at(&found.spots) {
            if let Some(reason) = &names.names.symbols[symbol].fixed {
                return Err(Refusal(format!("`{}` cannot be renamed: {reason}", found.name)));
            }
        }
        // One text of a model that means different things in different instances.
        let unclear = names.names.all.iter().find(|one| {
            one.symbols.len() > 1 && one.pattern.is_none() && found.spots.contains(&names.spot(&one.place))
        });
        if let Some(one) = unclear {
            let at = |place: &Place| {
                let file = &names.files[place.file.0 as usize];
                shown(&file.path, &file.text, place.span.start)
            };
            let declared = one.symbols.iter().flat_map(|&symbol| &names.names.symbols[symbol].declared);
            let declared: Vec<String> = declared.map(at).collect();
            return Err(Refusal(format!(
                "`{}` is ambiguous: at {} it stands for what is declared at {}, depending on the instance",
                found.name,
                at(&one.place),
                declared.join(" and at ")
            )));
        }
    }
    Ok(found)
}

/// Whether a word can be a name.
fn check_name(new: &str) -> Result<(), Refusal> {
    let starts = new.chars().next().is_some_and(|sign| sign.is_ascii_alphabetic());
    if !starts || !new.chars().all(|sign| sign.is_ascii_alphanumeric() || sign == '_') || new == "in" {
        let rule = "names start with a letter, then letters, digits and `_`; `in` is reserved";
        return Err(Refusal(format!("`{new}` is not a valid name: {rule}")));
    }
    Ok(())
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
    check_name(new)?;
    let found = renamable(models, path, at, snapshot, code)?;
    if new == found.name {
        return Ok(WorkspaceEdit::default());
    }
    not_taken(&found, new)?;
    let mut by_file: BTreeMap<&PathBuf, Vec<Range<usize>>> = BTreeMap::new();
    for (path, start, end) in &found.spots {
        by_file.entry(path).or_default().push(*start..*end);
    }
    let mut texts = Texts::new(snapshot, &models.disk, code);
    for (path, spots) in &by_file {
        let mut text = found.text(path).unwrap_or_default().to_owned();
        spots.iter().rev().for_each(|spot| text.replace_range(spot.clone(), new));
        texts.instead.insert((*path).clone(), text);
    }
    let trees = Trees::default();
    for (root, before) in &found.models {
        let after = Names::of(root, &texts, &trees);
        same(&found, before, &after, new)?;
    }
    let mut changes: Vec<(Uri, Vec<TextEdit>)> = Vec::new();
    for (path, spots) in by_file {
        let text = found.text(path).unwrap_or_default();
        let Some(uri) = uri_of(path) else {
            return Err(Refusal(format!("{} cannot be named to the editor", path.display())));
        };
        let edit = |spot: &Range<usize>| TextEdit { range: span(text, spot), new_text: new.to_owned() };
        changes.push((uri, spots.iter().map(edit).collect()));
    }
    #[expect(clippy::mutable_key_type, reason = "the protocol's own type")]
    let changes = changes.into_iter().collect();
    Ok(WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() })
}

/// Whether no other symbol of the sort has the name in one of the diagrams.
fn not_taken(found: &Meant, new: &str) -> Result<(), Refusal> {
    for names in found.models.values() {
        let taken =
            names.names.symbols.iter().filter(|symbol| symbol.meaning == found.meaning && symbol.name == new);
        for place in taken.flat_map(|symbol| &symbol.declared) {
            let file = &names.files[place.file.0 as usize];
            if found.declared.iter().any(|(path, ..)| *path == file.path) {
                return Err(Refusal(format!(
                    "`{new}` is taken: it is {} at {}",
                    found.meaning.described(),
                    shown(&file.path, &file.text, place.span.start)
                )));
            }
        }
    }
    Ok(())
}

/// Names of a model by place, each with where it is declared.
type Table = BTreeMap<(PathBuf, usize), BTreeSet<(PathBuf, usize)>>;

fn table(names: &Names, moved: impl Fn(Spot) -> (PathBuf, usize)) -> Table {
    let one = |mention: &blocksim_diagram::Mention| {
        let declared = mention.symbols.iter().flat_map(|&symbol| &names.names.symbols[symbol].declared);
        let declared = declared.map(|place| moved(names.spot(place))).collect();
        (moved(names.spot(&mention.place)), declared)
    };
    names.names.all.iter().map(one).collect()
}

/// Whether all names of a model mean what they have meant before.
fn same(found: &Meant, before: &Names, after: &Names, new: &str) -> Result<(), Refusal> {
    let errors = |names: &Names| {
        let errors = names.problems.iter().filter(|problem| problem.severity == Severity::Error);
        errors.map(|problem| problem.code).collect::<Vec<_>>()
    };
    if errors(before) != errors(after) {
        let problem = after.problems.iter().find(|problem| problem.severity == Severity::Error);
        let reason = problem.map_or("another error would be hidden", |problem| &problem.message);
        return Err(Refusal(format!("with the name `{new}` the model would have errors: {reason}")));
    }
    let moved = |(path, start, _): Spot| {
        let longer = new.len() as isize - found.name.len() as isize;
        let first = (path.clone(), 0, 0);
        let earlier = found.spots.range(first..(path.clone(), start, 0)).count() as isize;
        (path, (start as isize + earlier * longer) as usize)
    };
    let (was, is) = (table(before, moved), table(after, |(path, start, _)| (path, start)));
    if was == is {
        return Ok(());
    }
    // The first name that differs, in the changed text, or in the present one if it is gone there.
    let differs = is.iter().find(|(place, declared)| was.get(*place) != Some(*declared));
    let gone = || was.iter().find(|(place, declared)| is.get(*place) != Some(*declared));
    let Some(((path, at), _)) = differs.or_else(gone) else { return Ok(()) };
    let text = after.files.iter().find(|file| file.path == *path).map(|file| &*file.text).unwrap_or_default();
    let word = text.get(*at..).unwrap_or_default();
    let word = word
        .find(|sign: char| !sign.is_alphanumeric() && !"_*".contains(sign))
        .map_or(word, |end| &word[..end]);
    Err(Refusal(format!(
        "`{new}` would change what names mean: `{word}` at {} would stand for something else",
        shown(path, text, *at)
    )))
}
