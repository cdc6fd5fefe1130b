//! Solutions of one island for the sets of valves that have conducted so far.

use std::collections::HashMap;

use crate::electrics::{Conducting, Solved};

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
}
