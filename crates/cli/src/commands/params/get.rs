use std::io;

use blocksim_diagram::{Found, Sources, Target, below, find, targets};

use super::told::{data, rows, unknown};
use crate::args::model::Format;
use crate::args::params::GetArgs;
use crate::commands::tell;
use crate::disk::{Disk, refusal};
use crate::exit::Exit;
use crate::terminal::console::Console;

/// Tells what a parameter is worth and where that is written; of a set or a block all that it holds.
pub fn get(args: &GetArgs, console: Console) -> io::Result<Exit> {
    if let Some(refusal) = refusal(&args.model) {
        console.say(&refusal);
        return Ok(Exit::Files);
    }
    crate::loaded::tell_builds();
    let disk = Disk::default();
    let sources = Sources::new(&disk);
    let (all, problems) = targets(&sources, &args.model);
    let files = sources.all();
    let found: Vec<&Target> = match find(&all, &args.target) {
        Found::One(one) => [vec![one], below(&all, &args.target)].concat(),
        Found::Several(several) => several,
        Found::Nothing(help) => {
            tell(&problems, &files, Format::Full, console)?;
            return Ok(unknown(&args.model, &args.target, &help, console));
        }
    };
    if args.json {
        console.data(&found.iter().map(|target| data(target, &files)).collect::<String>())?;
    } else {
        console.data(&rows(&found, &files, found.len() > 1))?;
    }
    Ok(Exit::Done)
}
