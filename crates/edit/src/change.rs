//! What becomes of the texts of a model.

use std::collections::BTreeMap;
use std::path::PathBuf;

use blocksim_syntax::format;

/// A text that changes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextChange {
    /// Its file.
    pub path: PathBuf,
    /// The text as it is; `None` where the file is new.
    pub old: Option<String>,
    /// The text with the change.
    pub new: String,
}

/// A change of a model that nothing is against. No file has been written.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Change {
    /// The texts that change; none where everything is as it should be.
    pub texts: Vec<TextChange>,
    /// What is done, in a sentence without period.
    pub summary: String,
    /// What to know of it, in sentences without periods: ports that are not connected any more.
    pub notes: Vec<String>,
    /// The path of the block to look at then.
    pub block: Option<String>,
}

/// Texts that are being changed.
#[derive(Debug, Clone, Default)]
pub(crate) struct Draft {
    texts: BTreeMap<PathBuf, (Option<String>, String)>,
}

impl Draft {
    /// Another text for a file. One that is laid out as `blocksim fmt` does it stays so.
    pub(crate) fn put(&mut self, path: PathBuf, old: &str, new: String) {
        let is_laid_out = format(old).is_ok_and(|formatted| formatted == old);
        let new = if is_laid_out { format(&new).unwrap_or(new) } else { new };
        if new != old {
            self.texts.insert(path, (Some(old.to_owned()), new));
        }
    }

    /// A new file.
    pub(crate) fn create(&mut self, path: PathBuf, new: String) {
        let new = format(&new).unwrap_or(new);
        self.texts.insert(path, (None, new));
    }

    /// The new texts.
    pub(crate) fn texts(&self) -> BTreeMap<PathBuf, String> {
        self.texts.iter().map(|(path, (_, new))| (path.clone(), new.clone())).collect()
    }

    pub(crate) fn finish(self, summary: impl Into<String>) -> Change {
        let text = |(path, (old, new))| TextChange { path, old, new };
        Change {
            texts: self.texts.into_iter().map(text).collect(),
            summary: summary.into(),
            ..Change::default()
        }
    }
}
