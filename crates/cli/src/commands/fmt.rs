use std::io::{self, Read};
use std::path::{Path, PathBuf};

use blocksim_block::problem::FileId;
use blocksim_diagram::{Reader, SourceFile, not_ron};
use blocksim_syntax::{SyntaxError, format};

use crate::args::fmt::FmtArgs;
use crate::disk::{Disk, readable, reason, text_files, write_file};
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::terminal::console::Console;
use crate::terminal::diff::difference;
use crate::terminal::render::plural;

/// Lays files out, or shows what would change.
///
/// # Errors
/// If there is nothing to lay out, or a file cannot be written.
pub fn fmt(args: &FmtArgs, console: Console) -> Outcome {
    if args.stdin {
        return standard_input(console);
    }
    let mut found = Vec::new();
    for named in &args.files {
        found.extend(files(named)?);
    }
    found.sort();
    found.dedup();
    let mut exit = Exit::Done;
    let (mut changed, mut broken) = (0, 0);
    for path in &found {
        let text = match Disk::default().read(path) {
            Ok(text) => text,
            Err(reason) => {
                exit =
                    Failure::unreadable(format!("cannot read `{}`: {reason}", path.display())).tell(console);
                continue;
            }
        };
        let formatted = match format(&text) {
            Ok(formatted) => formatted,
            Err(error) => {
                no_ron(error, path, &text).tell(console);
                broken += 1;
                continue;
            }
        };
        if formatted == text {
            continue;
        }
        changed += 1;
        if args.check {
            console.data(&difference(path, &text, &formatted))?;
        } else {
            write_file(path, formatted.as_bytes(), true)?;
            console.data(&format!("{}\n", path.display()))?;
        }
    }
    let verb = if args.check { "would change" } else { "changed" };
    let left = if broken > 0 { format!(", {broken} left because of errors") } else { String::new() };
    console.say(&format!("{}: {changed} {verb}{left}", plural(found.len(), "file")));
    Ok(match exit {
        Exit::Done if broken > 0 => Exit::Model,
        Exit::Done if args.check && changed > 0 => Exit::Failed,
        exit => exit,
    })
}

/// What is meant by a name: the file, or the texts of a folder.
fn files(named: &Path) -> Result<Vec<PathBuf>, Failure> {
    if !named.is_dir() {
        return readable(named).map(|()| vec![named.to_owned()]);
    }
    match text_files(named) {
        Ok(files) if files.is_empty() => {
            let said = format!("`{}` holds no .ron file", named.display());
            Err(Failure::unreadable(said).help("name the folder of a model, or a file"))
        }
        Ok(files) => Ok(files),
        Err(error) => {
            Err(Failure::unreadable(format!("cannot read `{}`: {}", named.display(), reason(&error))))
        }
    }
}

fn standard_input(console: Console) -> Outcome {
    let mut text = String::new();
    if let Err(error) = io::stdin().lock().take(blocksim_recording::MOST_TEXT).read_to_string(&mut text) {
        return Err(Failure::unreadable(format!("cannot read the standard input: {}", reason(&error))));
    }
    match format(&text) {
        Ok(formatted) => {
            console.bytes_of(&formatted)?;
            Ok(Exit::Done)
        }
        Err(error) => Err(no_ron(error, Path::new("<stdin>"), &text)),
    }
}

/// Where a text is no RON.
fn no_ron(error: SyntaxError, path: &Path, text: &str) -> Failure {
    Failure::of(
        Exit::Model,
        vec![not_ron(error, FileId(0))],
        vec![SourceFile { path: path.to_owned(), text: text.into() }],
    )
}
