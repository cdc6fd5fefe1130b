//! What a network knows of its stiffness, for linearly implicit methods.

pub(crate) mod linear;

use blocksim_block::Context;

use crate::network::Network;
use crate::work::Work;

impl Network {
    /// `J` holds the slopes of torques over speeds and the positions as integrals of speeds: for speeds
    /// `(M + hg C) dv = M r + D' lambda` with `D dv = D r` where constraints `D` hold, for positions `r + hg T dv`. What
    /// components know of their own states is eliminated, see [`linear`](crate::implicit::linear).
    pub(crate) fn prepare_implicit(&self, c: &Context, hg: f64, w: &mut Work) {
        self.motion_phase(c, w);
        let r = &self.rotation;
        self.envelope.clear(&mut w.damping);
        for (torque, pin) in w.torque.iter().zip(&r.branches).filter(|(torque, _)| torque.slope != 0.0) {
            self.envelope.square(&r.pins[*pin].speed, torque.slope, &mut w.damping);
        }
        for (torque, joint) in w.joint_torque.iter().zip(&r.joints).filter(|(torque, _)| torque.slope != 0.0)
        {
            self.envelope.square(joint, torque.slope, &mut w.damping);
        }
        for (gear, slope) in r.gears.iter().zip(&w.mesh.by_speed) {
            self.envelope.square(&gear.base, *slope, &mut w.damping);
        }
        self.envelope.sum(&mut w.implicit, &w.mass, hg, &w.damping);
        // Stages stand elsewhere. With a mass matrix of their own each would take another Jacobian, and the method would be of order one.
        w.implicit_mass.copy_from_slice(&w.mass);
        w.implicit_rows.copy_from(&w.rows);
        w.hg = hg;
        self.prepare_linear(c, hg, w);
        w.position.copy_from_slice(self.positions(c));
        if self.envelope.factor(&mut w.implicit).is_err() {
            c.fail("the mass matrix lost its positive definiteness: check masses and inertias");
            return;
        }
        if !w.implicit_rows.is_empty() {
            w.implicit_schur.factor(&w.implicit_rows, &w.implicit, &self.envelope);
        }
    }

    /// Overwrites `r` with `(I - hg J)^-1 r`.
    pub(crate) fn solve_implicit(&self, w: &mut Work, r: &mut [f64]) {
        let n = self.rotation.free;
        let (q, rest) = r.split_at_mut(self.positions);
        let (v, x) = rest.split_at_mut(n);
        self.envelope.product(&w.implicit_mass, v, &mut w.product);
        self.eliminate_states(w, x);
        self.envelope.solve(&w.implicit, &mut w.product);
        if !w.implicit_rows.is_empty() {
            // The Jacobian leaves `D v` alone, so the solution has that of `r`.
            w.implicit_schur.impose(&w.implicit_rows, &mut w.product, |i| w.implicit_rows.of(i, v));
            w.lock.settle_like(&mut w.product, v);
        }
        v.copy_from_slice(&w.product);
        self.return_states(w, v, x);
        for (to, joint) in w.joint_product.iter_mut().zip(&self.rotation.joints) {
            *to = w.hg * joint.of(v);
        }
        if self.frames.balls.is_empty() {
            q.iter_mut().zip(&w.joint_product).for_each(|(q, step)| *q += step);
        } else {
            self.position_rates(&w.position, &w.joint_product, &mut w.position_rate);
            q.iter_mut().zip(&w.position_rate).for_each(|(q, step)| *q += step);
        }
    }
}
