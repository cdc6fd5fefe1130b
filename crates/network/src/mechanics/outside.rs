//! What acts on bodies from outside, and bodies that come and go.

use blocksim_block::Context;
use blocksim_block::physical::{FrameAcceleration, Wrench};
use blocksim_multibody::{Force, add_force, forward_accelerations, forward_velocities};

use crate::network::Network;
use crate::work::Work;

impl Network {
    /// Pose and velocity of the frames that members look at.
    pub(crate) fn frame_motion(&self, q: &[f64], w: &mut Work) {
        let (Some(model), Some(data)) = (&self.frames.model, &mut w.data) else { return };
        forward_velocities(model, data, q, &w.joint_speed);
        for (to, probe) in w.frame_motion.iter_mut().zip(&self.frames.probes) {
            *to = probe.place.motion(data);
        }
    }

    /// Accelerations of the frames that members look at, once those of the joints are known.
    pub(crate) fn frame_accelerations(&self, q: &[f64], w: &mut Work) {
        let (Some(model), Some(data)) = (&self.frames.model, &mut w.data) else { return };
        forward_accelerations(model, data, q, &w.joint_speed, &w.joint_acceleration);
        for (to, probe) in w.frame_acceleration.iter_mut().zip(&self.frames.probes) {
            let found = probe.place.acceleration(data);
            *to = FrameAcceleration { angular: found.angular.into(), linear: found.linear.into() };
        }
    }

    /// Torques at the joints of the forces that members apply to frames; shares of payloads.
    pub(crate) fn outside_forces(&self, c: &Context, w: &mut Work) {
        if self.frames.probes.is_empty() && self.frames.payloads.is_empty() {
            return;
        }
        let mut wrench = std::mem::take(&mut w.wrench);
        for seat in self.active.frames.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.component() {
                wrench[seat.frames.clone()].fill(Wrench::default());
                component.wrenches(&self.moving_law(c, seat, w), &mut wrench[seat.frames.clone()]);
            }
        }
        w.wrench = wrench;
        w.joint_outside.fill(0.0);
        let (Some(model), Some(data)) = (&self.frames.model, &w.data) else { return };
        for (probe, wrench) in self.frames.probes.iter().zip(&w.wrench).filter(|(probe, _)| probe.acts) {
            let Some(body) = probe.place.body else { continue };
            let force = Force { angular: wrench.torque.into(), linear: wrench.force.into() };
            add_force(model, data, body, &probe.place.placement.translation, &force, &mut w.joint_outside);
        }
        self.payloads(c, w);
    }

    /// Puts what is attached into the mass properties of the bodies.
    fn payloads(&self, c: &Context, w: &mut Work) {
        for (k, payload) in self.frames.payloads.iter().enumerate() {
            let seat = &self.seats[payload.member];
            if let Some(component) = seat.component() {
                w.load[k] = component.load(&self.known_law(c, seat));
            }
        }
        self.weigh(w);
    }

    /// The same for the shares that the working space has.
    pub(crate) fn weigh(&self, w: &mut Work) {
        let (Some(model), Some(loaded)) = (&self.frames.model, &mut w.loaded) else { return };
        loaded.copy_inertias(model);
        for (payload, share) in self.frames.payloads.iter().zip(&w.load) {
            if let Some(body) = payload.body {
                loaded.add_load(body, &payload.inertia, *share);
            }
        }
    }
}
