//! Mass, centre of mass and inertia of a rigid body: what bodies and payloads have in common.

use blocksim_block::prelude::*;

/// Mass properties of a rigid body in a frame.
#[derive(Debug, Clone, Copy, PartialEq, Parameters)]
pub struct MassProperties {
    /// Mass.
    #[block(unit = "kg", not_negative)]
    pub mass: f64,
    /// Centre of mass in the frame: x, y, z.
    #[block(unit = "m", finite, default = [0.0, 0.0, 0.0])]
    pub com: [f64; 3],
    /// Moments of inertia Ixx, Iyy, Izz about the centre of mass.
    #[block(unit = "kg*m^2", not_negative, default = [0.0, 0.0, 0.0])]
    pub moi: [f64; 3],
    /// Products of inertia Iyz, Izx, Ixy about the centre of mass.
    #[block(unit = "kg*m^2", finite, default = [0.0, 0.0, 0.0])]
    pub poi: [f64; 3],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn negative_masses_and_moments_of_inertia_are_refused() {
        let properties = MassProperties { mass: 1.0, com: [0.0; 3], moi: [0.1; 3], poi: [0.0; 3] };
        assert_eq!(properties.errors()[..], []);
        assert_eq!(MassProperties { mass: -1.0, ..properties }.errors()[0].param, "mass");
        assert_eq!(MassProperties { moi: [0.1, -0.1, 0.1], ..properties }.errors()[0].param, "moi[1]");
    }
}
