//! Whether what a panel turns can be turned as far as it says: each end is tried, as nobody knows before which values a block refuses, or
//! which make another model.

use blocksim_block::problem::{Problem, Severity};
use blocksim_diagram::{Options, PanelAction, PanelItem, Sources, compile_with};
use blocksim_sim::untunable;

use crate::args::model::ModelArgs;
use crate::disk::Disk;
use crate::loaded::Loaded;
use crate::trust::{Plugins, Purpose};

/// Warnings of the elements of a panel that cannot go as far as they say.
pub fn warnings(args: &ModelArgs, loaded: &Loaded) -> Vec<Problem> {
    let Some(now) = &loaded.compiled.schedule else { return Vec::new() };
    let disk = Disk::with(Plugins::of(args.plugins, Purpose::Look));
    let sources = Sources::new(&disk);
    let tried = |item: &PanelItem, value: String| {
        let set = format!("{}={value}", item.name);
        let all: Vec<String> = args.set.iter().cloned().chain([set.clone()]).collect();
        let mut compiled =
            compile_with(&sources, &args.model, &Options { overrides: &all, ..Options::default() });
        let (why, help) = match compiled.schedule.take() {
            Some(next) => {
                let help = "while a run goes on, parameters may change numbers, not what there is: leave this one out";
                (format!("it makes another model: {}", untunable(now, &next)?), Some(help.to_owned()))
            }
            None => {
                let first =
                    compiled.problems.into_iter().find(|problem| problem.severity == Severity::Error)?;
                (first.message, first.help)
            }
        };
        let told = format!("the {} cannot set `{set}`: {why}", item.word.name());
        let problem = Problem { help, ..Problem::warning("panel", told) };
        Some(problem.at(&item.place, "cannot go so far"))
    };
    let of_item = |item: &PanelItem| -> Vec<Problem> {
        let values = match &item.action {
            PanelAction::Number { range, unit, .. } => {
                range.map(|end| format!("{end} {unit}").trim_end().to_owned())
            }
            PanelAction::Two { off, on, .. } => [off.clone(), on.clone()],
            PanelAction::Shows { .. } => return Vec::new(),
        };
        values.into_iter().filter_map(|value| tried(item, value)).collect()
    };
    loaded.compiled.panel.iter().flat_map(of_item).collect()
}
