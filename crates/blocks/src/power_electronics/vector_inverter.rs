use std::f64::consts::TAU;

use blocksim_block::physical::{Domain, Element, Pin, Supply};
use blocksim_block::prelude::*;

use crate::drives::modulation::Modulation;
use crate::machines::space_vector::turned;
use crate::three_phase::three_phase_source::delivered;

/// Three-phase inverter without its switching, commanded by a voltage vector in a frame of the controller's
/// choice: for field-oriented control.
///
/// $$ v_a = \hat v \cos(\theta + \varphi), \qquad \hat v = \min\bigl(\sqrt{v_d^2 + v_q^2},\, v_{max}\bigr),
///    \qquad \varphi = \operatorname{atan2}(v_q, v_d) $$
///
/// $\theta$ is the angle of the frame against the axis of phase a, usually the output `theta` of the machine;
/// then $v_d$ and $v_q$ are the voltages that the windings see in the frame of the rotor. Amplitudes are peak
/// phase voltages. The DC link limits the length of the vector and keeps its direction: $v_{max} = V_{dc}/2$ for
/// sine modulation, $V_{dc}/\sqrt3$ for space-vector modulation. A controller with an integral part needs limits
/// and protection against windup of its own; `limited` reports when the link limits.
///
/// The input `f` changes no voltage. It is the speed of the frame in which an asynchronous machine holds its
/// fluxes and measures its slip; a machine with permanent magnets has a frame of its own. Power balances: what
/// the machines draw is taken from the DC link.
///
/// ```ron
/// VectorInverter(vdc: "560 V", modulation: SpaceVector)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Power electronics", symbol = Converter("=","~"))]
pub struct VectorInverter {
    /// Voltage of the DC link.
    #[block(
        unit = "V",
        not_negative,
        remedy = "a rectifier at 400 V gives 540 to 565 V, a battery its own voltage"
    )]
    pub vdc: f64,
    /// `Sine` or `SpaceVector`, or any other law of `PwmGenerator`.
    #[block(default = Modulation::Sine)]
    pub modulation: Modulation,
}

const V_D: usize = 0;
const V_Q: usize = 1;
const THETA: usize = 2;
const F: usize = 3;

impl VectorInverter {
    /// Largest peak phase voltage, V.
    pub fn limit(&self) -> f64 {
        self.modulation.limit(self.vdc)
    }
}

impl Component for VectorInverter {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("ac", Domain::ThreePhase, "phases a, b, c")
            .input(Input::real("v_d").scalar().unit("V").doc("voltage along the d axis, peak of a phase"))
            .input(Input::real("v_q").scalar().unit("V").doc("voltage along the q axis, peak of a phase"))
            .input(Input::real("theta").scalar().unit("rad").doc("angle of the d axis against phase a"))
            .input(Input::real("f").scalar().unit("Hz").default(0.0).doc("speed of the frame of the fluxes"))
            .measures("amplitude", "V", Needs::Electrics, "peak phase voltage after the limit")
            .measures("power", "W", Needs::Electrics, "power taken from the DC link")
            .output(Output::boolean("limited").doc("the DC link limits the amplitude"), Needs::Electrics)
            .drifting_state("frame", 0.0)
            .element(Element::Supply { ac: 0, n: Pin::Ground })
    }

    fn supply(&self, c: &Known) -> Supply {
        let (v_d, v_q, frame) = (c.scalar(V_D), c.scalar(V_Q), c.x[0]);
        // The frame is the integral of its own speed, never the angle that is put in: fluxes that a machine
        // holds in it must not jump when that angle does.
        let (length, limit) = (v_d.hypot(v_q), self.limit());
        let shorter = if length > limit { limit / length } else { 1.0 };
        Supply {
            voltage: turned([v_d * shorter, v_q * shorter], c.scalar(THETA) - frame),
            zero: 0.0,
            frequency: c.scalar(F),
            angle: frame,
            ..Supply::NONE
        }
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = TAU * c.scalar(F);
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        let limited = c.scalar(V_D).hypot(c.scalar(V_Q)) > self.limit();
        let power = delivered(c.supply, *c.line_current);
        y.copy_from_slice(&[c.supply.amplitude(), power, f64::from(limited)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    const INVERTER: VectorInverter = VectorInverter { vdc: 400.0, modulation: Modulation::SpaceVector };

    #[test]
    fn the_voltage_of_phase_a_is_that_of_the_vector_whatever_the_frame_of_the_fluxes() {
        for frame in [0.0, 0.7, -3.0] {
            let supply =
                INVERTER.supply(&Seen { x: &[frame], u: &[30.0, -40.0, 1.2, 50.0], ..law() }.loaded());
            let phase_a = supply.phases()[0];
            let expected = 30.0 * 1.2_f64.cos() + 40.0 * 1.2_f64.sin();
            assert!((phase_a - expected).abs() < 1e-12, "{phase_a} != {expected}");
            assert_eq!((supply.frequency, supply.angle), (50.0, frame));
        }
    }

    #[test]
    fn the_dc_link_shortens_the_vector_and_keeps_its_direction() {
        let supply = INVERTER.supply(&Seen { x: &[0.0], u: &[300.0, 400.0, 0.0, 0.0], ..law() }.loaded());
        assert!((supply.amplitude() - 230.940_107_676).abs() < 1e-8);
        assert!((supply.voltage[1] / supply.voltage[0] - 4.0 / 3.0).abs() < 1e-14);
        let sine = VectorInverter { modulation: Modulation::Sine, ..INVERTER };
        assert_eq!(sine.limit(), 200.0);
    }

    #[test]
    fn no_voltage_has_no_direction_and_needs_none() {
        let supply = INVERTER.supply(&Seen { x: &[0.0], u: &[0.0; 4], ..law() }.loaded());
        assert_eq!(supply.voltage, [0.0, 0.0]);
        assert_eq!(VectorInverter { vdc: -1.0, ..INVERTER }.errors()[0].param, "vdc");
    }
}
