//! Test problems with known solutions, for the tests of steppers and of what is built on them.

use crate::{Failed, System};

/// A system given by a closure `f(t, x, dx)`.
pub struct Function<F> {
    dimension: usize,
    f: F,
}

/// The system dx/dt = f(t, x) of `dimension` states.
pub fn function<F: FnMut(f64, &[f64], &mut [f64])>(dimension: usize, f: F) -> Function<F> {
    Function { dimension, f }
}

impl<F: FnMut(f64, &[f64], &mut [f64])> System for Function<F> {
    fn dimension(&self) -> usize {
        self.dimension
    }

    fn derivatives(&mut self, t: f64, x: &[f64], dx: &mut [f64]) -> Result<(), Failed> {
        (self.f)(t, x, dx);
        Ok(())
    }
}

/// Van der Pol's oscillator x'' = mu (1 - x^2) x' - x. Stiff for large mu. Its usual start is (2, 0).
///
/// B. van der Pol: On relaxation-oscillations, Phil. Mag. 2 (1926), doi 10.1080/14786442608564127.
pub fn van_der_pol(mu: f64) -> impl System {
    function(2, move |_, x, dx| {
        dx[0] = x[1];
        dx[1] = mu * (1.0 - x[0] * x[0]) * x[1] - x[0];
    })
}

/// Robertson's chemical reaction, rates 0.04, 3e7 and 1e4 1/s, from (1, 0, 0). The sum of the states is 1 for ever.
///
/// E. Hairer, G. Wanner: Solving Ordinary Differential Equations II, eq. IV.1.4.
pub fn robertson() -> impl System {
    function(3, |_, x, dx| {
        let (slow, fast, middle) = (0.04 * x[0], 3e7 * x[1] * x[1], 1e4 * x[1] * x[2]);
        dx[0] = middle - slow;
        dx[1] = slow - middle - fast;
        dx[2] = fast;
    })
}

/// A nonlinear and time-dependent pair that is not stiff: x' = y cos t, y' = -x cos t, from (0, 1).
/// Solution [`swing_solution`].
pub fn swing() -> impl System {
    function(2, |t, x, dx| {
        // The factor is 1 on the solution, and makes every elementary differential appear.
        let r = x[0] * x[0] + x[1] * x[1];
        dx[0] = x[1] * t.cos() * r;
        dx[1] = -x[0] * t.cos() / r;
    })
}

/// (sin(sin t), cos(sin t)).
pub fn swing_solution(t: f64) -> [f64; 2] {
    let (sin, cos) = t.sin().sin_cos();
    [sin, cos]
}

/// Prothero and Robinson's problem x' = -rate (x - sin t) + cos t with the solution sin t, whatever the rate, from x = 0.
/// Knows its Jacobian.
///
/// A. Prothero, A. Robinson: On the stability and accuracy of one-step methods for solving stiff systems of ordinary
/// differential equations, Math. Comp. 28 (1974), doi 10.1090/S0025-5718-1974-0331793-2.
pub struct ProtheroRobinson {
    /// Decay of a deviation, 1/s.
    pub rate: f64,
    divisor: f64,
}

impl ProtheroRobinson {
    /// With this rate of decay, 1/s.
    pub fn new(rate: f64) -> Self {
        Self { rate, divisor: 1.0 }
    }
}

impl System for ProtheroRobinson {
    fn dimension(&self) -> usize {
        1
    }

    fn derivatives(&mut self, t: f64, x: &[f64], dx: &mut [f64]) -> Result<(), Failed> {
        dx[0] = -self.rate * (x[0] - t.sin()) + t.cos();
        Ok(())
    }

    fn prepare(&mut self, _t: f64, _x: &[f64], hg: f64) -> Result<(), Failed> {
        self.divisor = 1.0 + hg * self.rate;
        Ok(())
    }

    fn solve(&mut self, r: &mut [f64]) {
        r[0] /= self.divisor;
    }
}

/// A direct current motor with its mechanics: armature current i (A) and speed w (rad/s), i' = rate (sin t - i - w / 10),
/// w' = 5 i - w. The rate is that of the winding, 1/s. Gives as much of its Jacobian as it is told to.
pub struct Motor {
    /// Resistance over inductance of the winding, 1/s.
    pub rate: f64,
    /// What J holds besides its diagonal.
    pub coupling: Coupling,
    hg: f64,
}

/// Terms off the diagonal in the Jacobian of [`Motor`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coupling {
    /// None.
    Neither,
    /// Of the speed on the current.
    OnCurrent,
    /// Of the current on the speed.
    OnSpeed,
    /// Both: J is exact.
    Both,
}

impl Motor {
    /// With this rate of the winding, 1/s, and these terms in J.
    pub fn new(rate: f64, coupling: Coupling) -> Self {
        Self { rate, coupling, hg: 0.0 }
    }
}

impl System for Motor {
    fn dimension(&self) -> usize {
        2
    }

    fn derivatives(&mut self, t: f64, x: &[f64], dx: &mut [f64]) -> Result<(), Failed> {
        dx[0] = self.rate * (t.sin() - x[0] - 0.1 * x[1]);
        dx[1] = 5.0 * x[0] - x[1];
        Ok(())
    }

    fn prepare(&mut self, _t: f64, _x: &[f64], hg: f64) -> Result<(), Failed> {
        self.hg = hg;
        Ok(())
    }

    fn solve(&mut self, r: &mut [f64]) {
        let on_current = matches!(self.coupling, Coupling::OnCurrent | Coupling::Both);
        let on_speed = matches!(self.coupling, Coupling::OnSpeed | Coupling::Both);
        // I - hg J = [a b; c d], by Cramer's rule.
        let (a, d) = (1.0 + self.hg * self.rate, 1.0 + self.hg);
        let b = if on_current { 0.1 * self.hg * self.rate } else { 0.0 };
        let c = if on_speed { -5.0 * self.hg } else { 0.0 };
        let determinant = a * d - b * c;
        (r[0], r[1]) = ((d * r[0] - b * r[1]) / determinant, (a * r[1] - c * r[0]) / determinant);
    }
}

/// x' = x^2 from 1, which has a pole at t = 1.
pub fn pole() -> impl System {
    function(1, |_, x, dx| dx[0] = x[0] * x[0])
}

/// x' = -sqrt(x) from 1; reaches 0 at t = 2 along (1 - t/2)^2, and has no derivative beyond.
pub fn draining_tank() -> impl System {
    function(1, |_, x, dx| dx[0] = -x[0].sqrt())
}
