//! Denavit-Hartenberg parameters of a chain of axes.

use crate::data::Data;
use crate::frame::Frame;
use crate::joint::Joint;
use crate::kinematics::forward_kinematics;
use crate::model::Model;
use crate::placement::Placement;
use crate::positions::home_positions;
use nalgebra::{Matrix3, Vector3};
use std::error::Error;
use std::f64::consts::PI;
use std::fmt;

/// Sines of angles and distances (m) below this count as zero: axes are then parallel or meet.
const SMALL: f64 = 1e-9;

/// One row: `A = Rz(θ) Tz(d) Tx(a) Rx(α)`, the standard (distal) convention. Frame i sits at the far end of link i, its
/// z axis on joint i + 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DhRow {
    /// Whether the joint slides: its position then adds to d, else to θ.
    pub prismatic: bool,
    /// θ at position zero, rad, in (-π, π].
    pub theta: f64,
    /// d at position zero, m.
    pub d: f64,
    /// a, m, not negative but for rounding.
    pub a: f64,
    /// α, rad, in (-π, π].
    pub alpha: f64,
}

impl DhRow {
    /// `A` at a position of the joint, rad or m.
    pub fn placement(&self, q: f64) -> Placement {
        let (turn, slide) = if self.prismatic { (0.0, q) } else { (q, 0.0) };
        let z = Placement::from_axis_angle([0.0, 0.0, self.d + slide], Vector3::z(), self.theta + turn);
        z * Placement::from_axis_angle([self.a, 0.0, 0.0], Vector3::x(), self.alpha)
    }
}

/// Parameters of a chain in the standard (distal) convention: the end frame is at `base · A₁(q₁) … Aₙ(qₙ) · end` in
/// the base frame.
#[derive(Debug, Clone, PartialEq)]
pub struct DhTable {
    /// Where frame 0 is in the base frame: the identity where the base has its z axis on joint 1.
    pub base: Placement,
    /// One row per joint.
    pub rows: Vec<DhRow>,
    /// Where the end frame is in frame n: the identity where its z axis is that of the last joint.
    pub end: Placement,
}

impl DhTable {
    /// Where the end frame is in the base frame; `q` has one position per row, further ones are ignored.
    pub fn placement(&self, q: &[f64]) -> Placement {
        let chain = self.rows.iter().zip(q).fold(self.base, |t, (row, q)| t * row.placement(*q));
        chain * self.end
    }
}

/// Why a chain has no Denavit-Hartenberg parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DhError {
    /// The base frame is on a body that moves.
    BaseMoves,
    /// The end frame is on the ground.
    NoJoint,
    /// A joint of the chain is spherical.
    Spherical {
        /// Index of its body.
        body: usize,
    },
}

impl fmt::Display for DhError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            DhError::BaseMoves => write!(f, "the base frame is on a body that moves; put it on the ground"),
            DhError::NoJoint => write!(f, "no joint moves the end frame; put it on a body of the chain"),
            DhError::Spherical { body } => write!(
                f,
                "body {body}: a spherical joint has no Denavit-Hartenberg parameters; write it as three axes"
            ),
        }
    }
}

impl Error for DhError {}

/// Standard Denavit-Hartenberg parameters of the chain from `base` (on the ground) to `end` (on a body).
///
/// Where the convention leaves a choice: parallel axes have d = 0, where axes meet x keeps to the side of the x before,
/// and the last frame takes over as much of the end frame as it can.
///
/// Source: Siciliano, Sciavicco, Villani, Oriolo, Robotics (2009), section 2.8.2.
///
/// # Errors
/// See [`DhError`].
pub fn denavit_hartenberg(model: &Model, base: &Frame, end: &Frame) -> Result<DhTable, DhError> {
    if base.body.is_some() {
        return Err(DhError::BaseMoves);
    }
    let last = end.body.ok_or(DhError::NoJoint)?;
    let chain = model.chain(last);
    let mut data = model.data();
    forward_kinematics(model, &mut data, &home_positions(model));
    let mut axes = Vec::new();
    for body in &chain {
        let axis = model.joint(*body).axis().ok_or(DhError::Spherical { body: body.index() })?;
        axes.push(line(base, &Frame::of(*body), &axis, &data));
    }
    let end = end.relative_to(base, &data);
    let mut frame = start(&axes[0]);
    let (first, mut rows) = (frame, Vec::new());
    for (i, body) in chain.iter().enumerate() {
        let next = match axes.get(i + 1) {
            Some(axis) => follow(&frame, axis),
            None => finish(&frame, &end),
        };
        rows.push(row(&frame, &next, matches!(model.joint(*body), Joint::Prismatic { .. })));
        frame = next;
    }
    Ok(DhTable { base: first, rows, end: frame.inverse() * end })
}

/// A point of an axis and its direction.
struct Line {
    point: Vector3<f64>,
    direction: Vector3<f64>,
}

fn line(base: &Frame, body: &Frame, axis: &Vector3<f64>, data: &Data) -> Line {
    let placement = body.relative_to(base, data);
    Line { point: placement.translation, direction: placement.direction(axis) }
}

/// Right-handed frame with these x and z, which are perpendicular.
fn frame(origin: Vector3<f64>, x: &Vector3<f64>, z: &Vector3<f64>) -> Placement {
    let x = (x - z * x.dot(z)).normalize();
    Placement { rotation: Matrix3::from_columns(&[x, z.cross(&x), *z]), translation: origin }
}

/// The part of the first candidate across `z` that is not along it.
fn across(z: &Vector3<f64>, candidates: [Vector3<f64>; 2]) -> Vector3<f64> {
    let [first, second] = candidates.map(|c| c - z * c.dot(z));
    if first.norm() > 1e-3 { first } else { second }
}

/// Frame 0 on axis 1, as near to the base frame as possible.
fn start(axis: &Line) -> Placement {
    let z = &axis.direction;
    let origin = axis.point - z * axis.point.dot(z);
    let origin = if origin.norm() < SMALL { Vector3::zeros() } else { origin };
    frame(origin, &across(z, [Vector3::x(), Vector3::y()]), z)
}

/// Frame i on the next axis.
fn follow(before: &Placement, next: &Line) -> Placement {
    let [x0, z0] = [before.rotation.column(0).into_owned(), before.rotation.column(2).into_owned()];
    let (z, between) = (next.direction, next.point - before.translation);
    let normal = z0.cross(&z);
    let sine = normal.norm();
    if sine < SMALL {
        // parallel: the foot beside the origin before
        let offset = between - z0 * between.dot(&z0);
        let x = if offset.norm() < SMALL { x0 } else { offset };
        return frame(
            before.translation + if offset.norm() < SMALL { Vector3::zeros() } else { offset },
            &x,
            &z,
        );
    }
    let n = normal / sine;
    // feet of the common normal: p0 + s z0 + distance n = p + t z
    let t = between.cross(&z0).dot(&normal) / (sine * sine);
    let distance = between.dot(&n);
    let x = match distance.abs() < SMALL {
        // they meet: both directions serve
        true if n.dot(&x0) < -SMALL => -n,
        true => n,
        false => n * distance,
    };
    frame(next.point + z * t, &x, &z)
}

/// Frame n on the last axis, beside the end frame.
fn finish(before: &Placement, end: &Placement) -> Placement {
    let z = before.rotation.column(2).into_owned();
    let origin = before.translation + z * (end.translation - before.translation).dot(&z);
    let x = across(&z, [end.rotation.column(0).into_owned(), end.rotation.column(1).into_owned()]);
    frame(origin, &x, &z)
}

fn row(before: &Placement, next: &Placement, prismatic: bool) -> DhRow {
    let t = before.inverse() * *next;
    // R = Rz(θ) Rx(α): first column (cos θ, sin θ, 0), last row (0, sin α, cos α)
    let theta = angle(t.rotation[(1, 0)], t.rotation[(0, 0)]);
    let alpha = angle(t.rotation[(2, 1)], t.rotation[(2, 2)]);
    let a = t.translation.x * theta.cos() + t.translation.y * theta.sin();
    DhRow { prismatic, theta, d: t.translation.z, a, alpha }
}

/// In (-π, π], where rounding would give -π as well.
fn angle(sin: f64, cos: f64) -> f64 {
    let angle = sin.atan2(cos);
    if angle < -PI + SMALL { angle + 2.0 * PI } else { angle }
}
