//! Currents of inductances that current sources decide.
//!
//! Where nothing but windings and current sources meets at a part of the circuit, Kirchhoff's law `W' i + Q' j = 0` ties the
//! currents `i` of the windings to those of the sources, `j` (`floating.rs` has the notation). The states need no slope of `j`:
//! they hold the fluxes without what the sources have moved, and at each evaluation the currents are
//!
//! ```text
//! i = x + Gamma W psi,    (W' Gamma W) psi = - (W' x + Q' j)
//! ```
//!
//! with volt-seconds `psi` of the potentials of such parts: what a voltage without end does in no time where `j` jumps, so the
//! flux is shared by the windings as they would share a jump. `x'` is `i'` with a potential for those `j'` that are known, and the
//! rest of `i'` comes by `psi`, so `x` may hold a jump or a signal whose slope nobody tells; only the potential is unknown then,
//! which is told where somebody looks at it. Where a winding saturates, its current is a curve over its flux, and `psi` is found by Newton's
//! method.

use blocksim_block::Context;

use crate::electrics::Floating;
use crate::electrics::floating::Crossing;
use crate::network::Network;
use crate::work::Work;
use crate::work::circuits::FloatRoom;

/// Steps of Newton's method at most, where a current is a curve over its flux: from small currents it overshoots once, and comes down along
/// a convex curve from there.
const NEWTON: usize = 60;
/// What may be missing of a current, relative to the largest.
const FOLLOWED: f64 = 1e-13;

impl Network {
    /// Passes the states of members that the network shifts on as the solver has them.
    pub(crate) fn take_states(&self, island: usize, c: &Context, w: &mut Work) {
        let circuit = &self.electrics.islands[island];
        if circuit.shifts.is_empty() && circuit.in_cuts.is_empty() {
            return;
        }
        for seat in circuit.members.iter().map(|i| &self.seats[*i]) {
            if let Some(at) = seat.shifted {
                let x = seat.states(c).0;
                w.own[at..at + x.len()].copy_from_slice(x);
            }
        }
    }

    /// Gives the windings in cuts the currents that the sources ask for. The given currents are those of the states.
    pub(crate) fn follow_sources(&self, island: usize, c: &Context, w: &mut Work) {
        let circuits = std::mem::take(&mut w.circuits);
        let floating = circuits[island].now().floating.as_ref();
        if let Some(floating) = floating.filter(|floating| floating.cut.contains(&true)) {
            let mut room = std::mem::take(&mut w.float);
            let is_curved = |crossing: &Crossing| self.seats[crossing.member].member.part.curved;
            let times = if floating.crossing.iter().any(is_curved) { NEWTON } else { 1 };
            for _ in 0..times {
                if !self.follow_once(floating, c, w, &mut room) {
                    break;
                }
            }
            w.float = room;
        }
        w.circuits = circuits;
    }

    /// Moves the states by the volt-seconds that bring the currents to those of the sources, exactly where these are linear in the states.
    /// Returns whether anything was missing.
    fn follow_once(&self, floating: &Floating, c: &Context, w: &mut Work, room: &mut FloatRoom) -> bool {
        self.assemble_floating(floating, c, w, room, false);
        let (mut missing, mut size) = (0.0_f64, 0.0_f64);
        let parts = room.phi.iter_mut().zip(&floating.leaving).zip(&floating.cut);
        for ((psi, leaving), _) in parts.filter(|(_, cut)| **cut) {
            *psi = -leaving.iter().map(|(i, sign)| sign * w.given[*i]).sum::<f64>();
            missing = missing.max(psi.abs());
            size = leaving.iter().map(|(i, _)| w.given[*i].abs()).fold(size, f64::max);
        }
        super::float::solve_symmetric(&mut room.matrix, &mut room.phi);
        for crossing in &floating.crossing {
            let seat = &self.seats[crossing.member];
            let (Some(component), Some(at)) = (seat.component(), seat.shifted) else { continue };
            let mut flux = std::mem::take(&mut w.flux);
            flux.clear();
            let rows = crossing.border.chunks(floating.parts);
            flux.extend(rows.map(|row| row.iter().zip(&room.phi).map(|(w, psi)| w * psi).sum::<f64>()));
            room.state.clear();
            room.state.extend_from_slice(&w.own[at..at + seat.x.len()]);
            component.strike(&self.fed_own_law(c, seat, w), &flux, &mut room.state);
            w.own[at..at + seat.x.len()].copy_from_slice(&room.state);
            w.flux = flux;
            let first = self.electrics.sources;
            let mut given = std::mem::take(&mut w.given);
            let own = &mut given[first + seat.windings.start..first + seat.windings.end];
            seat.member.part.write_currents(component, &self.moving_law(c, seat, w), own);
            w.given = given;
        }
        missing > FOLLOWED * size
    }
}
