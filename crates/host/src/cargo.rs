//! Builds the crate of a plug-in. Cargo knows best whether anything changed, so it is always asked; without cargo
//! a library that was built before is used.

use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::{Arc, Mutex, PoisonError, RwLock, mpsc};
use std::time::{Duration, Instant};

use blocksim_block::LoadError;

use crate::fault::{self, BUILD, MISSING};

/// Blocks of one diagram that name one crate share an answer of cargo; a diagram that is read again later, say
/// after an edit, asks again.
const ANSWER_HOLDS: Duration = Duration::from_secs(2);
/// When a build takes longer than this, people want to know what they wait for.
const PATIENCE: Duration = Duration::from_millis(500);
/// Lines of cargo's errors that are shown.
const SHOWN_LINES: usize = 20;

type Answer = Result<PathBuf, LoadError>;
/// The last answer for one crate; locked while cargo runs.
type Slot = Arc<Mutex<Option<(Instant, Answer)>>>;

static SLOTS: Mutex<BTreeMap<PathBuf, Slot>> = Mutex::new(BTreeMap::new());
static NOTICE: RwLock<Option<fn(&str)>> = RwLock::new(None);

/// Sets who is told that a plug-in is being built, in one line, when it takes more than half a second (cargo also
/// waits while another cargo uses the same target folder). Nobody is told otherwise.
pub fn set_build_notice(notice: fn(&str)) {
    *NOTICE.write().unwrap_or_else(PoisonError::into_inner) = Some(notice);
}

/// Folders of all crates that this process has built, whether they could be built or not.
pub fn crates() -> Vec<PathBuf> {
    SLOTS.lock().unwrap_or_else(PoisonError::into_inner).keys().cloned().collect()
}

/// The library of the crate in `folder`, up to date. `named` is how the diagram calls it.
///
/// # Errors
/// The crate does not build, or builds no library; there is no cargo and no built library.
pub fn built(folder: &Path, named: &str) -> Answer {
    let slot = {
        let mut slots = SLOTS.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(slots.entry(folder.to_owned()).or_default())
    };
    let mut last = slot.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((asked, answer)) = last.as_ref()
        && asked.elapsed() < ANSWER_HOLDS
    {
        return answer.clone();
    }
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| OsString::from("cargo"));
    let answer = ask(&cargo, folder, named);
    *last = Some((Instant::now(), answer.clone()));
    answer
}

fn ask(cargo: &OsStr, folder: &Path, named: &str) -> Answer {
    let manifest = folder.join("Cargo.toml");
    let child = Command::new(cargo)
        .args(["build", "--release", "--quiet", "--color=never", "--message-format=json-render-diagnostics"])
        .arg("--manifest-path")
        .arg(&manifest)
        // Where cargo looks for its settings and for the toolchain of the crate.
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let child = match child {
        Ok(child) => child,
        Err(e) => return without_cargo(folder, named, &e),
    };
    let (send, receive) = mpsc::channel();
    std::thread::spawn(move || send.send(child.wait_with_output()));
    let output = receive.recv_timeout(PATIENCE).or_else(|_| {
        let notice = *NOTICE.read().unwrap_or_else(PoisonError::into_inner);
        if let Some(notice) = notice {
            notice(&format!("building the plug-in `{named}` with cargo"));
        }
        receive.recv()
    });
    match output {
        Ok(Ok(output)) => library_of(&output, &manifest, named),
        Ok(Err(e)) => Err(fault::library(BUILD, format!("cargo could not build `{named}`: {e}"))),
        Err(e) => Err(fault::library(BUILD, format!("cargo could not build `{named}`: {e}"))),
    }
}

/// Finds the library in what cargo reported.
fn library_of(output: &Output, manifest: &Path, named: &str) -> Answer {
    if !output.status.success() {
        let said = last_lines(&String::from_utf8_lossy(&output.stderr));
        let error = fault::library(BUILD, format!("the plug-in `{named}` does not build:\n{said}"));
        let shown = fault::shown(manifest);
        return Err(fault::help(error, format!("see `cargo build --release --manifest-path {shown}`")));
    }
    let text = String::from_utf8_lossy(&output.stdout);
    text.lines().find_map(|line| cdylib(line, manifest)).ok_or_else(|| {
        let error =
            fault::library(BUILD, format!("the crate `{named}` builds no library that can be loaded"));
        fault::help(error, "write `[lib]` and `crate-type = [\"cdylib\", \"rlib\"]` into its `Cargo.toml`")
    })
}

/// The file of a cargo message that says: this crate has become this dynamic library.
fn cdylib(line: &str, manifest: &Path) -> Option<PathBuf> {
    let message: serde_json::Value = serde_json::from_str(line).ok()?;
    if message["reason"] != "compiler-artifact" {
        return None;
    }
    let is_cdylib = message["target"]["crate_types"].as_array()?.iter().any(|kind| kind == "cdylib");
    let of = Path::new(message["manifest_path"].as_str()?).canonicalize().ok()?;
    if !is_cdylib || of != manifest {
        return None;
    }
    let files = message["filenames"].as_array()?.iter().filter_map(|file| file.as_str());
    files.map(PathBuf::from).find(|file| file.to_string_lossy().ends_with(std::env::consts::DLL_SUFFIX))
}

fn last_lines(text: &str) -> String {
    let lines: Vec<&str> = text.trim_end().lines().collect();
    let cut = lines.len().saturating_sub(SHOWN_LINES);
    let shown = lines[cut..].join("\n");
    if cut > 0 { format!("...\n{shown}") } else { shown }
}

/// What was built before, where cargo would have put it.
fn without_cargo(folder: &Path, named: &str, e: &std::io::Error) -> Answer {
    let name = library_name(&std::fs::read_to_string(folder.join("Cargo.toml")).unwrap_or_default());
    let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let file = name.map(|name| format!("{prefix}{name}{suffix}"));
    let targets = std::env::var_os("CARGO_TARGET_DIR")
        .map(|target| folder.join(target))
        .into_iter()
        .chain(folder.ancestors().map(|folder| folder.join("target")));
    let built = file.and_then(|file| {
        targets.map(|target| target.join("release").join(&file)).find(|library| library.is_file())
    });
    built.ok_or_else(|| {
        let error = fault::library(
            MISSING,
            format!("the plug-in `{named}` is not built, and cargo cannot be run: {e}"),
        );
        fault::help(
            error,
            "install Rust from https://rustup.rs, or name a built library instead of the crate",
        )
    })
}

/// The name of a crate's library: that of `[lib]`, else that of `[package]` with underscores.
fn library_name(manifest: &str) -> Option<String> {
    let name_in = |wanted: &str| {
        let mut section = "";
        manifest.lines().map(str::trim).find_map(|line| {
            if line.starts_with('[') {
                section = line;
            }
            let (key, value) = line.split_once('=')?;
            let value = value.trim().strip_prefix(['"', '\''])?.split(['"', '\'']).next()?;
            (section == wanted && key.trim() == "name").then(|| value.replace('-', "_"))
        })
    };
    name_in("[lib]").or_else(|| name_in("[package]"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_of_the_library_is_read_from_the_manifest() {
        let package =
            "[dependencies]\nname = \"no\"\n[package]\nname = \"low-pass\" # ours\nversion = \"1\"\n";
        assert_eq!(library_name(package).as_deref(), Some("low_pass"));
        let lib = format!("{package}[lib]\ncrate-type = [\"cdylib\"]\nname='filter'\n");
        assert_eq!(library_name(&lib).as_deref(), Some("filter"));
        assert_eq!(library_name("[workspace]"), None);
    }

    #[test]
    fn without_cargo_a_built_library_serves() {
        let folder = std::env::temp_dir().join(format!("blocksim-no-cargo-{}", std::process::id()));
        let release = folder.join("target/release");
        std::fs::create_dir_all(&release).unwrap();
        std::fs::write(folder.join("Cargo.toml"), "[package]\nname = \"no-cargo-here\"\n").unwrap();
        let nowhere = OsStr::new("/no/such/cargo");

        let error = ask(nowhere, &folder, "here").unwrap_err();
        assert_eq!(error.code, MISSING);
        assert!(error.message.starts_with("the plug-in `here` is not built, and cargo cannot be run"));

        let name = format!("{}no_cargo_here{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
        std::fs::write(release.join(&name), "").unwrap();
        assert_eq!(ask(nowhere, &folder, "here"), Ok(release.join(&name)));
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn an_edit_of_the_source_gives_another_library() {
        let folder = std::env::temp_dir().join(format!("blocksim-edited-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("src")).unwrap();
        let folder = folder.canonicalize().unwrap();
        let manifest = "[package]\nname = \"edited\"\nedition = \"2024\"\n[lib]\ncrate-type = [\"cdylib\"]\n[workspace]\n";
        std::fs::write(folder.join("Cargo.toml"), manifest).unwrap();
        let library = |answer: u32| {
            let code = format!("#[unsafe(no_mangle)]\npub extern \"C\" fn answer() -> u32 {{ {answer} }}\n");
            std::fs::write(folder.join("src/lib.rs"), code).unwrap();
            let cargo = std::env::var_os("CARGO").unwrap_or_else(|| OsString::from("cargo"));
            std::fs::read(ask(&cargo, &folder, "edited").unwrap()).unwrap()
        };
        assert!(library(41) != library(42));
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn who_waits_is_told_and_what_cargo_says_is_shown() {
        use std::os::unix::fs::PermissionsExt;
        static TOLD: Mutex<Vec<String>> = Mutex::new(Vec::new());
        let folder = std::env::temp_dir().join(format!("blocksim-slow-cargo-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let slow = folder.join("cargo");
        std::fs::write(&slow, "#!/bin/sh\nsleep 1\necho 'error: no space left' >&2\nexit 101\n").unwrap();
        std::fs::set_permissions(&slow, std::fs::Permissions::from_mode(0o755)).unwrap();

        // Other tests build plug-ins at the same time.
        set_build_notice(|text| {
            TOLD.lock().unwrap().extend(text.contains("`slow`").then(|| text.to_owned()));
        });
        let error = ask(slow.as_os_str(), &folder, "slow").unwrap_err();
        assert_eq!(error.message, "the plug-in `slow` does not build:\nerror: no space left");
        assert_eq!(*TOLD.lock().unwrap(), ["building the plug-in `slow` with cargo"]);
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn long_errors_are_cut_at_the_front() {
        let text: String = (0..30).map(|i| format!("{i}\n")).collect();
        let shown = last_lines(&text);
        assert!(shown.starts_with("...\n10\n11") && shown.ends_with("\n29"), "{shown}");
        assert_eq!(last_lines("one\ntwo\n"), "one\ntwo");
    }
}
