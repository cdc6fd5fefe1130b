use blocksim_block::physical::Pin;
use blocksim_block::prelude::*;

use super::valve::{Device, Valve};

/// Field-effect transistor with its body diode.
///
/// While `gate` is true it conducts between `p` (drain) and `n` (source) in both directions with $v = r_{on} i$. Else only
/// the body diode conducts, from `n` to `p`, with $v = v_f + r_{on} i$.
///
/// ```ron
/// Mosfet(r_on: "4 mOhm")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Power electronics", symbol = Transistor)]
pub struct Mosfet {
    /// Forward voltage of the body diode.
    #[block(unit = "V", default = 0.6)]
    pub v_f: f64,
    /// Resistance while it conducts, of transistor and diode.
    #[block(unit = "Ohm", default = 0.01)]
    pub r_on: f64,
    /// Conductance from `p` to `n` while neither conducts.
    #[block(unit = "S", default = 0.0)]
    pub g_off: f64,
}

impl Mosfet {
    fn valve(&self) -> Valve {
        Valve { r_on: self.r_on, v_f: self.v_f, g_off: self.g_off }
    }
}

impl Block for Mosfet {
    fn check(&self) -> Result<(), ParamError> {
        self.valve().check()
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for Mosfet {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new().pins().input(Input::boolean("gate").scalar().doc("turns the transistor on"));
        Device::Mosfet
            .elements(&self.valve(), Pin::Port(0), Pin::Port(1))
            .into_iter()
            .fold(part, Part::element)
            .measures("i", "A", Needs::Electrics, "current from p to n, that of the diode being negative")
            .measures("v", "V", Needs::Electrics, "voltage from p to n")
    }

    fn gates(&self, c: &Law, on: &mut [bool]) {
        Device::Mosfet.gates(c.input(0), on);
    }

    fn measure(&self, c: &Law, _needs: Needs, y: &mut [f64]) {
        y.copy_from_slice(&[c.current[0] - c.current[1], c.voltage[0]]);
    }
}
