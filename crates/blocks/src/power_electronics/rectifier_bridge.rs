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

impl RectifierBridge {
    fn valve(&self) -> Valve {
        Valve { r_on: self.r_on, v_f: self.v_f, g_off: self.g_off }
    }
}

impl Block for RectifierBridge {
    fn check(&self) -> Result<(), ParamError> {
        self.valve().check()
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for RectifierBridge {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new().pins().port("ac", Domain::ThreePhase, "phases a, b, c");
        let diode = |from, to| self.valve().element(from, to, ValveKind::Diode);
        [0, 1, 2]
            .map(|k| Pin::Phase(2, k))
            .into_iter()
            .flat_map(|leg| [diode(leg, Pin::Port(0)), diode(Pin::Port(1), leg)])
            .fold(part, Part::element)
    }
}
