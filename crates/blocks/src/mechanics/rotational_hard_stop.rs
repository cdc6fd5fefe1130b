use blocksim_block::physical::Element;
use blocksim_block::prelude::*;

use super::joint_limit::JointLimit;

/// End of travel between two turning parts: free between two angles, a spring and a damper beyond them.
///
/// $$ \tau = s\,(k\,\delta + d\,\dot\delta), \qquad s = 3 x^2 - 2 x^3, \quad x = \min(\delta / b, 1) $$
///
/// with the penetration $\delta = \varphi - \varphi_{upper}$, or the mirrored law at the lower end. Both parts
/// set in smoothly over the transition width $b$; the stop pushes back and never pulls, so it never delivers
/// more than its spring has stored. The angle $\varphi$, $\dot\varphi = w_r - w_c$, is a state.
///
/// ```ron
/// RotationalHardStop(lower: "-90 deg", upper: "90 deg", stiffness: "1e5 N*m/rad", damping: "50 N*m*s/rad")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Mechanics")]
pub struct RotationalHardStop {
    /// Least angle without contact.
    #[block(unit = "rad", default = -0.1)]
    pub lower: f64,
    /// Largest angle without contact.
    #[block(unit = "rad", default = 0.1)]
    pub upper: f64,
    /// Stiffness $k$ of both ends.
    #[block(unit = "N*m/rad", default = 1e6)]
    pub stiffness: f64,
    /// Damping $d$ of both ends.
    #[block(unit = "N*m*s/rad", default = 0.01)]
    pub damping: f64,
    /// Width $b$ over which an end sets in; zero sets in at once.
    #[block(unit = "rad", default = 1e-3)]
    pub transition: f64,
    /// Angle at the start.
    #[block(unit = "rad", default = 0.0)]
    pub phi0: f64,
}

impl RotationalHardStop {
    /// Torque at an angle, rad, and a speed, rad/s.
    fn torque(&self, phi: f64, w: f64) -> Torque {
        let limit =
            JointLimit { stiffness: self.stiffness, damping: self.damping, transition: self.transition };
        let (above, below) = (limit.push(phi - self.upper, w), limit.push(self.lower - phi, -w));
        Torque { value: above.value - below.value, slope: above.slope + below.slope }
    }
}

impl Block for RotationalHardStop {
    fn check(&self) -> Result<(), ParamError> {
        finite("lower", self.lower)?;
        finite("upper", self.upper)?;
        ordered("lower", self.lower, "upper", self.upper)?;
        not_negative("stiffness", self.stiffness)?;
        not_negative("damping", self.damping)?;
        not_negative("transition", self.transition)?;
        finite("phi0", self.phi0)?;
        if self.phi0 < self.lower || self.phi0 > self.upper {
            return Err(ParamError::new(
                "phi0",
                format!(
                    "the parts start at {} rad, outside the free travel from {} to {} rad",
                    self.phi0, self.lower, self.upper
                ),
            )
            .help("start within the travel, or move `lower` and `upper`"));
        }
        Ok(())
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for RotationalHardStop {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .rod_and_case()
            .measures("phi", "rad", Needs::State, "angle of r against c")
            .measures("tau", "N*m", Needs::Motion, "torque from r to c")
            .state("phi", self.phi0)
            .element(Element::Branch { r: 0, c: 1 })
    }

    fn torques(&self, c: &Law, tau: &mut [Torque]) {
        tau[0] = self.torque(c.x[0], c.speed[0]);
    }

    fn derivatives(&self, c: &Law, dx: &mut [f64]) {
        dx[0] = c.speed[0];
    }

    fn measure(&self, c: &Law, needs: Needs, y: &mut [f64]) {
        match needs {
            Needs::State => y[0] = c.x[0],
            Needs::Electrics => {}
            Needs::Motion => y[1] = c.torque[0],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STOP: RotationalHardStop = RotationalHardStop {
        lower: -0.5,
        upper: 1.0,
        stiffness: 1000.0,
        damping: 20.0,
        transition: 0.1,
        phi0: 0.0,
    };

    #[test]
    fn the_penetration_gives_the_torque_of_the_smoothed_law_at_both_ends() {
        // Penetration, rad, and the smooth step over a width of 0.1 rad.
        for (depth, onset) in [(0.0, 0.0), (0.025, 0.15625), (0.05, 0.5), (0.075, 0.84375), (0.1, 1.0)] {
            let torque = onset * 1000.0 * depth;
            assert!((STOP.torque(1.0 + depth, 0.0).value - torque).abs() < 1e-11, "{depth}");
            assert!((STOP.torque(-0.5 - depth, 0.0).value + torque).abs() < 1e-11, "{depth}");
        }
    }

    #[test]
    fn between_the_ends_it_is_free_and_beyond_them_it_never_pulls() {
        assert_eq!(STOP.torque(0.9, 100.0), Torque::default());
        assert_eq!(STOP.torque(1.2, -11.0), Torque::default(), "moving out fast");
        assert_eq!(STOP.torque(1.25, 1.0), Torque { value: 270.0, slope: 20.0 });
        assert_eq!(STOP.torque(-0.75, -1.0), Torque { value: -270.0, slope: 20.0 });
    }

    #[test]
    fn a_travel_out_of_order_and_a_start_in_the_stop_are_refused() {
        assert_eq!(RotationalHardStop { upper: -1.0, ..STOP }.check().unwrap_err().param, "upper");
        let error = RotationalHardStop { phi0: 1.5, ..STOP }.check().unwrap_err();
        assert_eq!(error.param, "phi0");
        assert!(error.help.is_some());
        assert_eq!(STOP.check(), Ok(()));
    }
}
