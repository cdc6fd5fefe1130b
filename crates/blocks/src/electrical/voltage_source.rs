use blocksim_block::physical::{Element, Pin};
use blocksim_block::prelude::*;

/// Ideal source of a constant voltage: $v_p - v_n = V$, whatever current that takes.
///
/// ```ron
/// VoltageSource(v: "48 V")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = VoltageSource)]
pub struct VoltageSource {
    /// Voltage.
    #[block(unit = "V", finite)]
    pub v: f64,
}

impl Component for VoltageSource {
    fn part(&self, _given: &Given) -> Part {
        Part::new().pins().holds().element(Element::VoltageSource { p: Pin::Port(0), n: Pin::Port(1) })
    }

    fn voltages(&self, _c: &Moving, v: &mut [f64]) {
        v[0] = self.v;
    }
}
