//! `blocksim trust`: whose plug-ins are built and loaded to look at a model.

use std::path::{Path, PathBuf};

use serde_json::json;

use crate::args::trust::TrustArgs;
use crate::disk::reason;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::terminal::console::Console;
use crate::trust::TrustList;

/// Adds folders to what is trusted, removes them, or lists all.
///
/// # Errors
/// A folder that does not exist or is not on the list; a list that cannot be read or written.
pub fn trust(args: &TrustArgs, console: Console) -> Outcome {
    for folder in &args.folders {
        match args.remove {
            true => remove(folder, console)?,
            false => add(folder, console)?,
        }
    }
    if args.list || args.folders.is_empty() {
        list(args, console)?;
    }
    Ok(Exit::Done)
}

fn add(folder: &Path, console: Console) -> Result<(), Failure> {
    let path = folder.canonicalize().map_err(|error| {
        Failure::unreadable(format!("cannot trust `{}`: {}", folder.display(), reason(&error)))
            .help("name a folder with diagrams or plug-ins, or a library")
    })?;
    let said = match TrustList::add(&path).map_err(|reason| unlisted(&reason))? {
        true => "trusted from now on",
        false => "trusted already",
    };
    console.say(&format!("`{}` is {said}", path.display()));
    Ok(())
}

fn remove(folder: &Path, console: Console) -> Result<(), Failure> {
    // A folder that is gone stands in the list as it was.
    let path =
        folder.canonicalize().or_else(|_| std::path::absolute(folder)).unwrap_or_else(|_| folder.into());
    if !TrustList::remove(&path).map_err(|reason| unlisted(&reason))? {
        let said = format!("`{}` is not in the list of what is trusted", path.display());
        return Err(Failure::usage(said).help("`blocksim trust` shows the list"));
    }
    let rest = TrustList::read().map_err(|reason| unlisted(&reason))?;
    let above: Option<&PathBuf> = rest.entries.iter().find(|entry| path.starts_with(entry));
    console.say(&match above {
        Some(above) => format!(
            "`{}` is removed, but it is below `{}`, which is trusted",
            path.display(),
            above.display()
        ),
        None => format!("`{}` is trusted no longer", path.display()),
    });
    Ok(())
}

fn list(args: &TrustArgs, console: Console) -> Result<(), Failure> {
    let list = TrustList::read().map_err(|reason| unlisted(&reason))?;
    let line = |entry: &PathBuf| match args.json {
        true => format!("{}\n", json!({ "v": 1, "type": "trusted", "path": entry.to_string_lossy() })),
        false => format!("{}\n", entry.display()),
    };
    console.data(&list.entries.iter().map(line).collect::<String>())?;
    if list.entries.is_empty() && !args.json {
        console.say("nothing is trusted: plug-ins are loaded by commands that run a model alone");
    }
    Ok(())
}

fn unlisted(reason: &str) -> Failure {
    Failure::unwritable(format!("cannot use the list of what is trusted: {reason}"))
        .help("correct the file or remove it; BLOCKSIM_HOME names another folder for it")
}
