//! A robot as a set in a diagram or in a file of its own.

use blocksim_block::Shapes;
use blocksim_block::in_unit::{self, AxisValue};
use blocksim_block::physical::Element;
use blocksim_block::prelude::*;
use blocksim_multibody::{Inertia, Placement};
use blocksim_robotics::collision::Rules;
use blocksim_robotics::motion::AxisKind;
use blocksim_robotics::planner::{RobotShapes, Space};
use blocksim_robotics::robot::{Drive, Friction, Link, LinkSolid, Parts, Robot, RobotError, TcpLimits};
use blocksim_scene::Shape;
use serde::de::IgnoredAny;

use crate::motion::Limits;
use crate::motion::limits::of_kind;
use crate::robotics::Surroundings;

/// A robot: links with axes, frames, tool, limits and drives, as one set.
///
/// ```text
/// (
///     name: Text("two links"),
///     links: [
///         (name: Text("upper"), origin: (translation: [0, 0, "0.4 m"]), axis: [0, 1, 0],
///          limits: (lower: "-90 deg", upper: "90 deg", speed: "90 deg/s", acceleration: "200 deg/s^2"),
///          bodies: [(mass: "2 kg", com: [0, 0, "0.2 m"], moi: [...], poi: [...])]),
///     ],
///     flange: (translation: [0, 0, "0.5 m"]),
/// )
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotDescription {
    /// What people call it.
    #[serde(default)]
    pub name: String,
    /// Gravity in the world, m/s^2.
    #[serde(default = "downward", deserialize_with = "in_unit::acceleration_vector")]
    pub gravity: [f64; 3],
    /// The base in the world.
    #[serde(default)]
    pub base: Seat,
    /// What stands still below the first axis, in the base: its shapes can be hit.
    #[serde(default)]
    pub pedestal: Vec<BodyData>,
    /// The frame of targets in the base.
    #[serde(default)]
    pub reference: Seat,
    /// Links from the base on, each with the axis that moves it.
    pub links: Vec<JointLink>,
    /// The flange on the last link.
    #[serde(default)]
    pub flange: Seat,
    /// The tool in the flange.
    #[serde(default)]
    pub tool: Seat,
    /// What is fixed to the flange, in its axes.
    #[serde(default)]
    pub load: Vec<BodyData>,
    /// What the tool centre point can do; no limits if none are given.
    #[serde(default)]
    pub tcp_limits: TcpData,
    /// Pairs of parts that may touch each other, by their names: those of the links, `base` and `tool`.
    #[serde(default)]
    pub may_touch: Vec<[String; 2]>,
}

/// Where a frame is in another.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Seat {
    /// Its origin, m.
    #[serde(default, deserialize_with = "in_unit::point")]
    pub translation: [f64; 3],
    /// Roll, pitch and yaw about the fixed axes x, y and z, rad.
    #[serde(default, deserialize_with = "in_unit::turns")]
    pub rpy: [f64; 3],
}

/// A link with the axis that moves it against the link before.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointLink {
    /// What people call it.
    #[serde(default)]
    pub name: String,
    /// Where the axis is on the link before; the frame of the link is there at position zero.
    #[serde(default)]
    pub origin: Seat,
    /// Direction of the axis about which the link turns, in its frame.
    #[serde(default, deserialize_with = "in_unit::direction_if_given")]
    pub axis: Option<[f64; 3]>,
    /// Direction in which the link slides, in its frame; in the place of `axis`.
    #[serde(default, deserialize_with = "in_unit::direction_if_given")]
    pub slide: Option<[f64; 3]>,
    /// What the axis can do.
    pub limits: Limits,
    /// Position at the start, rad or m.
    #[serde(default, deserialize_with = "in_unit::axis_position")]
    pub start: AxisValue,
    /// What the link consists of, in its frame.
    #[serde(default)]
    pub bodies: Vec<BodyData>,
    /// Motor, gear and bearing.
    #[serde(default)]
    pub drive: DriveData,
}

/// Mass properties of a rigid body, and its shapes, which are drawn and can collide, but say nothing of its dynamics.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyData {
    /// Mass, kg.
    #[serde(deserialize_with = "in_unit::mass")]
    pub mass: f64,
    /// Centre of mass, m.
    #[serde(deserialize_with = "in_unit::point")]
    pub com: [f64; 3],
    /// Ixx, Iyy, Izz about the centre of mass, kg*m^2.
    #[serde(deserialize_with = "in_unit::moments")]
    pub moi: [f64; 3],
    /// Iyz, Izx, Ixy about the centre of mass, kg*m^2.
    #[serde(default, deserialize_with = "in_unit::moments")]
    pub poi: [f64; 3],
    #[serde(default, rename = "shape")]
    _shape: Unread,
    /// What it looks like, in the frame of the link; written as in the block `Body`.
    #[serde(default)]
    pub shapes: Shapes,
}

/// A member that may be there and is not read.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Unread;

impl<'de> Deserialize<'de> for Unread {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        IgnoredAny::deserialize(deserializer).map(|_| Unread)
    }
}

/// The drive of an axis: motor, gear and bearing; what is not given adds nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveData {
    /// Rotor.
    #[serde(default)]
    pub motor: MotorData,
    /// Gear between motor and joint.
    #[serde(default)]
    pub gear: GearData,
    /// Friction of the bearing of the joint.
    #[serde(default)]
    pub bearing: BearingData,
}

/// The rotor of a motor, at its own speed.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotorData {
    /// Moment of inertia, kg*m^2.
    #[serde(deserialize_with = "in_unit::inertia")]
    pub inertia: f64,
    /// Viscous damping, N*m*s/rad.
    #[serde(default, deserialize_with = "in_unit::damping")]
    pub damping: f64,
    /// Largest torque, N*m; without it moves are not checked for what the motor has to give.
    #[serde(default, deserialize_with = "in_unit::torque_if_given")]
    pub torque: Option<f64>,
}

/// A gear: its reduction, or the teeth of a cycloidal drive, and its losses. Where the axis slides, a screw or a rack with
/// a `lead` makes travel of turns.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GearData {
    /// Speed of the motor over speed of the joint.
    #[serde(default)]
    pub ratio: Option<f64>,
    /// Lobes of the disc of a cycloidal drive.
    #[serde(default)]
    pub disc_teeth: Option<u32>,
    /// Pins of its ring; more than lobes.
    #[serde(default)]
    pub ring_teeth: Option<u32>,
    /// Travel of an axis that slides for one turn behind the reduction, m.
    #[serde(default, deserialize_with = "in_unit::length_if_given")]
    pub lead: Option<f64>,
    /// Share of the power that passes where the motor drives.
    #[serde(default = "one", deserialize_with = "in_unit::share")]
    pub efficiency_forward: f64,
    /// Share that passes where the joint drives the motor.
    #[serde(default = "one", deserialize_with = "in_unit::share")]
    pub efficiency_backward: f64,
    /// Moment of inertia at the motor, kg*m^2.
    #[serde(default, deserialize_with = "in_unit::inertia")]
    pub inertia: f64,
    /// Speed of the motor over which the losses set in, rad/s.
    #[serde(default = "one", deserialize_with = "in_unit::speed")]
    pub threshold: f64,
}

impl Default for GearData {
    fn default() -> Self {
        GearData {
            ratio: None,
            disc_teeth: None,
            ring_teeth: None,
            lead: None,
            efficiency_forward: 1.0,
            efficiency_backward: 1.0,
            inertia: 0.0,
            threshold: 1.0,
        }
    }
}

/// Friction of a bearing, as of the block `RotationalFriction`; of an axis that slides as of `TranslationalFriction`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BearingData {
    /// Breakaway torque, N*m, or force, N.
    #[serde(deserialize_with = "in_unit::axis_force")]
    pub breakaway: AxisValue,
    /// Speed of the breakaway torque, rad/s or m/s.
    #[serde(deserialize_with = "in_unit::axis_speed")]
    pub breakaway_velocity: AxisValue,
    /// Coulomb torque, N*m, or force, N.
    #[serde(deserialize_with = "in_unit::axis_force")]
    pub coulomb: AxisValue,
    /// Viscous coefficient, N*m*s/rad or N*s/m.
    #[serde(deserialize_with = "in_unit::axis_damping")]
    pub viscous: AxisValue,
}

/// What the tool centre point can do.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TcpData {
    /// Largest speed, m/s.
    #[serde(deserialize_with = "in_unit::velocity")]
    pub speed: f64,
    /// Largest acceleration, m/s^2.
    #[serde(deserialize_with = "in_unit::point_acceleration")]
    pub acceleration: f64,
}

impl Default for TcpData {
    fn default() -> Self {
        TcpData { speed: f64::INFINITY, acceleration: f64::INFINITY }
    }
}

fn downward() -> [f64; 3] {
    [0.0, 0.0, -blocksim_multibody::STANDARD_GRAVITY]
}

fn one() -> f64 {
    1.0
}

impl RobotDescription {
    /// All shapes of the bodies.
    pub(super) fn shapes_mut(&mut self) -> impl Iterator<Item = &mut Shape> {
        let links = self.links.iter_mut().flat_map(|link| &mut link.bodies);
        let bodies = links.chain(&mut self.load).chain(&mut self.pedestal);
        bodies.flat_map(|body| &mut body.shapes.0)
    }

    /// How the axes move.
    pub fn kinds(&self) -> Vec<AxisKind> {
        self.links.iter().map(JointLink::kind).collect()
    }

    /// The robot.
    ///
    /// # Errors
    /// A member that makes no robot, with its path below `param` and a remedy.
    pub fn robot(&self, param: &str) -> Result<Robot, ParamError> {
        self.parts(param).and_then(|parts| Robot::new(parts).map_err(|error| refusal(param, &error)))
    }

    /// The shapes of its parts.
    pub fn shapes(&self) -> RobotShapes {
        let of = |bodies: &[BodyData]| bodies.iter().flat_map(|body| body.shapes.0.clone()).collect();
        RobotShapes {
            base: of(&self.pedestal),
            links: self.links.iter().map(|link| of(&link.bodies)).collect(),
            tool: of(&self.load),
        }
    }

    /// What can collide: the robot, and what stands around it; `None` where the robot has no shapes and nothing surrounds it.
    ///
    /// # Errors
    /// Surroundings that make no sense, and pairs that may touch of which there is no such part; `param` is the path of the
    /// surroundings.
    pub fn space(
        &self,
        robot: &Robot,
        around: Option<&Surroundings>,
        param: &str,
    ) -> Result<Option<Space>, ParamError> {
        let shapes = self.shapes();
        let none = RobotShapes { links: vec![Vec::new(); shapes.links.len()], ..RobotShapes::default() };
        if shapes == none && around.is_none() {
            return Ok(None);
        }
        let nothing = Surroundings::default();
        let around = around.unwrap_or(&nothing);
        let may_touch = [&self.may_touch[..], &around.may_touch].concat();
        let things = around.space(param)?;
        let space =
            Space::new(robot, &shapes, &things, &Rules { may_touch: may_touch.clone(), ..Rules::default() });
        let names = space.names();
        if let Some(unknown) = may_touch.iter().flatten().find(|name| !names.contains(&name.as_str())) {
            let message = format!("there is no part `{unknown}` with shapes");
            let choose = format!("choose {}", names.join(", "));
            return Err(ParamError::new("may_touch", message).help(choose));
        }
        Ok(Some(space))
    }

    fn parts(&self, param: &str) -> Result<Parts, ParamError> {
        let last = self.links.len().saturating_sub(1);
        let mut links = Vec::new();
        for (i, link) in self.links.iter().enumerate() {
            let mut solids = Vec::new();
            for (k, body) in link.bodies.iter().enumerate() {
                solids.push(body.solid(Placement::identity(), &format!("{param}.links[{i}].bodies[{k}]"))?);
            }
            if i == last {
                for (k, body) in self.load.iter().enumerate() {
                    solids.push(body.solid(self.flange.placement(), &format!("{param}.load[{k}]"))?);
                }
            }
            links.push(link.link(solids, &format!("axis {}", i + 1), &format!("{param}.links[{i}]"))?);
        }
        let TcpData { speed, acceleration } = self.tcp_limits;
        Ok(Parts {
            name: self.name.clone(),
            gravity: self.gravity,
            base: self.base.placement(),
            reference: self.reference.placement(),
            links,
            flange: self.flange.placement(),
            tool: self.tool.placement(),
            tcp_limits: TcpLimits { speed, acceleration },
        })
    }
}

fn refusal(param: &str, error: &RobotError) -> ParamError {
    let refused = ParamError::new(format!("{param}.{}", error.member()), error.to_string());
    match error {
        RobotError::NoLinks => refused.help("give at least one link with an axis"),
        _ => refused.help(format!("correct `{}` in the description of the robot", error.member())),
    }
}

impl JointLink {
    /// Whether its axis turns or slides.
    pub fn kind(&self) -> AxisKind {
        if self.slide.is_some() { AxisKind::Sliding } else { AxisKind::Turning }
    }

    /// Direction of the axis in the frame of the link; zero where none is given.
    pub fn direction(&self) -> [f64; 3] {
        self.axis.or(self.slide).unwrap_or_default()
    }

    /// Speed of the motor over that of the joint: turns for turns, or rad for metres.
    ///
    /// # Errors
    /// A gear that has none.
    pub fn transmission(&self, path: &str) -> Result<f64, ParamError> {
        self.drive.gear.transmission(self.kind(), path)
    }

    fn link(&self, solids: Vec<LinkSolid>, what: &str, path: &str) -> Result<Link, ParamError> {
        if self.axis.is_some() == self.slide.is_some() {
            let fact = if self.axis.is_some() { "both turns and slides" } else { "neither turns nor slides" };
            return Err(ParamError::new(path, format!("{what} {fact}"))
                .help("give `axis`, about which it turns, or `slide`, along which it slides"));
        }
        let kind = self.kind();
        // The unit of one of them stands for all.
        let unit = AxisValue { value: 0.0, slides: self.limits.slides };
        of_kind(unit, kind, what, &format!("{path}.limits"))?;
        Ok(Link {
            name: self.name.clone(),
            origin: self.origin.placement(),
            axis: self.direction(),
            limits: self.limits.of(kind),
            start: of_kind(self.start, kind, what, &format!("{path}.start"))?,
            solids,
            drive: self.drive.drive(kind, what, &format!("{path}.drive"))?,
        })
    }
}

impl Seat {
    /// As a placement.
    pub fn placement(&self) -> Placement {
        Placement::from_rpy(self.translation, self.rpy)
    }
}

impl BodyData {
    /// The body at a frame of a component.
    fn element(&self, frame: usize) -> Element {
        Element::Body { frame, mass: self.mass, com: self.com, moi: self.moi, poi: self.poi }
    }

    /// Body and shapes at a frame of a component.
    pub(super) fn add_to(&self, part: Part, frame: usize) -> Part {
        self.shapes
            .0
            .iter()
            .fold(part, |part, shape| part.shape(frame, shape.clone()))
            .element(self.element(frame))
    }

    fn solid(&self, placement: Placement, path: &str) -> Result<LinkSolid, ParamError> {
        match Inertia::from_moments(self.mass, self.com, self.moi, self.poi) {
            Ok(inertia) => Ok(LinkSolid { placement, inertia }),
            Err(error) => Err(ParamError::new(path, error.to_string())
                .help("moi are Ixx, Iyy, Izz, poi are Iyz, Izx, Ixy of the tensor about the centre of mass")),
        }
    }
}

impl GearData {
    /// Speed of the motor over speed of the joint; 1 without a gear.
    fn reduction(&self, path: &str) -> Result<f64, ParamError> {
        match (self.ratio, self.disc_teeth, self.ring_teeth) {
            (None, None, None) => Ok(1.0),
            (Some(ratio), None, None) if ratio != 0.0 && ratio.is_finite() => Ok(ratio),
            (Some(ratio), None, None) => {
                Err(ParamError::new(path, format!("the ratio {ratio} is no reduction")).help("give e.g. 121"))
            }
            (None, Some(disc), Some(ring)) if ring > disc && disc > 0 => {
                Ok(f64::from(disc) / f64::from(ring - disc))
            }
            (None, Some(disc), Some(ring)) => {
                Err(ParamError::new(path, format!("{disc} lobes and {ring} pins give no reduction"))
                    .help("a disc has at least one lobe, its ring more pins than it has lobes"))
            }
            _ => Err(ParamError::new(path, "a gear has a ratio, or the teeth of disc and ring")
                .help("give `ratio`, or `disc_teeth` and `ring_teeth`")),
        }
    }
}

impl GearData {
    /// Turns of the motor for a turn of the joint, or rad of the motor for a metre.
    fn transmission(&self, kind: AxisKind, path: &str) -> Result<f64, ParamError> {
        let ratio = self.reduction(path)?;
        match (kind, self.lead) {
            (AxisKind::Turning, None) => Ok(ratio),
            (AxisKind::Turning, Some(_)) => {
                Err(ParamError::new(format!("{path}.lead"), "an axis that turns has no lead")
                    .help("leave it out, or give the link `slide` in the place of `axis`"))
            }
            (AxisKind::Sliding, Some(lead)) if lead > 0.0 && lead.is_finite() => {
                Ok(ratio * std::f64::consts::TAU / lead)
            }
            (AxisKind::Sliding, Some(lead)) => {
                Err(ParamError::new(format!("{path}.lead"), format!("a lead of {lead} m moves nothing"))
                    .help("give the travel for one turn, such as 10 mm"))
            }
            (AxisKind::Sliding, None) => {
                Err(ParamError::new(format!("{path}.lead"), "a motor that moves a slide needs a lead")
                    .help("give the travel for one turn of screw or pinion, such as lead: \"10 mm\""))
            }
        }
    }
}

impl DriveData {
    /// All counted at the joint.
    fn drive(&self, kind: AxisKind, what: &str, path: &str) -> Result<Drive, ParamError> {
        let number =
            |value: AxisValue, member: &str| of_kind(value, kind, what, &format!("{path}.bearing.{member}"));
        let friction = Friction {
            breakaway: number(self.bearing.breakaway, "breakaway")?,
            breakaway_velocity: number(self.bearing.breakaway_velocity, "breakaway_velocity")?,
            coulomb: number(self.bearing.coulomb, "coulomb")?,
            viscous: number(self.bearing.viscous, "viscous")?,
        };
        if self.motor == MotorData::default() && self.gear == GearData::default() {
            return Ok(Drive { friction, ..Drive::default() });
        }
        let ratio = self.gear.transmission(kind, &format!("{path}.gear"))?;
        Ok(Drive {
            inertia: (self.motor.inertia + self.gear.inertia) * ratio * ratio,
            damping: self.motor.damping * ratio * ratio,
            friction,
            efficiency_forward: self.gear.efficiency_forward,
            efficiency_backward: self.gear.efficiency_backward,
            threshold: self.gear.threshold / ratio.abs(),
            limit: self.motor.torque.map_or(f64::INFINITY, |torque| torque * ratio.abs()),
        })
    }
}
