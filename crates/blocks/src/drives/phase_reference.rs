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
    #[block(unit = "rad", default = 0.0)]
    pub theta0: f64,
}

const V: usize = 0;
const F: usize = 1;

/// Groups of outputs: the voltages, and the angle, which does not depend on the amplitude.
const ABC: usize = 0;

impl Block for PhaseReference {
    fn check(&self) -> Result<(), ParamError> {
        finite("theta0", self.theta0)
    }

    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let abc = Output::like("abc", PortType::vector(3)).unit("V").doc("phase voltages a, b, c");
        Ok(Interface::new()
            .input(Input::real("v").scalar().unit("V").doc("amplitude: peak phase voltage"))
            .input(Input::real("f").scalar().unit("Hz").doc("frequency; may be negative"))
            .output_reading(&[V], abc)
            .output_from_state(Output::real("theta").unit("rad").doc("angle of phase a"))
            .drifting_state("theta", self.theta0)
            .turning_state(0))
    }

    fn outputs(&self, group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        let theta = c.x[0];
        if group == ABC {
            let (sin, cos) = theta.sin_cos();
            let v = c.scalar(V);
            y[c.output(0)].copy_from_slice(&transforms::inverse_clarke([v * cos, v * sin], 0.0));
        } else {
            y[c.output(1)][0] = theta;
        }
    }

    fn derivatives(&self, c: &Context, _w: &mut Scratch, dx: &mut [f64]) {
        dx[0] = TAU * c.scalar(F);
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
        let interface = PhaseReference { theta0: 0.0 }.interface(&Given::nothing()).unwrap();
        assert!(interface.reads(ABC, V) && !interface.reads(ABC, F));
        assert!(!interface.reads(1, V) && !interface.reads(1, F));
        assert_eq!(PhaseReference { theta0: f64::NAN }.check().unwrap_err().param, "theta0");
    }
}
