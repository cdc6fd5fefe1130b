//! Files on the disk: those of a model, read; results, written whole.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use blocksim_block::{CodePolicy, NoCode};
use blocksim_diagram::Reader;
use blocksim_recording::{MOST_TEXT, ResultsError, limited_text, write_whole};
use blocksim_signal::closest;

use crate::exit::Exit;
use crate::failure::Failure;
use crate::trust::Plugins;

/// Reads files and remembers which. Plug-ins that they name are not loaded, unless somebody decides otherwise.
#[derive(Debug, Default)]
pub struct Disk {
    read: RefCell<Vec<PathBuf>>,
    plugins: Option<Plugins>,
}

impl Disk {
    /// Files of a model whose plug-ins may be loaded as `plugins` decides.
    pub fn with(plugins: Plugins) -> Disk {
        Disk { read: RefCell::default(), plugins: Some(plugins) }
    }

    /// What the plug-ins offer that were loaded.
    pub fn offers(&self) -> BTreeMap<String, String> {
        self.plugins.as_ref().map(Plugins::offers).unwrap_or_default()
    }

    /// Files that were read.
    pub fn files(&self) -> Vec<PathBuf> {
        self.read.borrow().clone()
    }

    /// Whether this file was read.
    pub fn has_read(&self, path: &Path) -> bool {
        self.read.borrow().iter().any(|known| known == path)
    }
}

impl Reader for Disk {
    fn read(&self, path: &Path) -> Result<String, String> {
        let text = text(path).map_err(|error| reason(&error))?;
        self.read.borrow_mut().push(path.to_owned());
        Ok(text)
    }

    fn code(&self) -> &dyn CodePolicy {
        self.plugins.as_ref().map_or(&NoCode, |plugins| plugins as &dyn CodePolicy)
    }
}

/// The disk, with other texts for some of its files.
#[derive(Debug, Default)]
pub struct Overlaid {
    /// What lies below.
    pub disk: Disk,
    /// Texts by the paths under which the model names the files.
    pub texts: BTreeMap<PathBuf, String>,
}

impl Reader for Overlaid {
    fn read(&self, path: &Path) -> Result<String, String> {
        match self.texts.get(path) {
            Some(text) => Ok(text.clone()),
            None => self.disk.read(path),
        }
    }

    fn code(&self) -> &dyn CodePolicy {
        self.disk.code()
    }
}

fn text(path: &Path) -> io::Result<String> {
    limited_text(path, MOST_TEXT)
}

/// Whether a model can be read.
///
/// # Errors
/// Why it cannot, and what helps.
pub fn readable(model: &Path) -> Result<(), Failure> {
    let Err(error) = text(model) else { return Ok(()) };
    let said = format!("cannot read `{}`: {}", model.display(), reason(&error));
    let help = match error.kind() {
        io::ErrorKind::NotFound => {
            likely(model).map(|likely| format!("did you mean `{}`?", likely.display()))
        }
        io::ErrorKind::IsADirectory => {
            models(model).first().map(|file| format!("name a file in it, such as `{}`", file.display()))
        }
        _ => None,
    };
    Err(Failure::unreadable(said).perhaps_help(help))
}

/// The `.ron` files of a folder and of those below it, by name. Hidden folders, results of runs and what `cargo` builds
/// are left out.
///
/// # Errors
/// What the system says.
pub fn text_files(folder: &Path) -> io::Result<Vec<PathBuf>> {
    files_of(folder, &["ron"])
}

/// The same for files with any of these endings.
///
/// # Errors
/// What the system says.
pub fn files_of(folder: &Path, endings: &[&str]) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder)? {
            let entry = entry?;
            let (path, kind) = (entry.path(), entry.file_type()?);
            let name = entry.file_name();
            let is_ours = ["runs", "target"].iter().all(|other| name != *other)
                && !name.to_string_lossy().starts_with('.');
            // Links to folders might lead in a circle.
            if kind.is_dir() && is_ours {
                folders.push(path);
            } else if !kind.is_dir()
                && path.extension().is_some_and(|ending| endings.iter().any(|known| ending == *known))
                && path.is_file()
            {
                files.push(path);
            }
        }
    }
    files.sort();
    Ok(files)
}

/// Why a file cannot be read, in words.
pub fn reason(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "the file does not exist".to_owned(),
        io::ErrorKind::IsADirectory => "it is a folder".to_owned(),
        io::ErrorKind::PermissionDenied => "you may not read it".to_owned(),
        io::ErrorKind::InvalidData => "it is not text in UTF-8".to_owned(),
        _ => error.to_string(),
    }
}

/// The model beside `model` that is spelt most like it.
fn likely(model: &Path) -> Option<PathBuf> {
    let folder = model.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let with_ending = model.with_extension("ron");
    if with_ending.is_file() {
        return Some(with_ending);
    }
    let files = models(folder);
    let names: Vec<&str> = files.iter().filter_map(|file| file.file_name()?.to_str()).collect();
    let meant = closest(model.file_name()?.to_str()?, names)?;
    Some(if folder == Path::new(".") { PathBuf::from(meant) } else { folder.join(meant) })
}

/// Models of a folder by name; the one named as the folder first.
pub fn models(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut files: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|ending| ending == "ron"))
        .collect();
    files.sort_by_key(|file| (file.file_stem() != folder.file_name(), file.clone()));
    files
}

/// Whether a file may be written there: only `replace` takes the place of one that is there.
///
/// # Errors
/// That there is one.
pub fn free(path: &Path, replace: bool) -> Result<(), Failure> {
    if path.symlink_metadata().is_ok() && !replace {
        let said = format!("`{}` already exists", path.display());
        return Err(
            Failure::new(Exit::Files, "exists", said).help("name another file, or add --yes to replace it")
        );
    }
    Ok(())
}

/// Writes a file whole or not at all; one that is there only if `replace`.
///
/// # Errors
/// Why it cannot be written.
pub fn write_file(path: &Path, bytes: &[u8], replace: bool) -> Result<(), Failure> {
    free(path, replace)?;
    // A link goes on pointing to the file that it names.
    let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let folder = target
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .map_or(PathBuf::from("."), Path::to_path_buf);
    let Some(name) = target.file_name().map(|name| name.to_string_lossy().into_owned()) else {
        return Err(
            Failure::unwritable(format!("`{}` names no file", path.display())).help("add the name of a file")
        );
    };
    write_whole(&folder, &name, |out| out.write_all(bytes))
        .map(|_| ())
        .map_err(|error| unwritable(path, &error))
}

/// Why a file cannot be written.
pub fn unwritable(path: &Path, error: &ResultsError) -> Failure {
    let (reason, help) = match error {
        ResultsError::Io { source, .. } => match source.kind() {
            io::ErrorKind::NotFound => {
                ("the folder does not exist".to_owned(), "create it, or name a file elsewhere")
            }
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                (error.reason(), "free some space, write less, or name a file elsewhere")
            }
            io::ErrorKind::FileTooLarge => {
                (error.reason(), "raise the limit of the system (`ulimit -f`), or write less")
            }
            _ => (error.reason(), "name a file elsewhere"),
        },
        _ => (error.reason(), error.remedy()),
    };
    Failure::unwritable(format!("cannot write `{}`: {reason}", path.display())).help(help)
}
