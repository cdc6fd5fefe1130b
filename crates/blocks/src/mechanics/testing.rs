//! What a component sees, for tests of single components.

use blocksim_block::physical::{
    ElementPlace, Fed, Flowing, FrameMotion, JointLoad, JointMotion, Known, Loaded, Moving, Supply,
};

/// What a component sees, all stages beside each other.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seen<'a> {
    pub t: f64,
    pub x: &'a [f64],
    pub d: &'a [f64],
    pub u: &'a [f64],
    pub inputs: &'a [(u32, u32)],
    pub speed: &'a [f64],
    pub mode: &'a [f64],
    pub joint: &'a [JointMotion],
    pub frames: &'a [FrameMotion],
    pub voltage: &'a [f64],
    pub current: &'a [f64],
    pub places: &'a [ElementPlace],
    pub supply: &'a Supply,
    pub torque: &'a [f64],
    pub mesh: &'a [f64],
    pub joint_load: &'a [JointLoad],
}

impl<'a> Seen<'a> {
    /// Time zero, everything at rest, nothing connected.
    pub(crate) const NOTHING: Self = Seen {
        t: 0.0,
        x: &[],
        d: &[],
        u: &[],
        inputs: &[],
        speed: &[],
        mode: &[],
        joint: &[],
        frames: &[],
        voltage: &[],
        current: &[],
        places: &[],
        supply: &Supply::NONE,
        torque: &[],
        mesh: &[],
        joint_load: &[],
    };

    /// The same as a component gets it in the end; earlier stages are parts of that.
    pub(crate) fn loaded(self) -> Loaded<'a> {
        let Seen { t, x, d, u, inputs, speed, mode, joint, frames, voltage, current, places, supply, .. } =
            self;
        let known = Known { t, x, d, u, inputs };
        let moving = Moving { known, speed, mode, joint, frames, ..Moving::NOTHING };
        let fed = Fed { moving, supply };
        let flowing = Flowing { fed, voltage, current, places, ..Flowing::NOTHING };
        let Seen { torque, mesh, joint_load, .. } = self;
        Loaded { flowing, torque, mesh, joint_load, ..Loaded::NOTHING }
    }
}

/// Everything at rest, up to four scalar inputs, nothing connected; to be completed by `Seen { x: &[..], ..law() }`.
pub(crate) fn law() -> Seen<'static> {
    Seen { inputs: &[(0, 1), (1, 2), (2, 3), (3, 4)], ..Seen::NOTHING }
}
