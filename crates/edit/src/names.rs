//! Names across the files of models: where they are declared, every place that names the same, other names for them.
//!
//! A new name is tried out before it is offered: the models are read with the changed texts, and every name in them must mean
//! what it has meant. So no name is captured by another diagram, by a unit or by a pattern.

mod comments;

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};

use blocksim_block::problem::{FileId, Place, Problem, Severity};
use blocksim_diagram::{Meaning, Mentions, Reader, SourceFile, Sources, Trees, mentions};

use crate::project::{Project, With};
use crate::refusal::{Refusal, line_of, place};

/// A name in a text: file, first byte, byte behind it.
pub type Spot = (PathBuf, usize, usize);

/// The names of a model.
struct Names {
    files: Vec<SourceFile>,
    names: Mentions,
    problems: Vec<Problem>,
}

impl Names {
    fn of(root: &Path, reader: &dyn Reader, trees: &Trees) -> Names {
        let sources = Sources::with_trees(reader, trees);
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
pub struct Meant {
    /// What it is.
    pub meaning: Meaning,
    /// The name.
    pub name: String,
    /// Where it stands, without patterns.
    pub spots: BTreeSet<Spot>,
    /// Where it is declared.
    pub declared: BTreeSet<Spot>,
    /// The one that the request is about.
    pub here: Spot,
    models: BTreeMap<PathBuf, Names>,
}

impl Meant {
    /// The text of a file.
    pub fn text(&self, path: &Path) -> Option<&str> {
        self.file(path).map(|file| &*file.text)
    }

    fn file(&self, path: &Path) -> Option<&SourceFile> {
        self.models.values().flat_map(|names| &names.files).find(|file| file.path == path)
    }

    /// Where comments show how to `--set` it.
    pub(crate) fn in_comments(&self, project: &Project) -> Vec<Spot> {
        let file = |(root, names): (&PathBuf, &'_ Names)| {
            let file = names.files.iter().find(|file| file.path == *root);
            file.map(|file| comments::spots(project.reader, file, self, &names.names)).unwrap_or_default()
        };
        self.models.iter().flat_map(file).collect()
    }

    /// A spot as a person names it: `segment.ron:12`.
    pub fn shown(&self, (path, start, _): &Spot) -> String {
        self.file(path).map(|file| line_of(file, *start)).unwrap_or_default()
    }
}

/// What stands at a byte of a file, with all that names the same in the models that have one of the files. Nothing if no name
/// stands there, or if the reader has cancelled the search.
pub fn meant(project: &Project, trees: &Trees, path: &Path, at: usize) -> Option<Meant> {
    let first = Names::of(project.model, project.reader, trees);
    let file = first.files.iter().position(|file| file.path == path)?;
    let mention = first.names.at(FileId(file as u32), at)?;
    let symbol = &first.names.symbols[*mention.symbols.first()?];
    let (meaning, name, here) = (symbol.meaning, symbol.name.clone(), first.spot(&mention.place));
    let mut found = Meant {
        meaning,
        name,
        spots: BTreeSet::from([here.clone()]),
        declared: BTreeSet::new(),
        here,
        models: BTreeMap::from([(project.model.to_owned(), first)]),
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
            return (!project.reader.is_cancelled()).then_some(found);
        }
        for root in project.models_that_read(&new) {
            if let Entry::Vacant(entry) = found.models.entry(root) {
                let names = Names::of(entry.key(), project.reader, trees);
                if new.iter().any(|file| names.has(file)) {
                    entry.insert(names);
                }
            }
        }
    }
}

/// Errors that hide no names: what is connected to what, and units.
const HARMLESS: [&str; 9] = [
    "unconnected_input",
    "second_driver",
    "wrong_direction",
    "port_kind",
    "domain_mismatch",
    "unit_mismatch",
    "type_mismatch",
    "parameter",
    "missing_parameter",
];

/// What stands at a byte of a file, unless something is against another name.
///
/// # Errors
/// Nothing that can be renamed stands there, errors may hide names, or the name has to stay.
pub fn renamable(project: &Project, trees: &Trees, path: &Path, at: usize) -> Result<Meant, Refusal> {
    let Some(found) = meant(project, trees, path, at) else {
        let sorts =
            "blocks, parameters of diagrams, and inputs, outputs and ports of subsystems can be renamed";
        return Err(Refusal::new(format!("there is no such name here: {sorts}")));
    };
    for (root, names) in &found.models {
        // A plug-in that is not loaded hides no names.
        let hides = |problem: &&Problem| {
            problem.severity == Severity::Error
                && !problem.code.starts_with("plugin_")
                && !HARMLESS.contains(&problem.code)
        };
        if let Some(problem) = names.problems.iter().find(hides) {
            let at = problem.labels.first().and_then(|label| place(&label.place, &names.files));
            return Err(Refusal::new(format!(
                "first correct the errors of {}, which may hide names: {}{}",
                root.file_name().unwrap_or_default().to_string_lossy(),
                at.map(|at| format!("{at}: ")).unwrap_or_default(),
                problem.message
            )));
        }
        for symbol in names.symbols_at(&found.spots) {
            if let Some(reason) = &names.names.symbols[symbol].fixed {
                return Err(Refusal::new(format!("`{}` cannot be renamed: {reason}", found.name)));
            }
        }
        // One text of a model that means different things in different instances.
        let unclear = names.names.all.iter().find(|one| {
            one.symbols.len() > 1 && one.pattern.is_none() && found.spots.contains(&names.spot(&one.place))
        });
        if let Some(one) = unclear {
            let at = |at: &Place| place(at, &names.files).unwrap_or_default();
            let declared = one.symbols.iter().flat_map(|&symbol| &names.names.symbols[symbol].declared);
            let declared: Vec<String> = declared.map(at).collect();
            return Err(Refusal::new(format!(
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
///
/// # Errors
/// It cannot.
pub fn check_name(new: &str) -> Result<(), Refusal> {
    let starts = new.chars().next().is_some_and(|sign| sign.is_ascii_alphabetic());
    if !starts || !new.chars().all(|sign| sign.is_ascii_alphanumeric() || sign == '_') || new == "in" {
        let rule = "names start with a letter, then letters, digits and `_`; `in` is reserved";
        return Err(Refusal::new(format!("`{new}` is not a valid name: {rule}")));
    }
    Ok(())
}

/// Another name for what stands at a byte of a file.
pub struct Renaming {
    /// What gets another name.
    pub meant: Meant,
    /// The bytes that the new name replaces, by file; none where it is the present one.
    pub spots: BTreeMap<PathBuf, Vec<Range<usize>>>,
}

impl Renaming {
    /// The texts with the new name.
    pub fn texts(&self, new: &str) -> BTreeMap<PathBuf, String> {
        let mut texts = BTreeMap::new();
        for (path, spots) in &self.spots {
            let mut text = self.meant.text(path).unwrap_or_default().to_owned();
            spots.iter().rev().for_each(|spot| text.replace_range(spot.clone(), new));
            texts.insert(path.clone(), text);
        }
        texts
    }
}

/// Gives another name to what stands at a byte of a file, wherever it is named: in all models that share the file, and where
/// comments show how to `--set` it.
///
/// # Errors
/// The name is not one, is taken, or something would mean something else.
pub fn renamed(
    project: &Project,
    trees: &Trees,
    path: &Path,
    at: usize,
    new: &str,
) -> Result<Renaming, Refusal> {
    check_name(new)?;
    let found = renamable(project, trees, path, at)?;
    if new == found.name {
        return Ok(Renaming { meant: found, spots: BTreeMap::new() });
    }
    not_taken(&found, new)?;
    let mut all = found.spots.clone();
    all.extend(found.in_comments(project));
    let mut spots: BTreeMap<PathBuf, Vec<Range<usize>>> = BTreeMap::new();
    for (path, start, end) in &all {
        spots.entry(path.clone()).or_default().push(*start..*end);
    }
    let renaming = Renaming { meant: found, spots };
    let texts = renaming.texts(new);
    let reader = With { reader: project.reader, texts: &texts };
    let trees = Trees::default();
    for (root, before) in &renaming.meant.models {
        let after = Names::of(root, &reader, &trees);
        same(&renaming.meant, &all, before, &after, new)?;
    }
    Ok(renaming)
}

/// Whether no other symbol of the sort has the name in one of the diagrams.
fn not_taken(found: &Meant, new: &str) -> Result<(), Refusal> {
    for names in found.models.values() {
        let taken =
            names.names.symbols.iter().filter(|symbol| symbol.meaning == found.meaning && symbol.name == new);
        for place in taken.flat_map(|symbol| &symbol.declared) {
            let file = &names.files[place.file.0 as usize];
            if found.declared.iter().any(|(path, ..)| *path == file.path) {
                return Err(Refusal::new(format!(
                    "`{new}` is taken: it is {} at {}",
                    found.meaning.described(),
                    line_of(file, place.span.start)
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
fn same(
    found: &Meant,
    spots: &BTreeSet<Spot>,
    before: &Names,
    after: &Names,
    new: &str,
) -> Result<(), Refusal> {
    let errors = |names: &Names| {
        let errors = names.problems.iter().filter(|problem| problem.severity == Severity::Error);
        errors.map(|problem| problem.code).collect::<Vec<_>>()
    };
    if errors(before) != errors(after) {
        let problem = after.problems.iter().find(|problem| problem.severity == Severity::Error);
        let reason = problem.map_or("another error would be hidden", |problem| &problem.message);
        return Err(Refusal::new(format!("with the name `{new}` the model would have errors: {reason}")));
    }
    let moved = |(path, start, _): Spot| {
        let longer = new.len() as isize - found.name.len() as isize;
        let first = (path.clone(), 0, 0);
        let earlier = spots.range(first..(path.clone(), start, 0)).count() as isize;
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
    let Some(file) = after.files.iter().find(|file| file.path == *path) else { return Ok(()) };
    let word = file.text.get(*at..).unwrap_or_default();
    let word = word
        .find(|sign: char| !sign.is_alphanumeric() && !"_*".contains(sign))
        .map_or(word, |end| &word[..end]);
    Err(Refusal::new(format!(
        "`{new}` would change what names mean: `{word}` at {} would stand for something else",
        line_of(file, *at)
    )))
}
