use blocksim_block::prelude::*;

use crate::mechanics::quantities::{TRANSLATION, undamped};

/// Applies a given force between two sliding parts, whatever their velocity: positive `f` drives `r` against `c`.
///
/// ```ron
/// IdealForceSource
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Translational", symbol = Force)]
pub struct IdealForceSource;

impl Component for IdealForceSource {
    fn part(&self, _given: &Given) -> Part {
        TRANSLATION.effort_source()
    }

    fn torques(&self, c: &Flowing, f: &mut [Torque]) {
        f[0] = undamped(-c.scalar(0));
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::supplied(c.scalar(0) * c.speed[0])
    }
}
