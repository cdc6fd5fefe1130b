use blocksim_block::prelude::*;

use super::axis::Inside;
use super::joint_limit::JointLimit;
use super::one_axis_joint::{OneAxisJoint, TURNS};

/// A joint that turns `follower` about an axis of `base`; both origins coincide.
///
/// $$ \tau = \tau_{in} + \tau_{rc} - k (q - q_0) - d \dot q + \tau_{lim}, \qquad w_r - w_c = \dot q $$
///
/// Three torques may act on it: the input `torque`; whatever is connected to the drive side `r`, `c` (a gear,
/// a motor, friction; its inertia counts in the mass matrix of the mechanism, so nothing is filtered); and
/// the spring and damper inside.
///
/// Beyond a limit a spring and a damper set in smoothly over the transition width $b$ and push back, never
/// pull:
///
/// $$ \tau_{lim} = s\,(k_l\,\delta + d_l\,\dot\delta), \qquad s = 3 x^2 - 2 x^3,
///    \quad x = \min(\delta / b, 1) $$
///
/// with the penetration $\delta \ge 0$. The output `tau` is the torque of the actuators: the input and the
/// drive side, without spring, damper and limits.
///
/// ```ron
/// RevoluteJoint(axis: [0.0, 1.0, 0.0], position: "30 deg", lower: "-95 deg", upper: "155 deg")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody", symbol = Hinge, builds = OneAxisJoint)]
pub struct RevoluteJoint {
    /// Direction of the axis in `base`; its length does not matter.
    #[block(direction, default = [0.0, 0.0, 1.0])]
    pub axis: [f64; 3],
    /// Angle at the start. Where none is given it is zero, or in a closed loop what closes it.
    #[block(unit = "rad", finite, default = None)]
    pub position: Option<f64>,
    /// Speed at the start. Where none is given it is zero, or in a closed loop what fits the others.
    #[block(unit = "rad/s", finite, default = None)]
    pub velocity: Option<f64>,
    /// Angle $q_0$ at which the spring inside is relaxed.
    #[block(unit = "rad", finite, default = 0.0)]
    pub equilibrium: f64,
    /// Stiffness $k$ of the spring inside.
    #[block(unit = "N*m/rad", not_negative, default = 0.0)]
    pub stiffness: f64,
    /// Coefficient $d$ of the damper inside.
    #[block(unit = "N*m*s/rad", not_negative, default = 0.0)]
    pub damping: f64,
    /// Least angle; none unless given.
    #[block(unit = "rad", finite, default = None)]
    pub lower: Option<f64>,
    /// Largest angle; none unless given.
    #[block(unit = "rad", finite, above = lower, default = None)]
    pub upper: Option<f64>,
    /// Stiffness $k_l$ beyond a limit.
    #[block(unit = "N*m/rad", not_negative, default = 5.73e5)]
    pub limit_stiffness: f64,
    /// Damping $d_l$ beyond a limit.
    #[block(unit = "N*m*s/rad", not_negative, default = 573.0)]
    pub limit_damping: f64,
    /// Width $b$ over which a limit sets in.
    #[block(unit = "rad", not_negative, default = 1.745e-3)]
    pub limit_transition: f64,
}

impl RevoluteJoint {
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
        self.inside().validate(self.position, TURNS.unit(), errors);
    }

    fn build(self, _errors: &mut ParamErrors) -> Option<OneAxisJoint> {
        let Self { axis, position, velocity, .. } = self;
        Some(OneAxisJoint { words: &TURNS, axis, position, velocity, inside: self.inside() })
    }
}

#[cfg(test)]
mod tests {
    use blocksim_block::physical::{Element, Freedom};

    use super::*;

    const JOINT: RevoluteJoint = RevoluteJoint {
        axis: [0.0, 0.0, 2.0],
        position: None,
        velocity: None,
        equilibrium: 0.5,
        stiffness: 4.0,
        damping: 0.25,
        lower: Some(-1.0),
        upper: Some(2.0),
        limit_stiffness: 100.0,
        limit_damping: 10.0,
        limit_transition: 0.01,
    };

    #[test]
    fn the_axis_is_normalised() {
        let part = JOINT.built().part(&Given::nothing());
        let Element::Joint { freedoms, .. } = &part.elements[0] else { panic!("no joint") };
        assert!(matches!(&freedoms[..], [Freedom::Turn(axis)] if axis.direction == [0.0, 0.0, 1.0]));
    }

    #[test]
    fn spring_and_damper_pull_towards_the_equilibrium() {
        assert_eq!(JOINT.inside().torque(1.5, 2.0, &[]), Torque { value: -4.5, slope: 0.25 });
    }

    #[test]
    fn limits_push_back_into_the_free_range() {
        let joint = RevoluteJoint { stiffness: 0.0, damping: 0.0, ..JOINT };
        assert!((joint.inside().torque(2.1, 0.0, &[]).value + 10.0).abs() < 1e-12);
        assert!((joint.inside().torque(-1.1, 0.0, &[]).value - 10.0).abs() < 1e-12);
        assert!(
            (joint.inside().torque(-1.1, -0.5, &[]).value - 15.0).abs() < 1e-12,
            "moving further in adds damping"
        );
        assert_eq!(joint.inside().torque(2.1, -2.0, &[]).value, 0.0, "moving out fast must not be held back");
        assert_eq!(joint.inside().torque(0.0, 100.0, &[]).value, 0.0);
    }

    #[test]
    fn a_start_outside_the_limits_is_refused() {
        let error = RevoluteJoint { position: Some(2.5), ..JOINT }.errors()[0].clone();
        assert_eq!(error.param, "position");
        assert!(error.message.contains("above its upper limit of 2 rad"), "{}", error.message);
        assert_eq!(RevoluteJoint { position: Some(-1.5), ..JOINT }.errors()[0].param, "position");
        assert_eq!(JOINT.errors()[..], []);
    }

    #[test]
    fn limits_out_of_order_and_an_axis_without_length_are_refused() {
        assert_eq!(RevoluteJoint { upper: Some(-2.0), ..JOINT }.errors()[0].param, "upper");
        assert_eq!(RevoluteJoint { axis: [0.0; 3], ..JOINT }.errors()[0].param, "axis");
    }
}
