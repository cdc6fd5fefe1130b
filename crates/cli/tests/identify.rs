//! `blocksim identify` as users call it, with the robot that ships.

use std::path::PathBuf;
use std::process::{Command, Output};

use serde_json::Value;

/// A robot arm has none of this.
const LAG: &str = r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: { "demand": Step(time: "0.1 s", after: 1.0), "scope": Scope(inputs: ["set"]) },
    connections: ["demand.y -> scope.set"],
)
"#;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn identify(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_blocksim"));
    command.current_dir(root()).env("NO_COLOR", "1").arg("identify").args(arguments);
    command.output().expect("the program runs")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The objects of the lines.
fn lines(output: &Output) -> Vec<Value> {
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}")))
        .collect()
}

/// A folder that is removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("blocksim-identify-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn file(&self, name: &str) -> String {
        self.0.join(name).to_string_lossy().into_owned()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// How far an estimate is from what is set, relative.
fn deviation(result: &Value, group: &str, name: &str) -> f64 {
    let estimate = &result[group][name];
    let number =
        |key: &str| estimate[key].as_f64().unwrap_or_else(|| panic!("{group}.{name}.{key}: {result}"));
    (number("value") / number("set") - 1.0).abs()
}

#[test]
fn friction_that_was_set_is_found_again_with_and_without_gravity() {
    // Axis 1 stands upright; axis 2 bears the arm; axis 6 is the quickest.
    let output = identify(&["friction", "--axis", "1,2,6", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let results = lines(&output);
    assert_eq!(results.len(), 3);
    for result in &results {
        for (group, name, tolerance) in [
            ("at_the_motor", "viscous", 0.02),
            ("at_the_motor", "coulomb", 0.01),
            ("bearing", "viscous", 0.02),
            ("bearing", "coulomb", 0.01),
            ("bearing", "breakaway", 0.01),
            ("bearing", "breakaway_velocity", 0.05),
        ] {
            let off = deviation(result, group, name);
            assert!(off < tolerance, "axis {}: {group}.{name} is off by {off}", result["axis"]);
        }
    }
    let slope = |index: usize| results[index]["gravity_slope"].as_f64().unwrap();
    assert!(slope(0) == 0.0 && slope(1).abs() > 100.0 && slope(2) == 0.0);
}

#[test]
fn a_changed_parameter_is_found_as_changed() {
    let set = ["--set", "robot.axis1.bearing.coulomb=12", "--set", "robot.axis1.bearing.viscous=20"];
    let output = identify(&[&["friction", "--axis", "1", "--json"], &set[..]].concat());
    let results = lines(&output);
    let found = |name: &str| results[0]["bearing"][name]["value"].as_f64().unwrap();
    assert!((found("coulomb") - 12.0).abs() < 0.1 && (found("viscous") - 20.0).abs() < 0.3, "{results:?}");
}

#[test]
fn base_parameters_lie_in_their_intervals() {
    let output = identify(&["dynamics", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let results = lines(&output);
    let (last, parameters) = results.split_last().unwrap();
    let inside = parameters.iter().filter(|p| p["inside"] == true).count();
    // 95 % of some fifty: with a standard deviation of 1.5, were they independent.
    assert!(
        parameters.len() > 30 && inside * 100 >= 85 * parameters.len(),
        "{inside} of {}",
        parameters.len()
    );
    let errors =
        last["prediction_errors"].as_array().unwrap().iter().zip(last["torques"].as_array().unwrap());
    for (error, torque) in errors {
        assert!(error.as_f64().unwrap() < 0.02 * torque.as_f64().unwrap(), "{last}");
    }
}

#[test]
fn requests_that_make_no_sense_are_refused_with_a_remedy() {
    let folder = Folder::new("refused");
    std::fs::write(folder.file("lag.ron"), LAG).unwrap();
    std::fs::write(folder.file("there.csv"), "mine").unwrap();
    let lag = folder.file("lag.ron");
    let there = folder.file("there.csv");
    for (arguments, code, words) in [
        (&["friction", "--axis", "9"][..], 2, "the axes of this robot are 1 to 6"),
        (&["friction", "--axis", "5", "--speeds", "350 deg/s"][..], 2, "choose speeds up to"),
        (&["friction", "--axis", "2", "--speeds", "170 deg/s"][..], 2, "where gravity is balanced"),
        (&["friction", "--speeds", "3 m"][..], 2, "a unit such as deg/s"),
        (&["friction", &lag][..], 3, "the diagram has no arm of bodies and joints"),
        (&["dynamics", "--out", &there][..], 2, "exists"),
        (&["dynamics", "--out", "result.txt"][..], 2, "endings: .csv"),
        (&["dynamics", "--harmonics", "1"][..], 2, "2 to 50"),
        (&["friction", "nowhere.ron"][..], 4, "no such file"),
    ] {
        let output = identify(arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", said(&output));
        assert!(said(&output).contains(words), "{arguments:?}: {}", said(&output));
    }
    assert_eq!(std::fs::read_to_string(there).unwrap(), "mine");
}
