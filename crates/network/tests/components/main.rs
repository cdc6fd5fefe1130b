//! Networks of real components: against closed forms, equivalent circuits and second implementations.

mod dc_motors;
mod errors;
mod gears;
mod machines;
mod mechanisms;
mod plant;
mod shafts;
