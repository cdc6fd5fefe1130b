//! Whether a plug-in is as it was built: a stamp beside its library lists every file that it was built from.
//!
//! Asking cargo or a compiler takes a good part of the time in which a model is checked. A file is the same if size and times
//! are; the time of its last change of state is one that no archive brings along, so a stamp from elsewhere is worth nothing.
//! If anything is in doubt, the plug-in is built.

use std::collections::BTreeSet;
use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use super::text::text;

/// First line of a stamp; another version has another one.
const HEAD: &str = "blocksim plug-in 1";
/// Nanoseconds before the build in which a file may change once more without another time: the grain of clocks.
const GRAIN: i128 = 20_000_000;

/// Whether a library, the recipe (one line) that it was built by and all that it was built from are as they were.
pub fn is_fresh(library: &Path, recipe: &str) -> bool {
    let Ok(stamp) = text(&place(library)) else { return false };
    let mut lines = stamp.lines();
    lines.next() == Some(HEAD)
        && lines.next() == Some(recipe)
        && lines.next() == Some(state(library).as_str())
        && lines.all(|line| line.split_once(' ').is_some_and(|(_, path)| state(Path::new(path)) == line))
}

/// Writes the stamp of a library that was built, or found up to date, of these files by a recipe. What changed since the
/// build was asked for may have come too late for it: there is no stamp then, and it is built again.
pub fn remember(library: &Path, recipe: &str, files: &BTreeSet<PathBuf>, asked: SystemTime) {
    if let Some(stamp) = stamp(library, recipe, files, asked) {
        // Renamed into its place: it is whole, whatever has been there.
        let (new, place) = (library.with_extension("blocksim.new"), place(library));
        let _ = fs::remove_file(&new);
        if fs::write(&new, stamp).and_then(|()| fs::rename(&new, &place)).is_err() {
            let _ = fs::remove_file(&new);
        }
    }
}

fn place(library: &Path) -> PathBuf {
    library.with_extension("blocksim")
}

fn stamp(library: &Path, recipe: &str, files: &BTreeSet<PathBuf>, asked: SystemTime) -> Option<String> {
    let last = nanoseconds(asked)? - GRAIN;
    let is_settled = |path: &PathBuf| match fs::metadata(path) {
        Ok(about) => times(&about).is_some_and(|times| times.iter().all(|time| *time < last)),
        Err(_) => true,
    };
    // A path with a line break is no line.
    let can_be_listed = |path: &PathBuf| path.to_str().is_some_and(|path| !path.contains('\n'));
    if recipe.contains('\n') || !files.iter().all(|path| is_settled(path) && can_be_listed(path)) {
        return None;
    }
    let states: String = files.iter().map(|path| format!("{}\n", state(path))).collect();
    Some(format!("{HEAD}\n{recipe}\n{}\n{states}", state(library)))
}

/// The files behind the colon of a rule `target: file file`, in which a backslash stands before a space or the end of a line.
pub fn rule_files(rule: &str) -> Option<Vec<PathBuf>> {
    let whole = rule.replace("\\\r\n", " ").replace("\\\n", " ");
    let (_, files) = whole.lines().next()?.split_once(": ")?;
    let marked = files.replace("\\ ", "\0");
    let files: Vec<PathBuf> =
        marked.split_whitespace().map(|file| PathBuf::from(file.replace('\0', " "))).collect();
    (!files.is_empty()).then_some(files)
}

/// `size,written,changed path`, or `- path` if the file does not exist.
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

#[cfg(test)]
mod tests {
    use super::*;

    const RECIPE: &str = "cc -O2";

    struct Folder(PathBuf);

    impl Folder {
        /// A library that was built of `src/lib.rs`.
        fn new(name: &str) -> Folder {
            let folder = std::env::temp_dir().join(format!("blocksim-fresh-{name}-{}", std::process::id()));
            fs::create_dir_all(folder.join("src")).unwrap();
            fs::write(folder.join("src/lib.rs"), "fn law() {}").unwrap();
            fs::write(folder.join("Cargo.toml"), "[package]").unwrap();
            fs::write(folder.join("liblaw.so"), "built").unwrap();
            Folder(folder)
        }

        /// As if cargo were asked after the grain of the clock.
        fn remember(&self) {
            let asked = SystemTime::now() + std::time::Duration::from_millis(30);
            remember(&self.library(), RECIPE, &self.files(), asked);
        }

        fn files(&self) -> BTreeSet<PathBuf> {
            ["src/lib.rs", "Cargo.toml", "rust-toolchain.toml"].map(|name| self.0.join(name)).into()
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
            assert!(!is_fresh(&folder.library(), RECIPE), "there is no stamp yet");
            folder.remember();
            assert!(is_fresh(&folder.library(), RECIPE), "{name}");
            change(&folder.0);
            assert!(!is_fresh(&folder.library(), RECIPE), "{name}");
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
        assert!(!cfg!(unix) || !is_fresh(&folder.library(), RECIPE));
    }

    #[test]
    fn what_was_written_while_cargo_ran_gets_no_stamp() {
        let asked = SystemTime::now();
        let folder = Folder::new("now");
        remember(&folder.library(), RECIPE, &folder.files(), asked);
        assert!(!is_fresh(&folder.library(), RECIPE));
    }

    #[cfg(unix)]
    #[test]
    fn a_stamp_that_never_ends_is_none_and_is_replaced() {
        let folder = Folder::new("endless");
        let stamp = place(&folder.library());
        std::os::unix::fs::symlink("/dev/zero", &stamp).unwrap();
        assert!(!is_fresh(&folder.library(), RECIPE));
        folder.remember();
        assert!(is_fresh(&folder.library(), RECIPE) && stamp.symlink_metadata().unwrap().is_file());
        fs::remove_file(&stamp).unwrap();
        let made = std::process::Command::new("mkfifo").arg(&stamp).status().unwrap();
        assert!(made.success() && !is_fresh(&folder.library(), RECIPE));
        folder.remember();
        assert!(is_fresh(&folder.library(), RECIPE));
        fs::write(&stamp, vec![b' '; 2 << 20]).unwrap();
        assert!(!is_fresh(&folder.library(), RECIPE), "too long");
    }

    #[test]
    fn another_recipe_gives_another_library() {
        let folder = Folder::new("recipe");
        folder.remember();
        assert!(is_fresh(&folder.library(), RECIPE) && !is_fresh(&folder.library(), "cc -O0"));
    }

    #[test]
    fn rules_are_read() {
        let files = rule_files("/t/lib a.so: /a/lib.rs /b\\ c/d.rs\n").unwrap();
        assert_eq!(files, [PathBuf::from("/a/lib.rs"), PathBuf::from("/b c/d.rs")]);
        let files = rule_files("law.o: law.c \\\n  law.h\n").unwrap();
        assert_eq!(files, [PathBuf::from("law.c"), PathBuf::from("law.h")]);
        assert_eq!(rule_files("nothing"), None);
    }
}
