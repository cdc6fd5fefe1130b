//! What a file says of a move along a path of the tool, and the request that it makes.

use blocksim_block::in_unit;
use blocksim_block::prelude::*;
use blocksim_multibody::EulerZyx;
use blocksim_robotics::planner::{CartesianRequest, Orientation, Speeds, Start, Timing, Turning};
use nalgebra::Vector3;

use crate::robotics::Seat;

/// A line or an arc of the tool, in a frame that stands in the reference frame of the robot.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToolPath {
    /// Where the tool goes, m.
    #[serde(deserialize_with = "in_unit::point")]
    pub target: [f64; 3],
    /// The frame in which target, via point and rotation are given, in the reference frame of the robot.
    #[serde(default)]
    pub work_object: Seat,
    /// A point that an arc passes, m; none for a line.
    #[serde(default)]
    pub via: Option<Point>,
    /// What its orientation does: `free`, `fixed`, `interpolated` or `tool-axis`.
    #[serde(default = "free")]
    pub orientation: String,
    /// ZYX Euler angles α, β, γ at the target, rad; for `interpolated`.
    #[serde(default)]
    pub rotation: Option<Turns>,
    /// Speed of the tool, m/s.
    #[serde(deserialize_with = "in_unit::velocity")]
    pub velocity: f64,
    /// Share of the maximum acceleration of the tool.
    #[serde(deserialize_with = "in_unit::share")]
    pub acceleration: f64,
    /// Speed of a turn on the spot, rad/s: where the target is where the tool is already, with another rotation.
    #[serde(default = "turn_velocity", deserialize_with = "in_unit::speed")]
    pub rotation_velocity: f64,
    /// Acceleration of a turn on the spot, rad/s^2.
    #[serde(default = "turn_acceleration", deserialize_with = "in_unit::acceleration")]
    pub rotation_acceleration: f64,
    /// How the speed rises and falls: `sin2`, `trapezoid`, `s-curve` or `time-optimal`.
    #[serde(default = "sin2")]
    pub profile: String,
    /// Largest jerk of an S-curve, m/s^3; without it, the acceleration is reached in 0.1 s.
    #[serde(default, deserialize_with = "in_unit::jerk_if_given")]
    pub jerk: Option<f64>,
    /// Distance of waypoints, m.
    #[serde(default = "millimetre", deserialize_with = "in_unit::length")]
    pub resolution: f64,
}

/// A point, m.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(transparent)]
pub struct Point {
    /// x, y, z.
    #[serde(deserialize_with = "in_unit::point")]
    pub at: [f64; 3],
}

/// Three angles, rad.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(transparent)]
pub struct Turns {
    /// About z, the new y and the new x.
    #[serde(deserialize_with = "in_unit::turns")]
    pub angles: [f64; 3],
}

fn free() -> String {
    "free".into()
}

fn sin2() -> String {
    "sin2".into()
}

fn millimetre() -> f64 {
    1e-3
}

fn turn_velocity() -> f64 {
    Turning::default().velocity
}

fn turn_acceleration() -> f64 {
    Turning::default().acceleration
}

/// The words for orientations.
pub const ORIENTATIONS: [&str; 4] = ["free", "fixed", "interpolated", "tool-axis"];

/// The words for profiles.
pub const PROFILES: [&str; 4] = ["sin2", "trapezoid", "s-curve", "time-optimal"];

impl ToolPath {
    /// The request from a start. `acceleration` is the largest one of the tool, m/s²; `param` the path of this set.
    ///
    /// # Errors
    /// A word that is not known, a rotation that is missing or not used.
    pub fn request(
        &self,
        start: Start,
        acceleration: f64,
        param: &str,
    ) -> Result<CartesianRequest, ParamError> {
        let unknown = |member: &str, word: &str, known: &[&str]| {
            ParamError::new(format!("{param}.{member}"), format!("there is no {member} `{word}`"))
                .help(format!("choose {}", known.join(", ")))
        };
        let work_object = self.work_object.placement();
        let orientation = match (self.orientation.as_str(), self.rotation) {
            ("interpolated", Some(Turns { angles: [alpha, beta, gamma] })) => {
                let within = EulerZyx { alpha, beta, gamma }.rotation();
                Orientation::Interpolated(work_object.rotation * within)
            }
            ("interpolated", None) => {
                return Err(ParamError::new(
                    format!("{param}.rotation"),
                    "the orientation at the target is missing",
                )
                .help("give three ZYX Euler angles, or choose the orientation fixed"));
            }
            ("free" | "fixed" | "tool-axis", Some(_)) => {
                let message = format!(
                    "a rotation at the target has no use where the orientation is {}",
                    self.orientation
                );
                return Err(ParamError::new(format!("{param}.rotation"), message)
                    .help("leave the rotation out, or choose the orientation interpolated"));
            }
            ("free", None) => Orientation::Free,
            ("fixed", None) => Orientation::Fixed,
            ("tool-axis", None) => Orientation::Axis,
            (word, _) => return Err(unknown("orientation", word, &ORIENTATIONS)),
        };
        let timing = match self.profile.as_str() {
            "sin2" => Timing::Sin2,
            "trapezoid" => Timing::Trapezoid,
            "s-curve" => {
                Timing::SCurve { jerk: self.jerk.unwrap_or(10.0 * self.acceleration * acceleration) }
            }
            "time-optimal" => Timing::TimeOptimal,
            word => return Err(unknown("profile", word, &PROFILES)),
        };
        Ok(CartesianRequest {
            start,
            via: self.via.map(|via| work_object.point(&Vector3::from(via.at))),
            target: work_object.point(&Vector3::from(self.target)),
            orientation,
            speeds: Speeds { velocity: self.velocity, acceleration: self.acceleration, timing },
            turning: Turning { velocity: self.rotation_velocity, acceleration: self.rotation_acceleration },
            resolution: self.resolution,
        })
    }
}

#[cfg(test)]
mod tests {
    use blocksim_multibody::Placement;

    use super::*;

    #[test]
    fn targets_of_a_work_object_are_where_it_stands() {
        let in_object = ToolPath {
            target: [0.1, 0.2, 0.0],
            work_object: Seat { translation: [1.0, -0.5, 0.6], rpy: [0.0, 0.0, std::f64::consts::FRAC_PI_2] },
            via: Some(Point { at: [0.0, 0.1, 0.3] }),
            orientation: "interpolated".into(),
            rotation: Some(Turns { angles: [0.2, 0.3, -0.4] }),
            velocity: 0.1,
            acceleration: 0.2,
            rotation_velocity: 1.0,
            rotation_acceleration: 2.0,
            profile: sin2(),
            jerk: None,
            resolution: 1e-3,
        };
        let request = in_object.request(Start::Joints(Vec::new()), 5.0, "move.tool").unwrap();
        // A quarter turn about z takes x to y and y to -x.
        assert!((request.target - Vector3::new(0.8, -0.4, 0.6)).norm() < 1e-15, "{}", request.target);
        assert!((request.via.unwrap() - Vector3::new(0.9, -0.5, 0.9)).norm() < 1e-15);
        let Orientation::Interpolated(rotation) = request.orientation else { panic!("{request:?}") };
        let alone = EulerZyx { alpha: 0.2 + std::f64::consts::FRAC_PI_2, beta: 0.3, gamma: -0.4 };
        assert!((rotation - alone.rotation()).norm() < 1e-14, "turns about z add up");
        let plain = ToolPath { work_object: Seat::default(), ..in_object };
        assert_eq!(plain.work_object.placement(), Placement::identity());
        let request = plain.request(Start::Joints(Vec::new()), 5.0, "move.tool").unwrap();
        assert_eq!(request.target, Vector3::new(0.1, 0.2, 0.0));
    }
}
