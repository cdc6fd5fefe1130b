//! Discrete PID controller as a plug-in; see [`Pid`] and the README beside it.

mod pid;

pub use pid::Pid;

blocksim_controller::export_plugin!("pid", [Pid]);
