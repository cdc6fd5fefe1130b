//! Potentials of parts that float, while a network runs; see `electrics/floating.rs` for the equations.

use blocksim_block::Context;

use crate::electrics::floating::Crossing;
use crate::electrics::{Floating, coordinates};
use crate::network::Network;
use crate::work::Work;
use crate::work::circuits::FloatRoom;

/// The rate at which currents that must be one come together again where they have drifted apart, 1/s: quickly for the times of power
/// electronics, and slowly for steps (J. Baumgarte, Stabilization of constraints and integrals of motion in dynamical systems, 1972).
pub(super) const TOGETHER: f64 = 5e3;

impl Network {
    /// Adds the potentials of floating parts to the voltages of an island.
    pub(crate) fn float(&self, island: usize, c: &Context, w: &mut Work) {
        if w.circuits[island].now().floating.is_none() {
            return;
        }
        let mut circuits = std::mem::take(&mut w.circuits);
        if let Some(floating) = &circuits[island].now().floating {
            let mut room = std::mem::take(&mut w.float);
            self.assemble_floating(floating, c, w, &mut room, true);
            self.settle_floating(island, floating, &mut room, w);
            self.hold_still(floating, c, w, &mut room);
            w.float = room;
        }
        w.circuits = std::mem::take(&mut circuits);
    }

    /// Gives windings that cannot carry anything but what they do the voltage that keeps it, to the last bit: what rounding leaves of
    /// volts would be all that moves in a circuit that waits for its first current, and steps would follow it.
    fn hold_still(&self, floating: &Floating, c: &Context, w: &mut Work, room: &mut FloatRoom) {
        for crossing in floating.crossing.iter().filter(|crossing| crossing.is_still) {
            if !self.find_reluctance(crossing, c, w, room) {
                continue;
            }
            let seat = &self.seats[crossing.member];
            for (two_pin, internal) in seat.winding_pins.iter().zip(&room.internal) {
                w.voltage[*two_pin] = *internal;
            }
        }
    }

    /// How the currents of a member change with its voltages, in `room`; `false` where it has no law of its own.
    fn find_reluctance(&self, crossing: &Crossing, c: &Context, w: &Work, room: &mut FloatRoom) -> bool {
        let seat = &self.seats[crossing.member];
        let Some(component) = seat.component() else { return false };
        let m = crossing.weights.len();
        room.internal.clear();
        room.internal.resize(m, 0.0);
        room.inverse.clear();
        room.inverse.resize(m * m, 0.0);
        component.reluctance(&self.flowing_law(c, seat, w), &mut room.internal, &mut room.inverse);
        true
    }

    /// `W' Gamma W` and, if wanted, `W' Gamma (u - v) - Q' j'`, or else zeros.
    pub(crate) fn assemble_floating(
        &self,
        floating: &Floating,
        c: &Context,
        w: &Work,
        room: &mut FloatRoom,
        of_voltages: bool,
    ) {
        let k = floating.parts;
        room.matrix.clear();
        room.matrix.resize(k * k, 0.0);
        room.phi.clear();
        room.phi.resize(k, 0.0);
        for crossing in &floating.crossing {
            if !self.find_reluctance(crossing, c, w, room) {
                continue;
            }
            let m = crossing.weights.len();
            self.winding_voltages(crossing.member, w, &mut room.voltage);
            room.product.clear();
            room.product.resize(m * k, 0.0);
            for i in 0..m {
                for j in 0..m {
                    for part in 0..k {
                        room.product[i * k + part] +=
                            room.inverse[i * m + j] * crossing.border[j * k + part] * crossing.weights[i];
                    }
                }
            }
            for i in 0..m {
                for a in 0..k {
                    if of_voltages {
                        room.phi[a] += room.product[i * k + a] * (room.internal[i] - room.voltage[i]);
                    }
                    for b in 0..k {
                        room.matrix[a * k + b] += crossing.border[i * k + a] * room.product[i * k + b];
                    }
                }
            }
        }
        if of_voltages {
            let slope = |(index, sign): &(usize, f64)| {
                self.electrics.slope_of(*index).map_or(0.0, |slope| sign * w.given[slope])
            };
            for (phi, driven) in room.phi.iter_mut().zip(&floating.driven) {
                *phi -= driven.iter().map(slope).sum::<f64>();
            }
            let is_curved = |crossing: &Crossing| self.seats[crossing.member].member.part.curved;
            // At rest nothing else says that currents of windings in series are one.
            let is_sought = c.d.get(self.seeks).is_some_and(|seeks| *seeks > 0.0);
            if is_sought || floating.crossing.iter().any(is_curved) {
                let free = floating.leaving.iter().zip(&floating.cut).zip(&mut room.phi);
                for ((leaving, _), phi) in free.filter(|((_, cut), _)| !**cut) {
                    *phi -= TOGETHER * leaving.iter().map(|(i, sign)| sign * w.given[*i]).sum::<f64>();
                }
            }
        }
        // The common potential of a group that windings do not connect to the rest is free here.
        for group in &floating.groups {
            let diagonal = group.iter().map(|(a, _)| room.matrix[a * k + a]);
            let scale = diagonal.sum::<f64>().max(f64::MIN_POSITIVE);
            for (a, by_a) in group {
                for (b, by_b) in group {
                    room.matrix[a * k + b] += scale * by_a * by_b;
                }
            }
        }
    }

    /// Voltages of the windings of a member in the coordinates of its reluctance.
    pub(crate) fn winding_voltages(&self, member: usize, w: &Work, out: &mut Vec<f64>) {
        let seat = &self.seats[member];
        out.clear();
        match seat.role.joined() {
            Some(joined) => out.extend(coordinates(joined, &w.voltage[seat.two_pins.clone()])),
            None => out.extend(seat.winding_pins.iter().map(|two_pin| w.voltage[*two_pin])),
        }
    }

    /// Solves for the potentials and adds them to the voltages.
    pub(crate) fn settle_floating(
        &self,
        island: usize,
        floating: &Floating,
        room: &mut FloatRoom,
        w: &mut Work,
    ) {
        solve_symmetric(&mut room.matrix, &mut room.phi);
        self.shift(island, floating, &room.phi, w);
        self.leak(island, floating, room, w);
    }

    fn shift(&self, island: usize, floating: &Floating, phi: &[f64], w: &mut Work) {
        for (position, parts) in &floating.shifts {
            let index = self.electrics.islands[island].two_pins[*position].index;
            w.voltage[index] += parts.iter().map(|(part, sign)| sign * phi[*part]).sum::<f64>();
        }
    }

    /// Lets leakage decide the potentials of groups that only open valves connect.
    fn leak(&self, island: usize, floating: &Floating, room: &mut FloatRoom, w: &mut Work) {
        let g = floating.groups.len();
        if g == 0 {
            return;
        }
        let two_pins = &self.electrics.islands[island].two_pins;
        room.phi.fill(0.0);
        for a in 0..g {
            let mut common = 0.0;
            for b in 0..g {
                let pull: f64 =
                    floating.leaks.iter().map(|(at, z)| z[b] * w.voltage[two_pins[*at].index]).sum();
                common -= floating.leak_inverse[a * g + b] * pull;
            }
            floating.groups[a].iter().for_each(|(part, by)| room.phi[*part] += common * by);
        }
        self.shift(island, floating, &room.phi, w);
    }
}

/// Solves `A x = b` for a symmetric positive semidefinite matrix stored by rows; a direction without stiffness stays.
pub(crate) fn solve_symmetric(a: &mut [f64], b: &mut [f64]) {
    let n = b.len();
    for k in 0..n {
        let pivot = a[k * n + k];
        if pivot <= 0.0 {
            continue;
        }
        for i in k + 1..n {
            let factor = a[i * n + k] / pivot;
            for j in k..n {
                a[i * n + j] -= factor * a[k * n + j];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        let pivot = a[k * n + k];
        let rest: f64 = (k + 1..n).map(|j| a[k * n + j] * b[j]).sum();
        b[k] = if pivot > 0.0 { (b[k] - rest) / pivot } else { 0.0 };
    }
}
