//! Joints: everything that depends on the kind of a joint is in this file.

use crate::placement::Placement;
use crate::spatial::{Force, Motion, SpatialInertia};
use nalgebra::{Matrix3, Vector3};

/// How a body moves against its parent: one degree of freedom along or about an axis.
///
/// The axis is a direction in the joint frame; its length does not matter. The body frame coincides with
/// the joint frame at coordinate zero.
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

    /// Direction of the axis.
    pub fn axis(&self) -> Vector3<f64> {
        match *self {
            Joint::Revolute { axis } | Joint::Prismatic { axis } => axis,
        }
    }

    /// The same joint with an axis of length one, or `None` where the axis has no direction.
    pub(crate) fn normalized(&self) -> Option<Self> {
        let length = self.axis().norm();
        if !length.is_finite() || length == 0.0 {
            return None;
        }
        Some(match *self {
            Joint::Revolute { axis } => Joint::Revolute { axis: axis / length },
            Joint::Prismatic { axis } => Joint::Prismatic { axis: axis / length },
        })
    }

    /// Motion subspace `S` in body coordinates.
    #[inline(always)]
    pub(crate) fn subspace(&self) -> Motion {
        match *self {
            Joint::Revolute { axis } => Motion { angular: axis, linear: Vector3::zeros() },
            Joint::Prismatic { axis } => Motion { angular: Vector3::zeros(), linear: axis },
        }
    }

    /// `m + S rate`.
    #[inline(always)]
    pub(crate) fn add_motion(&self, m: Motion, rate: f64) -> Motion {
        match self {
            Joint::Revolute { axis } => Motion { angular: m.angular + axis * rate, ..m },
            Joint::Prismatic { axis } => Motion { linear: m.linear + axis * rate, ..m },
        }
    }

    /// `v × S rate`.
    #[inline(always)]
    pub(crate) fn cross_motion(&self, v: &Motion, rate: f64) -> Motion {
        match self {
            Joint::Revolute { axis } => {
                let turn = axis * rate;
                Motion { angular: v.angular.cross(&turn), linear: v.linear.cross(&turn) }
            }
            Joint::Prismatic { axis } => {
                Motion { angular: Vector3::zeros(), linear: v.angular.cross(&(axis * rate)) }
            }
        }
    }

    /// `Sᵀ f`: the part of a force that the joint's actuator feels, N m or N.
    #[inline(always)]
    pub(crate) fn project(&self, f: &Force) -> f64 {
        match self {
            Joint::Revolute { axis } => axis.dot(&f.angular),
            Joint::Prismatic { axis } => axis.dot(&f.linear),
        }
    }

    /// `I S`.
    #[inline(always)]
    pub(crate) fn inertia_force(&self, inertia: &SpatialInertia) -> Force {
        match self {
            Joint::Revolute { axis } => {
                Force { angular: inertia.rotational.times(axis), linear: axis.cross(&inertia.moment) }
            }
            Joint::Prismatic { axis } => {
                Force { angular: inertia.moment.cross(axis), linear: axis * inertia.mass }
            }
        }
    }
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
        let cross = joint.axis().cross_matrix();
        let sine = home.rotation * cross;
        MountedJoint { joint, home, sine, versine: sine * cross }
    }

    /// Placement of the body in its parent at coordinate `q`.
    #[inline(always)]
    pub fn placement(&self, q: f64) -> Placement {
        match self.joint {
            Joint::Revolute { .. } => {
                // Rodrigues: R = P (1 + sin q [axis]× + (1 - cos q) [axis]×²)
                let (sin, cos) = q.sin_cos();
                let rotation = self.home.rotation + self.sine * sin + self.versine * (1.0 - cos);
                Placement { rotation, translation: self.home.translation }
            }
            Joint::Prismatic { axis } => {
                let translation = self.home.translation + self.home.rotation * (axis * q);
                Placement { rotation: self.home.rotation, translation }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds() -> [Joint; 4] {
        let skew = Vector3::new(0.6, 0.0, 0.8);
        [
            Joint::revolute([0.0, 1.0, 0.0]),
            Joint::revolute(skew),
            Joint::prismatic([1.0, 0.0, 0.0]),
            Joint::prismatic(skew),
        ]
    }

    #[test]
    fn a_placement_moves_along_the_motion_subspace() {
        const STEP: f64 = 1e-6;
        let home = Placement::from_rpy([0.3, -0.2, 0.9], [0.4, -1.0, 2.2]);
        for joint in kinds() {
            let mount = MountedJoint::new(joint, home);
            assert_eq!(mount.placement(0.0), home);
            let (ahead, behind) = (mount.placement(0.7 + STEP), mount.placement(0.7 - STEP));
            let here = mount.placement(0.7);
            assert!(here.rotation_error() < 1e-15);
            // Ṙ = R [s_ω]×,  ṗ = R s_v
            let s = joint.subspace();
            let spin = (ahead.rotation - behind.rotation) / (2.0 * STEP);
            assert!((spin - here.rotation * s.angular.cross_matrix()).abs().max() < 1e-9);
            let slide = (ahead.translation - behind.translation) / (2.0 * STEP);
            assert!((slide - here.direction(&s.linear)).norm() < 1e-9);
        }
    }

    #[test]
    fn the_shortcuts_agree_with_the_motion_subspace() {
        let m = Motion { angular: [0.1, 0.7, -0.4].into(), linear: [1.0, -2.0, 0.5].into() };
        let f = Force { angular: [3.0, 1.0, -2.0].into(), linear: [0.2, 0.6, 5.0].into() };
        let body = crate::Inertia::point(2.0, [0.3, -0.1, 0.6]).map(|i| i.spatial()).unwrap_or_default();
        for joint in kinds() {
            let s = joint.subspace();
            let scaled = Motion { angular: s.angular * 1.5, linear: s.linear * 1.5 };
            assert_eq!(joint.add_motion(m, 1.5), m + scaled);
            assert_eq!(joint.cross_motion(&m, 1.5), m.cross(&scaled));
            assert!((joint.project(&f) - s.dot(&f)).abs() < 1e-15);
            let (got, expected) = (joint.inertia_force(&body), body.times(&s));
            assert!((got.angular - expected.angular).norm() < 1e-15);
            assert!((got.linear - expected.linear).norm() < 1e-15);
        }
    }
}
