//! Closed loops of bodies: constraints between the speeds of a tree.
//!
//! Where a joint or a transform leads to a frame that the tree has reached already, the joint joins the tree with a
//! body of no mass at its end, and that end has to coincide with the frame: six rows `D v = 0`, the difference of two
//! Jacobians. In a plane three of them say nothing and others say the same twice; the solution finds that out
//! (see `constraints`).
//!
//! Bodies without mass make the mass matrix singular. With `M + D'WD` and `f + D'Wb` instead of `M` and `f` the
//! solution is the same, because `D dv = b` holds for it, and the matrix is positive definite wherever the mechanism
//! has inertia in all directions that its loops leave. The weights `W` make both parts equally large.
//!
//! Accelerations alone would let the loops drift apart with the error of the integrator. Baumgarte's stabilisation
//! pulls the gap `e` together, `e'' + 2 e'/T + e/T^2 = 0` with `T` = 50 ms: slow against steps that resolve a
//! mechanism, so that it never decides the step, and quick enough to hold the gap at the error of a few steps. It needs
//! no event and no jump, so that it works with every method and in every minor step.

use blocksim_block::Context;
use blocksim_multibody::{Data, add_jacobian, bias_accelerations, forward_kinematics};
use nalgebra::Vector3;

use crate::assembly::closing::{ACCEPTED, close};
use crate::mechanics::frames::Loop;
use crate::mechanics::place::rotation_vector;
use crate::network::Network;
use crate::work::Work;

/// Time constant in which a gap closes, s.
const SETTLE: f64 = 0.05;

/// A row whose entries are all below this part of the others of its kind (angles, lengths) is rounding: axes that are
/// parallel but for their last digits constrain nothing.
const ROUNDING: f64 = 1e-6;

/// A jump of a prescribed speed beyond this part of the speeds is passed on by impulses.
const MISFIT: f64 = 1e-3;
/// Rates of the gaps, rad/s and m/s, that the stabilisation of rounded positions brings while everything stands.
pub(crate) const AT_REST: f64 = 1e-9;

impl Loop {
    /// The angles, rad, and lengths, m, between its two ends, in the axes of the world.
    pub(crate) fn gap(&self, data: &Data) -> [Vector3<f64>; 2] {
        let (a, b) = (self.a.in_world(data), self.b.in_world(data));
        [rotation_vector(&(b.rotation * a.rotation.transpose())), b.translation - a.translation]
    }
}

impl Network {
    /// Writes the rows of all loops at the positions `q` and the current speeds, and lets the mass matrix and the
    /// forces know of them.
    pub(crate) fn close_loops(&self, q: &[f64], w: &mut Work) {
        let (Some(model), Some(data)) = (&self.frames.model, &mut w.data) else { return };
        let (j, n) = (self.joints, self.rotation.free);
        bias_accelerations(model, data, q, &w.joint_speed);
        w.loops.joint_rows.fill(0.0);
        for (k, closing) in self.frames.loops.iter().enumerate() {
            let rows = &mut w.loops.joint_rows[6 * k * j..6 * (k + 1) * j];
            for (place, sign) in [(&closing.b, 1.0), (&closing.a, -1.0)] {
                if let Some(body) = place.body {
                    add_jacobian(model, data, body, &place.placement.translation, sign, rows);
                }
            }
            drop_rounding(rows, j);
            let gap = closing.gap(data);
            let (va, vb) = (closing.a.velocity(data), closing.b.velocity(data));
            let rate = [vb.angular - va.angular, vb.linear - va.linear];
            let (aa, ab) = (closing.a.acceleration(data), closing.b.acceleration(data));
            let bias = [ab.angular - aa.angular, ab.linear - aa.linear];
            for part in 0..2 {
                let mut target: Vector3<f64> = -bias[part];
                if w.loops.drifts {
                    target -= rate[part] * (2.0 / SETTLE) + gap[part] / (SETTLE * SETTLE);
                }
                for axis in 0..3 {
                    w.loops.b[6 * k + 3 * part + axis] = target[axis];
                    w.loops.rate[6 * k + 3 * part + axis] = rate[part][axis];
                }
            }
        }
        // D over the independent speeds; what prescribed speeds bring goes to the other side.
        let r = &self.rotation;
        w.loops.rows.fill(0.0);
        w.loops.target.fill(0.0);
        for (i, row) in w.loops.joint_rows.chunks_exact(j.max(1)).enumerate() {
            let to = &mut w.loops.rows[i * n..(i + 1) * n];
            for (joint, value) in row.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                r.joints[joint].add_to(*value, to);
                w.loops.b[i] -= value * r.joints_prescribed[joint].of(&w.ds);
                w.loops.target[i] -= value * r.joints_prescribed[joint].of(&w.s);
            }
        }
        self.add_loops(w);
    }

    /// `M + D'WD`, `f + D'Wb`.
    fn add_loops(&self, w: &mut Work) {
        let n = self.rotation.free;
        let trace: f64 = (0..n).map(|i| w.mass[i * n + i]).sum();
        for k in 0..2 * self.frames.loops.len() {
            let rows = &w.loops.rows[3 * k * n..3 * (k + 1) * n];
            let square: f64 = rows.iter().map(|d| d * d).sum();
            if square == 0.0 {
                continue;
            }
            let weight = trace / square;
            for (row, b) in rows.chunks_exact(n).zip(&w.loops.b[3 * k..]) {
                for (i, d) in row.iter().enumerate().filter(|(_, d)| **d != 0.0) {
                    let factor = weight * d;
                    w.force[i] += factor * b;
                    w.mass[i * n..(i + 1) * n].iter_mut().zip(row).for_each(|(m, d)| *m += factor * d);
                }
            }
        }
    }

    /// Where prescribed speeds have jumped, or do not fit at the start, impulses pass it on through the loops: of all
    /// speeds that fit, those nearest in kinetic energy. The working space holds the evaluation before.
    pub(crate) fn meet_loops(&self, c: &Context, w: &mut Work, x: &mut [f64]) -> bool {
        let speeds = w.joint_speed.iter().fold(0.0_f64, |max, v| max.max(v.abs()));
        let size = w.loops.joint_rows.iter().fold(0.0_f64, |max, d| max.max(d.abs()));
        let worst = w.loops.rate.iter().fold(0.0_f64, |max, rate| max.max(rate.abs()));
        let allowed = (MISFIT * speeds * size).max(AT_REST);
        if worst <= allowed {
            return false;
        }
        let before = self.speeds(c);
        let after = &mut x[self.positions..self.positions + self.rotation.free];
        // What is stuck stays so.
        let target = &w.loops.target;
        w.schur.impose(&w.rows, after, |i| target.get(i).copied().unwrap_or_else(|| w.rows.of(i, before)));
        let n = self.rotation.free;
        let left = target.iter().enumerate().map(|(i, target)| {
            let row = &w.loops.rows[i * n..(i + 1) * n];
            (row.iter().zip(after.iter()).map(|(d, v)| d * v).sum::<f64>() - target).abs()
        });
        if left.fold(0.0, f64::max) > allowed {
            c.fail("the prescribed speeds do not fit each other: a closed loop of bodies couples them");
            return false;
        }
        true
    }
}

impl Network {
    /// Closes loops of bodies that a search for a state of rest has left open, with all joints at rest; says which one gaped most.
    pub(crate) fn close_at_rest(&self, c: &Context, w: &mut Work, x: &mut [f64]) -> Option<String> {
        let (Some(model), Some(data)) = (&self.frames.model, &mut w.data) else { return None };
        let gap = |closing: &Loop, data: &Data| {
            let [turn, way] = closing.gap(data);
            turn.amax().max(way.amax())
        };
        forward_kinematics(model, data, self.positions(c));
        let open = self.frames.loops.iter().map(|closing| (gap(closing, data), closing));
        let (most, closing) = open.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(gap, _)| *gap > ACCEPTED)?;
        let path = &self.seats[closing.member].member.path;
        let mut q = self.positions(c).to_vec();
        close(model, data, &self.frames.loops, &vec![1.0; model.dof()], &mut q);
        x[..q.len()].copy_from_slice(&q);
        x[self.positions..self.positions + self.rotation.free].fill(0.0);
        Some(format!("the closed loop of bodies through `{path}` gapes by {most:.3e} rad or m"))
    }
}

/// Rows of rounding become zero; the first three rows are angles, the others lengths.
fn drop_rounding(rows: &mut [f64], joints: usize) {
    let largest = |row: &[f64]| row.iter().fold(0.0_f64, |max, d| max.max(d.abs()));
    for kind in rows.chunks_exact_mut((3 * joints).max(1)) {
        let allowed = ROUNDING * largest(kind);
        for row in kind.chunks_exact_mut(joints.max(1)) {
            if largest(row) < allowed {
                row.fill(0.0);
            }
        }
    }
}
