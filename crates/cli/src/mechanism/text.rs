//! The text of the model of a run: what was kept with the run, else the files as they are now.

use std::path::{Path, PathBuf};

use blocksim_diagram::Reader;
use blocksim_recording::{MOST_TEXT, Manifest, limited_text};

use crate::disk::Disk;
use crate::running::model_text::{Kept, MODEL};

/// The text of a model and what was set.
pub struct Text {
    /// Where the files come from. It loads no plug-ins, because a run may be somebody else's.
    pub reader: Box<dyn Reader>,
    /// The diagram itself.
    pub root: PathBuf,
    /// `target=value` as of `--set`.
    pub overrides: Vec<String>,
    /// Whether this is what was run, not the files as they are now.
    pub is_kept: bool,
}

/// The text of the model of a run; `None` where there is none any more.
///
/// # Errors
/// Why what was kept cannot be read, in words.
pub fn text(folder: &Path, manifest: &Manifest) -> Result<Option<Text>, String> {
    let overrides = manifest.overrides.iter().map(|set| format!("{}={}", set.path, set.value)).collect();
    let kept = kept(folder).map_err(|reason| format!("{MODEL} cannot be read: {reason}"))?;
    if let Some(kept) = kept {
        return Ok(Some(Text { root: kept.root.clone(), reader: Box::new(kept), overrides, is_kept: true }));
    }
    let root = PathBuf::from(&manifest.model.path);
    let is_there = root.is_file();
    Ok(is_there.then(|| Text { root, reader: Box::new(Disk::default()), overrides, is_kept: false }))
}

fn kept(folder: &Path) -> Result<Option<Kept>, String> {
    let file = folder.join(MODEL);
    if !file.is_file() {
        return Ok(None);
    }
    let text = limited_text(&file, MOST_TEXT).map_err(|error| error.to_string())?;
    Kept::read(&text).map(Some)
}
