//! Limits along a whole move.

use std::fmt;

use blocksim_motion::{AxisKind, AxisLimits};
use blocksim_robot::Robot;
use nalgebra::{DVector, Vector3};

use crate::arm::Arm;
use crate::course::{Course, Narrow, Way, place};
use crate::error::short;

/// What counts as exceeding a limit, relative: above the rounding of the planning.
const TOLERANCE: f64 = 1e-6;
/// Positions may be this far outside, rad or m.
const POSITION_TOLERANCE: f64 = 1e-7;
/// Nearer than this to a singular pose, m and rad, a move does not go without being told.
pub(crate) const NARROW: f64 = 0.01;

/// No axis may move by more from one waypoint to the next, rad or m.
fn jump(kind: AxisKind) -> f64 {
    match kind {
        AxisKind::Turning => 10f64.to_radians(),
        AxisKind::Sliding => 0.1,
    }
}

/// Fewest waypoints in time.
pub(crate) const FEWEST: usize = 500;

/// What is bounded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Position below its lower limit.
    Lower,
    /// Position above its upper limit.
    Upper,
    /// Speed of an axis.
    Speed,
    /// Acceleration of an axis.
    Acceleration,
    /// Change of a position between two waypoints.
    Jump,
    /// Speed of the tool, m/s.
    ToolSpeed,
    /// Smallest singular value of what is prescribed.
    Singularity,
}

/// A limit that a move exceeds, where it does so first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Violation {
    /// What.
    pub quantity: Quantity,
    /// Index of the axis, where it is about one.
    pub axis: Option<usize>,
    /// How this axis moves.
    pub kind: AxisKind,
    /// Time, s.
    pub t: f64,
    /// Share of the time.
    pub share: f64,
    /// Where the tool is on its path, if it follows one.
    pub way: Option<Way>,
    /// Value there.
    pub value: f64,
    /// The value that is furthest beyond on the whole move.
    pub worst: f64,
    /// The limit.
    pub limit: f64,
}

/// What an axis does at most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisExtremes {
    /// Lowest position, rad or m by the kind of its limits.
    pub lowest: f64,
    /// Highest position.
    pub highest: f64,
    /// Largest speed.
    pub speed: f64,
    /// Largest acceleration.
    pub acceleration: f64,
    /// Its limits.
    pub limits: AxisLimits,
}

/// What was found along a move.
#[derive(Debug, Clone, PartialEq)]
pub struct Findings {
    /// Waypoints that were looked at.
    pub waypoints: usize,
    /// Of each axis.
    pub axes: Vec<AxisExtremes>,
    /// Largest speed of the tool, m/s.
    pub tool_speed: f64,
    /// Where the axes are nearest to a singular pose, if the tool follows a path.
    pub narrowest: Option<Narrow>,
    /// Limits that are exceeded, each where it is exceeded first, in the order of time.
    pub violations: Vec<Violation>,
}

/// Looks at a move at its seams and at `waypoints` times at least, equally distant.
pub fn inspect(robot: &Robot, course: &dyn Course, waypoints: usize) -> Findings {
    let limits = robot.limits();
    let duration = course.duration();
    let count = waypoints.max(FEWEST);
    let times = course.times(count);
    let none = |limits: &AxisLimits| AxisExtremes {
        lowest: f64::INFINITY,
        highest: f64::NEG_INFINITY,
        speed: 0.0,
        acceleration: 0.0,
        limits: *limits,
    };
    let kinds: Vec<AxisKind> = limits.iter().map(|limits| limits.kind).collect();
    let mut seen = Seen { course, duration, kinds, violations: Vec::new() };
    let mut axes: Vec<AxisExtremes> = limits.iter().map(none).collect();
    let mut arm = Arm::new(robot);
    let n = course.axes();
    let (mut q, mut v, mut tool_speed) = (vec![0.0; n], DVector::zeros(n), 0.0_f64);
    for (k, t) in times.iter().enumerate() {
        for (i, (extremes, limits)) in axes.iter_mut().zip(&limits).enumerate() {
            let [position, speed, acceleration] = course.at(i, *t);
            if k > 0 {
                seen.see(Quantity::Jump, Some(i), *t, (position - q[i]).abs(), jump(limits.kind), TOLERANCE);
            }
            (q[i], v[i]) = (position, speed);
            extremes.lowest = extremes.lowest.min(position);
            extremes.highest = extremes.highest.max(position);
            extremes.speed = extremes.speed.max(speed.abs());
            extremes.acceleration = extremes.acceleration.max(acceleration.abs());
            seen.see(Quantity::Lower, Some(i), *t, -position, -limits.lower, POSITION_TOLERANCE);
            seen.see(Quantity::Upper, Some(i), *t, position, limits.upper, POSITION_TOLERANCE);
            seen.see(Quantity::Speed, Some(i), *t, speed.abs(), limits.speed, TOLERANCE);
            seen.see(Quantity::Acceleration, Some(i), *t, acceleration.abs(), limits.acceleration, TOLERANCE);
        }
        arm.look(&q);
        let motion = arm.jacobian.rows(3, 3) * &v;
        let speed = Vector3::new(motion[0], motion[1], motion[2]).norm();
        tool_speed = tool_speed.max(speed);
        seen.see(Quantity::ToolSpeed, None, *t, speed, robot.tcp_limits().speed, TOLERANCE);
    }
    let narrowest = course.narrowest();
    if let Some(narrow) = narrowest {
        seen.see(Quantity::Singularity, None, narrow.t, -narrow.margin, -NARROW, 0.0);
    }
    let mut violations = seen.violations;
    for violation in &mut violations {
        if matches!(violation.quantity, Quantity::Lower | Quantity::Singularity) {
            violation.value = -violation.value;
            violation.worst = -violation.worst;
            violation.limit = -violation.limit;
        }
    }
    violations.sort_by(|a, b| a.t.total_cmp(&b.t));
    Findings { waypoints: times.len(), axes, tool_speed, narrowest, violations }
}

struct Seen<'c> {
    course: &'c dyn Course,
    duration: f64,
    kinds: Vec<AxisKind>,
    violations: Vec<Violation>,
}

impl Seen<'_> {
    /// A value that shall not be above a limit.
    fn see(
        &mut self,
        quantity: Quantity,
        axis: Option<usize>,
        t: f64,
        value: f64,
        limit: f64,
        tolerance: f64,
    ) {
        if value <= limit + tolerance * limit.abs().max(1.0) {
            return;
        }
        let known = |v: &&mut Violation| v.quantity == quantity && v.axis == axis;
        match self.violations.iter_mut().find(known) {
            Some(violation) => violation.worst = violation.worst.max(value),
            None => {
                let way = self.course.way(t);
                let share = if self.duration > 0.0 { t / self.duration } else { 0.0 };
                let kind = axis.map(|axis| self.kinds[axis]).unwrap_or_default();
                self.violations.push(Violation {
                    quantity,
                    axis,
                    kind,
                    t,
                    share,
                    way,
                    value,
                    worst: value,
                    limit,
                });
            }
        }
    }
}

impl Violation {
    /// Where in the description of the robot the limit stands; none for those of the planner.
    pub fn source(&self) -> Option<String> {
        let of = |what: &str| self.axis.map(|axis| format!("links[{axis}].limits.{what}"));
        match self.quantity {
            Quantity::Lower => of("lower"),
            Quantity::Upper => of("upper"),
            Quantity::Speed => of("speed"),
            Quantity::Acceleration => of("acceleration"),
            Quantity::ToolSpeed => Some("tcp_limits.speed".into()),
            Quantity::Jump | Quantity::Singularity => None,
        }
    }

    /// What helps. `velocity` is the speed along the path that was asked for, m/s, where there is one.
    pub fn help(&self, velocity: Option<f64>) -> String {
        let ratio = self.limit / self.worst;
        // of a turn on the spot it is not the speed along the path that counts
        let velocity = velocity.filter(|_| !self.way.is_some_and(|way| way.turn));
        match self.quantity {
            Quantity::Lower | Quantity::Upper => {
                "move start or target, choose another orientation, or start in another configuration".into()
            }
            Quantity::Speed | Quantity::ToolSpeed => match velocity {
                Some(v) => format!(
                    "lower the velocity to {} mm/s, or take the profile time-optimal",
                    floor(1e3 * v * ratio)
                ),
                None => format!("lower the velocity to {} % of what it is", floor(100.0 * ratio)),
            },
            Quantity::Acceleration => match velocity {
                Some(_) => format!(
                    "lower the acceleration to {} % of what it is and the velocity to {} %, or take the profile \
                     time-optimal",
                    floor(100.0 * ratio),
                    floor(100.0 * ratio.sqrt())
                ),
                None => format!("lower the acceleration to {} % of what it is", floor(100.0 * ratio)),
            },
            Quantity::Jump | Quantity::Singularity => {
                "start in another configuration, let the tool turn about its axis (tool-axis) or be free"
                    .into()
            }
        }
    }

    /// Its place on the move.
    pub fn place(&self) -> String {
        place(self.t, self.share, self.way)
    }
}

/// Rounded down to three digits, so that the advice is enough.
fn floor(value: f64) -> String {
    let unit = 10f64.powf(value.abs().max(1e-12).log10().floor() - 2.0);
    short((value / unit).floor() * unit)
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let axis = self.axis.map_or(String::new(), |axis| format!("axis {} ", axis + 1));
        write!(f, "{} ", self.place())?;
        let (value, limit, worst) = (self.value, self.limit, self.worst);
        let unit = self.kind.unit();
        let text = |x: f64| self.kind.text(x);
        match self.quantity {
            Quantity::Lower | Quantity::Upper => {
                let end = if self.quantity == Quantity::Lower { "lower" } else { "upper" };
                write!(
                    f,
                    "{axis}leaves its range: {} {unit}, {end} limit {} {unit}, up to {} {unit}",
                    text(value),
                    text(limit),
                    text(worst)
                )
            }
            Quantity::Speed => {
                let moves = match self.kind {
                    AxisKind::Turning => "turns",
                    AxisKind::Sliding => "slides",
                };
                write!(
                    f,
                    "{axis}{moves} with {} {unit}/s, limit {} {unit}/s, up to {} {unit}/s",
                    text(value),
                    text(limit),
                    text(worst)
                )
            }
            Quantity::Acceleration => write!(
                f,
                "{axis}accelerates with {} {unit}/s^2, limit {} {unit}/s^2, up to {} {unit}/s^2",
                text(value),
                text(limit),
                text(worst)
            ),
            Quantity::Jump => write!(
                f,
                "{axis}moves by {} {unit} between two waypoints, limit {} {unit}",
                text(worst),
                text(limit)
            ),
            Quantity::ToolSpeed => write!(
                f,
                "the tool moves with {} mm/s, limit {} mm/s, up to {} mm/s",
                short(1e3 * value),
                short(1e3 * limit),
                short(1e3 * worst)
            ),
            Quantity::Singularity => write!(
                f,
                "the arm is nearly singular: its smallest singular value is {}, limit {}",
                short(value),
                short(limit)
            ),
        }
    }
}
