use blocksim_block::physical::Grip;
use blocksim_block::prelude::*;

use crate::mechanics::friction_model::Pressed;

/// Friction clutch between two shafts `r` and `c`.
///
/// $$ |\tau| = n\,\tau_{max} \ \text{while it slips}, \qquad |\tau| \le n\,p\,\tau_{max} \ \text{while it is locked},
///    \qquad n = \min(\max(\mathtt{normal}, 0), 1) $$
///
/// The input is the normal force as a share of the largest one. The faster shaft drives the slower one with the
/// same torque that brakes it; the slip becomes heat. When the slip comes to zero, and the torque between the shafts is
/// not more than what is held, the clutch locks: both shafts turn as one, exactly. With more than that, or less normal
/// force, it slips again.
///
/// `Smooth` has no events: $\tau = n\,\tau_{max} \tanh(w / w_{th})$ over the slip $w$. Such a clutch never locks; it slips
/// with $w_{th} \operatorname{artanh}(\tau / n\,\tau_{max})$. A smaller threshold slips less and is stiffer; solvers
/// that use slopes (`RosW3`, `Rodas4`) do not mind.
///
/// ```ron
/// Clutch(torque: "180 N*m")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = Clutch)]
pub struct Clutch {
    /// What is pressed together.
    #[block(group)]
    pub pressed: Pressed,
}

impl Component for Clutch {
    fn part(&self, _given: &Given) -> Part {
        self.pressed.part("normal", "how hard the discs are pressed together: Bool, or a share 0 to 1")
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

    const CLUTCH: Clutch = Clutch {
        pressed: Pressed {
            torque: 10.0,
            model: FrictionModel::Smooth,
            peak: 1.0,
            threshold: 0.01,
            heat_port: false,
        },
    };

    #[test]
    fn the_torque_follows_the_normal_force_and_opposes_the_slip() {
        for (u, w, torque) in [(1.0, 5.0, 10.0), (0.5, -5.0, -5.0), (0.0, 5.0, 0.0), (3.0, 5.0, 10.0)] {
            let mut tau = [Torque::default()];
            CLUTCH.torques(&Seen { u: &[u], speed: &[w], ..law() }.loaded(), &mut tau);
            assert_eq!(tau[0].value, torque);
        }
    }

    #[test]
    fn heat_is_torque_times_slip_and_a_locked_clutch_says_so() {
        let mut y = [0.0; 3];
        CLUTCH.measure_motion(&Seen { torque: &[-4.0], speed: &[-3.0], ..law() }.loaded(), &mut y);
        assert_eq!(y, [-4.0, 12.0, 0.0]);
        CLUTCH
            .measure_motion(&Seen { torque: &[-4.0], speed: &[0.0], mode: &[0.0], ..law() }.loaded(), &mut y);
        assert_eq!(y, [-4.0, 0.0, 1.0]);
    }
}
