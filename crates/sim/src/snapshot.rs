//! Save and restore.

use crate::{SimError, Simulation, methods};

/// All that a simulation remembers, between two calls of `run`.
///
/// A simulation that goes on from a snapshot gives the same bits as one that never stopped, if its method has a fixed
/// step or it has no continuous states. Methods that choose their step choose the first one anew, always in the same way.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    t: f64,
    x: Vec<f64>,
    d: Vec<f64>,
    signals: Vec<f64>,
    started: bool,
    next_hits: Vec<u64>,
    due: Vec<bool>,
    next_row: u64,
    next_step: u64,
    fired: Vec<bool>,
    chatter: (f64, u32),
}

impl Simulation {
    /// What this simulation remembers.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            t: self.t,
            x: self.x.clone(),
            d: self.diagram.d.clone(),
            signals: self.diagram.signals.clone(),
            started: self.started,
            next_hits: self.hits.next.clone(),
            due: self.hits.due.clone(),
            next_row: self.rows.grid.as_ref().map_or(0, |grid| grid.next),
            next_step: self.grid.as_ref().map_or(0, |grid| grid.next),
            fired: self.guards.fired.clone(),
            chatter: self.guards.chatter,
        }
    }

    /// Goes back, or on, to a snapshot of a simulation of the same schedule. Counts begin anew.
    ///
    /// # Errors
    /// `settings` if the snapshot is of another diagram; the simulation is then as it was.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), SimError> {
        let fits = snapshot.x.len() == self.x.len()
            && snapshot.d.len() == self.diagram.d.len()
            && snapshot.signals.len() == self.diagram.signals.len()
            && snapshot.next_hits.len() == self.hits.next.len()
            && snapshot.fired.len() == self.guards.fired.len();
        if !fits {
            return Err(SimError::new("settings", snapshot.t, "the snapshot is of another diagram"));
        }
        self.t = snapshot.t;
        self.x.clone_from(&snapshot.x);
        self.diagram.d.clone_from(&snapshot.d);
        self.diagram.signals.clone_from(&snapshot.signals);
        self.diagram.place(self.t, &self.x);
        self.started = snapshot.started;
        self.hits.next.clone_from(&snapshot.next_hits);
        self.hits.due.clone_from(&snapshot.due);
        self.hits.tell_times();
        self.rows.grid.iter_mut().for_each(|grid| grid.next = snapshot.next_row);
        self.grid.iter_mut().for_each(|grid| grid.next = snapshot.next_step);
        self.guards.fired.clone_from(&snapshot.fired);
        self.guards.chatter = snapshot.chatter;
        self.guards.known = false;
        self.stepper = methods::stepper(&self.schedule);
        (self.majors, self.events, self.hit_count, self.unasked) = (0, 0, 0, 0);
        Ok(())
    }
}
