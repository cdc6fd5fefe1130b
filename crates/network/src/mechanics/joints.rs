//! Joints as their members see them, and as the tree has them.
//!
//! A member counts the speeds of its joint from `base` to `follower`. The tree counts from the world outwards, so a
//! joint whose `follower` is nearer to the world has its freedoms in reverse; an axis then only points the other way,
//! but a ball turns the other way round and has its speeds in the axes of the other frame.

use blocksim_block::Context;
use blocksim_block::physical::{JointMotion, Torque};
use blocksim_multibody::positions_derivative;
use nalgebra::{Matrix3, Vector3};

use crate::network::Network;
use crate::work::Work;

/// Rotation matrix of a quaternion (w, x, y, z) of any length.
pub(crate) fn rotation([w, x, y, z]: [f64; 4]) -> Matrix3<f64> {
    nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z))
        .to_rotation_matrix()
        .into_inner()
}

fn four(q: &[f64], at: usize) -> [f64; 4] {
    [q[at], q[at + 1], q[at + 2], q[at + 3]]
}

impl Network {
    /// Positions among the states.
    #[inline]
    pub(crate) fn positions<'a>(&self, c: &Context<'a>) -> &'a [f64] {
        c.x.get(..self.positions).unwrap_or(&[])
    }

    /// Independent speeds among the states.
    #[inline]
    pub(crate) fn speeds<'a>(&self, c: &Context<'a>) -> &'a [f64] {
        c.x.get(self.positions..self.positions + self.rotation.free).unwrap_or(&[])
    }

    /// Motion of the joints without accelerations.
    pub(crate) fn joint_motion(&self, q: &[f64], v: &[f64], w: &mut Work) {
        let r = &self.rotation;
        for (i, speed) in self.frames.speeds.iter().enumerate() {
            w.joint_speed[i] = r.joints[i].of(v) + r.joints_prescribed[i].of(&w.s);
            let q = speed.position.map_or(0.0, |at| q[at]);
            w.joint_motion[speed.user] = JointMotion { q, w: w.joint_speed[i] };
        }
        for (ball, to) in self.frames.balls.iter().zip(&mut w.orientation) {
            let p = four(q, ball.position);
            let scale = 1.0 / p.iter().map(|e| e * e).sum::<f64>().sqrt();
            let sign = if ball.flipped { -scale } else { scale };
            *to = [scale * p[0], sign * p[1], sign * p[2], sign * p[3]];
            if ball.flipped {
                let speeds = -(rotation(p) * three(&w.joint_speed, ball.speed));
                (0..3).for_each(|k| w.joint_motion[ball.user + k].w = speeds[k]);
            }
        }
    }

    /// Torques that members apply to their own joints, in the order of the tree.
    pub(crate) fn joint_torques(&self, c: &Context, w: &mut Work) {
        let mut torque = std::mem::take(&mut w.user_torque);
        for seat in self.active.joints.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.component() {
                torque[seat.joint.clone()].fill(Torque::default());
                component.joint_torques(&self.moving_law(c, seat, w), &mut torque[seat.joint.clone()]);
            }
        }
        for (to, speed) in w.joint_torque.iter_mut().zip(&self.frames.speeds) {
            *to = torque[speed.user];
        }
        for (ball, p) in self.frames.balls.iter().zip(&w.orientation).filter(|(ball, _)| ball.flipped) {
            // the orientation of `follower` in `base` is R'
            let tau = [0, 1, 2].map(|k| torque[ball.user + k].value);
            let value = -(rotation(*p) * Vector3::from(tau));
            (0..3).for_each(|k| w.joint_torque[ball.speed + k].value = value[k]);
        }
        w.user_torque = torque;
    }

    /// Accelerations of the joints, in the order of the tree and as members see them.
    pub(crate) fn joint_accelerations(&self, w: &mut Work) {
        let r = &self.rotation;
        for (i, speed) in self.frames.speeds.iter().enumerate() {
            w.joint_acceleration[i] = r.joints[i].of(&w.dv) + r.joints_prescribed[i].of(&w.ds);
            w.joint_load[speed.user].a = w.joint_acceleration[i];
        }
        for (ball, p) in self.frames.balls.iter().zip(&w.orientation).filter(|(ball, _)| ball.flipped) {
            let a = -rotation(*p).tr_mul(&three(&w.joint_acceleration, ball.speed));
            (0..3).for_each(|k| w.joint_load[ball.user + k].a = a[k]);
        }
    }

    /// Draws orientations to length 1 in a search for rest, where nothing else says how long they are.
    pub(crate) fn keep_length(&self, q: &[f64], dq: &mut [f64]) {
        for ball in &self.frames.balls {
            let p = four(q, ball.position);
            let excess = p.iter().map(|e| e * e).sum::<f64>() - 1.0;
            (0..4).for_each(|k| dq[ball.position + k] -= excess * p[k]);
        }
    }

    /// Derivatives of the positions.
    pub(crate) fn position_rates(&self, q: &[f64], speed: &[f64], dq: &mut [f64]) {
        match &self.frames.model {
            Some(model) if !self.frames.balls.is_empty() => positions_derivative(model, q, speed, dq),
            _ => dq.copy_from_slice(speed),
        }
    }
}

fn three(values: &[f64], at: usize) -> Vector3<f64> {
    Vector3::new(values[at], values[at + 1], values[at + 2])
}
