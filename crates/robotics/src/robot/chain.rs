//! A robot that is ready for kinematics, planning and dynamics.

use crate::kinematics::{ClosedForm, JointRange};
use crate::motion::{AxisKind, AxisLimits};
use crate::robot::drive::Drive;
use crate::robot::error::RobotError;
use crate::robot::parts::{Parts, TcpLimits};
use blocksim_multibody::{
    BodyId, Data, Frame, Inertia, Joint, Model, ModelBuilder, Placement, bias, forward_kinematics, rnea,
};

/// A chain of axes that turn or slide, with frames, tool and drives.
///
/// ```
/// use blocksim_robotics::motion::{AxisKind, AxisLimits};
/// use blocksim_multibody::{Inertia, Placement};
/// use blocksim_robotics::robot::{Drive, Link, Parts, Robot, LinkSolid, TcpLimits};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let limits = AxisLimits { kind: AxisKind::Turning, lower: -3.0, upper: 3.0, speed: 2.0, acceleration: 10.0 };
/// let link = |name: &str, x: f64| -> Result<Link, Box<dyn std::error::Error>> {
///     let solid = LinkSolid { placement: Placement::identity(), inertia: Inertia::point(1.0, [0.5, 0.0, 0.0])? };
///     let origin = Placement::from_translation([x, 0.0, 0.0]);
///     let name = name.to_owned();
///     Ok(Link { name, origin, axis: [0.0, 1.0, 0.0], limits, start: 0.0, solids: vec![solid], drive: Drive::default() })
/// };
/// let robot = Robot::new(Parts {
///     name: "two links".into(),
///     gravity: [0.0, 0.0, -9.81],
///     base: Placement::identity(),
///     reference: Placement::identity(),
///     links: vec![link("upper", 0.0)?, link("fore", 1.0)?],
///     flange: Placement::from_translation([1.0, 0.0, 0.0]),
///     tool: Placement::identity(),
///     tcp_limits: TcpLimits { speed: 1.0, acceleration: 5.0 },
/// })?;
/// let tcp = robot.tcp(&mut robot.model().data(), &[0.0, -std::f64::consts::FRAC_PI_2]);
/// assert!((tcp.translation.x - 1.0).abs() < 1e-15 && (tcp.translation.z - 1.0).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Robot {
    parts: Parts,
    model: Model,
    last: BodyId,
    closed_form: Option<ClosedForm>,
    /// A zero for each axis.
    rest: Vec<f64>,
}

impl Robot {
    /// Assembles a robot.
    ///
    /// # Errors
    /// [`RobotError`] names the member of the parts that is at fault.
    pub fn new(parts: Parts) -> Result<Self, RobotError> {
        parts.check()?;
        let mut builder = ModelBuilder::new();
        builder.gravity(parts.gravity);
        let mut last = None;
        for (link, part) in parts.links.iter().enumerate() {
            let fail = |cause| RobotError::Link { link, cause };
            let origin = if link == 0 { parts.base * part.origin } else { part.origin };
            let joint = match part.limits.kind {
                AxisKind::Turning => Joint::revolute(part.axis),
                AxisKind::Sliding => Joint::prismatic(part.axis),
            };
            let body = builder.add_body(last, joint, origin, Inertia::zero()).map_err(fail)?;
            for solid in &part.solids {
                builder.add_inertia(body, solid.placement, solid.inertia).map_err(fail)?;
            }
            last = Some(body);
        }
        let last = last.ok_or(RobotError::NoLinks)?;
        let model = builder.build();
        let tool = Frame::of(last).at(parts.flange * parts.tool);
        let closed_form = ClosedForm::of(&model, &tool).ok();
        let rest = vec![0.0; parts.links.len()];
        Ok(Robot { parts, model, last, closed_form, rest })
    }

    /// What it was made of.
    pub fn parts(&self) -> &Parts {
        &self.parts
    }

    /// What people call it.
    pub fn name(&self) -> &str {
        &self.parts.name
    }

    /// The mechanism; its ground is the world, its joints are the axes in their order.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Number of axes.
    pub fn axes(&self) -> usize {
        self.parts.links.len()
    }

    /// What the axes can do.
    pub fn limits(&self) -> Vec<AxisLimits> {
        self.parts.links.iter().map(|link| link.limits).collect()
    }

    /// From where to where the axes may go.
    pub fn ranges(&self) -> Vec<JointRange> {
        let range = |limits: AxisLimits| JointRange { lower: limits.lower, upper: limits.upper };
        self.limits().into_iter().map(range).collect()
    }

    /// Positions of the axes at the start, rad or m.
    pub fn start(&self) -> Vec<f64> {
        self.parts.links.iter().map(|link| link.start).collect()
    }

    /// What the tool centre point can do.
    pub fn tcp_limits(&self) -> TcpLimits {
        self.parts.tcp_limits
    }

    /// The frame of targets, fixed in the world.
    pub fn reference(&self) -> Frame {
        Frame::ground().at(self.parts.base * self.parts.reference)
    }

    /// The flange on the last link.
    pub fn flange(&self) -> Frame {
        Frame::of(self.last).at(self.parts.flange)
    }

    /// The tool on the last link.
    pub fn tool(&self) -> Frame {
        self.flange().at(self.parts.tool)
    }

    /// Inverse kinematics of the tool in closed form, if the arm is of its class: six axes, an ortho-parallel basis and
    /// a spherical wrist. Targets of [`ClosedForm`] are in the world: put [`Robot::reference`] in front.
    pub fn closed_form(&self) -> Option<&ClosedForm> {
        self.closed_form.as_ref()
    }

    /// The drives of the axes.
    pub fn drives(&self) -> impl Iterator<Item = &Drive> {
        self.parts.links.iter().map(|link| &link.drive)
    }

    /// Where the tool is in the reference at positions `q`, rad or m.
    ///
    /// # Panics
    /// If `q` has not one entry for each axis, or `data` belongs to another model.
    pub fn tcp(&self, data: &mut Data, q: &[f64]) -> Placement {
        forward_kinematics(&self.model, data, q);
        self.tool().relative_to(&self.reference(), data)
    }

    /// Torques (N m) and forces (N) at the joints that move the mechanism with speeds `v` and accelerations `a` at positions `q`: the
    /// inverse dynamics without drives.
    ///
    /// # Panics
    /// If a slice has not one entry for each axis, or `data` belongs to another model.
    pub fn joint_torques(&self, data: &mut Data, q: &[f64], v: &[f64], a: &[f64], tau: &mut [f64]) {
        rnea(&self.model, data, q, v, a, tau);
    }

    /// Torques (N m) and forces (N) at the joints that hold the mechanism at rest.
    ///
    /// # Panics
    /// As [`Robot::joint_torques`].
    pub fn gravity_torques(&self, data: &mut Data, q: &[f64], tau: &mut [f64]) {
        bias(&self.model, data, q, &self.rest, tau);
    }

    /// Torques (N m) and forces (N) of the motors, counted at the joints: [`Robot::joint_torques`] and what the drives need for
    /// themselves ([`Drive::motor_torque`]).
    ///
    /// # Panics
    /// As [`Robot::joint_torques`].
    pub fn motor_torques(&self, data: &mut Data, q: &[f64], v: &[f64], a: &[f64], tau: &mut [f64]) {
        self.joint_torques(data, q, v, a, tau);
        for (i, drive) in self.drives().enumerate() {
            tau[i] = drive.motor_torque(tau[i], v[i], a[i]);
        }
    }
}
