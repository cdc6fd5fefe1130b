//! What components know of how their own states and torques change, for linearly implicit methods.
//!
//! For a component with states `x` and one branch of the speed `w = P v`, let `A = dx'/dx`, `B = dx'/dw` and
//! `C = dtau/dx`. The states are eliminated where they are, so that the system stays as large as the speeds: with
//! `S = (I - hg A)^-1`
//!
//! ```text
//! (M + hg D + hg^2 P' C S B P) dv = M r_v - hg P' C S r_x
//! dx = S (r_x + hg B P dv)
//! ```

use blocksim_block::Context;
use blocksim_solve::linear::{lu_factor, lu_solve};

use crate::network::Network;
use crate::work::Work;

impl Network {
    /// Linearises the members and adds what their states do to the speeds to the matrix `w.implicit`.
    pub(crate) fn prepare_linear(&self, c: &Context, hg: f64, w: &mut Work) {
        let mut members = std::mem::take(&mut w.linear);
        for linear in &mut members {
            let seat = &self.seats[linear.seat];
            let Some(component) = seat.component() else { continue };
            component.linearize(&self.flowing_law(c, seat, w), &mut linear.a, &mut linear.sb, &mut linear.c);
            let n = linear.c.len();
            linear.a.iter_mut().for_each(|a| *a *= -hg);
            (0..n).for_each(|i| linear.a[i * n + i] += 1.0);
            if lu_factor(&mut linear.a, &mut linear.pivots).is_err() {
                // Without slopes the method is still of its order, only smaller in its steps.
                linear.a.fill(0.0);
                (0..n).for_each(|i| linear.a[i * n + i] = 1.0);
                (0..n).for_each(|i| linear.pivots[i] = i);
                linear.sb.fill(0.0);
                linear.c.fill(0.0);
            }
            lu_solve(&linear.a, &linear.pivots, &mut linear.sb);
            let slope: f64 = linear.c.iter().zip(&linear.sb).map(|(c, sb)| c * sb).sum();
            self.envelope.square(&self.rotation.pins[linear.pin].speed, hg * hg * slope, &mut w.implicit);
        }
        w.linear = members;
    }

    /// Eliminates the states: overwrites theirs in `x` with `S x`, and takes what follows for the speeds from
    /// `w.product`. `x` are the states behind the speeds.
    pub(crate) fn eliminate_states(&self, w: &mut Work, x: &mut [f64]) {
        let first = self.positions + self.rotation.free;
        for linear in &w.linear {
            let range = self.seats[linear.seat].x.clone();
            let x = &mut x[range.start - first..range.end - first];
            lu_solve(&linear.a, &linear.pivots, x);
            let torque: f64 = linear.c.iter().zip(&*x).map(|(c, x)| c * x).sum();
            self.rotation.pins[linear.pin].speed.add_to(-w.hg * torque, &mut w.product);
        }
    }

    /// Gives the states what the speeds `v` add to them.
    pub(crate) fn return_states(&self, w: &Work, v: &[f64], x: &mut [f64]) {
        let first = self.positions + self.rotation.free;
        for linear in &w.linear {
            let range = self.seats[linear.seat].x.clone();
            let speed = w.hg * self.rotation.pins[linear.pin].speed.of(v);
            let x = &mut x[range.start - first..range.end - first];
            x.iter_mut().zip(&linear.sb).for_each(|(x, sb)| *x += sb * speed);
        }
    }
}
