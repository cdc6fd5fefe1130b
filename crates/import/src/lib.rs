//! Mechanisms from files of other programs: robot descriptions (URDF), assemblies of CAD programs (import XML of Simscape
//! Multibody) and their data files.
//!
//! Three steps, from plain data to plain data: a reader makes a [`Mechanism`] of the bytes of a file ([`urdf::read`], [`simscape::read`]),
//! [`diagram`] and [`parameters`] make text of it; where its axes make a [`chain`], [`robot`] describes it as one. Nothing here opens or writes a file, and nothing knows blocks: the
//! diagram is text.
//!
//! Faults have a file, a line, a reason and a remedy ([`Fault`]); all of a file are told at once.

mod chain;
mod fault;
mod mechanism;
mod meshes;
mod model;
mod names;
mod numbers;
pub mod simscape;
pub mod smidata;
pub mod stl;
mod structure;
mod update;
pub mod urdf;
mod volume;
mod write;
mod xml;

pub use chain::{Chain, ChainLink, chain};
pub use fault::Fault;
pub use mechanism::{Body, Form, Joint, Mechanism, Motion, Role, Shape, Start};
pub use meshes::{MeshFile, meshes};
pub use model::{Tree, model};
pub use names::file_name;
pub use structure::{Part, Restructured, restructured};
pub use update::{Differences, differences, named_in, wired_in};
pub use volume::{Solid, solid};
pub use write::{Files, Provenance, diagram, parameters, robot};
