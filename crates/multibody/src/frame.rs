//! Frames: places on bodies or on the ground, and how they move.
//!
//! A robot has five of them. The *world* is [`Frame::ground`]; the *base* is the mounting surface of the robot, where
//! its axes start, z up; the *reference* is where targets are given (the base, or a work object in it); the *flange*
//! sits on the last link, z out of it; the *tool* has its origin in the tool centre point and its z along the tool.

use crate::body::BodyId;
use crate::data::Data;
use crate::kinematics::add_jacobian;
use crate::model::Model;
use crate::placement::Placement;
use nalgebra::{Matrix3, Vector3};

/// A frame that is fixed to a body or to the ground.
///
/// ```
/// use blocksim_multibody::{Frame, Inertia, Joint, ModelBuilder, Placement, forward_kinematics};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut builder = ModelBuilder::new();
/// let body = builder.add_body(None, Joint::revolute([0.0, 0.0, 1.0]), Placement::identity(), Inertia::zero())?;
/// let arm = builder.build();
/// let tip = Frame::of(body).at(Placement::from_translation([0.5, 0.0, 0.0]));
/// let mut data = arm.data();
/// forward_kinematics(&arm, &mut data, &[std::f64::consts::FRAC_PI_2]);
/// assert!((tip.in_world(&data).translation.y - 0.5).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// The body that carries the frame, `None` for the ground.
    pub body: Option<BodyId>,
    /// Where the frame is on its body, or in the world.
    pub placement: Placement,
}

impl Frame {
    /// The world frame.
    pub fn ground() -> Self {
        Frame { body: None, placement: Placement::identity() }
    }

    /// The frame of a body.
    pub fn of(body: BodyId) -> Self {
        Frame { body: Some(body), placement: Placement::identity() }
    }

    /// The frame that is at `placement` in this one, on the same body: a flange on a link, a tool on a flange.
    pub fn at(self, placement: Placement) -> Self {
        Frame { body: self.body, placement: self.placement * placement }
    }

    /// Where the frame is in the world, as of the last [`forward_kinematics`](crate::forward_kinematics).
    ///
    /// # Panics
    /// If the body belongs to another, larger model.
    pub fn in_world(&self, data: &Data) -> Placement {
        match self.body {
            Some(body) => data.bodies[body.0].world * self.placement,
            None => self.placement,
        }
    }

    /// Where the frame is in another frame, as of the last [`forward_kinematics`](crate::forward_kinematics).
    ///
    /// # Panics
    /// If a body belongs to another, larger model.
    pub fn relative_to(&self, reference: &Frame, data: &Data) -> Placement {
        reference.in_world(data).inverse() * self.in_world(data)
    }
}

/// Geometric Jacobian of a frame from the current placements: 6 x [`Model::dof`], row-major, angular rows first,
/// `(ω; ṗ) = J v`. It tells how the frame moves against the world; the reference point is the **origin of the
/// frame**, the components are along the **axes of `axes`**: [`Frame::ground`] for world axes, the frame itself for
/// its own.
///
/// # Panics
/// If `jacobian` or `data` does not fit the model.
pub fn frame_jacobian(model: &Model, data: &Data, frame: &Frame, axes: &Frame, jacobian: &mut [f64]) {
    jacobian.fill(0.0);
    if let Some(body) = frame.body {
        add_jacobian(model, data, body, &frame.placement.translation, 1.0, jacobian);
    }
    to_axes(&axes.in_world(data).rotation, model.dof(), jacobian);
}

/// Jacobian of a frame as an observer in `reference` sees it: 6 x [`Model::dof`], row-major, angular rows first. The
/// reference point is the origin of the frame, the components are along the axes of `reference`, which may move.
///
/// # Panics
/// If `jacobian` or `data` does not fit the model.
pub fn relative_jacobian(model: &Model, data: &Data, frame: &Frame, reference: &Frame, jacobian: &mut [f64]) {
    jacobian.fill(0.0);
    if let Some(body) = frame.body {
        add_jacobian(model, data, body, &frame.placement.translation, 1.0, jacobian);
    }
    if let Some(body) = reference.body {
        // the point of the reference body that is where the frame is
        let carried = data.bodies[body.0].world.inverse().point(&frame.in_world(data).translation);
        add_jacobian(model, data, body, &carried, -1.0, jacobian);
    }
    to_axes(&reference.in_world(data).rotation, model.dof(), jacobian);
}

/// World components to components along the columns of `rotation`.
fn to_axes(rotation: &Matrix3<f64>, n: usize, jacobian: &mut [f64]) {
    if *rotation == Matrix3::identity() {
        return;
    }
    for part in 0..2 {
        for column in 0..n {
            let at = |row: usize| (3 * part + row) * n + column;
            let v = rotation.tr_mul(&Vector3::new(jacobian[at(0)], jacobian[at(1)], jacobian[at(2)]));
            (0..3).for_each(|row| jacobian[at(row)] = v[row]);
        }
    }
}
