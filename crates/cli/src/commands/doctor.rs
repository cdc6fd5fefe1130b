//! `blocksim doctor`: whether everything is there that runs, plug-ins and pages need.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::SystemTime;

use blocksim_block::shell::quoted_text;
use blocksim_recording::{MOST_TEXT, limited_text};
use serde_json::json;

use crate::args::start::DoctorArgs;
use crate::args::values::RUNS;
use crate::exit::Exit;
use crate::failure::Outcome;
use crate::left_out;
use crate::terminal::console::Console;

/// Oldest Rust that builds plug-ins.
const RUST: (u32, u32) = (1, 88);
/// A run of the flagship with all its signals takes less, in bytes.
const ROOM: u64 = 500 << 20;
/// Programs that show a page, by their usual names.
const BROWSERS: [&str; 7] =
    ["xdg-open", "open", "firefox", "chromium", "chromium-browser", "google-chrome", "microsoft-edge"];

/// How something is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Well,
    /// Worth knowing.
    Note,
    Missing,
}

/// A line of the answer.
struct Finding {
    what: &'static str,
    state: State,
    said: String,
    remedy: Option<String>,
}

impl Finding {
    fn well(what: &'static str, said: impl Into<String>) -> Finding {
        Finding { what, state: State::Well, said: said.into(), remedy: None }
    }

    fn not(what: &'static str, state: State, said: impl Into<String>, remedy: impl Into<String>) -> Finding {
        Finding { what, state, said: said.into(), remedy: Some(remedy.into()) }
    }
}

/// Tells what is there, what is missing and what to do about it.
///
/// # Errors
/// If the standard output cannot be written.
pub fn doctor(args: &DoctorArgs, console: Console) -> Outcome {
    let mut findings = vec![program(), parts(), cargo(), compiler(), sources(), runs(), disk(), browser()];
    findings.extend(plugins(Path::new(".")));
    for finding in &findings {
        console.data(&if args.json { data(finding) } else { text(finding) })?;
    }
    let missing = findings.iter().any(|finding| finding.state == State::Missing);
    Ok(if missing { Exit::Failed } else { Exit::Done })
}

fn word(state: State) -> &'static str {
    match state {
        State::Well => "ok",
        State::Note => "note",
        State::Missing => "missing",
    }
}

fn text(finding: &Finding) -> String {
    let remedy = finding.remedy.as_ref().map_or_else(String::new, |remedy| format!("  = help: {remedy}\n"));
    format!("{:8} {:12} {}\n{remedy}", word(finding.state), finding.what, finding.said)
}

fn data(finding: &Finding) -> String {
    let line = json!({
        "v": 1,
        "type": "finding",
        "what": finding.what,
        "state": word(finding.state),
        "message": finding.said,
        "help": finding.remedy,
    });
    format!("{line}\n")
}

fn program() -> Finding {
    let place = std::env::current_exe().map(|path| format!(", {}", path.display())).unwrap_or_default();
    Finding::well("blocksim", format!("{}{place}", env!("CARGO_PKG_VERSION")))
}

/// The optional parts of this program.
fn parts() -> Finding {
    let what = "parts";
    let all = [
        ("png", cfg!(feature = "png")),
        ("xlsx", cfg!(feature = "xlsx")),
        ("parquet", cfg!(feature = "parquet")),
        ("lsp", cfg!(feature = "lsp")),
        ("wasm", cfg!(feature = "wasm")),
        ("site", cfg!(feature = "site")),
    ];
    let names = |is_there: bool| {
        let names: Vec<&str> =
            all.iter().filter(|(_, there)| *there == is_there).map(|(name, _)| *name).collect();
        names.join(", ")
    };
    match (names(true), names(false)) {
        (there, absent) if absent.is_empty() => Finding::well(what, format!("all: {there}")),
        (there, absent) => {
            let there = if there.is_empty() { "none".to_owned() } else { there };
            let said = format!("{there}; built without {absent}");
            Finding::not(what, State::Note, said, left_out::help("full"))
        }
    }
}

/// The first line of what a program says of its version.
fn version(program: &str) -> Option<String> {
    let output =
        Command::new(program).arg("--version").stdin(Stdio::null()).stderr(Stdio::null()).output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    output.status.success().then(|| text.lines().next().unwrap_or_default().to_owned())
}

fn cargo() -> Finding {
    let what = "cargo";
    let named = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let Some(said) = version(&named) else {
        let remedy = "install Rust from https://rustup.rs; plug-ins that are not built yet need it";
        return Finding::not(what, State::Missing, "missing", remedy);
    };
    let mut numbers = said.split_whitespace().nth(1).unwrap_or_default().split('.');
    let mut next = || numbers.next().and_then(|number| number.parse::<u32>().ok());
    match (next(), next()) {
        (Some(major), Some(minor)) if (major, minor) < RUST => {
            let remedy = format!("plug-ins need {}.{}: `rustup update`", RUST.0, RUST.1);
            Finding::not(what, State::Missing, said, remedy)
        }
        _ => Finding::well(what, said),
    }
}

fn compiler() -> Finding {
    let what = "C compiler";
    match ["cc", "gcc", "clang"].into_iter().find_map(version) {
        Some(said) => Finding::well(what, said),
        None if cfg!(windows) => Finding::well(what, "comes with the toolchain of Rust"),
        None => Finding::not(
            what,
            State::Missing,
            "there is no cc, gcc or clang",
            "plug-ins in C are compiled and those in Rust are linked with it: install gcc or clang, such as with \
             `apt-get install gcc`",
        ),
    }
}

fn sources() -> Finding {
    let what = "sources";
    let clone = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    match clone.canonicalize() {
        Ok(clone) if clone.join("crates/controller/Cargo.toml").is_file() => {
            Finding::well(what, clone.display().to_string())
        }
        _ => Finding::not(
            what,
            State::Note,
            "the clone that this program was built from is gone",
            "new plug-ins need one: give its folder with `blocksim plugin new --blocksim DIR`",
        ),
    }
}

fn runs() -> Finding {
    let what = "runs folder";
    let folder = Path::new(RUNS);
    let (tried, said) = match folder.is_dir() {
        true => (folder, format!("`{RUNS}` can be written")),
        false => (Path::new("."), format!("`{RUNS}` can be made here")),
    };
    let probe = tried.join(format!(".blocksim-{}", std::process::id()));
    let written = fs::File::create_new(&probe);
    let _ = fs::remove_file(&probe);
    match written {
        Ok(_) if !folder.exists() || folder.is_dir() => Finding::well(what, said),
        Ok(_) => {
            let said = format!("`{RUNS}` is a file");
            Finding::not(
                what,
                State::Missing,
                said,
                "rename it, or name another folder: `blocksim run --out DIR`",
            )
        }
        Err(error) => {
            let said = format!("`{}` cannot be written: {error}", tried.display());
            Finding::not(
                what,
                State::Missing,
                said,
                "go to a folder of yours, or name one: `blocksim run --out DIR`",
            )
        }
    }
}

/// Room on the disk of this folder; nobody but `df` tells it without unsafe code.
fn disk() -> Finding {
    let what = "disk";
    let output = Command::new("df").args(["-Pk", "."]).stdin(Stdio::null()).stderr(Stdio::null()).output();
    let text = output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned()).unwrap_or_default();
    let free = text.lines().nth(1).and_then(|line| line.split_whitespace().nth(3)?.parse::<u64>().ok());
    match free.map(|blocks| blocks.saturating_mul(1024)) {
        None => Finding::not(what, State::Note, "the free space is unknown", "check it yourself"),
        Some(free) if free < ROOM => {
            let said = format!("{} MB are free", free >> 20);
            Finding::not(what, State::Missing, said, "delete old runs; `blocksim runs` lists them")
        }
        Some(free) => Finding::well(what, format!("{} GB are free", free >> 30)),
    }
}

fn browser() -> Finding {
    let what = "browser";
    let path = std::env::var_os("PATH").unwrap_or_default();
    let found =
        BROWSERS.into_iter().find(|name| std::env::split_paths(&path).any(|dir| dir.join(name).is_file()));
    match found {
        Some(name) => Finding::well(what, name),
        None if cfg!(windows) => Finding::well(what, "comes with the system"),
        None => Finding::not(
            what,
            State::Note,
            "none was found here",
            "open `report.html` on another computer: it is one file and needs nothing else",
        ),
    }
}

/// Crates of plug-ins, and folders with sources of one in C or C++, in this folder and in `plugins`.
fn plugins(folder: &Path) -> Vec<Finding> {
    let mut crates = Vec::new();
    for parent in [folder.to_owned(), folder.join("plugins")] {
        let entries = fs::read_dir(&parent).into_iter().flatten().flatten().map(|entry| entry.path());
        let mut found: Vec<PathBuf> = entries.filter(|path| is_plugin(path)).collect();
        found.sort();
        crates.extend(found);
    }
    crates.iter().map(|path| if is_crate(path) { plugin(path) } else { plugin_in_c(path) }).collect()
}

fn is_plugin(folder: &Path) -> bool {
    is_crate(folder) || is_in_c(folder)
}

fn is_crate(folder: &Path) -> bool {
    limited_text(&folder.join("Cargo.toml"), MOST_TEXT)
        .is_ok_and(|text| text.contains("blocksim-controller") && text.contains("cdylib"))
}

/// Whether a folder holds a source in C or C++ that names the header of plug-ins.
fn is_in_c(folder: &Path) -> bool {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut sources = entries.filter(|path| {
        let ending = path.extension().and_then(|ending| ending.to_str());
        ending.is_some_and(|ending| ["c", "cpp", "cc", "cxx"].contains(&ending))
    });
    sources.any(|path| limited_text(&path, MOST_TEXT).is_ok_and(|text| text.contains("blocksim_plugin.h")))
}

fn plugin_in_c(folder: &Path) -> Finding {
    let target = folder.join("target");
    let libraries = fs::read_dir(target.join("blocksim")).into_iter().flatten().flatten();
    let is_library = |path: &PathBuf| path.to_string_lossy().ends_with(std::env::consts::DLL_SUFFIX);
    let libraries = libraries.map(|entry| entry.path()).filter(is_library);
    let built = libraries.filter_map(|path| modified(&path)).max();
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let sources = entries.filter(|path| *path != target);
    let source = sources.filter_map(|path| if path.is_dir() { newest(&path) } else { modified(&path) }).max();
    state_of(folder, built, source)
}

fn plugin(folder: &Path) -> Finding {
    let name = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let file =
        format!("{}{}{}", std::env::consts::DLL_PREFIX, name.replace('-', "_"), std::env::consts::DLL_SUFFIX);
    let named = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    // A crate of a workspace is built into the folder of that.
    let targets = named.into_iter().chain(folder.ancestors().map(|above| above.join("target")));
    let above = std::env::current_dir().unwrap_or_default();
    let targets = targets.chain(above.ancestors().map(|above| above.join("target")));
    let built = targets.map(|target| target.join("release").join(&file)).find_map(|path| modified(&path));
    state_of(folder, built, newest(&folder.join("src")).max(modified(&folder.join("Cargo.toml"))))
}

/// How the library of a plug-in and its newest source stand to each other.
fn state_of(folder: &Path, built: Option<SystemTime>, source: Option<SystemTime>) -> Finding {
    let what = "plug-in";
    let shown = folder.strip_prefix(".").unwrap_or(folder).display().to_string();
    let remedy =
        format!("the next run builds it; `blocksim plugin show {}` does so now", quoted_text(&shown));
    match (built, source) {
        (None, _) => Finding::not(what, State::Note, format!("{shown} is not built yet"), remedy),
        (Some(built), Some(source)) if built < source => {
            Finding::not(what, State::Note, format!("{shown} is older than its source"), remedy)
        }
        _ => Finding::well(what, format!("{shown} is built")),
    }
}

fn modified(path: &Path) -> Option<SystemTime> {
    fs::metadata(path).and_then(|about| about.modified()).ok()
}

/// When a file of a folder was written last; of folders below it, too.
fn newest(folder: &Path) -> Option<SystemTime> {
    let mut newest = None;
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            match entry.file_type() {
                Ok(kind) if kind.is_dir() => folders.push(entry.path()),
                _ => newest = newest.max(modified(&entry.path())),
            }
        }
    }
    newest
}
