//! Zero crossings of guards, and all else that has to be found within a step.

pub(crate) mod audit;
mod confirm;
pub(crate) mod crossings;
pub(crate) mod departure;
pub(crate) mod guards;
pub(crate) mod hops;
pub(crate) mod kinks;
pub(crate) mod looks;
pub(crate) mod modes;
pub(crate) mod pace;
pub(crate) mod peaks;
pub(crate) mod rhythm;
pub(crate) mod scan;
pub(crate) mod slopes;
pub(crate) mod turn;
