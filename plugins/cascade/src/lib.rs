//! Cascaded position and speed controller with feedforward as a plug-in; see [`Cascade`] and the README
//! beside it.

mod cascade;

pub use cascade::Cascade;

blocksim_controller::export_plugin!("cascade", [Cascade]);
