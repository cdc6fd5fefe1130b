//! The manifest of a run: enough to repeat it.

use blocksim_block::schedule::Schedule;
use blocksim_diagram::{Replaced, SourceFile, fingerprint};
use blocksim_recording::{
    Choice, Counts, Ended, FileUsed, Layout, Manifest, Override, Program, RecordedUsed,
};

use crate::args::model::ModelArgs;
use crate::loaded::{Loaded, with_slashes};
use crate::running::solver;

/// What a manifest is made of.
pub struct Facts<'a> {
    /// The command line: the model and what was set.
    pub model: &'a ModelArgs,
    /// What was said of the signals to keep.
    pub signals: Vec<String>,
    /// The model.
    pub loaded: &'a Loaded,
    /// What was run.
    pub schedule: &'a Schedule,
    /// What is recorded.
    pub layout: &'a Layout,
    /// Work done.
    pub counts: blocksim_sim::Counts,
    /// How far it came, s.
    pub simulated: f64,
    /// Start in UTC.
    pub started: String,
    /// Duration on the clock on the wall, s.
    pub wall_time: f64,
    /// How it ended.
    pub ended: Ended,
}

/// The manifest of a run.
pub fn of(facts: &Facts) -> Manifest {
    let mut files = facts.loaded.on_disk.iter().map(file_used);
    let counts = &facts.counts;
    let choice =
        |variant: &str, choice: &str| Choice { variant: variant.to_owned(), choice: choice.to_owned() };
    Manifest {
        schema: Manifest::SCHEMA,
        program: Program { name: "blocksim".to_owned(), version: env!("CARGO_PKG_VERSION").to_owned() },
        // The model itself is the first file that is read.
        model: files.next().unwrap_or_else(|| FileUsed {
            path: facts.model.model.display().to_string(),
            hash: fingerprint(&[]),
        }),
        files: files.chain(facts.loaded.plugins.iter().cloned()).collect(),
        overrides: facts.loaded.compiled.replaced.iter().map(override_of).collect(),
        variants: facts.loaded.compiled.variants.iter().map(|(path, v)| choice(path, &v.chosen)).collect(),
        solver: solver::used(facts.schedule.settings.solver),
        recorded: Some(RecordedUsed::of(facts.layout, facts.signals.clone())),
        started: facts.started.clone(),
        wall_time: facts.wall_time,
        simulated_time: facts.simulated,
        counts: Counts {
            steps: counts.accepted,
            rejected: counts.rejected,
            evaluations: counts.evaluations,
            events: counts.events,
            sample_hits: counts.hits,
        },
        ended: facts.ended.clone(),
    }
}

fn file_used(file: &SourceFile) -> FileUsed {
    FileUsed { path: with_slashes(&file.path), hash: fingerprint(file.text.as_bytes()) }
}

/// With the unit that the value was taken in, so that the manifest says what was run.
fn override_of(replaced: &Replaced) -> Override {
    Override { path: replaced.target.clone(), value: replaced.value.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_have_slashes() {
        let file = SourceFile { path: "/a/b.ron".into(), text: "x".into() };
        assert_eq!(file_used(&file).path, "/a/b.ron");
    }
}
