//! What the law of a component sees, for tests of single components.

use blocksim_block::physical::{JointMotion, Law, Supply};

/// Everything at rest, up to four scalar inputs, nothing connected; to be completed by `Law { x: &[..],
/// ..law() }`.
pub(crate) fn law() -> Law<'static> {
    Law {
        t: 0.0,
        x: &[],
        u: &[],
        inputs: &[(0, 1), (1, 2), (2, 3), (3, 4)],
        speed: &[],
        acceleration: &[],
        torque: &[],
        mesh: &[],
        voltage: &[],
        current: &[],
        supply: Supply::default(),
        line_current: [0.0; 2],
        joint: JointMotion::default(),
    }
}
