use blocksim_block::physical::{Domain, Element};
use blocksim_block::prelude::*;

/// A body that a gripper holds or drops while the simulation runs.
///
/// While `attached` is true the body is part of whatever `frame` belongs to; otherwise it is not there. It is taken
/// and dropped at the speed of the frame, so that no speed jumps: the mass matrix changes, and with it the
/// accelerations. Where the body is while nobody holds it is not simulated.
///
/// ```ron
/// Payload(mass: "5 kg", com: ["0 m", "0 m", "0.1 m"])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody", symbol = Body)]
pub struct Payload {
    /// Mass.
    #[block(unit = "kg")]
    pub mass: f64,
    /// Centre of mass in the frame: x, y, z.
    #[block(unit = "m", default = [0.0, 0.0, 0.0])]
    pub com: [f64; 3],
    /// Moments of inertia Ixx, Iyy, Izz about the centre of mass.
    #[block(unit = "kg*m^2", default = [0.0, 0.0, 0.0])]
    pub moi: [f64; 3],
    /// Products of inertia Iyz, Izx, Ixy about the centre of mass.
    #[block(unit = "kg*m^2", default = [0.0, 0.0, 0.0])]
    pub poi: [f64; 3],
}

impl Block for Payload {
    fn check(&self) -> Result<(), ParamError> {
        not_negative("mass", self.mass)?;
        self.com.iter().try_for_each(|x| finite("com", *x))?;
        self.moi.iter().try_for_each(|i| not_negative("moi", *i))?;
        self.poi.iter().try_for_each(|i| finite("poi", *i))
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for Payload {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("frame", Domain::Frame, "the frame that holds it")
            .input(Input::boolean("attached").scalar().default(1.0).doc("whether it is held"))
            .element(Element::Payload {
                frame: 0,
                mass: self.mass,
                com: self.com,
                moi: self.moi,
                poi: self.poi,
            })
    }

    fn load(&self, c: &Law) -> f64 {
        if c.scalar(0) != 0.0 { 1.0 } else { 0.0 }
    }
}
