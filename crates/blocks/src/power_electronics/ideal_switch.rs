use blocksim_block::physical::{Pin, ValveKind};
use blocksim_block::prelude::*;

use super::valve::Valve;

/// Contact that a signal closes: $v = r_{on} i$ while `gate` is true, $i = g_{off} v$ while it is not.
///
/// It conducts in both directions, and changes at once. Without off-state conductance the branch is cut: the current
/// of an inductance or of a current source must then have another path, a freewheeling diode or a resistance in parallel.
///
/// ```ron
/// IdealSwitch(r_on: "5 mOhm")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Power electronics", symbol = Contact)]
pub struct IdealSwitch {
    /// Resistance while closed; zero is an ideal contact.
    #[block(unit = "Ohm", not_negative, default = 0.01)]
    pub r_on: f64,
    /// Conductance while open; zero cuts the branch.
    #[block(unit = "S", not_negative, default = 0.0)]
    pub g_off: f64,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

impl IdealSwitch {
    fn valve(&self) -> Valve {
        Valve { r_on: self.r_on, v_f: 0.0, g_off: self.g_off, heat_port: self.heat_port }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        self.valve().validate(errors);
    }
}

impl Component for IdealSwitch {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .pins()
            .input(Input::boolean("gate").scalar().doc("whether the contact is closed"))
            .element(self.valve().element(Pin::Port(0), Pin::Port(1), ValveKind::Switch))
            .measures("i", "A", Needs::Electrics, "current from p to n")
            .heat_port(self.heat_port)
    }

    fn gates(&self, c: &Known, on: &mut [bool]) {
        on[0] = c.scalar(0) != 0.0;
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        y[0] = c.current[0];
    }
}
