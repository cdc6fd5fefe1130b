use blocksim_block::physical::{Pin, ValveKind};
use blocksim_block::prelude::*;

use super::valve::Valve;

/// Diode: blocks with $i = g_{off} v$ until its voltage from `p` (anode) to `n` (cathode) exceeds $v_f$, and conducts with
/// $v = v_f + r_{on} (i - g_{off} v_f)$ until its current falls below $g_{off} v_f$, at which both lines meet.
///
/// The solver stops at both instants. There is no recovery: the current ends at zero.
///
/// ```ron
/// Diode(v_f: "0.7 V")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Power electronics", symbol = Diode)]
pub struct Diode {
    /// Properties while on and off.
    #[block(group)]
    pub valve: Valve,
}

impl Component for Diode {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .pins()
            .element(self.valve.element(Pin::Port(0), Pin::Port(1), ValveKind::Diode))
            .measures("i", "A", Needs::Electrics, "current from p to n")
            .measures("v", "V", Needs::Electrics, "voltage from p to n")
            .heat_port(self.valve.heat_port)
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        y.copy_from_slice(&[c.current[0], c.voltage[0]]);
    }
}
