use blocksim_block::physical::Element;
use blocksim_block::prelude::*;

/// Friction with true sticking: the surfaces touch through bristles that bend before they slip.
///
/// $$ \dot z = w - \frac{\sigma_0 |w|}{g(w)} z, \qquad
///    g(w) = \tau_C + (\tau_b - \tau_C)\, e^{-(w/w_S)^2}, \qquad
///    \tau = \sigma_0 z + \sigma_1(w)\, \dot z + f w $$
///
/// with the deflection of the bristles $z$ as a state and $w = w_r - w_c$. Stuck parts are joined by a spring of
/// stiffness $\sigma_0$ and a damper $\sigma_1$: under a load below the breakaway torque they do not creep away,
/// as they do with `RotationalFriction`. Sliding steadily the torque is $g(w) \operatorname{sgn} w + f w$.
///
/// The damping of the bristles fades with the speed,
///
/// $$ \sigma_1(w) = \frac{\sigma_1}{1 + \sigma_1 |w| / 4 g(w)} \le \frac{4 g(w)}{|w|} $$
///
/// which is what makes $\tau w \ge \frac{d}{dt} \frac{\sigma_0 z^2}{2}$ for every motion: with a constant
/// $\sigma_1$ the law can deliver energy at high speed. At rest it damps well with
/// $\sigma_1 \approx 2 \sqrt{\sigma_0 J}$.
///
/// While sliding, $z$ settles at the rate $\sigma_0 |w| / g$, which soon is a million per second: choose a solver
/// for stiff systems (`Rodas4`), or a smaller $\sigma_0$.
///
/// ```ron
/// LuGreFriction(
///     coulomb: "1 N*m", breakaway: "1.5 N*m", stribeck_velocity: "0.01 rad/s", viscous: "0.4 N*m*s/rad",
///     sigma0: "1e4 N*m/rad", sigma1: "100 N*m*s/rad",
/// )
/// ```
///
/// Source: C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, *A New Model for Control of Systems with
/// Friction*, IEEE Transactions on Automatic Control 40 (1995) 419-425; for a damping that depends on the
/// speed, H. Olsson, *Control Systems with Friction* (1996).
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = Friction)]
pub struct LuGreFriction {
    /// Coulomb torque $\tau_C$, above zero.
    #[block(
        unit = "N*m",
        positive,
        remedy = "without dry friction a RotationalDamper does the same; else write a small torque"
    )]
    pub coulomb: f64,
    /// Breakaway torque $\tau_b$, at least the Coulomb torque.
    #[block(
        unit = "N*m", finite, at_least = coulomb,
        remedy = "without a Stribeck effect write the same value for `breakaway` and `coulomb`",
    )]
    pub breakaway: f64,
    /// Stribeck velocity $w_S$: how soon the torque falls from breakaway to Coulomb.
    #[block(unit = "rad/s", positive)]
    pub stribeck_velocity: f64,
    /// Viscous coefficient $f$.
    #[block(unit = "N*m*s/rad", not_negative, default = 0.0)]
    pub viscous: f64,
    /// Stiffness of the bristles $\sigma_0$.
    #[block(
        unit = "N*m/rad",
        positive,
        remedy = "bristles without stiffness never stick; RotationalFriction needs none"
    )]
    pub sigma0: f64,
    /// Damping of the bristles $\sigma_1$ at rest.
    #[block(unit = "N*m*s/rad", not_negative, default = 0.0)]
    pub sigma1: f64,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

/// A share of the breakaway torque beyond it that counts as rounding.
const FITTING: f64 = 1e-6;

/// What follows from deflection and speed, with derivatives over the speed.
struct Bristles {
    /// Rate of the deflection, rad/s.
    rate: f64,
    d_rate: f64,
    /// Damping, N*m*s/rad.
    damping: f64,
    d_damping: f64,
}

impl LuGreFriction {
    fn bristles(&self, z: f64, w: f64) -> Bristles {
        let x = w / self.stribeck_velocity;
        let bump = (self.breakaway - self.coulomb) * (-x * x).exp();
        let g = self.coulomb + bump;
        let d_g = -2.0 * x * bump / self.stribeck_velocity;
        // |w| / g and its derivative
        let (ratio, d_ratio) = (w.abs() / g, (w.signum() - w.abs() * d_g / g) / g);
        let damping = self.sigma1 / (1.0 + 0.25 * self.sigma1 * ratio);
        Bristles {
            rate: w - self.sigma0 * ratio * z,
            d_rate: 1.0 - self.sigma0 * d_ratio * z,
            damping,
            d_damping: -0.25 * damping * damping * d_ratio,
        }
    }

    /// Torque, N*m, and its derivative over the speed at a deflection, rad, and a speed, rad/s.
    fn torque(&self, z: f64, w: f64) -> (f64, f64) {
        let b = self.bristles(z, w);
        let value = self.sigma0 * z + b.damping * b.rate + self.viscous * w;
        (value, b.d_damping * b.rate + b.damping * b.d_rate + self.viscous)
    }
}

impl Component for LuGreFriction {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .rod_and_case()
            .measures("z", "rad", Needs::State, "deflection of the bristles")
            .measures("tau", "N*m", Needs::Motion, "torque from r to c")
            .nominal_state("z", 0.0, self.breakaway / self.sigma0)
            .element(Element::Branch { r: 0, c: 1 })
            .heat_port(self.heat_port)
    }

    fn torques(&self, c: &Flowing, tau: &mut [Torque]) {
        let (value, slope) = self.torque(c.x[0], c.speed[0]);
        // Where the curve falls an implicit step must not take it for a drive.
        tau[0] = Torque { value, slope: slope.max(0.0) };
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = self.bristles(c.x[0], c.speed[0]).rate;
    }

    /// At rest the equations hold at any deflection, but no motion leads to one beyond breakaway.
    fn fit(&self, _c: &Flowing, x: &mut [f64]) -> Option<String> {
        let held = self.sigma0 * x[0].abs();
        if held <= self.breakaway * (1.0 + FITTING) {
            return None;
        }
        x[0] = (self.breakaway / self.sigma0).copysign(x[0]);
        let breakaway = self.breakaway;
        Some(format!("holds {held:.3e} N*m at rest, more than its breakaway torque of {breakaway:.3e} N*m"))
    }

    fn energy(&self, c: &Flowing) -> Energy {
        // The bristles yield: what bends them beyond their own rate becomes heat, as does what damps them.
        let (z, w) = (c.x[0], c.speed[0]);
        let b = self.bristles(z, w);
        Energy {
            stored: 0.5 * self.sigma0 * z * z,
            dissipated: self.sigma0 * z * (w - b.rate) + b.damping * b.rate * w + self.viscous * w * w,
            ..Energy::default()
        }
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y[0] = c.x[0];
    }

    fn measure_motion(&self, c: &Loaded, y: &mut [f64]) {
        y[1] = c.torque[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    const EXAMPLE: LuGreFriction = LuGreFriction {
        coulomb: 1.0,
        breakaway: 1.5,
        stribeck_velocity: 0.01,
        viscous: 0.4,
        sigma0: 1e4,
        sigma1: 100.0,
        heat_port: false,
    };

    #[test]
    fn at_rest_it_is_a_spring_and_a_damper() {
        let mut tau = [Torque::default()];
        EXAMPLE.torques(&Seen { x: &[5e-5], speed: &[0.0], ..law() }.loaded(), &mut tau);
        assert!((tau[0].value - 0.5).abs() < 1e-15);
        // Both one-sided slopes; the mean is sigma1 + f exactly.
        let h = 1e-9;
        let slope = (EXAMPLE.torque(5e-5, h).0 - EXAMPLE.torque(5e-5, -h).0) / (2.0 * h);
        assert!((slope - 100.4).abs() < 1e-4, "{slope}");
        assert!((EXAMPLE.torque(0.0, 0.0).1 - 100.4).abs() < 1e-12);
    }

    #[test]
    fn steady_sliding_has_the_stribeck_curve() {
        for w in [1e-4, 1e-3, 0.01, 0.02, 0.3, 5.0_f64] {
            let curve = 1.0 + 0.5 * (-(w / 0.01) * (w / 0.01)).exp();
            for sign in [1.0, -1.0] {
                let z = sign * curve / 1e4;
                assert!(EXAMPLE.bristles(z, sign * w).rate.abs() < 1e-14 * (1.0 + w));
                let torque = EXAMPLE.torque(z, sign * w).0;
                assert!((torque - sign * (curve + 0.4 * w)).abs() < 1e-12, "{w}: {torque}");
            }
        }
    }

    #[test]
    fn the_slope_is_the_derivative_of_the_torque_over_the_speed() {
        for (z, w) in [(5e-5, 1e-3), (-8e-5, 0.004), (1.2e-4, -0.012), (1e-4, 0.3), (-1e-4, -4.0)] {
            let h = 1e-6 * f64::abs(w);
            let difference = (EXAMPLE.torque(z, w + h).0 - EXAMPLE.torque(z, w - h).0) / (2.0 * h);
            let slope = EXAMPLE.torque(z, w).1;
            assert!((slope - difference).abs() < 1e-6 * (1.0 + difference.abs()), "{slope} != {difference}");
        }
    }

    #[test]
    fn no_deflection_and_no_speed_gain_energy() {
        // Power taken up less what the bristles store, with much bristle damping and no viscous friction.
        let model = LuGreFriction { sigma1: 3000.0, viscous: 0.0, ..EXAMPLE };
        let mut with_constant_damping = 0.0_f64;
        for i in -60..=60 {
            let z = 1.5e-4 * f64::from(i) / 60.0;
            for exponent in -12..=8 {
                for sign in [1.0, -1.0] {
                    let w = sign * 10.0_f64.powf(0.5 * f64::from(exponent));
                    let rate = model.bristles(z, w).rate;
                    let lost = model.torque(z, w).0 * w - model.sigma0 * z * rate;
                    assert!(lost >= -1e-12 * (1.0 + w * w), "z = {z}, w = {w}: {lost} W");
                    let constant = model.sigma0 * z + model.sigma1 * rate;
                    with_constant_damping = with_constant_damping.min(constant * w - model.sigma0 * z * rate);
                }
            }
        }
        assert!(with_constant_damping < -1.0, "the test must reach where constant damping fails");
    }

    #[test]
    fn parameters_that_make_no_friction_are_refused() {
        assert_eq!(EXAMPLE.errors()[..], []);
        for (model, param) in [
            (LuGreFriction { coulomb: 0.0, ..EXAMPLE }, "coulomb"),
            (LuGreFriction { breakaway: 0.5, ..EXAMPLE }, "breakaway"),
            (LuGreFriction { sigma0: 0.0, ..EXAMPLE }, "sigma0"),
        ] {
            let error = model.errors()[0].clone();
            assert_eq!(error.param, param);
            assert!(error.help.is_some());
        }
        assert_eq!(LuGreFriction { sigma1: -1.0, ..EXAMPLE }.errors()[0].param, "sigma1");
        assert_eq!(
            LuGreFriction { stribeck_velocity: 0.0, ..EXAMPLE }.errors()[0].param,
            "stribeck_velocity"
        );
    }
}
