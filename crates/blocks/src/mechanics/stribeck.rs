//! Friction of a bearing or a guide: breakaway, Coulomb and viscous parts over the speed.

use std::f64::consts::{E, SQRT_2};

use blocksim_block::physical::{Grip, Part, Torque};
use blocksim_block::prelude::*;

use super::friction_model::FrictionModel;
use super::quantities::Quantities;

/// Parameters of the curve; units are those of rotation, in translation N, m/s and N*s/m.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stribeck {
    /// Largest friction at rest, N*m.
    pub breakaway: f64,
    /// Speed of the largest friction of the smooth curve, rad/s.
    pub breakaway_velocity: f64,
    /// Friction while sliding, N*m.
    pub coulomb: f64,
    /// Viscous coefficient, N*m*s/rad.
    pub viscous: f64,
    pub model: FrictionModel,
}

impl Stribeck {
    /// Reports a curve that jumps at standstill.
    pub(crate) fn validate(&self, errors: &mut ParamErrors) {
        if self.model == FrictionModel::Smooth && self.breakaway > 0.0 && self.breakaway_velocity == 0.0 {
            let message = "`breakaway_velocity` is 0, but the torque would then jump at standstill";
            let error = ParamError::new("breakaway_velocity", message).beside(&["breakaway"]);
            errors.add(error.help(
                "write `model: Stiction` for friction that sticks, a small velocity such as \"0.001 rad/s\" for a \
                 smooth curve, or zero for `breakaway` and `coulomb`",
            ));
        }
    }

    /// Ports and element.
    pub(crate) fn part(&self, quantities: &Quantities) -> Part {
        quantities.between(self.model.element())
    }

    /// What a smooth branch transmits; nothing where the friction sticks, which [`grip`](Self::grip) describes.
    pub(crate) fn loads(&self, c: &Flowing, load: &mut [Torque]) {
        if self.model.sticks() {
            return;
        }
        let (value, slope) = self.smooth(c.speed[0]);
        // Beyond the breakaway velocity the curve falls; an implicit step damps only where it rises.
        load[0] = Torque { value, slope: slope.max(0.0) };
    }

    /// Heat of a smooth branch; that of friction that sticks is booked by the network.
    pub(crate) fn energy(&self, c: &Flowing) -> Energy {
        match self.model.sticks() {
            true => Energy::default(),
            false => Energy::dissipated(self.smooth(c.speed[0]).0 * c.speed[0]),
        }
    }

    /// What it holds, and its friction while it slides at a speed.
    pub(crate) fn grip(&self, w: f64) -> Grip {
        Grip::symmetric(self.breakaway, w, |w| self.sliding(w))
    }

    /// Smooth friction and its derivative at a speed.
    fn smooth(&self, w: f64) -> (f64, f64) {
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

    /// Friction of surfaces that slide in one direction at this speed in it; smooth through zero.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};
    use crate::rotational::RotationalFriction;

    const EXAMPLE: Stribeck = Stribeck {
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
            let found = EXAMPLE.smooth(w).0;
            assert!((found - torque).abs() < 1e-7, "{w}: {found} != {torque}");
            assert_eq!(EXAMPLE.smooth(-w).0, -found);
        }
        let slope = EXAMPLE.smooth(0.0).1;
        assert!((slope - 2_082.437_06).abs() < 6e-6, "{slope}");
    }

    #[test]
    fn the_slope_is_the_derivative_of_the_torque() {
        for w in [0.0, 0.003, 0.02, 0.09, 0.15, -0.3, 2.0] {
            let h = 1e-6;
            let difference = (EXAMPLE.smooth(w + h).0 - EXAMPLE.smooth(w - h).0) / (2.0 * h);
            let slope = EXAMPLE.smooth(w).1;
            assert!(
                (slope - difference).abs() < 1e-4 * (1.0 + difference.abs()),
                "{w}: {slope} != {difference}"
            );
        }
    }

    #[test]
    fn on_the_falling_branch_no_damping_is_reported() {
        let mut tau = [Torque::default()];
        EXAMPLE.loads(&Seen { speed: &[0.2], ..law() }.loaded(), &mut tau);
        assert!(EXAMPLE.smooth(0.2).1 < 0.0);
        assert_eq!(tau[0].slope, 0.0);
    }

    #[test]
    fn stiction_breaks_away_at_the_same_torque_and_ends_in_the_same_curve() {
        let sticks = Stribeck { model: FrictionModel::Stiction, ..EXAMPLE };
        assert_eq!(sticks.sliding(0.0).value, 25.0);
        for w in [0.5, 1.0, 30.0] {
            assert!((sticks.sliding(w).value - EXAMPLE.smooth(w).0).abs() < 1e-3, "{w}");
        }
        let hard = Stribeck { breakaway_velocity: 0.0, ..sticks };
        assert_eq!(hard.sliding(1e-9).value, 20.0 + 1e-12);
        let grip = hard.grip(-2.0);
        assert_eq!((grip.hold, grip.slide[1].value), ([25.0; 2], 20.002));
    }

    fn friction(law: Stribeck) -> RotationalFriction {
        let Stribeck { breakaway, breakaway_velocity, coulomb, viscous, model } = law;
        RotationalFriction { breakaway, breakaway_velocity, coulomb, viscous, model, heat_port: false }
    }

    #[test]
    fn zeros_are_legal_and_give_zero_torque() {
        let none =
            Stribeck { breakaway: 0.0, breakaway_velocity: 0.0, coulomb: 0.0, viscous: 0.0, ..EXAMPLE };
        assert_eq!(friction(none).errors()[..], []);
        assert_eq!(none.smooth(3.0), (0.0, 0.0));
    }

    #[test]
    fn a_jump_at_standstill_and_a_breakaway_below_coulomb_are_refused() {
        let jump = Stribeck { breakaway_velocity: 0.0, ..EXAMPLE };
        let error = friction(jump).errors()[0].clone();
        assert_eq!(error.param, "breakaway_velocity");
        assert!(error.help.is_some_and(|help| help.contains("Stiction")));
        assert_eq!(friction(Stribeck { model: FrictionModel::Stiction, ..jump }).errors()[..], []);
        assert_eq!(friction(Stribeck { breakaway: 19.0, ..EXAMPLE }).errors()[0].param, "breakaway");
    }
}
