//! Layout of one level of a block diagram: where blocks stand and where wires run.
//!
//! Blocks are sorted into layers from left to right, wires run between them in channels and past them in lanes,
//! always along the axes and never through a block. Feedback runs back below, and a block in a feedback path is
//! mirrored. The same graph gives the same picture, and the order of the blocks in the file breaks all ties.
//!
//! ```text
//! Graph -flow-> forward/feedback -layers-> columns -sides-> ports -lanes-> items -order-> rows -rows-> y
//!       -channels-> x of the wires -wires-> Layout
//! ```
//!
//! The order is found in the skeleton, which lacks all that only stands in a wire, and sinks; the level is sorted after its
//! heights (`keys`), and what was left out is put between (`insert`), sinks as in the skeleton that has them. So a small edit
//! makes a small change (`level`).
//!
//! Lengths are dots of a drawing, x to the right, y down.

mod components;
mod graph;
mod heights;
mod keys;
mod level;
mod lines;
mod metrics;
mod order;
mod simplex;
mod structure;

pub use components::layout;
pub use graph::{
    End, Form, Graph, Layout, Net, Node, Placed, PlacedPort, Point, PortKind, Segment, Side, Standing, Wire,
};
pub use metrics::{Metrics, metrics};
pub use structure::feedback;
