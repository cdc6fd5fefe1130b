//! Rigid multibody dynamics of kinematic trees in joint space.
//!
//! A [`Model`] is constant: bodies in topological order, one joint to the parent each. A [`Data`] is the
//! workspace that [`Model::data`] makes once; no algorithm allocates afterwards.
//!
//! | question | function | Featherstone, *Rigid Body Dynamics Algorithms* (2008) |
//! |---|---|---|
//! | torques for a motion | [`rnea`] | recursive Newton-Euler, table 5.1 |
//! | the same as a matrix times the inertial parameters | [`regressor`] | |
//! | torques at zero acceleration | [`bias`] | the same with zero joint acceleration |
//! | mass matrix | [`crba`] | composite rigid bodies, table 6.2 |
//! | both, for a caller that solves | [`mass_and_bias`] | one forward and one backward sweep |
//! | accelerations for torques | [`aba`] | articulated bodies, table 7.1 |
//! | where everything is | [`forward_kinematics`], [`jacobian`] | |
//! | the same of frames on bodies: flange, tool | [`Frame`], [`frame_jacobian`], [`relative_jacobian`] | |
//! | Euler angles and quaternions | [`EulerZyx`], [`quaternion_of_rotation`] | |
//! | Denavit-Hartenberg parameters | [`denavit_hartenberg`] | |
//! | what forces from outside do | [`add_force`] | `τ += Jᵀ f` |
//! | positions from speeds | [`positions_derivative`], [`move_positions`] | |
//!
//! # Conventions
//!
//! * Ground is body 0, bodies count from 1; body i is moved by joint i. λ(i) is the parent of body i.
//! * A joint has its positions in `q` and its speeds in `v`, `a` and `tau`, in the order of the bodies
//!   ([`Model::positions`], [`Model::speeds`]). Axes have one of each, a spherical joint has four positions
//!   (a quaternion) and three speeds (its angular velocity in the axes of the child).
//! * Spatial vectors are written **in the coordinates of their body, angular part first**, and refer to the
//!   origin of the body frame: a motion is (ω, v), a force is (n, f).
//! * A [`Placement`] maps child coordinates to parent coordinates.
//! * Gravity enters as an acceleration of the ground by -g, so body forces already contain the weight.
//! * SI units throughout: m, kg, s, rad, N, N m.

mod aba;
mod articulated;
mod body;
mod crba;
mod data;
mod denavit_hartenberg;
mod energy;
mod error;
mod frame;
mod inertia;
mod joint;
mod kinematics;
mod mass_and_bias;
mod model;
mod model_builder;
mod orientation;
mod placement;
mod positions;
mod quaternion;
mod regressor;
mod rnea;
mod spatial;
mod spatial_inertia;
mod symmetric;

pub use aba::aba;
pub use body::BodyId;
pub use crba::crba;
pub use data::Data;
pub use denavit_hartenberg::{DhError, DhRow, DhTable, denavit_hartenberg};
pub use energy::{Momentum, center_of_mass, kinetic_energy, momentum, potential_energy};
pub use error::{InertiaError, ModelError};
pub use frame::{Frame, frame_jacobian, relative_jacobian};
pub use inertia::Inertia;
pub use joint::Joint;
pub use kinematics::{
    add_force, add_jacobian, bias_accelerations, forward_accelerations, forward_kinematics,
    forward_velocities, jacobian,
};
pub use mass_and_bias::mass_and_bias;
pub use model::{Model, STANDARD_GRAVITY};
pub use model_builder::ModelBuilder;
pub use orientation::{
    EulerZyx, OrientationError, quaternion_of_rotation, rotation_of_quaternion, rotation_vector,
};
pub use placement::Placement;
pub use positions::{home_positions, move_positions, positions_derivative};
pub use regressor::{PARAMETER_NAMES, PARAMETERS_PER_BODY, regressor};
pub use rnea::{bias, rnea};
pub use spatial::{Force, Motion};
