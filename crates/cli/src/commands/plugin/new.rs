//! `blocksim plugin new`: the sources of a controller.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use blocksim_block::shell::quoted;

use crate::args::plugin::{Language, PluginNewArgs};
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::loaded::with_slashes;
use crate::terminal::console::Console;
use crate::trust::note_trust;

/// Names in the template, which are replaced.
const NAME: &str = "my_controller";
const KIND: &str = "MyController";
const PATH: &str = "PATH_OF_CONTROLLER";

/// A diagram that runs the controller.
pub const DEMO: &str = "demo.ron";
/// It names the source of a crate.
const DEMO_TEXT: &str = include_str!("template/demo.ron");
const CRATE_SOURCE: &str = "src/lib.rs";

/// The file that holds the law.
pub fn source(language: Language) -> &'static str {
    match language {
        Language::Rust => CRATE_SOURCE,
        Language::C => "controller.c",
        Language::Cpp => "controller.cpp",
    }
}

/// The files of a plug-in.
fn files(language: Language) -> Vec<(&'static str, &'static str)> {
    let text = match language {
        Language::Rust => include_str!("template/controller.rs"),
        Language::C => include_str!("template/controller.c"),
        Language::Cpp => include_str!("template/controller.cpp"),
    };
    let mut files = vec![(source(language), text), (DEMO, DEMO_TEXT)];
    match language {
        Language::Rust => files.push(("Cargo.toml", include_str!("template/manifest.toml"))),
        Language::C | Language::Cpp => files.push((".gitignore", "target/\n")),
    }
    files
}

/// Makes the sources of a controller, with a diagram that runs it.
///
/// # Errors
/// If it cannot be made.
pub fn new(args: &PluginNewArgs, console: Console) -> Outcome {
    let kind = make(args)?;
    let (folder, demo) = (args.folder.display(), quoted(&args.folder.join(DEMO)));
    console.data(&format!(
        "{folder}\n  {:14} the controller `{kind}`: write your law here\n  {:14} a loop with it: \
         blocksim run {demo}\n",
        source(args.language),
        DEMO
    ))?;
    Ok(Exit::Done)
}

/// The same without a word; gives the name of the controller.
///
/// # Errors
/// If it cannot be made.
pub fn make(args: &PluginNewArgs) -> Result<String, Failure> {
    let (name, kind) = names(args)?;
    made(args, &name, &kind)?;
    // What this program has written is the user's own.
    if let Ok(path) = args.folder.canonicalize() {
        note_trust(&path);
    }
    Ok(kind)
}

/// Name of the plug-in and of the controller.
fn names(args: &PluginNewArgs) -> Result<(String, String), Failure> {
    let name = args.folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let is_name = name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || "_-".contains(c))
        // Crates of the project, on which the new one depends.
        && !name.replace('_', "-").starts_with("blocksim-");
    if !is_name {
        let help = format!(
            "name a folder with small letters, digits and `_` that does not begin with `blocksim`, such as plugins/{NAME}"
        );
        return Err(Failure::usage(format!("`{name}` is not a valid name for a plug-in")).help(help));
    }
    let kind = args.kind.clone().unwrap_or_else(|| capitals(&name));
    let is_kind =
        kind.starts_with(|c: char| c.is_ascii_uppercase()) && kind.chars().all(|c| c.is_ascii_alphanumeric());
    if !is_kind {
        let said = format!("`{kind}` is not a valid name for a controller");
        return Err(Failure::usage(said).help(format!("write capitals, such as --kind {KIND}")));
    }
    Ok((name, kind))
}

/// `MyController` of `my_controller`.
fn capitals(name: &str) -> String {
    name.split(['_', '-'])
        .flat_map(|word| {
            let mut letters = word.chars();
            letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect::<Vec<_>>()
        })
        .collect()
}

/// Writes the sources, whole or not at all.
pub fn made(args: &PluginNewArgs, name: &str, kind: &str) -> Result<(), Failure> {
    let folder = &args.folder;
    let failed = |what: &str, error: &io::Error| {
        Failure::unwritable(format!("cannot {what} `{}`: {error}", folder.display()))
            .help("name a folder elsewhere")
    };
    if fs::read_dir(folder).map_or(folder.exists(), |mut entries| entries.next().is_some()) {
        let said = format!("`{}` already exists", folder.display());
        return Err(Failure::new(Exit::Files, "exists", said).help("name a new folder; nothing was changed"));
    }
    let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(parent).map_err(|error| failed("make", &error))?;
    let parent = parent.canonicalize().map_err(|error| failed("make", &error))?;
    let clone = if args.language == Language::Rust { Some(clone(args, &parent)?) } else { None };
    let is_member = clone.as_ref().is_some_and(|clone| parent == clone.join("plugins"));
    let above = if is_member { Some(PathBuf::from("../..")) } else { clone.clone() };
    let controller = above.map_or_else(String::new, |above| with_slashes(&above.join("crates/controller")));

    let partial = parent.join(format!(".{name}.{}", std::process::id()));
    let write = || -> io::Result<()> {
        fs::create_dir_all(&partial)?;
        if args.language == Language::Rust {
            fs::create_dir(partial.join("src"))?;
        }
        for (file, text) in files(args.language) {
            let text = text.replace(NAME, name).replace(KIND, kind).replace(PATH, &controller);
            let text = if file == DEMO { text.replace(CRATE_SOURCE, source(args.language)) } else { text };
            // Elsewhere than among the plug-ins of the clone the crate stands alone.
            let alone = if file == "Cargo.toml" && !is_member { "\n[workspace]\n" } else { "" };
            fs::write(partial.join(file), format!("{text}{alone}"))?;
        }
        if let Some(clone) = &clone
            && !is_member
        {
            // The versions that this blocksim was built with, which are on the disk already.
            fs::copy(clone.join("Cargo.lock"), partial.join("Cargo.lock"))?;
        }
        // An empty folder may stand there.
        let _ = fs::remove_dir(folder);
        fs::rename(&partial, folder)
    };
    write().map_err(|error| {
        let _ = fs::remove_dir_all(&partial);
        failed("write", &error)
    })
}

/// The clone of blocksim that the crate is built against.
fn clone(args: &PluginNewArgs, parent: &Path) -> Result<PathBuf, Failure> {
    let is_clone = |folder: &Path| folder.join("crates/controller/Cargo.toml").is_file();
    if let Some(named) = &args.blocksim {
        return match named.canonicalize() {
            Ok(named) if is_clone(&named) => Ok(named),
            _ => Err(Failure::usage(format!(
                "`{}` is not a clone of blocksim: it has no crates/controller",
                named.display()
            ))
            .help("name the folder that holds `crates` and `plugins`")),
        };
    }
    let built = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize();
    let around = parent.ancestors().map(Path::to_owned).chain(built).find(|folder| is_clone(folder));
    around.ok_or_else(|| {
        Failure::usage("the clone of blocksim that this program was built from is gone")
            .help("give its folder: --blocksim DIR")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn args(folder: &str, kind: Option<&str>) -> PluginNewArgs {
        PluginNewArgs {
            folder: folder.into(),
            kind: kind.map(str::to_owned),
            language: Language::Rust,
            blocksim: None,
        }
    }

    #[test]
    fn names_follow_from_the_folder() {
        let of = |folder, kind| names(&args(folder, kind)).unwrap();
        assert_eq!(of("a/low_pass2", None), ("low_pass2".into(), "LowPass2".into()));
        assert_eq!(of("pi-speed", Some("Speed")), ("pi-speed".into(), "Speed".into()));
        for (folder, kind) in [
            ("a/..", None),
            ("2nd", None),
            ("a b", None),
            ("blocksim-controller", None),
            ("ok", Some("low")),
            ("ok", Some("A-b")),
        ] {
            assert!(names(&args(folder, kind)).is_err(), "{folder} {kind:?}");
        }
    }
}
