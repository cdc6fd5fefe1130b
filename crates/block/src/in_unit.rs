//! Numbers in a fixed unit inside of nested parameters, for `#[serde(deserialize_with = "...")]`.
//!
//! The unit of a parameter itself stands in `#[block(unit = "...")]`; members of a set inside of it use these.

use serde::Deserialize;
use serde::de::Error;

use blocksim_signal::{Dimension, Quantity, Unit, Value};

use crate::ParamValue;

fn checked<E: Error>(value: &Value, unit: &str) -> Result<f64, E> {
    let Value::Number(Quantity { value, dimension }) = value else {
        return Err(E::custom(format!("expected a number in {unit}, found {}", value.describe())));
    };
    let wanted = Unit::parse(unit).map_or(Dimension::NONE, |unit| unit.dimension);
    // A number without unit is meant in SI.
    if *dimension == Dimension::NONE || wanted.compatible(*dimension) {
        return Ok(*value);
    }
    Err(E::custom(format!("expected a value in {unit}, found one in {dimension}")))
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
    /// A share or another number without unit.
    share, "1";
}

/// Angles, rad.
///
/// # Errors
/// No list of numbers, or one in another unit.
pub fn angles<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Vec<f64>, D::Error> {
    match ParamValue::deserialize(deserializer)?.0 {
        Value::List(items) => items.iter().map(|item| checked(item, "rad")).collect(),
        other => Err(D::Error::custom(format!("expected a list of angles, found {}", other.describe()))),
    }
}
