//! Blocks: routing.

mod bus_creator;
mod bus_selector;
mod demux;
mod mux;
pub(crate) mod names;
mod selector;
mod terminator;

pub use bus_creator::BusCreator;
pub use bus_selector::BusSelector;
pub use demux::Demux;
pub use mux::Mux;
pub use selector::Selector;
pub use terminator::Terminator;
