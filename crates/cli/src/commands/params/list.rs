use blocksim_block::shell::quoted;
use blocksim_diagram::{Origin, Sources, Target, targets};

use super::table::{data, rows};
use crate::args::params::ListArgs;
use crate::commands::tell;
use crate::disk::{Disk, readable};
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::terminal::console::Console;
use crate::terminal::places::Texts;
use crate::terminal::render::errors;
use crate::trust::is_about_trust;

/// Lists what `--set` can name.
pub fn list(args: &ListArgs, console: Console) -> Outcome {
    readable(&args.model)?;
    let disk = Disk::default();
    let sources = Sources::new(&disk);
    let (all, mut problems) = targets(&sources, &args.model);
    // No plug-in is needed to read values.
    problems.retain(|problem| !is_about_trust(problem));
    let files = sources.all();
    tell(&problems, &files, console)?;
    let is_wanted = |target: &&Target| {
        let fits = args.pattern.as_ref().is_none_or(|pattern| target.name.contains(pattern.as_str()));
        let is_shown = args.all || !matches!(target.origin, Origin::Kind(_));
        fits && is_shown && !target.is_item
    };
    let wanted: Vec<&Target> = all.iter().filter(is_wanted).collect();
    if let (true, Some(pattern)) = (wanted.is_empty(), &args.pattern) {
        return Err(Failure::usage(format!("no parameter has `{pattern}` in its name"))
            .help(format!("`blocksim params list {}` lists all", quoted(&args.model))));
    }
    let texts = Texts::of(&files);
    console.data(&match args.json {
        true => wanted.iter().map(|target| data(target, &texts)).collect(),
        false => rows(&wanted, &texts, true),
    })?;
    Ok(if errors(&problems) > 0 { Exit::Model } else { Exit::Done })
}
