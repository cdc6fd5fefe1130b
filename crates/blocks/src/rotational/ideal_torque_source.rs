use blocksim_block::prelude::*;

use crate::mechanics::quantities::{ROTATION, undamped};

/// Applies a given torque between two turning parts, whatever their speed: positive `tau` drives `r` against
/// `c`.
///
/// ```ron
/// IdealTorqueSource
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = Torque)]
pub struct IdealTorqueSource;

impl Component for IdealTorqueSource {
    fn part(&self, _given: &Given) -> Part {
        ROTATION.effort_source()
    }

    fn torques(&self, c: &Flowing, tau: &mut [Torque]) {
        tau[0] = undamped(-c.scalar(0));
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::supplied(c.scalar(0) * c.speed[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn a_source_absorbs_the_negative_of_what_it_applies() {
        let mut tau = [Torque::default()];
        IdealTorqueSource.torques(&Seen { u: &[2.5], ..law() }.loaded(), &mut tau);
        assert_eq!(tau[0].value, -2.5);
    }
}
