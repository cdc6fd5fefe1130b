//! Sets, models and workbooks on the disk.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_diagram::{Origin, Reader, SourceFile, Sources, Spelling, Target, targets};
#[cfg(feature = "xlsx")]
use blocksim_params::{Arrangement, open_workbook};
use blocksim_params::{Change, Content, Quantity, SetError, Tables, edited, quantities, quantities_at};
use blocksim_recording::limited_bytes;
use blocksim_signal::Value;

use crate::disk::{Disk, readable, reason};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::terminal::render::errors;
use crate::trust::is_about_trust;

/// Largest workbook that is read, in bytes.
const LARGEST: u64 = 32 << 20;

/// A set or a model that was read.
pub struct Set {
    /// The texts that hold its quantities; that of the set or of the model itself is the first.
    pub files: Vec<SourceFile>,
    pub quantities: Vec<Quantity>,
    /// Whether it is a model.
    pub is_model: bool,
}

impl Set {
    /// The texts alone.
    pub fn texts(&self) -> Vec<&str> {
        self.files.iter().map(|file| &*file.text).collect()
    }

    /// The files that changed numbers make different, with their new texts.
    ///
    /// # Errors
    /// One of the numbers is missing.
    pub fn edited(&self, changes: &[Change]) -> Result<Vec<(PathBuf, String)>, Failure> {
        let texts = edited(&self.texts(), &self.quantities, changes);
        let texts = texts.map_err(|error| set_error(&error, &self.files[0].path, &self.files[0].text))?;
        let files = self.files.iter().zip(texts).filter(|(file, text)| *file.text != **text);
        Ok(files.map(|(file, text)| (file.path.clone(), text)).collect())
    }

    /// The model that new numbers are checked with: the one that is given, else itself if it is one.
    pub fn model<'a>(&'a self, given: Option<&'a Path>) -> Option<&'a Path> {
        given.or_else(|| self.is_model.then_some(self.files[0].path.as_path()))
    }

    /// Its own text among changed ones, if no other file changes.
    ///
    /// # Errors
    /// Which other file does.
    pub fn alone(&self, changed: &[(PathBuf, String)]) -> Result<String, Failure> {
        let own = &self.files[0];
        match changed {
            [] => Ok(own.text.to_string()),
            [(path, text)] if *path == own.path => Ok(text.clone()),
            _ => {
                let other =
                    changed.iter().find(|(path, _)| *path != own.path).map(|(path, _)| path.display());
                let said = format!(
                    "numbers change in `{}` too",
                    other.map_or(String::new(), |path| path.to_string())
                );
                Err(Failure::usage(said)
                    .help("add --yes to change the files themselves; --out keeps only one file")
                    .last("nothing was written"))
            }
        }
    }

    /// Which sheets its workbook has: those of the file `NAME.sheets.ron` beside it, else one for each group of a set; of
    /// a model one for its top level, one for each subsystem and one for each set that it reads.
    ///
    /// # Errors
    /// Why the file of the sheets cannot be used.
    #[cfg(feature = "xlsx")]
    pub fn arrangement(&self) -> Result<Arrangement, Failure> {
        let path = self.files[0].path.with_extension("sheets.ron");
        if path.exists() {
            let text = text(&path)?;
            return Arrangement::read(&text, &self.quantities)
                .map_err(|error| set_error(&error, &path, &text));
        }
        if !self.is_model {
            return Ok(Arrangement::by_group(&self.quantities));
        }
        Ok(Arrangement::by_name(&self.quantities, |quantity| {
            let level = quantity.path.split('.').next().unwrap_or_default();
            match level.rsplit_once('/') {
                // Parameters of a subsystem stand with its blocks.
                Some((subsystem, _)) => subsystem.to_owned(),
                None if quantity.text > 0 => level.to_owned(),
                None => "Model".to_owned(),
            }
        }))
    }
}

fn text(path: &Path) -> Result<String, Failure> {
    readable(path)?;
    let read = Disk::default().read(path);
    read.map_err(|reason| Failure::unreadable(format!("cannot read `{}`: {reason}", path.display())))
}

/// Reads a set or a model.
///
/// # Errors
/// Why it cannot be read.
pub fn read_set(path: &Path) -> Result<Set, Failure> {
    let text = text(path)?;
    if blocksim_syntax::read(&text).is_ok_and(|root| root.word() == Some("Diagram")) {
        return read_model(path);
    }
    match quantities(&text) {
        Ok(quantities) => {
            let file = SourceFile { path: path.to_owned(), text: text.into() };
            Ok(Set { files: vec![file], quantities, is_model: false })
        }
        Err(error) => Err(set_error(&error, path, &text)),
    }
}

/// Reads the numbers that are written in a model: each once, under the name of the first part that is made of the text.
fn read_model(path: &Path) -> Result<Set, Failure> {
    let disk = Disk::default();
    let sources = Sources::new(&disk);
    let (all, mut problems) = targets(&sources, path);
    // No plug-in is needed to read values.
    problems.retain(|problem| !is_about_trust(problem));
    let files = sources.all();
    if errors(&problems) > 0 {
        return Err(Failure::of(Exit::Model, problems, files));
    }
    let (mut seen, mut found) = (BTreeSet::new(), Vec::new());
    for target in &all {
        let Some((place, file)) = numbers_at(target, &files) else { continue };
        let number = place.file.0 as usize;
        for mut quantity in quantities_at(&target.name, &file.text, number, &place.span) {
            let is_number = match &mut quantity.content {
                Content::Number { unit, .. } => {
                    if unit.is_empty() {
                        unit.clone_from(&target.unit);
                    }
                    true
                }
                Content::Expression(_) => matches!(target.value, Some(Value::Number(_))),
            };
            if is_number && seen.insert((number, quantity.place.start)) {
                if target.sharers > 1 {
                    quantity.provenance[1] = format!("holds for {} parts of the model", target.sharers);
                }
                found.push(quantity);
            }
        }
    }
    Ok(Set { files, quantities: found, is_model: true })
}

/// Where the numbers of a target stand; `None` for words, texts and defaults of blocks.
fn numbers_at<'a>(target: &'a Target, files: &'a [SourceFile]) -> Option<(&'a Place, &'a SourceFile)> {
    let (Origin::Text(place) | Origin::Declared(place)) = &target.origin else { return None };
    let file = files.get(place.file.0 as usize)?;
    (target.spelling == Spelling::Expression).then_some((place, file))
}

/// Where a text is no set.
pub fn set_error(error: &SetError, path: &Path, text: &str) -> Failure {
    let place = Place { file: FileId(0), span: error.place.clone() };
    let mut problem = Problem::error("syntax", error.message.clone()).at(&place, "");
    if let Some(help) = &error.help {
        problem = problem.help(help.clone());
    }
    Failure::of(Exit::Model, vec![problem], vec![SourceFile { path: path.to_owned(), text: text.into() }])
}

/// Reads a workbook; what is wrong in its cells is data.
///
/// # Errors
/// Why the file cannot be read.
pub fn read_workbook(path: &Path) -> Result<Tables, Failure> {
    let refuse = |said: &str| Failure::unreadable(format!("cannot read `{}`: {said}", path.display()));
    let bytes = limited_bytes(path, LARGEST).map_err(|error| refuse(&reason(&error)))?;
    open_workbook(&bytes).map_err(|error| refuse(&error.message).help(error.help))
}

#[cfg(not(feature = "xlsx"))]
fn open_workbook(_bytes: &[u8]) -> Result<Tables, blocksim_params::BookError> {
    use crate::left_out::{help, reason};
    Err(blocksim_params::BookError { message: reason("workbooks"), help: help("xlsx") })
}

/// Whether a file is a workbook, by its name; anything else is a set.
pub fn is_workbook(path: &Path) -> bool {
    let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
    extension.is_some_and(|extension| {
        extension.to_str().is_some_and(|text| text.starts_with("xls") || text == "ods")
    })
}
