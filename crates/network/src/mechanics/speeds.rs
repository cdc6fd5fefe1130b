//! First phase of an evaluation: the speeds of everything.

use blocksim_block::Context;

use crate::network::Network;
use crate::seat::STATE;
use crate::work::Work;

impl Network {
    /// Prescribed speeds and their derivatives.
    fn prescribed_speeds(&self, c: &Context, s: &mut [f64], ds: &mut [f64]) {
        for seat in self.active.speed_sources.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.component() {
                let range = seat.speed_sources.clone();
                component.speeds(&self.known_law(c, seat), &mut s[range.clone()], &mut ds[range]);
            }
        }
    }

    /// Notes the prescribed speeds at the end of a step, where dry friction has to know whether they jump behind it.
    pub(crate) fn note_prescribed_speeds(&self, c: &Context, d: &mut [f64]) {
        let cells = self.stiction.sources.clone();
        if cells.is_empty() {
            return;
        }
        let (members, own) = d[..cells.end].split_at_mut(cells.start);
        let (s, ds) = own.split_at_mut(self.rotation.sources);
        self.prescribed_speeds(&Context { d: members, ..*c }, s, ds);
    }

    /// Speeds of everything.
    pub(crate) fn state_phase(&self, c: &Context, w: &mut Work) {
        if w.evaluation[STATE] == c.evaluation {
            return;
        }
        w.evaluation[STATE] = c.evaluation;
        let (q, v) = (self.positions(c), self.speeds(c));
        if !w.s.is_empty() {
            let (mut s, mut ds) = (std::mem::take(&mut w.s), std::mem::take(&mut w.ds));
            self.prescribed_speeds(c, &mut s, &mut ds);
            (w.s, w.ds) = (s, ds);
        }
        let r = &self.rotation;
        self.joint_motion(q, v, w);
        if !self.frames.probes.is_empty() {
            self.frame_motion(q, w);
        }
        for (to, pin) in w.pin_speed.iter_mut().zip(&r.pins) {
            *to = pin.speed.of(v) + pin.prescribed.of(&w.s);
        }
        self.still_pins(c, w);
        if self.has_early {
            self.early_readings(c, w);
        }
    }
}
