//! One function for each verb.

pub mod blocks;
pub mod check;
mod collisions;
mod compare;
mod completions;
mod doctor;
mod edit;
mod emit;
mod explain;
mod export;
mod fmt;
mod grade;
mod graph;
mod help;
mod hints;
mod identify;
mod import;
mod licences;
mod linearise;
mod lsp;
mod manual;
mod new;
pub mod params;
pub mod plan;
pub mod plot;
mod plugin;
pub mod report;
mod run;
mod runs;
mod studio;
mod sweep;
mod trust;

pub use blocks::blocks;
pub use check::check;
pub use collisions::collisions;
pub use compare::compare;
pub use completions::completions;
pub use doctor::doctor;
pub use edit::edit;
pub use emit::emit;
pub use explain::explain;
pub use export::export;
pub use fmt::fmt;
pub use grade::grade;
pub use graph::graph;
pub use help::help;
pub use hints::hints;
pub use identify::identify;
pub use import::import;
pub use licences::licences;
pub use linearise::linearise;
pub use lsp::lsp;
pub use manual::manual;
pub use new::new;
pub use params::params;
pub use plan::plan;
pub use plot::plot;
pub use plugin::plugin;
pub use report::report;
pub use run::run;
pub use runs::runs;
pub use studio::studio;
pub use sweep::sweep;
pub use trust::trust;

use std::io;

use blocksim_block::problem::Problem;
use blocksim_diagram::SourceFile;

use crate::args::model::Format;
use crate::exit::Exit;
use crate::terminal::console::Console;
use crate::terminal::places::Texts;
use crate::terminal::render::{self, plural};

/// Most problems that are told with the text around them.
const MOST: usize = 50;

/// Tells problems: to people on the standard error, as data on the standard output.
///
/// # Errors
/// If the standard output cannot be written.
pub fn tell(problems: &[Problem], files: &[SourceFile], console: Console) -> io::Result<()> {
    tell_with(problems, files, None, console)
}

/// The same where the program ends because of them.
///
/// # Errors
/// If the standard output cannot be written.
pub fn tell_with(
    problems: &[Problem],
    files: &[SourceFile],
    exit: Option<Exit>,
    console: Console,
) -> io::Result<()> {
    let texts = Texts::of(files);
    match console.format {
        Format::Full => {
            let chosen = render::first(problems, MOST);
            chosen.iter().for_each(|problem| console.say(&render::full(problem, &texts, console.colour)));
            if let left @ 1.. = problems.len() - chosen.len() {
                let help = "`blocksim check MODEL --output-format short` lists all of them, one per line";
                console.say(&format!("and {}\n  = help: {help}\n", plural(left, "further problem")));
            }
        }
        Format::Short => problems.iter().for_each(|problem| console.say(&render::short(problem, &texts))),
        Format::Json => {
            let line = |problem| format!("{}\n", render::json(problem, &texts, exit));
            console.data(&problems.iter().map(line).collect::<String>())?;
        }
    }
    Ok(())
}
