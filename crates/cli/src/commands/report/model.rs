//! The model of a run: from what was kept with the run, else from the files as they are now.

use std::fs;
use std::path::{Path, PathBuf};

use blocksim_diagram::{Model, Reader, Sources};
use blocksim_report::Report;
use blocksim_results::Manifest;

use super::{drawn, tables};
use crate::disk::Disk;
use crate::running::model_text::{Kept, MODEL};

/// The text of a model and what was set.
pub struct Text {
    /// Where the files come from.
    pub reader: Box<dyn Reader>,
    /// The diagram itself.
    pub root: PathBuf,
    /// `target=value` as of `--set`.
    pub overrides: Vec<String>,
}

/// The text of the model of a run. What cannot be had is told as a note or a warning of the page.
pub fn text(folder: &Path, manifest: &Manifest, report: &mut Report) -> Option<Text> {
    let overrides = manifest.overrides.iter().map(|set| format!("{}={}", set.path, set.value)).collect();
    match kept(folder) {
        Ok(Some(kept)) => Some(Text { root: kept.root.clone(), reader: Box::new(kept), overrides }),
        Ok(None) => {
            let root = PathBuf::from(&manifest.model.path);
            if !root.is_file() {
                return None;
            }
            report.diagram.note =
                "Drawn from the files as they are now: this run kept no copy of its model.".to_owned();
            Some(Text { root, reader: Box::new(Disk::default()), overrides })
        }
        Err(reason) => {
            report.warnings.push(format!("The diagram is missing: {MODEL} cannot be read: {reason}."));
            None
        }
    }
}

/// The model.
pub fn read(text: &Text, sources: &Sources, report: &mut Report) -> Option<Model> {
    let (model, _) = blocksim_diagram::model(sources, &text.root, &text.overrides);
    if model.is_none() {
        report.warnings.push("The diagram is missing: the model cannot be read any more.".to_owned());
    }
    model
}

/// Adds the block diagram and the tables of parameters; the pictures must be there.
pub fn add(model: &Model, text: &Text, sources: &Sources, report: &mut Report) {
    report.tables.splice(0..0, tables::of(model, sources, &text.overrides));
    drawn::add(model, sources, &text.overrides, report);
    // What the diagram calls itself says more than the name of its file.
    let top = report.diagram.levels.iter().find(|level| level.path.is_empty() && !level.title.is_empty());
    if let Some(title) = top.map(|level| level.title.clone()) {
        report.title = title;
    }
}

fn kept(folder: &Path) -> Result<Option<Kept>, String> {
    let file = folder.join(MODEL);
    if !file.is_file() {
        return Ok(None);
    }
    let text = fs::read_to_string(&file).map_err(|error| error.to_string())?;
    Kept::read(&text).map(Some)
}
