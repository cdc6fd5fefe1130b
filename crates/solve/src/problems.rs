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

/// HIRES, the high irradiance response of plants to light: eight chemical species, stiff, from
/// (1, 0, 0, 0, 0, 0, 0, 0.0057) to t = 321.8122.
///
/// E. Schäfer: A new approach to explain the "high irradiance responses" of photomorphogenesis on the basis of phytochrome,
/// J. Math. Biology 2 (1975), doi 10.1007/BF00276015; problem hires of Mazzia and Magherini's test set.
pub fn hires() -> impl System {
    function(8, |_, x, dx| {
        dx[0] = -1.71 * x[0] + 0.43 * x[1] + 8.32 * x[2] + 0.0007;
        dx[1] = 1.71 * x[0] - 8.75 * x[1];
        dx[2] = -10.03 * x[2] + 0.43 * x[3] + 0.035 * x[4];
        dx[3] = 8.32 * x[1] + 1.71 * x[2] - 1.12 * x[3];
        dx[4] = -1.745 * x[4] + 0.43 * x[5] + 0.43 * x[6];
        dx[5] = -280.0 * x[5] * x[7] + 0.69 * x[3] + 1.71 * x[4] - 0.43 * x[5] + 0.69 * x[6];
        dx[6] = 280.0 * x[5] * x[7] - 1.81 * x[6];
        dx[7] = -dx[6];
    })
}

/// The Oregonator, a chemical reaction that oscillates, from (1, 2, 3) to t = 360; stiff, with steep fronts.
///
/// R. J. Field, R. M. Noyes: Oscillations in chemical systems IV, J. Chem. Phys. 60 (1974), doi 10.1063/1.1681288; problem
/// orego of Mazzia and Magherini's test set.
pub fn oregonator() -> impl System {
    function(3, |_, x, dx| {
        dx[0] = 77.27 * (x[1] + x[0] * (1.0 - 8.375e-6 * x[0] - x[1]));
        dx[1] = (x[2] - (1.0 + x[0]) * x[1]) / 77.27;
        dx[2] = 0.161 * (x[0] - x[2]);
    })
}

/// The Pleiades: seven stars in a plane whose masses are 1 to 7, with near encounters; not stiff. States are the
/// coordinates x, then y, then the velocities. Runs to t = 3 from [`PLEIADES`].
///
/// E. Hairer, S. P. Nørsett, G. Wanner: Solving Ordinary Differential Equations I, section II.10.
pub fn pleiades() -> impl System {
    function(28, |_, x, dx| {
        dx[..14].copy_from_slice(&x[14..]);
        dx[14..].fill(0.0);
        for i in 0..7 {
            for j in (0..7).filter(|&j| j != i) {
                let (a, b) = (x[j] - x[i], x[j + 7] - x[i + 7]);
                let pull = (j + 1) as f64 / (a * a + b * b).powf(1.5);
                dx[14 + i] += pull * a;
                dx[21 + i] += pull * b;
            }
        }
    })
}

/// Where the [`pleiades`] start.
pub const PLEIADES: [f64; 28] = [
    3.0, 3.0, -1.0, -3.0, 2.0, -2.0, 2.0, // x
    3.0, -3.0, 2.0, 0.0, 0.0, -4.0, 4.0, // y
    0.0, 0.0, 0.0, 0.0, 0.0, 1.75, -1.5, // x'
    0.0, 0.0, 0.0, -1.25, 1.0, 0.0, 0.0, // y'
];

/// Heat in a rod of `n` cells that is held at 1 at its left end and is insulated at its right one; starts at 0.
pub fn heat(n: usize) -> impl System {
    let rate = (n * n) as f64;
    function(n, move |_, x, dx| {
        for i in 0..n {
            let left = if i > 0 { x[i - 1] } else { 1.0 };
            let right = if i + 1 < n { x[i + 1] } else { x[i] };
            dx[i] = rate * (left - 2.0 * x[i] + right);
        }
    })
}

/// A small body between earth and moon, in the plane that turns with them: positions, then speeds. Not stiff, with close passages.
///
/// E. Hairer, S. P. Nørsett, G. Wanner: Solving Ordinary Differential Equations I, eq. II.0.1.
pub fn arenstorf() -> impl System {
    const MOON: f64 = 0.012_277_471;
    const EARTH: f64 = 1.0 - MOON;
    function(4, |_, x, dx| {
        let earth = ((x[0] + MOON).powi(2) + x[1] * x[1]).powf(1.5);
        let moon = ((x[0] - EARTH).powi(2) + x[1] * x[1]).powf(1.5);
        (dx[0], dx[1]) = (x[2], x[3]);
        dx[2] = x[0] + 2.0 * x[3] - EARTH * (x[0] + MOON) / earth - MOON * (x[0] - EARTH) / moon;
        dx[3] = x[1] - 2.0 * x[2] - EARTH * x[1] / earth - MOON * x[1] / moon;
    })
}

/// The usual start of [`hires`].
pub const HIRES_START: [f64; 8] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057];
