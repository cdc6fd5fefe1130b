use blocksim_block::physical::{Domain, DryMesh, Element};
use blocksim_block::prelude::*;

use super::mesh::{Direction, EachWay};
use crate::mechanics::contact::SpringDamper;
use crate::mechanics::elastic::ElasticLaw;

/// Gear whose teeth and shafts give way: ratio, losses, then stiffness, damping and backlash on the output side.
///
/// $$ \dot\varphi = \mp \frac{w_B}{i} - w_F, \qquad \tau = k\varphi + d\dot\varphi $$
///
/// $\varphi$ is the twist seen from the follower and $\tau$ the torque on it. With `backlash`, the whole play from flank to
/// flank, nothing is transmitted within the play and the flanks only push, as in a `RotationalSpringDamper`. Losses act
/// as in a `CycloidalDrive`.
///
/// Base and follower turn independently, so both sides need inertia. The housing stands still (an implied
/// ground).
///
/// ```ron
/// ElasticGear(
///     ratio: 100.0, direction: Same, k: "2e4 N*m/rad", d: "20 N*m*s/rad", backlash: "0.02 deg", efficiency_forward: 0.8,
/// )
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Gears", symbol = ElasticGear)]
pub struct ElasticGear {
    /// Teeth of the follower over teeth of the base: the reduction $i$.
    #[block(positive, remedy = "the sign of the ratio is given by `direction: Reversed` or `Same`")]
    pub ratio: f64,
    /// `Reversed` or `Same`.
    #[block(default = Direction::Reversed)]
    pub direction: Direction,
    /// Stiffness at the follower.
    #[block(unit = "N*m/rad", not_negative)]
    pub k: f64,
    /// Damping at the follower.
    #[block(unit = "N*m*s/rad", not_negative)]
    pub d: f64,
    /// Play at the follower, from one flank to the other.
    #[block(unit = "rad", not_negative, default = 0.0)]
    pub backlash: f64,
    /// Width over which the contact sets in; with backlash only.
    #[block(unit = "rad", not_negative, default = 0.0)]
    pub transition: f64,
    /// Twist at the start; zero is the middle of the play.
    #[block(unit = "rad", finite, default = 0.0)]
    pub phi0: f64,
    /// Its losses.
    #[block(group)]
    pub losses: EachWay,
}

impl ElasticGear {
    fn shaft(&self) -> SpringDamper {
        SpringDamper { k: self.k, d: self.d, backlash: self.backlash, transition: self.transition }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        self.shaft().validate(errors);
    }
}

impl Component for ElasticGear {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new()
            .port("base", Domain::Rotational, "input side")
            .port("follower", Domain::Rotational, "output side")
            .heat_port(self.losses.onset.heat_port);
        let teeth = part.ports.len();
        let part = part
            .inner("teeth", Domain::Rotational)
            .reads("phi", "rad", Reading::State(0), "twist seen from the follower")
            .reads("tau", "N*m", Reading::Mesh(0), "torque into the base")
            .state("phi", self.phi0)
            .element(Element::Gear {
                base: 0,
                follower: teeth,
                ratio: self.direction.ratio(1.0 / self.ratio),
                loss: self.losses.mesh().element(),
            })
            .element(Element::Branch { r: teeth, c: 1 });
        self.shaft().events(part).guards_of_state()
    }

    fn torques(&self, c: &Flowing, tau: &mut [Torque]) {
        tau[0] = self.shaft().load(c.x[0], c.speed[0], c.d);
    }

    fn mesh_losses(&self, _c: &Flowing, _speed: &[f64], losses: &mut [DryMesh]) {
        losses.fill(self.losses.mesh().dry());
    }

    fn jump(&self, c: &Flowing, _x: &mut [f64], d: &mut [f64]) -> bool {
        self.shaft().settle(c.x[0], c.speed[0], d)
    }

    fn guards_of_state(&self, c: &Moving, g: &mut [f64]) {
        self.shaft().guards(c.x[0], c.speed[0], c.d, g);
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = c.speed[0];
    }

    fn energy(&self, c: &Flowing) -> Energy {
        self.shaft().energy(c.x[0], c.speed[0], c.d)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_node_inside_is_no_port() {
        let gear = ElasticGear {
            ratio: 100.0,
            direction: Direction::Same,
            k: 1e4,
            d: 10.0,
            backlash: 0.0,
            transition: 0.0,
            phi0: 0.0,
            losses: EachWay::NONE,
        };
        let interface = gear.interface(&Given::nothing()).unwrap();
        let names: Vec<&str> = interface.ports.iter().map(|port| port.name.as_str()).collect();
        assert_eq!(names, ["base", "follower"]);
        assert_eq!(ElasticGear { ratio: 0.0, ..gear.clone() }.errors()[0].param, "ratio");
        assert_eq!(ElasticGear { k: -1.0, ..gear.clone() }.errors()[0].param, "k");
        assert_eq!(
            ElasticGear { losses: EachWay { efficiency_backward: 0.0, ..EachWay::NONE }, ..gear }.errors()[0]
                .param,
            "efficiency_backward"
        );
    }
}
