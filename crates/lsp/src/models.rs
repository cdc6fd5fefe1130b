//! Which model a file belongs to, what is wrong with it, and what its blocks look like.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use blocksim_block::problem::{Label, Problem, Severity};
use blocksim_diagram::{Content, Model, ModelBlock, SourceFile, Sources, compile, model};
use lsp_types::{
    Diagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, Location, NumberOrString, Range as Span,
};

use crate::fixes::{Fix, fix};
use crate::names::{Section, declared};
use crate::position::span;
use crate::texts::Texts;
use crate::uri::uri_of;

/// Folders above a file in which its model is looked for, and files there that are looked at.
const FOLDERS: usize = 3;
const MOST: usize = 100;

/// A port of a block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Port {
    /// Its name.
    pub name: String,
    /// `input`, `output` or the domain of a conserving one.
    pub side: String,
    /// Its unit, where it has one of its own.
    pub unit: String,
    /// A sentence.
    pub doc: String,
}

/// Blocks of a file with their ports, as they were when the diagram could be read last.
pub type Blocks = BTreeMap<String, Vec<Port>>;

/// Problems of files.
pub type Found = BTreeMap<PathBuf, Vec<Diagnostic>>;

/// What is known of the models of open files.
#[derive(Debug, Default)]
pub struct Models {
    /// The model of each open file.
    roots: BTreeMap<PathBuf, PathBuf>,
    blocks: BTreeMap<PathBuf, Blocks>,
    /// What mends the problems of each file, as it was looked at last.
    fixes: BTreeMap<PathBuf, Vec<Fix>>,
}

impl Models {
    /// Looks for the model of a file anew.
    pub fn forget(&mut self, path: &Path) {
        self.roots.remove(path);
    }

    /// Blocks of a file with their ports.
    pub fn blocks(&self, path: &Path) -> Option<&Blocks> {
        self.blocks.get(path)
    }

    /// What mends the problems of a file.
    pub fn fixes(&self, path: &Path) -> &[Fix] {
        self.fixes.get(path).map_or(&[], Vec::as_slice)
    }

    /// Compiles the models of all open files; problems by file, with an empty list for each file without any.
    pub fn look(&mut self, texts: &Texts) -> Found {
        let mut found = Found::new();
        self.fixes.clear();
        let mut roots: Vec<PathBuf> = Vec::new();
        for path in texts.open() {
            let root = self.roots.entry(path.clone()).or_insert_with(|| root_of(path, texts)).clone();
            found.entry(path.clone()).or_default();
            if !roots.contains(&root) {
                roots.push(root);
            }
        }
        for root in roots {
            let sources = Sources::new(texts);
            let problems = compile(&sources, &root, &[]).problems;
            let files = sources.all();
            for file in &files {
                found.entry(file.path.clone()).or_default();
            }
            for problem in &problems {
                let (path, diagnostic) = diagnostic(problem, &files, &root);
                let of_file = found.entry(path.clone()).or_default();
                if !of_file.contains(&diagnostic) {
                    let fix = fix(problem, &diagnostic, &files);
                    self.fixes.entry(path).or_default().extend(fix);
                    of_file.push(diagnostic);
                }
            }
            let sources = Sources::new(texts);
            if let (Some(model), _) = model(&sources, &root, &[]) {
                self.remember(&model, &sources);
            }
        }
        found
    }

    fn remember(&mut self, model: &Model, sources: &Sources) {
        let blocks = self.blocks.entry(sources.file(model.ast.file).path).or_default();
        for block in model.blocks.iter().filter(|block| !matches!(block.content, Content::Unknown)) {
            blocks.insert(block.name.clone(), ports(block));
        }
        for block in &model.blocks {
            if let Content::Diagram(inside) = &block.content {
                self.remember(inside, sources);
            }
        }
    }
}

/// The model that a file belongs to: itself if it is whole, else the first in its folder or above that reads it, the one
/// named as its folder before all others.
fn root_of(path: &Path, texts: &Texts) -> PathBuf {
    let text = texts.get(path).unwrap_or_default();
    let is_open = |section| matches!(section, Section::Input | Section::Output | Section::Port);
    let is_whole =
        text.contains("Diagram(") && !declared(text).iter().any(|declared| is_open(declared.section));
    // It may still be part of a larger one, but it stands for itself as well.
    if is_whole {
        return path.to_owned();
    }
    let reads = |candidate: &PathBuf| {
        let sources = Sources::new(texts);
        model(&sources, candidate, &[]);
        sources.all().iter().any(|file| file.path == path)
    };
    let folders = path.ancestors().skip(1).take(FOLDERS);
    let found = folders.flat_map(diagrams).filter(|candidate| candidate != path).take(MOST).find(reads);
    found.unwrap_or_else(|| path.to_owned())
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

fn ports(block: &ModelBlock) -> Vec<Port> {
    let Content::Block { interface, .. } = &block.content else {
        let named = |names: Vec<String>, side: &'static str| {
            let port =
                move |name| Port { name, side: side.to_owned(), unit: String::new(), doc: String::new() };
            names.into_iter().map(port)
        };
        let signals = named(block.inputs(), "input").chain(named(block.outputs(), "output"));
        return signals.chain(named(block.ports(), "conserving")).collect();
    };
    let inputs = interface.inputs.iter().map(|input| Port {
        name: input.name.clone(),
        side: "input".to_owned(),
        unit: written(input.dimension),
        doc: input.doc.to_owned(),
    });
    let outputs = interface.outputs.iter().map(|output| Port {
        name: output.name.clone(),
        side: "output".to_owned(),
        unit: written(output.port_type.dimension),
        doc: output.doc.to_owned(),
    });
    let conserving = interface.ports.iter().filter(|port| !port.inner).map(|port| Port {
        name: port.name.clone(),
        side: port.domain.to_string(),
        unit: String::new(),
        doc: port.doc.to_owned(),
    });
    inputs.chain(outputs).chain(conserving).collect()
}

/// A unit; empty where there is none.
fn written(unit: Option<impl ToString>) -> String {
    unit.map_or_else(String::new, |unit| unit.to_string())
}
