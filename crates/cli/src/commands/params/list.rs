use std::io;

use blocksim_diagram::{Origin, Sources, Target, targets};

use super::told::{data, rows};
use crate::args::model::Format;
use crate::args::params::ListArgs;
use crate::commands::tell;
use crate::disk::{Disk, refusal};
use crate::exit::Exit;
use crate::terminal::console::Console;
use crate::terminal::render::errors;

/// Lists what `--set` can name.
pub fn list(args: &ListArgs, console: Console) -> io::Result<Exit> {
    if let Some(refusal) = refusal(&args.model) {
        console.say(&refusal);
        return Ok(Exit::Files);
    }
    crate::loaded::tell_builds();
    let disk = Disk::default();
    let sources = Sources::new(&disk);
    let (all, problems) = targets(&sources, &args.model);
    let files = sources.all();
    tell(&problems, &files, Format::Full, console)?;
    let is_wanted = |target: &&Target| {
        let fits = args.pattern.as_ref().is_none_or(|pattern| target.name.contains(pattern.as_str()));
        let is_shown = args.all || !matches!(target.origin, Origin::Kind(_));
        fits && is_shown && !target.is_item
    };
    let wanted: Vec<&Target> = all.iter().filter(is_wanted).collect();
    if args.json {
        console.data(&wanted.iter().map(|target| data(target, &files)).collect::<String>())?;
    } else if let (true, Some(pattern)) = (wanted.is_empty(), &args.pattern) {
        console.say(&format!(
            "error: no parameter has `{pattern}` in its name\n  = help: `blocksim params list {}` lists all",
            args.model.display()
        ));
        return Ok(Exit::Usage);
    } else {
        console.data(&rows(&wanted, &files, true))?;
    }
    Ok(if errors(&problems) > 0 { Exit::Model } else { Exit::Done })
}
