//! Heat of parts: what their laws dissipate flows into a thermal network.
//!
//! Heat follows from torques, voltages and currents together, so it comes last. The temperature where it flows is a state, so nothing
//! that was known before changes with it but flows of heat.

use blocksim_block::Context;
use blocksim_block::physical::{Domain, LossModel};

use crate::electrics::Branch;
use crate::network::Network;
use crate::seat::Seat;
use crate::work::Work;

impl Network {
    /// Heat flows of all parts that have a port for them, and what they change; after torques and accelerations.
    pub(crate) fn heats(&self, c: &Context, w: &mut Work) {
        let heats = &self.electrics.heats;
        if heats.is_empty() {
            return;
        }
        let mut flows = std::mem::take(&mut w.heats);
        let mut first = 0;
        while first < heats.len() {
            let member = heats[first].member;
            let ports = heats[first..].iter().take_while(|heat| heat.member == member).count();
            let seat = &self.seats[member];
            if let Some(component) = seat.component() {
                let law = self.flowing_law(c, seat, w);
                let dissipated = component.energy(&law).dissipated + self.booked(seat, w);
                component.heats(&law, dissipated, &mut flows[first..first + ports]);
            }
            for (heat, flow) in heats.iter().zip(&flows).skip(first).take(ports) {
                w.given[heat.given] = -flow;
            }
            first += ports;
        }
        w.heats = flows;
        for (index, island) in self.electrics.islands.iter().enumerate().filter(|(_, i)| !i.heats.is_empty())
        {
            let Work { circuits, given, current, .. } = w;
            let solved = &circuits[index].now().currents;
            for (pin, form) in island.two_pins.iter().zip(solved) {
                if pin.domain == Domain::Thermal && !matches!(pin.branch, Branch::Characteristic(..)) {
                    current[pin.index] = form.of(given);
                }
            }
        }
    }

    /// What the network books as heat for a member, W: friction, meshes, resistances and valves.
    fn booked(&self, seat: &Seat, w: &Work) -> f64 {
        let r = &self.rotation;
        let mut heat = 0.0;
        for friction in seat.frictions.clone() {
            let branch = r.smooth + friction;
            heat += w.torque[branch].value * w.pin_speed[r.branches[branch]];
        }
        for mesh in seat.gears.clone().filter_map(|gear| r.all_gears[gear].1) {
            let stuck = self.meshes[mesh].model == LossModel::Stiction && w.mesh.dry[mesh].1 == 0.0;
            heat += if stuck { 0.0 } else { w.mesh.loss[mesh] * w.mesh_speed[mesh] };
        }
        for (two_pin, dissipates) in seat.two_pins.clone().zip(&seat.dissipates) {
            if *dissipates {
                heat += w.voltage[two_pin] * w.current[two_pin];
            }
        }
        heat
    }
}
