use blocksim_block::prelude::*;

use crate::mechanics::quantities::TRANSLATION;

/// A mass that slides: $F = m \dot v$, against an implied ground.
///
/// Masses that are coupled rigidly are one state. Behind a rack and a pinion of radius $r$ a mass counts as the moment
/// of inertia $m r^2$, behind a screw of the lead $l$ as $m (l / 2\pi)^2$. Its weight is a `ConstantForce` where the
/// way is not level.
///
/// ```ron
/// Mass(m: "12 kg")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Translational", symbol = Mass)]
pub struct Mass {
    /// Mass; zero is allowed where something else gives the part its mass.
    #[block(unit = "kg", not_negative)]
    pub m: f64,
    /// Velocity at the start. Where none is given it is that of the parts it is coupled to, else zero.
    #[block(unit = "m/s", finite, default = None)]
    pub v0: Option<f64>,
}

impl Component for Mass {
    fn part(&self, _given: &Given) -> Part {
        TRANSLATION.inertia("the sliding part", self.m, self.v0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_negative_mass_is_refused() {
        assert_eq!(Mass { m: -1.0, v0: None }.errors()[0].param, "m");
        assert_eq!(Mass { m: 0.0, v0: None }.errors()[..], []);
    }
}
