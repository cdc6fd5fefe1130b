//! Numbers in a fixed unit inside of nested parameters, for `#[serde(deserialize_with = "...")]`.
//!
//! The unit of a parameter itself stands in `#[block(unit = "...")]`; members of a set inside of it use these.

use serde::Deserialize;
use serde::de::Error;

use blocksim_signal::{Dimension, Quantity, Unit, Value};

use crate::ParamValue;

/// A number with or without a unit, for parameters that mean something else without: in per unit, for instance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measure {
    /// In SI, if there is a unit.
    pub value: f64,
    /// Whether a unit was written.
    pub has_unit: bool,
}

fn checked<E: Error>(value: &Value, unit: &str) -> Result<f64, E> {
    measured(value, unit).map(|measure| measure.value)
}

fn measured<E: Error>(value: &Value, unit: &str) -> Result<Measure, E> {
    let Value::Number(Quantity { value, dimension }) = value else {
        return Err(E::custom(format!("expected a number in {unit}, found {}", value.describe())));
    };
    let wanted = Unit::parse(unit).map_or(Dimension::NONE, |unit| unit.dimension);
    // A number without unit is meant in SI.
    let has_unit = *dimension != Dimension::NONE;
    if !has_unit || wanted.compatible(*dimension) {
        return Ok(Measure { value: *value, has_unit });
    }
    let expected =
        if wanted.is_none() { "a number without a unit".to_owned() } else { format!("a value in {unit}") };
    Err(E::custom(format!("expected {expected}, found one in {dimension}")))
}

macro_rules! numbers_in {
    ($($(#[$doc:meta])* $name:ident, $unit:literal;)*) => {
        $($(#[$doc])*
        ///
        /// # Errors
        /// No number, or one in another unit.
        pub fn $name<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
            checked(&ParamValue::deserialize(deserializer)?.0, $unit)
        })*
    };
}

numbers_in! {
    /// An angle, rad.
    angle, "rad";
    /// An angular velocity, rad/s.
    speed, "rad/s";
    /// An angular acceleration, rad/s^2.
    acceleration, "rad/s^2";
    /// A time, s.
    time, "s";
    /// A length, m.
    length, "m";
    /// A velocity, m/s.
    velocity, "m/s";
    /// An acceleration of a point, m/s^2.
    point_acceleration, "m/s^2";
    /// A mass, kg.
    mass, "kg";
    /// A moment of inertia, kg*m^2.
    inertia, "kg*m^2";
    /// A torque, N*m.
    torque, "N*m";
    /// A coefficient of viscous damping, N*m*s/rad.
    damping, "N*m*s/rad";
    /// A voltage, V.
    voltage, "V";
    /// A frequency, Hz.
    frequency, "Hz";
    /// A share or another number without unit.
    share, "1";
}

macro_rules! lists_in {
    ($($(#[$doc:meta])* $name:ident -> $item:ty, $each:ident, $unit:literal;)*) => {
        $($(#[$doc])*
        ///
        /// # Errors
        /// No list of numbers, or one in another unit.
        pub fn $name<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Vec<$item>, D::Error> {
            match ParamValue::deserialize(deserializer)?.0 {
                Value::List(items) => items.iter().map(|item| $each(item, $unit)).collect(),
                other => Err(D::Error::custom(format!("expected a list of numbers, found {}", other.describe()))),
            }
        }
        )*
    };
}

lists_in! {
    /// Angles, rad.
    angles -> f64, checked, "rad";
    /// Plain numbers.
    shares -> f64, checked, "1";
    /// Currents, A, or something else without unit.
    currents -> Measure, measured, "A";
    /// Voltages, V, or something else without unit.
    voltages -> Measure, measured, "V";
}

macro_rules! triples_in {
    ($($(#[$doc:meta])* $name:ident, $unit:literal;)*) => {
        $($(#[$doc])*
        ///
        /// # Errors
        /// No list of three numbers, or one in another unit.
        pub fn $name<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<[f64; 3], D::Error> {
            match ParamValue::deserialize(deserializer)?.0 {
                Value::List(items) if items.len() == 3 => {
                    let mut triple = [0.0; 3];
                    for (place, item) in triple.iter_mut().zip(&items) {
                        *place = checked(item, $unit)?;
                    }
                    Ok(triple)
                }
                other => Err(D::Error::custom(format!("expected a list of three numbers, found {}", other.describe()))),
            }
        }
        )*
    };
}

triples_in! {
    /// A point or a displacement: x, y, z, m.
    point, "m";
    /// A direction: x, y, z without unit.
    direction, "1";
    /// Three angles, rad.
    turns, "rad";
    /// Three moments or products of inertia, kg*m^2.
    moments, "kg*m^2";
    /// An acceleration: x, y, z, m/s^2.
    acceleration_vector, "m/s^2";
}

/// A number of an axis: by its unit the axis turns or slides.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AxisValue {
    /// In SI.
    pub value: f64,
    /// Whether the unit is that of an axis that slides; unknown where no unit was written.
    pub slides: Option<bool>,
}

/// Positions of axes, rad or m, as a parameter of a block.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AxisPositions(pub Vec<AxisValue>);

impl AxisValue {
    /// A number that is meant in SI.
    pub fn bare(value: f64) -> Self {
        AxisValue { value, slides: None }
    }

    fn of<E: Error>(value: &Value, turning: &str, sliding: &str) -> Result<Self, E> {
        let Value::Number(Quantity { value, dimension }) = value else {
            return Err(E::custom(format!(
                "expected a number in {turning} or {sliding}, found {}",
                value.describe()
            )));
        };
        let is_in = |unit: &str| Unit::parse(unit).is_ok_and(|unit| unit.dimension.compatible(*dimension));
        let slides = match *dimension == Dimension::NONE {
            true => None,
            false if is_in(sliding) => Some(true),
            false if is_in(turning) => Some(false),
            false => {
                let message = format!("expected a value in {turning} or {sliding}, found one in {dimension}");
                return Err(E::custom(message));
            }
        };
        Ok(AxisValue { value: *value, slides })
    }
}

impl<'de> Deserialize<'de> for AxisPositions {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        axis_positions(deserializer).map(AxisPositions)
    }
}

macro_rules! of_axes {
    ($($(#[$doc:meta])* $name:ident, $turning:literal, $sliding:literal;)*) => {
        $($(#[$doc])*
        ///
        /// # Errors
        /// No number, or one in another unit.
        pub fn $name<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<AxisValue, D::Error> {
            AxisValue::of(&ParamValue::deserialize(deserializer)?.0, $turning, $sliding)
        })*
    };
}

of_axes! {
    /// A position, rad or m.
    axis_position, "rad", "m";
    /// A speed, rad/s or m/s.
    axis_speed, "rad/s", "m/s";
    /// An acceleration, rad/s^2 or m/s^2.
    axis_acceleration, "rad/s^2", "m/s^2";
    /// A torque or a force, N*m or N.
    axis_force, "N*m", "N";
    /// A coefficient of viscous damping, N*m*s/rad or N*s/m.
    axis_damping, "N*m*s/rad", "N*s/m";
}

/// Positions of axes, rad or m.
///
/// # Errors
/// No list of numbers, or one in another unit.
pub fn axis_positions<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Vec<AxisValue>, D::Error> {
    match ParamValue::deserialize(deserializer)?.0 {
        Value::List(items) => items.iter().map(|item| AxisValue::of(item, "rad", "m")).collect(),
        other => Err(D::Error::custom(format!("expected a list of numbers, found {}", other.describe()))),
    }
}

/// A share that may be absent, with `#[serde(default)]`.
///
/// # Errors
/// No number, or one in another unit.
pub fn share_if_given<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    share(deserializer).map(Some)
}

/// A jerk, m/s^3, that may be absent, with `#[serde(default)]`.
///
/// # Errors
/// No number, or one in another unit.
pub fn jerk_if_given<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    checked(&ParamValue::deserialize(deserializer)?.0, "m/s^3").map(Some)
}

/// A torque, N*m, that may be absent, with `#[serde(default)]`.
///
/// # Errors
/// No number, or one in another unit.
pub fn torque_if_given<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    checked(&ParamValue::deserialize(deserializer)?.0, "N*m").map(Some)
}

/// A length, m, that may be absent, with `#[serde(default)]`.
///
/// # Errors
/// No number, or one in another unit.
pub fn length_if_given<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    length(deserializer).map(Some)
}

/// A direction, x, y, z without unit, that may be absent, with `#[serde(default)]`.
///
/// # Errors
/// No list of three numbers, or one with a unit.
pub fn direction_if_given<'de, D: serde::Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<[f64; 3]>, D::Error> {
    direction(deserializer).map(Some)
}

/// A resistance or reactance, ohm, or something else without unit.
///
/// # Errors
/// No number, or one in another unit.
pub fn impedance<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Measure, D::Error> {
    measured(&ParamValue::deserialize(deserializer)?.0, "ohm")
}
