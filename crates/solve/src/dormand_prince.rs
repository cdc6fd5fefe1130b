//! `Ode45`: Dormand and Prince's pair. Order 5 with an error estimate of order 4, seven stages of which the last is
//! the first of the next step; explicit; continuous extension of order 4, of order 5 for two more evaluations.
//!
//! The default for anything that is not stiff, at tolerances from 1e-3 to 1e-9. On stiff systems its steps shrink to
//! about three times the shortest time constant; take `Rodas4` or `Ros34pw2` there.
//!
//! J. R. Dormand, P. J. Prince: A family of embedded Runge-Kutta formulae, J. Comput. Appl. Math. 6 (1980),
//! doi 10.1016/0771-050X(80)90013-3. Continuous extension: E. Hairer, S. P. Nørsett, G. Wanner: Solving Ordinary
//! Differential Equations I, 2nd ed., section II.6.

use crate::adaptive::{Adaptive, Fault, Method, Radius, Span, Work, difference_radius};
use crate::combine::{combine, combine_error};
use crate::weights::Weights;
use crate::{Ode15s, Stepper};

/// Order 5 for systems that are not stiff; the default.
pub type Ode45 = Adaptive<DormandPrince>;

pub(crate) const C2: f64 = 1.0 / 5.0;
pub(crate) const C3: f64 = 3.0 / 10.0;
pub(crate) const C4: f64 = 4.0 / 5.0;
pub(crate) const C5: f64 = 8.0 / 9.0;

pub(crate) const A2: [f64; 1] = [1.0 / 5.0];
pub(crate) const A3: [f64; 2] = [3.0 / 40.0, 9.0 / 40.0];
pub(crate) const A4: [f64; 3] = [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0];
pub(crate) const A5: [f64; 4] = [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0];
pub(crate) const A6: [f64; 5] =
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0];
/// Weights of order 5, and the last row: stage 7 is the derivative at the end.
pub(crate) const B: [f64; 6] =
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0];
/// Weights of order 5 less those of order 4, for stages 1, 3, 4, 5, 6, 7.
const E: [f64; 6] =
    [71.0 / 57600.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];
/// Coefficients of theta^2 (1 - theta)^2 in the continuous extension, for stages 1, 3, 4, 5, 6, 7.
const D: [f64; 6] = [
    -12715105075.0 / 11282082432.0,
    87487479700.0 / 32700410799.0,
    -10690763975.0 / 1880347072.0,
    701980252875.0 / 199316789632.0,
    -1453857185.0 / 822651844.0,
    69997945.0 / 29380423.0,
];

/// Where the derivative is taken to make the continuous extension one of order 5: in the middle and here, where the error is
/// near its least.
const FIFTH: f64 = 0.2;

/// Stages of [`Ode45`].
pub struct DormandPrince {
    k: [Vec<f64>; 7],
    /// Coefficients of theta^2 (1 - theta)^2 and theta^3 (1 - theta)^2 beyond order 4, if they are known.
    more: [Vec<f64>; 2],
    sharp: bool,
    /// Where stage 6 was evaluated, at the end of the step as the last one.
    sixth: Vec<f64>,
}

impl Ode45 {
    /// Goes on where the stiff method has got to.
    pub(crate) fn follow(&mut self, stiff: &Ode15s) {
        let (t0, t1) = stiff.last_step();
        self.go_on(stiff.learnt(), t1 - t0);
    }
}

impl DormandPrince {
    /// Coefficients of the continuous extension of state `i`: those of 1, theta, theta (1 - theta), theta^2 (1 - theta) and
    /// theta^2 (1 - theta)^2.
    #[inline]
    fn coefficients(&self, i: usize, h: f64, x0: &[f64], x1: &[f64]) -> [f64; 5] {
        let [k1, _, k3, k4, k5, k6, k7] = &self.k;
        let chord = x1[i] - x0[i];
        let start = h * k1[i] - chord;
        let end = chord - h * k7[i] - start;
        let bump =
            h * (D[0] * k1[i] + D[1] * k3[i] + D[2] * k4[i] + D[3] * k5[i] + D[4] * k6[i] + D[5] * k7[i]);
        [x0[i], chord, start, end, bump]
    }
}

impl Method for DormandPrince {
    const NAME: &'static str = "Ode45";
    const ORDER: f64 = 5.0;
    const ERROR_POWER: f64 = 5.0;

    fn new(n: usize) -> Self {
        let zeros = || vec![0.0; n];
        Self { k: std::array::from_fn(|_| zeros()), more: [zeros(), zeros()], sharp: false, sixth: zeros() }
    }

    fn radius(&self, weights: &Weights, x0: &[f64], x1: &[f64], h: f64) -> Radius {
        difference_radius(weights, [x0, x1], [&self.k[5], &self.k[6]], &self.sixth, h)
    }

    fn begin(&mut self, work: &mut Work, t: f64, x: &[f64], known: bool) -> Result<(), Fault> {
        if known {
            self.k.swap(0, 6);
            return Ok(());
        }
        work.derivatives(t, x, &mut self.k[0])
    }

    fn last_derivative(&self) -> &[f64] {
        &self.k[6]
    }

    fn last_derivative_mut(&mut self) -> &mut [f64] {
        &mut self.k[6]
    }

    fn first_derivative(&mut self) -> (&[f64], &mut [f64]) {
        let [k1, k2, ..] = &mut self.k;
        (k1, k2)
    }

    fn attempt(
        &mut self,
        work: &mut Work,
        Span { t0, t1, h }: Span,
        x0: &[f64],
        x1: &mut [f64],
        error: &mut [f64],
    ) -> Result<(), Fault> {
        self.sharp = false;
        let [k1, k2, k3, k4, k5, k6, k7] = &mut self.k;
        combine(x1, x0, h, A2, [k1]);
        work.derivatives(t0 + C2 * h, x1, k2)?;
        combine(x1, x0, h, A3, [k1, k2]);
        work.derivatives(t0 + C3 * h, x1, k3)?;
        combine(x1, x0, h, A4, [k1, k2, k3]);
        work.derivatives(t0 + C4 * h, x1, k4)?;
        combine(x1, x0, h, A5, [k1, k2, k3, k4]);
        work.derivatives(t0 + C5 * h, x1, k5)?;
        combine(x1, x0, h, A6, [k1, k2, k3, k4, k5]);
        self.sixth.copy_from_slice(x1);
        work.derivatives(t1, x1, k6)?;
        let [b1, _, b3, b4, b5, b6] = B;
        combine(x1, x0, h, [b1, b3, b4, b5, b6], [k1, k3, k4, k5, k6]);
        work.derivatives(t1, x1, k7)?;
        combine_error(error, h, E, [k1, k3, k4, k5, k6, k7]);
        Ok(())
    }

    /// The polynomial of degree 5 with the values and slopes of that of order 4 at both ends, and the derivatives that f has on
    /// the latter at two points within: since it errs by h^5 there, h f errs by h^6.
    ///
    /// W. H. Enright, K. R. Jackson, S. P. Nørsett, P. G. Thomsen: Interpolants for Runge-Kutta formulas, ACM TOMS 12
    /// (1986), doi 10.1145/7921.7923.
    fn sharpen(
        &mut self,
        work: &mut Work,
        Span { t0, h, .. }: Span,
        x0: &[f64],
        x1: &[f64],
    ) -> Result<(), Fault> {
        if self.sharp {
            return Ok(());
        }
        // Stages that nobody asks for after the step.
        let (mut x, mut f) = (std::mem::take(&mut self.sixth), std::mem::take(&mut self.k[1]));
        let mut off = |method: &mut Self, theta: f64| -> Result<usize, Fault> {
            method.interpolate(theta, h, x0, x1, &mut x);
            work.derivatives(t0 + theta * h, &x, &mut f)?;
            let place = usize::from(theta == 0.5);
            for (i, f) in f.iter().enumerate() {
                let [_, chord, start, end, bump] = method.coefficients(i, h, x0, x1);
                let rest = 1.0 - theta;
                let slope = chord
                    + start * (1.0 - 2.0 * theta)
                    + end * theta * (2.0 - 3.0 * theta)
                    + bump * 2.0 * theta * rest * (1.0 - 2.0 * theta);
                method.more[place][i] = h * f - slope;
            }
            Ok(place)
        };
        let found = off(self, FIFTH).and_then(|_| off(self, 0.5));
        (self.sixth, self.k[1]) = (x, f);
        found?;
        let rest = 1.0 - FIFTH;
        let (height, slope) = ((FIFTH * rest).powi(2), 2.0 * FIFTH * rest * (1.0 - 2.0 * FIFTH));
        let [even, odd] = &mut self.more;
        for (even, odd) in even.iter_mut().zip(odd) {
            // In the middle theta^2 (1 - theta)^2 is 1/16, and level.
            *odd *= 16.0;
            *even = (*even - height * *odd) / slope - FIFTH * *odd;
        }
        self.sharp = true;
        Ok(())
    }

    fn interpolate(&self, theta: f64, h: f64, x0: &[f64], x1: &[f64], x: &mut [f64]) {
        let rest = 1.0 - theta;
        for (i, x) in x.iter_mut().enumerate() {
            let [x0, chord, start, end, mut bump] = self.coefficients(i, h, x0, x1);
            if self.sharp {
                bump += self.more[0][i] + theta * self.more[1][i];
            }
            *x = x0 + theta * (chord + rest * (start + theta * (end + rest * bump)));
        }
    }
}
