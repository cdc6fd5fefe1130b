//! Planning of a line with 1233 waypoints.

#[path = "../tests/moves/arm.rs"]
mod arm;

use blocksim_planner::{CartesianMove, CartesianRequest, Orientation, Speeds, Start, Timing, inspect};
use nalgebra::Vector3;

fn main() {
    divan::main();
}

const Q: [f64; 6] = [0.1, 0.2, 0.1, 0.3, 0.8, -0.2];

/// Planned and inspected.
#[divan::bench(args = ["free", "fixed", "axis", "time-optimal"])]
fn line_of_1233_waypoints(bencher: divan::Bencher, kind: &str) {
    let robot = arm::robot();
    let (orientation, timing) = match kind {
        "free" => (Orientation::Free, Timing::Sin2),
        "fixed" => (Orientation::Fixed, Timing::Sin2),
        "axis" => (Orientation::Axis, Timing::Sin2),
        _ => (Orientation::Fixed, Timing::TimeOptimal),
    };
    let by = Vector3::new(0.1, -0.45, -0.35);
    let request = CartesianRequest {
        start: Start::Joints(Q.to_vec()),
        via: None,
        target: arm::tool(&robot, &Q).translation + by,
        orientation,
        speeds: Speeds { velocity: 0.25, acceleration: 0.4, timing },
        resolution: by.norm() / 1232.0,
    };
    bencher.bench(|| {
        let planned = CartesianMove::plan(&robot, &request).expect("a move");
        inspect(&robot, &planned, 1233)
    });
}
