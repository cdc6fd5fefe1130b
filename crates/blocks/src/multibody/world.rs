use blocksim_block::physical::{Domain, Element};
use blocksim_block::prelude::*;

/// The inertial frame of a mechanism, and gravity.
///
/// ```ron
/// World(gravity: [0.0, 0.0, -9.80665])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody", symbol = World)]
pub struct World {
    /// Gravitational acceleration in the axes of the world; standard gravity along -z unless given.
    #[block(unit = "m/s^2", finite, default = [0.0, 0.0, -9.80665])]
    pub gravity: [f64; 3],
}

impl Component for World {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("frame", Domain::Frame, "the inertial frame")
            .element(Element::World { frame: 0, gravity: self.gravity })
    }
}
