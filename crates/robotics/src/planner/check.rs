//! Limits along a whole move.

use std::fmt;

use crate::motion::{AxisKind, AxisLimits};
use crate::robot::Robot;
use blocksim_multibody::Data;
use nalgebra::{DMatrix, Vector3};

use crate::planner::arm::Arm;
use crate::planner::course::{Course, Narrow, Spot, State, Way};
use crate::planner::error::short;

/// What counts as exceeding a limit, relative: above the rounding of the planning.
const TOLERANCE: f64 = 1e-6;
/// Positions may be this far outside, rad or m.
const POSITION_TOLERANCE: f64 = 1e-7;
/// Nearer than this to a singular pose, m and rad, a move does not go without being told, unless another threshold is chosen.
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
    /// Torque (N m) or force (N) of a motor, counted at the joint.
    Torque,
    /// Speed of the tool, m/s.
    ToolSpeed,
    /// Acceleration of the tool, m/s²: along its path and across it together.
    ToolAcceleration,
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
    /// Where.
    pub spot: Spot,
    /// How many times longer the move takes there than its velocity asks for.
    pub stretched: f64,
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
    /// What its motor gives at most.
    pub torque: Option<Effort>,
    /// Its limits.
    pub limits: AxisLimits,
}

/// The largest torque of a motor on a move, counted at the joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Its size, N m; of an axis that slides the force, N.
    pub largest: f64,
    /// When it is needed, s.
    pub t: f64,
    /// What the motor can give, N m or N.
    pub limit: f64,
}

/// How a move is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scrutiny {
    /// Times at which it is looked at, at least; equally distant.
    pub waypoints: usize,
    /// Smallest singular value of what is prescribed, m and rad, that a move may come to.
    pub narrow: f64,
}

impl Scrutiny {
    /// At these many times at least.
    pub fn at(waypoints: usize) -> Self {
        Scrutiny { waypoints, ..Scrutiny::default() }
    }
}

impl Default for Scrutiny {
    fn default() -> Self {
        Scrutiny { waypoints: 2000, narrow: NARROW }
    }
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
    /// Largest acceleration of the tool, m/s².
    pub tool_acceleration: f64,
    /// Largest angular velocity of the tool, rad/s.
    pub tool_turning: f64,
    /// Where the axes are nearest to a singular pose, if the tool follows a path.
    pub narrowest: Option<Narrow>,
    /// Limits that are exceeded, each where it is exceeded first, in the order of time.
    pub violations: Vec<Violation>,
}

/// Looks at a move on both sides of its seams, where the acceleration may jump, at many times between, and closer where something is
/// largest.
///
/// The acceleration of the tool is $\ddot x = J \ddot q + \dot J \dot q$; torques are those of the inverse dynamics with what the
/// drives need for themselves ([`Robot::motor_torques`]), of axes whose motors have a limit.
pub fn inspect(robot: &Robot, course: &dyn Course, scrutiny: &Scrutiny) -> Findings {
    let mut look = Look::new(robot, course);
    let times = looks(course, scrutiny.waypoints.max(FEWEST));
    let mut before: Option<Vec<f64>> = None;
    let mut sizes = Vec::with_capacity(times.len());
    for t in &times {
        sizes.push(look.at(*t));
        if let Some(before) = before.replace(look.q.clone()) {
            look.jumps(*t, &before);
        }
    }
    let mut waypoints = times.len();
    let quantities = sizes.first().map_or(0, Vec::len);
    for quantity in 0..quantities {
        for k in tops(&sizes, quantity) {
            let (from, to) = (times[k.saturating_sub(1)], times[(k + 1).min(times.len() - 1)]);
            waypoints += look.closer(quantity, from, to);
        }
    }
    let narrowest = course.narrowest();
    if let Some(narrow) = narrowest {
        let margin = -narrow.margin;
        look.seen.see(Quantity::Singularity, None, narrow.t, margin, -scrutiny.narrow, 0.0);
    }
    let Look { axes, tool: [tool_speed, tool_acceleration, tool_turning], seen, .. } = look;
    let violations = seen.all();
    Findings { waypoints, axes, tool_speed, tool_acceleration, tool_turning, narrowest, violations }
}

/// Where a quantity has its highest tops, of those that may be the highest between what was looked at.
fn tops(sizes: &[Vec<f64>], quantity: usize) -> Vec<usize> {
    /// Tops that are nearly as high may be higher between two looks.
    const NEARLY: f64 = 0.9;
    /// What trembles has many.
    const MOST: usize = 6;
    let (count, size) = (sizes.len(), |k: usize| sizes[k][quantity]);
    let highest = (0..count).map(&size).fold(0.0, f64::max);
    let is_top = |k: &usize| {
        let here = size(*k);
        let sides = [k.checked_sub(1), Some(k + 1).filter(|next| *next < count)].map(|at| at.map(&size));
        // On level ground nothing is higher in between.
        here > 0.0
            && here >= NEARLY * highest
            && sides.iter().flatten().all(|side| *side <= here)
            && sides.iter().flatten().any(|side| *side < here)
    };
    let mut found: Vec<usize> = (0..count).filter(is_top).collect();
    found.sort_by(|a, b| size(*b).total_cmp(&size(*a)));
    found.truncate(MOST);
    found
}

/// A robot that is looked at while it moves, and what was found.
struct Look<'c> {
    robot: &'c Robot,
    course: &'c dyn Course,
    limits: Vec<AxisLimits>,
    arm: Arm<'c>,
    data: Data,
    /// Positions, speeds, accelerations and torques of the axes at the last time.
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    tau: Vec<f64>,
    axes: Vec<AxisExtremes>,
    /// Largest speed, acceleration and angular velocity of the tool.
    tool: [f64; 3],
    seen: Seen<'c>,
}

impl<'c> Look<'c> {
    fn new(robot: &'c Robot, course: &'c dyn Course) -> Self {
        let limits = robot.limits();
        let kinds: Vec<AxisKind> = limits.iter().map(|limits| limits.kind).collect();
        let axes =
            limits.iter().zip(robot.drives()).map(|(limits, drive)| none(limits, drive.limit)).collect();
        let none = vec![0.0; course.axes()];
        Look {
            robot,
            course,
            arm: Arm::new(robot),
            data: robot.model().data(),
            q: none.clone(),
            v: none.clone(),
            a: none.clone(),
            tau: none,
            axes,
            limits,
            tool: [0.0; 3],
            seen: Seen { course, kinds, violations: Vec::new() },
        }
    }

    /// Looks at one time. Returns the sizes of all that may be too large: of the axes positions to both sides, speeds, accelerations and
    /// torques, of the tool speed, acceleration and angular velocity.
    fn at(&mut self, t: f64) -> Vec<f64> {
        let n = self.course.axes();
        let mut sizes = Vec::with_capacity(5 * n + 3);
        for (i, (extremes, limits)) in self.axes.iter_mut().zip(&self.limits).enumerate() {
            let state @ [position, speed, acceleration] = self.course.at(i, t);
            (self.q[i], self.v[i], self.a[i]) = (position, speed, acceleration);
            extremes.lowest = extremes.lowest.min(position);
            extremes.highest = extremes.highest.max(position);
            extremes.speed = extremes.speed.max(speed.abs());
            extremes.acceleration = extremes.acceleration.max(acceleration.abs());
            self.seen.axis(i, t, state, limits);
            sizes.extend([-position, position, speed.abs(), acceleration.abs()]);
        }
        self.arm.look_moving(&self.q, &self.v);
        let of_tool = |matrix: &DMatrix<f64>, by: &[f64], rows: usize| -> Vector3<f64> {
            let sum = |row: usize| (0..n).map(|i| matrix[(rows + row, i)] * by[i]).sum();
            Vector3::new(sum(0), sum(1), sum(2))
        };
        let arm = &self.arm;
        let speed = of_tool(&arm.jacobian, &self.v, 3).norm();
        let acceleration = (of_tool(&arm.jacobian, &self.a, 3) + of_tool(&arm.slope, &self.v, 3)).norm();
        let tool = [speed, acceleration, of_tool(&arm.jacobian, &self.v, 0).norm()];
        self.tool.iter_mut().zip(tool).for_each(|(largest, now)| *largest = largest.max(now));
        sizes.extend(tool);
        let limits = self.robot.tcp_limits();
        self.seen.see(Quantity::ToolSpeed, None, t, speed, limits.speed, TOLERANCE);
        self.seen.see(Quantity::ToolAcceleration, None, t, acceleration, limits.acceleration, TOLERANCE);
        if self.axes.iter().any(|axis| axis.torque.is_some()) {
            self.robot.motor_torques(&mut self.data, &self.q, &self.v, &self.a, &mut self.tau);
            for (i, extremes) in self.axes.iter_mut().enumerate() {
                let Some(effort) = &mut extremes.torque else { continue };
                let size = self.tau[i].abs();
                if size > effort.largest {
                    (effort.largest, effort.t) = (size, t);
                }
                self.seen.see(Quantity::Torque, Some(i), t, size, effort.limit, TOLERANCE);
                sizes.push(size);
            }
        }
        sizes
    }

    /// Whether an axis has jumped since it was at `before`.
    fn jumps(&mut self, t: f64, before: &[f64]) {
        for (i, before) in before.iter().enumerate() {
            let way = (self.q[i] - before).abs();
            self.seen.see(Quantity::Jump, Some(i), t, way, jump(self.limits[i].kind), TOLERANCE);
        }
    }

    /// Looks closer at where a quantity is largest between two times; returns at how many times.
    fn closer(&mut self, quantity: usize, mut from: f64, mut to: f64) -> usize {
        const PARTS: u32 = 8;
        const ROUNDS: usize = 3;
        for _ in 0..ROUNDS {
            let at = |k: u32| from + (to - from) * f64::from(k) / f64::from(PARTS);
            let mut best = (f64::NEG_INFINITY, 0);
            for k in 0..=PARTS {
                let size = self.at(at(k))[quantity];
                if size > best.0 {
                    best = (size, k);
                }
            }
            (from, to) = (at(best.1.saturating_sub(1)), at((best.1 + 1).min(PARTS)));
        }
        ROUNDS * (PARTS as usize + 1)
    }
}

/// Limits of the axes that a move exceeds.
pub(crate) fn axes_alone(limits: &[AxisLimits], course: &dyn Course, scrutiny: &Scrutiny) -> Vec<Violation> {
    let kinds = limits.iter().map(|limits| limits.kind).collect();
    let mut seen = Seen { course, kinds, violations: Vec::new() };
    for t in looks(course, scrutiny.waypoints.max(FEWEST)) {
        for (i, limits) in limits.iter().enumerate().take(course.axes()) {
            seen.axis(i, t, course.at(i, t), limits);
        }
    }
    seen.all()
}

/// Times at which a move is looked at: equally distant ones, seams, and just before each seam.
fn looks(course: &dyn Course, count: usize) -> Vec<f64> {
    // Far above the rounding of a time, and far below what a joint moves in.
    let instant = 1e-12 * course.duration();
    let mut times = course.times(count);
    times.extend(course.seams().iter().map(|seam| (seam - instant).max(0.0)));
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

/// An axis of which nothing was seen.
fn none(limits: &AxisLimits, effort: f64) -> AxisExtremes {
    AxisExtremes {
        lowest: f64::INFINITY,
        highest: f64::NEG_INFINITY,
        speed: 0.0,
        acceleration: 0.0,
        torque: effort.is_finite().then_some(Effort { largest: 0.0, t: 0.0, limit: effort }),
        limits: *limits,
    }
}

struct Seen<'c> {
    course: &'c dyn Course,
    kinds: Vec<AxisKind>,
    violations: Vec<Violation>,
}

impl Seen<'_> {
    /// An axis at a time.
    fn axis(&mut self, i: usize, t: f64, [position, speed, acceleration]: State, limits: &AxisLimits) {
        self.see(Quantity::Lower, Some(i), t, -position, -limits.lower, POSITION_TOLERANCE);
        self.see(Quantity::Upper, Some(i), t, position, limits.upper, POSITION_TOLERANCE);
        self.see(Quantity::Speed, Some(i), t, speed.abs(), limits.speed, TOLERANCE);
        self.see(Quantity::Acceleration, Some(i), t, acceleration.abs(), limits.acceleration, TOLERANCE);
    }

    /// What was found, in the order of time.
    fn all(self) -> Vec<Violation> {
        let mut violations = self.violations;
        for violation in &mut violations {
            if matches!(violation.quantity, Quantity::Lower | Quantity::Singularity) {
                violation.value = -violation.value;
                violation.worst = -violation.worst;
                violation.limit = -violation.limit;
            }
        }
        violations.sort_by(|a, b| a.spot.t.total_cmp(&b.spot.t));
        violations
    }

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
                let spot = Spot::of(self.course, t);
                let kind = axis.map(|axis| self.kinds[axis]).unwrap_or_default();
                let stretched = self.course.stretched(t);
                let worst = value;
                let found = Violation { quantity, axis, kind, spot, stretched, value, worst, limit };
                self.violations.push(found);
            }
        }
    }
}

impl Violation {
    /// A word for programs.
    pub fn code(&self) -> &'static str {
        match self.quantity {
            Quantity::Lower | Quantity::Upper => "axis_range",
            Quantity::Speed => "axis_speed",
            Quantity::Acceleration => "axis_acceleration",
            Quantity::Torque => "axis_torque",
            Quantity::Jump => "axis_jump",
            Quantity::ToolSpeed => "tool_speed",
            Quantity::ToolAcceleration => "tool_acceleration",
            Quantity::Singularity => "singular",
        }
    }

    /// Where in the description of the robot the limit stands; none for those of the planner.
    pub fn source(&self) -> Option<String> {
        let of = |what: &str| self.axis.map(|axis| format!("links[{axis}].{what}"));
        match self.quantity {
            Quantity::Lower => of("limits.lower"),
            Quantity::Upper => of("limits.upper"),
            Quantity::Speed => of("limits.speed"),
            Quantity::Acceleration => of("limits.acceleration"),
            Quantity::Torque => of("drive.motor.torque"),
            Quantity::ToolSpeed => Some("tcp_limits.speed".into()),
            Quantity::ToolAcceleration => Some("tcp_limits.acceleration".into()),
            Quantity::Jump | Quantity::Singularity => None,
        }
    }

    /// What helps. `velocity` is the speed along the path that was asked for, m/s, where there is one.
    pub fn help(&self, velocity: Option<f64>) -> String {
        let ratio = self.limit / self.worst;
        let (share, root) = (floor(100.0 * ratio), floor(100.0 * ratio.sqrt()));
        match self.quantity {
            Quantity::Lower | Quantity::Upper => {
                "move start or target, choose another orientation, or start in another configuration".into()
            }
            Quantity::Speed | Quantity::ToolSpeed => match (self.spot.way, velocity) {
                (Some(Way { turn: true, .. }), _) => {
                    format!("lower `rotation_velocity` to {share} % of what it is")
                }
                (Some(_), Some(v)) => format!(
                    "lower the velocity to {} mm/s, or take the profile time-optimal",
                    floor(1e3 * v * ratio)
                ),
                (Some(_), None) => {
                    format!("lower the velocity to {share} % of what it is, or take the profile time-optimal")
                }
                (None, _) => {
                    format!("lower the velocity to {} % of what it is", floor(100.0 * ratio / self.stretched))
                }
            },
            Quantity::Acceleration | Quantity::ToolAcceleration => match self.spot.way {
                Some(Way { turn: true, .. }) => format!(
                    "lower `rotation_acceleration` to {share} % of what it is and `rotation_velocity` to {root} %"
                ),
                Some(_) => format!(
                    "lower the acceleration to {share} % of what it is and the velocity to {root} %, or take the profile \
                     time-optimal"
                ),
                // Times go with the velocity, accelerations with its square; what an axis has stretched already does not count.
                None => {
                    let share = floor(100.0 * ratio.sqrt() / self.stretched);
                    format!("lower the velocity to {share} % of what it is")
                }
            },
            Quantity::Torque => {
                "lower velocity and acceleration, carry less, or let the drive give more torque".into()
            }
            Quantity::Jump => {
                "start in another configuration, let the tool turn about its axis (tool-axis) or be free"
                    .into()
            }
            Quantity::Singularity => {
                "start in another configuration, let the tool turn about its axis (tool-axis) or be free; or lower \
                 `singular_limit` of the move"
                    .into()
            }
        }
    }

    /// Its place on the move.
    pub fn place(&self) -> String {
        self.spot.to_string()
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
            Quantity::ToolAcceleration => write!(
                f,
                "the tool accelerates with {} m/s^2, limit {} m/s^2, up to {} m/s^2",
                short(value),
                short(limit),
                short(worst)
            ),
            Quantity::Torque => {
                let (what, unit) = match self.kind {
                    AxisKind::Turning => ("torque", "N m"),
                    AxisKind::Sliding => ("force", "N"),
                };
                write!(
                    f,
                    "the motor of {axis}has to give a {what} of {} {unit} at the joint, limit {} {unit}, up to {} {unit} \
                     ({} %)",
                    short(value),
                    short(limit),
                    short(worst),
                    short((1e3 * worst / limit).round() / 10.0)
                )
            }
            Quantity::Singularity => write!(
                f,
                "the arm is nearly singular: its smallest singular value is {}, limit {}",
                short(value),
                short(limit)
            ),
        }
    }
}
