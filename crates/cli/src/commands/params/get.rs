use blocksim_diagram::{Found, Sources, Target, below, find, targets};

use super::table::{data, rows, unknown};
use crate::args::params::GetArgs;
use crate::commands::tell;
use crate::disk::{Disk, readable};
use crate::exit::Exit;
use crate::failure::Outcome;
use crate::terminal::console::Console;
use crate::terminal::places::Texts;
use crate::trust::is_about_trust;

/// Tells what a parameter is worth and where that is written; of a set or a block all that it holds.
pub fn get(args: &GetArgs, console: Console) -> Outcome {
    readable(&args.model)?;
    let disk = Disk::default();
    let sources = Sources::new(&disk);
    let (all, mut problems) = targets(&sources, &args.model);
    // No plug-in is needed to read values.
    problems.retain(|problem| !is_about_trust(problem));
    let files = sources.all();
    let found: Vec<&Target> = match find(&all, &args.target) {
        Found::One(one) => [vec![one], below(&all, &args.target)].concat(),
        Found::Several(several) => several,
        Found::Nothing(help) => {
            tell(&problems, &files, console)?;
            return Err(unknown(&args.model, &args.target, &help));
        }
    };
    let texts = Texts::of(&files);
    if args.json {
        console.data(&found.iter().map(|target| data(target, &texts)).collect::<String>())?;
    } else {
        console.data(&rows(&found, &texts, found.len() > 1))?;
    }
    Ok(Exit::Done)
}
