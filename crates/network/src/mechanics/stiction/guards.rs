//! When a mode ends: a speed that comes to zero, a torque that reaches what is held.

use blocksim_block::Context;

use super::{FAR, OPEN, ROUNDING};
use crate::network::Network;
use crate::work::Work;

impl Network {
    /// Distance from the end of each mode.
    pub(crate) fn stiction_guards(&self, c: &Context, w: &mut Work, g: &mut [f64]) {
        if !self.stiction.parts.is_empty() {
            self.without_drift(c, w, |w| self.distances(c, w, g));
        }
    }

    fn distances(&self, c: &Context, w: &Work, g: &mut [f64]) {
        let g = &mut g[self.stiction.guards.clone()];
        for (i, (g, mode)) in g.iter_mut().zip(self.stiction.of(c.d)).enumerate() {
            // Before the end of a travel the way it moves makes no difference.
            let before_end = w.grip[i].stop.is_some() && w.grip[i].hold == [0.0; 2];
            *g = if *mode == OPEN {
                // Pressed again, it needs another mode at once.
                if self.is_open(i, w) { FAR } else { -FAR }
            } else if before_end && *mode != 0.0 {
                FAR
            } else if *mode == 0.0 {
                let [forward, backward] = self.reserve(i, w.grip[i].hold, w);
                forward.min(backward).min(FAR)
            } else {
                let (speed, zero, _) = self.slip(i, c.x, &w.s);
                (mode * speed + zero).min(self.jam(i, *mode, w))
            };
        }
    }

    /// What a part that is stuck could still bear in either direction, N*m: the guard and the verdict are the same number.
    pub(super) fn reserve(&self, i: usize, hold: [f64; 2], w: &Work) -> [f64; 2] {
        let (torque, noise) = (self.resistance(i, w), self.noise(i, w));
        [(hold[0] - torque) + noise, (hold[1] + torque) + noise]
    }

    /// What rounding makes of the torque of a part that is stuck, N*m: a part of what pulls at the network, as it reaches
    /// this part.
    pub(super) fn noise(&self, i: usize, w: &Work) -> f64 {
        let scale = self.row_of(i, w).map_or(0.0, |row| w.schur.scale(row));
        if scale > 0.0 { ROUNDING * w.pull / scale } else { 0.0 }
    }

    /// Evaluates as if the loops had not drifted, and lets `then` read it: what closes the gaps that steps have left is no
    /// load on a friction. Nor is the motion that does so: the accelerations of a drift contradict what is stuck beside it, where
    /// constraints depend on each other. Without loops, `w` holds the evaluation at `c` already.
    pub(super) fn without_drift<T>(&self, c: &Context, w: &mut Work, then: impl FnOnce(&mut Work) -> T) -> T {
        if self.frames.loops.is_empty() {
            return then(w);
        }
        w.loops.drifts = false;
        self.again(c, w);
        if !w.stuck.is_empty() {
            let mut fitting = std::mem::take(&mut w.fitting_x);
            fitting.copy_from_slice(c.x);
            self.stop(w, &mut fitting);
            self.again(&Context { x: &fitting, ..*c }, w);
            w.fitting_x = fitting;
        }
        let result = then(w);
        w.loops.drifts = true;
        w.evaluation = [u64::MAX; 3];
        result
    }

    /// Evaluates at changed states and modes.
    pub(super) fn again(&self, c: &Context, w: &mut Work) {
        w.evaluation = [u64::MAX; 3];
        self.motion_phase(c, w);
    }
}
