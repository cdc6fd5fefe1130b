//! The manual as it is followed by a reader: fences of its pages, and a folder like that of the project.

use std::fs;
use std::path::{Path, PathBuf};

use super::root;

/// A part of a page between fences.
pub struct Fence<'a> {
    /// Language, and the name of the file that the part is.
    pub language: &'a str,
    pub file: Option<&'a str>,
    pub text: &'a str,
    /// Whether nothing but blank lines lies between it and the fence before.
    pub follows: bool,
}

/// The fences of a page.
pub fn fences(page: &str) -> Vec<Fence<'_>> {
    let parts: Vec<&str> = page.split("```").collect();
    let fence = |at: usize| {
        let (info, text) = parts[at].split_once('\n').expect("a line below the fence");
        let mut words = info.split_whitespace();
        let (language, file) = (words.next().unwrap_or_default(), words.next());
        Fence { language, file, text, follows: parts[at - 1].trim().is_empty() }
    };
    (1..parts.len()).step_by(2).map(fence).collect()
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(from).expect("a folder") {
        let (entry, name) = entry.map(|entry| (entry.path(), entry.file_name())).expect("an entry");
        if entry.is_dir() {
            copy(&entry, &to.join(name));
        } else {
            fs::copy(&entry, to.join(name)).expect("a copy");
        }
    }
}

/// A folder like that of the project, as far as a page needs it.
pub fn folder_of_project(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    for part in ["diagrams", "params"] {
        copy(&root().join(part), &folder.join(part));
    }
    // Crates stay where their workspace is; new ones come beside them.
    fs::create_dir_all(folder.join("plugins")).expect("a folder");
    for entry in fs::read_dir(root().join("plugins")).expect("the plug-ins") {
        let plugin = entry.expect("an entry").path().canonicalize().expect("a plug-in");
        let name = plugin.file_name().expect("a name");
        std::os::unix::fs::symlink(&plugin, folder.join("plugins").join(name)).expect("a link");
    }
    folder
}
