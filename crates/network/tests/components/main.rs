//! Networks of real components: against closed forms, equivalent circuits and second implementations.

mod contacts;
mod couplings;
mod dc_motors;
mod errors;
mod forces;
mod friction;
mod gears;
mod joints;
mod loops;
mod machines;
mod mechanisms;
mod modes;
mod open_windings;
mod permanent_magnets;
mod plant;
mod shafts;
mod sliders;
mod translation;
mod wound_fields;
mod wrists;
