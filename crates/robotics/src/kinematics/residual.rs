//! Residuals of the constraints with their Jacobians, and how far each constraint is violated.

use crate::kinematics::constraint::Constraint;
use blocksim_multibody::{Data, Frame, Model, Placement, relative_jacobian, rotation_vector};
use nalgebra::{Matrix3, Vector3};

/// Nearer than this to its target a tool aims at it, m.
const AIMED: f64 = 1e-6;
/// Nearer than this the direction to a target counts by the distance, so that its derivative stays bounded, m.
const FADE: f64 = 1e-2;

/// The rows of all constraints: cost ½ Σ r².
#[derive(Debug, Clone, Default)]
pub(crate) struct Rows {
    n: usize,
    /// Residuals.
    pub r: Vec<f64>,
    /// Their derivatives by the joint positions, row-major.
    pub j: Vec<f64>,
    /// By how much each part of each constraint exceeds its tolerance.
    pub excess: Vec<f64>,
    frame: Vec<f64>,
}

impl Rows {
    pub fn new(n: usize) -> Self {
        // More than usual stacks have, so that a solver that runs along with a simulation takes no memory.
        const USUAL: usize = 16;
        Rows {
            n,
            r: Vec::with_capacity(USUAL),
            j: Vec::with_capacity(USUAL * n),
            excess: Vec::with_capacity(USUAL),
            frame: vec![0.0; 6 * n],
        }
    }

    /// Σ r²
    pub fn cost(&self) -> f64 {
        self.r.iter().map(|r| r * r).sum()
    }

    /// The largest excess of all.
    pub fn worst(&self) -> f64 {
        self.excess.iter().fold(0.0, |m, e| m.max(*e))
    }

    /// The rows of all constraints from the current placements and positions.
    pub fn fill(&mut self, model: &Model, data: &Data, q: &[f64], constraints: &[Constraint]) {
        self.r.clear();
        self.j.clear();
        self.excess.clear();
        for constraint in constraints {
            self.add(model, data, q, constraint);
        }
    }

    fn look(&mut self, model: &Model, data: &Data, frame: &Frame, reference: &Frame) -> Placement {
        relative_jacobian(model, data, frame, reference, &mut self.frame);
        frame.relative_to(reference, data)
    }

    fn add(&mut self, model: &Model, data: &Data, q: &[f64], constraint: &Constraint) {
        match constraint {
            Constraint::Position { frame, reference, target, tolerance, weight } => {
                let at = self.look(model, data, frame, reference);
                self.vector(at.translation - target, *tolerance, *weight, |_, v| v);
            }
            Constraint::Orientation { frame, reference, target, tolerance, weight } => {
                let at = self.look(model, data, frame, reference);
                self.turn(&at.rotation, target, *tolerance, *weight);
            }
            Constraint::Pose { frame, reference, target, tolerances, weights } => {
                let at = self.look(model, data, frame, reference);
                self.vector(at.translation - target.translation, tolerances[0], weights[0], |_, v| v);
                self.turn(&at.rotation, &target.rotation, tolerances[1], weights[1]);
            }
            Constraint::Aiming { frame, reference, target, tolerance, weight } => {
                let at = self.look(model, data, frame, reference);
                self.aim(&at, target, *tolerance, *weight);
            }
            Constraint::CartesianBounds { frame, reference, target, lower, upper, weights } => {
                let at = self.look(model, data, frame, reference);
                let x = target.inverse().point(&at.translation);
                for i in 0..3 {
                    let axis: Vector3<f64> = target.rotation.column(i).into();
                    self.hinge(x[i], lower[i], upper[i], weights[i], |_, v| axis.dot(&v));
                }
            }
            Constraint::JointBounds { lower, upper, weights } => {
                for i in 0..self.n {
                    let along = |column| if column == i { 1.0 } else { 0.0 };
                    self.hinge_column(q[i], lower[i], upper[i], weights[i], along);
                }
            }
            Constraint::DistanceBounds { frame, reference, lower, upper, weight } => {
                let at = self.look(model, data, frame, reference).translation;
                let distance = at.norm();
                // where the origins coincide any direction leads away
                let away = if distance < 1e-12 { Vector3::x() } else { at / distance };
                self.hinge(distance, *lower, *upper, *weight, |_, v| away.dot(&v));
            }
        }
    }

    /// ω and v of a column of the Jacobian of the frame.
    fn column(&self, k: usize) -> (Vector3<f64>, Vector3<f64>) {
        let at = |row: usize| self.frame[row * self.n + k];
        (Vector3::new(at(0), at(1), at(2)), Vector3::new(at(3), at(4), at(5)))
    }

    fn turn(&mut self, rotation: &Matrix3<f64>, target: &Matrix3<f64>, tolerance: f64, weight: f64) {
        // to first order the derivative of the rotation vector is ω; exactly so at the target
        let e = rotation_vector(&(rotation * target.transpose()));
        self.vector(e, tolerance, weight, |omega, _| omega);
    }

    fn aim(&mut self, at: &Placement, target: &Vector3<f64>, tolerance: f64, weight: f64) {
        let z: Vector3<f64> = at.rotation.column(2).into();
        let way = target - at.translation;
        let distance = way.norm();
        let (cross, along) = (z.cross(&way), z.dot(&way));
        let angle = cross.norm().atan2(along);
        // z × way = (distance sin) n, stretched so that the residual is the angle and does not vanish behind the tool
        let sine = if distance > 0.0 { cross.norm() / distance } else { 0.0 };
        let stretch = if sine > 1e-9 { angle / sine } else { 1.0 };
        let behind = sine <= 1e-9 && along < 0.0;
        let scale = stretch / distance.max(FADE);
        let e = match behind {
            // any direction across z leads out
            true => at.rotation.column(0) * (angle * distance / distance.max(FADE)),
            false => cross * scale,
        };
        let fades = distance < FADE;
        let (way_unit, tip) = (if distance > 0.0 { way / distance } else { way }, *at);
        let before = self.excess.len();
        self.vector(e, tolerance, weight, move |omega, v| {
            if behind {
                return -(omega - tip.rotation.column(2) * omega.dot(&tip.rotation.column(2)));
            }
            let slip = if fades { v } else { v - way_unit * way_unit.dot(&v) };
            (omega.cross(&z).cross(&way) - z.cross(&slip)) * scale
        });
        self.excess[before] = if distance < AIMED { 0.0 } else { (angle - tolerance).max(0.0) };
    }

    /// A vector that shall be no longer than a tolerance; `derivative` makes its change from ω and v.
    fn vector(
        &mut self,
        e: Vector3<f64>,
        tolerance: f64,
        weight: f64,
        derivative: impl Fn(Vector3<f64>, Vector3<f64>) -> Vector3<f64>,
    ) {
        let length = e.norm();
        self.excess.push((length - tolerance).max(0.0));
        if length <= tolerance && tolerance > 0.0 {
            return;
        }
        // r = e (1 - t / |e|)
        let root = weight.sqrt();
        let share = if tolerance > 0.0 { 1.0 - tolerance / length } else { 1.0 };
        let unit = if length > 0.0 { e / length } else { e };
        let first = self.j.len();
        self.j.resize(first + 3 * self.n, 0.0);
        for k in 0..self.n {
            let (omega, v) = self.column(k);
            let de = derivative(omega, v);
            let dr = (de * share + unit * ((1.0 - share) * unit.dot(&de))) * root;
            for row in 0..3 {
                self.j[first + row * self.n + k] = dr[row];
            }
        }
        self.r.extend((e * (share * root)).iter());
    }

    /// A number between bounds; `derivative` makes its change from ω and v.
    fn hinge(
        &mut self,
        x: f64,
        lower: f64,
        upper: f64,
        weight: f64,
        derivative: impl Fn(Vector3<f64>, Vector3<f64>) -> f64,
    ) {
        let outside = excess(x, lower, upper);
        self.excess.push(outside.abs());
        if outside != 0.0 {
            let root = weight.sqrt();
            self.r.push(root * outside);
            for k in 0..self.n {
                let (omega, v) = self.column(k);
                self.j.push(root * derivative(omega, v));
            }
        }
    }

    /// A number between bounds; `derivative` by each joint.
    fn hinge_column(
        &mut self,
        x: f64,
        lower: f64,
        upper: f64,
        weight: f64,
        derivative: impl Fn(usize) -> f64,
    ) {
        let outside = excess(x, lower, upper);
        self.excess.push(outside.abs());
        if outside != 0.0 {
            let root = weight.sqrt();
            self.r.push(root * outside);
            self.j.extend((0..self.n).map(|k| root * derivative(k)));
        }
    }
}

/// How far x is outside, with its sign.
fn excess(x: f64, lower: f64, upper: f64) -> f64 {
    if x < lower {
        x - lower
    } else if x > upper {
        x - upper
    } else {
        0.0
    }
}
