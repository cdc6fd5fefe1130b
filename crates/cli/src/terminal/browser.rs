//! The browser of the system.

use std::fs;
use std::path::Path;

use super::console::Console;

/// Shows a file, or the page at an address, in the browser of the system, where there is one.
pub fn open(file: &Path, console: Console) {
    let program = match std::env::consts::OS {
        "macos" => "open",
        "windows" => "explorer",
        _ => "xdg-open",
    };
    let file = fs::canonicalize(file).unwrap_or_else(|_| file.to_owned());
    let quiet = std::process::Stdio::null;
    let started =
        std::process::Command::new(program).arg(&file).stdout(quiet()).stderr(quiet()).stdin(quiet()).spawn();
    if started.is_err() {
        console.say(&format!("note: `{program}` is missing; open {} in a browser", file.display()));
    }
}
