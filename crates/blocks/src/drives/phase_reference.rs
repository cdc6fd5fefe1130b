use std::f64::consts::TAU;

use blocksim_block::prelude::*;

use super::transforms;

/// Three phase voltages from amplitude and frequency, for a `PwmGenerator`.
///
/// $$ \dot\theta = 2\pi f, \qquad v_a = v \cos\theta, \qquad v_b = v \cos(\theta - 2\pi/3), \qquad
///    v_c = v \cos(\theta + 2\pi/3) $$
///
/// The angle is an integral of the frequency, so the voltages have no jump when the frequency changes. A negative
/// frequency turns the field the other way. `VoltsPerHertz` gives the amplitude; its input `f` is the same frequency.
///
/// ```ron
/// PhaseReference
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Drives", symbol = Text("û, f → abc"))]
pub struct PhaseReference {
    /// Angle at the start.
    #[block(unit = "rad", finite, default = 0.0)]
    pub theta0: f64,
}

const V: usize = 0;
const F: usize = 1;

impl Block for PhaseReference {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let abc = Output::like("abc", PortType::vector(3)).unit("V").doc("phase voltages a, b, c");
        Ok(Interface::new()
            .input(Input::real("v").scalar().unit("V").doc("amplitude: peak phase voltage"))
            .input(Input::real("f").scalar().unit("Hz").doc("frequency; may be negative"))
            .output(abc)
            .output(Output::real("theta").unit("rad").doc("angle of phase a"))
            .drifting_state("theta", self.theta0)
            .turning_state(0))
    }

    fn law(&self, l: &Recording) -> bool {
        let (theta, v) = (l.x()[0], l.u(V));
        let phases = transforms::inverse_clarke([v * theta.cos(), v * theta.sin()], l.constant(0.0));
        phases.into_iter().enumerate().for_each(|(i, phase)| l.set(0, i, phase));
        l.set(1, 0, theta);
        l.derive(0, TAU * l.u(F));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn after_a_third_of_a_period_phase_b_is_at_its_peak() {
        for (f, phase) in [(50.0, 1), (-50.0, 2)] {
            let mut bench = Bench::new(PhaseReference { theta0: 0.0 });
            assert_eq!(bench.set(V, &[325.0]).set(F, &[f]).major()[0], 325.0);
            bench.integrate(0.02 / 3.0, 100);
            let y = bench.major();
            assert!((y[phase] - 325.0).abs() < 1e-9, "{y:?}");
            assert!((y[3] - f.signum() * TAU / 3.0).abs() < 1e-12);
            assert!((y[0] + y[1] + y[2]).abs() < 1e-9);
        }
    }

    #[test]
    fn a_change_of_frequency_makes_no_jump() {
        let mut bench = Bench::new(PhaseReference { theta0: 0.0 });
        bench.set(V, &[325.0]).set(F, &[50.0]).integrate(0.123, 1000);
        let before = bench.major();
        assert_eq!(bench.set(F, &[17.0]).major(), before);
    }

    #[test]
    fn the_angle_does_not_read_the_amplitude_nor_the_voltages_the_frequency() {
        let interface = Bench::new(PhaseReference { theta0: 0.0 }).interface;
        assert!(interface.reads(0, V) && !interface.reads(0, F));
        assert!(!interface.reads(1, V) && !interface.reads(1, F));
        assert_eq!(PhaseReference { theta0: f64::NAN }.errors()[0].param, "theta0");
    }
}
