//! First phase of an evaluation: the speeds of everything.

use blocksim_block::Context;
use blocksim_block::physical::JointMotion;

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
        let (q, v) = (&c.x[..self.joints], &c.x[self.joints..self.joints + self.rotation.free]);
        if !w.s.is_empty() {
            let (mut s, mut ds) = (std::mem::take(&mut w.s), std::mem::take(&mut w.ds));
            for seat in self.active.speed_sources.iter().map(|i| &self.seats[*i]) {
                if let Some(component) = seat.member.block.component() {
                    let range = seat.speed_sources.clone();
                    component.speeds(&self.law(c, seat, w), &mut s[range.clone()], &mut ds[range]);
                }
            }
            (w.s, w.ds) = (s, ds);
        }
        let r = &self.rotation;
        for (i, q) in q.iter().enumerate() {
            w.joint_speed[i] = r.joints[i].of(v) + r.joints_prescribed[i].of(&w.s);
            w.joint_motion[i] = JointMotion { q: *q, w: w.joint_speed[i], a: 0.0, drive: 0.0 };
        }
        for (to, pin) in w.pin_speed.iter_mut().zip(&r.pins) {
            *to = pin.speed.of(v) + pin.prescribed.of(&w.s);
        }
        if self.has_early {
            self.early_readings(c, w);
        }
    }
}
