//! What a block sees while it is evaluated.

use std::cell::RefCell;
use std::ops::Range;

use crate::Resolution;

/// Values of one block at one instant.
#[derive(Debug, Clone, Copy)]
pub struct Context<'a> {
    /// Time, s.
    pub t: f64,
    /// Continuous states of the block.
    pub x: &'a [f64],
    /// Discrete states of the block: sampled states, modes, memories.
    pub d: &'a [f64],
    /// Inputs, port after port. In `outputs` only those that the group reads are up to date.
    pub u: &'a [f64],
    /// Start and end in `u` of each input port.
    pub inputs: &'a [(u32, u32)],
    /// Start and end in `y` of each output port.
    pub outputs: &'a [(u32, u32)],
    /// Counts evaluations of the whole diagram. While it stays the same, what a block left in its scratch space is
    /// still valid.
    pub evaluation: u64,
    /// Which times are meant to be equal.
    pub resolution: Resolution,
    /// Seed of the run, for numbers that are random.
    pub seed: u64,
    /// Where to report that the block cannot go on.
    pub fault: &'a Fault,
}

impl<'a> Context<'a> {
    /// All elements of an input port.
    #[inline]
    pub fn input(&self, port: usize) -> &'a [f64] {
        let (start, end) = self.inputs[port];
        &self.u[start as usize..end as usize]
    }

    /// The first element of an input port.
    #[inline]
    pub fn scalar(&self, port: usize) -> f64 {
        self.u[self.inputs[port].0 as usize]
    }

    /// Where an output port lies in `y`.
    #[inline]
    pub fn output(&self, port: usize) -> Range<usize> {
        let (start, end) = self.outputs[port];
        start as usize..end as usize
    }

    /// Ends the simulation at this instant, once all of it is known, with a sentence that says why. This is no failure.
    pub fn finish(&self, reason: impl Into<String>) {
        self.fault.finish(reason.into());
    }

    /// Stops the simulation with a sentence that says why; the engine adds the block and the time.
    pub fn fail(&self, reason: impl Into<String>) {
        self.fault.raise(reason.into());
    }
}

/// Holds the first failure of an evaluation, and why the run is to end. Costs nothing while nothing fails.
#[derive(Debug, Default)]
pub struct Fault {
    failure: RefCell<Option<String>>,
    end: RefCell<Option<String>>,
}

impl Fault {
    /// Notes a failure unless one is noted already.
    pub fn raise(&self, reason: String) {
        self.failure.borrow_mut().get_or_insert(reason);
    }

    /// Whether something failed.
    #[inline]
    pub fn is_raised(&self) -> bool {
        self.failure.borrow().is_some()
    }

    /// Notes that the run is to end, unless that is noted already.
    pub fn finish(&self, reason: String) {
        self.end.borrow_mut().get_or_insert(reason);
    }

    /// Why the run is to end, if it is.
    pub fn end(&self) -> Option<String> {
        self.end.borrow().clone()
    }

    /// Whether the run is to end.
    #[inline]
    pub fn ends(&self) -> bool {
        self.end.borrow().is_some()
    }

    /// Takes the failure, if any.
    pub fn take(&self) -> Option<String> {
        self.failure.borrow_mut().take()
    }
}
