//! Places on disk: tried before they are needed, filled whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::error::ResultsError;

/// Creates the folder `parent` where it is missing and tries to write a small file there, so that a long run
/// does not fail at its end. Leaves nothing but the folder.
///
/// # Errors
///
/// [`ResultsError`] where the folder cannot be created or written.
pub fn probe(parent: &Path) -> Result<(), ResultsError> {
    fs::create_dir_all(parent).map_err(|error| ResultsError::io("create", parent, error))?;
    let file = parent.join(format!(".blocksim-probe-{}", unique()));
    let tried = fs::write(&file, [b'x'; 4096]);
    let removed = fs::remove_file(&file);
    tried.and(removed).map_err(|error| ResultsError::io("write into", parent, error))
}

/// Writes `folder/name` by way of a temporary sibling that is renamed at the end: whole or not at all.
///
/// # Errors
///
/// [`ResultsError`] where the system refuses; an older file of this name is then as it was.
pub fn write_whole(
    folder: &Path,
    name: &str,
    content: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
) -> Result<PathBuf, ResultsError> {
    let target = folder.join(name);
    let temporary = folder.join(format!(".{name}-{}.tmp", unique()));
    let write = || -> io::Result<()> {
        let mut file = BufWriter::new(File::create_new(&temporary)?);
        content(&mut file)?;
        // A disk may report that it is full only now.
        file.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
        fs::rename(&temporary, &target)
    };
    write().map_err(|error| {
        // The first error is the one to tell; a second one here has the same cause.
        let _ = fs::remove_file(&temporary);
        ResultsError::io("write", &target, error)
    })?;
    Ok(target)
}

/// A part of a name of its own for each process and thread.
fn unique() -> String {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    format!("{}-{}", process::id(), COUNT.fetch_add(1, Ordering::Relaxed))
}

/// `name`, then `name-2`, `name-3` …
pub(crate) fn numbered(name: &str) -> impl Iterator<Item = String> {
    let name = name.to_owned();
    std::iter::once(name.clone()).chain((2_u32..).map(move |n| format!("{name}-{n}")))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A folder of its own for each test, removed at the end.
    pub(crate) struct Scratch(pub PathBuf);

    impl Scratch {
        pub(crate) fn new() -> Scratch {
            static COUNT: AtomicU32 = AtomicU32::new(0);
            let n = COUNT.fetch_add(1, Ordering::Relaxed);
            let path = std::env::temp_dir().join(format!("blocksim-recording-{}-{n}", process::id()));
            fs::create_dir_all(&path).unwrap();
            Scratch(path)
        }

        pub(crate) fn names(&self) -> Vec<String> {
            let mut names: Vec<String> = fs::read_dir(&self.0)
                .unwrap()
                .map(|entry| entry.unwrap().file_name().into_string().unwrap())
                .collect();
            names.sort();
            names
        }
    }

    impl Drop for Scratch {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn probing_creates_the_folder_and_leaves_nothing_else() {
        let scratch = Scratch::new();
        let parent = scratch.0.join("a/b");
        probe(&parent).unwrap();
        assert_eq!(fs::read_dir(&parent).unwrap().count(), 0);
    }

    #[test]
    fn probing_below_a_file_says_so() {
        let scratch = Scratch::new();
        let file = scratch.0.join("file");
        fs::write(&file, "").unwrap();
        let error = probe(&file.join("runs")).unwrap_err();
        assert_eq!(error.place(), file.join("runs"));
        assert_eq!(error.reason(), "part of the path is a file, not a folder");
        assert_eq!(error.remedy(), "choose another place with --out");
    }

    #[test]
    fn a_file_that_fails_half_way_leaves_nothing_and_spares_the_old_one() {
        let scratch = Scratch::new();
        write_whole(&scratch.0, "signals.csv", |w| w.write_all(b"old")).unwrap();
        let error = write_whole(&scratch.0, "signals.csv", |w| {
            w.write_all(b"half")?;
            Err(io::ErrorKind::StorageFull.into())
        })
        .unwrap_err();
        assert_eq!(
            error.to_string(),
            format!(
                "cannot write `{}`: the disk is full; free some space, record fewer signals, or choose \
                 another place with --out",
                scratch.0.join("signals.csv").display()
            )
        );
        assert_eq!(scratch.names(), ["signals.csv"]);
        assert_eq!(fs::read(scratch.0.join("signals.csv")).unwrap(), b"old");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_full_device_of_linux_is_reported_as_a_full_disk() {
        let mut full = BufWriter::new(File::create("/dev/full").unwrap());
        let result = full.write_all(&[0; 10]).and_then(|()| full.flush());
        let error = ResultsError::io("write", Path::new("/dev/full"), result.unwrap_err());
        assert_eq!(error.reason(), "the disk is full");
        // What is left in the buffer cannot be written when it is dropped, either.
        let _ = full.into_parts();
    }
}
