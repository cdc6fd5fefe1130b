//! The operating point: where a run has come to, or where nothing moves.

use std::sync::Arc;

use blocksim_block::schedule::{Schedule, Steady};
use blocksim_sim::{Control, Counts, Ended, Frozen, Observer, SimError, Simulation};

use crate::running::interrupt;

/// Why there is no operating point.
#[derive(Debug)]
pub enum Lost {
    /// The simulation could not go on.
    Simulation(SimError),
    /// Ctrl-C.
    Interrupted,
}

impl From<SimError> for Lost {
    fn from(error: SimError) -> Lost {
        if interrupt::is_requested() { Lost::Interrupted } else { Lost::Simulation(error) }
    }
}

/// Runs to an instant, s, and freezes the simulation there; with `steady`, at the states near there at which nothing moves.
/// States on which nothing depends, such as the angle of a shaft that turns, may move on; returns their names.
///
/// # Errors
/// [`Lost`].
pub fn at(schedule: &Arc<Schedule>, t: f64, steady: bool) -> Result<(Frozen, Vec<String>), Lost> {
    let mut simulation = Simulation::new(Arc::clone(schedule))?;
    match simulation.run_until(t, &mut Patient)? {
        Ended::Interrupted => return Err(Lost::Interrupted),
        Ended::Stopped if simulation.time() < t => {
            let reason = simulation.stop_reason().unwrap_or_default();
            return Err(Lost::Simulation(SimError {
                code: "settings",
                t: simulation.time(),
                path: None,
                message: format!("the run ends before {t} s: {reason}"),
                help: Some("choose an earlier time, or leave out the block that ends the run".to_owned()),
            }));
        }
        Ended::Finished | Ended::Stopped => {}
    }
    let mut adrift = Vec::new();
    if steady {
        let rest = simulation.seek_rest(&Steady::default(), false, &mut || !interrupt::is_requested())?;
        adrift = rest.adrift.into_iter().map(|(name, _)| name).collect();
    }
    Ok((Frozen::new(simulation, Vec::new())?, adrift))
}

/// Looks at nothing, but respects Ctrl-C.
pub struct Patient;

impl Observer for Patient {
    fn row(&mut self, _t: f64, _values: &[f64]) {}

    fn progress(&mut self, _t: f64, _counts: &Counts) -> Control {
        if interrupt::is_requested() { Control::Stop } else { Control::Go }
    }
}
