//! The files of a model.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use blocksim_block::problem::{FileId, Problem};
use blocksim_block::{CodePolicy, Files, LoadError, NoCode};

use crate::tree::{Node, read};

/// Reads files for the compiler, which itself opens none.
pub trait Reader {
    /// Text of a file.
    ///
    /// # Errors
    /// A sentence why it cannot be read.
    fn read(&self, path: &Path) -> Result<String, String>;

    /// Who decides whether code that a diagram names is built and loaded; without a decision none is.
    fn code(&self) -> &dyn CodePolicy {
        &NoCode
    }
}

/// A file of the model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SourceFile {
    /// Path as it was asked for, relative to where the program runs.
    pub path: PathBuf,
    /// Its text.
    pub text: Arc<str>,
}

/// The files of a model in the order in which they were first read.
pub struct Sources<'a> {
    reader: &'a dyn Reader,
    files: RefCell<Vec<SourceFile>>,
    /// Files as trees: a set that many values name is read once.
    trees: RefCell<HashMap<FileId, Result<Rc<Node>, Problem>>>,
}

impl<'a> Sources<'a> {
    /// No files yet.
    pub fn new(reader: &'a dyn Reader) -> Self {
        Self { reader, files: RefCell::default(), trees: RefCell::default() }
    }

    /// Reads a file once and numbers it.
    ///
    /// # Errors
    /// A sentence why it cannot be read.
    pub fn open(&self, path: &Path) -> Result<FileId, String> {
        let path = normal(path);
        if let Some(known) = self.files.borrow().iter().position(|file| file.path == path) {
            return Ok(FileId(known as u32));
        }
        let text = self.reader.read(&path)?;
        let mut files = self.files.borrow_mut();
        files.push(SourceFile { path, text: text.into() });
        Ok(FileId(files.len() as u32 - 1))
    }

    /// Holds a text that is in no file (the command line), so that messages can show it.
    pub(crate) fn hold(&self, path: &Path, text: &str) -> FileId {
        let mut files = self.files.borrow_mut();
        files.push(SourceFile { path: path.to_path_buf(), text: text.into() });
        FileId(files.len() as u32 - 1)
    }

    /// A file as a tree, or why it is none.
    pub(crate) fn tree(&self, id: FileId) -> Result<Rc<Node>, Problem> {
        if let Some(known) = self.trees.borrow().get(&id) {
            return known.clone();
        }
        let tree = read(&self.file(id).text).map(Rc::new).map_err(|error| error.problem(id));
        self.trees.borrow_mut().insert(id, tree.clone());
        tree
    }

    /// A file that was read.
    pub fn file(&self, id: FileId) -> SourceFile {
        self.files.borrow()[id.0 as usize].clone()
    }

    /// The folder of a file.
    pub fn folder(&self, id: FileId) -> PathBuf {
        self.file(id).path.parent().map(Path::to_path_buf).unwrap_or_default()
    }

    /// All files that were read.
    pub fn all(&self) -> Vec<SourceFile> {
        self.files.borrow().clone()
    }
}

/// Paths without `.` and, where it can be seen from the text, without `..`.
fn normal(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            std::path::Component::CurDir => {}
            std::path::Component::ParentDir
                if matches!(out.components().next_back(), Some(std::path::Component::Normal(_))) =>
            {
                out.pop();
            }
            part => out.push(part),
        }
    }
    out
}

/// Lets a block read files beside the diagram that names it.
pub(crate) struct BlockFiles<'a> {
    sources: &'a Sources<'a>,
    folder: PathBuf,
    warnings: RefCell<Vec<LoadError>>,
}

impl<'a> BlockFiles<'a> {
    /// Files beside this one.
    pub fn beside(sources: &'a Sources<'a>, file: FileId) -> Self {
        Self { sources, folder: sources.folder(file), warnings: RefCell::default() }
    }

    /// What blocks have reported about files.
    pub fn warnings(self) -> Vec<LoadError> {
        self.warnings.into_inner()
    }
}

impl Files for BlockFiles<'_> {
    fn read(&self, path: &str) -> Result<String, String> {
        let id = self.sources.open(&self.folder.join(path))?;
        Ok(self.sources.file(id).text.to_string())
    }

    fn folder(&self) -> &Path {
        &self.folder
    }

    fn code(&self) -> &dyn CodePolicy {
        self.sources.reader.code()
    }

    fn warn(&self, warning: LoadError) {
        self.warnings.borrow_mut().push(warning);
    }
}
