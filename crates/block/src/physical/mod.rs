//! Parts of physical networks: what a component connects, contains and obeys.
//!
//! A component names its conserving ports, contributes [`Element`]s between them and states the laws of those
//! elements as functions. Kirchhoff's laws, the balance of torques and the elimination of rigid connections
//! appear in no component: the assembly of a network does them in one place.
//!
//! Rotation and translation share their elements: where this page says speed, torque and inertia, translational ports
//! have velocity (m/s), force (N) and mass (kg), and angles (rad) are positions (m).
//!
//! Signs. A branch between `r` and `c` has the speed `w_r - w_c`; its torque is counted positive when it absorbs
//! power at positive speed: it acts as `-tau` on `r` and `+tau` on `c`. A two-pin between `p` and `n` has the
//! voltage `v_p - v_n`; its current is counted positive from `p` through the element to `n`.

mod characteristic;
mod component;
mod effort;
mod element;
mod energy;
mod freedom;
mod law;
mod loss;
mod part;
mod port;
mod reading;
mod supply;

pub use characteristic::{Characteristics, ElementPlace, Handle};
pub use component::Component;
pub use effort::{Grip, Stop, Torque, Wrench};
pub use element::{Element, ValveKind};
pub use energy::Energy;
pub use freedom::{Axis, Freedom};
pub use law::{Fed, Flowing, FrameAcceleration, FrameMotion, JointLoad, JointMotion, Known, Loaded, Moving};
pub use loss::{DryMesh, LossModel, MeshLoss};
pub use part::{HEAT, Needs, Part};
pub use port::{Domain, PhysicalPort, Pin};
pub use reading::{Gives, Reading};
pub use supply::{Field, Supply, from_space_vector, space_vector};
