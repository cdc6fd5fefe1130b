//! Changes of models, as command line and studio make them: which files there are, and how several are written.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use blocksim_diagram::Reader;
use blocksim_edit::{Project, Refusal, TextChange};
use blocksim_recording::{MOST_TEXT, limited_text};

use crate::disk::{Disk, write_file};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::trust::Plugins;

/// Most files among which other models are looked for, and how deep they may lie.
const MOST_FILES: usize = 5000;
const DEEPEST: usize = 8;

/// Does something with a model. Other models that share its files are looked for below `root`; without one below the present
/// folder, or that of the model where it is elsewhere.
pub fn with_project<T>(
    model: &Path,
    root: Option<&Path>,
    shared: bool,
    what: impl FnOnce(&Project) -> T,
) -> T {
    let disk = Disk::with(Plugins::looking());
    with_reader(&disk, model, root, shared, what)
}

/// The same with a reader of one's own.
pub fn with_reader<T>(
    reader: &dyn Reader,
    model: &Path,
    root: Option<&Path>,
    shared: bool,
    what: impl FnOnce(&Project) -> T,
) -> T {
    let is_below = model.is_relative() && !model.starts_with("..");
    let beside = model.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let root = root.unwrap_or(if is_below { Path::new(".") } else { beside });
    let others = |_: &[PathBuf]| {
        let mut found = BTreeSet::new();
        gather(root, 0, &mut found);
        found
    };
    what(&Project { reader, model, others: &others, shared })
}

/// `.ron` files of a folder and below.
fn gather(folder: &Path, depth: usize, found: &mut BTreeSet<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let (path, name) = (entry.path(), entry.file_name());
        let is_ours = !name.to_string_lossy().starts_with('.')
            && ["target", "runs", "node_modules"].iter().all(|other| name != *other);
        match entry.file_type() {
            Ok(kind) if kind.is_dir() && is_ours && depth < DEEPEST => gather(&path, depth + 1, found),
            Ok(kind)
                if kind.is_file()
                    && found.len() < MOST_FILES
                    && path.extension().is_some_and(|ending| ending == "ron") =>
            {
                found.insert(path);
            }
            _ => {}
        }
    }
}

/// What is against a change.
pub fn failure(refusal: Refusal) -> Failure {
    Failure::usage(refusal.message).perhaps_help(refusal.help)
}

/// Writes texts, all of them or none, in the place of those that they were made from.
///
/// # Errors
/// A file has been changed since, is there although it should be new, or cannot be written.
pub fn write(texts: &[TextChange]) -> Result<(), Failure> {
    for text in texts {
        let name = text.path.display();
        let is_same = match &text.old {
            Some(old) => limited_text(&text.path, MOST_TEXT).ok().as_deref() == Some(old),
            None => text.path.symlink_metadata().is_err(),
        };
        if !is_same {
            let what = if text.old.is_some() { "has been changed meanwhile" } else { "is there already" };
            return Err(Failure::new(Exit::Files, "exists", format!("`{name}` {what}"))
                .help("look at it as it is now, then try again"));
        }
    }
    for (n, text) in texts.iter().enumerate() {
        if let Err(failure) = write_file(&text.path, text.new.as_bytes(), text.old.is_some()) {
            // What is half done would be another model.
            texts[..n].iter().for_each(|text| drop(take_back(text)));
            return Err(failure);
        }
    }
    Ok(())
}

/// Puts a text back as it was; a file that was new goes.
///
/// # Errors
/// It cannot be written.
pub fn take_back(text: &TextChange) -> Result<(), Failure> {
    match &text.old {
        Some(old) => write_file(&text.path, old.as_bytes(), true),
        None => fs::remove_file(&text.path).map_err(|error| {
            Failure::unwritable(format!("cannot remove `{}`: {error}", text.path.display()))
        }),
    }
}
