//! What a mechanism looks like, as plain data.
//!
//! A [`Shape`] is a box, cylinder, capsule, sphere, cone or mesh, fixed to a body. A [`Scene`] is a tree of bodies with
//! their joints, the shapes, masses and named frames on them, and the names of the recorded signals that tell where
//! every body is; [`Scene::poses`] computes that. A scene is written as JSON, for programs that draw it.

pub mod mesh;
mod place;
mod read;
mod scene;
mod shape;

pub use read::shapes;
pub use scene::{Actuator, Mass, Motion, Scene, SceneBody, SceneFrame, SceneShape};
pub use shape::{Form, Purpose, Shape};
