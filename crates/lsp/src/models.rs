//! Which model a file belongs to, what is wrong with it, and what its blocks look like.

use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use blocksim_block::CodePolicy;
use blocksim_block::problem::{Label, Problem, Severity};
use blocksim_diagram::{Options, SourceFile, Sources, Trees, compile_and_keep, model};
use blocksim_edit::{Blocks, Learned, is_whole};
use lsp_types::{
    Diagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, Location, NumberOrString, Range as Span,
};

use crate::fixes::{Fix, fix};
use crate::position::span;
use crate::texts::{Disk, Snapshot, Texts};
use crate::uri::uri_of;

/// Folders above a file in which its model is looked for, and files there that are looked at.
const FOLDERS: usize = 3;
const MOST: usize = 100;

/// Problems of files.
pub type Found = BTreeMap<PathBuf, Vec<Diagnostic>>;

/// What is known of the models of all open files.
#[derive(Debug, Clone, Default)]
pub struct Known {
    /// Problems by file, with an empty list for each file without any.
    pub found: Found,
    /// What fixes the problems of each file.
    pub fixes: BTreeMap<PathBuf, Vec<Fix>>,
    /// Blocks by file.
    pub blocks: BTreeMap<PathBuf, Blocks>,
    /// The alternatives of `Choice` parameters by the name of the parameter.
    pub choices: BTreeMap<String, Vec<String>>,
}

impl Known {
    /// That a compilation has ended by a bug, reported in each open file, since the text that caused it is unknown.
    pub fn after_a_bug(snapshot: &Snapshot) -> Known {
        let message =
            "this is a bug of blocksim: compiling this model has failed, so its problems are not known";
        let diagnostic = Diagnostic {
            severity: Some(DiagnosticSeverity::ERROR),
            source: Some("blocksim".to_owned()),
            message: message.to_owned(),
            ..Diagnostic::default()
        };
        let found = snapshot.open.keys().map(|path| (path.clone(), vec![diagnostic.clone()])).collect();
        Known { found, ..Known::default() }
    }
}

/// What was read for a model, and what came of it.
#[derive(Debug, Default)]
struct Last {
    /// Files that were requested, with their texts where there were any.
    read: Vec<(PathBuf, Option<Arc<str>>)>,
    known: Known,
}

/// The models of open files. Work is done once: texts are parsed again when they differ, files are read again when the disk
/// has others, and a model is compiled again when one of its texts differs.
#[derive(Debug, Default)]
pub struct Models {
    /// The model of each open file.
    roots: BTreeMap<PathBuf, PathBuf>,
    blocks: BTreeMap<PathBuf, Blocks>,
    last: BTreeMap<PathBuf, Last>,
    /// Files of the disk.
    pub disk: Disk,
    /// Parsed texts.
    pub trees: Trees,
    /// Folders that the editor has open.
    pub folders: Vec<PathBuf>,
    compiled: Cell<usize>,
}

impl Models {
    /// Nothing known; the editor has these folders open.
    pub fn of(folders: Vec<PathBuf>) -> Models {
        Models { folders, ..Models::default() }
    }

    /// Looks for the model of a file anew, and at everything that may have changed on the disk.
    pub fn forget(&mut self, path: &Path) {
        self.roots.remove(path);
        self.last.clear();
    }

    /// How many models have been compiled so far.
    #[cfg(test)]
    pub fn compiled(&self) -> usize {
        self.compiled.get()
    }

    /// Compiles the models of all open files; nothing if texts change meanwhile.
    pub fn look(&mut self, snapshot: &Snapshot, code: &dyn CodePolicy) -> Option<Known> {
        let mut known = Known::default();
        let mut roots: Vec<PathBuf> = Vec::new();
        for path in snapshot.open.keys() {
            let root = self.root(path, snapshot, code);
            known.found.entry(path.clone()).or_default();
            if !roots.contains(&root) {
                roots.push(root);
            }
        }
        self.last.retain(|root, _| roots.contains(root));
        for root in roots {
            let is_known = self.last.get(&root).is_some_and(|last| is_same(last, snapshot, &self.disk));
            if !is_known {
                let last = self.compile(&root, snapshot, code)?;
                self.last.insert(root.clone(), last);
            }
            let Known { found, fixes, choices, .. } = &self.last[&root].known;
            for (path, diagnostics) in found {
                let of_file = known.found.entry(path.clone()).or_default();
                let new: Vec<_> = diagnostics.iter().filter(|one| !of_file.contains(one)).cloned().collect();
                of_file.extend(new);
            }
            for (path, fixes) in fixes {
                known.fixes.entry(path.clone()).or_default().extend(fixes.iter().cloned());
            }
            known.choices.extend(choices.iter().map(|(name, of)| (name.clone(), of.clone())));
        }
        known.blocks = self.blocks.clone();
        (!snapshot.is_stale()).then_some(known)
    }

    /// The model that an open file belongs to.
    pub fn root(&mut self, path: &Path, snapshot: &Snapshot, code: &dyn CodePolicy) -> PathBuf {
        if let Some(root) = self.roots.get(path) {
            return root.clone();
        }
        let mut texts = Texts::new(snapshot, &self.disk, code);
        texts.is_patient = true;
        let root = root_of(path, &texts, &self.trees);
        self.roots.insert(path.to_owned(), root.clone());
        root
    }

    fn compile(&mut self, root: &Path, snapshot: &Snapshot, code: &dyn CodePolicy) -> Option<Last> {
        let texts = Texts::new(snapshot, &self.disk, code);
        let sources = Sources::with_trees(&texts, &self.trees);
        let (model, compiled) = compile_and_keep(&sources, root, &Options::default());
        self.compiled.set(self.compiled.get() + 1);
        if snapshot.is_stale() {
            return None;
        }
        let mut known = Known::default();
        let files = sources.all();
        let read = |file: &SourceFile| (file.path.clone(), Some(file.text.clone()));
        let mut last = Last { read: files.iter().map(read).collect(), ..Last::default() };
        last.read.extend(texts.missing.take().into_iter().map(|path| (path, None)));
        for file in &files {
            known.found.entry(file.path.clone()).or_default();
        }
        for problem in &compiled.problems {
            let (path, diagnostic) = diagnostic(problem, &files, root);
            let of_file = known.found.entry(path.clone()).or_default();
            if !of_file.contains(&diagnostic) {
                let fix = fix(problem, &diagnostic, &files);
                known.fixes.entry(path).or_default().extend(fix);
                of_file.push(diagnostic);
            }
        }
        if let Some(model) = model {
            let mut learned = Learned { blocks: std::mem::take(&mut self.blocks), ..Learned::default() };
            learned.learn(&model, &sources, &compiled);
            (self.blocks, known.choices) = (learned.blocks, learned.choices);
        }
        last.known = known;
        Some(last)
    }
}

/// Whether all texts of a model are what they were.
fn is_same(last: &Last, snapshot: &Snapshot, disk: &Disk) -> bool {
    let text = |path: &PathBuf| match snapshot.open.get(path) {
        Some(document) => Some(document.text.clone()),
        None => disk.read(path).ok(),
    };
    last.read.iter().all(|(path, read)| text(path) == *read)
}

/// The model that a file belongs to: itself if it is whole, else the first in its folder or above that reads it, the one
/// named as its folder before all others.
fn root_of(path: &Path, texts: &Texts, trees: &Trees) -> PathBuf {
    let text = texts.text(path).unwrap_or_else(|_| "".into());
    if is_whole(&text) {
        return path.to_owned();
    }
    let reads = |candidate: &PathBuf| {
        let sources = Sources::with_trees(texts, trees);
        model(&sources, candidate, &[]);
        sources.all().iter().any(|file| file.path == path)
    };
    let folders = path.ancestors().skip(1).take(FOLDERS);
    let found = folders.flat_map(diagrams).filter(|candidate| candidate != path).take(MOST).find(reads);
    found.unwrap_or_else(|| path.to_owned())
}

/// Most files of a folder of the editor that are looked at, and how deep they may lie.
const MOST_FILES: usize = 5000;
const DEEPEST: usize = 8;

/// Files among which are the diagrams that read one of these files: those of the folders of the editor that hold a file, else
/// those beside the file and above it, and all that are open.
pub fn candidates(files: &[PathBuf], folders: &[PathBuf], snapshot: &Snapshot) -> BTreeSet<PathBuf> {
    let mut candidates: BTreeSet<PathBuf> = BTreeSet::new();
    for file in files {
        let within: Vec<&PathBuf> = folders.iter().filter(|folder| file.starts_with(folder)).collect();
        match within.is_empty() {
            true => candidates.extend(file.ancestors().skip(1).take(FOLDERS).flat_map(diagrams)),
            false => within.iter().for_each(|folder| gather(folder, 0, &mut candidates)),
        }
    }
    candidates.extend(snapshot.open.keys().cloned());
    candidates
}

/// All `.ron` files of a folder and below.
fn gather(folder: &Path, depth: usize, found: &mut BTreeSet<PathBuf>) {
    let is_text = |path: &Path| path.extension().is_some_and(|ending| ending == "ron");
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries {
        let path = entry.path();
        let name = entry.file_name();
        let is_hidden = name.to_string_lossy().starts_with('.');
        let is_built = ["target", "runs", "node_modules"].iter().any(|other| name == *other);
        match entry.file_type() {
            Ok(kind) if kind.is_dir() && !is_hidden && !is_built && depth < DEEPEST => {
                gather(&path, depth + 1, found);
            }
            Ok(kind) if kind.is_file() && found.len() < MOST_FILES && is_text(&path) => {
                found.insert(path);
            }
            _ => {}
        }
    }
}

/// Diagrams of a folder by name; the one named as the folder first.
fn diagrams(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|ending| ending == "ron"))
        .collect();
    files.sort_by_key(|file| (file.file_stem() != folder.file_name(), file.clone()));
    files
}

/// A problem as the protocol writes it, and the file that it is shown in.
fn diagnostic(problem: &Problem, files: &[SourceFile], root: &Path) -> (PathBuf, Diagnostic) {
    let place = |label: &Label| -> Option<(PathBuf, Span)> {
        let file = files.get(label.place.file.0 as usize)?;
        Some((file.path.clone(), span(&file.text, &label.place.span)))
    };
    let mut labels = problem.labels.iter();
    let first = labels.next();
    let (path, range) = first.and_then(place).unwrap_or_else(|| (root.to_owned(), Span::default()));
    let mut message = problem.message.clone();
    if let Some(label) = first.filter(|label| !label.text.is_empty()) {
        message.push_str(&format!("\n{}", label.text));
    }
    problem.notes.iter().for_each(|note| message.push_str(&format!("\nnote: {note}")));
    problem.help.iter().for_each(|help| message.push_str(&format!("\nhelp: {help}")));
    let related = labels.filter_map(|label| {
        let (path, range) = place(label)?;
        let message = if label.text.is_empty() { problem.message.clone() } else { label.text.clone() };
        Some(DiagnosticRelatedInformation { location: Location::new(uri_of(&path)?, range), message })
    });
    let related: Vec<_> = related.collect();
    let severity = match problem.severity {
        Severity::Error => DiagnosticSeverity::ERROR,
        Severity::Warning => DiagnosticSeverity::WARNING,
        Severity::Note => DiagnosticSeverity::INFORMATION,
    };
    let diagnostic = Diagnostic {
        range,
        severity: Some(severity),
        code: Some(NumberOrString::String(problem.code.to_owned())),
        source: Some("blocksim".to_owned()),
        message,
        related_information: (!related.is_empty()).then_some(related),
        ..Diagnostic::default()
    };
    (path, diagnostic)
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;
    use std::sync::atomic::AtomicU64;

    use blocksim_block::{Decision, untrusted};
    // Diagrams need a library, the robot plug-ins as well.
    use blocksim_blocks as _;
    use blocksim_host as _;

    use super::*;
    use crate::texts::{Document, Open};

    /// Trusts nothing, and counts how often it is asked.
    #[derive(Debug, Default)]
    struct Counting(RefCell<Vec<String>>);

    impl CodePolicy for Counting {
        fn decide(&self, _folder: &Path, named: &str) -> Decision {
            self.0.borrow_mut().push(named.to_owned());
            Decision::Refuse(untrusted(named))
        }
    }

    fn snapshot(open: &Open, number: u64) -> Snapshot {
        Snapshot { open: Arc::new(open.clone()), number, newest: Arc::new(AtomicU64::new(number)) }
    }

    fn flagship(name: &str) -> (PathBuf, Arc<str>) {
        let folder =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../diagrams/irb2600").canonicalize().unwrap();
        let path = folder.join(name);
        let text = std::fs::read_to_string(&path).unwrap();
        (path, text.into())
    }

    #[test]
    fn a_key_in_the_largest_file_of_the_robot_costs_one_text_and_one_compilation() {
        let code = Counting::default();
        let mut models = Models::default();
        let mut open = Open::new();
        for name in ["irb2600.ron", "feedforward_central.ron", "manipulator.ron"] {
            let (path, text) = flagship(name);
            open.insert(path, Document { text, version: 1 });
        }
        let known = models.look(&snapshot(&open, 0), &code).expect("nobody types");
        let (path, text) = flagship("feedforward_central.ron");
        assert!(known.found.len() > 25, "{:?}", known.found.keys());
        assert_eq!(models.roots[&path], path.with_file_name("irb2600.ron"));
        // The description of the arm is a file of values: alone it is no diagram.
        let (parsed, compiled, reads) = (models.trees.parsed(), models.compiled(), models.disk.reads());
        for (n, new) in
            ["Mux(inputs: 6)", "Mux(inputs: 7)", "Mux(input: 7)", "Mux(inputs: 6"].iter().enumerate()
        {
            let typed = text.replacen("Mux(inputs: 6)", new, 1);
            open.insert(path.clone(), Document { text: typed.into(), version: 2 });
            let known = models.look(&snapshot(&open, 1), &code).expect("nobody types");
            // Beside the plug-in that is not trusted.
            let is_slip = |one: &&Diagnostic| {
                let code = NumberOrString::String("plugin_untrusted".to_owned());
                one.severity == Some(DiagnosticSeverity::ERROR) && one.code != Some(code)
            };
            assert_eq!(known.found[&path].iter().any(|one| is_slip(&one)), n > 0, "{new}");
            // The first text is the one before.
            assert_eq!(models.trees.parsed(), parsed + n, "{new}");
            assert_eq!(models.compiled(), compiled + n, "{new}");
            assert_eq!(models.disk.reads(), reads, "{new}");
        }
        assert!(!code.0.borrow().is_empty(), "the policy has been asked, and nothing was loaded");
    }

    #[test]
    fn work_on_texts_that_have_changed_ends_without_an_answer() {
        let mut models = Models::default();
        let (path, text) = flagship("irb2600.ron");
        let open = Open::from([(path, Document { text, version: 1 })]);
        let stale = snapshot(&open, 0);
        stale.newest.store(1, std::sync::atomic::Ordering::Relaxed);
        assert!(models.look(&stale, &Counting::default()).is_none());
        assert!(models.last.is_empty() && models.blocks.is_empty());
    }
}
