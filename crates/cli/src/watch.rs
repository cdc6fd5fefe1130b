//! Does something again whenever a file of a model changes.

use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use crate::args::model::ModelArgs;
use crate::exit::Exit;
use crate::failure::Outcome;
use crate::loaded::files_of;
use crate::running::interrupt;
use crate::terminal::console::Console;
use crate::terminal::render::plural;
use crate::trust::Purpose;

/// How often files are looked at. A few hundred of them cost a millisecond.
const EVERY: Duration = Duration::from_millis(100);
/// Folders below that of a plug-in that are looked into.
const DEEP: usize = 8;
/// Endings of the sources of a plug-in.
const SOURCES: [&str; 9] = ["rs", "c", "cc", "cpp", "cxx", "h", "hh", "hpp", "hxx"];
/// Folders below that of a plug-in which hold what was made of it.
const MADE: [&str; 2] = ["target", "runs"];

/// When a file was written last, and how long it is; none where there is none.
type State = Vec<(PathBuf, Option<(SystemTime, u64)>)>;

/// Does something, and again after every change of a file that the model was read from, until Ctrl-C. Ends as what was
/// done last.
///
pub fn watch(
    model: &ModelArgs,
    purpose: Purpose,
    console: Console,
    mut again: impl FnMut() -> Outcome,
) -> Exit {
    interrupt::take_over();
    loop {
        // What is written while it runs has not been seen by it.
        let places = files_of(model, purpose);
        let before = state(&places);
        let exit = again().unwrap_or_else(|failure| failure.tell(console));
        if interrupt::is_requested() {
            return exit;
        }
        console.say(&format!("waiting for changes of {}; Ctrl-C ends", plural(before.len(), "file")));
        let Some(changed) = change(&places, before) else { return exit };
        console.say(&format!("\n{} has changed", changed.display()));
    }
}

/// Waits for a change and for its end; `None` after Ctrl-C.
fn change(places: &[PathBuf], before: State) -> Option<PathBuf> {
    let mut last = before.clone();
    loop {
        std::thread::sleep(EVERY);
        if interrupt::is_requested() {
            return None;
        }
        let now = state(places);
        // An editor may write several files, or take one away before it writes it again.
        let is_quiet =
            now == last && now.iter().all(|(path, file)| file.is_some() || path.ends_with("plugin.toml"));
        match first_changed(&before, &now) {
            Some(changed) if is_quiet => return Some(changed),
            _ => last = now,
        }
    }
}

fn first_changed(before: &State, now: &State) -> Option<PathBuf> {
    let changed = now.iter().find(|file| !before.contains(file));
    let gone = || before.iter().find(|(path, _)| !now.iter().any(|(other, _)| other == path));
    changed.or_else(gone).map(|(path, _)| path.clone())
}

/// When a source of these plug-ins was written last, by their folders.
pub fn newest(folders: &[PathBuf]) -> Option<SystemTime> {
    state(folders).into_iter().filter_map(|(_, file)| Some(file?.0)).max()
}

/// Files, and of folders, which hold plug-ins, their sources.
fn state(places: &[PathBuf]) -> State {
    let mut state = State::new();
    for place in places {
        if place.is_dir() {
            let is_crate = place.join("Cargo.toml").is_file();
            push_file(&place.join(if is_crate { "Cargo.toml" } else { "plugin.toml" }), &mut state);
            push_folder(&if is_crate { place.join("src") } else { place.clone() }, DEEP, &mut state);
        } else {
            push_file(place, &mut state);
        }
    }
    state
}

fn push_file(path: &Path, state: &mut State) {
    let written = path.metadata().ok().and_then(|data| Some((data.modified().ok()?, data.len())));
    state.push((path.to_owned(), written));
}

fn push_folder(folder: &Path, deep: usize, state: &mut State) {
    let Ok(entries) = folder.read_dir() else { return };
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            if deep > 0 && !MADE.iter().any(|made| path.ends_with(made)) {
                push_folder(&path, deep - 1, state);
            }
        } else if path.extension().is_some_and(|ending| SOURCES.iter().any(|source| ending == *source)) {
            push_file(&path, state);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_of_a_plug_in_are_looked_at_and_what_changed_is_named() {
        let folder = std::env::temp_dir().join(format!("blocksim-watch-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("src/deep")).unwrap();
        for file in ["Cargo.toml", "src/lib.rs", "src/deep/law.rs", "src/notes.txt"] {
            std::fs::write(folder.join(file), "a").unwrap();
        }
        let places = [folder.clone(), folder.join("none.ron")];
        let before = state(&places);
        let names: Vec<_> =
            before.iter().map(|(path, _)| path.strip_prefix(&folder).unwrap().to_owned()).collect();
        assert_eq!(names, ["Cargo.toml", "src/deep/law.rs", "src/lib.rs", "none.ron"].map(PathBuf::from));
        assert_eq!(before[3].1, None);
        assert_eq!(first_changed(&before, &before.clone()), None);

        std::fs::write(folder.join("src/deep/law.rs"), "longer").unwrap();
        assert_eq!(first_changed(&before, &state(&places)), Some(folder.join("src/deep/law.rs")));
        std::fs::remove_file(folder.join("src/deep/law.rs")).unwrap();
        assert_eq!(first_changed(&before, &state(&places)), Some(folder.join("src/deep/law.rs")));
        std::fs::remove_dir_all(folder).unwrap();
    }
}
