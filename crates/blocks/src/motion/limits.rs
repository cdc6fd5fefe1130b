//! What an axis can do, as files say it.

use blocksim_block::in_unit::{self, AxisValue};
use blocksim_block::prelude::*;
use blocksim_robotics::motion::{AxisKind, AxisLimits};

/// What one axis can do, in rad where it turns and in m where it slides.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(try_from = "Written")]
pub struct Limits {
    /// Lowest position, rad or m.
    pub lower: f64,
    /// Highest position, rad or m.
    pub upper: f64,
    /// Largest speed, rad/s or m/s.
    pub speed: f64,
    /// Largest acceleration, rad/s^2 or m/s^2.
    pub acceleration: f64,
    /// Whether the units are those of an axis that slides; unknown where none were written.
    pub slides: Option<bool>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    #[serde(deserialize_with = "in_unit::axis_position")]
    lower: AxisValue,
    #[serde(deserialize_with = "in_unit::axis_position")]
    upper: AxisValue,
    #[serde(deserialize_with = "in_unit::axis_speed")]
    speed: AxisValue,
    #[serde(deserialize_with = "in_unit::axis_acceleration")]
    acceleration: AxisValue,
}

impl TryFrom<Written> for Limits {
    type Error = String;

    fn try_from(written: Written) -> Result<Self, String> {
        let Written { lower, upper, speed, acceleration } = written;
        let all = [("lower", lower), ("upper", upper), ("speed", speed), ("acceleration", acceleration)];
        let mut known: Option<(&str, bool)> = None;
        for (name, value) in all {
            let Some(slides) = value.slides else { continue };
            match known {
                Some((first, other)) if other != slides => {
                    let (turning, sliding) = if slides { (first, name) } else { (name, first) };
                    return Err(format!(
                        "`{turning}` is that of an axis that turns, `{sliding}` that of one that slides"
                    ));
                }
                _ => known = Some((name, slides)),
            }
        }
        let slides = known.map(|(_, slides)| slides);
        let [lower, upper, speed, acceleration] = all.map(|(_, value)| value.value);
        Ok(Limits { lower, upper, speed, acceleration, slides })
    }
}

impl Limits {
    /// How the axis moves, by the units alone.
    pub fn kind(&self) -> AxisKind {
        if self.slides == Some(true) { AxisKind::Sliding } else { AxisKind::Turning }
    }

    /// The limits of an axis of a kind.
    pub fn of(&self, kind: AxisKind) -> AxisLimits {
        let Limits { lower, upper, speed, acceleration, .. } = *self;
        AxisLimits { kind, lower, upper, speed, acceleration }
    }
}

/// The number, if its unit is that of the kind of the axis; `what` begins the message.
pub(crate) fn of_kind(value: AxisValue, kind: AxisKind, what: &str, param: &str) -> Result<f64, ParamError> {
    match (value.slides, kind) {
        (Some(false), AxisKind::Sliding) => {
            Err(ParamError::new(param, format!("{what} slides, but this has the unit of an axis that turns"))
                .help("give it with m in the place of rad, such as 100 mm, 0.2 m/s or 50 N"))
        }
        (Some(true), AxisKind::Turning) => {
            Err(ParamError::new(param, format!("{what} turns, but this has the unit of an axis that slides"))
                .help("give it with rad or deg in the place of m, such as 30 deg, 2 rad/s or 50 N*m"))
        }
        _ => Ok(value.value),
    }
}

/// The numbers of all axes.
pub(crate) fn of_kinds(
    values: &[AxisValue],
    kinds: &[AxisKind],
    param: &str,
) -> Result<Vec<f64>, ParamError> {
    // A list of another length is refused by who uses it.
    let kind = |axis: usize, value: &AxisValue| match kinds.get(axis) {
        Some(kind) => of_kind(*value, *kind, &format!("axis {}", axis + 1), &format!("{param}[{axis}]")),
        None => Ok(value.value),
    };
    values.iter().enumerate().map(|(axis, value)| kind(axis, value)).collect()
}
