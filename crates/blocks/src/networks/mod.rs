//! Blocks: what belongs to a physical network as a whole.

mod energy_account;

pub use energy_account::{EnergyAccount, Joins};
