//! The files of a model.

use std::cell::{Cell, RefCell};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use blocksim_block::problem::FileId;
use blocksim_block::{CodePolicy, Files, LoadError, NoCode};
use foldhash::HashMap;

use crate::mentions::Log;
use blocksim_syntax::{Node, SyntaxError, read};

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

    /// Whether nobody waits for the answer any more. The compiler then stops soon; what it returns is incomplete.
    fn is_cancelled(&self) -> bool {
        false
    }
}

/// A text as a tree, or what is wrong with it.
pub(crate) type TreeOrError = Result<Rc<Node>, SyntaxError>;

/// Texts as trees, for a program that compiles a model again and again while one of its files changes: what has the same
/// text as the last time is not parsed again.
#[derive(Debug, Default)]
pub struct Trees {
    kept: RefCell<HashMap<PathBuf, (Arc<str>, TreeOrError)>>,
    parsed: Cell<usize>,
}

impl Trees {
    /// How many texts have been parsed so far.
    pub fn parsed(&self) -> usize {
        self.parsed.get()
    }

    fn of(&self, file: &SourceFile) -> TreeOrError {
        if let Some((text, tree)) = self.kept.borrow().get(&file.path)
            && (Arc::ptr_eq(text, &file.text) || *text == file.text)
        {
            return tree.clone();
        }
        self.parsed.set(self.parsed.get() + 1);
        let tree = read(&file.text).map(Rc::new);
        self.kept.borrow_mut().insert(file.path.clone(), (file.text.clone(), tree.clone()));
        tree
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
    /// Trees of earlier compilations, and those of this one where there are none.
    trees: Option<&'a Trees>,
    own: Trees,
    /// What names mean, where somebody asks for that.
    pub(crate) log: Log,
}

impl<'a> Sources<'a> {
    /// No files yet.
    pub fn new(reader: &'a dyn Reader) -> Self {
        Self { reader, files: RefCell::default(), trees: None, own: Trees::default(), log: Log::default() }
    }

    /// No files yet; texts that were parsed before are not parsed again.
    pub fn with_trees(reader: &'a dyn Reader, trees: &'a Trees) -> Self {
        Self { trees: Some(trees), ..Self::new(reader) }
    }

    /// The text of a file as a tree.
    pub(crate) fn tree(&self, id: FileId) -> TreeOrError {
        self.trees.unwrap_or(&self.own).of(&self.file(id))
    }

    /// Whether nobody waits for the answer any more.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.reader.is_cancelled()
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
    asked: Cell<bool>,
}

impl<'a> BlockFiles<'a> {
    /// Files beside this one.
    pub fn beside(sources: &'a Sources<'a>, file: FileId) -> Self {
        Self { sources, folder: sources.folder(file), warnings: RefCell::default(), asked: Cell::default() }
    }

    /// Whether blocks wanted to know anything of files.
    pub fn were_asked(&self) -> bool {
        self.asked.get() || !self.warnings.borrow().is_empty()
    }

    /// What blocks have reported about files.
    pub fn warnings(self) -> Vec<LoadError> {
        self.warnings.into_inner()
    }
}

impl Files for BlockFiles<'_> {
    fn read(&self, path: &str) -> Result<String, String> {
        self.asked.set(true);
        let id = self.sources.open(&self.folder.join(path))?;
        Ok(self.sources.file(id).text.to_string())
    }

    fn folder(&self) -> &Path {
        self.asked.set(true);
        &self.folder
    }

    fn code(&self) -> &dyn CodePolicy {
        self.asked.set(true);
        self.sources.reader.code()
    }

    fn warn(&self, warning: LoadError) {
        self.warnings.borrow_mut().push(warning);
    }
}
