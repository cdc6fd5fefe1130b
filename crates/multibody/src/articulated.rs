//! Articulated inertias, kept as three 3x3 blocks, two of them symmetric.

use crate::joint::Joint;
use crate::placement::Placement;
use crate::spatial::{Force, Motion};
use crate::spatial_inertia::SpatialInertia;
use crate::symmetric::Symmetric;
use nalgebra::Matrix3;
use std::ops::AddAssign;

/// Inertia of a body with everything that hangs on it by free joints: `[I H; Hᵀ M]`.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ArticulatedInertia {
    /// I: moment per angular acceleration, kg m².
    pub rotational: Symmetric,
    /// H: moment per linear acceleration, kg m.
    pub coupling: Matrix3<f64>,
    /// M: force per linear acceleration, kg.
    mass: Symmetric,
}

impl ArticulatedInertia {
    #[inline(always)]
    pub fn rigid(i: &SpatialInertia) -> Self {
        let m = i.mass;
        ArticulatedInertia {
            rotational: i.rotational,
            // H = [h]×
            coupling: i.moment.cross_matrix(),
            mass: Symmetric { xx: m, yy: m, zz: m, yz: 0.0, zx: 0.0, xy: 0.0 },
        }
    }

    /// `Iᴬ m` = (I ω + H v, Hᵀ ω + M v).
    #[inline(always)]
    pub fn times(&self, m: &Motion) -> Force {
        Force {
            angular: self.rotational.times(&m.angular) + self.coupling * m.linear,
            linear: self.coupling.tr_mul(&m.angular) + self.mass.times(&m.linear),
        }
    }

    /// `Iᴬ s`.
    #[inline(always)]
    pub fn column(&self, joint: &Joint) -> Force {
        match joint {
            Joint::Prismatic { axis } => {
                Force { angular: self.coupling * axis, linear: self.mass.times(axis) }
            }
            Joint::Revolute { axis } => {
                Force { angular: self.rotational.times(axis), linear: self.coupling.tr_mul(axis) }
            }
            Joint::Spherical => Force::default(),
        }
    }

    /// `Iᴬ - U D⁻¹ Uᵀ` of a spherical joint, where `U = (I, Hᵀ)`.
    pub fn minus_ball(&self, d_inverse: &Symmetric) -> Self {
        let (i, h, d) = (self.rotational.full(), &self.coupling, d_inverse.full());
        let (di, dh) = (d * i, d * h);
        ArticulatedInertia {
            rotational: Symmetric::from_upper(&(i - i * di)),
            coupling: h - i * dh,
            mass: Symmetric::from_upper(&(self.mass.full() - h.tr_mul(&dh))),
        }
    }

    /// `Iᴬ - U Uᵀ / D`.
    #[inline(always)]
    pub fn minus_outer(&self, k: f64, u: &Force) -> Self {
        ArticulatedInertia {
            rotational: self.rotational.minus_outer(k, &u.angular),
            coupling: self.coupling - (u.angular * k) * u.linear.transpose(),
            mass: self.mass.minus_outer(k, &u.linear),
        }
    }

    /// `ᵖX꜀* Iᴬ ᶜXₚ`.
    #[inline(always)]
    pub fn in_parent(&self, x: &Placement) -> Self {
        let (r, p) = (&x.rotation, &x.translation);
        // M' = R M Rᵀ,  G = R H Rᵀ,  H' = G + [p]× M'
        let mass = self.mass.rotated(r);
        let g = r * self.coupling * r.transpose();
        let coupling = g + p.cross_matrix() * mass.full();
        // I' = R I Rᵀ + [p]× Gᵀ - H' [p]×
        let rotational = self.rotational.rotated(r)
            + Symmetric::from_upper(&(p.cross_matrix() * g.transpose() - coupling * p.cross_matrix()));
        ArticulatedInertia { rotational, coupling, mass }
    }
}

impl AddAssign for ArticulatedInertia {
    #[inline(always)]
    fn add_assign(&mut self, b: ArticulatedInertia) {
        self.rotational += b.rotational;
        self.coupling += b.coupling;
        self.mass += b.mass;
    }
}
