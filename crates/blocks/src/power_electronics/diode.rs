use blocksim_block::physical::{Pin, ValveKind};
use blocksim_block::prelude::*;

use super::valve::Valve;

/// Diode: conducts from `p` (anode) to `n` (cathode) with $v = v_f + r_{on} i$ while its current is positive, and blocks
/// with $i = g_{off} v$ until its voltage exceeds $v_f$.
///
/// The solver stops at both instants. There is no recovery: the current ends at zero.
///
/// ```ron
/// Diode(v_f: "0.7 V")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Power electronics", symbol = Diode)]
pub struct Diode {
    /// Forward voltage.
    #[block(unit = "V", default = 0.6)]
    pub v_f: f64,
    /// Resistance while it conducts.
    #[block(unit = "Ohm", default = 0.01)]
    pub r_on: f64,
    /// Conductance while it blocks.
    #[block(unit = "S", default = 0.0)]
    pub g_off: f64,
}

impl Diode {
    fn valve(&self) -> Valve {
        Valve { r_on: self.r_on, v_f: self.v_f, g_off: self.g_off }
    }
}

impl Block for Diode {
    fn check(&self) -> Result<(), ParamError> {
        self.valve().check()
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for Diode {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .pins()
            .element(self.valve().element(Pin::Port(0), Pin::Port(1), ValveKind::Diode))
            .measures("i", "A", Needs::Electrics, "current from p to n")
            .measures("v", "V", Needs::Electrics, "voltage from p to n")
    }

    fn measure(&self, c: &Law, _needs: Needs, y: &mut [f64]) {
        y.copy_from_slice(&[c.current[0], c.voltage[0]]);
    }
}
