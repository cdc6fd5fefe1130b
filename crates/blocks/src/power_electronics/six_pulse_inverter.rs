use blocksim_block::physical::{Domain, Pin};
use blocksim_block::prelude::*;

use super::valve::{Device, Valve};

/// Bridge of six switches between a DC link and three phases.
///
/// Each leg has an upper switch from `p` to its phase and a lower one from its phase to `n`. `gates` are those of a+, a-,
/// b+, b-, c+, c-, as `PwmGenerator` makes them. Every edge is an event of the solver, and so is every current that
/// passes through zero: a second of an inverter at 8 kHz is some ten thousand events. `AveragedInverter` does without.
///
/// With both switches of a leg on the link is short-circuited through twice `r_on`. With `Contact` and a dead time the
/// currents of a machine would have no path.
///
/// ```ron
/// SixPulseInverter(device: Igbt, v_f: "1.2 V", r_on: "20 mOhm")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Power electronics", symbol = Converter("=","~"))]
pub struct SixPulseInverter {
    /// `Igbt` or `Mosfet`, both with diodes in parallel, or `Contact`.
    #[block(default = Device::Igbt)]
    pub device: Device,
    /// Properties of each switch while on and off.
    #[block(group(v_f = 0.8))]
    pub valve: Valve,
}

impl Component for SixPulseInverter {
    fn part(&self, _given: &Given) -> Part {
        let gates = Input::boolean("gates").shape(Shape::Vector(6)).doc("a+, a-, b+, b-, c+, c-");
        let part =
            Part::new().pins().port("ac", Domain::ThreePhase, "middle of the legs: a, b, c").input(gates);
        (0..3)
            .flat_map(|k| {
                let (middle, valve) = (Pin::Phase(2, k), self.valve);
                let upper = self.device.elements(&valve, Pin::Port(0), middle);
                upper.into_iter().chain(self.device.elements(&valve, middle, Pin::Port(1)))
            })
            .fold(part, Part::element)
            .heat_port(self.valve.heat_port)
    }

    fn gates(&self, c: &Known, on: &mut [bool]) {
        self.device.gates(c.input(0), on);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn gates_reach_their_transistors_and_no_diode() {
        let inverter = SixPulseInverter {
            device: Device::Igbt,
            valve: Valve { v_f: 0.8, r_on: 0.01, g_off: 0.0, heat_port: false },
        };
        let mut on = [false; 12];
        let u = [1.0, 0.0, 0.0, 1.0, 1.0, 0.0];
        inverter.gates(&Seen { u: &u, inputs: &[(0, 6)], ..law() }.loaded(), &mut on);
        let found: Vec<usize> = (0..12).filter(|k| on[*k]).collect();
        assert_eq!(found, [0, 6, 8]);
        assert_eq!(inverter.part(&Given::default()).elements.len(), 12);
    }
}
