use blocksim_block::physical::{Domain, Element};
use blocksim_block::prelude::*;

use super::mass_properties::MassProperties;

/// A body that a gripper holds or drops while the simulation runs.
///
/// While `attached` is true the body is part of whatever `frame` belongs to; otherwise it is not there. It is taken
/// and dropped at the speed of the frame, so that no speed jumps: the mass matrix changes, and with it the
/// accelerations. Where the body is while nothing holds it is not simulated.
///
/// ```ron
/// Payload(mass: "5 kg", com: ["0 m", "0 m", "0.1 m"])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody", symbol = Body)]
pub struct Payload {
    /// Its mass and how that is spread.
    #[block(group)]
    pub properties: MassProperties,
}

impl Component for Payload {
    fn part(&self, _given: &Given) -> Part {
        let MassProperties { mass, com, moi, poi } = self.properties;
        Part::new()
            .port("frame", Domain::Frame, "the frame that holds it")
            .input(Input::boolean("attached").scalar().default(1.0).doc("whether it is held"))
            .element(Element::Payload { frame: 0, mass, com, moi, poi })
    }

    fn load(&self, c: &Known) -> f64 {
        if c.scalar(0) != 0.0 { 1.0 } else { 0.0 }
    }
}
