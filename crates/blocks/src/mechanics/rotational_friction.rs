use std::f64::consts::{E, SQRT_2};

use blocksim_block::physical::Grip;
use blocksim_block::prelude::*;

use super::friction_model::FrictionModel;

/// Friction of a bearing: breakaway (Stribeck), Coulomb and viscous parts, as one smooth curve over the speed
/// $w = w_r - w_c$.
///
/// $$ \tau = \sqrt{2e}\,(\tau_b - \tau_C)\, \frac{w}{w_S} e^{-(w/w_S)^2} + \tau_C \tanh\frac{w}{w_C} + f w,
///    \qquad w_S = \sqrt 2\, w_b, \qquad w_C = \frac{w_b}{10} $$
///
/// This is the `Smooth` model. At the breakaway velocity $w_b$ the torque is the breakaway torque $\tau_b$ (plus $f w_b$), far above it
/// $\tau_C + f w$. There is no true sticking: under a load below $\tau_b$ the part creeps, slower than $w_C$.
/// Around standstill the curve is steep; with a small breakaway velocity a solver that uses the slope (`W`)
/// takes far fewer steps.
///
/// `Stiction` sticks truly. Stuck, the speed is exactly zero and the torque is whatever keeps it so, up to $\tau_b$;
/// beyond, it slides with
///
/// $$ \tau = \pm\bigl(\tau_C + (\tau_b - \tau_C)\, e^{-(w/w_S)^2}\bigr) + f w $$
///
/// until the speed comes to zero again. Both changes are events. A breakaway velocity of zero leaves $\tau_C$ as soon
/// as it slides: hard Coulomb friction.
///
/// All torques may be zero.
///
/// ```ron
/// RotationalFriction(
///     breakaway: "25 N*m", breakaway_velocity: "0.1 rad/s", coulomb: "20 N*m", viscous: "0.001 N*m*s/rad",
///     model: Stiction,
/// )
/// ```
///
/// Source: the friction law of common libraries of rotational parts, after B. Armstrong and C. Canudas de
/// Wit, *Friction Modeling and Compensation* (1995).
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Mechanics")]
pub struct RotationalFriction {
    /// Breakaway torque $\tau_b$, at least the Coulomb torque.
    #[block(unit = "N*m")]
    pub breakaway: f64,
    /// Breakaway velocity $w_b$: speed of the largest friction torque.
    #[block(unit = "rad/s")]
    pub breakaway_velocity: f64,
    /// Coulomb torque $\tau_C$.
    #[block(unit = "N*m")]
    pub coulomb: f64,
    /// Viscous coefficient $f$.
    #[block(unit = "N*m*s/rad", default = 0.0)]
    pub viscous: f64,
    /// `Smooth` or `Stiction`.
    #[block(default = FrictionModel::Smooth)]
    pub model: FrictionModel,
}

impl RotationalFriction {
    /// Torque, N*m, and its derivative, N*m*s/rad, at a speed in rad/s.
    fn torque(&self, w: f64) -> (f64, f64) {
        let (mut value, mut slope) = (self.viscous * w, self.viscous);
        if self.breakaway > self.coulomb {
            let stribeck = self.breakaway_velocity * SQRT_2;
            let x = w / stribeck;
            let bump = (2.0 * E).sqrt() * (self.breakaway - self.coulomb) * (-x * x).exp();
            value += bump * x;
            slope += bump * (1.0 - 2.0 * x * x) / stribeck;
        }
        if self.coulomb > 0.0 {
            let coulomb = self.breakaway_velocity / 10.0;
            let onset = (w / coulomb).tanh();
            value += self.coulomb * onset;
            slope += self.coulomb * (1.0 - onset * onset) / coulomb;
        }
        (value, slope)
    }

    /// Torque of surfaces that slide in one direction at this speed in it; smooth through zero.
    fn sliding(&self, w: f64) -> Torque {
        let mut torque = Torque { value: self.coulomb + self.viscous * w, slope: self.viscous };
        if self.breakaway > self.coulomb && self.breakaway_velocity > 0.0 {
            let stribeck = self.breakaway_velocity * SQRT_2;
            let x = w / stribeck;
            let bump = (self.breakaway - self.coulomb) * (-x * x).exp();
            torque.value += bump;
            torque.slope -= 2.0 * bump * x / stribeck;
        }
        // Where the curve falls, an implicit step must not count on it.
        Torque { slope: torque.slope.max(0.0), ..torque }
    }
}

impl Block for RotationalFriction {
    fn check(&self) -> Result<(), ParamError> {
        not_negative("coulomb", self.coulomb)?;
        not_negative("viscous", self.viscous)?;
        not_negative("breakaway_velocity", self.breakaway_velocity)?;
        finite("breakaway", self.breakaway)?;
        if self.breakaway < self.coulomb {
            return Err(ParamError::new(
                "breakaway",
                format!(
                    "the breakaway torque ({}) is below the Coulomb torque ({})",
                    self.breakaway, self.coulomb
                ),
            )
            .help("without a Stribeck effect write the same value for `breakaway` and `coulomb`"));
        }
        if self.model == FrictionModel::Smooth && self.breakaway > 0.0 && self.breakaway_velocity == 0.0 {
            return Err(ParamError::new(
                "breakaway_velocity",
                "`breakaway_velocity` is 0, but the torque would then jump at standstill",
            )
            .help(
                "write `model: Stiction` for friction that sticks, a small velocity such as \"0.001 rad/s\" for a \
                 smooth curve, or zero for `breakaway` and `coulomb`",
            ));
        }
        Ok(())
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for RotationalFriction {
    fn part(&self, _given: &Given) -> Part {
        Part::new().rod_and_case().element(self.model.element())
    }

    fn grips(&self, c: &Law, grips: &mut [Grip]) {
        grips[0] = Grip::symmetric(self.breakaway, c.speed[0], |w| self.sliding(w));
    }

    fn torques(&self, c: &Law, tau: &mut [Torque]) {
        if self.model.sticks() {
            return;
        }
        let (value, slope) = self.torque(c.speed[0]);
        // Beyond the breakaway velocity the curve falls; an implicit step damps only where it rises.
        tau[0] = Torque { value, slope: slope.max(0.0) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::law;

    const EXAMPLE: RotationalFriction = RotationalFriction {
        breakaway: 25.0,
        breakaway_velocity: 0.1,
        coulomb: 20.0,
        viscous: 0.001,
        model: FrictionModel::Smooth,
    };

    #[test]
    fn the_curve_has_its_reference_values_and_is_odd() {
        let expected = [
            (0.001, 2.075_792_8),
            (0.005, 9.654_013_6),
            (0.01, 16.052_142_2),
            (0.05, 23.635_712_6),
            (0.1, 25.000_099_9),
            (0.2, 22.231_501_6),
            (0.5, 20.000_653_7),
            (1.0, 20.001_000_0),
        ];
        for (w, torque) in expected {
            let found = EXAMPLE.torque(w).0;
            assert!((found - torque).abs() < 1e-7, "{w}: {found} != {torque}");
            assert_eq!(EXAMPLE.torque(-w).0, -found);
        }
        let slope = EXAMPLE.torque(0.0).1;
        assert!((slope - 2_082.437_06).abs() < 6e-6, "{slope}");
    }

    #[test]
    fn the_slope_is_the_derivative_of_the_torque() {
        for w in [0.0, 0.003, 0.02, 0.09, 0.15, -0.3, 2.0] {
            let h = 1e-6;
            let difference = (EXAMPLE.torque(w + h).0 - EXAMPLE.torque(w - h).0) / (2.0 * h);
            let slope = EXAMPLE.torque(w).1;
            assert!(
                (slope - difference).abs() < 1e-4 * (1.0 + difference.abs()),
                "{w}: {slope} != {difference}"
            );
        }
    }

    #[test]
    fn on_the_falling_branch_no_damping_is_reported() {
        let mut tau = [Torque::default()];
        EXAMPLE.torques(&Law { speed: &[0.2], ..law() }, &mut tau);
        assert!(EXAMPLE.torque(0.2).1 < 0.0);
        assert_eq!(tau[0].slope, 0.0);
    }

    #[test]
    fn stiction_breaks_away_at_the_same_torque_and_ends_in_the_same_curve() {
        let sticks = RotationalFriction { model: FrictionModel::Stiction, ..EXAMPLE };
        assert_eq!(sticks.sliding(0.0).value, 25.0);
        for w in [0.5, 1.0, 30.0] {
            assert!((sticks.sliding(w).value - EXAMPLE.torque(w).0).abs() < 1e-3, "{w}");
        }
        let hard = RotationalFriction { breakaway_velocity: 0.0, ..sticks };
        assert_eq!(hard.sliding(1e-9).value, 20.0 + 1e-12);
        let mut grips = [Grip::default()];
        hard.grips(&Law { speed: &[-2.0], ..law() }, &mut grips);
        assert_eq!((grips[0].hold, grips[0].slide[1].value), ([25.0; 2], 20.002));
    }

    #[test]
    fn zeros_are_legal_and_give_zero_torque() {
        let none = RotationalFriction {
            breakaway: 0.0,
            breakaway_velocity: 0.0,
            coulomb: 0.0,
            viscous: 0.0,
            ..EXAMPLE
        };
        assert_eq!(none.check(), Ok(()));
        assert_eq!(none.torque(3.0), (0.0, 0.0));
    }

    #[test]
    fn a_jump_at_standstill_and_a_breakaway_below_coulomb_are_refused() {
        let jump = RotationalFriction { breakaway_velocity: 0.0, ..EXAMPLE };
        let error = jump.check().unwrap_err();
        assert_eq!(error.param, "breakaway_velocity");
        assert!(error.help.is_some_and(|help| help.contains("Stiction")));
        assert_eq!(RotationalFriction { model: FrictionModel::Stiction, ..jump }.check(), Ok(()));
        assert_eq!(RotationalFriction { breakaway: 19.0, ..EXAMPLE }.check().unwrap_err().param, "breakaway");
    }
}
