//! Edits of the diagrams that ship with the project.

mod nodes;
mod random;
mod same;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use blocksim_block::{AnyCode, CodePolicy};
use blocksim_blocks as _;
use blocksim_diagram::Reader;
use blocksim_edit::{Change, Project, is_whole};
use blocksim_host as _;

/// The project's root.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().expect("the project")
}

/// Files of the project, with other texts for some.
#[derive(Debug, Clone, Default)]
struct Texts {
    changed: BTreeMap<PathBuf, String>,
    with_code: bool,
}

impl Reader for Texts {
    fn read(&self, path: &Path) -> Result<String, String> {
        match self.changed.get(path) {
            Some(text) => Ok(text.clone()),
            None => std::fs::read_to_string(path).map_err(|error| error.to_string()),
        }
    }

    fn code(&self) -> &dyn CodePolicy {
        if self.with_code { &AnyCode } else { &blocksim_block::NoCode }
    }
}

impl Texts {
    fn with(&self, change: &Change) -> Texts {
        let mut new = self.clone();
        for text in &change.texts {
            assert_eq!(self.read(&text.path).ok(), text.old, "{}", text.path.display());
            new.changed.insert(text.path.clone(), text.new.clone());
        }
        new
    }

    fn edit<T>(&self, model: &Path, shared: bool, what: impl FnOnce(&Project) -> T) -> T {
        let others = |_: &[PathBuf]| BTreeSet::new();
        what(&Project { reader: self, model, others: &others, shared })
    }
}

/// All diagrams below a folder of the project that stand for themselves.
fn models(folder: &str) -> Vec<PathBuf> {
    let (mut folders, mut found) = (vec![root().join(folder)], Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "ron")
                && is_whole(&std::fs::read_to_string(&path).expect("a text"))
            {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Numbers that look random and are the same each time.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n.max(1)
    }
}
