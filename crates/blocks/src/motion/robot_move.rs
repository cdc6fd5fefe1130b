use blocksim_block::prelude::*;
use blocksim_multibody::{Data, forward_kinematics, relative_jacobian};
use blocksim_robotics::planner::Course;
use std::sync::Arc;

use super::forewarning::{Subject, forewarn};
use super::joint_path::{JointPath, Rule};
use super::planned::planned;
use super::timed::{few, validate_path};
use crate::robotics::arm::OfAxes;
use crate::robotics::pose::{Pose, pose_outputs};
use crate::robotics::{RobotDescription, Surroundings};

/// Set values of a whole robot on a move: of all axes, and of the tool in the reference frame of the robot.
///
/// The move is the `path` of `JointMove`: a joint move, a line or an arc of the tool, or a sequence. Limits are those of
/// the description. The tool follows from the positions of the axes by forward kinematics, its speeds from theirs by the
/// Jacobian, $(\omega; v) = J \dot q$, so that they belong to joint moves and paths alike. The orientation comes twice: as
/// Euler angles about z, then the new y, then the new x, and as quaternion with the real part first (not negative).
///
/// A move that exceeds limits of the description, of axes, drives or tool, or in which something is hit, is simulated as it
/// is: warnings report where, when and by how much.
///
/// ```ron
/// RobotMove(
///     path: (start: ["0 deg", "0 deg"], target: ["60 deg", "-30 deg"], velocity: "40 %", acceleration: "30 %"),
///     robot: (
///         links: [
///             (axis: [0, 1, 0], limits: (lower: "-90 deg", upper: "90 deg", speed: "2 rad/s", acceleration: "9 rad/s^2")),
///             (origin: (translation: [0, 0, "0.5 m"]), axis: [0, 1, 0],
///              limits: (lower: "-150 deg", upper: "150 deg", speed: "2 rad/s", acceleration: "9 rad/s^2")),
///         ],
///         flange: (translation: [0, 0, "0.4 m"]),
///     ),
/// )
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Motion", symbol = Curve(Move), builds = RobotMove)]
pub struct RobotMove {
    /// The robot: links with axes and limits, frames and tool.
    pub robot: RobotDescription,
    /// The move, as of `JointMove`.
    pub path: JointPath,
    /// Time before the move starts, not negative.
    #[block(unit = "s", not_negative, default = 0.0)]
    pub delay: f64,
    /// What stands around the robot: the move is checked for collisions with it, as it is for those of the robot with itself.
    #[block(default = None)]
    pub surroundings: Option<Surroundings>,
    /// How the axes of a joint move are synchronised: `Feasible` or `AsPrinted`.
    #[block(default = Rule::Feasible)]
    pub rule: Rule,
    /// The robot and its move; made by `build`.
    #[block(skip)]
    plan: Option<(blocksim_robotics::robot::Robot, Arc<dyn Course>)>,
    /// Times that are hit exactly, counted from the start of the move, s.
    #[block(skip)]
    seams: Vec<f64>,
}

/// What one evaluation needs.
#[derive(Debug)]
struct Work {
    data: Data,
    q: Vec<f64>,
    /// (ω; v) by each joint, row by row.
    jacobian: Vec<f64>,
}

impl RobotMove {
    fn validate(&self, errors: &mut ParamErrors) {
        validate_path(&self.path, errors);
    }

    fn build(mut self, errors: &mut ParamErrors) -> Option<Self> {
        let robot = errors.take(self.robot.robot("robot"))?;
        errors.take(self.robot.space(&robot, self.surroundings.as_ref(), "surroundings"));
        let course = errors.take(planned(&self.path, &robot.limits(), self.rule, Some(&robot), "path"))?;
        self.seams = few(course.seams());
        self.plan = Some((robot, course));
        Some(self)
    }
}

impl Block for RobotMove {
    fn load(&mut self, files: &dyn Files) -> Result<(), LoadError> {
        if let Some((robot, course)) = &self.plan {
            let subject = Subject {
                path: self.path.clone(),
                limits: robot.limits(),
                as_printed: self.rule == Rule::AsPrinted,
                robot: Some(self.robot.clone()),
                collides: true,
                surroundings: self.surroundings.clone(),
            };
            forewarn(subject, course.as_ref(), Some(robot), files);
        }
        Ok(())
    }

    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let mut interface = Interface::new()
            .output_from_state(OfAxes::Position.output(&self.robot, "q", "positions of the axes"))
            .output_from_state(OfAxes::Speed.output(&self.robot, "qd", "their speeds"))
            .output_from_state(OfAxes::Acceleration.output(&self.robot, "qdd", "their accelerations"));
        for output in pose_outputs("tool centre point") {
            interface = interface.output_from_state(output);
        }
        let vector =
            |name: &str, unit: &str, doc| Output::real(name).shape(Shape::Vector(3)).unit(unit).doc(doc);
        Ok(interface
            .output_from_state(vector("v", "m/s", "velocity of the tool centre point"))
            .output_from_state(vector("w", "rad/s", "angular velocity of the tool"))
            .uses_time()
            .time_events())
    }

    fn scratch(&self) -> Scratch {
        let Some((robot, _)) = &self.plan else { return Scratch::default() };
        let n = robot.axes();
        Scratch::new(Work { data: robot.model().data(), q: vec![0.0; n], jacobian: vec![0.0; 6 * n] })
    }

    fn outputs(&self, _group: usize, c: &Context, w: &mut Scratch, y: &mut [f64]) {
        let (Some((robot, course)), Some(work)) = (&self.plan, w.get::<Work>()) else {
            return c.fail("the move has no plan");
        };
        let n = robot.axes();
        for axis in 0..n {
            let [q, qd, qdd] = course.at(axis, c.t - self.delay);
            (y[axis], y[n + axis], y[2 * n + axis]) = (q, qd, qdd);
        }
        work.q.copy_from_slice(&y[..n]);
        forward_kinematics(robot.model(), &mut work.data, &work.q);
        let (tool, reference) = (robot.tool(), robot.reference());
        let pose = Pose::of(&tool.relative_to(&reference, &work.data));
        pose.write(&mut y[3 * n..3 * n + Pose::LEN]);
        relative_jacobian(robot.model(), &work.data, &tool, &reference, &mut work.jacobian);
        let (axes, tool) = y.split_at_mut(3 * n + Pose::LEN);
        let speeds = &axes[n..2 * n];
        // Velocity comes before angular velocity.
        for (row, to) in [3, 4, 5, 0, 1, 2].into_iter().zip(tool) {
            let row = &work.jacobian[row * n..(row + 1) * n];
            *to = row.iter().zip(speeds).map(|(j, qd)| j * qd).sum();
        }
    }

    fn next_event(&self, c: &Context) -> f64 {
        let mut seams = self.seams.iter().map(|seam| self.delay + seam);
        seams.find(|seam| *seam > c.t).unwrap_or(f64::INFINITY)
    }

    fn end_time(&self) -> Option<f64> {
        self.plan.as_ref().map(|(_, course)| self.delay + course.duration())
    }
}
