//! Moves of the robot's tool, in the whole model.

use blocksim_blocks::robotics::RobotDescription;
use blocksim_diagram::{Sources, parameter};
use blocksim_multibody::EulerZyx;
use blocksim_robotics::robot::Robot;
use blocksim_tests::{Desk, Run, compile_file, root, run};
use nalgebra::Vector3;

const MODEL: &str = "diagrams/irb2600/irb2600.ron";

fn column<'r>(run: &'r Run, name: &str) -> &'r [f64] {
    let at = run.recorded.iter().position(|recorded| recorded.path == name);
    &run.columns[at.unwrap_or_else(|| panic!("{name} is recorded"))]
}

fn flagship() -> Robot {
    let desk = Desk::new();
    let read: Result<RobotDescription, _> =
        parameter(&Sources::new(&desk), &root().join(MODEL), &[], "manipulator");
    read.expect("a description").robot("manipulator").expect("a robot")
}

/// Distances of the tool from the line between its first and its last place, with set values and with actual ones, m.
fn off_the_line(drive: &str) -> [f64; 2] {
    let line = root().join("diagrams/irb2600/moves/demo_linear.ron");
    let line = format!("move=File({:?})", line.to_str().expect("a path"));
    let (compiled, problems) = compile_file(MODEL, &[&format!("drive={drive}"), &line]);
    let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    assert!(run.error.is_none(), "{:?}", run.error);

    let robot = flagship();
    let mut data = robot.model().data();
    let mut places = |kind: &str| -> Vec<Vector3<f64>> {
        let axes: Vec<&[f64]> =
            (1..=6).map(|axis| column(&run, &format!("measurements/angles/axis{axis}.{kind}"))).collect();
        (0..run.time.len())
            .map(|row| {
                let q: Vec<f64> = axes.iter().map(|axis| axis[row]).collect();
                robot.tcp(&mut data, &q).translation
            })
            .collect()
    };
    let [set, actual] = ["set", "actual"].map(&mut places);
    let (from, to) = (set[0], Vector3::new(1.3, -0.1, 0.9));
    assert!((set[set.len() - 1] - to).norm() < 1e-9, "the target of the file");
    let along = (to - from).normalize();
    let furthest = |places: &[Vector3<f64>]| {
        places.iter().map(|p| (p - from - along * along.dot(&(p - from))).norm()).fold(0.0, f64::max)
    };
    [furthest(&set), furthest(&actual)]
}

#[test]
fn the_tool_follows_a_line_with_ideal_torques_and_with_dc_motors() {
    for (drive, tolerance) in [("torque", 2e-3), ("dc", 5e-3)] {
        let [set, actual] = off_the_line(drive);
        assert!(set < 1e-6, "{drive}: the set values are {set} m off");
        assert!(actual < tolerance, "{drive}: the arm is {actual} m off");
    }
}

/// The source block of the flagship gives the tool of the move: against the robot's own forward kinematics of the set
/// values of the joints, against differences of its own positions, and against what `PathError` makes of it.
#[test]
fn the_source_of_a_move_tells_where_the_tool_should_be_and_how_fast_it_goes() {
    let line = root().join("diagrams/irb2600/moves/demo_linear.ron");
    let line = format!("move=File({:?})", line.to_str().expect("a path"));
    for overrides in [&["drive=torque"][..], &["drive=torque", &line]] {
        let (compiled, problems) = compile_file(MODEL, overrides);
        let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
        assert!(run.error.is_none(), "{:?}", run.error);
        let tool = |name: &str| column(&run, &format!("measurements/tool/{name}"));
        let robot = flagship();
        let mut data = robot.model().data();
        let joints = |kind: &str| -> Vec<&[f64]> {
            (1..=6).map(|axis| column(&run, &format!("measurements/angles/axis{axis}.{kind}"))).collect()
        };
        let point = |kind: &str, row: usize| {
            Vector3::from(["x", "y", "z"].map(|axis| tool(&format!("{axis}.{kind}"))[row]))
        };
        for kind in ["set", "actual"] {
            let turns = ["z", "y", "x"].map(|axis| tool(&format!("angle_{axis}.{kind}")));
            let q = joints(kind);
            for row in 0..run.time.len() {
                let q: Vec<f64> = q.iter().map(|axis| axis[row]).collect();
                let place = robot.tcp(&mut data, &q);
                assert!((place.translation - point(kind, row)).norm() < 1e-12, "{kind} {row}");
                let [alpha, beta, gamma] = turns.map(|turn| turn[row]);
                let rotation = EulerZyx { alpha, beta, gamma }.rotation();
                assert!((place.rotation - rotation).norm() < 1e-12, "{kind} {row}");
            }
        }
        let mut fastest = 0.0_f64;
        for row in 1..run.time.len() - 1 {
            let h = run.time[row + 1] - run.time[row];
            // Rows that a seam adds are not equally far.
            if (run.time[row] - run.time[row - 1] - h).abs() > 1e-9 {
                continue;
            }
            let v = Vector3::from([0, 1, 2].map(|i| tool(&format!("speed.v[{i}]"))[row]));
            let slope = (point("set", row + 1) - point("set", row - 1)) / (2.0 * h);
            assert!((slope - v).norm() < 1e-3, "{row}: {slope} and {v}");
            fastest = fastest.max(v.norm());
        }
        assert!(fastest > 0.39, "{fastest} m/s");
        let (distance, across) = (tool("path.distance"), tool("path.across"));
        for row in 0..run.time.len() {
            let off = (point("actual", row) - point("set", row)).norm();
            assert!((distance[row] - off).abs() < 1e-12 && across[row] <= off + 1e-12);
        }
    }
}
