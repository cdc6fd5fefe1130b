//! Laws that rotation, translation, gears and joints share; no blocks.

pub(crate) mod contact;
pub(crate) mod elastic;
pub(crate) mod friction_model;
pub(crate) mod quantities;
pub(crate) mod rigid_stop;
pub(crate) mod stribeck;
#[cfg(test)]
pub(crate) mod testing;

pub use friction_model::FrictionModel;
