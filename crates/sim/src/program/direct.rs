//! Derivatives as functions of time and states alone. At the stages of a step nobody reads the signals on the way, so they are not
//! written: what stands between a state and a derivative is computed in as few instructions as it takes.

use blocksim_block::law::{Draft, Id, Root, Tape};
use blocksim_block::schedule::Solver;

use crate::evaluation::evaluate::Diagram;
use crate::program::fused::Laws;

/// All derivatives as one tape; with them the guards, where these are looked at between the ends of steps.
#[derive(Debug)]
pub(crate) struct Direct {
    tape: Tape,
    /// The cells of the derivatives of all states.
    derivatives: Vec<u32>,
    /// The cells of guards, and their numbers.
    guards: Vec<(u32, u32)>,
}

/// The same, before it is a tape.
#[derive(Debug)]
pub(crate) struct DirectDraft {
    pub draft: Draft,
    /// Number of the state of each derivative.
    states: Vec<u32>,
    guards: Vec<u32>,
}

impl Direct {
    /// The tape of a draft, which leaves its values in `cells`.
    pub fn new(tape: Tape, cells: &[u32], DirectDraft { states, guards, .. }: &DirectDraft) -> Self {
        let (of_states, of_guards) = cells.split_at(states.len());
        let mut derivatives = vec![0; states.len()];
        states.iter().zip(of_states).for_each(|(state, cell)| derivatives[*state as usize] = *cell);
        Self { tape, derivatives, guards: of_guards.iter().copied().zip(guards.iter().copied()).collect() }
    }

    /// Writes the derivatives at a point that is in its place. Returns whether all requirements are met.
    #[inline]
    pub fn run(&self, signals: &mut [f64], d: &mut [f64], dx: &mut [f64]) -> bool {
        let met = self.meets(signals, d);
        dx.iter_mut().zip(&self.derivatives).for_each(|(dx, cell)| *dx = signals[*cell as usize]);
        met
    }

    /// Computes the derivatives at a point that is in its place and leaves them in their cells. Returns whether all requirements are met.
    #[inline]
    pub fn meets(&self, signals: &mut [f64], d: &mut [f64]) -> bool {
        self.tape.meets(signals, d)
    }

    /// The cells of the derivatives of all states.
    pub fn derivatives(&self) -> &[u32] {
        &self.derivatives
    }

    pub fn tape(&self) -> &Tape {
        &self.tape
    }

    pub fn tape_mut(&mut self) -> &mut Tape {
        &mut self.tape
    }
}

impl DirectDraft {
    /// The derivatives in the order of the states, if each has one.
    pub fn derivatives(&self) -> Option<Vec<Id>> {
        let mut derivatives = vec![None; self.states.len()];
        for (state, root) in self.states.iter().zip(&self.draft.roots) {
            if let Root::Anywhere(id) = root {
                *derivatives.get_mut(*state as usize)? = Some(*id);
            }
        }
        derivatives.into_iter().collect()
    }
}

impl Laws<'_> {
    /// The derivatives, and the guards of a method that looks at them, if all that they depend on is data.
    pub fn direct(&self) -> Option<DirectDraft> {
        let mut joined = self.joined_derivatives()?;
        let units = &self.plan.units;
        let states = self.plan.with_states.iter().flat_map(|block| units[*block].x.range());
        let states: Vec<u32> = states.map(|state| state as u32).collect();
        if states.len() != self.schedule.states {
            return None;
        }
        let mut guards = Vec::new();
        if let Solver::Variable { .. } = self.schedule.settings.solver {
            for &block in &self.plan.guarded {
                let law = self.law(block)?;
                guards.extend(units[block].g.range().map(|guard| guard as u32));
                joined.values(self.placed(block, law), &law.guards);
            }
        }
        Some(DirectDraft { draft: joined.finish_values(), states, guards })
    }
}

impl Diagram {
    /// Writes the derivatives at a point, and takes down the guards there if anybody looks; the signals stay those of the point before.
    /// Returns whether that was possible: where not all is data, or a law has no value, it takes an evaluation.
    #[inline]
    pub fn derive_directly(&mut self, t: f64, x: &[f64], dx: &mut [f64]) -> bool {
        let Self { plan, signals, d, looks, .. } = self;
        let Some(direct) = &plan.fused.direct else { return false };
        plan.fused.place(t, x, signals);
        if !direct.run(signals, d, dx) {
            return false;
        }
        if looks.is_on() {
            let row = looks.row(t);
            direct.guards.iter().for_each(|&(cell, guard)| row[guard as usize] = signals[cell as usize]);
        }
        true
    }
}
