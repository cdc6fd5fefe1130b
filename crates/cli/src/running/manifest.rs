//! The manifest of a run: enough to repeat it.

use blocksim_block::schedule::Schedule;
use blocksim_diagram::{SourceFile, fingerprint};
use blocksim_results::{Choice, Counts, Ended, FileUsed, Layout, Manifest, Override, Program, RecordedUsed};
use blocksim_sim::Simulation;

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
    /// The run.
    pub simulation: &'a Simulation,
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
    let counts = facts.simulation.counts();
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
        overrides: facts.model.set.iter().map(|text| override_of(text)).collect(),
        variants: facts.loaded.compiled.variants.iter().map(|(path, v)| choice(path, &v.chosen)).collect(),
        solver: solver::used(facts.schedule.settings.solver),
        recorded: Some(RecordedUsed::of(facts.layout, facts.signals.clone())),
        started: facts.started.clone(),
        wall_time: facts.wall_time,
        simulated_time: facts.simulation.time(),
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

fn override_of(text: &str) -> Override {
    let (path, value) = text.split_once('=').unwrap_or((text, ""));
    Override { path: path.trim().to_owned(), value: value.trim().to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_have_slashes_and_overrides_two_sides() {
        let file = SourceFile { path: "/a/b.ron".into(), text: "x".into() };
        assert_eq!(file_used(&file).path, "/a/b.ron");
        let over = override_of("robot.axis1.kp = 2*3 rad/s");
        assert_eq!((over.path.as_str(), over.value.as_str()), ("robot.axis1.kp", "2*3 rad/s"));
    }
}
