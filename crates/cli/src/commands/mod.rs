//! One function for each verb.

mod blocks;
mod check;
mod compare;
mod emit;
mod explain;
mod export;
mod graph;
mod identify;
mod import;
mod params;
mod plan;
mod plot;
mod report;
mod run;
mod runs;

pub use blocks::blocks;
pub use check::check;
pub use compare::compare;
pub use emit::emit;
pub use explain::explain;
pub use export::export;
pub use graph::graph;
pub use identify::identify;
pub use import::import;
pub use params::params;
pub use plan::plan;
pub use plot::plot;
pub use report::report;
pub use run::run;
pub use runs::runs;

use blocksim_block::problem::Problem;
use blocksim_diagram::{Compiled, SourceFile, Sources, compile};
use blocksim_results::FileUsed;

use crate::args::model::{Format, ModelArgs};
use crate::disk::{Disk, refusal};
use crate::running::manifest;
use crate::terminal::console::Console;
use crate::terminal::render;

/// A model and the files that it was read from.
pub struct Loaded {
    /// What became of it.
    pub compiled: Compiled,
    /// All texts that places in problems refer to.
    pub files: Vec<SourceFile>,
    /// Those of them that are files.
    pub on_disk: Vec<SourceFile>,
    /// Libraries of plug-ins.
    pub plugins: Vec<FileUsed>,
}

/// Reads and compiles a model; `None` if there is nothing to read, which has been told then.
pub fn load(args: &ModelArgs, console: Console) -> Option<Loaded> {
    if let Some(refusal) = refusal(&args.model) {
        console.say(&refusal);
        return None;
    }
    blocksim_host::set_build_notice(|notice| {
        use std::io::Write;
        let _ = writeln!(std::io::stderr(), "  {notice}");
    });
    let disk = Disk::default();
    let sources = Sources::new(&disk);
    let compiled = compile(&sources, &args.model, &args.set);
    let files = sources.all();
    let on_disk = files.iter().filter(|file| disk.has_read(&file.path)).cloned().collect();
    // Hashed now, before anybody builds them anew.
    let plugins = blocksim_host::opened().into_iter().map(|library| manifest::library_used(&library.path));
    Some(Loaded { compiled, files, on_disk, plugins: plugins.collect() })
}

/// Tells problems: to people on the standard error, as data on the standard output.
///
/// # Errors
/// If the standard output cannot be written.
pub fn tell(
    problems: &[Problem],
    files: &[SourceFile],
    format: Format,
    console: Console,
) -> std::io::Result<()> {
    for problem in problems {
        match format {
            Format::Full => console.say(&format!("{}\n", render::full(problem, files, console.colour))),
            Format::Short => console.say(&render::short(problem, files)),
            Format::Json => console.data(&format!("{}\n", render::json(problem, files)))?,
        }
    }
    Ok(())
}
