//! The laws of the squirrel-cage induction machine, in per unit and apart from networks: pure functions of fluxes,
//! voltages and speeds.

mod base;
mod breakdown;
mod circuit;
mod complex;
mod fit;
mod machine;
mod magnetisation;
mod name_plate;
mod reluctance;
#[cfg(test)]
pub(crate) mod samples;
mod steady;

pub use base::Base;
pub use circuit::{Cages, Circuit};
pub use complex::Complex;
pub use machine::Machine;
pub use magnetisation::Magnetisation;
pub use name_plate::{LockedRotor, NamePlate};
pub use reluctance::Reluctance;
pub use steady::Steady;
