use blocksim_block::physical::{Pin, ValveKind};
use blocksim_block::prelude::*;

use super::valve::Valve;

/// Thyristor: begins to conduct from `p` to `n` when `gate` is true while its voltage exceeds $v_f$, and goes on with
/// $v = v_f + r_{on} i$ until its current ends, whatever the gate does.
///
/// The solver stops at both instants. It needs no time to recover: a voltage may be applied at once.
///
/// ```ron
/// Thyristor(v_f: "1.2 V")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Power electronics", symbol = Thyristor)]
pub struct Thyristor {
    /// Properties while on and off.
    #[block(group(v_f = 0.8))]
    pub valve: Valve,
}

impl Component for Thyristor {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .pins()
            .input(Input::boolean("gate").scalar().doc("whether it may begin to conduct"))
            .element(self.valve.element(Pin::Port(0), Pin::Port(1), ValveKind::Thyristor))
            .measures("i", "A", Needs::Electrics, "current from p to n")
            .measures("v", "V", Needs::Electrics, "voltage from p to n")
            .heat_port(self.valve.heat_port)
    }

    fn gates(&self, c: &Known, on: &mut [bool]) {
        on[0] = c.scalar(0) != 0.0;
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        y.copy_from_slice(&[c.current[0], c.voltage[0]]);
    }
}
