use blocksim_block::physical::Element;
use blocksim_block::prelude::*;

/// Couples two turning parts rigidly and measures the torque that passes from `r` to `c`.
///
/// ```ron
/// TorqueSensor
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Mechanics")]
pub struct TorqueSensor;

impl Block for TorqueSensor {
    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for TorqueSensor {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .rod_and_case()
            .measures("tau", "N*m", Needs::Motion, "torque from r to c")
            .element(Element::Rigid { r: 0, c: 1 })
    }

    fn measure(&self, c: &Law, _needs: Needs, y: &mut [f64]) {
        y[0] = c.torque[0];
    }
}
