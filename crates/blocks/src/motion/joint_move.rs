use blocksim_block::prelude::*;
use blocksim_robotics::motion::{AxisKind, AxisLimits};
use blocksim_robotics::planner::Course;
use std::sync::Arc;

use super::forewarning::{Subject, forewarn};
use super::joint_path::{JointPath, Rule};
use super::limits::Limits;
use super::planned::planned;
use super::timed::{few, validate_path};
use crate::robotics::RobotDescription;

/// Set values of one axis of a robot that moves all axes together, from rest to rest (PTP, fully synchronised).
///
/// All axes accelerate, cruise and brake during the same times. The acceleration is a $\sin^2$ bump, then zero,
/// then the mirrored bump; with the distance $d$ of the axis
///
/// $$ \ddot q = a_m \sin^2\frac{\pi t}{T_{acc}}, \qquad v_m = \frac{d}{T_{dec}}, \qquad
///    a_m = \frac{2 v_m}{T_{acc}}, \qquad T_{end} = T_{acc} + T_{dec} $$
///
/// `path.velocity` is the share of each axis' maximum speed to use, `path.acceleration` the share of the move time
/// spent accelerating. The times are the longest that any axis needs (`rule: Feasible`), stretched where an
/// acceleration limit would be exceeded, or those of the axis that takes longest alone (`rule: AsPrinted`), which
/// can exceed limits of other axes. Start, end of acceleration, start of braking and end are hit exactly; before
/// and after the move the axis rests.
///
/// A move that `blocksim plan` wrote can be given as `path`, too: lines and arcs of the tool (`path.tool`) and
/// sequences (`path.moves`). These need the `robot`; position, speed and acceleration of the axes then follow from the
/// way of the tool.
///
/// A move that exceeds limits of the axes, and with the `robot` those of drives and tool, is simulated as it is: warnings report
/// where, when and by how much. `RobotMove` checks for collisions, too.
///
/// ```ron
/// JointMove(
///     path: (start: ["0 deg", "0 deg"], target: ["60 deg", "-30 deg"], velocity: "40 %", acceleration: "30 %", resolution: "0.5 deg"),
///     limits: [
///         (lower: "-180 deg", upper: "180 deg", speed: "175 deg/s", acceleration: "1000 deg/s^2"),
///         (lower: "-95 deg", upper: "155 deg", speed: "175 deg/s", acceleration: "1000 deg/s^2"),
///     ],
///     axis: 1,
/// )
/// ```
///
/// Source: W. Weber, Industrieroboter, 2017, sinusoidal profiles and fully synchronous joint moves.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Motion", symbol = Curve(Move), builds = JointMove)]
pub struct JointMove {
    /// The move of all axes: `(start, target, velocity, acceleration, resolution)`.
    pub path: JointPath,
    /// What each axis can do: a list of `(lower, upper, speed, acceleration)`, with lengths for axes that slide.
    pub limits: Vec<Limits>,
    /// The axis whose set values come out, counted from 1 as in the robot's manual.
    pub axis: usize,
    /// Time before the move starts, not negative.
    #[block(unit = "s", not_negative, default = 0.0)]
    pub delay: f64,
    /// How the axes are synchronised: `Feasible` or `AsPrinted`.
    #[block(default = Rule::Feasible)]
    pub rule: Rule,
    /// The robot, for moves of its tool.
    #[block(default = None)]
    pub robot: Option<RobotDescription>,
    /// The planned move; made by `build`.
    #[block(skip)]
    plan: Option<Arc<dyn Course>>,
    /// Times that are hit exactly, counted from the start of the move, s.
    #[block(skip)]
    seams: Vec<f64>,
}

impl JointMove {
    fn axis_limits(&self) -> Vec<AxisLimits> {
        self.limits.iter().map(|limits| limits.of(limits.kind())).collect()
    }

    fn planned(&self) -> Result<Arc<dyn Course>, ParamError> {
        let limits = self.axis_limits();
        let follows_path = self.path.tool.is_some() || !self.path.moves.is_empty();
        let robot = match &self.robot {
            Some(robot) if follows_path => Some(robot.robot("robot")?),
            _ => None,
        };
        planned(&self.path, &limits, self.rule, robot.as_ref(), "path")
    }

    fn validate(&self, errors: &mut ParamErrors) {
        validate_path(&self.path, errors);
        let axes = self.limits.len();
        if axes == 0 {
            let error = ParamError::new("limits", "`limits` is empty");
            errors.add(error.help("give what each axis can do: (lower, upper, speed, acceleration)"));
        }
        if !(1..=axes).contains(&self.axis) {
            let error =
                ParamError::new("axis", format!("`axis` is {}, but there are {axes} axes", self.axis));
            let help = format!("axes are counted from 1: choose 1 to {axes}");
            errors.add(error.beside(&["limits"]).help(help));
        }
    }

    fn build(mut self, errors: &mut ParamErrors) -> Option<Self> {
        let plan = errors.take(self.planned())?;
        self.seams = few(plan.seams());
        self.plan = Some(plan);
        Some(self)
    }
}

impl Block for JointMove {
    fn load(&mut self, files: &dyn Files) -> Result<(), LoadError> {
        let Some(course) = &self.plan else { return Ok(()) };
        // A description that makes no robot is reported where it is used.
        let robot = self.robot.as_ref().and_then(|robot| robot.robot("robot").ok());
        let robot = robot.filter(|robot| robot.axes() == course.axes());
        let subject = Subject {
            path: self.path.clone(),
            limits: self.axis_limits(),
            as_printed: self.rule == Rule::AsPrinted,
            robot: self.robot.clone().filter(|_| robot.is_some()),
            collides: false,
            surroundings: None,
        };
        forewarn(subject, course.as_ref(), robot.as_ref(), files);
        Ok(())
    }

    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let limits = self.axis.checked_sub(1).and_then(|axis| self.limits.get(axis));
        let [q, qd, qdd] = match limits.map(Limits::kind).unwrap_or_default() {
            AxisKind::Turning => ["rad", "rad/s", "rad/s^2"],
            AxisKind::Sliding => ["m", "m/s", "m/s^2"],
        };
        Ok(Interface::new()
            .output_from_state(Output::real("q").unit(q).doc("Position."))
            .output_from_state(Output::real("qd").unit(qd).doc("Velocity."))
            .output_from_state(Output::real("qdd").unit(qdd).doc("Acceleration."))
            .uses_time()
            .time_events())
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        match &self.plan {
            Some(plan) => {
                y.copy_from_slice(&plan.at(self.axis - 1, c.t - self.delay));
            }
            None => c.fail("the move has no plan"),
        }
    }

    fn next_event(&self, c: &Context) -> f64 {
        let mut seams = self.seams.iter().map(|seam| self.delay + seam);
        seams.find(|seam| *seam > c.t).unwrap_or(f64::INFINITY)
    }

    fn end_time(&self) -> Option<f64> {
        self.plan.as_ref().map(|plan| self.delay + plan.duration())
    }
}

#[cfg(test)]
#[path = "joint_move_tests.rs"]
mod tests;
