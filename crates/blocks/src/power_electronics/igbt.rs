use blocksim_block::physical::Pin;
use blocksim_block::prelude::*;

use super::valve::{Device, Valve};

/// Transistor with an insulated gate and a diode in parallel.
///
/// While `gate` is true the transistor conducts from `p` (collector) to `n` (emitter) with $v = v_f + r_{on} i$; it does
/// not conduct backwards. The diode conducts from `n` to `p` by the same law, whatever the gate does. Turned off, the
/// transistor opens at once.
///
/// ```ron
/// Igbt(v_f: "1.5 V", r_on: "20 mOhm")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Power electronics", symbol = Transistor)]
pub struct Igbt {
    /// Properties while on and off.
    #[block(group(v_f = 0.8))]
    pub valve: Valve,
}

impl Component for Igbt {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new().pins().input(Input::boolean("gate").scalar().doc("turns the transistor on"));
        Device::Igbt
            .elements(&self.valve, Pin::Port(0), Pin::Port(1))
            .into_iter()
            .fold(part, Part::element)
            .measures("i", "A", Needs::Electrics, "current from p to n, that of the diode being negative")
            .measures("v", "V", Needs::Electrics, "voltage from p to n")
            .heat_port(self.valve.heat_port)
    }

    fn gates(&self, c: &Known, on: &mut [bool]) {
        Device::Igbt.gates(c.input(0), on);
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        y.copy_from_slice(&[c.current[0] - c.current[1], c.voltage[0]]);
    }
}
