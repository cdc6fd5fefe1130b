//! A run that somebody looks at, and that may go back into its past: it is kept as it was then, and another one begins that has the
//! same past.

use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

use blocksim_host::Death;
use blocksim_sim::Simulation;

use super::prepare::{Setup, results_folder};
use super::simulate::{End, begin, keep_dead, taken};
use super::{finish, unwritten};
use crate::args::model::RunArgs;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::running::blame::failure;
use crate::running::live::Live;
use crate::running::live::mechanism::Mechanism;
use crate::running::recorder::Shared;
use crate::running::rescue;
use crate::running::start::Began;
use crate::running::tuning::{Planned, Tuner};
use crate::terminal::console::Console;

/// Runs what is prepared as often as it goes back, until nobody looks any more.
///
/// # Errors
/// If nothing can be recorded or kept.
pub fn watch(
    args: &RunArgs,
    mut setup: Setup,
    mut simulation: Simulation,
    speed: f64,
    console: Console,
) -> Outcome {
    let recorder = Mutex::new(Some(begin(args, &mut setup, console)?));
    let texts = setup.loaded.on_disk.clone();
    let mut tuner = Tuner::new(args, &setup.loaded);
    let items = setup.loaded.compiled.panel.clone();
    let mechanism = Mechanism::of(args, &setup.loaded, &setup.schedule);
    let began = Began::of(&simulation);
    let schedule = setup.schedule.clone();
    let setup = Mutex::new(Some(setup));
    let planned = Planned::new(&args.change);
    let pace = (speed, args.paused, args.catch_up);
    let mut live = Live::begin(Shared(&recorder), &schedule, (&items, &mechanism), planned, pace, console);
    for futures in 2.. {
        let keep = |death: &Death| keep_dead(args, &recorder, &setup, began.clone(), death, console);
        let outcome = rescue::during(keep, || tuner.run(&mut simulation, &mut live));
        live.finish();
        let (Some(recorded), Some(left)) = (taken(&recorder), taken(&setup)) else { return Ok(Exit::Failed) };
        if live.is_dropped() {
            drop(recorded);
            left.folder.discard();
            return Ok(Exit::Interrupted);
        }
        let Setup { loaded, selection, .. } = &left;
        let (loaded, selection) = (loaded.clone(), selection.clone());
        let refused = live.strayed.take().map(|t| strayed(t, &left));
        let end = End::of(outcome, refused, &mut simulation, &schedule, began.clone());
        let exit = finish(args, left, recorded, end, console)?;
        let Some(t) = live.linger(simulation.time()) else { return Ok(exit) };
        let started = SystemTime::now();
        let folder = results_folder(args, started, futures).map_err(|error| unwritten(&error))?;
        let mut next = Setup { loaded, schedule: schedule.clone(), selection, folder, started };
        let begun = begin(args, &mut next, console)?;
        *recorder.lock().unwrap_or_else(PoisonError::into_inner) = Some(begun);
        *setup.lock().unwrap_or_else(PoisonError::into_inner) = Some(next);
        let back = live
            .go_back(t)
            .map_err(|error| Failure::of(Exit::Failed, vec![failure(&error, &schedule)], texts.clone()))?;
        let Some((past, setting)) = back else { return Ok(exit) };
        simulation = past;
        tuner.go_back(setting);
    }
    Ok(Exit::Done)
}

/// That the way to a time of the past was not as before, and who can be the cause.
fn strayed(t: f64, setup: &Setup) -> (String, Option<String>) {
    let message = format!(
        "the run cannot go back to {t} s: from the same states it gave other results than before, so a block remembers something \
         that is not among its states"
    );
    let plugins: Vec<String> = setup.loaded.plugins.iter().map(|used| format!("`{}`", used.path)).collect();
    let help = match plugins.as_slice() {
        [] => "this is a mistake of blocksim; please report it with the model".to_owned(),
        all => format!(
            "a plug-in may do so: `blocksim plugin check` finds which; the model has {}",
            all.join(", ")
        ),
    };
    (message, Some(help))
}
