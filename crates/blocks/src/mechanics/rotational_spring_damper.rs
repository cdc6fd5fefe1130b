use blocksim_block::physical::Element;
use blocksim_block::prelude::*;

use super::joint_limit::JointLimit;

/// Elastic shaft: a torsion spring and a damper side by side, with backlash if there is any.
///
/// $$ \tau = k \varphi + d w, \qquad \dot\varphi = w = w_r - w_c $$
///
/// With a backlash $b$, the whole play from flank to flank, nothing is transmitted while $|\varphi| < b/2$.
/// Beyond it the flanks are pressed together by $\delta = |\varphi| - b/2$ and
///
/// $$ \tau = \operatorname{sgn}(\varphi)\, \max\bigl(0,\; s\,(k \delta + d \dot\delta)\bigr) $$
///
/// Flanks push and never pull. The contact sets in at once ($s = 1$), or over the width `transition` with
/// $s = 3 x^2 - 2 x^3$, $x = \min(\delta / \mathtt{transition}, 1)$, which solvers with step size control like
/// better. Without backlash the parts are joined, and the torque acts in both directions.
///
/// ```ron
/// RotationalSpringDamper(k: "2e4 N*m/rad", d: "15 N*m*s/rad", backlash: "0.02 deg")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Mechanics")]
pub struct RotationalSpringDamper {
    /// Stiffness; zero is allowed.
    #[block(unit = "N*m/rad")]
    pub k: f64,
    /// Damping coefficient; zero is allowed.
    #[block(unit = "N*m*s/rad")]
    pub d: f64,
    /// Play between the flanks, from one contact to the other.
    #[block(unit = "rad", default = 0.0)]
    pub backlash: f64,
    /// Width over which the contact sets in; with backlash only.
    #[block(unit = "rad", default = 0.0)]
    pub transition: f64,
    /// Deflection at the start; zero is the middle of the play.
    #[block(unit = "rad", default = 0.0)]
    pub phi0: f64,
}

impl RotationalSpringDamper {
    /// Torque at a deflection, rad, and a speed, rad/s.
    fn torque(&self, phi: f64, w: f64) -> Torque {
        if self.backlash == 0.0 {
            return Torque { value: self.k * phi + self.d * w, slope: self.d };
        }
        let flank = JointLimit { stiffness: self.k, damping: self.d, transition: self.transition };
        let side = phi.signum();
        let push = flank.push(phi.abs() - 0.5 * self.backlash, side * w);
        Torque { value: side * push.value, slope: push.slope }
    }
}

impl Block for RotationalSpringDamper {
    fn check(&self) -> Result<(), ParamError> {
        not_negative("k", self.k)?;
        not_negative("d", self.d)?;
        not_negative("backlash", self.backlash)?;
        not_negative("transition", self.transition)?;
        finite("phi0", self.phi0)?;
        if self.backlash == 0.0 && self.transition > 0.0 {
            return Err(ParamError::new(
                "transition",
                "`transition` tells how flanks meet, but without `backlash` there are none",
            )
            .help("give a `backlash`, or leave `transition` out"));
        }
        Ok(())
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for RotationalSpringDamper {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .rod_and_case()
            .measures("phi", "rad", Needs::State, "deflection")
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

    const SHAFT: RotationalSpringDamper =
        RotationalSpringDamper { k: 100.0, d: 2.0, backlash: 0.0, transition: 0.0, phi0: 0.0 };
    const LOOSE: RotationalSpringDamper = RotationalSpringDamper { backlash: 0.5, ..SHAFT };

    #[test]
    fn without_backlash_it_is_a_spring_and_a_damper_in_both_directions() {
        assert_eq!(SHAFT.torque(0.25, -30.0), Torque { value: -35.0, slope: 2.0 });
        assert_eq!(SHAFT.torque(-0.25, 1.0), Torque { value: -23.0, slope: 2.0 });
    }

    #[test]
    fn within_the_play_nothing_is_transmitted_and_flanks_never_pull() {
        for phi in [-0.25, -0.1, 0.0, 0.2, 0.25] {
            assert_eq!(LOOSE.torque(phi, 40.0).value, 0.0);
            assert_eq!(LOOSE.torque(phi, 40.0).slope, 0.0);
        }
        assert_eq!(LOOSE.torque(0.5, 3.0), Torque { value: 31.0, slope: 2.0 });
        assert_eq!(LOOSE.torque(-0.5, -3.0), Torque { value: -31.0, slope: 2.0 });
        assert_eq!(LOOSE.torque(0.5, -13.0).value, 0.0, "the flanks part");
        assert_eq!(LOOSE.torque(-0.5, 13.0).slope, 0.0, "the flanks part");
    }

    #[test]
    fn the_slope_is_the_derivative_over_the_speed() {
        let soft = RotationalSpringDamper { transition: 0.2, ..LOOSE };
        for (phi, w) in [(0.3, 1.0), (0.35, -2.0), (-0.4, -0.5), (0.9, 4.0)] {
            let h = 1e-5;
            let difference = (soft.torque(phi, w + h).value - soft.torque(phi, w - h).value) / (2.0 * h);
            assert!((soft.torque(phi, w).slope - difference).abs() < 1e-8, "{phi}, {w}");
        }
    }

    #[test]
    fn negative_parameters_and_a_transition_without_play_are_refused() {
        assert_eq!(RotationalSpringDamper { k: -1.0, ..SHAFT }.check().unwrap_err().param, "k");
        assert_eq!(RotationalSpringDamper { backlash: -0.1, ..SHAFT }.check().unwrap_err().param, "backlash");
        let error = RotationalSpringDamper { transition: 0.1, ..SHAFT }.check().unwrap_err();
        assert_eq!(error.param, "transition");
        assert!(error.help.is_some());
        assert_eq!(LOOSE.check(), Ok(()));
    }
}
