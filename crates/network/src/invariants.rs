//! What states of a network obey wherever it can be.
//!
//! The solver integrates more states than are free where bodies form closed loops, where windings are in series and where
//! capacitances are in parallel: laws keep them together. An orientation at rest has four numbers, whose squares add up to 1.

use blocksim_block::{Context, Invariant};

use crate::electrics::{Branch, GivenBy, loops};
use crate::mechanics::frames::Ball;
use crate::mechanics::loops::AT_REST;
use crate::network::Network;
use crate::seat::Role;
use crate::work::Work;

impl Network {
    /// All of them, at the states of an evaluation.
    pub(crate) fn all_invariants(&self, c: &Context, w: &mut Work) -> Vec<Invariant> {
        self.motion_phase(c, w);
        let mut all = self.invariant_loops(w);
        let q = self.positions(c);
        // What turns has no numbers of its own that would be three: which of them follows would decide what is found.
        let rests = |ball: &&Ball| {
            w.joint_speed[ball.speed..ball.speed + 3].iter().all(|speed| speed.abs() < AT_REST)
        };
        all.extend(self.frames.balls.iter().filter(rests).map(|ball| {
            let square: f64 = q[ball.position..ball.position + 4].iter().map(|p| p * p).sum();
            Invariant {
                gaps: vec![square - 1.0],
                followers: [(ball.position..ball.position + 4).collect(), Vec::new()],
                terms: Vec::new(),
                is_lasting: false,
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
        let (of_positions, of_speeds) =
            (0..self.positions, self.positions..self.positions + self.rotation.free);
        let positions = self.frames.loops.iter().flat_map(|closing| {
            closing.gap(data).map(|gaps| Invariant {
                gaps: gaps.as_slice().to_vec(),
                followers: [of_positions.clone().collect(), Vec::new()],
                terms: Vec::new(),
                is_lasting: true,
            })
        });
        let rates = w.loops.rate.chunks(3);
        positions
            .chain(rates.map(|rates| Invariant {
                gaps: rates.to_vec(),
                followers: [of_speeds.clone().collect(), Vec::new()],
                terms: Vec::new(),
                is_lasting: false,
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
        let mut found = Invariant::default();
        for closed in loops::find(&self.electrics, circuit, prescribes).unwrap_or_default() {
            let of = |i: usize| self.prescribed(island, i, w);
            let first = found.terms.len();
            found.terms.push(of(closed.chord));
            found.terms.extend(closed.others.iter().map(|(i, factor)| -factor * of(*i)));
            found.gaps.push(found.terms[first..].iter().sum());
            let all = closed.others.iter().map(|(i, _)| *i).chain([closed.chord]);
            let of = all.filter_map(|i| self.electrics.capacitance(&circuit.two_pins[i].branch));
            found.followers[0].extend(of.map(|own| self.seats[own.member].x.start + own.state));
        }
        found
    }

    /// Currents that have no way but into each other, A or the like. The current of a source whose slope is known takes part, as states
    /// move with it; of others the states hold what the source has not moved (`electrics/cuts.rs`).
    fn invariant_currents(&self, island: usize, c: &Context, w: &mut Work) -> Option<Invariant> {
        w.circuits[island].now().floating.as_ref()?;
        self.take_states(island, c, w);
        self.currents_of_states(island, c, w);
        let floating = w.circuits[island].now().floating.as_ref()?;
        let first = self.electrics.sources;
        let mut found = Invariant::default();
        for (leaving, driven) in floating.leaving.iter().zip(&floating.driven) {
            let of_states =
                leaving.iter().filter(|(i, _)| self.electrics.windings[i - first] == GivenBy::State);
            let of_sources = driven.iter().filter(|(i, _)| self.electrics.slopes.contains(&(*i, true)));
            let begins = found.terms.len();
            found.terms.extend(of_states.chain(of_sources).map(|(i, sign)| sign * w.given[*i]));
            found.gaps.push(found.terms[begins..].iter().sum());
        }
        // An angle never follows from a current; and the currents of a machine, which are those of its own frame, do so last.
        for crossing in &floating.crossing {
            let seat = &self.seats[crossing.member];
            let own = seat.x.clone().filter(|state| !self.interface.drifting.contains(state));
            found.followers[usize::from(matches!(seat.role, Role::Machine(_)))].extend(own);
        }
        Some(found)
    }
}
