//! `blocksim collisions`: what touched in a run, and how near the rest came.

mod table;

use std::path::Path;

use blocksim_blocks::robotics::Surroundings;
use blocksim_diagram::Sources;
use blocksim_recording::{Run, locate};

use crate::args::collisions::CollisionsArgs;
use crate::args::values::RUNS;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::mechanism::recorded::{mechanism, movement, scene};
use crate::mechanism::touching::{Found, look};
use crate::mechanism::{surroundings, text};
use crate::terminal::console::Console;

/// Contacts and least distances of a run, with what the reader must know of them.
struct Looked {
    found: Found,
    /// Pairs of solids that were looked at.
    pairs: usize,
    /// Pairs of names that touch at the start and were not looked at.
    left_out: Vec<[String; 2]>,
    /// Names of meshes, which were not looked at.
    meshes: Vec<String>,
    /// First and last time that was looked at, s.
    span: [f64; 2],
}

/// Looks for contacts in a run.
///
/// # Errors
/// Why the run cannot be looked at.
pub fn collisions(args: &CollisionsArgs, console: Console) -> Outcome {
    let looked = looked(args, console)?;
    match args.json {
        true => console.data(&format!("{}\n", table::data(&looked)))?,
        false => {
            console.data(&table::text(&looked, args.all))?;
            table::notes(&looked).iter().for_each(|note| console.say(note));
        }
    }
    Ok(if looked.found.history.contacts.is_empty() { Exit::Done } else { Exit::Failed })
}

fn looked(args: &CollisionsArgs, console: Console) -> Result<Looked, Failure> {
    let folder = locate(&args.run, Path::new(RUNS)).map_err(|error| Failure::of_run(&error))?;
    let run = Run::open(&folder).map_err(|error| Failure::of_run(&error))?;
    let refused = |reason: &str| {
        let said = format!("cannot look for contacts in `{}`: {reason}", folder.display());
        Failure::unreadable(said).help("run the model again")
    };
    let Some(drawn) = scene(&folder).map_err(|reason| refused(&reason))? else {
        let said = format!("`{}` has no mechanism to look at", folder.display());
        return Err(Failure::unreadable(said)
            .help("give bodies `shapes` (see `blocksim blocks Body`) and run the model again"));
    };
    let mechanism = mechanism(&drawn).map_err(|reason| refused(&reason))?;
    let movement = movement(&run, &drawn).map_err(|reason| refused(&reason))?.unwrap_or_default();
    if let Some(shortfall) = run.shortfall() {
        console.say(&format!("warning: this run is not whole: {shortfall}"));
    }
    let around = around(args, &folder, &run)?;
    let within = [args.from.unwrap_or(f64::NEG_INFINITY), args.to.unwrap_or(f64::INFINITY)];
    let seen = movement.within(within);
    let (Some(first), Some(last)) = (seen.time.first(), seen.time.last()) else {
        let given = movement.time.first().zip(movement.time.last());
        let help = given.map_or("nothing of it moves".to_owned(), |(from, to)| {
            format!("it goes from {from} s to {to} s")
        });
        return Err(Failure::unreadable(format!("`{}` has no values there", folder.display())).help(help));
    };
    let check = surroundings::check(&mechanism, &around);
    Ok(Looked {
        found: look(&check, &mechanism, &seen),
        pairs: check.pairs(),
        left_out: check.left_out().to_vec(),
        meshes: check.unchecked().to_vec(),
        span: [*first, *last],
    })
}

/// What stands around the mechanism.
fn around(args: &CollisionsArgs, folder: &Path, run: &Run) -> Result<Surroundings, Failure> {
    let file = args.surroundings.as_deref();
    let text = match run.manifest().filter(|_| file.is_none()) {
        Some(manifest) => text::text(folder, manifest).map_err(|reason| {
            Failure::unreadable(reason).help("name what stands around with --surroundings")
        })?,
        None => None,
    };
    let sources = text.as_ref().map(|text| Sources::new(&*text.reader));
    surroundings::read(file, text.as_ref().zip(sources.as_ref())).map(Option::unwrap_or_default).map_err(
        |reason| {
            let place = file.unwrap_or(folder).display();
            Failure::unreadable(format!("cannot read the surroundings in `{place}`: {reason}"))
                .help("write them as in docs/moves.md, or name a diagram with the parameter `surroundings`")
        },
    )
}
