//! What the library of a crate depends on: the sources that cargo lists beside it (`libname.d`), with the manifests and
//! settings of the folders around them.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::fresh::rule_files;
use super::text::text;

/// Files that may stand in any folder around a crate and change what cargo makes of it.
const AROUND: [&str; 6] = [
    "Cargo.toml",
    "Cargo.lock",
    ".cargo/config.toml",
    ".cargo/config",
    "rust-toolchain.toml",
    "rust-toolchain",
];
/// Beginnings of the variables of the environment that do so.
const VARIABLES: [&str; 4] = ["RUST", "CARGO_BUILD_", "CARGO_PROFILE_", "CARGO_TARGET_"];

/// All files that the library of the crate in `folder` was built from, or would be if they were there.
pub fn read(folder: &Path, library: &Path) -> Option<BTreeSet<PathBuf>> {
    let listed = text(&library.with_extension("d")).ok()?;
    let sources = sources(&listed)?;
    let mut files: BTreeSet<PathBuf> = around(folder).collect();
    for source in &sources {
        files.extend(source.parent().into_iter().flat_map(around));
    }
    let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    files.extend(home.into_iter().flat_map(|home| ["config.toml", "config"].map(|name| home.join(name))));
    files.extend(sources);
    Some(files)
}

/// What may stand in a folder and those around it.
fn around(folder: &Path) -> impl Iterator<Item = PathBuf> {
    folder.ancestors().flat_map(|folder| AROUND.map(|name| folder.join(name)))
}

/// The files of a rule, all of them absolute.
fn sources(rule: &str) -> Option<Vec<PathBuf>> {
    rule_files(rule).filter(|files| files.iter().all(|file| file.is_absolute()))
}

/// What the environment says to cargo and the compiler, in one line.
pub fn variables(all: impl Iterator<Item = (OsString, OsString)>) -> String {
    let named =
        all.filter(|(name, _)| VARIABLES.iter().any(|start| name.to_string_lossy().starts_with(start)));
    let sorted: BTreeSet<String> = named.map(|(name, value)| format!("{name:?}={value:?}")).collect();
    sorted.into_iter().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_and_variables_are_read() {
        assert_eq!(sources("/t/lib.so: /a/lib.rs\n"), Some(vec![PathBuf::from("/a/lib.rs")]));
        assert_eq!(sources("/t/lib.so: lib.rs\n"), None, "relative to nobody knows what");
        let all = [("RUSTFLAGS", "-C x"), ("HOME", "/h"), ("CARGO_TARGET_DIR", "t")];
        let all = all.map(|(name, value)| (OsString::from(name), OsString::from(value)));
        assert_eq!(variables(all.into_iter()), "\"CARGO_TARGET_DIR\"=\"t\" \"RUSTFLAGS\"=\"-C x\"");
    }
}
