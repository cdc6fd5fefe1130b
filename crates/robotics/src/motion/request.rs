//! What is asked of a joint move.

/// How the axes are made to start, cruise and brake together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Synchronisation {
    /// The longest acceleration time of all axes and the longest cruising time of all axes; stretched as a
    /// whole where an acceleration limit would be exceeded. Never breaks a limit.
    #[default]
    Feasible,
    /// The axis that would take longest alone leads, and the others take its times. An axis that needs more
    /// time to accelerate than the leading one can then exceed a limit; see [`crate::motion::JointMove::violations`].
    ///
    /// Alone, each axis keeps within its own acceleration limit: where the share of the move time would ask
    /// for more, the acceleration is the limit and the speed at most $\sqrt{a d / 2}$.
    AsPrinted,
}

/// A move of all axes from rest to rest.
#[derive(Debug, Clone, PartialEq)]
pub struct JointMoveRequest {
    /// Positions at the start, one per axis, rad or m.
    pub start: Vec<f64>,
    /// Positions at the end, one per axis, rad or m.
    pub target: Vec<f64>,
    /// Share of each axis' maximum speed to use, above 0 and at most 1.
    pub velocity: f64,
    /// Share of the move time spent accelerating, above 0 and at most 0.5: with 0.1 an axis accelerates for
    /// 10 % of the time, cruises for 80 % and brakes for 10 %.
    pub acceleration: f64,
    /// How the axes are synchronised.
    pub rule: Synchronisation,
}
