//! `blocksim edit`: what somebody does to a picture, done to the text that it is drawn from.

use std::path::Path;

use blocksim_edit::{Change, NewBlock, Project, Refusal, add, connect, delete, disconnect_end, rename, wrap};

use crate::args::edit::{AddArgs, EditCommand, EditOptions};
use crate::disk::readable;
use crate::editing::{failure, with_project, write};
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::loaded::tell_builds;
use crate::terminal::console::Console;
use crate::terminal::diff::difference;

/// Changes a model.
///
/// # Errors
/// What cannot be read or written, and what is against the change.
pub fn edit(command: &EditCommand, console: Console) -> Outcome {
    match command {
        EditCommand::Rename(args) => {
            done(&args.model, &args.options, console, |project| rename(project, &args.name, &args.new))
        }
        EditCommand::Delete(args) => {
            done(&args.model, &args.options, console, |project| delete(project, &args.blocks))
        }
        EditCommand::Connect(args) => {
            done(&args.model, &args.options, console, |project| connect(project, &args.from, &args.to))
        }
        EditCommand::Disconnect(args) => {
            done(&args.model, &args.options, console, |project| disconnect_end(project, &args.port))
        }
        EditCommand::Add(args) => added(args, console),
        EditCommand::Wrap(args) => {
            let name = args.name.as_deref().unwrap_or_default();
            done(&args.model, &args.options, console, |project| wrap(project, &args.blocks, name))
        }
    }
}

/// Adds a block at the level that its places are of.
fn added(args: &AddArgs, console: Console) -> Outcome {
    let mut parameters = Vec::new();
    for text in &args.with {
        let Some((name, value)) = text.split_once('=') else {
            return Err(Failure::usage(format!("`{text}` is not a parameter with its value"))
                .help("write `--with k=0.5` or `--with \"tau=5 ms\"`"));
        };
        parameters.push((name.trim().to_owned(), value.trim().to_owned()));
    }
    // Ends and neighbours are named from the top, as everywhere.
    let level_of = |path: &str| {
        let blocks = &path[..path.find('.').unwrap_or(path.len())];
        blocks.rfind('/').map(|slash| path[..slash].to_owned())
    };
    let places = args.into.iter().chain(&args.beside);
    let level =
        args.level.clone().or_else(|| places.clone().find_map(|path| level_of(path))).unwrap_or_default();
    let relative = |path: &String| {
        path.strip_prefix(level.as_str()).and_then(|rest| rest.strip_prefix('/')).unwrap_or(path).to_owned()
    };
    let into: Vec<String> = args.into.iter().map(relative).collect();
    let beside = args.beside.as_ref().map(relative).unwrap_or_default();
    let new = NewBlock {
        level: &level,
        kind: &args.kind,
        name: args.name.as_deref().unwrap_or_default(),
        parameters: &parameters,
        beside: &beside,
        into: &into,
    };
    done(&args.model, &args.options, console, |project| add(project, &new))
}

fn done(
    model: &Path,
    options: &EditOptions,
    console: Console,
    what: impl FnOnce(&Project) -> Result<Change, Refusal>,
) -> Outcome {
    readable(model)?;
    tell_builds();
    let change = with_project(model, None, options.all, what).map_err(|refusal| {
        let note = refusal.is_shared.then_some("--all changes it for all of them");
        let failure = note.into_iter().fold(failure(refusal), Failure::note);
        failure.last("nothing was written")
    })?;
    for text in &change.texts {
        console.data(&difference(&text.path, text.old.as_deref().unwrap_or_default(), &text.new))?;
    }
    if change.texts.is_empty() {
        console.data(&format!("{}\n", change.summary))?;
        return Ok(Exit::Done);
    }
    if options.dry_run {
        console.say("nothing was written");
    } else {
        write(&change.texts)?;
        console.say(&change.summary);
    }
    change.notes.iter().for_each(|note| console.say(&format!("  = note: {note}")));
    Ok(Exit::Done)
}
