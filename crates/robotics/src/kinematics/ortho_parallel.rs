//! The closed form itself: arms with an ortho-parallel basis and a spherical wrist, in their own frames.

use crate::kinematics::error::InverseError;
use crate::kinematics::solution::{Configuration, Elbow, Shoulder, Singular, Solution, Solutions, Wrist};
use blocksim_multibody::Placement;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{PI, TAU};

/// How far beyond stretched the wrist may lie by rounding, m.
const REACH: f64 = 1e-10;
/// Below this sines (and distances in m) count as zero: a singularity.
const SINGULAR: f64 = 1e-10;

/// Dimensions of a six-axis arm whose axes 1 and 2 are perpendicular, 2 and 3 parallel, 3 and 4 perpendicular, and
/// whose axes 4, 5 and 6 meet at right angles in one point, the wrist centre.
///
/// With all angles θ zero the arm stands upright: axes 1, 4 and 6 point along z, axes 2, 3 and 5 along y; axis 2 is at
/// (a1, ·, c1), axis 3 at (a1, ·, c1 + c2), the wrist centre at (a1 + a2, b, c1 + c2 + c3), the last frame c4 above
/// it. The joint positions are counted by `θ = sign q - offset`.
///
/// Source of the parametrisation: M. Brandstötter, A. Angerer, M. Hofbaur, An analytical solution of the inverse
/// kinematics problem of industrial serial manipulators with an ortho-parallel basis and a spherical wrist, Austrian
/// Robotics Workshop (2014).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrthoParallel {
    /// From axis 1 to axis 2, m.
    pub a1: f64,
    /// From axis 3 to axis 4, m.
    pub a2: f64,
    /// Sideways from axis 1 to the wrist centre, m.
    pub b: f64,
    /// Height of axis 2, m.
    pub c1: f64,
    /// Length of the upper arm, from axis 2 to axis 3, m.
    pub c2: f64,
    /// Length of the forearm, along axis 4 from axis 3 to the wrist centre, m.
    pub c3: f64,
    /// From the wrist centre to the last frame, m.
    pub c4: f64,
    /// Senses of rotation, 1 or -1.
    pub signs: [f64; 6],
    /// Offsets of the angles, rad.
    pub offsets: [f64; 6],
}

impl OrthoParallel {
    /// The last frame at joint positions q.
    pub fn forward(&self, q: &[f64; 6]) -> Placement {
        let t = self.angles(q);
        let [turn, arm] = [rz(t[0]), ry(t[1])];
        let fore = ry(t[1] + t[2]);
        let centre = Vector3::new(self.a1, self.b, self.c1)
            + arm * Vector3::new(0.0, 0.0, self.c2)
            + fore * Vector3::new(self.a2, 0.0, self.c3);
        let rotation = turn * fore * rz(t[3]) * ry(t[4]) * rz(t[5]);
        Placement { rotation, translation: turn * centre + rotation.column(2) * self.c4 }
    }

    /// All joint positions in (-π, π] that bring the last frame to `target`. Angles that are free at a singularity are
    /// taken from `near`.
    ///
    /// # Errors
    /// [`InverseError::Unreachable`].
    pub fn inverse(&self, target: &Placement, near: &[f64; 6]) -> Result<Solutions, InverseError> {
        let near = self.angles(near);
        let c = target.translation - target.rotation.column(2) * self.c4;
        let radius = c.x.hypot(c.y);
        // in the plane of the arm the wrist centre is at ρ from axis 1, b beside it
        let inside = self.b.abs() - radius;
        if inside > REACH {
            return Err(InverseError::Unreachable { distance: inside });
        }
        let rho = (-inside * (radius + self.b.abs())).max(0.0).sqrt();
        let free = radius < SINGULAR;
        let mut solutions = Solutions::none();
        let mut shortage = f64::INFINITY;
        for (shoulder, side) in [(Shoulder::Front, 1.0), (Shoulder::Back, -1.0)] {
            if shoulder == Shoulder::Back && rho < SINGULAR && !free {
                // both are one
                continue;
            }
            let t1 = match free {
                true if shoulder == Shoulder::Front => near[0],
                true => near[0] + PI,
                false => c.y.atan2(c.x) - self.b.atan2(side * rho),
            };
            let mut singular = Singular { shoulder: rho < SINGULAR, ..Singular::default() };
            match self.bend(side * rho - self.a1, c.z - self.c1, near[1]) {
                Err(distance) => shortage = shortage.min(distance),
                Ok((bends, one)) => {
                    singular.elbow = one;
                    for (i, (t2, t3)) in bends.into_iter().enumerate().take(if one { 1 } else { 2 }) {
                        // the first is bent forward
                        let elbow = if (i == 0) == (side > 0.0) { Elbow::Up } else { Elbow::Down };
                        self.hand(
                            &target.rotation,
                            &near,
                            [t1, t2, t3],
                            (shoulder, elbow, singular),
                            &mut solutions,
                        );
                    }
                }
            }
        }
        match solutions.is_empty() {
            true => Err(InverseError::Unreachable { distance: shortage }),
            false => Ok(solutions),
        }
    }

    /// Axes whose angle `target` leaves free, but for those of the wrist: the wrist centre lies on axis 1, or (where upper arm and forearm
    /// are equally long) on axis 2.
    pub(crate) fn free_axes(&self, target: &Placement) -> impl Iterator<Item = usize> {
        let c = target.translation - target.rotation.column(2) * self.c4;
        let radius = c.x.hypot(c.y);
        let rho = ((radius - self.b.abs()) * (radius + self.b.abs())).max(0.0).sqrt();
        let is_on_second = |side: f64| (side * rho - self.a1).hypot(c.z - self.c1) < SINGULAR;
        let free = [radius < SINGULAR, is_on_second(1.0) || is_on_second(-1.0)];
        (0..2).filter(move |axis| free[*axis])
    }

    /// θ₂ and θ₃ that bring the wrist centre to (u, w) from axis 2, u ahead and w up, and whether both pairs are one;
    /// else by how much the arm is too short or too long.
    fn bend(&self, u: f64, w: f64, near: f64) -> Result<([(f64, f64); 2], bool), f64> {
        let (upper, fore) = (self.c2, self.a2.hypot(self.c3));
        let s = u.hypot(w);
        let (longest, shortest) = (upper + fore, (upper - fore).abs());
        let outside = (s - longest).max(shortest - s);
        if outside > REACH {
            return Err(outside);
        }
        // s² = c2² + k² + 2 c2 k cos φ, as the half angle: accurate when stretched and when folded
        let sin = ((longest - s) * (longest + s)).max(0.0).sqrt();
        let cos = ((s - shortest) * (s + shortest)).max(0.0).sqrt();
        let phi = 2.0 * sin.atan2(cos);
        let lag = self.a2.atan2(self.c3);
        let towards = if s < SINGULAR { near } else { u.atan2(w) };
        let (sin_phi, cos_phi) = phi.sin_cos();
        let behind = match s < SINGULAR {
            true => 0.0,
            false => (fore * sin_phi).atan2(upper + fore * cos_phi),
        };
        let pairs = [(towards - behind, phi - lag), (towards + behind, -phi - lag)];
        Ok((pairs, sin_phi.abs() < SINGULAR))
    }

    /// Adds both wrist solutions for an arm.
    fn hand(
        &self,
        rotation: &Matrix3<f64>,
        near: &[f64; 6],
        [t1, t2, t3]: [f64; 3],
        (shoulder, elbow, singular): (Shoulder, Elbow, Singular),
        solutions: &mut Solutions,
    ) {
        let ((s1, c1), (s, c)) = (t1.sin_cos(), (t2 + t3).sin_cos());
        // columns of the forearm Rz(θ1) Ry(θ2 + θ3), in which R = Rz(θ4) Ry(θ5) Rz(θ6)
        let (x, y, z) =
            (Vector3::new(c1 * c, s1 * c, -s), Vector3::new(-s1, c1, 0.0), Vector3::new(c1 * s, s1 * s, c));
        let (r0, r1, r2) = (rotation.column(0), rotation.column(1), rotation.column(2));
        let (rx, ry, rz) = (x.dot(&r2), y.dot(&r2), z.dot(&r2));
        let sin = rx.hypot(ry);
        let straight = sin < SINGULAR;
        let (t4, s4, c4) = match straight {
            true => (near[3], near[3].sin(), near[3].cos()),
            false => (ry.atan2(rx), ry / sin, rx / sin),
        };
        let t5 = sin.atan2(rz);
        // second row of Ry(θ5) Rz(θ6) = Rz(-θ4) R: θ6 makes good what θ4 lacks near the singularity
        let t6 = (c4 * y.dot(&r0) - s4 * x.dot(&r0)).atan2(c4 * y.dot(&r1) - s4 * x.dot(&r1));
        let singular = Singular { wrist: straight, ..singular };
        let mut add = |wrist, angles| {
            let configuration = Configuration { shoulder, elbow, wrist };
            let (q, sense) = (self.positions(angles), self.signs[3] * self.signs[5]);
            solutions.push(Solution { q, configuration, singular, sense });
        };
        add(Wrist::Plain, [t1, t2, t3, t4, t5, t6]);
        add(Wrist::Flipped, [t1, t2, t3, t4 + PI, -t5, t6 + PI]);
    }

    fn angles(&self, q: &[f64; 6]) -> [f64; 6] {
        std::array::from_fn(|i| self.signs[i] * q[i] - self.offsets[i])
    }

    fn positions(&self, t: [f64; 6]) -> [f64; 6] {
        std::array::from_fn(|i| {
            let q = self.signs[i] * (t[i] + self.offsets[i]);
            q - TAU * ((q - PI) / TAU).ceil()
        })
    }
}

fn rz(angle: f64) -> Matrix3<f64> {
    let (s, c) = angle.sin_cos();
    Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
}

fn ry(angle: f64) -> Matrix3<f64> {
    let (s, c) = angle.sin_cos();
    Matrix3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c)
}
