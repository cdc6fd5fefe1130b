//! The model of a run: from what was kept with the run, else from the files as they are now.

use std::path::Path;

use blocksim_diagram::{Model, Sources};
use blocksim_recording::Manifest;
use blocksim_report::Report;

use super::{diagram, tables};
use crate::mechanism::text;
pub use crate::mechanism::text::Text;

/// The text of the model of a run. What cannot be had is told as a note or a warning of the page.
pub fn text(folder: &Path, manifest: &Manifest, report: &mut Report) -> Option<Text> {
    match text::text(folder, manifest) {
        Ok(text) => {
            if text.as_ref().is_some_and(|text| !text.is_kept) {
                report.diagram.note =
                    "Drawn from the files as they are now: this run kept no copy of its model.".to_owned();
            }
            text
        }
        Err(reason) => {
            report.warnings.push(format!("The diagram is missing: {reason}."));
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
    diagram::add(model, sources, &text.overrides, None, report);
    // What the diagram calls itself says more than the name of its file.
    let top = report.diagram.levels.iter().find(|level| level.path.is_empty() && !level.title.is_empty());
    if let Some(title) = top.map(|level| level.title.clone()) {
        report.title = title;
    }
}
