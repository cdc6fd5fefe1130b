//! Everything that can go wrong before the first step.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use blocksim_block::schedule::Schedule;
use blocksim_diagram::Options;
use blocksim_recording::{ResultsError, RunFolder, probe};
use blocksim_scene::Scene;
use blocksim_sim::Simulation;

use super::unwritten;
use crate::args::model::RunArgs;
use crate::args::values::RUNS;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::loaded::{Loaded, load_with};
use crate::running::blame::failure;
use crate::running::selection::{Selection, select};
use crate::running::tuning::Tuner;
use crate::running::{interrupt, native, solver};
use crate::terminal::console::Console;
use crate::trust::Purpose;

/// Why a run cannot be audited, and what helps.
const FIXED: [&str; 2] = [
    "--audit makes no sense with a method of fixed step, which looks at conditions only at its steps",
    "use a method of variable step, for example `--solver Ode45`",
];

/// A model that can be run, and where its results go.
pub struct Setup {
    /// The model.
    pub loaded: Loaded,
    /// What is run.
    pub schedule: Arc<Schedule>,
    /// Signals that are kept.
    pub selection: Selection,
    /// Where they are kept.
    pub folder: RunFolder,
    /// Now.
    pub started: SystemTime,
}

/// Reads, compiles and places a model; gives its run as well, at its start.
///
/// # Errors
/// What is wrong with it, with the command line, or with the place of the results.
pub fn prepare(args: &RunArgs, console: Console) -> Result<(Setup, Simulation), Failure> {
    let options = Options { recorded: &args.record, ..Options::default() };
    let mut loaded = load_with(&args.model, Purpose::Run, &options)?;
    let mut schedule = loaded.take_schedule("nothing was run", console)?;
    solver::apply(&args.solver, &mut schedule.settings)?;
    let poses = loaded.scene().map(Scene::signals).unwrap_or_default();
    let selection = select(&schedule.recorded, &args.signals, &poses, &schedule.settings)?;
    if args.live.is_none() {
        Tuner::new(args, &loaded).foresee(&schedule, &args.change)?;
    }
    interrupt::take_over();
    let started = SystemTime::now();
    let folder = results_folder(args, started, 1).map_err(|error| unwritten(&error))?;
    let schedule = Arc::new(schedule);
    let mut simulation = match Simulation::new(Arc::clone(&schedule)) {
        Ok(simulation) => simulation,
        Err(error) => {
            let problem = failure(&error, &schedule);
            return Err(Failure::of(Exit::Failed, vec![problem], loaded.files).last("nothing was run"));
        }
    };
    if args.audit && !simulation.audit() {
        return Err(Failure::usage(FIXED[0]).help(FIXED[1]));
    }
    if args.native {
        native::speed_up(&mut simulation, args.quiet || args.json, console);
    }
    Ok((Setup { loaded, schedule, selection, folder, started }, simulation))
}

/// Tries the place of the results before the run, so that a long one does not fail at its end. The second future of a run and those
/// behind it have places of their own, `DIR-2` and so on where one was named.
pub fn results_folder(args: &RunArgs, started: SystemTime, future: usize) -> Result<RunFolder, ResultsError> {
    if let Some(out) = &args.out {
        let mut name = out.clone().into_os_string();
        if future > 1 {
            name.push(format!("-{future}"));
        }
        let folder = RunFolder::create_exactly(Path::new(&name))?;
        let parent = out.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        probe(parent)?;
        return Ok(folder);
    }
    let parent = PathBuf::from(RUNS);
    probe(&parent)?;
    let name = args.model.model.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    RunFolder::create_at_time(&parent, &name, started)
}
