use blocksim_block::physical::Pin;
use blocksim_block::prelude::*;

use super::valve::{Device, Valve};

/// Field-effect transistor with its body diode.
///
/// While `gate` is true its channel conducts between `p` (drain) and `n` (source) in both directions with $v = r_{on} i$. Its body diode
/// conducts from `n` to `p`, with a resistance $r_{on}$ of its own behind $v_f$, whether the channel does or not: beside the channel from
/// the current $v_f / r_{on}$ on.
///
/// ```ron
/// Mosfet(r_on: "4 mOhm")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Power electronics", symbol = Transistor)]
pub struct Mosfet {
    /// Properties while on and off.
    #[block(group)]
    pub valve: Valve,
}

impl Component for Mosfet {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new().pins().input(Input::boolean("gate").scalar().doc("turns the transistor on"));
        Device::Mosfet
            .elements(&self.valve, Pin::Port(0), Pin::Port(1))
            .into_iter()
            .fold(part, Part::element)
            .measures("i", "A", Needs::Electrics, "current from p to n, that of the diode being negative")
            .measures("v", "V", Needs::Electrics, "voltage from p to n")
            .heat_port(self.valve.heat_port)
    }

    fn gates(&self, c: &Known, on: &mut [bool]) {
        Device::Mosfet.gates(c.input(0), on);
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        y.copy_from_slice(&[c.current[0] - c.current[1], c.voltage[0]]);
    }
}
