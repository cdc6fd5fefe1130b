use blocksim_block::in_unit::AxisPositions;
use blocksim_block::physical::{Axis, Domain, Element, Freedom};
use blocksim_block::prelude::*;
use blocksim_multibody::Placement;
use blocksim_robotics::motion::AxisKind;
use blocksim_scene::Form;

use super::RobotDescription;
use super::arm::OfAxes;
use crate::motion::limits::of_kinds;
use crate::multibody::axis::{Inside, unit};
use crate::multibody::joint_limit::JointLimit;

/// A robot arm as one block: bodies and joints of a description, a drive side for each axis.
///
/// It is the same mechanism as a chain of `Transform`, `Body` and `RevoluteJoint` or `PrismaticJoint`. The arm is mounted at `base`; at
/// `flange` more can be fixed to it, in the axes of the flange. `r1`, `c1`, `r2`, `c2` and so on are rod and case of the
/// drive sides, rotational where the axis turns and translational where it slides, so $w_{r_i} - w_{c_i} = \dot q_i$. An
/// axis that nothing drives swings freely. The ends of
/// travel are springs and dampers beyond the limits of the description; drives of the description are not built in, shapes
/// of its bodies are drawn.
///
/// ```ron
/// Robot(robot: (
///     links: [
///         (axis: [0, 1, 0], limits: (lower: "-90 deg", upper: "90 deg", speed: "2 rad/s", acceleration: "9 rad/s^2"),
///          bodies: [(mass: "3 kg", com: [0, 0, "0.25 m"], moi: ["0.06 kg*m^2", "0.06 kg*m^2", "0.003 kg*m^2"])]),
///         (origin: (translation: [0, 0, "0.5 m"]), axis: [0, 1, 0],
///          limits: (lower: "-150 deg", upper: "150 deg", speed: "2 rad/s", acceleration: "9 rad/s^2"),
///          bodies: [(mass: "2 kg", com: [0, 0, "0.2 m"], moi: ["0.03 kg*m^2", "0.03 kg*m^2", "0.002 kg*m^2"])]),
///     ],
///     flange: (translation: [0, 0, "0.4 m"]),
/// ))
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Robotics", symbol = Arm(""))]
pub struct Robot {
    /// The robot: links with axes, limits and bodies.
    pub robot: RobotDescription,
    /// Positions at the start, one for each axis, rad or m; those of the description unless given.
    #[block(default = None)]
    pub position: Option<AxisPositions>,
    /// Stiffness of the ends of travel of axes that turn.
    #[block(unit = "N*m/rad", not_negative, default = 5.73e5)]
    pub limit_stiffness: f64,
    /// Damping of the ends of travel of axes that turn.
    #[block(unit = "N*m*s/rad", not_negative, default = 573.0)]
    pub limit_damping: f64,
    /// Width over which the end of travel of an axis that turns sets in.
    #[block(unit = "rad", not_negative, default = 1.745e-3)]
    pub limit_transition: f64,
    /// Stiffness of the ends of travel of axes that slide.
    #[block(unit = "N/m", not_negative, default = 1e6)]
    pub slide_limit_stiffness: f64,
    /// Damping of the ends of travel of axes that slide.
    #[block(unit = "N*s/m", not_negative, default = 1e3)]
    pub slide_limit_damping: f64,
    /// Width over which the end of travel of an axis that slides sets in.
    #[block(unit = "m", not_negative, default = 1e-4)]
    pub slide_limit_transition: f64,
}

/// Names of position and speed of each axis.
const NAMES: [[&str; 2]; MOST] = [
    ["q1", "w1"],
    ["q2", "w2"],
    ["q3", "w3"],
    ["q4", "w4"],
    ["q5", "w5"],
    ["q6", "w6"],
    ["q7", "w7"],
    ["q8", "w8"],
    ["q9", "w9"],
    ["q10", "w10"],
    ["q11", "w11"],
    ["q12", "w12"],
];

/// Most axes.
const MOST: usize = 12;

impl Robot {
    fn start(&self, axis: usize) -> f64 {
        match &self.position {
            Some(position) => position.0.get(axis).copied().unwrap_or_default().value,
            None => self.robot.links[axis].start.value,
        }
    }

    fn inside(&self, axis: usize) -> Inside {
        let limits = &self.robot.links[axis].limits;
        Inside {
            equilibrium: 0.0,
            stiffness: 0.0,
            damping: 0.0,
            lower: Some(limits.lower),
            upper: Some(limits.upper),
            limit: match self.robot.links[axis].kind() {
                AxisKind::Turning => JointLimit {
                    stiffness: self.limit_stiffness,
                    damping: self.limit_damping,
                    transition: self.limit_transition,
                },
                AxisKind::Sliding => JointLimit {
                    stiffness: self.slide_limit_stiffness,
                    damping: self.slide_limit_damping,
                    transition: self.slide_limit_transition,
                },
            },
        }
    }

    fn axes(&self) -> usize {
        self.robot.links.len()
    }

    fn validate(&self, errors: &mut ParamErrors) {
        errors.take(self.robot.robot("robot"));
        let axes = self.axes();
        if axes > MOST {
            let error = ParamError::new("robot.links", format!("{axes} axes are more than {MOST}"));
            errors.add(error.help("build the arm of Transform, Body and RevoluteJoint"));
        }
        if let Some(AxisPositions(position)) = &self.position {
            if position.len() != axes {
                let error =
                    ParamError::new("position", format!("{} positions for {axes} axes", position.len()));
                errors.add(error.beside(&["robot"]).help("give one for each axis"));
            } else {
                errors.take(of_kinds(position, &self.robot.kinds(), "position"));
            }
        }
        if errors.are_right(&["robot", "position"]) {
            for axis in 0..axes {
                self.inside(axis).validate(
                    Some(self.start(axis)),
                    self.robot.links[axis].kind().si(),
                    errors,
                );
            }
        }
    }
}

fn transform(base: usize, follower: usize, placement: &Placement) -> Element {
    let r = &placement.rotation;
    Element::Transform {
        base,
        follower,
        rotation: [0, 1, 2].map(|i| [r[(i, 0)], r[(i, 1)], r[(i, 2)]]),
        translation: placement.translation.into(),
    }
}

/// What an axis has among the modes of all, which it takes away.
fn own<'a>(inside: &Inside, touches: &mut &'a [f64]) -> &'a [f64] {
    let (own, rest) = touches.split_at(inside.modes());
    *touches = rest;
    own
}

impl Component for Robot {
    fn locate(&mut self, files: &dyn Files) {
        for shape in self.robot.shapes_mut() {
            if let Form::Mesh { file, .. } = &mut shape.form {
                // Only who draws or measures it opens the file.
                *file = files.folder().join(&*file).to_string_lossy().into_owned();
            }
        }
    }

    fn part(&self, _given: &Given) -> Part {
        let axes = self.axes();
        let mut part = Part::new().port("base", Domain::Frame, "where the arm is mounted").port(
            "flange",
            Domain::Frame,
            "where the tool is fixed",
        );
        for (link, axis) in self.robot.links.iter().zip(1..) {
            let domain = match link.kind() {
                AxisKind::Turning => Domain::Rotational,
                AxisKind::Sliding => Domain::Translational,
            };
            part = part.port(&format!("r{axis}"), domain, "rod of the drive side of the axis").port(
                &format!("c{axis}"),
                domain,
                "case of the drive side of the axis",
            );
        }
        let (rod, case) = (|axis: usize| 2 + 2 * axis, |axis: usize| 3 + 2 * axis);
        let inner = 2 + 2 * axes;
        // Inner frames: the seat of each axis, and its link.
        let (seat, link) = (|axis: usize| inner + 2 * axis, |axis: usize| inner + 1 + 2 * axis);
        for axis in 1..=axes {
            part = part
                .inner(&format!("seat{axis}"), Domain::Frame)
                .inner(&format!("link{axis}"), Domain::Frame);
        }
        part = part
            .input(OfAxes::Force.input(&self.robot, "torque", "torques at the joints").default(0.0))
            .output(OfAxes::Position.output(&self.robot, "q", "positions"), Needs::State)
            .output(OfAxes::Speed.output(&self.robot, "w", "speeds"), Needs::State)
            .output(OfAxes::Acceleration.output(&self.robot, "a", "accelerations"), Needs::Motion)
            .output(
                OfAxes::Force.output(&self.robot, "tau", "torques of the actuators: input and drive sides"),
                Needs::Motion,
            );
        for (axis, described) in self.robot.links.iter().enumerate() {
            let origin = described.origin.placement();
            part = part.element(match axis {
                0 => transform(0, seat(0), &(self.robot.base.placement() * origin)),
                _ => transform(link(axis - 1), seat(axis), &origin),
            });
            let moved = Axis::new(NAMES[axis.min(MOST - 1)], unit(described.direction()))
                .driven(rod(axis), case(axis))
                .starting(Some(self.start(axis)), None);
            part = part.element(Element::Joint {
                base: seat(axis),
                follower: link(axis),
                freedoms: vec![match described.kind() {
                    AxisKind::Turning => Freedom::Turn(moved),
                    AxisKind::Sliding => Freedom::Slide(moved),
                }],
            });
            for body in &described.bodies {
                part = body.add_to(part, link(axis));
            }
        }
        if let Some(last) = axes.checked_sub(1) {
            part = part.element(transform(link(last), 1, &self.robot.flange.placement()));
        }
        part = (0..axes).fold(part, |part, axis| self.inside(axis).events(part, &(axis + 1).to_string()));
        part = part.guards_of_state();
        self.robot.load.iter().fold(part, |part, body| body.add_to(part, 1))
    }

    fn joint_torques(&self, c: &Moving, tau: &mut [Torque]) {
        let mut touches = c.d;
        for (axis, ((to, joint), input)) in tau.iter_mut().zip(c.joint).zip(c.input(0)).enumerate() {
            let inside = self.inside(axis);
            *to = inside.torque(joint.q, joint.w, own(&inside, &mut touches));
            to.value += input;
        }
    }

    fn guards_of_state(&self, c: &Moving, g: &mut [f64]) {
        let (joints, mut touches) = (c.joint.iter().enumerate(), c.d);
        joints.fold(0, |first, (axis, joint)| {
            let inside = self.inside(axis);
            first + inside.guards(joint.q, joint.w, own(&inside, &mut touches), &mut g[first..])
        });
    }

    fn jump(&self, c: &Flowing, _x: &mut [f64], d: &mut [f64]) -> bool {
        let (mut changed, mut first) = (false, 0);
        for (axis, joint) in c.joint.iter().enumerate() {
            let inside = self.inside(axis);
            let touches = &mut d[first..first + inside.modes()];
            changed |= inside.settle(joint.q, joint.w, touches);
            first += touches.len();
        }
        changed
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let (axes, mut touches) = (c.joint.iter().zip(c.input(0)).enumerate(), c.d);
        axes.fold(Energy::default(), |sum, (axis, (joint, torque))| {
            let inside = self.inside(axis);
            let own = inside.energy(joint.q, joint.w, own(&inside, &mut touches));
            sum + own + Energy::supplied(torque * joint.w)
        })
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        let n = self.axes();
        for (i, joint) in c.joint.iter().enumerate() {
            (y[i], y[n + i]) = (joint.q, joint.w);
        }
    }

    fn measure_motion(&self, c: &Loaded, y: &mut [f64]) {
        let n = self.axes();
        for (i, (load, input)) in c.joint_load.iter().zip(c.input(0)).enumerate() {
            (y[2 * n + i], y[3 * n + i]) = (load.a, input + load.drive);
        }
    }
}
