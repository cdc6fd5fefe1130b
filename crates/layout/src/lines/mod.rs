//! Wires between the layers, and the drawing as a whole.

mod channels;
pub(crate) mod draw;
mod wires;
