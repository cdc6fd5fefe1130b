//! Currents of inductances that have lost their path when a contact opened: the volt-seconds of the arc that this would
//! mean tell which valves take the current over.

use blocksim_block::Context;
use blocksim_block::physical::ValveKind;

use crate::electrics::Conducting;
use crate::electrics::commutation::Wrong;
use crate::network::Network;
use crate::work::Work;

impl Network {
    /// Largest current that enters a floating part and does not leave it, A. Where current sources lead into it, none is lost.
    pub(crate) fn lost(&self, island: usize, w: &Work) -> f64 {
        let Some(floating) = &w.circuits[island].now().floating else { return 0.0 };
        let free = floating.leaving.iter().zip(&floating.cut).filter(|(_, cut)| !**cut);
        free.map(|(leaving, _)| leaving.iter().map(|(i, sign)| sign * w.given[*i]).sum::<f64>().abs())
            .fold(0.0, f64::max)
    }

    /// Volt-seconds that would end the currents without a path: the potentials of the floating parts in `w.float.phi`,
    /// the voltages of all two-pins in `w.voltage`.
    fn volt_seconds(&self, island: usize, c: &Context, w: &mut Work) {
        let circuits = std::mem::take(&mut w.circuits);
        if let Some(floating) = &circuits[island].now().floating {
            let mut room = std::mem::take(&mut w.float);
            self.assemble_floating(floating, c, w, &mut room, false);
            let free =
                floating.leaving.iter().zip(&floating.cut).zip(&mut room.phi).filter(|((_, cut), _)| !**cut);
            for ((leaving, _), phi) in free {
                *phi = -leaving.iter().map(|(i, sign)| sign * w.given[*i]).sum::<f64>();
            }
            self.settle_floating(island, floating, &mut room, w);
            w.float = room;
        }
        w.circuits = circuits;
    }

    /// The valve that the arc would drive hardest to conduct.
    pub(crate) fn takes_over(
        &self,
        island: usize,
        c: &Context,
        w: &mut Work,
        conducting: Conducting,
    ) -> Wrong {
        for pin in &self.electrics.islands[island].two_pins {
            w.voltage[pin.index] = 0.0;
        }
        self.volt_seconds(island, c, w);
        let mut best = (0.0, None);
        for (bit, index) in self.electrics.islands[island].valves.iter().enumerate() {
            let valve = &self.electrics.valves[*index];
            let gated = matches!(valve.kind, ValveKind::GatedDiode | ValveKind::Thyristor);
            let may = self.is_natural(*index) && (!gated || w.gates[*index]);
            if may && conducting >> bit & 1 == 0 && w.voltage[valve.two_pin] > best.0 {
                best = (w.voltage[valve.two_pin], Some(bit));
            }
        }
        best.1.map_or(Wrong::Arc, |bit| Wrong::Valve(bit, 0.0))
    }

    /// Ends the currents that have no path.
    pub(crate) fn strike(&self, island: usize, c: &Context, w: &mut Work, x: &mut [f64]) {
        for pin in &self.electrics.islands[island].two_pins {
            w.voltage[pin.index] = 0.0;
        }
        self.volt_seconds(island, c, w);
        let circuits = std::mem::take(&mut w.circuits);
        if let Some(floating) = &circuits[island].now().floating {
            for crossing in &floating.crossing {
                let seat = &self.seats[crossing.member];
                let Some(component) = seat.component() else { continue };
                let mut flux = std::mem::take(&mut w.flux);
                self.winding_voltages(crossing.member, w, &mut flux);
                component.strike(&self.law(c, seat, w), &flux, &mut x[seat.x.clone()]);
                w.flux = flux;
            }
        }
        w.circuits = circuits;
    }

    pub(crate) fn arc(&self, island: usize, c: &Context, w: &Work) -> String {
        let circuit = &self.electrics.islands[island];
        let mut opened: Vec<&str> = circuit
            .valves
            .iter()
            .map(|valve| &self.electrics.valves[*valve])
            .map(|valve| self.seats[valve.member].member.path.as_str())
            .collect();
        opened.dedup();
        let floating = w.circuits[island].now().floating.as_ref();
        let mut interrupted: Vec<&str> = floating
            .into_iter()
            .flat_map(|floating| &floating.crossing)
            .map(|crossing| self.seats[crossing.member].member.path.as_str())
            .collect();
        interrupted.dedup();
        format!(
            "at {} s the valves (`{}`) interrupt the current of an inductance (`{}`): connect a freewheeling diode or \
             a resistance in parallel, or give the valve an off-state conductance",
            c.t,
            opened.join("`, `"),
            interrupted.join("`, `")
        )
    }
}
