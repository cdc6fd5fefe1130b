//! The block that passes the output of whichever conditional subsystem runs.

use std::sync::Arc;

use blocksim_block::{Block, Context, Given, Interface, InterfaceError, Merging, Scratch};

use super::gate::{GateState, gate_input};
use crate::problems::list;

/// A block that merges outputs of conditional subsystems, with a further input for each of its inputs, from the gate of the subsystem.
///
/// Its discrete states are whether any of them has run, and the output that is held.
#[derive(Debug)]
pub(crate) struct Merger {
    /// The block as the diagram has it: it knows the types.
    inner: Arc<dyn Block>,
    merging: Merging,
    /// Number of inputs that are merged.
    count: usize,
    /// What each of them comes from, for messages.
    subsystems: Vec<String>,
}

/// Places of the discrete states.
const HAS_RUN: usize = 0;
const HELD: usize = 1;

impl Merger {
    pub fn new(inner: Arc<dyn Block>, merging: Merging, subsystems: Vec<String>) -> Self {
        Self { inner, merging, count: subsystems.len(), subsystems }
    }

    /// The inputs whose subsystems run.
    fn running<'c>(&'c self, c: &'c Context) -> impl Iterator<Item = usize> + 'c {
        (0..self.count).filter(|input| GateState::new(c.input(self.count + input)).runs(c.t))
    }
}

impl Block for Merger {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let mut interface = self.inner.interface(given)?;
        let n = interface.outputs.iter().map(|output| output.port_type.shape.len()).sum();
        interface.inputs.extend((0..self.count).map(|_| gate_input()));
        interface.merges = None;
        interface.holds = Some(HELD);
        Ok(interface
            .discrete("has_run", 0.0)
            .memory("held", n, self.merging.initial.unwrap_or(0.0))
            .settles())
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        if self.running(c).next().is_some() {
            d[HAS_RUN] = 1.0;
        }
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        let mut running = self.running(c);
        match (running.next(), running.next()) {
            (Some(one), None) => {
                let u = c.input(one);
                y.iter_mut().enumerate().for_each(|(i, y)| *y = if let [u] = u { *u } else { u[i] });
            }
            (Some(one), Some(other)) => c.fail(format!(
                "`{}` and `{}` run at the same time, so there are two values: enable them by the outputs of one IfElse or SwitchCase",
                self.subsystems[one], self.subsystems[other]
            )),
            (None, _) if c.d[HAS_RUN] > 0.0 || self.merging.initial.is_some() => {
                y.copy_from_slice(&c.d[HELD..]);
            }
            (None, _) => c.fail(format!(
                "none of {} has run yet, and `initial` is missing: give it, or enable one of them from the start",
                list(&self.subsystems)
            )),
        }
    }
}
