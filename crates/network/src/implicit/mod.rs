//! What a network knows of its stiffness, for linearly implicit methods.

pub(crate) mod linear;

use blocksim_block::Context;
use blocksim_solve::linear::{cholesky_factor, cholesky_solve};

use crate::network::Network;
use crate::work::Work;

impl Network {
    /// `J` holds the slopes of torques over speeds and the positions as integrals of speeds: for speeds
    /// `(M + hg C) dv = M r + D' lambda` with `D dv = D r` where constraints `D` hold, for positions `r + hg T dv`. What
    /// components know of their own states is eliminated, see [`linear`](crate::implicit::linear).
    pub(crate) fn prepare_implicit(&self, c: &Context, hg: f64, w: &mut Work) {
        self.motion_phase(c, w);
        let r = &self.rotation;
        let n = r.free;
        w.damping.fill(0.0);
        for (torque, pin) in w.torque.iter().zip(&r.branches).filter(|(torque, _)| torque.slope != 0.0) {
            r.pins[*pin].speed.square_to(torque.slope, &mut w.damping, n);
        }
        for (torque, joint) in w.joint_torque.iter().zip(&r.joints).filter(|(torque, _)| torque.slope != 0.0)
        {
            joint.square_to(torque.slope, &mut w.damping, n);
        }
        for (gear, slope) in r.gears.iter().zip(&w.mesh.by_speed) {
            gear.base.square_to(*slope, &mut w.damping, n);
        }
        for ((to, mass), damping) in w.implicit.iter_mut().zip(&w.mass).zip(&w.damping) {
            *to = mass + hg * damping;
        }
        w.hg = hg;
        self.prepare_linear(c, hg, w);
        w.position.copy_from_slice(self.positions(c));
        if cholesky_factor(&mut w.implicit, n).is_err() {
            c.fail("the mass matrix lost its positive definiteness: check masses and inertias");
            return;
        }
        if !w.rows.is_empty() {
            w.implicit_schur.factor(&w.rows, &w.implicit);
        }
    }

    /// Overwrites `r` with `(I - hg J)^-1 r`.
    pub(crate) fn solve_implicit(&self, w: &mut Work, r: &mut [f64]) {
        let n = self.rotation.free;
        let (q, rest) = r.split_at_mut(self.positions);
        let (v, x) = rest.split_at_mut(n);
        for (row, to) in w.product.iter_mut().enumerate() {
            *to = w.mass[row * n..(row + 1) * n].iter().zip(v.iter()).map(|(m, v)| m * v).sum();
        }
        self.eliminate_states(w, x);
        cholesky_solve(&w.implicit, &mut w.product);
        if !w.rows.is_empty() {
            // The Jacobian leaves `D v` alone, so the solution has that of `r`.
            w.implicit_schur.impose(&w.rows, &mut w.product, |i| w.rows.of(i, v));
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
