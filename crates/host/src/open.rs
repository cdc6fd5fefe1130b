//! Opens libraries: once for each state of a file, from a copy, for the life of the process.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

use blocksim_abi::{ABI_MAJOR, EntryFn, SYMBOL};
use blocksim_block::LoadError;

use crate::build;
use crate::environment::Environment;
use crate::fault::{self, BUILD, MISSING};
use crate::kind::Kind;
use crate::locate::{Source, Target, is_module, locate};
use crate::offer::Period;
use crate::table::{Contents, contents, in_table, other_major};
use crate::{isolate, wasm, watch};

/// A loaded plug-in.
#[derive(Debug)]
pub struct Library {
    /// The file that was loaded.
    pub path: PathBuf,
    /// Name that the plug-in gives itself.
    pub name: &'static str,
    /// Version that the plug-in gives itself.
    pub version: &'static str,
    /// Its blocks.
    pub blocks: Vec<Kind>,
    /// Sample times that were worked out.
    pub(crate) periods: Mutex<Vec<Period>>,
}

/// What can be loaded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Binary {
    /// Its file.
    pub path: PathBuf,
    /// Whether it is a WebAssembly module, and not a library.
    pub is_module: bool,
}

/// A file at one point of its history: a rebuilt library is another one. And whether it is served by another process.
type Key = (PathBuf, Option<SystemTime>, u64, bool);

/// Libraries whose code has been run in this process, by the names that people know, plug-ins or not.
static LOADED: Mutex<Vec<String>> = Mutex::new(Vec::new());

static OPENED: Mutex<BTreeMap<Key, &'static Library>> = Mutex::new(BTreeMap::new());

/// The plug-in that `library` names, relative to `folder`: a built library, a WebAssembly module, or the folder of a crate or of C or
/// C++ sources, which is built for `target` first. A library that was loaded before and did not change is not loaded again.
///
/// # Errors
/// `plugin_missing`, `plugin_build`, `plugin_symbol`, `plugin_abi` or `left_out`, for the parameter `library`.
pub fn open(folder: &Path, library: &str, target: Target) -> Result<&'static Library, LoadError> {
    let binary = built(folder, library, target)?;
    let unreadable = |e: std::io::Error| {
        fault::library(MISSING, format!("`{}` cannot be read: {e}", fault::shown(&binary.path)))
    };
    let data = std::fs::metadata(&binary.path).map_err(unreadable)?;
    let is_isolated = isolate::is_isolated();
    let key = (binary.path.clone(), data.modified().ok(), data.len(), is_isolated);
    let mut opened = OPENED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = opened.get(&key) {
        return Ok(known);
    }
    let loaded = if is_isolated {
        Box::leak(Box::new(isolate::open(&binary, library, false)?))
    } else {
        watch::start();
        load(&binary, library)?
    };
    opened.insert(key, loaded);
    Ok(loaded)
}

/// What `library` names, built for `target` first if these are sources.
///
/// # Errors
/// `plugin_missing`, `plugin_build` or `left_out`.
pub(crate) fn built(folder: &Path, library: &str, target: Target) -> Result<Binary, LoadError> {
    let native = |path: PathBuf| Binary { path, is_module: false };
    let module = |path: PathBuf| Binary { path, is_module: true };
    match (locate(folder, library)?, target) {
        (Source::Module(path), _) => Ok(module(path)),
        (Source::Library(path), Target::Native) => Ok(native(path)),
        (Source::Crate(folder), Target::Native) => build::of_crate(&folder, library, target).map(native),
        (Source::Crate(folder), Target::Wasm) => {
            // Nobody waits for a module that cannot be run.
            wasm::usable(library)?;
            build::of_crate(&folder, library, target).map(module)
        }
        (Source::C(folder), Target::Native) => build::of_sources(&folder, library).map(native),
        (Source::Library(_), Target::Wasm) => {
            let message = format!("the plug-in `{library}` is a built library and cannot become a module");
            let help = "name the folder of its crate, or a module (`.wasm`), or leave out `target: Wasm`";
            Err(fault::help(fault::library(BUILD, message), help))
        }
        (Source::C(_), Target::Wasm) => {
            let message = format!(
                "the plug-in `{library}` is written in C or C++, which blocksim does not build as a module"
            );
            let help = "leave out `target: Wasm`, or build it with clang as in `blocksim manual plugins` and name the \
                        module: `library: \"law.wasm\"`";
            Err(fault::help(fault::library(BUILD, message), help))
        }
    }
}

/// All plug-ins that this process has loaded, by path.
pub fn opened() -> Vec<&'static Library> {
    OPENED.lock().unwrap_or_else(PoisonError::into_inner).values().copied().collect()
}

/// Libraries that are loaded in this process, valid plug-ins or not, as diagrams name them.
pub(crate) fn loaded() -> Vec<String> {
    LOADED.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Loads a library into this process; `named` is what the diagram calls it.
///
/// # Errors
/// As for [`open`].
pub(crate) fn load(binary: &Binary, named: &str) -> Result<&'static Library, LoadError> {
    let path = &binary.path;
    if binary.is_module || is_module(named) {
        let _calling = watch::calling(watch::tag(named, ""), 0, f64::NAN);
        return Ok(Box::leak(Box::new(wasm::load(path)?)));
    }
    let shown = fault::shown(path);
    let before = Environment::now();
    let calling = watch::calling(watch::tag(named, ""), 0, f64::NAN);
    let contents = read(path, &shown, named);
    drop(calling);
    if let Some(changed) = before.restore() {
        let error =
            fault::library(fault::ABI, format!("`{shown}` broke a rule when it was loaded: {changed}"));
        return Err(fault::help(
            error,
            "build it without `-ffast-math`, and set nothing of the process in initialisers",
        ));
    }
    let contents = contents?;
    let (name, version) = (contents.name, contents.version);
    let periods = Mutex::default();
    Ok(Box::leak(Box::new(Library { path: path.clone(), name, version, blocks: contents.blocks, periods })))
}

/// Opens a library and reads its table.
fn read(path: &Path, shown: &str, named: &str) -> Result<Contents, LoadError> {
    // Unloading is never safe, whatever the library turns out to be: the table, and what it has registered, point into it.
    let opened: &'static _ = Box::leak(Box::new(open_copy(path)?));
    let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
    if !loaded.iter().any(|known| known == named) {
        loaded.push(named.to_owned());
    }
    drop(loaded);
    // SAFETY: the type is that of the contract for this symbol.
    let entry = match unsafe { opened.get::<EntryFn>(SYMBOL) } {
        Ok(entry) => *entry,
        Err(_) => return Err(no_entry(opened, shown)),
    };
    // SAFETY: a function of the contract, of a library that stays loaded.
    unsafe { contents(entry(), shown, &in_table) }
}

/// A library without the symbol of this version: perhaps it has that of another one.
fn no_entry(opened: &libloading::Library, shown: &str) -> LoadError {
    let other = (1..=9).filter(|major| *major != ABI_MAJOR).find(|major| {
        // SAFETY: only looked for, never called.
        unsafe { opened.get::<EntryFn>(format!("blocksim_plugin_v{major}")) }.is_ok()
    });
    if let Some(major) = other {
        return other_major(shown, major);
    }
    let error = fault::library(
        fault::SYMBOL,
        format!("`{shown}` is not a blocksim plug-in: it does not export `{SYMBOL}`"),
    );
    fault::help(
        error,
        "in Rust, write `export_plugin!(\"name\", [Controller]);` and build a `cdylib`; in C, define `blocksim_plugin_v1`",
    )
}

/// Opens a copy under a name that was never used, and removes it where the system allows.
fn open_copy(path: &Path) -> Result<libloading::Library, LoadError> {
    let cannot = |what: &str, e: &dyn std::fmt::Display| {
        fault::library(MISSING, format!("`{}` cannot be {what}: {e}", fault::shown(path)))
    };
    let folder = fresh_folder().map_err(|e| cannot("copied to the temporary folder", &e))?;
    let copy = folder.join(path.file_name().unwrap_or("plugin".as_ref()));
    let opened = match std::fs::copy(path, &copy) {
        Ok(_) => open_now(&copy).map_err(|reason| {
            // The user knows the library, not its copy.
            let reason = reason.replace(&format!("{}: ", copy.display()), "");
            fault::library(
                fault::SYMBOL,
                format!("`{}` is not a library that can be loaded: {reason}", fault::shown(path)),
            )
        }),
        Err(e) => Err(cannot("copied to the temporary folder", &e)),
    };
    // Where a loaded library cannot be removed it stays for the system to clean up.
    let _ = std::fs::remove_dir_all(&folder);
    opened
}

/// A folder that nobody else can have prepared.
fn fresh_folder() -> std::io::Result<PathBuf> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    loop {
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("blocksim-{}-{count}", std::process::id()));
        let mut builder = std::fs::DirBuilder::new();
        #[cfg(unix)]
        std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
        match builder.create(&folder) {
            Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => {}
            result => return result.map(|()| folder),
        }
    }
}

/// Opens a library and finds all that it needs at once, so that nothing can be missing in the middle of a run.
fn open_now(path: &Path) -> Result<libloading::Library, String> {
    #[cfg(unix)]
    // SAFETY: a plug-in is code that the user chose to run, its initialisers included.
    let opened = unsafe {
        use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};
        Library::open(Some(path), RTLD_NOW | RTLD_LOCAL).map(libloading::Library::from)
    };
    #[cfg(not(unix))]
    // SAFETY: as above.
    let opened = unsafe { libloading::Library::new(path) };
    opened.map_err(|e| match std::error::Error::source(&e) {
        Some(source) => source.to_string(),
        None => e.to_string(),
    })
}
