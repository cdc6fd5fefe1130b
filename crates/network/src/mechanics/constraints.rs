//! What constrains the independent speeds: closed loops, stuck friction.
//!
//! Rows that contradict each other are obeyed in this order: closed loops, stuck frictions, stuck meshes. A mesh bears
//! nothing of what loops and frictions hold already: what it holds is a part of the torque that passes, which may be
//! none.

use blocksim_block::Context;

use crate::mechanics::schur::dot;
use crate::network::Network;
use crate::work::Work;

impl Network {
    /// The largest number of constraints that ever hold at once.
    pub(crate) fn most_constraints(&self) -> usize {
        6 * self.frames.loops.len() + self.stiction.len()
    }

    /// Takes the accelerations, so far those of `M dv = f`, onto the constraints, and leaves the multipliers in
    /// `w.lambda`, those of closed loops first: constraint `i` acts as `lambda_i D_i'` on the independent speeds.
    pub(crate) fn constrain(&self, c: &Context, w: &mut Work) {
        w.rows.clear();
        w.pull = dot(&w.force, &w.dv).max(0.0).sqrt();
        for (row, b) in w.loops.rows.chunks_exact(self.rotation.free.max(1)).zip(&w.loops.b) {
            w.rows.push(*b, 1.0).copy_from_slice(row);
        }
        self.stuck_rows(c, w);
        if w.rows.is_empty() {
            return;
        }
        // Rows of frictions are constant, and so is the mass matrix without bodies.
        if !(w.factored && w.schur_of == w.stuck) {
            w.schur.factor(&w.rows, &w.factor, &self.envelope);
            w.schur_of.clear();
            // Shares depend on what is held.
            if !w.schur.has_dependent_rows(&w.rows) {
                w.schur_of.extend_from_slice(&w.stuck);
            }
        }
        w.schur.impose(&w.rows, &mut w.dv, |i| w.rows.b[i]);
        let m = w.rows.len();
        w.lambda[..m].copy_from_slice(&w.schur.lambda[..m]);
        w.pull += w.schur.pulled(&w.lambda[..m]);
        if w.schur.has_dependent_rows(&w.rows) {
            self.share_load(w);
        }
        self.holding_torques(w);
    }
}
