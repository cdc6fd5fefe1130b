//! Where the program keeps its own files: settings and memories of the person who uses it.

use std::env;
use std::ffi::OsString;
use std::path::PathBuf;

/// Names a folder that holds both, in the place of those of the system: for tests, and for machines without a home.
pub const HOME: &str = "BLOCKSIM_HOME";

/// The folder of settings; `None` on a system without a place for them.
pub fn config() -> Option<PathBuf> {
    chosen().or_else(|| system("XDG_CONFIG_HOME", "APPDATA", ".config"))
}

/// The folder of what can be worked out again.
pub fn cache() -> Option<PathBuf> {
    chosen().or_else(|| system("XDG_CACHE_HOME", "LOCALAPPDATA", ".cache"))
}

fn chosen() -> Option<PathBuf> {
    let folder = env::var_os(HOME).filter(|folder| !folder.is_empty())?;
    std::path::absolute(folder).ok()
}

/// By the XDG Base Directory Specification, <https://specifications.freedesktop.org/basedir-spec/>, which leaves paths that are not
/// absolute unused; on Windows where programs keep their data.
fn system(xdg: &str, windows: &str, below_home: &str) -> Option<PathBuf> {
    let absolute = |path: Option<OsString>| path.map(PathBuf::from).filter(|path| path.is_absolute());
    let named = absolute(env::var_os(if cfg!(windows) { windows } else { xdg }));
    let base = named.or_else(|| Some(absolute(env::home_dir().map(Into::into))?.join(below_home)));
    base.map(|base| base.join("blocksim"))
}
