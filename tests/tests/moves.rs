//! Moves of the robot's tool, in the whole model.

use blocksim_blocks::robotics::RobotDescription;
use blocksim_diagram::{Sources, parameter};
use blocksim_tests::{Desk, Run, compile_file, root, run};
use nalgebra::Vector3;

const MODEL: &str = "diagrams/irb2600/irb2600.ron";

fn column<'r>(run: &'r Run, name: &str) -> &'r [f64] {
    let at = run.recorded.iter().position(|recorded| recorded.path == name);
    &run.columns[at.unwrap_or_else(|| panic!("{name} is recorded"))]
}

/// Distances of the tool from the line between its first and its last place, with set values and with actual ones, m.
fn off_the_line(drive: &str) -> [f64; 2] {
    let line = root().join("diagrams/irb2600/moves/demo_linear.ron");
    let line = format!("move=File({:?})", line.to_str().expect("a path"));
    let (compiled, problems) = compile_file(MODEL, &[&format!("drive={drive}"), &line]);
    let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    assert!(run.error.is_none(), "{:?}", run.error);

    let desk = Desk::new();
    let read: Result<RobotDescription, _> =
        parameter(&Sources::new(&desk), &root().join(MODEL), &[], "manipulator");
    let robot = read.expect("a description").robot("manipulator").expect("a robot");
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
