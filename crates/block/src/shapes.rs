//! A parameter that says what a body looks like.

use blocksim_scene::Shape;
use serde::Deserialize;
use serde::de::{Deserializer, Error};

use crate::ParamValue;

/// The shapes of a body as a parameter; written as [`blocksim_scene::shapes`] says.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shapes(pub Vec<Shape>);

impl<'de> Deserialize<'de> for Shapes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = ParamValue::deserialize(deserializer)?;
        blocksim_scene::shapes(&value.0).map(Shapes).map_err(D::Error::custom)
    }
}
