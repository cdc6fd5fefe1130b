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
    /// Properties of each diode while on and off.
    #[block(group)]
    pub valve: Valve,
}

impl Component for SinglePhaseRectifier {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new().pins().port("a", Domain::Electrical, "one AC pin").port(
            "b",
            Domain::Electrical,
            "the other AC pin",
        );
        let diode = |from, to| self.valve.element(from, to, ValveKind::Diode);
        [Pin::Port(2), Pin::Port(3)]
            .into_iter()
            .flat_map(|leg| [diode(leg, Pin::Port(0)), diode(Pin::Port(1), leg)])
            .fold(part, Part::element)
            .heat_port(self.valve.heat_port)
    }
}
