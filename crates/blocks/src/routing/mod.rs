//! Blocks: routing.

mod bus_creator;
mod bus_selector;
mod demux;
mod if_else;
mod merge;
mod mux;
pub(crate) mod names;
mod selector;
mod switch_case;
mod terminator;

pub use bus_creator::BusCreator;
pub use bus_selector::BusSelector;
pub use demux::Demux;
pub use if_else::IfElse;
pub use merge::Merge;
pub use mux::Mux;
pub use selector::Selector;
pub use switch_case::SwitchCase;
pub use terminator::Terminator;
