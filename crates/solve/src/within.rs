//! States within a step of an implicit method, nearer to the solution than its stages know them.
//!
//! What a continuous extension made of stages says of a stiff state is off by ten or a hundred times what the end of the step is
//! off by: the end damps such errors out. Here two states within are moved by one step of Newton's method towards where derivative and
//! slope agree, with the matrix that the step was made with. Where a state is stiff, that leads to where it rests; where it is not,
//! it changes what is of the order of the extension. A cubic goes through both ends and these two; it is bent to leave the
//! start with the slope of the solution as far as that is not the beginning of a decay that the step damps out. All
//! states are treated alike, so that within a step as well the system conserves what it conserves linearly.
//!
//! The idea of correcting an interpolant by its defect: W. H. Enright, K. R. Jackson, S. P. Nørsett, P. G. Thomsen: Interpolants for
//! Runge-Kutta formulas, ACM TOMS 12 (1986), doi 10.1145/7921.7923.

use crate::adaptive::{Fault, Method, Span, Work};

/// By how many tolerances the two states may be moved. What is wrong afterwards is about a tenth of that.
const FAR: f64 = 30.0;
/// Where the two states are, as parts of the step.
const PLACES: [f64; 2] = [1.0 / 3.0, 2.0 / 3.0];

/// The polynomial of the last step, once it is known.
#[derive(Default)]
pub(crate) struct Within {
    /// How far the two states are from the straight line between the ends; then the slope missing at the start, as
    /// the way that it makes over the step.
    off: [Vec<f64>; 3],
    f: Vec<f64>,
    x: Vec<f64>,
    is_known: bool,
}

/// What a method has to make it from.
pub(crate) struct Has<E, S> {
    /// Weight of the slope that the matrix belongs to.
    pub gamma: f64,
    /// Its own extension, a cubic: how far a state is from the straight line between the ends at a part of the step.
    pub extension: E,
    /// Multiplies by the inverse of I - h gamma J.
    pub solve: S,
}

impl Within {
    pub fn new(n: usize) -> Self {
        let zeros = || vec![0.0; n];
        Self { off: [zeros(), zeros(), zeros()], f: zeros(), x: zeros(), is_known: false }
    }

    /// Another step is tried, of which nothing is known yet.
    pub fn forget(&mut self) {
        self.is_known = false;
    }

    pub fn is_known(&self) -> bool {
        self.is_known
    }

    /// Makes the polynomial from what `method` has. Returns how far the two states were off, as a part of what is allowed.
    pub fn find<M: Method>(
        &mut self,
        method: &mut M,
        work: &mut Work,
        Span { t0, h, .. }: Span,
        [x0, x1]: [&[f64]; 2],
        has: Has<impl Fn(&M, usize, f64) -> f64, impl Fn(&mut M, &mut [f64])>,
    ) -> Result<f64, Fault> {
        let Has { gamma, extension, solve } = has;
        let Self { off: [early, late, start], f, x, .. } = self;
        for (place, off, slope) in [(PLACES[0], &mut *early, &mut *f), (PLACES[1], &mut *late, &mut *start)] {
            for i in 0..x0.len() {
                off[i] = extension(method, i, place);
                x[i] = x0[i] + place * (x1[i] - x0[i]) + off[i];
            }
            work.derivatives(t0 + place * h, x, slope)?;
        }
        for i in 0..x0.len() {
            // Slopes of the cubic that is zero at both ends.
            let (way, early, late) = (x1[i] - x0[i], early[i], late[i]);
            f[i] = gamma * (h * f[i] - way - (3.0 * late - 1.5 * early));
            start[i] = gamma * (h * start[i] - way - (1.5 * late - 3.0 * early));
        }
        let mut moved: f64 = 0.0;
        for (off, correction) in [(early, &mut *f), (late, &mut *start)] {
            solve(method, correction);
            moved = moved.max(work.weights.norm(x0, x1, correction, h));
            off.iter_mut().zip(correction.iter()).for_each(|(off, correction)| *off += correction);
        }
        let [early, late, start] = &mut self.off;
        let (f0, _) = method.first_derivative();
        for i in 0..x0.len() {
            start[i] = h * f0[i] - (x1[i] - x0[i]) - (9.0 * early[i] - 4.5 * late[i]);
        }
        solve(method, start);
        self.is_known = true;
        Ok(moved / FAR)
    }

    /// The state at the fraction `theta` of the step.
    pub fn interpolate(&self, theta: f64, x0: &[f64], x1: &[f64], x: &mut [f64]) {
        let [early, late, start] = &self.off;
        let rest = 1.0 - theta;
        let bend = (1.0 - 3.0 * theta) * (1.0 - 1.5 * theta);
        for (i, x) in x.iter_mut().enumerate() {
            let (early, late) = (early[i], late[i]);
            let bow = 9.0 * early - 4.5 * late + 13.5 * theta * (late - early) + bend * start[i];
            *x = x0[i] + theta * (x1[i] - x0[i] + rest * bow);
        }
    }
}
