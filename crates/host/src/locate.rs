//! What the parameter `library` names: a built library, a WebAssembly module, or a folder with the sources of a library.

use std::path::{Path, PathBuf};

use blocksim_block::LoadError;
use blocksim_signal::closest;
use serde::Deserialize;

use crate::build::{SETTINGS, is_source};
use crate::fault::{self, MISSING};

/// What the sources of a plug-in are built for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Deserialize)]
pub enum Target {
    /// A library for this computer.
    #[default]
    Native,
    /// A WebAssembly module.
    Wasm,
}

/// Where a plug-in comes from; both paths are absolute.
#[derive(Debug, PartialEq)]
pub enum Source {
    /// A built library.
    Library(PathBuf),
    /// A WebAssembly module.
    Module(PathBuf),
    /// The folder of a crate.
    Crate(PathBuf),
    /// A folder with sources in C or C++.
    C(PathBuf),
}

impl Source {
    /// The library or the folder, without links.
    pub fn path(&self) -> &Path {
        match self {
            Source::Library(path) | Source::Module(path) | Source::Crate(path) | Source::C(path) => path,
        }
    }
}

/// Whether a library is a WebAssembly module: its name ends so. The name alone decides, wherever a link of this name leads, since a
/// module is loaded without trust and must never turn out to be something else.
pub fn is_module(library: &str) -> bool {
    library.ends_with(".wasm")
}

/// Finds `library`, relative to the folder of the diagram.
///
/// # Errors
/// Nothing is there, or a folder without sources.
pub fn locate(folder: &Path, library: &str) -> Result<Source, LoadError> {
    let path = folder.join(library);
    let Ok(found) = path.canonicalize() else {
        return Err(absent(&path, library));
    };
    // Loading a pipe or a device might never end.
    let is_file = found.is_file();
    if !is_file && (is_module(library) || !found.is_dir()) {
        let error = fault::library(MISSING, format!("the plug-in `{library}` is not a regular file"));
        return Err(fault::help(error, "name a built library, a module, or a folder with sources"));
    }
    if is_file {
        return Ok(if is_module(library) { Source::Module(found) } else { Source::Library(found) });
    }
    if found.join("Cargo.toml").is_file() {
        return Ok(Source::Crate(found));
    }
    if found.join(SETTINGS).is_file() || has_sources(&found) {
        return Ok(Source::C(found));
    }
    let message = format!("the folder `{library}` holds no `Cargo.toml`, `{SETTINGS}`, C or C++ sources");
    let error = fault::library(MISSING, message);
    Err(fault::help(error, "name a built library, or a folder with the sources of one"))
}

fn has_sources(folder: &Path) -> bool {
    let mut entries = folder.read_dir().into_iter().flatten().flatten();
    entries.any(|entry| is_source(&entry.path()))
}

fn absent(path: &Path, library: &str) -> LoadError {
    let error = fault::library(MISSING, format!("there is no plug-in `{library}`"));
    let sought = format!("looked for `{}`", fault::shown(path));
    let (Some(parent), Some(name)) = (path.parent(), path.file_name()) else {
        return fault::help(error, sought);
    };
    let mut beside: Vec<String> = std::fs::read_dir(parent)
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    beside.sort();
    match closest(&name.to_string_lossy(), beside.iter().map(String::as_str)) {
        Some(near) => fault::help(error, format!("{sought}; did you mean `{near}` there?")),
        None => fault::help(error, sought),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_folder_of_a_crate_and_a_file_are_told_apart() {
        let here = Path::new(env!("CARGO_MANIFEST_DIR")).canonicalize().unwrap();
        assert_eq!(locate(&here, "../host").unwrap(), Source::Crate(here.clone()));
        assert_eq!(locate(&here, "Cargo.toml").unwrap(), Source::Library(here.join("Cargo.toml")));
        assert_eq!(locate(&here, "tests/c").unwrap(), Source::C(here.join("tests/c")));
    }

    #[test]
    fn a_module_is_known_by_its_name_alone() {
        let folder = std::env::temp_dir().join(format!("blocksim-locate-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("crate.wasm")).unwrap();
        std::fs::write(folder.join("crate.wasm/Cargo.toml"), "").unwrap();
        std::fs::write(folder.join("law.wasm"), "").unwrap();
        let here = folder.canonicalize().unwrap();
        assert_eq!(locate(&folder, "law.wasm").unwrap(), Source::Module(here.join("law.wasm")));
        assert_eq!(
            locate(&folder, "crate.wasm").unwrap_err().message,
            "the plug-in `crate.wasm` is not a regular file"
        );
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(here.join("law.wasm"), folder.join("a.so")).unwrap();
            assert_eq!(locate(&folder, "a.so").unwrap(), Source::Library(here.join("law.wasm")));
        }
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_device_is_never_loaded() {
        let error = locate(Path::new("/dev"), "zero").unwrap_err();
        assert_eq!(
            (error.code, error.message.as_str()),
            (MISSING, "the plug-in `zero` is not a regular file")
        );
    }

    #[test]
    fn a_folder_without_a_crate_is_refused() {
        let error = locate(Path::new(env!("CARGO_MANIFEST_DIR")), "src").unwrap_err();
        let message = "the folder `src` holds no `Cargo.toml`, `plugin.toml`, C or C++ sources";
        assert_eq!((error.code, error.message.as_str()), (MISSING, message));
    }

    #[test]
    fn a_slip_of_the_pen_is_told() {
        let error = locate(Path::new(env!("CARGO_MANIFEST_DIR")), "src/lacote.rs").unwrap_err();
        assert_eq!(error.message, "there is no plug-in `src/lacote.rs`");
        assert!(error.help.unwrap().ends_with("did you mean `locate.rs` there?"));
    }
}
