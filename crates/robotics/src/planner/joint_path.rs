//! Joint positions along a path, twice continuously differentiable by its length.

use crate::motion::Path;
use crate::robot::Robot;

use crate::planner::arm::Arm;
use crate::planner::course::Way;
use crate::planner::error::{PlanError, Reason};
use crate::planner::task::Task;

/// How far the tool may be from the path between two knots, m and rad.
const BETWEEN: f64 = 1e-7;

/// Fewest knots of a path, and most.
const FEWEST: usize = 33;
pub(crate) const MOST: usize = 400_000;

/// The positions of all axes as a function of the length of the path: polynomials of degree five between knots, which
/// agree with positions and both derivatives there.
#[derive(Debug, Clone, PartialEq)]
pub struct JointPath {
    axes: usize,
    step: f64,
    length: f64,
    /// q, q', q'' of all axes, knot after knot.
    knots: Vec<[f64; 3]>,
    /// Smallest singular value of what is prescribed at each knot.
    margins: Vec<f64>,
}

impl JointPath {
    /// Follows a path from `q`, where the tool is at its beginning. `spacing` is the largest distance of knots, m;
    /// they are closer where the tool would leave the path by more than 0.1 µm between them.
    pub(crate) fn follow(
        robot: &Robot,
        task: &Task,
        path: &Path,
        q: &[f64],
        spacing: f64,
    ) -> Result<JointPath, PlanError> {
        let mut intervals = ((path.length() / spacing - 1e-9).ceil() as usize).max(FEWEST - 1);
        loop {
            let outcome = attempt(robot, task, path, q, intervals);
            let finer = intervals.saturating_mul(4) <= MOST;
            match outcome {
                Ok(joint_path) if !finer || joint_path.strays(robot, task, path) <= BETWEEN => {
                    return Ok(joint_path);
                }
                // A longer step than the curvature allows may look like a place that is not reached.
                Err(_) if finer && intervals < 2000 => {}
                Err(error) => return Err(error),
                Ok(_) => {}
            }
            intervals *= 4;
        }
    }

    /// The largest deviation in the middle between knots.
    fn strays(&self, robot: &Robot, task: &Task, path: &Path) -> f64 {
        let mut arm = Arm::new(robot);
        let stride = (self.intervals() / 256).max(1);
        let middle = |k: usize| (k as f64 + 0.5) * self.step;
        (0..self.intervals())
            .step_by(stride)
            .map(|k| {
                let s = middle(k);
                let q: Vec<f64> = (0..self.axes).map(|axis| self.at(axis, s)[0]).collect();
                task.deviation(&mut arm, &path.at(s).placement, &q)
            })
            .fold(0.0, f64::max)
    }

    /// Number of axes.
    pub fn axes(&self) -> usize {
        self.axes
    }

    /// Length of the path, m.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Number of intervals between knots, which are equally long.
    pub fn intervals(&self) -> usize {
        self.margins.len() - 1
    }

    /// Position of an axis (rad) and its two derivatives by the length, at a knot.
    ///
    /// # Panics
    /// Beyond the last knot or axis.
    pub fn knot(&self, knot: usize, axis: usize) -> [f64; 3] {
        self.knots[knot * self.axes + axis]
    }

    /// Smallest singular value of what is prescribed at a knot.
    ///
    /// # Panics
    /// Beyond the last knot.
    pub fn margin(&self, knot: usize) -> f64 {
        self.margins[knot]
    }

    /// Length of the path at a knot, m.
    pub fn place(&self, knot: usize) -> f64 {
        self.length * (knot as f64 / self.intervals() as f64)
    }

    /// Position of an axis (rad) and its first and second derivative by the length, at length `s`.
    ///
    /// # Panics
    /// Beyond the last axis.
    pub fn at(&self, axis: usize, s: f64) -> [f64; 3] {
        let s = s.clamp(0.0, self.length);
        let k = ((s / self.step) as usize).min(self.intervals() - 1);
        let (left, right) = (self.knot(k, axis), self.knot(k + 1, axis));
        if s >= self.length {
            return self.knot(self.intervals(), axis);
        }
        hermite(left, right, self.step, (s - k as f64 * self.step) / self.step)
    }
}

/// The polynomial of degree five through values and two derivatives at both ends of an interval of length `h`, at the
/// share `x` of it.
///
/// Each derivative is written as what belongs to both ends and a remainder that vanishes there, and the value from the
/// nearer end: at a knot both intervals then agree to the last digits, although a remainder, a difference of large terms
/// over h², has fewer.
fn hermite([p0, v0, a0]: [f64; 3], [p1, v1, a1]: [f64; 3], h: f64, x: f64) -> [f64; 3] {
    let (d, v0, v1, a0, a1) = (p1 - p0, v0 * h, v1 * h, a0 * h * h, a1 * h * h);
    let y = 1.0 - x;
    let e = 60.0 * d - 36.0 * v0 - 24.0 * v1 - 8.0 * a0 + 2.0 * a1;
    let f = -120.0 * d + 60.0 * (v0 + v1) - 10.0 * (a1 - a0);
    let a = a0 * y + a1 * x + x * y * (e + f * x);
    let ends = v0 * y * y * (1.0 + 2.0 * x) + v1 * x * x * (1.0 + 2.0 * y) + x * y * (a0 * y - a1 * x);
    let v = ends - 0.25 * f * x * x * y * y;
    // from an end with what belongs to it and to the other
    let from = |d: f64, v0: f64, v1: f64, a0: f64, a1: f64, x: f64| {
        let c3 = 10.0 * d - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1;
        let c4 = -15.0 * d + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1;
        let c5 = 6.0 * d - 3.0 * (v0 + v1) + 0.5 * (a1 - a0);
        x * (v0 + x * (0.5 * a0 + x * (c3 + x * (c4 + x * c5))))
    };
    let p = match x <= 0.5 {
        true => p0 + from(d, v0, v1, a0, a1, x),
        false => p1 + from(-d, -v1, -v0, a1, a0, y),
    };
    [p, v / h, a / (h * h)]
}

fn attempt(
    robot: &Robot,
    task: &Task,
    path: &Path,
    start: &[f64],
    intervals: usize,
) -> Result<JointPath, PlanError> {
    let mut arm = Arm::new(robot);
    let (axes, length) = (robot.axes(), path.length());
    let step = length / intervals as f64;
    let mut knots = Vec::with_capacity((intervals + 1) * axes);
    let mut margins = Vec::with_capacity(intervals + 1);
    let mut q = start.to_vec();
    let fail = |k: usize, singular: bool| {
        let at = k as f64 / intervals as f64;
        let way = Way { length, done: length * at, turn: path.is_turn() };
        PlanError::new(
            "path",
            match singular {
                true => Reason::Singular { at, way },
                false => Reason::Unreachable { at, way, distance: None },
            },
        )
    };
    let redundant = *task != Task::Pose || axes != 6;
    let mut before: Option<Vec<[f64; 3]>> = None;
    for k in 0..=intervals {
        let point = path.at(length * (k as f64 / intervals as f64));
        let close = margins.last().is_some_and(|margin| *margin < 0.03);
        task.settle(&mut arm, &point.placement, &mut q).ok_or_else(|| fail(k, close))?;
        let mut slopes = task.derivatives(&mut arm, &point, &q).ok_or_else(|| fail(k, true))?;
        if let (true, Some(before)) = (redundant, &before) {
            // Least motion is a differential equation: a rule of order four over the interval.
            for (i, [p, v, a]) in before.iter().enumerate() {
                q[i] = p + 0.5 * step * (v + slopes.0[i]) + step * step / 12.0 * (a - slopes.1[i]);
            }
            task.settle(&mut arm, &point.placement, &mut q).ok_or_else(|| fail(k, close))?;
            slopes = task.derivatives(&mut arm, &point, &q).ok_or_else(|| fail(k, true))?;
        }
        margins.push(task.margin(&arm));
        let row: Vec<[f64; 3]> = (0..axes).map(|i| [q[i], slopes.0[i], slopes.1[i]]).collect();
        for (q, [p, v, a]) in q.iter_mut().zip(&row) {
            *q = p + step * (v + 0.5 * step * a);
        }
        knots.extend_from_slice(&row);
        before = Some(row);
    }
    Ok(JointPath { axes, step, length, knots, margins })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_polynomial_keeps_what_it_is_given_and_is_exact_for_degree_five() {
        // p = x⁵ - 2 x³ + x, over 0.3 to 0.7
        let at = |x: f64| {
            [
                x.powi(5) - 2.0 * x.powi(3) + x,
                5.0 * x.powi(4) - 6.0 * x * x + 1.0,
                20.0 * x.powi(3) - 12.0 * x,
            ]
        };
        for k in 0..=40 {
            let share = f64::from(k) / 40.0;
            let found = hermite(at(0.3), at(0.7), 0.4, share);
            for (found, expected) in found.iter().zip(at(0.3 + 0.4 * share)) {
                assert!((found - expected).abs() < 1e-13, "{share}: {found} {expected}");
            }
        }
        // at the ends to the last digits, however short the interval
        let (left, right) = ([1.2, -0.7, 3.1], [1.2 - 0.7e-4, -0.7 + 3.1e-4, 3.2]);
        for (x, end) in [(0.0, left), (1.0, right)] {
            for (found, given) in hermite(left, right, 1e-4, x).iter().zip(end) {
                assert!((found - given).abs() < 1e-15 * given.abs().max(1.0), "{found} {given}");
            }
        }
    }
}
