//! What each of several stuck frictions bears where they hold the same parts.
//!
//! Then the laws tell what all of them bear, and not what each does. Each bears the same part of what it can as long as
//! that is possible; where it would be too much for one of them, any other share within what each holds is as good. They
//! give way when there is none.

use super::parts::Place;
use crate::network::Network;
use crate::work::Work;

impl Network {
    /// Gives the multipliers a share that all can bear, if one bears too much and there is such a share. Losses of
    /// meshes depend on the share, so with them it stays even.
    pub(crate) fn share_load(&self, w: &mut Work) {
        let too_much = |w: &Work| {
            let stuck = w.stuck.iter().zip(&w.lambda[w.first_stuck..]);
            stuck.into_iter().any(|(i, lambda)| {
                let [forward, backward] = w.grip[*i].hold;
                -lambda > forward || *lambda > backward
            })
        };
        if !self.meshes.is_empty() || w.stuck.is_empty() || !too_much(w) {
            return;
        }
        let (rank, small) = self.fit(false, w);
        let m = w.rows.len();
        if (0..m).all(|i| w.bounded.slope(i, rank).abs() <= small) {
            for i in 0..m {
                let scale = w.schur.scale(i);
                w.lambda[i] = if scale > 0.0 { w.bounded.z[i] / scale } else { 0.0 };
            }
            // To the last digit.
            for (k, i) in w.stuck.iter().enumerate() {
                let [forward, backward] = w.grip[*i].hold;
                let lambda = &mut w.lambda[w.first_stuck + k];
                *lambda = lambda.max(-forward).min(backward);
            }
        }
    }

    /// Torques of what is stuck within what it holds, as near as possible to what keeps all of it still. Returns the
    /// number of independent constraints, and the slope that is rounding: beyond it a part is not kept still.
    pub(super) fn fit(&self, soft: bool, w: &mut Work) -> (usize, f64) {
        let m = w.rows.len();
        let rank = w.schur.within_bounds(&w.rows, &w.lambda[..m], &mut w.bounded);
        w.bounded.lower[..m].fill(f64::NEG_INFINITY);
        w.bounded.upper[..m].fill(f64::INFINITY);
        for (k, i) in w.stuck.iter().enumerate() {
            if let Place::Pin(_) = self.stiction.parts[*i] {
                let row = w.first_stuck + k;
                let [forward, backward] = self.held(*i, soft, w);
                w.bounded.lower[row] = -forward * w.schur.scale(row);
                w.bounded.upper[row] = backward * w.schur.scale(row);
                if w.schur.scale(row) == 0.0 {
                    (w.bounded.lower[row], w.bounded.upper[row]) = (0.0, 0.0);
                }
            }
        }
        (rank, w.bounded.solve(m, rank))
    }

    /// Modes of what stands, from the torques that come nearest to keeping it still: what cannot be kept still slides the
    /// way it is pulled. `w` holds the evaluation with all of it stuck.
    pub(super) fn fitting_modes(&self, soft: bool, w: &mut Work, modes: &mut [f64]) {
        let (rank, small) = self.fit(soft, w);
        for (k, i) in w.stuck.iter().enumerate() {
            let slope = w.bounded.slope(w.first_stuck + k, rank);
            if slope.abs() > small {
                modes[self.stiction.modes.start + i] = -slope.signum();
            }
        }
    }
}
