use blocksim_block::physical::{Domain, Pin, ValveKind};
use blocksim_block::prelude::*;

use super::valve::Valve;

/// Bridge of six diodes between three phases and a DC link.
///
/// The highest phase is connected to `p`, the lowest to `n`. With an inductance behind it and ideal phases the mean is
/// $\frac{3\sqrt2}{\pi} V$ of the RMS line voltage $V$. An inductance $L$ in each phase takes $\frac{3}{\pi} \omega L I$ of
/// it: for a while two phases share the current $I$.
///
/// Source: N. Mohan, T. M. Undeland, W. P. Robbins, *Power Electronics*, chapter 5.
///
/// ```ron
/// RectifierBridge(v_f: "1 V")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Power electronics", symbol = Converter("~","="))]
pub struct RectifierBridge {
    /// Properties of each diode while on and off.
    #[block(group)]
    pub valve: Valve,
}

impl Component for RectifierBridge {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new().pins().port("ac", Domain::ThreePhase, "phases a, b, c");
        let diode = |from, to| self.valve.element(from, to, ValveKind::Diode);
        [0, 1, 2]
            .map(|k| Pin::Phase(2, k))
            .into_iter()
            .flat_map(|leg| [diode(leg, Pin::Port(0)), diode(Pin::Port(1), leg)])
            .fold(part, Part::element)
            .heat_port(self.valve.heat_port)
    }
}
