use std::f64::consts::TAU;

use blocksim_block::physical::{Domain, Element, Pin, Supply};
use blocksim_block::prelude::*;

use crate::drives::modulation::Modulation;
use crate::machines::space_vector::turned;
use crate::three_phase::three_phase_source::delivered;

/// Three-phase inverter without its switching: the mean of the phase voltages over a switching period.
///
/// $$ \dot\theta = 2\pi f, \qquad v_a = \hat v \cos\theta, \qquad |\hat v| = \min(|v|, v_{max}) $$
///
/// The angle is an integral of the frequency, so the voltages have no jump when the frequency changes. The DC
/// link limits the amplitude: $v_{max} = V_{dc}/2$ for sine modulation, $V_{dc}/\sqrt3$ for space-vector
/// modulation and the discontinuous laws of `PwmGenerator`; `limited` reports it. A negative amplitude turns the
/// voltages by half a turn. With `reverse` the phases b and c are exchanged: angle
/// and frequency are mirrored. A negative frequency turns the field the other way as well, and does it without a
/// jump of the voltages.
///
/// Power balances: what the machines draw is taken from the DC link.
///
/// ```ron
/// AveragedInverter(vdc: "560 V", modulation: SpaceVector)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Power electronics", symbol = Converter("=","~"))]
pub struct AveragedInverter {
    /// Voltage of the DC link.
    #[block(unit = "V", not_negative)]
    pub vdc: f64,
    /// `Sine` or `SpaceVector`, or any other law of `PwmGenerator`.
    #[block(default = Modulation::Sine)]
    pub modulation: Modulation,
}

const V: usize = 0;
const F: usize = 1;
const REVERSE: usize = 2;

const THETA: usize = 0;
/// Angle of the frame in which machines hold their fluxes: it turns with the voltage, but does not jump when
/// the phases are exchanged.
const FRAME: usize = 1;

impl AveragedInverter {
    /// Largest peak phase voltage, V.
    pub fn limit(&self) -> f64 {
        self.modulation.limit(self.vdc)
    }
}

/// -1 when the phases b and c are exchanged.
fn sequence(c: &Known) -> f64 {
    if c.scalar(REVERSE) == 0.0 { 1.0 } else { -1.0 }
}

impl Component for AveragedInverter {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("ac", Domain::ThreePhase, "phases a, b, c")
            .input(Input::real("v").scalar().unit("V").doc("amplitude: peak phase voltage"))
            .input(Input::real("f").scalar().unit("Hz").doc("frequency; may be negative"))
            .input(Input::boolean("reverse").scalar().default(0.0).doc("exchanges the phases b and c"))
            .measures("theta", "rad", Needs::State, "angle of phase a")
            .measures("amplitude", "V", Needs::Electrics, "peak phase voltage after the limit")
            .measures("power", "W", Needs::Electrics, "power taken from the DC link")
            .output(Output::boolean("limited").doc("the DC link limits the amplitude"), Needs::Electrics)
            .drifting_state("theta", 0.0)
            .drifting_state("frame", 0.0)
            .element(Element::Supply { ac: 0, n: Pin::Ground })
    }

    fn supply(&self, c: &Known) -> Supply {
        let sequence = sequence(c);
        Supply {
            voltage: turned(
                [c.scalar(V).clamp(-self.limit(), self.limit()), 0.0],
                sequence * c.x[THETA] - c.x[FRAME],
            ),
            zero: 0.0,
            frequency: sequence * c.scalar(F),
            angle: c.x[FRAME],
            ..Supply::NONE
        }
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[THETA] = TAU * c.scalar(F);
        dx[FRAME] = sequence(c) * TAU * c.scalar(F);
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y[0] = c.x[THETA];
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        y[1] = c.supply.amplitude();
        y[2] = delivered(c.supply, *c.line_current);
        y[3] = f64::from(c.scalar(V).abs() > self.limit());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn the_dc_link_limits_the_amplitude() {
        let sine = AveragedInverter { vdc: 400.0, modulation: Modulation::Sine };
        let vectors = AveragedInverter { vdc: 400.0, modulation: Modulation::SpaceVector };
        let amplitude = |inverter: &AveragedInverter, v: f64| {
            inverter.supply(&Seen { x: &[0.0, 0.0], u: &[v, 50.0, 0.0], ..law() }.loaded()).amplitude()
        };
        assert_eq!(amplitude(&sine, 150.0), 150.0);
        assert_eq!(amplitude(&sine, 250.0), 200.0);
        assert!((amplitude(&vectors, 250.0) - 230.940_107_676).abs() < 1e-8);
        assert_eq!(amplitude(&sine, -1.0), 1.0);
        assert_eq!(amplitude(&sine, -250.0), 200.0);
    }

    #[test]
    fn links_just_high_enough_reach_the_voltage_of_a_machine() {
        // RMS line voltage, least DC link for sine and for space-vector modulation.
        for (line, sine, vectors) in [(200.0, 326.6, 282.8), (220.0, 359.3, 311.1), (400.0, 653.2, 565.7)] {
            let peak = line * (2.0_f64 / 3.0).sqrt();
            for (vdc, modulation) in [(sine, Modulation::Sine), (vectors, Modulation::SpaceVector)] {
                let limit = AveragedInverter { vdc, modulation }.limit();
                assert!((limit / peak - 1.0).abs() < 2e-4, "{line} V, {modulation:?}: {limit} != {peak}");
            }
        }
    }

    #[test]
    fn exchanged_phases_mirror_the_voltage_in_a_frame_that_does_not_jump() {
        let inverter = AveragedInverter { vdc: 400.0, modulation: Modulation::Sine };
        let x = [0.7, 0.7];
        let forward = inverter.supply(&Seen { x: &x, u: &[100.0, 50.0, 0.0], ..law() }.loaded());
        let reverse = inverter.supply(&Seen { x: &x, u: &[100.0, 50.0, 1.0], ..law() }.loaded());
        assert_eq!((forward.angle, forward.voltage[1], forward.frequency), (0.7, 0.0, 50.0));
        assert_eq!((reverse.angle, reverse.frequency), (0.7, -50.0));
        assert!((reverse.voltage[1].atan2(reverse.voltage[0]) + 1.4).abs() < 1e-15);
    }
}
