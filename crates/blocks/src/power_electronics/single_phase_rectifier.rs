use blocksim_block::physical::{Domain, Pin, ValveKind};
use blocksim_block::prelude::*;

use super::valve::Valve;

/// Bridge of four diodes between two AC pins and a DC link.
///
/// Whatever the direction of the current through `a` and `b`, it leaves by `p` and comes back by `n`.
///
/// ```ron
/// SinglePhaseRectifier(v_f: "1 V")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Power electronics", symbol = Converter("~","="))]
pub struct SinglePhaseRectifier {
    /// Forward voltage of a diode.
    #[block(unit = "V", default = 0.6)]
    pub v_f: f64,
    /// Resistance of a diode while it conducts.
    #[block(unit = "Ohm", default = 0.01)]
    pub r_on: f64,
    /// Conductance of a diode while it blocks.
    #[block(unit = "S", default = 0.0)]
    pub g_off: f64,
}

impl SinglePhaseRectifier {
    fn valve(&self) -> Valve {
        Valve { r_on: self.r_on, v_f: self.v_f, g_off: self.g_off }
    }
}

impl Block for SinglePhaseRectifier {
    fn check(&self) -> Result<(), ParamError> {
        self.valve().check()
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for SinglePhaseRectifier {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new().pins().port("a", Domain::Electrical, "one AC pin").port(
            "b",
            Domain::Electrical,
            "the other AC pin",
        );
        let diode = |from, to| self.valve().element(from, to, ValveKind::Diode);
        [Pin::Port(2), Pin::Port(3)]
            .into_iter()
            .flat_map(|leg| [diode(leg, Pin::Port(0)), diode(Pin::Port(1), leg)])
            .fold(part, Part::element)
    }
}
