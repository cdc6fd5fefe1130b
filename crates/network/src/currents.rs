//! Second phase of an evaluation: supplies, voltages and currents.

use blocksim_block::Context;

use crate::electrics::GivenBy;
use crate::eliminate::Form;
use crate::network::Network;
use crate::seat::{ELECTRICS, Seat};
use crate::work::Work;

impl Network {
    /// What sensors read that follows from states alone.
    pub(crate) fn early_readings(&self, c: &Context, w: &mut Work) {
        let mut given = std::mem::take(&mut w.given);
        self.source_voltages(c, w, &mut given, |seat| seat.is_capacitance);
        self.given_currents(c, w, &mut given, |by| by == GivenBy::State);
        for (two_pin, (voltage, current)) in w.voltage.iter_mut().zip(&mut w.current).enumerate() {
            if self.electrics.is_early(two_pin) {
                *voltage = self.electrics.voltages[two_pin].of(&given);
                *current = self.electrics.currents[two_pin].of(&given);
            }
        }
        w.given = given;
    }

    fn source_voltages(&self, c: &Context, w: &Work, given: &mut [f64], which: impl Fn(&Seat) -> bool) {
        for seat in self.active.sources.iter().map(|i| &self.seats[*i]).filter(|seat| which(seat)) {
            if let Some(component) = seat.member.block.component() {
                component.voltages(&self.law(c, seat, w), &mut given[seat.sources.clone()]);
            }
        }
    }

    fn given_currents(&self, c: &Context, w: &Work, given: &mut [f64], which: impl Fn(GivenBy) -> bool) {
        let first = self.electrics.sources;
        for seat in self.active.windings.iter().map(|i| &self.seats[*i]) {
            // A component writes all its currents; those that wait for a voltage are written again.
            if !seat.windings.clone().any(|i| which(self.electrics.windings[i])) {
                continue;
            }
            if let Some(component) = seat.member.block.component() {
                let range = first + seat.windings.start..first + seat.windings.end;
                component.currents(&self.law(c, seat, w), &mut given[range]);
            }
        }
    }

    /// Voltages and currents.
    pub(crate) fn electrics_phase(&self, c: &Context, w: &mut Work) {
        if w.evaluation[ELECTRICS] == c.evaluation {
            return;
        }
        self.state_phase(c, w);
        w.evaluation[ELECTRICS] = c.evaluation;
        for (i, member) in self.supplies.iter().enumerate() {
            let seat = &self.seats[*member];
            if let Some(component) = seat.member.block.component() {
                w.supply[i] = component.supply(&self.law(c, seat, w));
            }
        }
        if !w.supply.is_empty() {
            w.line_current.fill([0.0; 2]);
            for seat in self.active.machines.iter().map(|i| &self.seats[*i]) {
                if let (Some(component), Some(i)) = (seat.member.block.component(), seat.supply) {
                    let [d, q] = component.line_current(&self.law(c, seat, w));
                    w.line_current[i][0] += d;
                    w.line_current[i][1] += q;
                }
            }
        }
        if w.voltage.is_empty() {
            return;
        }
        let mut given = std::mem::take(&mut w.given);
        self.source_voltages(c, w, &mut given, |_| true);
        self.given_currents(c, w, &mut given, |by| by != GivenBy::Voltage);
        all(&self.electrics.voltages, &given, &mut w.voltage);
        if self.electrics.waits_for_voltages() {
            self.given_currents(c, w, &mut given, |by| by == GivenBy::Voltage);
            all(&self.electrics.voltages, &given, &mut w.voltage);
        }
        all(&self.electrics.currents, &given, &mut w.current);
        w.given = given;
    }
}

fn all(forms: &[Form], given: &[f64], out: &mut [f64]) {
    out.iter_mut().zip(forms).for_each(|(to, form)| *to = form.of(given));
}
