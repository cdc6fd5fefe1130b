use blocksim_block::in_unit;
use blocksim_block::prelude::*;
use blocksim_motion::{AxisLimits, Endpoint, JointMoveRequest, MoveError, Synchronisation};

/// Set values of one axis of a robot that moves all axes together, from rest to rest (PTP, fully synchronised).
///
/// All axes accelerate, cruise and brake during the same times. The acceleration is a $\sin^2$ bump, then zero,
/// then the mirrored bump; with the distance $d$ of the axis
///
/// $$ \ddot q = a_m \sin^2\frac{\pi t}{T_{acc}}, \qquad v_m = \frac{d}{T_{dec}}, \qquad
///    a_m = \frac{2 v_m}{T_{acc}}, \qquad T_{end} = T_{acc} + T_{dec} $$
///
/// `path.velocity` is the share of each axis' largest speed to use, `path.acceleration` the share of the move time
/// spent accelerating. The times are the longest that any axis needs (`rule: Feasible`), stretched where an
/// acceleration limit would be exceeded, or those of the axis that takes longest alone (`rule: AsPrinted`), which
/// can exceed limits of other axes. Start, end of acceleration, start of braking and end are hit exactly; before
/// and after the move the axis rests.
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
#[block(category = "Motion", symbol = Curve(Move))]
pub struct JointMove {
    /// The move of all axes: `(start, target, velocity, acceleration, resolution)`.
    pub path: JointPath,
    /// What each axis can do: a list of `(lower, upper, speed, acceleration)`.
    pub limits: Vec<Limits>,
    /// The axis whose set values come out, counted from 1 as in the robot's manual.
    pub axis: usize,
    /// Time before the move starts, not negative.
    #[block(unit = "s", default = 0.0)]
    pub delay: f64,
    /// How the axes are synchronised: `Feasible` or `AsPrinted`.
    #[block(default = Rule::Feasible)]
    pub rule: Rule,
    /// The planned move; made by `load`.
    #[block(skip)]
    plan: Option<blocksim_motion::JointMove>,
}

/// A move of all axes from rest to rest.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointPath {
    /// Positions at the start, one for each axis, rad.
    #[serde(deserialize_with = "in_unit::angles")]
    pub start: Vec<f64>,
    /// Positions at the end, one for each axis, rad.
    #[serde(deserialize_with = "in_unit::angles")]
    pub target: Vec<f64>,
    /// Share of each axis' largest speed, above 0 and at most 1.
    #[serde(deserialize_with = "in_unit::share")]
    pub velocity: f64,
    /// Share of the move time spent accelerating, above 0 and at most 0.5.
    #[serde(deserialize_with = "in_unit::share")]
    pub acceleration: f64,
    /// Distance between two rows of a table of the move, rad, positive. The set values do not depend on it.
    #[serde(default = "half_a_degree", deserialize_with = "in_unit::angle")]
    pub resolution: f64,
}

/// What one axis can do.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Lowest position, rad.
    #[serde(deserialize_with = "in_unit::angle")]
    pub lower: f64,
    /// Highest position, rad.
    #[serde(deserialize_with = "in_unit::angle")]
    pub upper: f64,
    /// Largest speed, rad/s.
    #[serde(deserialize_with = "in_unit::speed")]
    pub speed: f64,
    /// Largest acceleration, rad/s^2.
    #[serde(deserialize_with = "in_unit::acceleration")]
    pub acceleration: f64,
}

/// How the axes are made to start, cruise and brake together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Rule {
    /// In the longest times that any axis needs; never exceeds a limit.
    Feasible,
    /// In the times of the axis that takes longest alone.
    AsPrinted,
}

/// Spacing of a table of set values where a move says none, rad.
fn half_a_degree() -> f64 {
    0.5_f64.to_radians()
}

impl JointMove {
    /// A block with its plan, as it is after `load`.
    pub fn new(path: JointPath, limits: Vec<Limits>, axis: usize, delay: f64, rule: Rule) -> Self {
        let block = Self { path, limits, axis, delay, rule, plan: None };
        Self { plan: block.planned().ok(), ..block }
    }

    fn planned(&self) -> Result<blocksim_motion::JointMove, MoveError> {
        let JointPath { start, target, velocity, acceleration, .. } = self.path.clone();
        let rule = match self.rule {
            Rule::Feasible => Synchronisation::Feasible,
            Rule::AsPrinted => Synchronisation::AsPrinted,
        };
        let axis_limits = |limits: &Limits| {
            let Limits { lower, upper, speed, acceleration } = *limits;
            AxisLimits { lower, upper, speed, acceleration }
        };
        let limits: Vec<_> = self.limits.iter().map(axis_limits).collect();
        blocksim_motion::JointMove::plan(
            &JointMoveRequest { start, target, velocity, acceleration, rule },
            &limits,
        )
    }
}

/// The parameter that a plan failed for.
fn guilty(error: &MoveError) -> String {
    let side = |endpoint: Endpoint| match endpoint {
        Endpoint::Start => "path.start",
        Endpoint::Target => "path.target",
    };
    match *error {
        MoveError::NoAxes => "limits".to_owned(),
        MoveError::WrongLength { endpoint, .. } => side(endpoint).to_owned(),
        MoveError::NotFinite { endpoint, axis, .. } | MoveError::OutsideLimits { endpoint, axis, .. } => {
            format!("{}[{axis}]", side(endpoint))
        }
        MoveError::NothingToMove => "path.target".to_owned(),
        MoveError::VelocityShare { .. } => "path.velocity".to_owned(),
        MoveError::AccelerationShare { .. } => "path.acceleration".to_owned(),
        MoveError::LimitsCrossed { axis, .. } => format!("limits[{axis}].upper"),
        MoveError::SpeedLimit { axis, .. } => format!("limits[{axis}].speed"),
        MoveError::AccelerationLimit { axis, .. } => format!("limits[{axis}].acceleration"),
        MoveError::NotComputable { axis, .. } => format!("path.target[{axis}]"),
    }
}

/// The error of a plan; what follows the semicolon in its message is the remedy.
fn refusal(error: &MoveError) -> ParamError {
    let text = error.to_string();
    match text.split_once("; ") {
        Some((fact, remedy)) => ParamError::new(guilty(error), fact).help(remedy),
        None => ParamError::new(guilty(error), text),
    }
}

impl Block for JointMove {
    fn load(&mut self, _files: &dyn Files) -> Result<(), LoadError> {
        // A move that cannot be planned is reported by `check`, with the parameter at fault.
        self.plan = self.planned().ok();
        Ok(())
    }

    fn check(&self) -> Result<(), ParamError> {
        self.planned().map_err(|error| refusal(&error))?;
        positive("path.resolution", self.path.resolution)?;
        not_negative("delay", self.delay)?;
        let axes = self.limits.len();
        if !(1..=axes).contains(&self.axis) {
            return Err(ParamError::new(
                "axis",
                format!("`axis` is {}, but there are {axes} axes", self.axis),
            )
            .help(format!("axes are counted from 1: choose 1 to {axes}")));
        }
        Ok(())
    }

    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        Ok(Interface::new()
            .output_from_state(Output::real("q").unit("rad").doc("Position."))
            .output_from_state(Output::real("qd").unit("rad/s").doc("Velocity."))
            .output_from_state(Output::real("qdd").unit("rad/s^2").doc("Acceleration."))
            .uses_time()
            .time_events())
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        match &self.plan {
            Some(plan) => {
                let (q, qd, qdd) = plan.at(self.axis - 1, c.t - self.delay);
                y.copy_from_slice(&[q, qd, qdd]);
            }
            None => c.fail("the move has no plan"),
        }
    }

    fn next_event(&self, c: &Context) -> f64 {
        let Some(plan) = &self.plan else {
            return f64::INFINITY;
        };
        let seams = [0.0, plan.t_acc(), plan.t_dec(), plan.duration()].map(|seam| self.delay + seam);
        seams.into_iter().find(|seam| *seam > c.t).unwrap_or(f64::INFINITY)
    }

    fn end_time(&self) -> Option<f64> {
        self.plan.as_ref().map(|plan| self.delay + plan.duration())
    }
}

#[cfg(test)]
#[path = "joint_move_tests.rs"]
mod tests;
