use std::f64::consts::{FRAC_PI_2, PI};

use blocksim_block::physical::{Domain, DryMesh, Element, LossModel, MeshLoss};
use blocksim_block::prelude::*;

use super::mesh::Direction;

/// Worm and worm wheel with the friction of the thread: $w_B = \mp i\, w_F$, base the worm, follower the wheel.
///
/// With the lead angle $\gamma$, the normal pressure angle $\alpha$ and the coefficient of friction $\mu$
///
/// $$ \eta_{BF} = \frac{\cos\alpha - \mu \tan\gamma}{\cos\alpha + \mu / \tan\gamma}, \qquad
///    \eta_{FB} = \frac{\cos\alpha - \mu / \tan\gamma}{\cos\alpha + \mu \tan\gamma} $$
///
/// Where $\mu \ge \cos\alpha \tan\gamma$ the second is zero or less: the gear locks itself. No torque on the wheel turns
/// the worm then; to lower a load the worm has to be driven. The gear sticks truly: a load that it holds stands still
/// exactly. `bearing` is the torque of the worm's bearings, which is there without a load, too.
///
/// When the load overruns a self-locking worm and there is too little inertia at the worm to give way, no torque fits
/// the laws of rigid bodies: the mesh jams and stops at once, by an impact.
///
/// The gear has no inertia; its housing stands still (an implied ground).
///
/// ```ron
/// WormGear(ratio: 40.0, lead_angle: "4 deg", friction: 0.08)
/// ```
///
/// Source: balance of forces on the flank of a thread with Coulomb's friction, as in textbooks of machine elements.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Gears", symbol = Worm)]
pub struct WormGear {
    /// Teeth of the wheel over threads of the worm: the reduction $i$.
    #[block(positive, remedy = "the sign of the ratio is given by `direction: Reversed` or `Same`")]
    pub ratio: f64,
    /// `Reversed` or `Same`: the hand of the thread.
    #[block(default = Direction::Same)]
    pub direction: Direction,
    /// Lead angle $\gamma$, above 0 and below 90 deg.
    #[block(unit = "rad", above = 0.0, below = FRAC_PI_2, remedy = "write it with its unit: \"5 deg\"")]
    pub lead_angle: f64,
    /// Coefficient of friction $\mu$ of the flanks.
    #[block(not_negative)]
    pub friction: f64,
    /// Normal pressure angle $\alpha$, from 0 to below 90 deg; mostly 20 deg.
    #[block(
        unit = "rad", at_least = 0.0, below = FRAC_PI_2, default = PI / 9.0,
        remedy = "write it with its unit: \"20 deg\"",
    )]
    pub pressure_angle: f64,
    /// Torque of the bearings of the worm.
    #[block(unit = "N*m", not_negative, default = 0.0)]
    pub bearing: f64,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

impl WormGear {
    /// Efficiencies from the worm to the wheel and back.
    fn efficiencies(&self) -> [f64; 2] {
        let (cos, tan, mu) = (self.pressure_angle.cos(), self.lead_angle.tan(), self.friction);
        [(cos - mu * tan) / (cos + mu / tan), (cos - mu / tan) / (cos + mu * tan)]
    }

    fn validate(&self, errors: &mut ParamErrors) {
        if self.efficiencies()[0] <= 0.0 {
            let message =
                format!("with a friction of {} not even the worm can turn the wheel", self.friction);
            let error = ParamError::new("friction", message).beside(&["lead_angle", "pressure_angle"]);
            errors.add(error.help("it must be below cos(pressure_angle) / tan(lead_angle)"));
        }
    }
}

impl Component for WormGear {
    fn part(&self, _given: &Given) -> Part {
        let [forward, backward] = self.efficiencies();
        Part::new()
            .port("base", Domain::Rotational, "worm")
            .port("follower", Domain::Rotational, "wheel")
            .measures("tau", "N*m", Needs::Motion, "torque into the worm")
            .output(Output::boolean("locked").doc("it is stuck"), Needs::Motion)
            .element(Element::Gear {
                base: 0,
                follower: 1,
                ratio: self.direction.ratio(1.0 / self.ratio),
                loss: Some(MeshLoss { forward, backward, model: LossModel::Stiction }),
            })
            .heat_port(self.heat_port)
    }

    fn mesh_losses(&self, _c: &Flowing, _speed: &[f64], losses: &mut [DryMesh]) {
        let [forward, backward] = self.efficiencies();
        let bearing = Torque { value: self.bearing, slope: 0.0 };
        losses[0] = DryMesh { share: [1.0 / forward - 1.0, 1.0 - backward], bearing: [bearing; 2] };
    }

    fn measure_motion(&self, c: &Loaded, y: &mut [f64]) {
        y[..2].copy_from_slice(&[c.mesh[0], f64::from(c.mode[0] == 0.0)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WORM: WormGear = WormGear {
        ratio: 40.0,
        direction: Direction::Same,
        lead_angle: 4.0 * PI / 180.0,
        friction: 0.08,
        pressure_angle: PI / 9.0,
        bearing: 0.0,
        heat_port: false,
    };

    #[test]
    fn efficiencies_are_those_of_the_inclined_plane() {
        // With the angle of friction rho = atan(mu / cos alpha): tan(gamma) / tan(gamma + rho), tan(gamma - rho) / tan(gamma).
        for (gamma, mu) in [(4.0_f64, 0.08), (10.0, 0.05), (25.0, 0.1)] {
            let worm = WormGear { lead_angle: gamma.to_radians(), friction: mu, ..WORM };
            let rho = f64::atan(mu / worm.pressure_angle.cos());
            let gamma = worm.lead_angle;
            let [forward, backward] = worm.efficiencies();
            assert!((forward - gamma.tan() / (gamma + rho).tan()).abs() < 1e-12);
            assert!((backward - (gamma - rho).tan() / gamma.tan()).abs() < 1e-12);
        }
        assert!(WORM.efficiencies()[1] < 0.0, "it locks itself");
    }

    #[test]
    fn a_thread_without_lead_or_with_too_much_friction_is_refused() {
        assert_eq!(WORM.errors()[..], []);
        assert_eq!(WormGear { lead_angle: 0.0, ..WORM }.errors()[0].param, "lead_angle");
        assert_eq!(WormGear { lead_angle: 4.0, ..WORM }.errors()[0].param, "lead_angle");
        assert_eq!(WormGear { friction: 20.0, ..WORM }.errors()[0].param, "friction");
        assert_eq!(WormGear { ratio: 0.0, ..WORM }.errors()[0].param, "ratio");
    }
}
