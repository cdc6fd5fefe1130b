//! `blocksim identify` as users call it, with the robot that ships.

use std::path::PathBuf;
use std::process::Output;

use serde_json::Value;

use crate::support::program;

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
    let mut command = program();
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
fn the_torque_of_a_motor_may_be_that_of_a_block_beside_it() {
    let set = ["--drive", "dc", "--set", "robot.axis1.bearing.coulomb=30"];
    let output = identify(&[&["friction", "--axis", "1", "--json"], &set[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let results = lines(&output);
    assert!(deviation(&results[0], "bearing", "coulomb") < 0.02, "{}", results[0]);
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
        (&["friction", &lag][..], 3, "the model has no arm of bodies and joints"),
        (&["dynamics", "--out", &there][..], 4, "already exists"),
        (&["dynamics", "--out", "result.txt"][..], 2, "endings: .csv"),
        (&["dynamics", "--harmonics", "1"][..], 2, "2 to 50"),
        (&["friction", "nowhere.ron"][..], 4, "the file does not exist"),
    ] {
        let output = identify(arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", said(&output));
        assert!(said(&output).contains(words), "{arguments:?}: {}", said(&output));
    }
    assert_eq!(std::fs::read_to_string(there).unwrap(), "mine");
}

/// Records a run of the flagship with a move and overrides; the folder of its recording.
fn recorded(folder: &Folder, name: &str, arguments: &[&str]) -> String {
    let run = folder.file(name);
    let mut command = program();
    command.current_dir(root()).env("NO_COLOR", "1").args([
        "run",
        "diagrams/irb2600/irb2600.ron",
        "--out",
        &run,
    ]);
    let output = command.args(["--set", "drive=torque"]).args(arguments).output().expect("the program runs");
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    run
}

#[test]
fn a_recording_of_the_robot_tells_its_parameters_and_predicts_another_run() {
    let folder = Folder::new("recorded");
    let exciting = format!("move=File({:?})", root().join("diagrams/irb2600/moves/exciting.ron"));
    let exciting = recorded(&folder, "exciting", &["--set", &exciting]);
    let demo = recorded(&folder, "demo", &[]);
    let prediction = |arguments: &[&str]| -> (f64, Vec<f64>) {
        let output =
            identify(&[&["dynamics", "--from", &exciting, "--predict", &demo, "--json"], arguments].concat());
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        let results = lines(&output);
        let (last, parameters) = results.split_last().unwrap();
        assert_eq!(parameters.len(), 36);
        let list = |key: &str| -> Vec<f64> {
            last[key].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
        };
        let shares =
            list("prediction_errors").iter().zip(list("torques")).map(|(wrong, size)| wrong / size).collect();
        let off =
            parameters.iter().map(|p| (p["value"].as_f64().unwrap() - p["set"].as_f64().unwrap()).abs());
        (off.fold(0.0, f64::max), shares)
    };
    // Speeds and accelerations as they were recorded: all fits to rounding.
    let (off, shares) = prediction(&[]);
    assert!(off < 1e-6 && shares.iter().all(|share| *share < 1e-7), "{off} {shares:?}");
    // From the positions alone, as on a real robot.
    let (_, shares) = prediction(&["--derive"]);
    assert!(shares.iter().all(|share| *share < 0.05), "{shares:?}");

    // The drives of the first run, axis by axis.
    let output = identify(&["friction", "--from", &exciting, "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    for result in lines(&output) {
        for (name, tolerance) in [("gear", 0.01), ("coulomb", 0.02), ("viscous", 0.03), ("inertia", 0.02)] {
            let number = |key: &str| result[name][key].as_f64().unwrap();
            let off = (number("value") / number("set") - 1.0).abs();
            assert!(off < tolerance, "axis {}: {name} is off by {off}: {result}", result["axis"]);
        }
    }

    for (arguments, code, words) in [
        (&["dynamics", "--from", &exciting, "--tau", "torque{}"][..], 2, "name the signals with --tau"),
        (&["dynamics", "--from", &exciting, "--tau", "measurements/*/*.*{}"], 2, "more than one signal"),
        (
            &["dynamics", "--from", &exciting, "--q", "measurements/velocities/*.axis{}"],
            2,
            "--q is for signals in rad",
        ),
        (&["dynamics", "--from", &exciting, "--derive", "--cutoff", "900 Hz"], 2, "it must be below 400"),
        (&["dynamics", "--from", &exciting, "--predict", "nowhere"], 4, "nowhere"),
        (&["friction", "--from", &exciting, "--speeds", "1 rad/s"], 2, "leave out --speeds"),
        (&["friction", "--from", &exciting, "--axis", "7"], 2, "the axes of this robot are 1 to 6"),
        (&["dynamics", "--predict", &demo], 2, "--from"),
    ] {
        let output = identify(arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", said(&output));
        assert!(said(&output).contains(words), "{arguments:?}: {}", said(&output));
    }
}

/// A pendulum on a bench, in a table as a measurement would be: degrees, without speeds, with noise.
#[test]
fn a_table_of_a_measurement_is_enough() {
    let folder = Folder::new("table");
    let limits = r#"limits: (lower: "-3 rad", upper: "3 rad", speed: "9 rad/s", acceleration: "99 rad/s^2")"#;
    let body = r#"bodies: [(mass: "2 kg", com: ["0.4 m", 0, 0], moi: ["0.06 kg*m^2", "0.1 kg*m^2", "0.06 kg*m^2"])]"#;
    std::fs::write(folder.file("arm.ron"), format!("(links: [(axis: [0, 1, 0], {limits}, {body})])"))
        .unwrap();
    let mut table = "time [s],angle1 [deg],torque1 [N*m]\n".to_owned();
    for k in 0..3000 {
        let t = 2e-3 * f64::from(k);
        let q = 0.9 * (3.0 * t).sin() + 0.3 * (7.0 * t).sin();
        let a = -8.1 * (3.0 * t).sin() - 14.7 * (7.0 * t).sin();
        // A pendulum that hangs down where its axis is turned by a quarter: gravity pulls down z.
        let noise = 1e-2 * f64::from((k * 7919) % 1000 - 500) / 500.0;
        let torque = (2.0 * 0.16 + 0.1) * a - 2.0 * 9.80665 * 0.4 * q.cos() + noise;
        table += &format!("{t},{},{torque}\n", q.to_degrees());
    }
    std::fs::write(folder.file("log.csv"), table).unwrap();
    let arguments = ["dynamics", &folder.file("arm.ron"), "--from", &folder.file("log.csv"), "--json"];
    let output = identify(&[&arguments[..], &["--q", "angle{}", "--tau", "torque{}"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let results = lines(&output);
    let value = |name: &str| {
        let found = results.iter().find(|result| result["base_parameter"] == name);
        found.unwrap_or_else(|| panic!("{name}: {results:?}"))["value"].as_f64().unwrap()
    };
    assert!((value("mx1") - 0.8).abs() < 0.002 && (value("Iyy1") - 0.42).abs() < 0.002, "{results:?}");
    assert_eq!(results.last().unwrap()["derived"], true);
}

/// Outputs on the page of the manual, each with the call above it.
fn shown() -> Vec<(Vec<String>, String)> {
    let page = std::fs::read_to_string(root().join("docs/identification.md")).expect("the page");
    let mut found = Vec::new();
    for part in page.split("\n`blocksim identify ").skip(1) {
        let (call, rest) = part.split_once('`').expect("the end of the call");
        let Some((_, text)) = rest.split_once("\n```text\n") else { continue };
        let (text, _) = text.split_once("\n```").expect("the end of the output");
        found.push((call.split(' ').map(str::to_owned).collect(), text.to_owned()));
    }
    found
}

/// Whether an output is that of a page, line by line, where `...` stands for any lines.
fn same(page: &str, output: &str) -> Result<(), String> {
    let mut lines = output.trim_end().lines();
    let mut skips = false;
    for wanted in page.lines() {
        if wanted == "..." {
            skips = true;
            continue;
        }
        loop {
            match lines.next() {
                Some(line) if line.trim_end() == wanted.trim_end() => break,
                Some(_) if skips => {}
                other => return Err(format!("the page has `{wanted}`, the program says {other:?}")),
            }
        }
        skips = false;
    }
    if lines.next().is_some() && !skips { Err("the program says more".to_owned()) } else { Ok(()) }
}

#[test]
fn the_page_shows_what_the_program_says() {
    let folder = Folder::new("page");
    let exciting = format!("move=File({:?})", root().join("diagrams/irb2600/moves/exciting.ron"));
    recorded(&folder, "exciting", &["--set", &exciting]);
    recorded(&folder, "demo", &[]);
    let shown = shown();
    assert_eq!(shown.len(), 4, "{shown:?}");
    for (call, text) in shown {
        let mut command = program();
        command.current_dir(&folder.0).env("NO_COLOR", "1").arg("identify");
        // The page calls from the folder of the model, or from that of the project.
        let model = root().join("diagrams/irb2600/irb2600.ron").to_string_lossy().into_owned();
        let named = call.iter().any(|argument| argument == "irb2600.ron");
        command.args(call.iter().map(|argument| if argument == "irb2600.ron" { &model } else { argument }));
        if !named {
            command.arg(&model);
        }
        let output = command.output().expect("the program runs");
        assert_eq!(output.status.code(), Some(0), "{call:?}: {}", said(&output));
        let printed = String::from_utf8_lossy(&output.stdout).into_owned();
        same(&text, &printed).unwrap_or_else(|error| panic!("{call:?}: {error}\n{printed}"));
    }
}

/// The smallest model that its page shows, in a folder that holds nothing else.
#[test]
fn a_model_in_any_folder_is_identified() {
    let folder = Folder::new("elsewhere");
    let page = std::fs::read_to_string(root().join("docs/errors/identify.md")).expect("the page");
    let model = page.split("```ron\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a model");
    std::fs::write(folder.file("axis.ron"), model).unwrap();
    let call = |arguments: &[&str]| {
        let mut command = program();
        command.current_dir(&folder.0).env("NO_COLOR", "1").arg("identify").args(arguments);
        command.output().expect("the program runs")
    };
    let output = call(&["friction", "axis.ron", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let results = lines(&output);
    assert_eq!(results.len(), 1);
    for (group, name) in [
        ("at_the_motor", "viscous"),
        ("at_the_motor", "coulomb"),
        ("bearing", "viscous"),
        ("bearing", "breakaway"),
    ] {
        let off = deviation(&results[0], group, name);
        assert!(off < 0.02, "{group}.{name} is off by {off}: {}", results[0]);
    }
    let output = call(&["dynamics", "axis.ron", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert_eq!(lines(&output)[0]["base_parameter"], "Izz1");

    // A damper inside the joint is not friction of the bearing.
    let damped = model.replace("RevoluteJoint(", "RevoluteJoint(damping: \"8 N*m*s/rad\", ");
    assert_ne!(damped, model);
    std::fs::write(folder.file("damped.ron"), damped).unwrap();
    let output = call(&["friction", "damped.ron", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let found = &lines(&output)[0];
    let off = deviation(found, "bearing", "viscous");
    assert!(off < 0.02, "the viscous friction of the bearing is off by {off}: {found}");

    // Without a controller of the joint, and without a model.
    let part = model.replace("\"joint.q -> error.u2, ", "\"move.q -> error.u2\", \"joint.q -> ");
    std::fs::write(folder.file("part.ron"), part).unwrap();
    let output = call(&["friction", "part.ron"]);
    assert_eq!(output.status.code(), Some(3), "{}", said(&output));
    assert!(said(&output).contains("no controller compares `joint.q`"), "{}", said(&output));
    let output = call(&["friction"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).starts_with("error[identify]: no model is named"), "{}", said(&output));
    assert!(said(&output).contains("`blocksim explain identify`"), "{}", said(&output));
}
