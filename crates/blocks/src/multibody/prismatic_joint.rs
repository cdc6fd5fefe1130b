use blocksim_block::prelude::*;

use super::axis::Inside;
use super::joint_limit::JointLimit;
use super::one_axis_joint::{OneAxisJoint, SLIDES};

/// A joint that slides `follower` along an axis of `base`; the axes of both frames stay parallel.
///
/// $$ F = F_{in} + F_{rc} - k (x - x_0) - d \dot x + F_{lim}, \qquad v_r - v_c = \dot x $$
///
/// Three forces may act on it: the input `force`; whatever is connected to the drive side `r`, `c` (a
/// cylinder, a rack, friction; its mass counts in the mass matrix of the mechanism); and the spring and damper
/// inside. Beyond a limit a spring and a damper set in smoothly over the transition width $b$ and push back,
/// never pull, as those of the `RevoluteJoint`. The output `f` is the force of the actuators: the input and the
/// drive side, without spring, damper and limits.
///
/// ```ron
/// PrismaticJoint(axis: [1.0, 0.0, 0.0], position: "0.2 m", lower: "0 m", upper: "0.8 m")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody", symbol = Slide, builds = OneAxisJoint)]
pub struct PrismaticJoint {
    /// Direction of the axis in `base`; its length does not matter.
    #[block(direction, default = [0.0, 0.0, 1.0])]
    pub axis: [f64; 3],
    /// Position at the start. Where none is given it is zero, or in a closed loop what closes it.
    #[block(unit = "m", finite, default = None)]
    pub position: Option<f64>,
    /// Speed at the start. Where none is given it is zero, or in a closed loop what fits the others.
    #[block(unit = "m/s", finite, default = None)]
    pub velocity: Option<f64>,
    /// Position $x_0$ at which the spring inside is relaxed.
    #[block(unit = "m", finite, default = 0.0)]
    pub equilibrium: f64,
    /// Stiffness $k$ of the spring inside.
    #[block(unit = "N/m", not_negative, default = 0.0)]
    pub stiffness: f64,
    /// Coefficient $d$ of the damper inside.
    #[block(unit = "N*s/m", not_negative, default = 0.0)]
    pub damping: f64,
    /// Least position; none unless given.
    #[block(unit = "m", finite, default = None)]
    pub lower: Option<f64>,
    /// Largest position; none unless given.
    #[block(unit = "m", finite, above = lower, default = None)]
    pub upper: Option<f64>,
    /// Stiffness beyond a limit.
    #[block(unit = "N/m", not_negative, default = 1e6)]
    pub limit_stiffness: f64,
    /// Damping beyond a limit.
    #[block(unit = "N*s/m", not_negative, default = 1e3)]
    pub limit_damping: f64,
    /// Width $b$ over which a limit sets in.
    #[block(unit = "m", not_negative, default = 1e-4)]
    pub limit_transition: f64,
}

impl PrismaticJoint {
    fn inside(&self) -> Inside {
        Inside {
            equilibrium: self.equilibrium,
            stiffness: self.stiffness,
            damping: self.damping,
            lower: self.lower,
            upper: self.upper,
            limit: JointLimit {
                stiffness: self.limit_stiffness,
                damping: self.limit_damping,
                transition: self.limit_transition,
            },
        }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        self.inside().validate(self.position, SLIDES.unit(), errors);
    }

    fn build(self, _errors: &mut ParamErrors) -> Option<OneAxisJoint> {
        let Self { axis, position, velocity, .. } = self;
        Some(OneAxisJoint { words: &SLIDES, axis, position, velocity, inside: self.inside() })
    }
}
