use blocksim_block::physical::{Domain, Element, Wrench};
use blocksim_block::prelude::*;

use super::axis::vector_input;
use super::vector::{dot, to_world};

/// The axes in which a force is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum Axes {
    /// Those of the world.
    #[default]
    World,
    /// Those of the frame that it acts on: the force turns with the body.
    Frame,
}

/// A force and a torque from outside on a body, at the origin of a frame.
///
/// Both inputs may stay open and are then zero.
///
/// ```ron
/// ExternalForce(axes: Frame)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody", symbol = Force)]
pub struct ExternalForce {
    /// `World` or `Frame`: the axes in which the inputs are written.
    #[block(default = Axes::World)]
    pub axes: Axes,
}

impl Component for ExternalForce {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("frame", Domain::Frame, "the frame that it acts on")
            .input(vector_input("force", 3, "N", "force at the origin of the frame"))
            .input(vector_input("torque", 3, "N*m", "torque on the body"))
            .element(Element::FrameForce { frame: 0 })
    }

    fn wrenches(&self, c: &Moving, f: &mut [Wrench]) {
        let three = |port: usize| [0, 1, 2].map(|k| c.input(port)[k]);
        let (force, torque) = (three(0), three(1));
        f[0] = match self.axes {
            Axes::World => Wrench { force, torque },
            Axes::Frame => {
                Wrench { force: to_world(&c.frames[0], force), torque: to_world(&c.frames[0], torque) }
            }
        };
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let mut f = [Wrench::default()];
        self.wrenches(c, &mut f);
        let frame = &c.frames[0];
        Energy::supplied(dot(f[0].force, frame.velocity) + dot(f[0].torque, frame.angular))
    }
}
