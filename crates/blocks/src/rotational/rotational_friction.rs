use blocksim_block::physical::Grip;
use blocksim_block::prelude::*;

use crate::mechanics::friction_model::FrictionModel;
use crate::mechanics::quantities::ROTATION;
use crate::mechanics::stribeck::Stribeck;

/// Friction of a bearing: breakaway (Stribeck), Coulomb and viscous parts, as one smooth curve over the speed
/// $w = w_r - w_c$.
///
/// $$ \tau = \sqrt{2e}\,(\tau_b - \tau_C)\, \frac{w}{w_S} e^{-(w/w_S)^2} + \tau_C \tanh\frac{w}{w_C} + f w,
///    \qquad w_S = \sqrt 2\, w_b, \qquad w_C = \frac{w_b}{10} $$
///
/// This is the `Smooth` model. At the breakaway velocity $w_b$ the torque is the breakaway torque $\tau_b$ (plus
/// $f w_b$), far above it $\tau_C + f w$. There is no true sticking: under a load below $\tau_b$ the part creeps, slower than $w_C$.
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
#[block(category = "Rotational", symbol = Friction)]
pub struct RotationalFriction {
    /// Breakaway torque $\tau_b$, at least the Coulomb torque.
    #[block(
        unit = "N*m", finite, at_least = coulomb,
        remedy = "without a Stribeck effect write the same value for `breakaway` and `coulomb`",
    )]
    pub breakaway: f64,
    /// Breakaway velocity $w_b$: speed of the largest friction torque.
    #[block(unit = "rad/s", not_negative)]
    pub breakaway_velocity: f64,
    /// Coulomb torque $\tau_C$.
    #[block(unit = "N*m", not_negative)]
    pub coulomb: f64,
    /// Viscous coefficient $f$.
    #[block(unit = "N*m*s/rad", not_negative, default = 0.0)]
    pub viscous: f64,
    /// `Smooth` or `Stiction`.
    #[block(default = FrictionModel::Smooth)]
    pub model: FrictionModel,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

impl RotationalFriction {
    fn law(&self) -> Stribeck {
        let Self { breakaway, breakaway_velocity, coulomb, viscous, model, .. } = *self;
        Stribeck { breakaway, breakaway_velocity, coulomb, viscous, model }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        self.law().validate(errors);
    }
}

impl Component for RotationalFriction {
    fn part(&self, _given: &Given) -> Part {
        self.law().part(&ROTATION).heat_port(self.heat_port)
    }

    fn grips(&self, c: &Flowing, grips: &mut [Grip]) {
        grips[0] = self.law().grip(c.speed[0]);
    }

    fn torques(&self, c: &Flowing, tau: &mut [Torque]) {
        self.law().loads(c, tau);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        self.law().energy(c)
    }
}
