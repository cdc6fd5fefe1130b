use std::io::{self, Read};
use std::path::{Path, PathBuf};

use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_diagram::{Reader, SourceFile, SyntaxError, format};

use crate::args::fmt::FmtArgs;
use crate::disk::{Disk, reason, refusal, text_files, write_file};
use crate::exit::Exit;
use crate::terminal::console::Console;
use crate::terminal::diff::difference;
use crate::terminal::render::{full, plural};

/// Lays files out, or shows what would change.
///
/// # Errors
/// If the standard output cannot be written.
pub fn fmt(args: &FmtArgs, console: Console) -> io::Result<Exit> {
    if args.stdin {
        return standard_input(console);
    }
    let mut found = Vec::new();
    for named in &args.files {
        match files(named) {
            Ok(files) => found.extend(files),
            Err(said) => {
                console.say(&said);
                return Ok(Exit::Files);
            }
        }
    }
    found.sort();
    found.dedup();
    let mut exit = Exit::Done;
    let (mut changed, mut broken) = (0, 0);
    for path in &found {
        let text = match Disk::default().read(path) {
            Ok(text) => text,
            Err(reason) => {
                console.say(&format!("error: cannot read `{}`: {reason}", path.display()));
                exit = Exit::Files;
                continue;
            }
        };
        let formatted = match format(&text) {
            Ok(formatted) => formatted,
            Err(error) => {
                tell(&error, path, &text, console);
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
        } else if let Err(failed) = write_file(path, formatted.as_bytes(), true, console) {
            return Ok(failed);
        } else {
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
fn files(named: &Path) -> Result<Vec<PathBuf>, String> {
    if !named.is_dir() {
        return match refusal(named) {
            Some(refusal) => Err(refusal),
            None => Ok(vec![named.to_owned()]),
        };
    }
    match text_files(named) {
        Ok(files) if files.is_empty() => Err(format!(
            "error: `{}` holds no .ron file\n  = help: name the folder of a model, or a file",
            named.display()
        )),
        Ok(files) => Ok(files),
        Err(error) => Err(format!("error: cannot read `{}`: {}", named.display(), reason(&error))),
    }
}

fn standard_input(console: Console) -> io::Result<Exit> {
    let mut text = String::new();
    if let Err(error) = io::stdin().lock().take(crate::disk::LARGEST).read_to_string(&mut text) {
        console.say(&format!("error: cannot read the standard input: {}", reason(&error)));
        return Ok(Exit::Files);
    }
    match format(&text) {
        Ok(formatted) => {
            console.data(&formatted)?;
            Ok(Exit::Done)
        }
        Err(error) => {
            tell(&error, Path::new("<stdin>"), &text, console);
            Ok(Exit::Model)
        }
    }
}

/// Shows where a text is no RON.
fn tell(error: &SyntaxError, path: &Path, text: &str, console: Console) {
    let place = Place { file: FileId(0), span: error.span.clone() };
    let mut problem = Problem::error("syntax", error.message.clone()).at(&place, "");
    problem.help = error.help.clone();
    let files = [SourceFile { path: path.to_owned(), text: text.into() }];
    console.say(&format!("{}\n", full(&problem, &files, console.colour)));
}
