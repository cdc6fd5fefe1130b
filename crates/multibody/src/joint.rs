//! Joints: everything that depends on the kind of a joint is in this file.

use crate::placement::Placement;
use crate::quaternion;
use crate::spatial::{Force, Motion};
use crate::spatial_inertia::SpatialInertia;
use nalgebra::{Matrix3, Vector3};

/// How a body moves against its parent.
///
/// The axis is a direction in the joint frame; its length does not matter. The body frame coincides with
/// the joint frame at coordinate zero (or at the unit quaternion).
///
/// All other joints are exact chains of these with bodies that have no mass in between: see
/// [`Joint::cylindrical`], [`Joint::planar`], [`Joint::universal`], [`Joint::cartesian`], [`Joint::free`] and
/// [`ModelBuilder::add_chain`](crate::ModelBuilder::add_chain).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Joint {
    /// Rotation about an axis; coordinate in rad, right-handed.
    Revolute {
        /// Direction of the axis.
        axis: Vector3<f64>,
    },
    /// Translation along an axis; coordinate in m.
    Prismatic {
        /// Direction of the axis.
        axis: Vector3<f64>,
    },
    /// Any rotation about the common origin. Positions: a quaternion (w, x, y, z) that turns the child against
    /// the parent; only its direction counts, so that rounding never bends a body. Speeds: the angular velocity
    /// in the axes of the child, rad/s.
    Spherical,
}

impl Joint {
    /// Rotation about `axis`.
    pub fn revolute(axis: impl Into<Vector3<f64>>) -> Self {
        Joint::Revolute { axis: axis.into() }
    }

    /// Translation along `axis`.
    pub fn prismatic(axis: impl Into<Vector3<f64>>) -> Self {
        Joint::Prismatic { axis: axis.into() }
    }

    /// Translation along `axis` and rotation about it.
    pub fn cylindrical(axis: impl Into<Vector3<f64>>) -> [Self; 2] {
        let axis = axis.into();
        [Joint::prismatic(axis), Joint::revolute(axis)]
    }

    /// Translations along x and y of the parent, then rotation about z.
    pub fn planar() -> [Self; 3] {
        [Joint::prismatic(Vector3::x()), Joint::prismatic(Vector3::y()), Joint::revolute(Vector3::z())]
    }

    /// Rotation about `first`, then about `second`, which turns with the first: a Cardan joint.
    pub fn universal(first: impl Into<Vector3<f64>>, second: impl Into<Vector3<f64>>) -> [Self; 2] {
        [Joint::revolute(first), Joint::revolute(second)]
    }

    /// Translations along x, y and z.
    pub fn cartesian() -> [Self; 3] {
        [Vector3::x(), Vector3::y(), Vector3::z()].map(Joint::prismatic)
    }

    /// All six degrees of freedom: translations along the axes of the parent, then any rotation. The linear
    /// speeds are those of the body's origin in the axes of the parent.
    pub fn free() -> [Self; 4] {
        let [x, y, z] = Joint::cartesian();
        [x, y, z, Joint::Spherical]
    }

    /// Direction of the axis; a spherical joint has none.
    pub fn axis(&self) -> Option<Vector3<f64>> {
        match *self {
            Joint::Revolute { axis } | Joint::Prismatic { axis } => Some(axis),
            Joint::Spherical => None,
        }
    }

    /// Number of positions: 1, or 4 of a spherical joint.
    pub fn positions(&self) -> usize {
        if matches!(self, Joint::Spherical) { 4 } else { 1 }
    }

    /// Number of speeds: 1, or 3 of a spherical joint.
    #[inline(always)]
    pub fn speeds(&self) -> usize {
        if matches!(self, Joint::Spherical) { 3 } else { 1 }
    }

    /// The same joint with an axis of length one, or `None` where the axis has no direction.
    pub(crate) fn normalized(&self) -> Option<Self> {
        let Some(axis) = self.axis() else { return Some(*self) };
        let length = axis.norm();
        if !length.is_finite() || length == 0.0 {
            return None;
        }
        Some(match *self {
            Joint::Prismatic { axis } => Joint::Prismatic { axis: axis / length },
            _ => Joint::Revolute { axis: axis / length },
        })
    }

    /// Column `k` of the motion subspace `S` in body coordinates.
    #[inline(always)]
    pub(crate) fn subspace(&self, k: usize) -> Motion {
        match *self {
            Joint::Revolute { axis } => Motion { angular: axis, linear: Vector3::zeros() },
            Joint::Prismatic { axis } => Motion { angular: Vector3::zeros(), linear: axis },
            Joint::Spherical => {
                let mut angular = Vector3::zeros();
                angular[k] = 1.0;
                Motion { angular, linear: Vector3::zeros() }
            }
        }
    }

    /// `m + S rates`; `rate(k)` is the k-th of the joint.
    #[inline(always)]
    pub(crate) fn add_motion(&self, m: Motion, rate: impl Fn(usize) -> f64) -> Motion {
        match self {
            Joint::Revolute { axis } => Motion { angular: m.angular + axis * rate(0), ..m },
            Joint::Prismatic { axis } => Motion { linear: m.linear + axis * rate(0), ..m },
            Joint::Spherical => Motion { angular: m.angular + three(rate), ..m },
        }
    }

    /// `v × S rates`.
    #[inline(always)]
    pub(crate) fn cross_motion(&self, v: &Motion, rate: impl Fn(usize) -> f64) -> Motion {
        let turn = match self {
            Joint::Revolute { axis } => axis * rate(0),
            Joint::Prismatic { axis } => {
                return Motion { angular: Vector3::zeros(), linear: v.angular.cross(&(axis * rate(0))) };
            }
            Joint::Spherical => three(rate),
        };
        Motion { angular: v.angular.cross(&turn), linear: v.linear.cross(&turn) }
    }

    /// `Sᵀ f`: the part of a force that the joint's actuator feels, N m or N; `write(k, value)` takes it.
    #[inline(always)]
    pub(crate) fn project(&self, f: &Force, mut write: impl FnMut(usize, f64)) {
        match self {
            Joint::Revolute { axis } => write(0, axis.dot(&f.angular)),
            Joint::Prismatic { axis } => write(0, axis.dot(&f.linear)),
            Joint::Spherical => (0..3).for_each(|k| write(k, f.angular[k])),
        }
    }

    /// Column `k` of `I S`.
    #[inline(always)]
    pub(crate) fn inertia_force(&self, inertia: &SpatialInertia, k: usize) -> Force {
        match self {
            Joint::Revolute { axis } => {
                Force { angular: inertia.rotational.times(axis), linear: axis.cross(&inertia.moment) }
            }
            Joint::Prismatic { axis } => {
                Force { angular: inertia.moment.cross(axis), linear: axis * inertia.mass }
            }
            Joint::Spherical => inertia.times(&self.subspace(k)),
        }
    }
}

#[inline(always)]
fn three(rate: impl Fn(usize) -> f64) -> Vector3<f64> {
    Vector3::new(rate(0), rate(1), rate(2))
}

/// A joint at its place on the parent, prepared so that a placement costs one sine and one cosine.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MountedJoint {
    pub joint: Joint,
    /// Placement of the joint frame in the parent.
    pub home: Placement,
    /// `P [axis]×` of a revolute joint mounted with rotation `P`.
    sine: Matrix3<f64>,
    /// `P [axis]×²`.
    versine: Matrix3<f64>,
}

impl MountedJoint {
    /// `joint` must have an axis of length one.
    pub fn new(joint: Joint, home: Placement) -> Self {
        let cross = joint.axis().unwrap_or_else(Vector3::zeros).cross_matrix();
        let sine = home.rotation * cross;
        MountedJoint { joint, home, sine, versine: sine * cross }
    }

    /// Placement of the body in its parent; `q(k)` is the k-th position of the joint.
    #[inline(always)]
    pub fn placement(&self, q: impl Fn(usize) -> f64) -> Placement {
        match self.joint {
            Joint::Revolute { .. } => {
                // Rodrigues: R = P (1 + sin q [axis]× + (1 - cos q) [axis]×²)
                let (sin, cos) = q(0).sin_cos();
                let rotation = self.home.rotation + self.sine * sin + self.versine * (1.0 - cos);
                Placement { rotation, translation: self.home.translation }
            }
            Joint::Prismatic { axis } => {
                let translation = self.home.translation + self.home.rotation * (axis * q(0));
                Placement { rotation: self.home.rotation, translation }
            }
            Joint::Spherical => {
                let turn = quaternion::rotation([q(0), q(1), q(2), q(3)]);
                Placement { rotation: self.home.rotation * turn, translation: self.home.translation }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds() -> [Joint; 5] {
        let skew = Vector3::new(0.6, 0.0, 0.8);
        [
            Joint::revolute([0.0, 1.0, 0.0]),
            Joint::revolute(skew),
            Joint::prismatic([1.0, 0.0, 0.0]),
            Joint::prismatic(skew),
            Joint::Spherical,
        ]
    }

    #[test]
    fn a_placement_moves_along_the_motion_subspace() {
        const STEP: f64 = 1e-6;
        let home = Placement::from_rpy([0.3, -0.2, 0.9], [0.4, -1.0, 2.2]);
        for joint in kinds() {
            let mount = MountedJoint::new(joint, home);
            let at_home = [if joint == Joint::Spherical { 1.0 } else { 0.0 }, 0.0, 0.0, 0.0];
            assert_eq!(mount.placement(|k| at_home[k]), home);
            for k in 0..joint.speeds() {
                let at = |step: f64| match joint {
                    Joint::Spherical => {
                        let mut turn = Vector3::zeros();
                        turn[k] = step;
                        let q = quaternion::product([0.8, 0.1, -0.3, 0.4], quaternion::exponential(&turn));
                        mount.placement(|k| q[k])
                    }
                    _ => mount.placement(|_| 0.7 + step),
                };
                let (ahead, here, behind) = (at(STEP), at(0.0), at(-STEP));
                assert!(here.rotation_error() < 1e-15);
                // Ṙ = R [s_ω]×,  ṗ = R s_v
                let s = joint.subspace(k);
                let spin = (ahead.rotation - behind.rotation) / (2.0 * STEP);
                assert!((spin - here.rotation * s.angular.cross_matrix()).abs().max() < 1e-9);
                let slide = (ahead.translation - behind.translation) / (2.0 * STEP);
                assert!((slide - here.direction(&s.linear)).norm() < 1e-9);
            }
        }
    }

    #[test]
    fn the_shortcuts_agree_with_the_motion_subspace() {
        let m = Motion { angular: [0.1, 0.7, -0.4].into(), linear: [1.0, -2.0, 0.5].into() };
        let f = Force { angular: [3.0, 1.0, -2.0].into(), linear: [0.2, 0.6, 5.0].into() };
        let body = crate::Inertia::point(2.0, [0.3, -0.1, 0.6]).map(|i| i.spatial()).unwrap_or_default();
        for joint in kinds() {
            let rates = [1.5, -0.3, 0.8];
            let mut scaled = Motion::default();
            for (k, rate) in rates.iter().enumerate().take(joint.speeds()) {
                let s = joint.subspace(k);
                scaled = scaled + Motion { angular: s.angular * *rate, linear: s.linear * *rate };
                joint.project(&f, |other, value| {
                    assert!(other != k || (value - s.dot(&f)).abs() < 1e-15);
                });
                let (got, expected) = (joint.inertia_force(&body, k), body.times(&s));
                assert!((got.angular - expected.angular).norm() < 1e-15);
                assert!((got.linear - expected.linear).norm() < 1e-15);
            }
            assert_eq!(joint.add_motion(m, |k| rates[k]), m + scaled);
            assert_eq!(joint.cross_motion(&m, |k| rates[k]), m.cross(&scaled));
        }
    }
}
