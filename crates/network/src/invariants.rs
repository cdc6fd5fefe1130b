//! What states of a network obey wherever it can be.
//!
//! The solver integrates more states than are free where bodies form closed loops, where windings are in series and where
//! capacitances are in parallel: laws keep them together. An orientation has four numbers, whose squares add up to 1.

use blocksim_block::{Context, Invariant};

use crate::electrics::{Branch, GivenBy, loops};
use crate::network::Network;
use crate::work::Work;

impl Network {
    /// All of them, at the states of an evaluation.
    pub(crate) fn all_invariants(&self, c: &Context, w: &mut Work) -> Vec<Invariant> {
        self.motion_phase(c, w);
        let mut all = self.invariant_loops(w);
        let q = self.positions(c);
        all.extend(self.frames.balls.iter().map(|ball| {
            let square: f64 = q[ball.position..ball.position + 4].iter().map(|p| p * p).sum();
            Invariant {
                gaps: vec![square - 1.0],
                states: ball.position..ball.position + 4,
                terms: Vec::new(),
            }
        }));
        for (index, island) in self.electrics.islands.iter().enumerate() {
            if island.separate.is_none() && self.circuit(index, c, w).is_ok() {
                all.push(self.invariant_voltages(index, c, w));
                all.extend(self.invariant_currents(index, c, w));
            }
        }
        all
    }

    /// Gaps of closed loops, rad and m, and how fast they open.
    fn invariant_loops(&self, w: &Work) -> Vec<Invariant> {
        let Some(data) = &w.data else { return Vec::new() };
        let of_speeds = self.positions..self.positions + self.rotation.free;
        let positions = self.frames.loops.iter().flat_map(|closing| {
            closing.gap(data).map(|gaps| Invariant {
                gaps: gaps.as_slice().to_vec(),
                states: 0..self.positions,
                terms: Vec::new(),
            })
        });
        let rates = w.loops.rate.chunks(3);
        positions
            .chain(rates.map(|rates| Invariant {
                gaps: rates.to_vec(),
                states: of_speeds.clone(),
                terms: Vec::new(),
            }))
            .collect()
    }

    /// Capacitances whose voltages others decide, V or the like; sources are what they are.
    fn invariant_voltages(&self, island: usize, c: &Context, w: &mut Work) -> Invariant {
        let circuit = &self.electrics.islands[island];
        let conducting = self.conducting(island, c, w);
        let prescribes = |i: usize| match circuit.two_pins[i].branch {
            Branch::Source(_) | Branch::Variable(_) | Branch::Wire => true,
            Branch::Valve { index, on_resistance, .. } => {
                on_resistance == 0.0 && conducting >> index & 1 == 1
            }
            _ => false,
        };
        let mut found = Invariant { states: 0..c.x.len(), ..Invariant::default() };
        for closed in loops::find(&self.electrics, circuit, prescribes).unwrap_or_default() {
            let of = |i: usize| self.prescribed(island, i, w);
            let first = found.terms.len();
            found.terms.push(of(closed.chord));
            found.terms.extend(closed.others.iter().map(|(i, factor)| -factor * of(*i)));
            found.gaps.push(found.terms[first..].iter().sum());
        }
        found
    }

    /// Currents that have no way but into each other, A or the like. Of those that a source decides, the states hold what the source has not
    /// moved.
    fn invariant_currents(&self, island: usize, c: &Context, w: &mut Work) -> Option<Invariant> {
        w.circuits[island].now().floating.as_ref()?;
        self.take_states(island, c, w);
        self.currents_of_states(island, c, w);
        let first = self.electrics.sources;
        let mut found = Invariant { states: 0..c.x.len(), ..Invariant::default() };
        for leaving in &w.circuits[island].now().floating.as_ref()?.leaving {
            let of_states =
                leaving.iter().filter(|(i, _)| self.electrics.windings[i - first] == GivenBy::State);
            let begins = found.terms.len();
            found.terms.extend(of_states.map(|(i, sign)| sign * w.given[*i]));
            found.gaps.push(found.terms[begins..].iter().sum());
        }
        Some(found)
    }
}
