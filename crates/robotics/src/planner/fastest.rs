//! The fastest way along a path of the axes that keeps all limits everywhere, not at its knots alone.
//!
//! Near a singular pose the derivatives of the axes change much from one knot to the next, and a motion that keeps its limits
//! at knots exceeds them between. There the path is divided into finer intervals; what is left is taken away from all speeds.

use crate::motion::Path;

use crate::planner::joint_path::JointPath;
use crate::planner::law::TimeLaw;
use crate::planner::phase_plane::{Bounds, Knot, time_optimal};

/// Intervals in all, at least: an acceleration is the same on each, and the more they are the nearer it is to its limits on all of it.
const FEWEST: usize = 2000;
/// How many times as many, at most.
const FINEST: usize = 32;
/// Intervals in all, at most: beyond, the motion is slowed down instead.
const MOST: usize = 20_000;
/// By how much speeds may be above what they can be before the intervals are divided, relative.
const CLOSE: f64 = 1e-3;
/// Places within an interval at which the limits are looked at; and at last, between two knots.
const INSIDE: usize = 4;
const AT_LAST: usize = 64;
/// What may lie between the last of them, relative.
const BETWEEN: f64 = 2e-6;

/// Length over time of the fastest motion from rest to rest; `None` where there is none.
pub(crate) fn fastest(joints: &JointPath, path: &Path, bounds: &Bounds) -> Option<TimeLaw> {
    let (axes, length) = (joints.axes(), joints.length());
    let fewest = FEWEST.div_ceil(joints.intervals().max(1));
    let mut parts = fewest;
    loop {
        let n = joints.intervals() * parts;
        let step = length / n as f64;
        let places = (0..=n).map(|k| length * (k as f64 / n as f64));
        let knots: Vec<Knot> = places
            .clone()
            .flat_map(|s| (0..axes).map(move |axis| joints.at(axis, s)))
            .map(|[_, first, second]| Knot { first, second })
            .collect();
        let curvatures: Vec<f64> = places.map(|s| path.at(s).curvature.norm()).collect();
        let squares = time_optimal(n, step, |k, axis| knots[k * axes + axis], |k| curvatures[k], bounds);
        let finer = parts < FINEST * fewest && 2 * n <= MOST;
        let excess =
            squares.as_ref().map_or(f64::INFINITY, |x| excess(joints, path, bounds, (step, INSIDE), x));
        if excess > 1.0 + CLOSE && finer {
            parts *= 2;
            continue;
        }
        // All speeds by one factor: speeds go with it, accelerations with its square.
        let mut squares = squares?;
        let at_last = (AT_LAST / parts).max(INSIDE);
        let excess = excess.max(self::excess(joints, path, bounds, (step, at_last), &squares));
        if excess > 1.0 - BETWEEN {
            let slower = (excess * (1.0 + BETWEEN)).powi(2);
            squares.iter_mut().for_each(|x| *x /= slower);
        }
        return Some(TimeLaw::phases(step, &squares));
    }
}

/// By how much speeds are above what all limits allow: their largest ratio to the limit, or the root of that of
/// accelerations; looked at so many places `inside` each interval.
fn excess(
    joints: &JointPath,
    path: &Path,
    bounds: &Bounds,
    (step, inside): (f64, usize),
    squares: &[f64],
) -> f64 {
    let mut worst = 0.0_f64;
    for (k, pair) in squares.windows(2).enumerate() {
        let u = (pair[1] - pair[0]) / (2.0 * step);
        for i in 0..=inside {
            let along = step * (i as f64 / inside as f64);
            let s = (k as f64 * step + along).min(joints.length());
            let x = (pair[0] + 2.0 * u * along).max(0.0);
            for (axis, limits) in bounds.axes.iter().enumerate() {
                let [_, first, second] = joints.at(axis, s);
                worst = worst.max(first.abs() * x.sqrt() / limits.speed);
                worst = worst.max(((first * u + second * x).abs() / limits.acceleration).sqrt());
            }
            let across = path.at(s).curvature.norm() * x;
            worst = worst.max(x.sqrt() / bounds.speed);
            worst = worst.max((across.hypot(u) / bounds.acceleration).sqrt());
        }
    }
    worst
}
