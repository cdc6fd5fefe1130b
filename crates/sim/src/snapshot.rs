//! Save and restore.

use std::sync::Arc;

use blocksim_block::schedule::Schedule;
use blocksim_solve::Memory;

use crate::events::guards::Guards;
use crate::events::pace::Pace;
use crate::floors::Floors;
use crate::ignored_states::Sizes;
use crate::rows::refine::Refine;
use crate::stepping::halves::{self, Halves};
use crate::stepping::methods;
use crate::stepping::past::Past;
use crate::{Counts, SimError, Simulation};

/// All that a simulation remembers, between two calls of `run`.
///
/// A simulation that goes on from a snapshot gives the same bits as the one of which it was taken, whatever its method. A
/// stop in the middle may itself show: `run_until` ends a step there that would have gone on. One at which the
/// observer has interrupted the run does not.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    t: f64,
    x: Vec<f64>,
    d: Vec<f64>,
    signals: Vec<f64>,
    loops: Vec<f64>,
    started: bool,
    next_hits: Vec<u64>,
    due: Vec<bool>,
    next_row: u64,
    next_step: u64,
    guards: Guards,
    pace: Pace,
    angles: f64,
    past: Past,
    refine: Refine,
    sizes: Sizes,
    floors: Floors,
    stepper: Option<Memory>,
    halves: Option<halves::Memory>,
    unasked: u32,
    interrupted: bool,
}

impl Snapshot {
    /// When it was taken, s.
    pub fn time(&self) -> f64 {
        self.t
    }

    /// Discrete states of all blocks.
    pub(crate) fn discrete(&self) -> &[f64] {
        &self.d
    }
}

impl Simulation {
    /// What this simulation remembers.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            t: self.t,
            x: self.x.clone(),
            d: self.diagram.d.clone(),
            signals: self.diagram.signals.clone(),
            loops: self.diagram.loops.anchors.clone(),
            started: self.started,
            next_hits: self.hits.next.clone(),
            due: self.hits.due.clone(),
            next_row: self.rows.grid.as_ref().map_or(0, |grid| grid.next()),
            next_step: self.grid.as_ref().map_or(0, |grid| grid.next()),
            guards: self.guards.clone(),
            pace: self.pace.clone(),
            angles: self.angles.rate,
            past: self.past.clone(),
            refine: self.refine.clone(),
            sizes: self.sizes.clone(),
            floors: self.floors.clone(),
            stepper: self.stepper.as_ref().map(|stepper| stepper.memory()),
            halves: self.halves.as_ref().map(Halves::memory),
            unasked: self.unasked,
            interrupted: self.interrupted,
        }
    }

    /// A simulation that goes on from a snapshot of another one of the same schedule, and counts on from its work.
    ///
    /// # Errors
    /// Those of [`new`](Self::new), but for the steady state, which is not sought; `settings` if the snapshot is of another diagram.
    pub fn resume(schedule: Arc<Schedule>, snapshot: &Snapshot, counts: Counts) -> Result<Self, SimError> {
        let mut simulation = Self::given(schedule)?;
        simulation.restore(snapshot)?;
        (simulation.majors, simulation.events, simulation.hit_count) =
            (counts.major, counts.events, counts.hits);
        simulation.carried = counts;
        Ok(simulation)
    }

    /// Goes back, or on, to a snapshot of a simulation of the same schedule. Counts begin anew.
    ///
    /// # Errors
    /// `settings` if the snapshot is of another diagram; the simulation is then as it was.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), SimError> {
        let fits = snapshot.x.len() == self.x.len()
            && snapshot.d.len() == self.diagram.d.len()
            && snapshot.signals.len() == self.diagram.signals.len()
            && snapshot.loops.len() == self.diagram.loops.anchors.len()
            && snapshot.next_hits.len() == self.hits.next.len()
            && snapshot.guards.fired.len() == self.guards.fired.len();
        if !fits {
            return Err(SimError::new("settings", snapshot.t, "the snapshot is of another diagram"));
        }
        self.t = snapshot.t;
        self.x.clone_from(&snapshot.x);
        self.diagram.d.clone_from(&snapshot.d);
        self.modes.note(&self.diagram.d);
        self.diagram.signals.clone_from(&snapshot.signals);
        self.diagram.loops.anchors.clone_from(&snapshot.loops);
        self.diagram.place(self.t, &self.x);
        self.started = snapshot.started;
        self.hits.next.clone_from(&snapshot.next_hits);
        self.hits.due.clone_from(&snapshot.due);
        self.hits.tell_times();
        self.rows.grid.iter_mut().for_each(|grid| grid.go_to(snapshot.next_row));
        self.grid.iter_mut().for_each(|grid| grid.go_to(snapshot.next_step));
        self.guards.clone_from(&snapshot.guards);
        self.pace.clone_from(&snapshot.pace);
        self.angles.rate = snapshot.angles;
        self.past.clone_from(&snapshot.past);
        self.refine.clone_from(&snapshot.refine);
        self.sizes.clone_from(&snapshot.sizes);
        self.floors.clone_from(&snapshot.floors);
        self.stepper = methods::stepper(&self.schedule);
        if let (Some(stepper), Some(memory)) = (&mut self.stepper, &snapshot.stepper) {
            stepper.recall(memory);
        }
        if let (Some(halves), Some(memory)) = (&mut self.halves, &snapshot.halves) {
            halves.recall(memory);
        }
        (self.unasked, self.interrupted) = (snapshot.unasked, snapshot.interrupted);
        self.looked = if self.started { self.t } else { f64::NEG_INFINITY };
        (self.majors, self.events, self.hit_count) = (0, 0, 0);
        Ok(())
    }
}
