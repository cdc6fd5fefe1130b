//! Planning of a line with 1233 waypoints.

#[path = "../tests/all/moves/arm.rs"]
mod arm;

use blocksim_multibody::EulerZyx;
use blocksim_robotics::planner::{
    CartesianMove, CartesianRequest, Orientation, Scrutiny, Speeds, Start, Timing, Turning, choose, inspect,
};
use blocksim_robotics::robot::Robot;
use nalgebra::Vector3;

fn main() {
    divan::main();
}

const Q: [f64; 6] = [0.1, 0.2, 0.1, 0.3, 0.8, -0.2];

const ORIENTATIONS: [&str; 4] = ["free", "fixed", "interpolated", "axis"];
const TIMINGS: [&str; 4] = ["sin2", "trapezoid", "s-curve", "time-optimal"];

fn request(robot: &Robot, orientation: &str, timing: &str) -> CartesianRequest {
    let by = Vector3::new(0.1, -0.45, -0.35);
    let start = arm::tool(robot, &Q);
    let turned = EulerZyx { alpha: 0.3, beta: 0.2, gamma: -0.25 }.rotation() * start.rotation;
    CartesianRequest {
        start: Start::Joints(Q.to_vec()),
        via: None,
        target: start.translation + by,
        orientation: match orientation {
            "free" => Orientation::Free,
            "fixed" => Orientation::Fixed,
            "interpolated" => Orientation::Interpolated(turned),
            _ => Orientation::Axis,
        },
        speeds: Speeds {
            velocity: 0.25,
            acceleration: 0.4,
            timing: match timing {
                "sin2" => Timing::Sin2,
                "trapezoid" => Timing::Trapezoid,
                "s-curve" => Timing::SCurve { jerk: 40.0 },
                _ => Timing::TimeOptimal,
            },
        },
        turning: Turning::default(),
        resolution: by.norm() / 1232.0,
    }
}

/// Planned and inspected, of each orientation with each law.
#[divan::bench(args = ORIENTATIONS.iter().flat_map(|o| TIMINGS.map(|t| format!("{o} {t}"))))]
fn line_of_1233_waypoints(bencher: divan::Bencher, kind: &str) {
    let robot = arm::robot();
    let (orientation, timing) = kind.split_once(' ').expect("two words");
    let request = request(&robot, orientation, timing);
    bencher.bench(|| {
        let planned = CartesianMove::plan(&robot, &request).expect("a move");
        inspect(&robot, &planned, &Scrutiny::at(1233))
    });
}

/// Only the choice of the configuration at a start that is given by the place of the tool.
#[divan::bench]
fn configuration_of_1233_waypoints(bencher: divan::Bencher) {
    let robot = arm::robot();
    let mut request = request(&robot, "fixed", "sin2");
    request.start = Start::Pose(arm::tool(&robot, &Q));
    bencher.bench(|| choose(&robot, &request, None).expect("a start"));
}
