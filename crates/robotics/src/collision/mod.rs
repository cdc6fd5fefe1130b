//! Distances and collisions of simple shapes.
//!
//! A [`Solid`] is a sphere, capsule, box, cylinder, cone or half-space; [`distance`] tells how far two of them are from
//! each other and where. A [`Check`] holds all solids of a mechanism and of its surroundings, knows which pairs may
//! touch, and finds the nearest pair in a pose, the first collision and the least distance on a way, or its whole
//! [`History`]: what touches when, and how near all others come.
//!
//! Neighbours, bodies joined by a joint, may touch; and so may what touches at rest. [`Check::left_out`] lists the latter.

mod apart;
mod check;
mod convex;
mod depth;
mod distance;
mod history;
mod solid;
mod walk;

pub use check::{Check, Clearance, Item, Rules};
pub use distance::{Distance, distance};
pub use history::{Contact, History, Nearest};
pub use solid::Solid;
pub use walk::{Passage, Walk};
