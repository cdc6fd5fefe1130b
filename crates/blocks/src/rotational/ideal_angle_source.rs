use std::f64::consts::TAU;

use blocksim_block::physical::Element;
use blocksim_block::prelude::*;

/// Turns `r` against `c` to an angle, whatever torque that takes.
///
/// Parts with inertia need the speed and its derivative as well, so the angle follows the input through a filter of
/// second order with critical damping:
///
/// $$ \ddot\varphi = \omega^2 (\mathtt{phi} - \varphi) - 2\omega\dot\varphi, \qquad \omega = 2\pi f $$
///
/// It lags a steady motion by $2/\omega$. Where speed and acceleration are known, an `IdealSpeedSource` with its input
/// `dw` follows without a lag.
///
/// ```ron
/// IdealAngleSource(f: "50 Hz")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = MotionSource("φ"))]
pub struct IdealAngleSource {
    /// Corner frequency of the filter.
    #[block(unit = "Hz", positive, default = 50.0)]
    pub f: f64,
    /// Angle at the start.
    #[block(unit = "rad", finite, default = 0.0)]
    pub phi0: f64,
}

impl IdealAngleSource {
    fn acceleration(&self, c: &Known) -> f64 {
        let omega = TAU * self.f;
        omega * (omega * (c.scalar(0) - c.x[0]) - 2.0 * c.x[1])
    }
}

impl Component for IdealAngleSource {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .rod_and_case()
            .input(Input::real("phi").scalar().unit("rad").doc("angle of r against c"))
            .measures("actual", "rad", Needs::State, "angle behind the filter")
            .measures("tau", "N*m", Needs::Motion, "torque that the source applies to r")
            .drifting_state("phi", self.phi0)
            .state("w", 0.0)
            .element(Element::SpeedSource { r: 0, c: 1 })
    }

    fn speeds(&self, c: &Known, w: &mut [f64], dw: &mut [f64]) {
        w[0] = c.x[1];
        dw[0] = self.acceleration(c);
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = c.x[1];
        dx[1] = self.acceleration(c);
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y[0] = c.x[0];
    }

    fn measure_motion(&self, c: &Loaded, y: &mut [f64]) {
        y[1] = -c.torque[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn a_resting_source_that_is_asked_to_move_accelerates_by_the_square_of_its_frequency() {
        let source = IdealAngleSource { f: 1.0, phi0: 0.0 };
        let (mut w, mut dw) = ([9.0], [9.0]);
        source.speeds(&Seen { u: &[0.5], x: &[0.0, 0.0], ..law() }.loaded(), &mut w, &mut dw);
        assert_eq!((w[0], dw[0]), (0.0, 0.5 * TAU * TAU));
        assert_eq!(IdealAngleSource { f: 0.0, ..source }.errors()[0].param, "f");
    }
}
