//! Moves of one axis at constant speeds, and the mean torque of each.

use std::sync::Arc;

use blocksim_identify::Point;
use blocksim_multibody::crba;
use blocksim_robotics::motion::Profile;

use super::bench::{Bench, Experiment, Rows};
use super::course::ConstantSpeed;
use super::pose::{Pose, range};

/// Time between reaching the speed and the window, s: the controller settles.
const SETTLING: f64 = 0.4;
/// Length of the window where nothing limits it, s.
const WINDOW: f64 = 0.3;
/// Shortest window, s: many samples of a controller at 1 kHz.
const SHORTEST: f64 = 0.1;
/// Rows in a window.
const ROWS: f64 = 300.0;
/// Largest deviation of the speed within the window, over its mean, at which it counts as constant.
const CONSTANT: f64 = 0.05;

/// A move at a constant speed through a window about the middle of the pose.
#[derive(Debug, Clone)]
pub struct Move {
    /// rad/s, signed.
    pub speed: f64,
    /// Half the window, rad.
    pub half: f64,
    /// What is run.
    pub experiment: Experiment,
}

/// Half the window at a speed, rad; `widest` is as far as gravity allows.
pub fn half_window(speed: f64, widest: f64) -> f64 {
    (0.5 * WINDOW * speed.abs()).min(widest)
}

/// Fastest speed at which the window is long enough, rad/s.
pub fn fastest_for(widest: f64) -> f64 {
    2.0 * widest / SHORTEST
}

/// Way before the window, rad, and time to get up to speed, s.
fn lead(speed: f64, acceleration: f64) -> (f64, f64) {
    // The peak of a sin² bump is twice its mean; a fifth is kept in reserve.
    let up = (2.5 * speed.abs() / acceleration).max(0.1);
    (speed.abs() * (0.5 * up + SETTLING), up)
}

/// Whether an axis can reach a speed and keep it through the window within its limits.
pub fn fits(bench: &Bench, axis: usize, pose: &Pose, speed: f64, widest: f64) -> bool {
    let limits = &bench.axes[axis].limits;
    let (lower, upper) = (limits.lower, limits.upper);
    let way = lead(speed, limits.acceleration).0 + half_window(speed, widest);
    let centre = pose.q[axis];
    speed.abs() <= limits.speed * (1.0 + 1e-9) && centre - way >= lower && centre + way <= upper
}

/// The fastest speed that fits, rad/s, at most `wanted`.
pub fn fastest(bench: &Bench, axis: usize, pose: &Pose, wanted: f64, widest: f64) -> f64 {
    let (mut low, mut high) = (0.0, wanted);
    if fits(bench, axis, pose, wanted, widest) {
        return wanted;
    }
    for _ in 0..50 {
        let speed = 0.5 * (low + high);
        if fits(bench, axis, pose, speed, widest) { low = speed } else { high = speed }
    }
    low
}

/// A move at a speed. The axis starts at rest before the window and the run ends behind it.
pub fn plan(bench: &Bench, axis: usize, pose: &Pose, speed: f64, widest: f64) -> Option<Move> {
    let limits = &bench.axes[axis].limits;
    let half = half_window(speed, widest);
    let (way, up) = lead(speed, limits.acceleration);
    let start = pose.q[axis] - speed.signum() * (way + half);
    let window = 2.0 * half / speed.abs();
    let end = up + SETTLING + window;
    // A little longer, so that braking is never seen.
    let cruise = end + 0.05;
    let profile = Profile::new(up, cruise, speed * cruise)?;
    let course = Arc::new(ConstantSpeed { start, profile });
    let mut q = pose.q.clone();
    q[axis] = start;
    let every = window / ROWS;
    Some(Move { speed, half, experiment: Experiment::one_axis(&q, axis, course, end + 0.02, every) })
}

/// What a move brought.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Mean speed and mean torque of the motor at the joint in the window.
    pub point: Point,
    /// Torque that was taken off because the speed still changed, N m.
    pub inertial: f64,
    /// The speed was constant.
    pub is_steady: bool,
    /// The motor drove all the time: the torque never changed its sign.
    pub is_driving: bool,
}

/// Mean values of a move over the positions of its window, so that two directions see the same gravity.
pub fn measure(bench: &Bench, axis: usize, pose: &Pose, course: &Move, rows: &Rows) -> Option<Measured> {
    let drive = &bench.axes[axis].drive;
    let (centre, half) = (pose.q[axis], course.half);
    // The controller keeps the speed exactly, but the position lags: the window is where the joint is.
    let inside: Vec<&[f64; 5]> = rows
        .values
        .iter()
        .filter(|row| (row[0] - centre).abs() <= half && row[1] * course.speed > 0.0)
        .collect();
    let (first, last) = (inside.first()?, inside.last()?);
    let way = last[0] - first[0];
    if inside.len() < 20 || way * course.speed <= 0.0 {
        return None;
    }
    let mean = |value: &dyn Fn(&[f64; 5]) -> f64| {
        let sum: f64 = inside
            .windows(2)
            .map(|pair| 0.5 * (value(pair[0]) + value(pair[1])) * (pair[1][0] - pair[0][0]))
            .sum();
        sum / way
    };
    let speed = mean(&|row| row[1]);
    let torque = mean(&|row| drive.ratio * row[4]);
    let n = bench.tree.dof();
    let mut mass = vec![0.0; n * n];
    crba(&bench.tree, &mut bench.tree.data(), &pose.q, &mut mass);
    let inertia = mass[axis * n + axis] + drive.reflected;
    // Mean over the way of dw/dt is (w2² - w1²) / 2 over the way.
    let inertial = inertia * 0.5 * (last[1] * last[1] - first[1] * first[1]) / way;
    let spread = inside.iter().map(|row| (row[1] - speed).abs()).fold(0.0, f64::max);
    Some(Measured {
        point: Point { speed, torque: torque - inertial },
        inertial,
        is_steady: spread <= CONSTANT * speed.abs(),
        is_driving: inside.iter().all(|row| drive.ratio * row[4] * course.speed > 0.0),
    })
}

/// Room on both sides of the middle of a pose, rad.
pub fn room(bench: &Bench, axis: usize, pose: &Pose) -> f64 {
    let (lower, upper) = range(&bench.axes[axis].limits);
    (pose.q[axis] - lower).min(upper - pose.q[axis])
}
