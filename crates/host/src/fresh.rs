//! Whether a plug-in is as cargo built it: a stamp beside its library lists every file that the build depends on.
//!
//! Asking cargo takes a good part of the time in which a model is checked. The list comes from the dependencies that
//! cargo writes beside the library (`libname.d`, sources of crates on this disk), with the manifests and settings of the
//! folders around them. A file is the same if size and times are; the time of its last change of state is one that
//! no archive brings along, so a stamp from elsewhere is worth nothing. If anything is in doubt, cargo is asked.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// First line of a stamp; another version has another one.
const HEAD: &str = "blocksim plug-in 1";
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
/// Nanoseconds before the build in which a file may change once more without another time: the grain of clocks.
const GRAIN: i128 = 20_000_000;

/// Whether a library and all that it was built from are as they were.
pub fn is_fresh(library: &Path) -> bool {
    let Ok(stamp) = fs::read_to_string(place(library)) else { return false };
    let mut lines = stamp.lines();
    lines.next() == Some(HEAD)
        && lines.next() == Some(variables(std::env::vars_os()).as_str())
        && lines.next() == Some(state(library).as_str())
        && lines.all(|line| line.split_once(' ').is_some_and(|(_, path)| state(Path::new(path)) == line))
}

/// Writes the stamp of a library that cargo, asked at a time, has called up to date. What changed since then may have
/// come too late for cargo: there is no stamp then, and cargo is asked again.
pub fn remember(folder: &Path, library: &Path, asked: SystemTime) {
    if let Some(stamp) = stamp(folder, library, asked) {
        let _ = fs::write(place(library), stamp);
    }
}

fn place(library: &Path) -> PathBuf {
    library.with_extension("blocksim")
}

fn stamp(folder: &Path, library: &Path, asked: SystemTime) -> Option<String> {
    let listed = fs::read_to_string(library.with_extension("d")).ok()?;
    let sources = dependencies(&listed)?;
    let mut files: BTreeSet<PathBuf> = around(folder).collect();
    for source in &sources {
        files.extend(source.parent().into_iter().flat_map(around));
    }
    let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    files.extend(home.into_iter().flat_map(|home| ["config.toml", "config"].map(|name| home.join(name))));
    files.extend(sources);
    let last = nanoseconds(asked)? - GRAIN;
    let is_settled = |path: &PathBuf| match fs::metadata(path) {
        Ok(about) => times(&about).is_some_and(|times| times.iter().all(|time| *time < last)),
        Err(_) => true,
    };
    // A path with a line break is no line.
    let can_be_listed = |path: &PathBuf| path.to_str().is_some_and(|path| !path.contains('\n'));
    if !files.iter().all(|path| is_settled(path) && can_be_listed(path)) {
        return None;
    }
    let states: String = files.iter().map(|path| format!("{}\n", state(path))).collect();
    Some(format!("{HEAD}\n{}\n{}\n{states}", variables(std::env::vars_os()), state(library)))
}

/// What may stand in a folder and those around it.
fn around(folder: &Path) -> impl Iterator<Item = PathBuf> {
    folder.ancestors().flat_map(|folder| AROUND.map(|name| folder.join(name)))
}

/// The files behind the colon of a rule `target: file file`, in which a backslash stands before a space.
fn dependencies(rule: &str) -> Option<Vec<PathBuf>> {
    let (_, files) = rule.lines().next()?.split_once(": ")?;
    let marked = files.replace("\\ ", "\0");
    let files: Vec<PathBuf> =
        marked.split_whitespace().map(|file| PathBuf::from(file.replace('\0', " "))).collect();
    (!files.is_empty() && files.iter().all(|file| file.is_absolute())).then_some(files)
}

/// `size,written,changed path`, or `- path` if there is no such file.
fn state(path: &Path) -> String {
    let about = fs::metadata(path).ok().and_then(|about| {
        let [written, changed] = times(&about)?;
        Some(format!("{},{written},{changed}", about.len()))
    });
    format!("{} {}", about.as_deref().unwrap_or("-"), path.display())
}

fn nanoseconds(time: SystemTime) -> Option<i128> {
    i128::try_from(time.duration_since(UNIX_EPOCH).ok()?.as_nanos()).ok()
}

/// When a file was written last, and when anything about it changed last, which nobody can set.
fn times(about: &Metadata) -> Option<[i128; 2]> {
    Some([nanoseconds(about.modified().ok()?)?, changed(about)?])
}

#[cfg(unix)]
#[expect(clippy::unnecessary_wraps, reason = "as elsewhere, where there may be no such time")]
fn changed(about: &Metadata) -> Option<i128> {
    use std::os::unix::fs::MetadataExt;
    Some(i128::from(about.ctime()) * 1_000_000_000 + i128::from(about.ctime_nsec()))
}

#[cfg(not(unix))]
fn changed(about: &Metadata) -> Option<i128> {
    nanoseconds(about.created().ok()?)
}

/// What the environment says to cargo and the compiler, in one line.
fn variables(all: impl Iterator<Item = (OsString, OsString)>) -> String {
    let named =
        all.filter(|(name, _)| VARIABLES.iter().any(|start| name.to_string_lossy().starts_with(start)));
    let sorted: BTreeSet<String> = named.map(|(name, value)| format!("{name:?}={value:?}")).collect();
    sorted.into_iter().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Folder(PathBuf);

    impl Folder {
        /// A library that was built of `src/lib.rs`.
        fn new(name: &str) -> Folder {
            let folder = std::env::temp_dir().join(format!("blocksim-fresh-{name}-{}", std::process::id()));
            fs::create_dir_all(folder.join("src")).unwrap();
            let source = folder.join("src/lib.rs");
            fs::write(&source, "fn law() {}").unwrap();
            fs::write(folder.join("Cargo.toml"), "[package]").unwrap();
            fs::write(folder.join("liblaw.so"), "built").unwrap();
            let rule = format!("{}: {}\n", folder.join("liblaw.so").display(), source.display());
            fs::write(folder.join("liblaw.d"), rule).unwrap();
            Folder(folder)
        }

        /// As if cargo were asked after the grain of the clock.
        fn remember(&self) {
            let asked = SystemTime::now() + std::time::Duration::from_millis(30);
            remember(&self.0, &self.library(), asked);
        }

        fn library(&self) -> PathBuf {
            self.0.join("liblaw.so")
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn a_library_is_fresh_until_something_that_it_was_built_of_changes() {
        type Change = fn(&Path);
        let changes: [(&str, Change); 5] = [
            ("source", |folder| fs::write(folder.join("src/lib.rs"), "fn law() { }").unwrap()),
            ("same size", |folder| fs::write(folder.join("src/lib.rs"), "fn wal() {}").unwrap()),
            ("manifest", |folder| fs::write(folder.join("Cargo.toml"), "[package] ").unwrap()),
            ("library", |folder| fs::write(folder.join("liblaw.so"), "other").unwrap()),
            ("settings", |folder| fs::write(folder.join("rust-toolchain.toml"), "[toolchain]").unwrap()),
        ];
        for (name, change) in changes {
            let folder = Folder::new(name.split(' ').next().unwrap_or_default());
            assert!(!is_fresh(&folder.library()), "there is no stamp yet");
            folder.remember();
            assert!(is_fresh(&folder.library()), "{name}");
            change(&folder.0);
            assert!(!is_fresh(&folder.library()), "{name}");
        }
    }

    #[test]
    fn a_time_that_was_set_back_does_not_hide_a_change() {
        let folder = Folder::new("back");
        folder.remember();
        let source = folder.0.join("src/lib.rs");
        let written = fs::metadata(&source).unwrap().modified().unwrap();
        fs::write(&source, "fn wal() {}").unwrap();
        fs::File::options().append(true).open(&source).unwrap().set_modified(written).unwrap();
        assert_eq!(fs::metadata(&source).unwrap().modified().unwrap(), written);
        assert!(!cfg!(unix) || !is_fresh(&folder.library()));
    }

    #[test]
    fn what_was_written_while_cargo_ran_gets_no_stamp() {
        let asked = SystemTime::now();
        let folder = Folder::new("now");
        remember(&folder.0, &folder.library(), asked);
        assert!(!is_fresh(&folder.library()));
    }

    #[test]
    fn rules_and_variables_are_read() {
        let files = dependencies("/t/lib a.so: /a/lib.rs /b\\ c/d.rs\n").unwrap();
        assert_eq!(files, [PathBuf::from("/a/lib.rs"), PathBuf::from("/b c/d.rs")]);
        assert_eq!(dependencies("/t/lib.so: lib.rs\n"), None, "relative to nobody knows what");
        let all = [("RUSTFLAGS", "-C x"), ("HOME", "/h"), ("CARGO_TARGET_DIR", "t")];
        let all = all.map(|(name, value)| (OsString::from(name), OsString::from(value)));
        assert_eq!(variables(all.into_iter()), "\"CARGO_TARGET_DIR\"=\"t\" \"RUSTFLAGS\"=\"-C x\"");
    }
}
