use blocksim_numbers::format::{duration, fixed, simulated};
use blocksim_recording::{Kept, history};
use blocksim_terminal::{Align, Table};
use serde_json::json;

use crate::args::export::RunsArgs;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::terminal::console::Console;

/// Lists the runs that were kept, the oldest first.
///
/// # Errors
/// If the folder cannot be read.
pub fn runs(args: &RunsArgs, console: Console) -> Outcome {
    let kept = history(&args.folder).map_err(|error| Failure::of_run(&error))?;
    if args.json {
        let lines: String = kept.iter().map(|kept| format!("{}\n", data(kept))).collect();
        console.data(&lines)?;
        return Ok(Exit::Done);
    }
    if kept.is_empty() {
        console.say(&format!(
            "there are no runs in `{}`; `blocksim run MODEL` makes one",
            args.folder.display()
        ));
        return Ok(Exit::Done);
    }
    let mut table = Table::new(&[
        ("run", Align::Left),
        ("model", Align::Left),
        ("ended", Align::Left),
        ("simulated", Align::Right),
        ("took", Align::Right),
        ("size", Align::Right),
    ]);
    for kept in &kept {
        let manifest = kept.manifest.as_ref();
        let model = manifest.map_or(String::new(), |manifest| {
            let set = manifest.overrides.iter().map(|over| format!(" {}={}", over.path, over.value));
            manifest.model.path.clone() + &set.collect::<String>()
        });
        let [simulated, took] = match manifest.filter(|_| !kept.is_unfinished()) {
            None => ["".to_owned(), "".to_owned()],
            Some(manifest) => [simulated(manifest.simulated_time), duration(manifest.wall_time)],
        };
        table.row([kept.name.clone(), model, kept.ended().to_owned(), simulated, took, size(kept.bytes)]);
    }
    console.data(&table.render())?;
    Ok(Exit::Done)
}

fn data(kept: &Kept) -> serde_json::Value {
    let manifest = kept.manifest.as_ref();
    json!({
        "v": 1,
        "type": "run",
        "name": kept.name,
        "path": kept.path.display().to_string(),
        "started": kept.started,
        "model": manifest.map(|manifest| &manifest.model.path),
        "ended": kept.ended(),
        "simulated_time": manifest.map(|manifest| manifest.simulated_time),
        "wall_time": manifest.map(|manifest| manifest.wall_time),
        "bytes": kept.bytes,
    })
}

fn size(bytes: u64) -> String {
    let bytes = bytes as f64;
    match bytes {
        b if b < 1e6 => format!("{} kB", fixed((b / 1e3).ceil(), 0)),
        b if b < 1e9 => format!("{} MB", fixed(b / 1e6, 1)),
        b => format!("{} GB", fixed(b / 1e9, 2)),
    }
}
