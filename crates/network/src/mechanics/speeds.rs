//! First phase of an evaluation: the speeds of everything.

use blocksim_block::Context;

use crate::network::Network;
use crate::seat::STATE;
use crate::work::Work;

impl Network {
    /// Speeds of everything.
    pub(crate) fn state_phase(&self, c: &Context, w: &mut Work) {
        if w.evaluation[STATE] == c.evaluation {
            return;
        }
        w.evaluation[STATE] = c.evaluation;
        let (q, v) = (self.positions(c), self.speeds(c));
        if !w.s.is_empty() {
            let (mut s, mut ds) = (std::mem::take(&mut w.s), std::mem::take(&mut w.ds));
            for seat in self.active.speed_sources.iter().map(|i| &self.seats[*i]) {
                if let Some(component) = seat.component() {
                    let range = seat.speed_sources.clone();
                    component.speeds(&self.known_law(c, seat), &mut s[range.clone()], &mut ds[range]);
                }
            }
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
