//! Solutions of one island for the sets of valves that have conducted so far.

use std::collections::HashMap;

use crate::electrics::{Conducting, Electrics, Island, Solved, solve};

/// Islands with at most this many valves are solved for all sets of them before a run; others take memory when a set
/// conducts together for the first time.
const ALL: usize = 6;

/// Solutions by set of conducting valves, and which of them holds.
#[derive(Debug, Default)]
pub(crate) struct Circuits {
    known: HashMap<Conducting, usize>,
    solved: Vec<Solved>,
    /// The set that holds and its place; meaningless while nothing is solved.
    conducting: Conducting,
    current: usize,
}

impl Circuits {
    /// With the solutions that are worth having from the beginning.
    pub(crate) fn new(electrics: &Electrics, island: &Island) -> Self {
        let mut circuits = Self::default();
        let valves = if island.valves.len() <= ALL { island.valves.len() } else { 0 };
        // A set that has no solution is one that must not occur; the run will tell if it does.
        for conducting in (0..1 << valves).rev() {
            if let Ok(solved) = solve(electrics, island, conducting) {
                circuits.add(conducting, solved);
            }
        }
        circuits
    }

    /// Makes the solution for a set the current one; returns whether it is known.
    #[inline]
    pub(crate) fn choose(&mut self, conducting: Conducting) -> bool {
        if self.conducting == conducting && !self.solved.is_empty() {
            return true;
        }
        let Some(place) = self.known.get(&conducting) else { return false };
        (self.current, self.conducting) = (*place, conducting);
        true
    }

    /// Adds a solution and makes it the current one.
    pub(crate) fn add(&mut self, conducting: Conducting, solved: Solved) {
        self.known.insert(conducting, self.solved.len());
        (self.current, self.conducting) = (self.solved.len(), conducting);
        self.solved.push(solved);
    }

    /// The current solution. At least one has been added.
    #[inline]
    pub(crate) fn now(&self) -> &Solved {
        &self.solved[self.current]
    }

    /// Whether no voltage follows from a current of a winding now.
    pub(crate) fn is_stiff(&self) -> bool {
        self.now().stiff
    }
}
