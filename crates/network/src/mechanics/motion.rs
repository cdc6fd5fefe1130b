//! Third phase of an evaluation: torques, accelerations, and what the rigid parts must supply.

use blocksim_block::Context;
use blocksim_block::physical::Torque;
use blocksim_multibody::mass_and_bias;
use blocksim_solve::linear::cholesky_solve_matrix;

use crate::mechanics::mesh::{self, ARM};
use crate::mechanics::rotation::LossyGear;
use crate::network::Network;
use crate::seat::MOTION;
use crate::work::Work;

/// What the loss of each mesh takes from the torque into each other one, row by row.
#[inline(always)]
fn couple(gears: &[LossyGear], columns: &[f64], coupling: &mut [f64], g: usize) {
    for (gear, row) in gears.iter().zip(coupling.chunks_exact_mut(g)) {
        row.iter_mut().zip(&gear.by_loss[..g]).for_each(|(to, by_loss)| *to = -by_loss);
        for (speed, factor) in gear.by_acceleration.terms() {
            let column = &columns[*speed as usize * g..][..g];
            row.iter_mut().zip(column).for_each(|(to, value)| *to += factor * value);
        }
    }
}

/// Takes from the accelerations what the losses of meshes do to them.
#[inline(always)]
fn take_losses(dv: &mut [f64], columns: &[f64], loss: &[f64], g: usize) {
    for (dv, row) in dv.iter_mut().zip(columns.chunks_exact(g)) {
        *dv = loss[..g].iter().zip(row).fold(*dv, |dv, (loss, column)| dv - loss * column);
    }
}

impl Network {
    /// Mass matrix over the independent speeds, bias forces of the joints.
    pub(crate) fn mass(&self, q: &[f64], w: &mut Work) {
        let (n, j) = (self.rotation.free, self.joints);
        if w.factored {
            return;
        }
        w.mass.copy_from_slice(&self.rotation.reflected);
        let (Some(model), Some(data)) = (w.loaded.as_ref().or(self.frames.model.as_ref()), &mut w.data)
        else {
            return;
        };
        mass_and_bias(model, data, q, &w.joint_speed, &mut w.joint_mass, &mut w.bias);
        if self.rotation.joints_are_free {
            let rows = w.mass.chunks_exact_mut(n.max(1)).zip(w.joint_mass.chunks_exact(j.max(1)));
            rows.for_each(|(to, from)| to.iter_mut().zip(from).for_each(|(to, from)| *to += from));
            return;
        }
        for row in 0..j {
            for column in 0..j {
                let value = w.joint_mass[row * j + column];
                for (a, fa) in self.rotation.joints[row].terms() {
                    for (b, fb) in self.rotation.joints[column].terms() {
                        w.mass[*a as usize * n + *b as usize] += fa * value * fb;
                    }
                }
            }
        }
    }

    /// Torques and accelerations.
    pub(crate) fn motion_phase(&self, c: &Context, w: &mut Work) {
        if w.evaluation[MOTION] == c.evaluation {
            return;
        }
        self.electrics_phase(c, w);
        w.evaluation[MOTION] = c.evaluation;
        let r = &self.rotation;

        let mut torque = std::mem::take(&mut w.torque);
        for seat in self.active.branches.iter().map(|i| &self.seats[*i]) {
            if let Some(held) = &seat.held {
                let courses = held.torque.clone().zip(held.course.clone());
                for (to, (mean, rise)) in torque[seat.branches.clone()].iter_mut().zip(courses) {
                    let value = c.d[mean] + c.d[rise] * held.place(c);
                    *to = Torque { value, slope: 0.0 };
                }
            } else if let Some(component) = seat.component() {
                component.torques(&self.flowing_law(c, seat, w), &mut torque[seat.branches.clone()]);
            }
        }
        w.torque = torque;
        self.sliding_torques(c, w);
        self.joint_torques(c, w);
        self.outside_forces(c, w);

        // (M + T'JT) dv = T' tau - T_j' (h + M P ds) - T_n' J P ds
        self.mass(self.positions(c), w);
        w.force.fill(0.0);
        for (torque, pin) in w.torque.iter().zip(&r.branches) {
            r.pins[*pin].speed.add_to(-torque.value, &mut w.force);
        }
        for joint in 0..self.joints {
            let mut value = w.joint_torque[joint].value + w.joint_outside[joint] - w.bias[joint];
            if !w.ds.is_empty() {
                for other in 0..self.joints {
                    value -= w.joint_mass[joint * self.joints + other] * r.joints_prescribed[other].of(&w.ds);
                }
            }
            r.joints[joint].add_to(value, &mut w.force);
        }
        if !w.ds.is_empty() {
            for (node, inertia) in r.inertia.iter().enumerate().filter(|(_, inertia)| **inertia != 0.0) {
                r.nodes[node].add_to(-inertia * r.nodes_prescribed[node].of(&w.ds), &mut w.force);
            }
        }
        if !self.frames.loops.is_empty() {
            self.close_loops(self.positions(c), w);
        }
        if !w.factored {
            w.factor.copy_from_slice(&w.mass);
            if self.envelope.factor(&mut w.factor).is_err() {
                c.fail("the mass matrix lost its positive definiteness: check masses and inertias");
                w.dv.fill(0.0);
                return;
            }
            w.factored = self.frames.model.is_none();
        }
        w.dv.copy_from_slice(&w.force);
        self.envelope.solve(&w.factor, &mut w.dv);
        self.constrain(c, w);
        if !self.meshes.is_empty() {
            self.dry_meshes(c, w);
            self.meshes(c, w);
            self.holding_torques(w);
            self.mesh_grips(w);
        }
        w.lock.settle(&mut w.dv, &w.ds);
        self.heats(c, w);
    }

    /// Losses of gear meshes, and what they change about the accelerations.
    pub(crate) fn meshes(&self, c: &Context, w: &mut Work) {
        let r = &self.rotation;
        let (n, g, m) = (r.free, self.meshes.len(), w.rows.len());
        let v = self.speeds(c);
        for (i, gear) in r.gears.iter().enumerate() {
            w.mesh_speed[i] = gear.base.of(v) + gear.base_prescribed.of(&w.s);
            let torques: f64 =
                gear.by_torque.terms().iter().map(|(b, f)| f * w.torque[*b as usize].value).sum();
            let stuck: f64 = self.stuck_meshes(w).map(|(row, h)| -gear.by_loss[h] * w.lambda[row]).sum();
            w.through[i] = gear.by_acceleration.of(&w.dv) + gear.by_prescribed.of(&w.ds) + torques + stuck;
        }
        // Columns M^-1 t' of all meshes, beside each other. A loss takes its column from the accelerations, and acts at
        // its base.
        w.columns.fill(0.0);
        for (h, gear) in r.gears.iter().enumerate() {
            gear.base.terms().iter().for_each(|(i, factor)| w.columns[*i as usize * g + h] += factor);
        }
        cholesky_solve_matrix(&w.factor, n, &mut w.columns);
        if !w.rows.is_empty() {
            for h in 0..g {
                for (i, to) in w.product.iter_mut().enumerate() {
                    *to = w.columns[i * g + h];
                }
                w.schur.impose(&w.rows, &mut w.product, |_| 0.0);
                w.product.iter().enumerate().for_each(|(i, value)| w.columns[i * g + h] = *value);
                w.mesh_lambda[h * m..(h + 1) * m].copy_from_slice(&w.schur.lambda[..m]);
            }
        }
        match g {
            ARM => couple(&r.gears, &w.columns, &mut w.coupling, ARM),
            g => couple(&r.gears, &w.columns, &mut w.coupling, g),
        }
        if !w.rows.is_empty() {
            for i in 0..g {
                for h in 0..g {
                    // What is stuck gives way to the loss: its share of the torques changes as well.
                    let held: f64 =
                        self.stuck_shares(i, w).map(|(row, by)| by * w.mesh_lambda[h * m + row]).sum();
                    w.coupling[i * g + h] -= held;
                }
            }
        }
        self.find_jams(w);
        if !mesh::solve(&mut w.mesh, &self.meshes, &w.mesh_speed, &w.coupling, &w.through) {
            c.fail(self.self_locking(w).unwrap_or_else(|| {
                "the losses of the gears have no solution: with efficiencies below 0.3 write `loss: Stiction`".into()
            }));
            return;
        }
        match g {
            ARM => take_losses(&mut w.dv, &w.columns, &w.mesh.loss, ARM),
            g => take_losses(&mut w.dv, &w.columns, &w.mesh.loss, g),
        }
        for (h, loss) in w.mesh.loss.iter().enumerate() {
            for (lambda, share) in w.lambda.iter_mut().zip(&w.mesh_lambda[h * m..(h + 1) * m]) {
                *lambda -= loss * share;
            }
        }
    }

    /// `J dw - tau` of every node: what the rigid parts must supply.
    pub(crate) fn residuals(&self, w: &mut Work) {
        let r = &self.rotation;
        for (node, (to, inertia)) in w.residual.iter_mut().zip(&r.inertia).enumerate() {
            let inertia = *inertia;
            *to = if inertia == 0.0 {
                0.0
            } else {
                inertia * (r.nodes[node].of(&w.dv) + r.nodes_prescribed[node].of(&w.ds))
            };
        }
        for (torque, (rod, case)) in w.torque.iter().zip(&r.branch_nodes) {
            w.residual[*rod] += torque.value;
            w.residual[*case] -= torque.value;
        }
        for (gear, loss) in r.gears.iter().zip(&w.mesh.loss) {
            w.residual[gear.base_node] += loss;
        }
    }

    /// `M qdd + h - tau` of every joint: what its drive side must supply.
    pub(crate) fn joint_residuals(&self, w: &mut Work) {
        let j = self.joints;
        for joint in 0..j {
            let row = &w.joint_mass[joint * j..(joint + 1) * j];
            let inertial: f64 = row.iter().zip(&w.joint_acceleration).map(|(mass, a)| mass * a).sum();
            w.residual[self.rotation.nodes.len() + joint] =
                inertial + w.bias[joint] - w.joint_torque[joint].value - w.joint_outside[joint];
        }
        // What closed loops bear.
        for (row, lambda) in w.loops.joint_rows.chunks_exact(j.max(1)).zip(&w.lambda) {
            for (joint, d) in row.iter().enumerate() {
                w.residual[self.rotation.nodes.len() + joint] -= lambda * d;
            }
        }
    }

    /// Accelerations and inner torques, for sensors.
    pub(crate) fn inner_torques(&self, w: &mut Work) {
        let r = &self.rotation;
        self.joint_accelerations(w);
        self.residuals(w);
        if r.needs_joint_balance {
            self.joint_residuals(w);
        }
        for (speed, drive) in self.frames.speeds.iter().zip(&r.drives) {
            w.joint_load[speed.user].drive = drive.of(&w.residual);
        }
        for (i, pin) in r.pins.iter().enumerate() {
            w.pin_acceleration[i] = pin.speed.of(&w.dv) + pin.prescribed.of(&w.ds);
            w.pin_torque[i] = match pin.branch {
                Some(branch) => w.torque[branch].value,
                None => pin.reaction.of(&w.residual),
            };
        }
        for (i, (through, lossy)) in r.all_gears.iter().enumerate() {
            let loss = lossy.map_or(0.0, |lossy| w.mesh.loss[lossy]);
            w.all_mesh[i] = through.of(&w.residual) + loss;
        }
    }
}
