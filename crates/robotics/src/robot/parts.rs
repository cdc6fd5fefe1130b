//! What a robot is made of.

use crate::motion::AxisLimits;
use crate::robot::drive::Drive;
use crate::robot::error::RobotError;
use blocksim_multibody::{Inertia, Placement};

/// A robot before it is assembled.
#[derive(Debug, Clone, PartialEq)]
pub struct Parts {
    /// What people call it.
    pub name: String,
    /// Gravity in the world, m/s².
    pub gravity: [f64; 3],
    /// The base in the world.
    pub base: Placement,
    /// The frame of targets, in the base.
    pub reference: Placement,
    /// Links from the base on, each with the axis that moves it against the one before.
    pub links: Vec<Link>,
    /// The flange on the last link.
    pub flange: Placement,
    /// The tool in the flange.
    pub tool: Placement,
    /// What the tool centre point can do.
    pub tcp_limits: TcpLimits,
}

/// A link and the axis before it.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// What people call it.
    pub name: String,
    /// Where its axis is on the link before, at position zero; its own frame is there, too.
    pub origin: Placement,
    /// Direction of the axis in the frame of the link, about which it turns or along which it slides; the length does
    /// not matter.
    pub axis: [f64; 3],
    /// What the axis can do, and whether it turns or slides.
    pub limits: AxisLimits,
    /// Position at the start, rad or m.
    pub start: f64,
    /// Bodies that the link consists of.
    pub solids: Vec<LinkSolid>,
    /// The drive of the axis.
    pub drive: Drive,
}

/// A rigid body that is fixed to a link.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkSolid {
    /// The frame of its inertia on the link.
    pub placement: Placement,
    /// Its mass properties.
    pub inertia: Inertia,
}

/// What the tool centre point can do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TcpLimits {
    /// Largest speed, m/s; positive, may be infinite.
    pub speed: f64,
    /// Largest acceleration, m/s²; positive, may be infinite.
    pub acceleration: f64,
}

impl Parts {
    /// Whether all numbers make sense that the mechanism does not check.
    pub(crate) fn check(&self) -> Result<(), RobotError> {
        if self.links.is_empty() {
            return Err(RobotError::NoLinks);
        }
        let frames = [
            ("base", &self.base),
            ("reference", &self.reference),
            ("flange", &self.flange),
            ("tool", &self.tool),
        ];
        for (member, placement) in frames {
            let numbers = placement.rotation.iter().chain(placement.translation.iter());
            if !numbers.into_iter().all(|number| number.is_finite()) {
                return Err(RobotError::NotFinite { member });
            }
        }
        if !self.gravity.iter().all(|g| g.is_finite()) {
            return Err(RobotError::NotFinite { member: "gravity" });
        }
        let TcpLimits { speed, acceleration } = self.tcp_limits;
        for (member, value) in [("tcp_limits.speed", speed), ("tcp_limits.acceleration", acceleration)] {
            // Written so that a NaN fails.
            let positive = value > 0.0;
            if !positive {
                return Err(RobotError::TcpLimit { member, value });
            }
        }
        self.links.iter().enumerate().try_for_each(|(i, link)| link.check(i))
    }
}

impl Link {
    fn check(&self, link: usize) -> Result<(), RobotError> {
        let fail = |member, message| Err(RobotError::Number { link, member, message });
        let AxisLimits { kind, lower, upper, speed, acceleration } = self.limits;
        let unit = kind.si();
        let ordered = lower < upper;
        if !ordered {
            return fail(
                "limits.upper",
                format!("the upper limit {upper} {unit} is not above the lower, {lower} {unit}"),
            );
        }
        for (member, value) in [("limits.speed", speed), ("limits.acceleration", acceleration)] {
            let positive = value > 0.0;
            if !positive {
                return fail(member, format!("`{member}` is {value}; it must be positive"));
            }
        }
        let inside = (lower..=upper).contains(&self.start);
        if !inside {
            let message =
                format!("the axis starts at {} {unit}, outside {lower} {unit} to {upper} {unit}", self.start);
            return fail("start", message);
        }
        let drive = &self.drive;
        let friction = &drive.friction;
        let not_negative = [
            ("drive.inertia", drive.inertia),
            ("drive.damping", drive.damping),
            ("drive.gear.threshold", drive.threshold),
            ("drive.bearing.breakaway_velocity", friction.breakaway_velocity),
            ("drive.bearing.coulomb", friction.coulomb),
            ("drive.bearing.viscous", friction.viscous),
        ];
        for (member, value) in not_negative {
            let allowed = value >= 0.0 && value.is_finite();
            if !allowed {
                return fail(member, format!("`{member}` is {value}; it must be zero or positive"));
            }
        }
        let above_coulomb = friction.breakaway >= friction.coulomb && friction.breakaway.is_finite();
        if !above_coulomb {
            let message = format!(
                "the breakaway torque {} is below the Coulomb torque {}",
                friction.breakaway, friction.coulomb
            );
            return fail("drive.bearing.breakaway", message);
        }
        if friction.breakaway > 0.0 && friction.breakaway_velocity == 0.0 {
            let message = "dry friction needs a breakaway velocity above zero".to_owned();
            return fail("drive.bearing.breakaway_velocity", message);
        }
        for (member, value) in [
            ("drive.gear.efficiency_forward", drive.efficiency_forward),
            ("drive.gear.efficiency_backward", drive.efficiency_backward),
        ] {
            let allowed = value > 0.0 && value <= 1.0;
            if !allowed {
                return fail(member, format!("`{member}` is {value}; it must be above 0 and at most 1"));
            }
        }
        let positive = drive.limit > 0.0;
        if !positive {
            let message = format!("`drive.motor.torque` is {}; it must be positive", drive.limit);
            return fail("drive.motor.torque", message);
        }
        Ok(())
    }
}
