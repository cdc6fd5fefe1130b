//! What experiments tell of the friction of an axis.

use blocksim_identify::{Curve, CurveFit, Line, Train, TwoPoint};

use super::constant_speed::Measured;
use super::pose::Pose;

/// Friction of a part by its parameters, brought to the joint, without the losses of gears: a line over the fast speeds.
pub struct TakenFriction {
    /// Path of the block.
    pub path: String,
    /// It turns with the motor.
    pub is_at_motor: bool,
    /// Viscous coefficient, N m s/rad.
    pub viscous: f64,
    /// Coulomb torque, N m.
    pub coulomb: f64,
    /// What is the same in both directions, N m.
    pub constant: f64,
}

/// What was found out about an axis.
pub struct AxisFriction {
    /// Number of the axis, from 1.
    pub number: usize,
    /// Path of the joint.
    pub joint: String,
    /// Where it was measured.
    pub pose: Pose,
    /// Each move, with what it brought.
    pub measured: Vec<Measured>,
    /// The straight part, at the motor.
    pub line: Result<Line, String>,
    /// From half and full speed.
    pub two_point: Option<(TwoPoint, f64, f64)>,
    /// The bearing alone.
    pub curve: Result<CurveFit, String>,
    /// Straight part by the parameters: viscous and Coulomb.
    pub set_line: Option<(f64, f64)>,
    /// Bearing by the parameters.
    pub set_bearing: Option<Curve>,
    /// What stands between.
    pub train: Train,
    /// Friction that was taken from the parameters.
    pub taken: Vec<TakenFriction>,
    /// What the result holds beside what it seems to hold.
    pub notes: Vec<String>,
    /// Turns of the motor for one of the joint.
    pub ratio: f64,
}
