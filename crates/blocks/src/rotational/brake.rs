use blocksim_block::physical::Grip;
use blocksim_block::prelude::*;

use crate::mechanics::friction_model::Pressed;

/// Friction brake between a turning part `r` and its housing `c`.
///
/// $$ |\tau| = e\,\tau_{max} \ \text{while it slips}, \qquad |\tau| \le e\,p\,\tau_{max} \ \text{while it holds},
///    \qquad e = \min(\max(\mathtt{engaged}, 0), 1) $$
///
/// What it holds stands still exactly, whatever the load, until that is more than what can be held. Several brakes on
/// one shaft share a load in proportion to what they can hold.
///
/// `Smooth` has no events: $\tau = e\,\tau_{max} \tanh(w / w_{th})$ over the speed $w$. Such a brake creeps under a load
/// $\tau$ with $w_{th} \operatorname{artanh}(\tau / e\,\tau_{max})$. A smaller threshold creeps less and is stiffer;
/// solvers that use slopes (`RosW3`, `Rodas4`) do not mind.
///
/// `engaged` takes a Bool, or a real share between released and fully applied.
///
/// ```ron
/// Brake(torque: "25 N*m")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = Brake)]
pub struct Brake {
    /// What is pressed together.
    #[block(group)]
    pub pressed: Pressed,
}

impl Component for Brake {
    fn part(&self, _given: &Given) -> Part {
        self.pressed.part("engaged", "how firmly it is applied: Bool, or a share 0 to 1")
    }

    fn torques(&self, c: &Flowing, tau: &mut [Torque]) {
        if !self.pressed.model.sticks() {
            tau[0] = self.pressed.smooth(c.scalar(0), c.speed[0]);
        }
    }

    fn grips(&self, c: &Flowing, grips: &mut [Grip]) {
        grips[0] = self.pressed.grip(c.scalar(0));
    }

    fn energy(&self, c: &Flowing) -> Energy {
        self.pressed.energy(c)
    }

    fn measure_motion(&self, c: &Loaded, y: &mut [f64]) {
        self.pressed.measure(c, y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::friction_model::FrictionModel;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn what_it_holds_follows_the_input_and_the_peak() {
        let brake = Brake {
            pressed: Pressed {
                torque: 10.0,
                model: FrictionModel::Stiction,
                peak: 1.2,
                threshold: 0.0,
                heat_port: false,
            },
        };
        for (u, slide) in [(1.0, 10.0), (0.5, 5.0), (0.0, 0.0), (3.0, 10.0)] {
            let mut grips = [Grip::default()];
            brake.grips(&Seen { u: &[u], speed: &[0.0], ..law() }.loaded(), &mut grips);
            assert_eq!(grips[0].slide.map(|torque| torque.value), [slide; 2]);
            assert_eq!(grips[0].hold, [1.2 * slide; 2]);
        }
    }
}
