//! Symmetric 3x3 matrices by their six numbers: the rotational inertias of the hot loops.

use nalgebra::{Matrix3, Vector3};
use std::ops::{Add, AddAssign};

/// A symmetric 3x3 matrix.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Symmetric {
    pub xx: f64,
    pub yy: f64,
    pub zz: f64,
    pub yz: f64,
    pub zx: f64,
    pub xy: f64,
}

impl Symmetric {
    /// The upper triangle of `m`.
    pub fn from_upper(m: &Matrix3<f64>) -> Self {
        Symmetric { xx: m.m11, yy: m.m22, zz: m.m33, yz: m.m23, zx: m.m13, xy: m.m12 }
    }

    /// The whole matrix.
    pub fn full(&self) -> Matrix3<f64> {
        Matrix3::new(self.xx, self.xy, self.zx, self.xy, self.yy, self.yz, self.zx, self.yz, self.zz)
    }

    /// The product with a vector.
    #[inline(always)]
    pub fn times(&self, u: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            self.xx * u.x + self.xy * u.y + self.zx * u.z,
            self.xy * u.x + self.yy * u.y + self.yz * u.z,
            self.zx * u.x + self.yz * u.y + self.zz * u.z,
        )
    }

    /// `k A`.
    pub fn scaled(&self, k: f64) -> Self {
        Symmetric {
            xx: k * self.xx,
            yy: k * self.yy,
            zz: k * self.zz,
            yz: k * self.yz,
            zx: k * self.zx,
            xy: k * self.xy,
        }
    }

    /// The inverse by cofactors; not finite where there is none.
    pub fn inverse(&self) -> Self {
        let (xx, yy, zz) = (
            self.yy * self.zz - self.yz * self.yz,
            self.xx * self.zz - self.zx * self.zx,
            self.xx * self.yy - self.xy * self.xy,
        );
        let (yz, zx, xy) = (
            self.zx * self.xy - self.xx * self.yz,
            self.xy * self.yz - self.zx * self.yy,
            self.zx * self.yz - self.xy * self.zz,
        );
        let k = 1.0 / (self.xx * xx + self.xy * xy + self.zx * zx);
        Symmetric { xx: k * xx, yy: k * yy, zz: k * zz, yz: k * yz, zx: k * zx, xy: k * xy }
    }

    /// `R A Rᵀ`, of which only the upper triangle is computed.
    #[inline(always)]
    pub fn rotated(&self, r: &Matrix3<f64>) -> Self {
        // rows of R A; A is symmetric, so they are A times the rows of R
        let (r1, r2, r3) = (row(r, 0), row(r, 1), row(r, 2));
        let (t1, t2, t3) = (self.times(&r1), self.times(&r2), self.times(&r3));
        Symmetric {
            xx: dot(&t1, &r1),
            yy: dot(&t2, &r2),
            zz: dot(&t3, &r3),
            yz: dot(&t2, &r3),
            zx: dot(&t3, &r1),
            xy: dot(&t1, &r2),
        }
    }

    /// `A - k u uᵀ`.
    #[inline(always)]
    pub fn minus_outer(&self, k: f64, u: &Vector3<f64>) -> Self {
        let (x, y, z) = (k * u.x, k * u.y, k * u.z);
        Symmetric {
            xx: self.xx - x * u.x,
            yy: self.yy - y * u.y,
            zz: self.zz - z * u.z,
            yz: self.yz - y * u.z,
            zx: self.zx - z * u.x,
            xy: self.xy - x * u.y,
        }
    }
}

#[inline(always)]
fn row(m: &Matrix3<f64>, i: usize) -> Vector3<f64> {
    Vector3::new(m[(i, 0)], m[(i, 1)], m[(i, 2)])
}

#[inline(always)]
fn dot(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

impl Add for Symmetric {
    type Output = Symmetric;

    #[inline(always)]
    fn add(self, b: Symmetric) -> Symmetric {
        Symmetric {
            xx: self.xx + b.xx,
            yy: self.yy + b.yy,
            zz: self.zz + b.zz,
            yz: self.yz + b.yz,
            zx: self.zx + b.zx,
            xy: self.xy + b.xy,
        }
    }
}

impl AddAssign for Symmetric {
    #[inline(always)]
    fn add_assign(&mut self, b: Symmetric) {
        *self = *self + b;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::placement::Placement;

    const A: Symmetric = Symmetric { xx: 1.0, yy: 2.0, zz: 3.0, yz: 0.4, zx: -0.5, xy: 0.6 };

    #[test]
    fn six_numbers_stand_for_the_whole_matrix() {
        let u = Vector3::new(0.3, -0.7, 1.1);
        assert_eq!(Symmetric::from_upper(&A.full()), A);
        assert!((A.times(&u) - A.full() * u).norm() < 1e-15);
        let minus = A.full() - u * u.transpose() * 0.8;
        assert!((A.inverse().full() * A.full() - Matrix3::identity()).abs().max() < 1e-14);
        assert!((A.minus_outer(0.8, &u).full() - minus).abs().max() < 1e-15);
    }

    #[test]
    fn rotation_is_the_triple_product() {
        let r = Placement::from_rpy([0.0; 3], [0.3, -1.2, 2.0]).rotation;
        let expected = r * A.full() * r.transpose();
        assert!((A.rotated(&r).full() - expected).abs().max() < 1e-15);
    }
}
