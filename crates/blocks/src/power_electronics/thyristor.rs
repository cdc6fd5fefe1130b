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
    /// Forward voltage.
    #[block(unit = "V", default = 0.8)]
    pub v_f: f64,
    /// Resistance while it conducts.
    #[block(unit = "Ohm", default = 0.01)]
    pub r_on: f64,
    /// Conductance while it blocks.
    #[block(unit = "S", default = 0.0)]
    pub g_off: f64,
}

impl Thyristor {
    fn valve(&self) -> Valve {
        Valve { r_on: self.r_on, v_f: self.v_f, g_off: self.g_off }
    }
}

impl Block for Thyristor {
    fn check(&self) -> Result<(), ParamError> {
        self.valve().check()
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for Thyristor {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .pins()
            .input(Input::boolean("gate").scalar().doc("whether it may begin to conduct"))
            .element(self.valve().element(Pin::Port(0), Pin::Port(1), ValveKind::Thyristor))
            .measures("i", "A", Needs::Electrics, "current from p to n")
            .measures("v", "V", Needs::Electrics, "voltage from p to n")
    }

    fn gates(&self, c: &Law, on: &mut [bool]) {
        on[0] = c.scalar(0) != 0.0;
    }

    fn measure(&self, c: &Law, _needs: Needs, y: &mut [f64]) {
        y.copy_from_slice(&[c.current[0], c.voltage[0]]);
    }
}
