//! Builds the crate of a plug-in. Cargo is asked unless every file that it read at the last build is as it was then
//! (`fresh.rs`); without cargo a library that was built before is used.

use std::ffi::{OsStr, OsString};
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::SystemTime;

use blocksim_block::shell::quoted_text;

use super::text::text;
use super::{Answer, SHOWN_LINES, crate_files, fresh, notify};
use crate::fault::{self, BUILD, MISSING};
use crate::locate::Target;

/// What modules are built for.
const WASM: &str = "wasm32-unknown-unknown";
/// What cargo and the compiler say where they have not got it.
const NO_TARGET: &str = "target may not be installed";

/// The cargo that is asked.
pub fn program() -> OsString {
    std::env::var_os("CARGO").unwrap_or_else(|| OsString::from("cargo"))
}

/// The library of the crate in `folder`, or the module if that is the target, as this cargo builds it.
pub fn built(cargo: &OsStr, folder: &Path, named: &str, target: Target) -> Answer {
    let recipe = crate_files::variables(std::env::vars_os());
    if let Some(library) = built_before(folder, target).filter(|library| fresh::is_fresh(library, &recipe)) {
        return Ok(library);
    }
    let (asked, manifest) = (SystemTime::now(), folder.join("Cargo.toml"));
    let (verb, behind): (&[&str], &[&str]) = match target {
        Target::Native => (&["build"], &[]),
        // Without its table nobody could call the functions of a module.
        Target::Wasm => (
            &["rustc", "--lib", "--target", WASM],
            &["--", "--crate-type", "cdylib", "-C", "link-arg=--export-table"],
        ),
    };
    let child = Command::new(cargo)
        .args(verb)
        .args(["--release", "--color=never", "--message-format=json-render-diagnostics"])
        .arg("--manifest-path")
        .arg(&manifest)
        .args(behind)
        // Where cargo looks for its settings and for the toolchain of the crate.
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let answer = match child {
        Ok(child) => match finished(child, named) {
            Ok(built) => library_of(&built, &manifest, named, target),
            Err(e) => Err(fault::library(BUILD, format!("cargo could not build `{named}`: {e}"))),
        },
        Err(e) => return without_cargo(folder, named, target, &e),
    };
    if let Ok(library) = &answer
        && let Some(files) = crate_files::read(folder, library)
    {
        fresh::remember(library, &recipe, &files, asked);
    }
    answer
}

/// What cargo did and said.
struct Built {
    status: ExitStatus,
    /// Messages for programs.
    messages: String,
    /// Warnings and errors for people, without what cargo did and when.
    said: Vec<String>,
}

/// Waits for cargo, and passes on what people wait for.
fn finished(mut child: Child, named: &str) -> std::io::Result<Built> {
    // Both are read at once: cargo would wait for whoever reads the other one.
    let stdout = child.stdout.take();
    let messages = std::thread::spawn(move || {
        let mut text = String::new();
        stdout.map_or(Ok(0), |mut stdout| stdout.read_to_string(&mut text)).map(|_| text)
    });
    let mut said = Vec::new();
    let mut noticed = Vec::new();
    for line in child.stderr.take().into_iter().flat_map(|stderr| BufReader::new(stderr).split(b'\n')) {
        let line = String::from_utf8_lossy(&line?).trim_end().to_owned();
        let notice = match progress(&line) {
            None => {
                said.push(line);
                continue;
            }
            Some("Compiling") => format!("building the plug-in `{named}` with cargo"),
            Some("Blocking") => format!("waiting for another cargo before the plug-in `{named}` is built"),
            Some(_) => continue,
        };
        if !noticed.contains(&notice) {
            notify(&notice);
            noticed.push(notice);
        }
    }
    let messages = messages.join().unwrap_or_else(|_| Ok(String::new()))?;
    Ok(Built { status: child.wait()?, messages, said })
}

/// The verb of a line in which cargo reports its progress: right-aligned in twelve columns.
fn progress(line: &str) -> Option<&'static str> {
    const VERBS: [&str; 9] = [
        "Compiling",
        "Finished",
        "Blocking",
        "Updating",
        "Locking",
        "Adding",
        "Downloading",
        "Downloaded",
        "Building",
    ];
    VERBS
        .into_iter()
        .find(|verb| line.strip_prefix(&format!("{verb:>12}")).is_some_and(|rest| rest.starts_with(' ')))
}

/// Finds the library in what cargo reported.
fn library_of(built: &Built, manifest: &Path, named: &str, target: Target) -> Answer {
    if !built.status.success()
        && target == Target::Wasm
        && built.said.iter().any(|line| line.contains(NO_TARGET))
    {
        let message =
            format!("the plug-in `{named}` cannot be built as a module: this Rust has no target `{WASM}`");
        let help = format!("install it with `rustup target add {WASM}`, or leave out `target: Wasm`");
        return Err(fault::help(fault::library(BUILD, message), help));
    }
    if !built.status.success() {
        let said = last_lines(&built.said.join("\n"));
        let error = fault::library(BUILD, format!("the plug-in `{named}` does not build:\n{said}"));
        let shown = quoted_text(&fault::shown(manifest));
        let options = if target == Target::Wasm { format!(" --target {WASM}") } else { String::new() };
        return Err(fault::help(
            error,
            format!("see `cargo build --release{options} --manifest-path {shown}`"),
        ));
    }
    built.messages.lines().find_map(|line| cdylib(line, manifest, target)).ok_or_else(|| {
        let error =
            fault::library(BUILD, format!("the crate `{named}` builds no library that can be loaded"));
        fault::help(error, "write `[lib]` and `crate-type = [\"cdylib\", \"rlib\"]` into its `Cargo.toml`")
    })
}

/// The file of a cargo message that says: this crate has become this dynamic library.
fn cdylib(line: &str, manifest: &Path, target: Target) -> Option<PathBuf> {
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
    files.map(PathBuf::from).find(|file| file.to_string_lossy().ends_with(affixes(target).1))
}

fn last_lines(text: &str) -> String {
    let lines: Vec<&str> = text.trim_end().lines().collect();
    let cut = lines.len().saturating_sub(SHOWN_LINES);
    let shown = lines[cut..].join("\n");
    if cut > 0 { format!("...\n{shown}") } else { shown }
}

/// What was built before.
fn without_cargo(folder: &Path, named: &str, target: Target, e: &std::io::Error) -> Answer {
    built_before(folder, target).ok_or_else(|| {
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

/// What stands before and behind the name of a library.
fn affixes(target: Target) -> (&'static str, &'static str) {
    match target {
        Target::Native => (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX),
        Target::Wasm => ("", ".wasm"),
    }
}

/// The library of a crate where cargo would have put it, if it is there.
fn built_before(folder: &Path, target: Target) -> Option<PathBuf> {
    let name = library_name(&text(&folder.join("Cargo.toml")).ok()?)?;
    let (prefix, suffix) = affixes(target);
    let file = format!("{prefix}{name}{suffix}");
    let of = if target == Target::Wasm { WASM } else { "" };
    let named = std::env::var_os("CARGO_TARGET_DIR").map(|target| folder.join(target));
    let targets = named.into_iter().chain(folder.ancestors().map(|folder| folder.join("target")));
    targets.map(|target| target.join(of).join("release").join(&file)).find(|library| library.is_file())
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

        let error = built(nowhere, &folder, "here", Target::Native).unwrap_err();
        assert_eq!(error.code, MISSING);
        assert!(error.message.starts_with("the plug-in `here` is not built, and cargo cannot be run"));

        let name = format!("{}no_cargo_here{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
        std::fs::write(release.join(&name), "").unwrap();
        assert_eq!(built(nowhere, &folder, "here", Target::Native), Ok(release.join(&name)));
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
            std::fs::read(built(&program(), &folder, "edited", Target::Native).unwrap()).unwrap()
        };
        assert!(library(41) != library(42));
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn who_waits_is_told_and_what_cargo_says_is_shown() {
        use std::os::unix::fs::PermissionsExt;
        static TOLD: std::sync::Mutex<Vec<String>> = std::sync::Mutex::new(Vec::new());
        let folder = std::env::temp_dir().join(format!("blocksim-slow-cargo-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (text, slow) = (folder.join("text"), folder.join("cargo"));
        std::fs::write(
            &text,
            "#!/bin/sh\necho '   Compiling slow v0.1.0' >&2\necho 'error: no space left' >&2\nexit 101\n",
        )
        .unwrap();
        std::fs::set_permissions(&text, std::fs::Permissions::from_mode(0o755)).unwrap();
        // A file that this process has written is busy while another test starts a program.
        assert!(Command::new("cp").arg(&text).arg(&slow).status().unwrap().success());

        // Other tests build plug-ins at the same time.
        crate::set_build_notice(|text| {
            TOLD.lock().unwrap().extend(text.contains("`slow`").then(|| text.to_owned()));
        });
        let error = built(slow.as_os_str(), &folder, "slow", Target::Native).unwrap_err();
        assert_eq!(error.message, "the plug-in `slow` does not build:\nerror: no space left");
        assert_eq!(*TOLD.lock().unwrap(), ["building the plug-in `slow` with cargo"]);
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_target_that_rust_has_not_got_is_named_with_the_line_that_installs_it() {
        use std::os::unix::fs::PermissionsExt;
        let folder = std::env::temp_dir().join(format!("blocksim-no-target-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (text, poor) = (folder.join("text"), folder.join("cargo"));
        // What cargo 1.88 prints.
        let said = "error[E0463]: can't find crate for `core`\n  |\n  \
                    = note: the `wasm32-unknown-unknown` target may not be installed\n";
        std::fs::write(&text, format!("#!/bin/sh\ncat >&2 <<'END'\n{said}END\nexit 101\n")).unwrap();
        std::fs::set_permissions(&text, std::fs::Permissions::from_mode(0o755)).unwrap();
        assert!(Command::new("cp").arg(&text).arg(&poor).status().unwrap().success());
        let error = built(poor.as_os_str(), &folder, "law", Target::Wasm).unwrap_err();
        assert_eq!(
            error.message,
            "the plug-in `law` cannot be built as a module: this Rust has no target `wasm32-unknown-unknown`"
        );
        let help = "install it with `rustup target add wasm32-unknown-unknown`, or leave out `target: Wasm`";
        assert_eq!(error.help.as_deref(), Some(help));
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn only_lines_of_progress_are_left_out_of_errors() {
        assert_eq!(progress("   Compiling low-pass v0.1.0 (/a)"), Some("Compiling"));
        assert_eq!(progress("    Blocking waiting for file lock on build directory"), Some("Blocking"));
        for line in ["error: could not compile `a`", "  --> src/lib.rs:1:1", "   Compilingx", "Compiling a"] {
            assert_eq!(progress(line), None, "{line}");
        }
    }

    #[test]
    fn long_errors_are_cut_at_the_front() {
        let text: String = (0..30).map(|i| format!("{i}\n")).collect();
        let shown = last_lines(&text);
        assert!(shown.starts_with("...\n10\n11") && shown.ends_with("\n29"), "{shown}");
        assert_eq!(last_lines("one\ntwo\n"), "one\ntwo");
    }
}
