//! Second phase of an evaluation: supplies, voltages and currents.

use blocksim_block::Context;

use crate::electrics::CurrentOf;
use crate::network::Network;
use crate::seat::ELECTRICS;
use crate::work::Work;

impl Network {
    /// Currents of windings, and what follows from them; of those that are states, or of all.
    pub(crate) fn currents(&self, c: &Context, w: &mut Work, early: bool) {
        let mut winding = std::mem::take(&mut w.winding);
        for seat in self.active.windings.iter().map(|i| &self.seats[*i]) {
            // What follows from states was computed with them.
            let from_state = seat.windings.clone().all(|i| self.electrics.from_state[i]);
            if self.has_early && early != from_state {
                continue;
            }
            if let Some(component) = seat.member.block.component() {
                component.currents(&self.law(c, seat, w), &mut winding[seat.windings.clone()]);
            }
        }
        for (to, from) in w.current.iter_mut().zip(&self.electrics.currents) {
            *to = match from {
                CurrentOf::Winding(i) => winding[*i],
                CurrentOf::Balance(form) => form.of(&winding),
                CurrentOf::Open => 0.0,
            };
        }
        w.winding = winding;
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
        let mut source = std::mem::take(&mut w.source);
        for seat in self.active.sources.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.member.block.component() {
                component.voltages(&self.law(c, seat, w), &mut source[seat.sources.clone()]);
            }
        }
        for (to, form) in w.voltage.iter_mut().zip(&self.electrics.voltages) {
            *to = form.of(&source);
        }
        w.source = source;
        self.currents(c, w, false);
    }
}
