//! Texts as the editor has them, which come before those on the disk.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use blocksim_block::CodePolicy;
use blocksim_diagram::Reader;

/// Largest file that is read.
const LARGEST: u64 = 64 << 20;

/// Open files with their texts.
#[derive(Debug)]
pub struct Texts {
    open: BTreeMap<PathBuf, String>,
    code: Box<dyn CodePolicy>,
}

impl Texts {
    /// No open files; `code` decides whether plug-ins that they name are built and loaded.
    pub fn new(code: Box<dyn CodePolicy>) -> Texts {
        Texts { open: BTreeMap::new(), code }
    }

    /// Takes the text of a file over.
    pub fn put(&mut self, path: PathBuf, text: String) {
        self.open.insert(path, text);
    }

    /// From now on the text on the disk counts.
    pub fn close(&mut self, path: &Path) {
        self.open.remove(path);
    }

    /// Open files.
    pub fn open(&self) -> impl Iterator<Item = &PathBuf> {
        self.open.keys()
    }

    /// The text of an open file.
    pub fn get(&self, path: &Path) -> Option<&str> {
        self.open.get(path).map(String::as_str)
    }
}

impl Reader for Texts {
    fn read(&self, path: &Path) -> Result<String, String> {
        if let Some(text) = self.get(path) {
            return Ok(text.to_owned());
        }
        let about = std::fs::metadata(path).map_err(|error| error.to_string())?;
        if !about.is_file() || about.len() > LARGEST {
            return Err("it is not a text file".to_owned());
        }
        std::fs::read_to_string(path).map_err(|error| error.to_string())
    }

    fn code(&self) -> &dyn CodePolicy {
        &*self.code
    }
}
