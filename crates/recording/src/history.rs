//! The runs that were kept in a folder, and how to name one of them.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::clock;
use crate::error::ResultsError;
use crate::manifest::{Ended, Manifest};
use crate::regular::{MOST_TEXT, limited_text};
use crate::run::STORE;

/// A run in the history.
#[derive(Debug, Clone, PartialEq)]
pub struct Kept {
    /// Its folder.
    pub path: PathBuf,
    /// Name of the folder.
    pub name: String,
    /// Start in UTC, ISO 8601; where there is no manifest, when the folder was changed last.
    pub started: String,
    /// What was run; none where the manifest is missing or cannot be read.
    pub manifest: Option<Manifest>,
    /// Bytes of all its files.
    pub bytes: u64,
}

impl Kept {
    /// Whether it has not got its final name: it still runs, or its program was ended by force.
    pub fn is_unfinished(&self) -> bool {
        self.name.ends_with(PARTIAL)
    }

    /// How it ended, in a word.
    pub fn ended(&self) -> &'static str {
        match self.manifest.as_ref().map(|manifest| &manifest.ended) {
            _ if self.is_unfinished() => "unfinished",
            None => "unknown",
            Some(Ended::Unfinished) => "unfinished",
            Some(Ended::Complete) => "complete",
            Some(Ended::Stopped { .. }) => "stopped",
            Some(Ended::Interrupted) => "interrupted",
            Some(Ended::Failed { .. }) => "failed",
        }
    }
}

/// Ending of the folder of a run that is being written.
pub(crate) const PARTIAL: &str = ".partial";

/// The runs in a folder, the oldest first; none where the folder is missing. Folders that hold neither manifest nor
/// recording are passed over.
///
/// # Errors
/// [`ResultsError`] where the folder cannot be read.
pub fn history(runs: &Path) -> Result<Vec<Kept>, ResultsError> {
    let entries = match fs::read_dir(runs) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(|error| ResultsError::io("read", runs, error))?,
    };
    let mut kept: Vec<Kept> = entries.filter_map(|entry| look(&entry.ok()?.path())).collect();
    // Of the same second the one that was written last is the newest.
    let written =
        |kept: &Kept| fs::metadata(kept.path.join("manifest.json")).and_then(|file| file.modified()).ok();
    let key = |kept: &Kept| (kept.started.clone(), written(kept), kept.name.len(), kept.name.clone());
    kept.sort_by_cached_key(key);
    Ok(kept)
}

fn look(path: &Path) -> Option<Kept> {
    let about = fs::metadata(path).ok().filter(fs::Metadata::is_dir)?;
    let files = ["manifest.json", STORE, "signals.csv"];
    if !files.iter().any(|file| path.join(file).is_file()) {
        return None;
    }
    let text = limited_text(&path.join("manifest.json"), MOST_TEXT);
    let manifest = text.ok().and_then(|text| Manifest::from_json(&text).ok());
    let changed = || clock::iso(about.modified().unwrap_or(SystemTime::UNIX_EPOCH));
    let sizes = fs::read_dir(path).ok()?.filter_map(|file| Some(file.ok()?.metadata().ok()?.len()));
    Some(Kept {
        path: path.to_owned(),
        name: path.file_name()?.to_string_lossy().into_owned(),
        started: manifest.as_ref().map_or_else(changed, |manifest| manifest.started.clone()),
        manifest,
        bytes: sizes.sum(),
    })
}

/// The folder or file that a person means: a path; else, among the runs in `runs`, `latest` (the newest finished
/// one), a name, or the beginning or some other part of a name that only one of them has.
///
/// # Errors
/// [`ResultsError::NoSuchRun`] with the names that come into question.
pub fn locate(named: &str, runs: &Path) -> Result<PathBuf, ResultsError> {
    let path = Path::new(named);
    if named != "latest" && path.exists() {
        return Ok(path.to_owned());
    }
    let kept = history(runs)?;
    let finished = || kept.iter().filter(|kept| !kept.is_unfinished());
    let refuse = |likely: Vec<String>| ResultsError::NoSuchRun {
        path: path.to_owned(),
        runs: runs.to_owned(),
        likely,
    };
    if named == "latest" {
        return finished().next_back().map(|kept| kept.path.clone()).ok_or_else(|| refuse(Vec::new()));
    }
    let begins = |kept: &&Kept| kept.name.starts_with(named);
    let contains = |kept: &&Kept| kept.name.contains(named);
    let mut found: Vec<&Kept> = kept.iter().filter(|kept| kept.name == named).collect();
    for fits in [&begins as &dyn Fn(&&Kept) -> bool, &contains] {
        if found.is_empty() && !named.is_empty() {
            found = kept.iter().filter(fits).collect();
        }
    }
    match found.as_slice() {
        [only] => Ok(only.path.clone()),
        many => Err(refuse(many.iter().rev().map(|kept| kept.name.clone()).collect())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::manifest::tests::example;
    use crate::place::tests::Scratch;

    fn keep(scratch: &Scratch, name: &str, started: &str) {
        let folder = scratch.0.join(name);
        fs::create_dir(&folder).unwrap();
        let manifest = Manifest { started: started.into(), ..example() };
        fs::write(folder.join("manifest.json"), manifest.to_json().unwrap()).unwrap();
    }

    #[test]
    fn runs_are_listed_by_time_and_other_folders_are_not() {
        let scratch = Scratch::new();
        keep(&scratch, "b", "2026-11-21T14:03:22Z");
        keep(&scratch, "a", "2026-11-21T14:03:23Z");
        // Within one second they are sorted by when they were written, not by name.
        for name in ["a-first", "b-9", "b-10", "a-last"] {
            std::thread::sleep(std::time::Duration::from_millis(15));
            keep(&scratch, name, "2026-11-21T14:03:22Z");
        }
        fs::create_dir(scratch.0.join("notes")).unwrap();
        fs::write(scratch.0.join("file"), "").unwrap();
        fs::create_dir(scratch.0.join("broken")).unwrap();
        fs::write(scratch.0.join("broken/manifest.json"), "{").unwrap();
        let kept = history(&scratch.0).unwrap();
        let names: Vec<&str> = kept.iter().map(|kept| kept.name.as_str()).collect();
        // The broken one goes by the time of its folder, which is now.
        let known: Vec<&str> = names.iter().copied().filter(|name| *name != "broken").collect();
        assert_eq!(known, ["b", "a-first", "b-9", "b-10", "a-last", "a"]);
        let broken = kept.iter().find(|kept| kept.name == "broken").unwrap();
        assert_eq!((broken.ended(), broken.bytes), ("unknown", 1));
        assert!(kept.iter().all(|kept| kept.name == "broken" || kept.ended() == "complete"));
        assert!(history(&scratch.0.join("none")).unwrap().is_empty());
    }

    #[test]
    fn a_run_is_found_by_path_name_part_or_as_the_latest() {
        let scratch = Scratch::new();
        keep(&scratch, "2026-11-21T14-03-22_servo", "2026-11-21T14:03:22Z");
        keep(&scratch, "2026-11-21T14-03-22_servo-2", "2026-11-21T14:03:22Z");
        keep(&scratch, "2026-11-22T08-00-00_arm", "2026-11-22T08:00:00Z");
        keep(&scratch, "2026-11-23T08-00-00_arm.partial", "2026-11-23T08:00:00Z");
        let found = |named: &str| {
            locate(named, &scratch.0).map(|path| path.file_name().unwrap().to_string_lossy().into_owned())
        };
        assert_eq!(found("latest").unwrap(), "2026-11-22T08-00-00_arm");
        assert_eq!(found("2026-11-22").unwrap(), "2026-11-22T08-00-00_arm");
        assert_eq!(found("2026-11-21T14-03-22_servo").unwrap(), "2026-11-21T14-03-22_servo");
        assert_eq!(found("servo-2").unwrap(), "2026-11-21T14-03-22_servo-2");
        let whole = scratch.0.join("2026-11-21T14-03-22_servo").display().to_string();
        assert_eq!(locate(&whole, Path::new("elsewhere")).unwrap(), Path::new(&whole));
        let error = found("servo").unwrap_err();
        assert_eq!(
            error.reason(),
            "several runs fit: 2026-11-21T14-03-22_servo-2, 2026-11-21T14-03-22_servo"
        );
        assert!(found("pole").unwrap_err().reason().starts_with("no folder, file or run in"));
        assert!(found("").is_err());
        assert!(locate("latest", &scratch.0.join("none")).is_err());
    }
}
