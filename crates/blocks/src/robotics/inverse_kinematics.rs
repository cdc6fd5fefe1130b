use blocksim_block::prelude::*;
use blocksim_kinematics::{Constraint, JointRange, Options, Solver, Status};
use blocksim_multibody::{EulerZyx, Placement};
use blocksim_robot::Robot;

use super::RobotDescription;
use super::arm::Arm;

/// Joint positions that bring the tool of a robot to a point with an orientation, both in its reference frame.
///
/// The orientation is given by Euler angles about z, then the new y, then the new x. Of all solutions within the limits of
/// the axes the one nearest to `near` comes out; connect the measured positions there, or the last set values. Six-axis
/// arms with an ortho-parallel basis and a spherical wrist are solved in closed form; all others by damped least
/// squares from `near` on, so the target should not be far from it.
///
/// Where there is no solution `solved` is false, and `q` is `near`.
///
/// ```ron
/// InverseKinematics(robot: (
///     links: [
///         (axis: [0, 0, 1], origin: (translation: [0, 0, "0.4 m"]),
///          limits: (lower: "-3 rad", upper: "3 rad", speed: "2 rad/s", acceleration: "9 rad/s^2")),
///         (axis: [0, 1, 0], origin: (translation: ["0.1 m", 0, 0]),
///          limits: (lower: "-2 rad", upper: "2 rad", speed: "2 rad/s", acceleration: "9 rad/s^2")),
///         (axis: [0, 1, 0], origin: (translation: [0, 0, "0.9 m"]),
///          limits: (lower: "-3 rad", upper: "1 rad", speed: "2 rad/s", acceleration: "9 rad/s^2")),
///         (axis: [1, 0, 0], origin: (translation: [0, 0, "0.1 m"]),
///          limits: (lower: "-6 rad", upper: "6 rad", speed: "2 rad/s", acceleration: "9 rad/s^2")),
///         (axis: [0, 1, 0], origin: (translation: ["0.8 m", 0, 0]),
///          limits: (lower: "-2 rad", upper: "2 rad", speed: "2 rad/s", acceleration: "9 rad/s^2")),
///         (axis: [1, 0, 0], origin: (translation: ["0.1 m", 0, 0]),
///          limits: (lower: "-6 rad", upper: "6 rad", speed: "2 rad/s", acceleration: "9 rad/s^2")),
///     ],
/// ))
/// ```
///
/// Source: M. Brandstötter, A. Angerer, M. Hofbaur, An analytical solution of the inverse kinematics problem of
/// industrial serial manipulators with an ortho-parallel basis and a spherical wrist, 2014.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Robotics", symbol = Arm("q(T)"))]
pub struct InverseKinematics {
    /// The robot: links with axes and limits, frames and tool.
    pub robot: RobotDescription,
    /// The assembled robot; made by `load`.
    #[block(skip)]
    arm: Arm,
}

impl Block for InverseKinematics {
    fn load(&mut self, _files: &dyn Files) -> Result<(), LoadError> {
        self.arm = Arm::of(&self.robot);
        Ok(())
    }

    fn check(&self) -> Result<(), ParamError> {
        Arm::check(&self.robot)
    }

    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let joints = self.robot.links.len();
        Ok(Interface::new()
            .input(Arm::vector("p", 3, "m", "where the tool centre point shall be"))
            .input(Arm::vector("zyx", 3, "rad", "Euler angles α, β, γ of the tool"))
            .input(Arm::positions("near", joints, "positions that the solution shall be near"))
            .output(Output::real("q").shape(Shape::Vector(joints)).unit("rad").doc("positions of the joints"))
            .output(Output::boolean("solved").doc("whether the tool gets there")))
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        let Some(robot) = self.arm.robot(c) else { return };
        let (p, zyx, near) = (c.input(0), c.input(1), c.input(2));
        let rotation = EulerZyx { alpha: zyx[0], beta: zyx[1], gamma: zyx[2] }.rotation();
        let target = Placement { rotation, translation: nalgebra::Vector3::new(p[0], p[1], p[2]) };
        let solved = solve(robot, &target, near, &mut y[c.output(0)]);
        y[c.output(1)][0] = f64::from(solved);
    }
}

/// Writes the solution nearest to `near`, or `near`; whether there is one.
fn solve(robot: &Robot, target: &Placement, near: &[f64], q: &mut [f64]) -> bool {
    q.copy_from_slice(near);
    let ranges = robot.ranges();
    let six: Option<(&[f64; 6], &[JointRange; 6])> =
        near.try_into().ok().zip(ranges.as_slice().try_into().ok());
    if let (Some(closed_form), Some((near, ranges))) = (robot.closed_form(), six) {
        let in_world = robot.reference().placement * *target;
        return closed_form
            .nearest(&in_world, near, ranges)
            .map(|solution| q.copy_from_slice(&solution.q))
            .is_ok();
    }
    let wish = [Constraint::pose(robot.tool(), robot.reference(), *target)];
    let options = Options { restarts: 0, ..Options::default() };
    let solved =
        Solver::new(robot.model(), &ranges).and_then(|mut solver| solver.solve(&wish, near, &options));
    match solved {
        Ok(solved) if solved.status == Status::Success => {
            q.copy_from_slice(&solved.q);
            true
        }
        _ => false,
    }
}
