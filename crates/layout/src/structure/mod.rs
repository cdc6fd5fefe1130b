//! What a level says of its blocks before any has a place: direction, skeleton, layers, sides of the ports.

pub(crate) mod flow;
pub(crate) mod layers;
pub(crate) mod sides;
pub(crate) mod skeleton;

pub use flow::feedback;
