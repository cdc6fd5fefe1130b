//! What is asked of a move along a path.

use blocksim_multibody::Placement;
use nalgebra::{Matrix3, Vector3};

/// Where a move begins.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    /// Positions of all axes, rad or m.
    Joints(Vec<f64>),
    /// Placement of the tool in the reference; of the positions of the axes, those nearest to the start of the robot.
    Pose(Placement),
    /// Position of the tool in the reference, m; the orientation is left to the axes.
    Point(Vector3<f64>),
}

/// What the orientation of the tool does along the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Orientation {
    /// Left to the axes, which move as little as they can: the tool points at each point of the path with its tip,
    /// and its turn about this is what least motion makes of it.
    Free,
    /// As at the start.
    Fixed,
    /// Turns evenly to this orientation.
    Interpolated(Matrix3<f64>),
    /// The z axis of the tool as at the start; the turn about it is free, axes move as little as they can.
    Axis,
}

/// How the length of the path goes with time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Timing {
    /// Acceleration in bumps of sin².
    Sin2,
    /// Constant acceleration; it jumps.
    Trapezoid,
    /// The acceleration rises and falls with this jerk, m/s³.
    SCurve {
        /// Largest jerk, m/s³.
        jerk: f64,
    },
    /// As fast as speeds and accelerations of axes and tool allow; the acceleration jumps.
    TimeOptimal,
}

/// Speed and acceleration along the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speeds {
    /// Largest speed of the tool, m/s.
    pub velocity: f64,
    /// Share of the maximum acceleration of the tool, above 0 and at most 1.
    pub acceleration: f64,
    /// Profile.
    pub timing: Timing,
}

/// How fast the orientation of the tool may change: the speed and the acceleration of a turn on the spot, where the tool keeps
/// its place, and bounds of those along a path on which the orientation is interpolated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turning {
    /// Largest speed, rad/s.
    pub velocity: f64,
    /// Largest acceleration, rad/s².
    pub acceleration: f64,
}

impl Default for Turning {
    /// 90 deg/s and 180 deg/s².
    fn default() -> Self {
        Turning { velocity: std::f64::consts::FRAC_PI_2, acceleration: std::f64::consts::PI }
    }
}

/// A move of the tool along a line or an arc, or a turn on the spot, from rest to rest.
#[derive(Debug, Clone, PartialEq)]
pub struct CartesianRequest {
    /// Where it begins.
    pub start: Start,
    /// A point that an arc passes, m; none for a line.
    pub via: Option<Vector3<f64>>,
    /// Where the tool goes, m, in the reference.
    pub target: Vector3<f64>,
    /// What its orientation does.
    pub orientation: Orientation,
    /// How fast.
    pub speeds: Speeds,
    /// How fast the orientation changes at most.
    pub turning: Turning,
    /// Largest distance of two waypoints, m.
    pub resolution: f64,
}
