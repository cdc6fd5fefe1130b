//! The closed form of an arm of a model, from world to tool.

use crate::kinematics::error::InverseError;
use crate::kinematics::ortho_parallel::OrthoParallel;
use crate::kinematics::range::JointRange;
use crate::kinematics::solution::{Configuration, Solution, Solutions};
use blocksim_multibody::Placement;
use std::f64::consts::TAU;

/// How far a rotation may be from orthonormal.
const ROTATION_TOLERANCE: f64 = 1e-6;
/// Squares of distances that differ by less are the same, rad².
const ROUNDING: f64 = 1e-15;
/// Angles of a free axis that are tried to a turn.
const TRIED: usize = 720;
/// How often the neighbourhood of the best of them is divided: down to rounding.
const DIVISIONS: usize = 24;

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
    /// squares). Where an axis is free its angle is looked for, too: at every half degree, and from the best of these on to rounding.
    ///
    /// # Errors
    /// Those of [`ClosedForm::inverse`], [`InverseError::RangeCrossed`], [`InverseError::OutsideRanges`].
    pub fn nearest(
        &self,
        target: &Placement,
        near: &[f64; 6],
        ranges: &[JointRange; 6],
    ) -> Result<Solution, InverseError> {
        self.nearest_of(target, near, ranges, |_| true)
    }

    /// As [`ClosedForm::nearest`], of the solutions that are wanted.
    ///
    /// # Errors
    /// Those of [`ClosedForm::nearest`], [`InverseError::OtherConfiguration`].
    pub fn nearest_of(
        &self,
        target: &Placement,
        near: &[f64; 6],
        ranges: &[JointRange; 6],
        wanted: impl Fn(&Configuration) -> bool,
    ) -> Result<Solution, InverseError> {
        if let Some(axis) = ranges.iter().position(|range| !range.is_sound()) {
            let JointRange { lower, upper } = ranges[axis];
            return Err(InverseError::RangeCrossed { axis, lower, upper });
        }
        let here = self.base.inverse() * *target * self.end.inverse();
        let mut search = Search { near, ranges, wanted, best: None, miss: (0, f64::INFINITY), others: false };
        search.look(&self.inverse(target, near)?);
        for axis in self.geometry.free_axes(&here) {
            search.along(axis, |from| self.geometry.inverse(&here, from).ok());
        }
        search.end()
    }
}

/// The solution nearest to `near` among those that have been looked at.
struct Search<'a, W> {
    near: &'a [f64; 6],
    ranges: &'a [JointRange; 6],
    wanted: W,
    best: Option<Solution>,
    /// The axis that misses its range by the least, and by how much.
    miss: (usize, f64),
    /// Whether there are solutions within the ranges that are not wanted.
    others: bool,
}

impl<W: Fn(&Configuration) -> bool> Search<'_, W> {
    fn look(&mut self, solutions: &Solutions) {
        for solution in solutions.iter() {
            match solution.turned(self.ranges, self.near) {
                Ok(_) if !(self.wanted)(&solution.configuration) => self.others = true,
                Ok(turned) => {
                    self.take(turned);
                    // Not a rounding away from where the joints were.
                    solution.shared(self.ranges, self.near).into_iter().for_each(|shared| self.take(shared));
                }
                Err((axis, excess)) if excess < self.miss.1 => self.miss = (axis, excess),
                Err(_) => {}
            }
        }
    }

    fn take(&mut self, found: Solution) {
        if self.best.is_none_or(|best| found.distance(self.near) + ROUNDING < best.distance(self.near)) {
            self.best = Some(found);
        }
    }

    /// Tries the angles of a free axis: one turn of them first, then ever closer to the best.
    fn along(&mut self, axis: usize, solve: impl Fn(&[f64; 6]) -> Option<Solutions>) {
        let try_at = |search: &mut Self, angle: f64| {
            let mut from = *search.near;
            from[axis] = angle;
            solve(&from).iter().for_each(|solutions| search.look(solutions));
        };
        let mut step = TAU / TRIED as f64;
        (1..TRIED).for_each(|i| try_at(self, self.near[axis] + i as f64 * step));
        for _ in 0..DIVISIONS {
            let Some(best) = self.best else { return };
            step /= 4.0;
            (1..=4).for_each(|i| {
                try_at(self, best.q[axis] - f64::from(i) * step);
                try_at(self, best.q[axis] + f64::from(i) * step);
            });
        }
    }

    fn end(self) -> Result<Solution, InverseError> {
        let (axis, excess) = self.miss;
        match self.others {
            true => self.best.ok_or(InverseError::OtherConfiguration),
            false => self.best.ok_or(InverseError::OutsideRanges { axis, excess }),
        }
    }
}
