//! Subsystems that run only at times: while a signal is true, at its edges, or from their initial values on at its edges.
//!
//! A conditional subsystem has one block of its own, its [`Gate`], which knows when it runs. Each block inside stands in a
//! [`Conditional`], which asks the gate before it hands a call on, so the engine needs to know nothing of conditions. The gate of a
//! subsystem within a subsystem asks the outer one.

mod conditional;
mod gate;
mod merger;
mod outlet;

use blocksim_block::Crossing;
use blocksim_block::problem::Place;
use blocksim_signal::Quantity;

pub(crate) use conditional::Conditional;
pub(crate) use gate::{Gate, gate_input};
pub(crate) use merger::Merger;
pub(crate) use outlet::Outlet;

/// Names of the inputs of a conditional subsystem, in their order.
pub(crate) const INPUTS: [&str; 3] = ["enable", "trigger", "reset"];

/// When a subsystem runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Condition {
    /// It runs while the input `enable` is true.
    pub enable: Option<WhenEnabled>,
    /// It runs at these edges of the input `trigger` alone.
    pub trigger: Option<Crossing>,
    /// Its states are set to their initial values at these edges of the input `reset`.
    pub reset: Option<Crossing>,
    /// What outputs give while it is disabled; the others hold what they gave last.
    pub when_disabled: Vec<SetOutput>,
}

/// What becomes of the states of a subsystem that is enabled again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WhenEnabled {
    /// They go on from where they were.
    Held,
    /// They begin anew.
    Reset,
}

/// What an output gives while its subsystem is disabled.
#[derive(Debug, Clone, PartialEq)]
pub struct SetOutput {
    /// The output.
    pub name: String,
    /// In SI units.
    pub value: Quantity,
    /// Where it is written.
    pub place: Place,
}

impl Condition {
    /// Names of the inputs that it adds to the subsystem.
    pub fn inputs(&self) -> impl Iterator<Item = &'static str> + use<> {
        let given = [self.enable.is_some(), self.trigger.is_some(), self.reset.is_some()];
        INPUTS.into_iter().zip(given).filter(|(_, given)| *given).map(|(name, _)| name)
    }

    /// Whether it sets states to their initial values.
    pub(crate) fn resets(&self) -> bool {
        self.reset.is_some() || self.enable == Some(WhenEnabled::Reset)
    }

    /// Whether the subsystem does not always run.
    pub(crate) fn pauses(&self) -> bool {
        self.enable.is_some() || self.trigger.is_some()
    }
}
