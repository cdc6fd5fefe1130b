use blocksim_block::physical::Element;
use blocksim_block::prelude::*;

use super::coulomb::Coulomb;

/// Friction brake between a turning part `r` and its housing `c`.
///
/// $$ \tau = e\,\tau_{max} \tanh\frac{w_r - w_c}{w_{th}}, \qquad e = \min(\max(\mathtt{engaged}, 0), 1) $$
///
/// There is no true sticking: a part that is held under a load $\tau < e\,\tau_{max}$ creeps with
/// $w_{th} \operatorname{artanh}(\tau / e\,\tau_{max})$. A smaller threshold creeps less and is stiffer; solvers
/// that use slopes (`RosW3`, `Rodas4`) do not mind.
///
/// `engaged` takes a Bool, or a real share between released and fully applied.
///
/// ```ron
/// Brake(torque: "25 N*m")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Mechanics")]
pub struct Brake {
    /// Torque that it transmits while slipping, fully applied.
    #[block(unit = "N*m")]
    pub torque: f64,
    /// Speed at which 76 % of the torque act; far below the speeds of the machine.
    #[block(unit = "rad/s", default = 0.01)]
    pub threshold: f64,
}

impl Brake {
    fn friction(&self, share: f64, w: f64) -> Torque {
        Coulomb { torque: self.torque, threshold: self.threshold }.at(share, w)
    }
}

impl Block for Brake {
    fn check(&self) -> Result<(), ParamError> {
        not_negative("torque", self.torque)?;
        positive("threshold", self.threshold).map_err(|error| {
            error.help("the torque would jump at standstill; write a small speed such as \"0.01 rad/s\"")
        })
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for Brake {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .rod_and_case()
            .input(Input::any("engaged").scalar().doc("how firmly it is applied: Bool, or a share 0 to 1"))
            .measures("tau", "N*m", Needs::Motion, "torque from r to c")
            .measures("heat", "W", Needs::Motion, "power that becomes heat")
            .element(Element::Branch { r: 0, c: 1 })
    }

    fn torques(&self, c: &Law, tau: &mut [Torque]) {
        tau[0] = self.friction(c.scalar(0), c.speed[0]);
    }

    fn measure(&self, c: &Law, needs: Needs, y: &mut [f64]) {
        if needs == Needs::Motion {
            y[..2].copy_from_slice(&[c.torque[0], c.torque[0] * c.speed[0]]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::law;

    #[test]
    fn the_torque_follows_the_input_and_opposes_the_speed() {
        let block = Brake { torque: 10.0, threshold: 0.01 };
        for (u, w, torque) in [(1.0, 5.0, 10.0), (0.5, -5.0, -5.0), (0.0, 5.0, 0.0), (3.0, 5.0, 10.0)] {
            let mut tau = [Torque::default()];
            block.torques(&Law { u: &[u], speed: &[w], ..law() }, &mut tau);
            assert_eq!(tau[0].value, torque);
        }
    }

    #[test]
    fn heat_is_torque_times_slip() {
        let block = Brake { torque: 10.0, threshold: 0.01 };
        let mut y = [0.0; 2];
        block.measure(&Law { torque: &[-4.0], speed: &[-3.0], ..law() }, Needs::Motion, &mut y);
        assert_eq!(y, [-4.0, 12.0]);
    }

    #[test]
    fn a_jump_at_standstill_is_refused() {
        let error = Brake { torque: 10.0, threshold: 0.0 }.check().unwrap_err();
        assert_eq!(error.param, "threshold");
        assert!(error.help.is_some());
        assert_eq!(Brake { torque: -1.0, threshold: 0.1 }.check().unwrap_err().param, "torque");
    }
}
