//! The laws of the squirrel-cage induction machine, in per unit and apart from networks: pure functions of fluxes,
//! voltages and speeds.

mod base;
mod circuit;
mod complex;
mod machine;
mod magnetisation;
mod reluctance;
#[cfg(test)]
pub(crate) mod samples;
mod steady;

pub use base::Base;
pub use circuit::{Cages, Circuit};
pub use complex::Complex;
pub use machine::Machine;
pub use magnetisation::Magnetisation;
pub use reluctance::Reluctance;
pub use steady::Steady;
