//! A model with the texts that it is made of, and the other models that share them.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::{Component, Path, PathBuf};

use blocksim_block::CodePolicy;
use blocksim_block::problem::{Problem, Severity};
use blocksim_diagram::{Content, Model, ModelBlock, Reader, SourceFile, Sources, compile, model};
use blocksim_syntax::{Name, Node, Shape, read};

use crate::declared::{Section, declared};
use crate::refusal::Refusal;

/// A model that is to be changed.
#[derive(Clone, Copy)]
pub struct Project<'a> {
    /// Reads its files.
    pub reader: &'a dyn Reader,
    /// The file of the model.
    pub model: &'a Path,
    /// Files among which are the models that may share some of these files.
    pub others: &'a dyn Fn(&[PathBuf]) -> BTreeSet<PathBuf>,
    /// Whether a file changes that several blocks, or several models, are made of.
    pub shared: bool,
}

/// Texts in the place of those of the files.
pub(crate) struct With<'a> {
    pub reader: &'a dyn Reader,
    pub texts: &'a BTreeMap<PathBuf, String>,
}

impl Reader for With<'_> {
    fn read(&self, path: &Path) -> Result<String, String> {
        match self.texts.get(path) {
            Some(text) => Ok(text.clone()),
            None => self.reader.read(path),
        }
    }

    fn code(&self) -> &dyn CodePolicy {
        self.reader.code()
    }

    fn is_cancelled(&self) -> bool {
        self.reader.is_cancelled()
    }
}

/// The hierarchy of a model as its texts are now.
pub(crate) struct Opened {
    pub top: Model,
    pub files: Vec<SourceFile>,
    pub problems: Vec<Problem>,
}

/// A diagram of a model, with its text.
pub(crate) struct Level<'m> {
    pub model: &'m Model,
    pub file: SourceFile,
    /// The text as a tree.
    pub root: Node,
    /// Paths of the blocks that are made of the file.
    pub instances: Vec<String>,
    /// How often the files of the model name the file, in alternatives that are not chosen as well.
    pub uses: usize,
}

impl Project<'_> {
    /// Reads the model.
    pub(crate) fn open(&self) -> Result<Opened, Refusal> {
        let sources = Sources::new(self.reader);
        let (top, problems) = model(&sources, self.model, &[]);
        let files = sources.all();
        match top {
            Some(top) => Ok(Opened { top, files, problems }),
            None => {
                let error = problems.first();
                Err(error.map_or_else(
                    || Refusal::new("the model cannot be read"),
                    |one| Refusal::first(one, &files),
                ))
            }
        }
    }

    /// The problems of the model with other texts, and the files that they are in.
    pub(crate) fn problems(&self, texts: &BTreeMap<PathBuf, String>) -> (Vec<Problem>, Vec<SourceFile>) {
        let reader = With { reader: self.reader, texts };
        let sources = Sources::new(&reader);
        let problems = compile(&sources, self.model, &[]).problems;
        (problems, sources.all())
    }

    /// Errors that the model has with other texts and has not now.
    pub(crate) fn new_errors(&self, texts: &BTreeMap<PathBuf, String>) -> (Vec<Problem>, Vec<SourceFile>) {
        let (before, _) = self.problems(&BTreeMap::new());
        let (after, files) = self.problems(texts);
        let known: HashSet<(&str, &str)> =
            before.iter().map(|problem| (problem.code, problem.message.as_str())).collect();
        let is_new = |problem: &Problem| {
            problem.severity == Severity::Error && !known.contains(&(problem.code, problem.message.as_str()))
        };
        (after.into_iter().filter(is_new).collect(), files)
    }

    /// Whether a file may be changed for the sake of one block: several may be made of it.
    pub(crate) fn may_change(&self, level: &Level) -> Result<(), Refusal> {
        if self.shared {
            return Ok(());
        }
        let name = level.file.path.display();
        if level.instances.len() > 1 {
            let some =
                level.instances.iter().take(4).map(|path| format!("`{path}`")).collect::<Vec<_>>().join(", ");
            let more = if level.instances.len() > 4 { " ..." } else { "" };
            let message = format!("{} blocks are made of `{name}`: {some}{more}", level.instances.len());
            return Err(Refusal::shared(
                message,
                "change it for all of them, or give this block a file of its own",
            ));
        }
        if level.uses > 1 {
            let message = format!(
                "`{name}` is a part of this model in {} places, not all of which are chosen",
                level.uses
            );
            return Err(Refusal::shared(
                message,
                "change it for all of them, or give this block a file of its own",
            ));
        }
        let others = self.models_that_read(std::slice::from_ref(&level.file.path));
        let others: Vec<&PathBuf> =
            others.iter().filter(|other| other.as_path() != normal(self.model)).collect();
        match others.first() {
            Some(other) => Err(Refusal::shared(
                format!("`{name}` is a part of `{}` as well", other.display()),
                "change it for all models, or give this one a file of its own",
            )),
            None => Ok(()),
        }
    }

    /// Diagrams that stand for themselves and read one of these files, also by others.
    pub(crate) fn models_that_read(&self, files: &[PathBuf]) -> Vec<PathBuf> {
        let candidates = (self.others)(files);
        let text = |path: &Path| self.reader.read(path).ok();
        let mut named: BTreeMap<PathBuf, Vec<PathBuf>> = BTreeMap::new();
        let mut reaches = |root: &PathBuf| {
            let (mut seen, mut open) = (BTreeSet::from([root.clone()]), vec![root.clone()]);
            while let Some(file) = open.pop() {
                if files.contains(&file) {
                    return true;
                }
                let others = named.entry(file.clone()).or_insert_with(|| {
                    let folder = file.parent().unwrap_or(Path::new(""));
                    text(&file).map(|text| files_named_in(&text, folder)).unwrap_or_default()
                });
                open.extend(others.iter().filter(|other| seen.insert((*other).clone())).cloned());
            }
            false
        };
        let candidates = candidates.into_iter().map(|path| normal(&path));
        candidates.filter(|root| reaches(root) && text(root).is_some_and(|text| is_whole(&text))).collect()
    }
}

/// The path of the first diagram of a model that is made of a file; empty for the model itself.
///
/// # Errors
/// The model cannot be read, or nothing in it is made of the file.
pub fn instance_of(project: &Project, file: &Path) -> Result<String, Refusal> {
    let opened = project.open()?;
    let mut found = None;
    each(&opened.top, &mut |diagram| {
        let is_it = opened.files[diagram.ast.file.0 as usize].path == *file;
        if is_it && found.is_none() {
            found = Some(diagram.path.clone());
        }
    });
    found.ok_or_else(|| opened.cause(format!("no diagram of the model is made of `{}`", file.display())))
}

/// How often a text has a subsystem that is made of a file.
fn uses(text: &SourceFile, file: &Path) -> usize {
    // Most files name no others.
    if !text.text.contains("Subsystem") {
        return 0;
    }
    let Ok(root) = read(&text.text) else { return 0 };
    let folder = text.path.parent().unwrap_or(Path::new(""));
    let (mut count, mut open) = (0, vec![&root]);
    while let Some(node) = open.pop() {
        match &node.value {
            Shape::List(items) | Shape::Tuple(_, items) => open.extend(items),
            Shape::Map(members) | Shape::Struct(_, members) => {
                let is_it = |(name, value): &(Name, Node)| {
                    let Shape::Text(named) = &value.value else { return false };
                    name.text == "file" && normal(&folder.join(named)) == *file
                };
                count += usize::from(node.word() == Some("Subsystem") && members.iter().any(is_it));
                open.extend(members.iter().map(|(_, value)| value));
            }
            _ => {}
        }
    }
    count
}

/// Files that a text names, as paths.
fn files_named_in(text: &str, folder: &Path) -> Vec<PathBuf> {
    let named = text.split('"').filter(|piece| piece.ends_with(".ron"));
    named.map(|name| normal(&folder.join(name))).collect()
}

/// A path without `.` and `..`, as the compiler writes it.
pub(crate) fn normal(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if matches!(out.components().next_back(), Some(Component::Normal(_))) => {
                out.pop();
            }
            part => out.push(part),
        }
    }
    out
}

/// Whether a text is a diagram that stands for itself, though it may be part of a larger one as well.
pub fn is_whole(text: &str) -> bool {
    let is_open = |section| matches!(section, Section::Input | Section::Output | Section::Port);
    text.contains("Diagram(") && !declared(text).iter().any(|declared| is_open(declared.section))
}

impl Opened {
    /// The diagram at a path such as `arm/link1`; the top for an empty one.
    pub(crate) fn level(&self, path: &str) -> Result<Level<'_>, Refusal> {
        let mut model = &self.top;
        for name in path.split('/').filter(|name| !name.is_empty()) {
            let block = model.block(name).ok_or_else(|| no_block(model, name))?;
            model = match &block.content {
                Content::Diagram(inside) => inside,
                Content::Block { .. } => {
                    return Err(Refusal::new(format!("`{}` is not a subsystem", block.path)));
                }
                Content::Unknown => {
                    return Err(self.cause(format!("what is in `{}` is not known", block.path)));
                }
            };
        }
        let file = self.files[model.ast.file.0 as usize].clone();
        let root = read(&file.text).map_err(|error| Refusal::new(error.message))?;
        // What could not be read would be lost.
        let hides = |problem: &&Problem| {
            ["syntax", "duplicate_name", "bad_name"].contains(&problem.code)
                && problem.labels.first().is_some_and(|label| label.place.file == model.ast.file)
        };
        if let Some(problem) = self.problems.iter().find(hides) {
            return Err(Refusal::first(problem, &self.files));
        }
        let mut instances = Vec::new();
        each(&self.top, &mut |other| {
            if other.ast.file == model.ast.file {
                instances.push(other.path.clone());
            }
        });
        let uses = self.files.iter().map(|other| uses(other, &file.path)).sum();
        Ok(Level { model, file, root, instances, uses })
    }

    /// A refusal with the first error of the model as its reason.
    fn cause(&self, message: String) -> Refusal {
        match self.problems.iter().find(|problem| problem.severity == Severity::Error) {
            Some(problem) => Refusal::new(message).help(Refusal::first(problem, &self.files).message),
            None => Refusal::new(message),
        }
    }
}

/// Visits a diagram and all inside it.
fn each<'m>(model: &'m Model, visit: &mut impl FnMut(&'m Model)) {
    visit(model);
    for block in &model.blocks {
        if let Content::Diagram(inside) = &block.content {
            each(inside, visit);
        }
    }
}

/// That there is no such block, with those that may be meant.
pub(crate) fn no_block(model: &Model, name: &str) -> Refusal {
    let within = if model.path.is_empty() { String::new() } else { format!(" in `{}`", model.path) };
    let names: Vec<&str> = model.blocks.iter().map(|block| block.name.as_str()).collect();
    let some = names.iter().take(8).copied().collect::<Vec<_>>().join(", ");
    let more = if names.len() > 8 { " ..." } else { "" };
    Refusal::new(format!("there is no block `{name}`{within}"))
        .help(format!("the blocks here are {some}{more}"))
}

impl Level<'_> {
    /// A section of the diagram: `blocks`.
    pub(crate) fn section(&self, name: &str) -> Option<&Node> {
        let members = self.root.members()?;
        members.iter().find(|(known, _)| known.text == name).map(|(_, node)| node)
    }

    /// A block of the diagram.
    pub(crate) fn block(&self, name: &str) -> Result<&ModelBlock, Refusal> {
        self.model.block(name).ok_or_else(|| no_block(self.model, name))
    }

    /// The path of a block of the diagram from the top.
    pub(crate) fn path_of(&self, name: &str) -> String {
        below(&self.model.path, name)
    }
}

/// A path below another.
pub(crate) fn below(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_owned() } else { format!("{path}/{name}") }
}

/// The level of a path and the name of the block there.
pub(crate) fn split(path: &str) -> (&str, &str) {
    path.rsplit_once('/').unwrap_or(("", path))
}
