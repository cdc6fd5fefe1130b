//! The closed form of an arm of a model, from world to tool.

use crate::kinematics::error::InverseError;
use crate::kinematics::ortho_parallel::OrthoParallel;
use crate::kinematics::range::JointRange;
use crate::kinematics::solution::{Solution, Solutions};
use blocksim_multibody::Placement;

/// How far a rotation may be from orthonormal.
const ROTATION_TOLERANCE: f64 = 1e-6;
/// Squares of distances that differ by less are the same, rad².
const ROUNDING: f64 = 1e-15;

/// Inverse kinematics in closed form of a six-axis arm of a [`Model`](blocksim_multibody::Model).
///
/// ```
/// use blocksim_robotics::kinematics::ClosedForm;
/// use blocksim_multibody::{Frame, Inertia, Joint, ModelBuilder, Placement};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
/// let mut builder = ModelBuilder::new();
/// let mut last = None;
/// for (origin, axis) in [
///     ([0.0, 0.0, 0.4], z), ([0.1, 0.0, 0.0], y), ([0.0, 0.0, 0.9], y),
///     ([0.0, 0.0, 0.1], x), ([0.8, 0.0, 0.0], y), ([0.1, 0.0, 0.0], x),
/// ] {
///     let place = Placement::from_translation(origin);
///     last = Some(builder.add_body(last, Joint::revolute(axis), place, Inertia::zero())?);
/// }
/// let arm = builder.build();
/// let tool = Frame::of(last.ok_or("no axis")?).at(Placement::from_translation([0.2, 0.0, 0.0]));
/// let closed_form = ClosedForm::of(&arm, &tool)?;
/// let q = [0.1, 0.2, -0.3, 0.4, 0.5, 0.6];
/// let solutions = closed_form.inverse(&closed_form.forward(&q), &q)?;
/// assert_eq!(solutions.len(), 8);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedForm {
    /// Where the first frame of the arm is in the world: z on axis 1.
    pub base: Placement,
    /// Dimensions of the arm.
    pub geometry: OrthoParallel,
    /// Where the frame that targets are given for (tool, flange) is in the last frame of the arm.
    pub end: Placement,
}

impl ClosedForm {
    /// Placement of the end frame in the world at joint positions q (rad).
    pub fn forward(&self, q: &[f64; 6]) -> Placement {
        self.base * self.geometry.forward(q) * self.end
    }

    /// All joint positions in (-π, π] that bring the end frame to `target` (in the world), without regard to limits.
    /// Angles that are free at a singularity are taken from `near`.
    ///
    /// # Errors
    /// [`InverseError::NotFinite`], [`InverseError::NotRotation`], [`InverseError::Unreachable`].
    pub fn inverse(&self, target: &Placement, near: &[f64; 6]) -> Result<Solutions, InverseError> {
        let r = &target.rotation;
        let entries = r.iter().chain(target.translation.iter()).chain(near);
        if !entries.fold(0.0, |sum, e| sum + e * 0.0).eq(&0.0) {
            return Err(InverseError::NotFinite);
        }
        let error = (r.tr_mul(r) - nalgebra::Matrix3::identity()).amax();
        if error > ROTATION_TOLERANCE || r.determinant() < 0.0 {
            return Err(InverseError::NotRotation);
        }
        self.geometry.inverse(&(self.base.inverse() * *target * self.end.inverse()), near)
    }

    /// The joint positions within `ranges` that bring the end frame to `target` and are nearest to `near` (sum of
    /// squares).
    ///
    /// # Errors
    /// Those of [`ClosedForm::inverse`], [`InverseError::RangeCrossed`], [`InverseError::OutsideRanges`].
    pub fn nearest(
        &self,
        target: &Placement,
        near: &[f64; 6],
        ranges: &[JointRange; 6],
    ) -> Result<Solution, InverseError> {
        if let Some(axis) = ranges.iter().position(|range| !range.is_sound()) {
            let JointRange { lower, upper } = ranges[axis];
            return Err(InverseError::RangeCrossed { axis, lower, upper });
        }
        let solutions = self.inverse(target, near)?;
        let mut best: Option<Solution> = None;
        let mut miss = (0, f64::INFINITY);
        for solution in solutions.iter() {
            let mut take = |found: Solution| {
                if best.is_none_or(|best| found.distance(near) + ROUNDING < best.distance(near)) {
                    best = Some(found);
                }
            };
            match solution.turned(ranges, near) {
                Ok(turned) => {
                    take(turned);
                    // Not a rounding away from where the joints were.
                    solution.shared(ranges, near).into_iter().for_each(take);
                }
                Err((axis, excess)) if excess < miss.1 => miss = (axis, excess),
                Err(_) => {}
            }
        }
        best.ok_or(InverseError::OutsideRanges { axis: miss.0, excess: miss.1 })
    }
}
