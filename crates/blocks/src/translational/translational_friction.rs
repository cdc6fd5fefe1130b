use blocksim_block::physical::Grip;
use blocksim_block::prelude::*;

use crate::mechanics::FrictionModel;
use crate::mechanics::quantities::TRANSLATION;
use crate::mechanics::stribeck::Stribeck;

/// Friction of a guide: breakaway (Stribeck), Coulomb and viscous parts over the velocity $v = v_r - v_c$.
///
/// $$ F = \sqrt{2e}\,(F_b - F_C)\, \frac{v}{v_S} e^{-(v/v_S)^2} + F_C \tanh\frac{v}{v_C} + f v,
///    \qquad v_S = \sqrt 2\, v_b, \qquad v_C = \frac{v_b}{10} $$
///
/// This is the `Smooth` model: one curve without events, under which a part that is held creeps slower than $v_C$.
/// `Stiction` sticks truly: at rest the force is whatever keeps the part there, up to $F_b$; beyond, it slides with
///
/// $$ F = \pm\bigl(F_C + (F_b - F_C)\, e^{-(v/v_S)^2}\bigr) + f v $$
///
/// until the velocity comes to zero again. The laws are those of a `RotationalFriction`. All forces may be zero.
///
/// ```ron
/// TranslationalFriction(
///     breakaway: "60 N", breakaway_velocity: "5 mm/s", coulomb: "45 N", viscous: "80 N*s/m", model: Stiction,
/// )
/// ```
///
/// Source: as `RotationalFriction`.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Translational", symbol = Friction)]
pub struct TranslationalFriction {
    /// Breakaway force $F_b$, at least the Coulomb force.
    #[block(
        unit = "N", finite, at_least = coulomb,
        remedy = "without a Stribeck effect write the same value for `breakaway` and `coulomb`",
    )]
    pub breakaway: f64,
    /// Breakaway velocity $v_b$: velocity of the largest friction of the smooth curve.
    #[block(unit = "m/s", not_negative)]
    pub breakaway_velocity: f64,
    /// Coulomb force $F_C$.
    #[block(unit = "N", not_negative)]
    pub coulomb: f64,
    /// Viscous coefficient $f$.
    #[block(unit = "N*s/m", not_negative, default = 0.0)]
    pub viscous: f64,
    /// `Smooth` or `Stiction`.
    #[block(default = FrictionModel::Smooth)]
    pub model: FrictionModel,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

impl TranslationalFriction {
    fn law(&self) -> Stribeck {
        let Self { breakaway, breakaway_velocity, coulomb, viscous, model, .. } = *self;
        Stribeck { breakaway, breakaway_velocity, coulomb, viscous, model }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        self.law().validate(errors);
    }
}

impl Component for TranslationalFriction {
    fn part(&self, _given: &Given) -> Part {
        self.law().part(&TRANSLATION).heat_port(self.heat_port)
    }

    fn grips(&self, c: &Flowing, grips: &mut [Grip]) {
        grips[0] = self.law().grip(c.speed[0]);
    }

    fn torques(&self, c: &Flowing, f: &mut [Torque]) {
        self.law().loads(c, f);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        self.law().energy(c)
    }
}
