use blocksim_block::prelude::*;
use blocksim_multibody::{EulerZyx, Model, Placement};
use blocksim_robotics::kinematics::{
    Configuration, Constraint, Elbow, InverseError, JointRange, Options, Shoulder, Solver, Status, Wrist,
};
use blocksim_robotics::robot::Robot;

use super::RobotDescription;
use super::arm::{Arm, OfArm, OfAxes};

/// Joint positions that bring the tool of a robot to a point with an orientation, both in its reference frame.
///
/// The orientation is given by Euler angles about z, then the new y, then the new x. Of all solutions within the limits of
/// the axes the one nearest to `near` comes out; connect the measured positions there, or the last set values. Six-axis
/// arms with an ortho-parallel basis and a spherical wrist are solved in closed form; all others by damped least
/// squares from `near` on, so the target should not be far from it. Where the closed form leaves an angle free (the wrist
/// straight, or its centre on axis 1) the nearest to `near` is looked for among all its values.
///
/// Of an arm with a closed form `configuration` is the number of its up to eight solutions: shoulder front (1) or back
/// (-1), elbow up (1) or down (-1), wrist plain (1) or flipped (-1). `shoulder`, `elbow` and `wrist` ask for one; the
/// input `wish`, of the same three numbers, asks while the simulation runs and goes before them where it is not zero.
///
/// Where there is no solution, `solved` is false, `q` is `near` and `status` is the reason: 1 out of reach, 2 within reach, but
/// not within the limits of the axes, 3 not in the required configuration, 4 none found from `near` (arms
/// without a closed form), 5 an input is infinite or no number; then `q` is the start of the description. With a
/// solution `status` is 0.
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
#[block(category = "Robotics", symbol = Arm("q(T)"), builds = OfArm<InverseKinematics>)]
pub struct InverseKinematics {
    /// The robot: links with axes and limits, frames and tool.
    pub robot: RobotDescription,
    /// `Front`: turned towards the tool; `Back`: away from it, reaching over itself; either unless given.
    #[block(default = None)]
    pub shoulder: Option<ShoulderName>,
    /// `Up`: the elbow is above the line from axis 2 to the wrist; `Down`: below; either unless given.
    #[block(default = None)]
    pub elbow: Option<ElbowName>,
    /// `Plain`: axis 5 bent to its positive side; `Flipped`: to the other; either unless given.
    #[block(default = None)]
    pub wrist: Option<WristName>,
}

/// On which side of axis 1 the wrist is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum ShoulderName {
    /// The arm is turned towards it.
    Front,
    /// The arm is turned away and reaches over itself.
    Back,
}

/// To which side the arm is bent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum ElbowName {
    /// The elbow is above the line from axis 2 to the wrist.
    Up,
    /// It is below.
    Down,
}

/// Which way the hand is bent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum WristName {
    /// Axis 5 on its positive side.
    Plain,
    /// Axis 5 on its negative side, axis 4 half a turn away.
    Flipped,
}

/// Why there is no solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Refusal {
    OutOfReach = 1,
    OutsideLimits = 2,
    OtherConfiguration = 3,
    NotFound = 4,
    NotFinite = 5,
}

/// How the arm is solved.
#[derive(Debug)]
enum Work {
    Closed([JointRange; 6]),
    General(Box<Solver<Model>>),
}

/// The three numbers of a configuration.
fn numbers(configuration: &Configuration) -> [f64; 3] {
    let sign = |positive: bool| if positive { 1.0 } else { -1.0 };
    [
        sign(configuration.shoulder == Shoulder::Front),
        sign(configuration.elbow == Elbow::Up),
        sign(configuration.wrist == Wrist::Plain),
    ]
}

impl InverseKinematics {
    /// What the parameters ask for; 0 for either.
    fn wish(&self) -> [f64; 3] {
        let sign = |wish: Option<bool>| wish.map_or(0.0, |positive| if positive { 1.0 } else { -1.0 });
        [
            sign(self.shoulder.map(|shoulder| shoulder == ShoulderName::Front)),
            sign(self.elbow.map(|elbow| elbow == ElbowName::Up)),
            sign(self.wrist.map(|wrist| wrist == WristName::Plain)),
        ]
    }
}

impl InverseKinematics {
    fn build(self, errors: &mut ParamErrors) -> Option<OfArm<Self>> {
        let built = Arm::build(self, errors)?;
        if built.robot.closed_form().is_none() {
            let wishes = ["shoulder", "elbow", "wrist"].into_iter().zip(built.kind.wish());
            for (param, _) in wishes.filter(|(_, wish)| *wish != 0.0) {
                let message = "this arm has no closed form, so its solutions have no configurations";
                let help = "leave it out; the solution is the one to which `near` leads";
                errors.add(ParamError::new(param, message).help(help));
            }
        }
        Some(built)
    }
}

impl Arm for InverseKinematics {
    fn description(&self) -> &RobotDescription {
        &self.robot
    }

    fn ports(&self, robot: &Robot) -> Interface {
        let vector =
            |name: &str, unit: &str, doc| Input::real(name).shape(Shape::Vector(3)).unit(unit).doc(doc);
        let status = PortType { kind: Kind::Int, ..PortType::scalar() };
        let mut interface = Interface::new()
            .input(vector("p", "m", "where the tool centre point shall be"))
            .input(vector("zyx", "rad", "Euler angles α, β, γ of the tool"))
            .input(OfAxes::Position.input(&self.robot, "near", "positions that the solution shall be near"))
            .output(OfAxes::Position.output(&self.robot, "q", "positions of the joints"))
            .output(Output::boolean("solved").doc("whether the tool gets there"))
            .output(Output::like("status", status).doc("0, or why it does not"));
        if robot.closed_form().is_some() {
            let doc = "shoulder, elbow, wrist: 1 or -1, 0 where there is no solution";
            interface = interface
                .input(vector("wish", "1", "configuration: 1 or -1, 0 for either").default(0.0))
                .output(Output::real("configuration").shape(Shape::Vector(3)).unit("1").doc(doc));
        }
        interface
    }

    fn workspace(&self, robot: &Robot) -> Scratch {
        let ranges = robot.ranges();
        let six = ranges.as_slice().try_into().ok().filter(|_| robot.closed_form().is_some());
        match six {
            Some(ranges) => Scratch::new(Work::Closed(ranges)),
            None => Solver::new(robot.model().clone(), &ranges)
                .map_or_else(|_| Scratch::default(), |solver| Scratch::new(Work::General(Box::new(solver)))),
        }
    }

    fn compute(&self, robot: &Robot, c: &Context, w: &mut Scratch, y: &mut [f64]) {
        let Some(work) = w.get::<Work>() else { return };
        let (p, zyx, near) = (c.input(0), c.input(1), c.input(2));
        let rotation = EulerZyx { alpha: zyx[0], beta: zyx[1], gamma: zyx[2] }.rotation();
        let target = Placement { rotation, translation: nalgebra::Vector3::new(p[0], p[1], p[2]) };
        let (q, said) = y.split_at_mut(near.len());
        q.copy_from_slice(near);
        let is_finite = p.iter().chain(zyx).chain(near).all(|number| number.is_finite());
        let solved = match work {
            _ if !is_finite => {
                q.iter_mut().zip(&robot.parts().links).for_each(|(q, link)| *q = link.start);
                Err(Refusal::NotFinite)
            }
            Work::Closed(ranges) => {
                let mut wish = self.wish();
                for (wish, asked) in wish.iter_mut().zip(c.input(3)).filter(|(_, asked)| **asked != 0.0) {
                    *wish = asked.signum();
                }
                closed(robot, &target, near, ranges, wish, q)
            }
            Work::General(solver) => general(robot, solver, &target, near, q).map(|()| [0.0; 3]),
        };
        said[0] = f64::from(solved.is_ok());
        said[1] = solved.map_or_else(|refusal| f64::from(refusal as u8), |_| 0.0);
        if let Some(configuration) = said.get_mut(2..5) {
            configuration.copy_from_slice(&solved.unwrap_or_default());
        }
    }
}

/// Writes the solution nearest to `near` that fulfils a wish; its configuration.
fn closed(
    robot: &Robot,
    target: &Placement,
    near: &[f64],
    ranges: &[JointRange; 6],
    wish: [f64; 3],
    q: &mut [f64],
) -> Result<[f64; 3], Refusal> {
    let (Some(closed_form), Ok(near)) = (robot.closed_form(), near.try_into()) else {
        return Err(Refusal::NotFound);
    };
    let in_world = robot.reference().placement * *target;
    let is_wanted =
        |has: &Configuration| numbers(has).iter().zip(wish).all(|(has, wish)| wish == 0.0 || *has == wish);
    let solution =
        closed_form.nearest_of(&in_world, near, ranges, is_wanted).map_err(|error| match error {
            InverseError::OutsideRanges { .. } => Refusal::OutsideLimits,
            InverseError::OtherConfiguration => Refusal::OtherConfiguration,
            _ => Refusal::OutOfReach,
        })?;
    q.copy_from_slice(&solution.q);
    Ok(numbers(&solution.configuration))
}

/// Writes the solution to which `near` leads.
fn general(
    robot: &Robot,
    solver: &mut Solver<Model>,
    target: &Placement,
    near: &[f64],
    q: &mut [f64],
) -> Result<(), Refusal> {
    let wish = [Constraint::pose(robot.tool(), robot.reference(), *target)];
    let options = Options { restarts: 0, ..Options::default() };
    match solver.solve_into(&wish, near, &options, q) {
        Ok(Status::Success) => Ok(()),
        _ => {
            q.copy_from_slice(near);
            Err(Refusal::NotFound)
        }
    }
}

#[cfg(test)]
#[path = "inverse_kinematics_tests.rs"]
mod tests;
