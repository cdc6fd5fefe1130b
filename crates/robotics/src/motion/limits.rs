//! What an axis can do, and how near a move comes to it.

use std::fmt;

use crate::motion::axis_kind::AxisKind;

/// What one axis can do, in rad or m by its kind. Positions may be infinite for an axis that turns without end, and
/// the acceleration may be infinite where no limit is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisLimits {
    /// How it moves.
    pub kind: AxisKind,
    /// Lowest position, rad or m.
    pub lower: f64,
    /// Highest position, rad or m.
    pub upper: f64,
    /// Largest speed, rad/s or m/s.
    pub speed: f64,
    /// Largest acceleration, rad/s² or m/s².
    pub acceleration: f64,
}

/// What is left between a move and the limits of one axis; negative where a limit is exceeded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margin {
    /// From the lowest position of the move to the lower limit, rad or m.
    pub lower: f64,
    /// From the highest position of the move to the upper limit, rad or m.
    pub upper: f64,
    /// From the maximum speed of the move to the limit, rad/s or m/s.
    pub speed: f64,
    /// From the maximum acceleration of the move to the limit, rad/s² or m/s².
    pub acceleration: f64,
}

/// A quantity that a limit bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisQuantity {
    /// Speed.
    Speed,
    /// Acceleration.
    Acceleration,
}

/// A limit that a planned move exceeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisViolation {
    /// Index of the axis, from 0.
    pub axis: usize,
    /// How the axis moves.
    pub kind: AxisKind,
    /// What is exceeded.
    pub quantity: AxisQuantity,
    /// Largest value of the move, in SI units.
    pub value: f64,
    /// The limit, in SI units.
    pub limit: f64,
}

impl fmt::Display for AxisViolation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, per) = match self.quantity {
            AxisQuantity::Speed => ("speed", "/s"),
            AxisQuantity::Acceleration => ("acceleration", "/s^2"),
        };
        let unit = format!("{}{per}", self.kind.unit());
        let percent = 100.0 * (self.value / self.limit - 1.0);
        write!(
            f,
            "axis {}: {name} {} {unit} exceeds its limit {} {unit} by {percent:.1} %",
            self.axis + 1,
            self.kind.text(self.value),
            self.kind.text(self.limit)
        )
    }
}
