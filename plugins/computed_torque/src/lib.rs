//! Central feedforward of torques for arms as a plug-in; see [`ComputedTorque`] and the README beside it.
//!
//! The dynamics are written out here, over plain numbers on the stack: a controller may not keep anything, and making
//! a mechanism anew at each sample would ask for memory a thousand times a second.

mod arm;
mod computed_torque;
mod drive;
mod quantities;
mod vector;

pub use computed_torque::ComputedTorque;

blocksim_controller::export_plugin!("computed_torque", [ComputedTorque<2>, ComputedTorque<6>]);
