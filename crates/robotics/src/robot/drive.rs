//! What the drive of an axis adds to the mechanism, all counted at the joint. Of an axis that slides read m for rad, N for
//! N m and kg for kg m²: the ratio is that of the motor's speed to the speed of the slide.

/// Drive of an axis as the joint sees it: rotating masses, friction and losses. All zero, lossless and without a limit by default.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Moment of inertia of rotor and gear, times the square of the ratio, kg m².
    pub inertia: f64,
    /// Viscous damping of the motor, times the square of the ratio, N m s/rad.
    pub damping: f64,
    /// Friction of the bearing.
    pub friction: Friction,
    /// Efficiency of the gear where the motor drives, in (0, 1].
    pub efficiency_forward: f64,
    /// Efficiency of the gear where the joint drives the motor, in (0, 1].
    pub efficiency_backward: f64,
    /// Speed of the joint over which the losses of the gear set in, rad/s.
    pub threshold: f64,
    /// Largest torque of the motor, times the ratio, N m; infinite where it is not known.
    pub limit: f64,
}

impl Default for Drive {
    fn default() -> Self {
        Drive {
            inertia: 0.0,
            damping: 0.0,
            friction: Friction::default(),
            efficiency_forward: 1.0,
            efficiency_backward: 1.0,
            threshold: 0.0,
            limit: f64::INFINITY,
        }
    }
}

/// Dry and viscous friction with the peak of Stribeck at low speed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Friction {
    /// Largest torque near standstill, N m; at least the Coulomb torque.
    pub breakaway: f64,
    /// Speed of that peak, rad/s; positive unless breakaway and Coulomb torque are zero.
    pub breakaway_velocity: f64,
    /// Torque of dry friction, N m.
    pub coulomb: f64,
    /// Viscous coefficient, N m s/rad.
    pub viscous: f64,
}

impl Friction {
    /// The torque that moving at speed `w` (rad/s) costs, N m.
    ///
    /// $$ \tau = \sqrt{2e}\,(\tau_b - \tau_C) \frac{w}{w_S} e^{-(w/w_S)^2} + \tau_C \tanh\frac{w}{w_C} + f w $$
    ///
    /// with $w_S = \sqrt2\,w_b$ and $w_C = w_b / 10$, the law of the block `RotationalFriction`.
    pub fn torque(&self, w: f64) -> f64 {
        let dry = if self.breakaway_velocity > 0.0 {
            let s = w / (std::f64::consts::SQRT_2 * self.breakaway_velocity);
            let peak = (2.0 * std::f64::consts::E).sqrt() * (self.breakaway - self.coulomb);
            peak * s * (-s * s).exp() + self.coulomb * (10.0 * w / self.breakaway_velocity).tanh()
        } else {
            0.0
        };
        dry + self.viscous * w
    }
}

impl Drive {
    /// The torque of the motor, counted at the joint (times the ratio), that gives the joint the torque `tau` (N m) at
    /// speed `w` (rad/s) and acceleration `a` (rad/s²).
    ///
    /// What passes the gear is `tau` and the friction of the bearing, $\tau_p$; its loss turns with the sign of the power and
    /// sets in with the speed, by the law of the block `CycloidalDrive`
    ///
    /// $$ \tau = \tau_p + |\tau| \lambda \tanh(w / w_0), \qquad \lambda = 1 - \eta_f \text{ or } 1 / \eta_b - 1 $$
    pub fn motor_torque(&self, tau: f64, w: f64, a: f64) -> f64 {
        let passed = tau + self.friction.torque(w);
        let onset = match self.threshold > 0.0 {
            true => (w.abs() / self.threshold).tanh(),
            false => 1.0,
        };
        // Where the motor drives it gives passed / η; where it is driven it takes passed η.
        let with_losses = if passed * w >= 0.0 {
            passed / (1.0 - (1.0 - self.efficiency_forward) * onset)
        } else {
            passed / (1.0 + (1.0 / self.efficiency_backward - 1.0) * onset)
        };
        with_losses + self.inertia * a + self.damping * w
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRICTION: Friction =
        Friction { breakaway: 36.0, breakaway_velocity: 0.01, coulomb: 24.0, viscous: 12.0 };

    #[test]
    fn friction_peaks_near_the_breakaway_speed_and_ends_in_a_line() {
        let peak = (1..100).map(|i| FRICTION.torque(1e-3 * f64::from(i))).fold(0.0, f64::max);
        assert!((peak - 36.0).abs() < 0.2, "{peak}");
        assert!((FRICTION.torque(1.0) - 36.0).abs() < 1e-12);
        assert_eq!(FRICTION.torque(-0.5), -FRICTION.torque(0.5));
        assert_eq!(Friction { viscous: 2.0, ..Friction::default() }.torque(3.0), 6.0);
    }

    #[test]
    fn losses_turn_with_the_power() {
        let drive =
            Drive { efficiency_forward: 0.8, efficiency_backward: 0.5, inertia: 3.0, ..Drive::default() };
        assert_eq!(drive.motor_torque(8.0, 1.0, 0.0), 10.0);
        assert_eq!(drive.motor_torque(8.0, -1.0, 0.0), 4.0);
        assert_eq!(drive.motor_torque(-8.0, -1.0, 2.0), -10.0 + 6.0);
        let soft = Drive { threshold: 0.1, ..drive };
        assert_eq!(soft.motor_torque(8.0, 0.0, 0.0), 8.0);
    }
}
