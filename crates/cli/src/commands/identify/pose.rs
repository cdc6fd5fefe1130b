//! Poses in which gravity does not load an axis.

use blocksim_blocks::motion::Limits;
use blocksim_multibody::{Model, bias};

/// Angles that are tried for the other joints, degrees.
const TRIED: [f64; 5] = [0.0, 45.0, -45.0, 90.0, -90.0];
/// Positions of the axis at which gravity is looked at.
const POSITIONS: usize = 13;
/// Torque of gravity that counts as none, over that of the worst pose.
const NONE: f64 = 1e-6;
/// Poses that are tried at most.
const MOST: usize = 20_000;

/// Where an axis is measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// Positions of all joints; that of the axis is the middle of the measurement, rad.
    pub q: Vec<f64>,
    /// How fast the torque of gravity grows with the position of the axis, N m/rad; zero where there is none anywhere.
    pub slope: f64,
}

/// Torque of gravity on an axis, N m.
pub fn gravity(tree: &Model, q: &[f64], axis: usize) -> f64 {
    let mut h = vec![0.0; tree.dof()];
    bias(tree, &mut tree.data(), q, &vec![0.0; tree.dof()], &mut h);
    h[axis]
}

/// The range of an axis about its middle that is used: at most half a turn to each side.
pub fn range(limits: &Limits) -> (f64, f64) {
    use std::f64::consts::PI;
    (limits.lower.max(-PI), limits.upper.min(PI))
}

/// Finds a pose: the axis along gravity where that can be, else the balance of all that it bears in the pose in which
/// gravity pulls least.
pub fn find(tree: &Model, limits: &[Limits], axis: usize) -> Option<Pose> {
    let n = limits.len();
    let (lower, upper) = range(&limits[axis]);
    let mut candidates: Vec<Vec<f64>> = vec![Vec::new()];
    for (joint, limits) in limits.iter().enumerate() {
        let allowed = |angle: &f64| (limits.lower..=limits.upper).contains(angle);
        let mut angles: Vec<f64> = TRIED.iter().map(|angle| angle.to_radians()).filter(allowed).collect();
        // One angle is enough where more would be too many, and for the axis itself.
        if joint == axis || candidates.len() * angles.len() > MOST {
            angles.truncate(1);
        }
        if angles.is_empty() {
            angles.push(0.5 * (limits.lower + limits.upper));
        }
        candidates = candidates
            .iter()
            .flat_map(|start| {
                angles.iter().map(move |angle| start.iter().copied().chain([*angle]).collect::<Vec<f64>>())
            })
            .collect();
    }
    let (mut data, zero, mut h) = (tree.data(), vec![0.0; n], vec![0.0; n]);
    let at = |k: usize| lower + (upper - lower) * k as f64 / (POSITIONS - 1) as f64;
    let mut scored: Vec<(f64, Vec<f64>)> = Vec::new();
    let mut worst = 0.0_f64;
    for mut q in candidates {
        let mut largest = 0.0_f64;
        for k in 0..POSITIONS {
            q[axis] = at(k);
            bias(tree, &mut data, &q, &zero, &mut h);
            largest = largest.max(h[axis].abs());
        }
        q[axis] = 0.5 * (lower + upper);
        worst = worst.max(largest);
        scored.push((largest, q));
    }
    // The first of equal poses is that nearest to home: the angles are tried in this order.
    let near = |q: &[f64]| q.iter().map(|q| q.abs()).sum::<f64>();
    let free = scored.iter().filter(|(largest, _)| *largest <= NONE * worst);
    if let Some((_, q)) = free.min_by(|a, b| near(&a.1).total_cmp(&near(&b.1))) {
        return Some(Pose { q: q.clone(), slope: 0.0 });
    }
    scored.sort_by(|a, b| a.0.total_cmp(&b.0));
    scored.into_iter().find_map(|(_, q)| balance(tree, q, axis, lower, upper))
}

/// The balance nearest to the middle of the range.
fn balance(tree: &Model, mut q: Vec<f64>, axis: usize, lower: f64, upper: f64) -> Option<Pose> {
    /// Steps of the search.
    const STEPS: usize = 72;
    let mut torque = |x: f64| {
        q[axis] = x;
        gravity(tree, &q, axis)
    };
    let middle = 0.5 * (lower + upper);
    let grid: Vec<f64> = (0..=STEPS).map(|k| lower + (upper - lower) * k as f64 / STEPS as f64).collect();
    let signs: Vec<f64> = grid.iter().map(|x| torque(*x)).collect();
    let crossings = (0..STEPS).filter(|k| signs[*k] * signs[k + 1] <= 0.0);
    let best = crossings.min_by(|a, b| (grid[*a] - middle).abs().total_cmp(&(grid[*b] - middle).abs()))?;
    let (mut a, mut b) = (grid[best], grid[best + 1]);
    let sign = signs[best];
    for _ in 0..60 {
        let x = 0.5 * (a + b);
        if torque(x) * sign > 0.0 { a = x } else { b = x }
    }
    let x = 0.5 * (a + b);
    let slope = (torque(x + 1e-4) - torque(x - 1e-4)) / 2e-4;
    q[axis] = x;
    Some(Pose { q, slope })
}
