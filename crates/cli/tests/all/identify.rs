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

/// The smallest model of its page, with changes.
fn axis_with(changes: &Changes) -> String {
    let page = std::fs::read_to_string(root().join("docs/errors/identify.md")).expect("the page");
    let model = page.split("```ron\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a model");
    changes.iter().fold(model.to_owned(), |model, (from, to)| {
        assert!(model.contains(from), "`{from}`: {model}");
        model.replace(from, to)
    })
}

/// Calls `identify` with a model that is written to a folder.
fn identify_model(folder: &Folder, command: &str, model: &str, arguments: &[&str]) -> Output {
    let file = folder.file("axis.ron");
    std::fs::write(&file, model).unwrap();
    identify(&[&[command, file.as_str()], arguments].concat())
}

const GEAR: &str = r#""gear": CycloidalDrive(disc_teeth: 50, ring_teeth: 51, direction: Same),"#;
const MOTOR: &str = r#""motor": IdealTorqueSource,"#;
const HOUSED: &str = r#""motor.c <-> friction.c <-> joint.c <-> housing.r","#;

/// Changes of the text of a model.
type Changes = Vec<(&'static str, String)>;

/// A block beside the gear, and what it is connected to.
fn beside(block: &str, connections: &str) -> Changes {
    vec![(GEAR, format!("{GEAR} {block}")), (HOUSED, format!("{HOUSED} {connections}"))]
}

fn changes(pairs: &[(&'static str, &str)]) -> Changes {
    pairs.iter().map(|(from, to)| (*from, (*to).to_owned())).collect()
}

/// A model, and the torque of its motor at the joint by hand.
struct Case {
    name: &'static str,
    changes: Changes,
    viscous: f64,
    coulomb: f64,
}

/// Models whose bearing has 4 N*m*s/rad, 6 N*m, and 8 N*m at 0.02 rad/s.
fn cases() -> Vec<Case> {
    let motor = r#""motor": WoundFieldDcMotor(r: "0.5 ohm", l: "1 mH", r_f: "10 ohm", l_f: "0.1 H", l_af: "0.1 H",
            j: "1e-4 kg*m^2", damping: "2e-3 N*m*s/rad", i_f0: "10 A"),
        "field": VoltageSource(v: "100 V"), "supply": ControlledVoltageSource, "gnd": ElectricalReference,"#;
    let power = r#""motor.c <-> friction.c <-> joint.c <-> housing.r", "field.p <-> motor.fp", "supply.p <-> motor.p",
        "field.n <-> motor.fn <-> motor.n <-> supply.n <-> gnd.p","#;
    let gears = r#""gear": CycloidalDrive(disc_teeth: 10, ring_teeth: 11, direction: Same, efficiency_forward: 0.8,
            threshold: "1e-3 rad/s"),
        "gear2": CycloidalDrive(disc_teeth: 5, ring_teeth: 6, direction: Same, efficiency_forward: 0.7,
            threshold: "1e-3 rad/s"),
        "mid": RotationalDamper(d: "0.3 N*m*s/rad"),"#;
    let shaft = r#""motor.r <-> rotor.r <-> gear.base", "gear.follower <-> mid.r <-> gear2.base", "mid.c <-> housing.r","#;
    let backward =
        r#""gear": SimpleGear(ratio: 0.02, direction: Same, efficiency: 0.8, threshold: "1e-5 rad/s"),"#;
    let case = |name, changes, viscous, coulomb| Case { name, changes, viscous, coulomb };
    vec![
        // 4 + 2e-3 * 50^2 of the motor.
        case(
            "motor",
            changes(&[
                (MOTOR, motor),
                (HOUSED, power),
                ("pid.u -> motor.tau", "pid.u -> supply.v"),
                (r#"kp: "60", ki: "200", kd: "6""#, r#"kp: "400", ki: "800", kd: "20""#),
            ]),
            9.0,
            6.0,
        ),
        // The bearing behind both gears, the damper on a shaft that turns five times behind the first one.
        case(
            "two gears",
            changes(&[
                (GEAR, gears),
                ("gear.follower <->", "gear2.follower <->"),
                (r#""motor.r <-> rotor.r <-> gear.base","#, shaft),
            ]),
            4.0 / 0.56 + 0.3 * 25.0 / 0.8,
            6.0 / 0.56,
        ),
        // A gear that is driven at its follower.
        case(
            "backward",
            changes(&[
                (GEAR, backward),
                ("rotor.r <-> gear.base", "rotor.r <-> gear.follower"),
                ("gear.follower <-> friction.r", "gear.base <-> friction.r"),
            ]),
            4.0 / 0.8,
            6.0 / 0.8,
        ),
        // 0.1 * 4^2 behind a gear beside the drive with an efficiency of a half.
        case(
            "side",
            beside(
                r#""side": SimpleGear(ratio: 4, direction: Same, efficiency: 0.5, threshold: "1e-4 rad/s"),
                "d": RotationalDamper(d: "0.1 N*m*s/rad"),"#,
                r#""joint.r <-> side.follower", "side.base <-> d.r", "d.c <-> housing.r","#,
            ),
            4.0 + 1.6 / 0.5,
            6.0,
        ),
        // 1e-3 * 50^2 and 0.05 * 50.
        case(
            "shaft",
            beside(
                r#""shaft": RotationalFriction(viscous: "1e-3 N*m*s/rad", coulomb: "0.05 N*m", breakaway: "0.06 N*m",
                    breakaway_velocity: "1 rad/s"),"#,
                r#""motor.r <-> shaft.r", "shaft.c <-> housing.r","#,
            ),
            4.0 + 2.5,
            6.0 + 2.5,
        ),
        case(
            "second",
            beside(
                r#""cover": RotationalFriction(viscous: "1 N*m*s/rad", coulomb: "2 N*m", breakaway: "3 N*m",
                    breakaway_velocity: "0.02 rad/s"),"#,
                r#""joint.r <-> cover.r", "cover.c <-> housing.r","#,
            ),
            4.0 + 1.0,
            6.0 + 2.0,
        ),
    ]
}

#[test]
fn friction_of_all_parts_is_booked_where_it_is() {
    let folder = Folder::new("parts");
    for Case { name, changes, viscous, coulomb } in cases() {
        let output = identify_model(&folder, "friction", &axis_with(&changes), &["--json"]);
        assert_eq!(output.status.code(), Some(0), "{name}: {}", said(&output));
        let found = &lines(&output)[0];
        let near = |group: &str, key: &str, what: &str, expected: f64, tolerance: f64| {
            let value = found[group][key][what].as_f64();
            let value = value.unwrap_or_else(|| panic!("{name}, {group}.{key}: {found}"));
            let off = (value / expected - 1.0).abs();
            assert!(off < tolerance, "{name}: {group}.{key}.{what} {value} is not {expected}");
        };
        for (key, expected) in [("viscous", viscous), ("coulomb", coulomb)] {
            near("at_the_motor", key, "set", expected, 1e-5);
            near("at_the_motor", key, "value", expected, 5e-3);
        }
        near("bearing", "viscous", "value", 4.0, 5e-3);
        near("bearing", "coulomb", "value", 6.0, 5e-3);
        // Behind two gears only one of the slow moves is steady: no breakaway, and a reason.
        match found["not_identified"][1].as_str() {
            None => {
                near("bearing", "breakaway", "value", 8.0, 5e-3);
                near("bearing", "breakaway_velocity", "value", 0.02, 5e-3);
            }
            Some(reason) => {
                assert_eq!(reason, "one of the speeds used shows it, and two are needed", "{name}");
                assert!(found["bearing"]["breakaway"].is_null() && name == "two gears", "{found}");
            }
        }
    }
}

#[test]
fn friction_that_sticks_is_fitted_by_its_own_law() {
    let folder = Folder::new("sticks");
    let model = axis_with(&changes(&[("model: Smooth", "model: Stiction")]));
    let output = identify_model(&folder, "friction", &model, &["--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let found = &lines(&output)[0];
    for name in ["viscous", "coulomb", "breakaway", "breakaway_velocity"] {
        let off = deviation(found, "bearing", name);
        assert!(off < 2e-3, "{name} is off by {off}: {found}");
    }
}

#[test]
fn what_the_parameters_do_not_give_is_named_with_a_remedy() {
    let folder = Folder::new("unknown");
    let friction = |changes: &Changes, arguments: &[&str]| {
        identify_model(&folder, "friction", &axis_with(changes), arguments)
    };
    // The torque of the motor stays a measurement; the bearing alone is not known.
    let input = beside(r#""drag": Gain(k: -3),"#, r#""joint.w -> drag.u", "drag.y -> joint.torque","#);
    let output = friction(&input, &["--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let found = &lines(&output)[0];
    let viscous = &found["at_the_motor"]["viscous"];
    assert!((viscous["value"].as_f64().unwrap() - 7.0).abs() < 1e-3 && viscous["set"].is_null(), "{found}");
    assert_eq!(found["bearing"], serde_json::json!({}));
    let reason =
        "blocks act on `joint` by its input `torque`; leave this input unconnected for the measurement";
    assert_eq!(found["not_identified"], serde_json::json!([null, reason]));

    let output = friction(
        &changes(&[
            ("\"friction\": RotationalFriction(", "\"friction\": LuGreFriction("),
            (
                r#"breakaway_velocity: "0.02 rad/s", model: Smooth"#,
                r#"stribeck_velocity: "0.03 rad/s", sigma0: "1e5 N*m/rad", sigma1: "300 N*m*s/rad""#,
            ),
        ]),
        &[],
    );
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let reason = "  not identified: the bristles of `friction` still bend in slow moves; put a `RotationalFriction` in its \
                  place for the measurement\n";
    assert!(text.contains(reason), "{text}{}", said(&output));

    // A brake is open while the axis moves.
    let brake = beside(
        r#""brake": Brake(torque: "20 N*m"), "open": Constant(value: 0),"#,
        r#""motor.r <-> brake.r", "brake.c <-> housing.r", "open.y -> brake.engaged","#,
    );
    let output = friction(&brake, &["--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let found = &lines(&output)[0];
    let note = "what `brake` transmits follows its input; it counts as friction of the bearing";
    assert_eq!(found["notes"], serde_json::json!([note]));
    assert!(deviation(found, "bearing", "viscous") < 2e-3, "{found}");

    // A spring that is relaxed elsewhere in each move.
    let spring = beside(
        r#""spring": RotationalSpring(k: "30 N*m/rad"),"#,
        r#""joint.r <-> spring.r", "spring.c <-> housing.r","#,
    );
    let output = friction(&spring, &[]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(
        said(&output),
        "error[usage]: axis 1: `spring` counts its deflection from the start of a run, and each move starts elsewhere\n  \
         = help: leave it out for the measurement, or use stiffness and limits of the joint\n"
    );

    // A second motor.
    let second = beside(
        r#""assist": IdealTorqueSource, "push": Constant(value: 2),"#,
        r#""joint.r <-> assist.r", "assist.c <-> housing.r", "push.y -> assist.tau","#,
    );
    let output = friction(&second, &[]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(
        said(&output),
        "error[usage]: axis 1: `assist` and `motor` drive the axis together\n  \
         = help: drive the axis by one motor for the measurement\n"
    );
}

#[test]
fn springs_and_dampers_in_joints_are_no_inertia_and_other_forces_are_refused() {
    let folder = Folder::new("inside");
    // By hand: 0.3 kg*m^2 + 8 kg * (0.3 m)^2.
    let inertia = 0.3 + 8.0 * 0.09;
    for joint in ["", r#"stiffness: "30 N*m/rad", "#, r#"damping: "3 N*m*s/rad", "#] {
        let model = axis_with(&vec![("RevoluteJoint(", format!("RevoluteJoint({joint}"))]);
        let output = identify_model(&folder, "dynamics", &model, &["--noise", "0", "--json"]);
        assert_eq!(output.status.code(), Some(0), "{joint}: {}", said(&output));
        let found = lines(&output);
        let value = found[0]["value"].as_f64().unwrap();
        assert!((value - inertia).abs() < 1e-9 && found[0]["inside"] == true, "{joint}: {found:?}");
        assert_eq!(found[1]["units"], serde_json::json!(["N*m"]));
        assert!(found[1]["residuals"][0].as_f64().unwrap() < 1e-9, "{joint}: {found:?}");
    }
    let band = beside(
        r#""band": FrameSpringDamper(stiffness: "200 N/m", length: "0.1 m"),
        "anchor": Transform(translation: ["0.5 m", 0, 0]), "tip": Transform(translation: ["0.3 m", "0.1 m", 0]),"#,
        r#""joint.follower <-> tip.base", "world.frame <-> anchor.base", "anchor.follower <-> band.base",
        "band.follower <-> tip.follower","#,
    );
    let output = identify_model(&folder, "dynamics", &axis_with(&band), &[]);
    assert_eq!(output.status.code(), Some(3), "{}", said(&output));
    assert_eq!(
        said(&output),
        "error[identify]: forces of `band` act on the bodies beside the drives\n  \
         = help: leave these blocks out for the measurement\n"
    );
    let output = identify_model(&folder, "friction", &axis_with(&band), &[]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("note: the force of `band` on the bodies is not taken off"), "{text}");
}

/// A slide that lifts an arm which turns about the vertical: by hand `F = (m1 + m2) (a + g)` and `tau = Izz a`.
#[test]
fn forces_of_slides_are_in_newtons() {
    let folder = Folder::new("slide");
    let arm = r#"(links: [
        (slide: [0, 0, 1],
         limits: (lower: "-1 m", upper: "1 m", speed: "9 m/s", acceleration: "99 m/s^2"),
         bodies: [(mass: "5 kg", com: [0, 0, 0], moi: ["0.1 kg*m^2", "0.1 kg*m^2", "0.1 kg*m^2"])],
         drive: (gear: (lead: "20 mm", efficiency_forward: 0.8, inertia: "1e-5 kg*m^2"),
             motor: (inertia: "9e-5 kg*m^2", damping: "0 N*m*s/rad"),
             bearing: (viscous: "2 N*s/m", coulomb: "3 N", breakaway: "3 N", breakaway_velocity: "1e-3 m/s"))),
        (axis: [0, 0, 1],
         limits: (lower: "-3 rad", upper: "3 rad", speed: "9 rad/s", acceleration: "99 rad/s^2"),
         bodies: [(mass: "2 kg", com: [0, 0, 0], moi: ["0.2 kg*m^2", "0.2 kg*m^2", "0.3 kg*m^2"])],
         drive: (gear: (ratio: 60, efficiency_forward: 0.8, inertia: "1e-5 kg*m^2"),
             motor: (inertia: "9e-5 kg*m^2", damping: "0 N*m*s/rad"),
             bearing: (viscous: "2 N*m*s/rad", coulomb: "3 N*m", breakaway: "3 N*m", breakaway_velocity: "1e-3 rad/s"))),
    ])"#;
    let file = folder.file("arm.ron");
    std::fs::write(&file, arm).unwrap();
    // Turns of the motor for a metre and for a radian; its inertia at the joint, and all behind an efficiency of 0.8.
    let ratios = [std::f64::consts::TAU / 0.02, 60.0];
    let table = |name: &str, other: f64| {
        let mut table =
            "time [s],q1 [m],q2 [rad],v1 [m/s],v2 [rad/s],a1 [m/s^2],a2 [rad/s^2],t1 [N],t2 [N*m],\
                         m1 [N*m],m2 [N*m]\n"
                .to_owned();
        for k in 0..2000 {
            let t = 2e-3 * f64::from(k);
            let course = |size: f64, w: f64| {
                (size * (w * t).sin(), size * w * (w * t).cos(), -size * w * w * (w * t).sin())
            };
            let (q1, v1, a1) = course(0.3, 5.0);
            let (q2, v2, a2) = course(0.8, 7.0);
            let pushed = other * (11.0 * t).sin();
            let loads = [7.0 * (a1 + 9.80665) + pushed, 0.3 * a2 + pushed];
            let motor = |joint: usize, v: f64, a: f64| {
                let behind = loads[joint] + 3.0 * v.signum() + 2.0 * v;
                (behind / 0.8 + ratios[joint] * ratios[joint] * 1e-4 * a) / ratios[joint]
            };
            let (m1, m2) = (motor(0, v1, a1), motor(1, v2, a2));
            table += &format!("{t},{q1},{q2},{v1},{v2},{a1},{a2},{},{},{m1},{m2}\n", loads[0], loads[1]);
        }
        std::fs::write(folder.file(name), table).unwrap();
        folder.file(name)
    };
    let signals = ["--q", "q{}", "--qd", "v{}", "--qdd", "a{}", "--tau", "t{}"];
    let call = |command: &str, log: &str, more: &[&str]| {
        let output = identify(&[&[command, file.as_str(), "--from", log], &signals[..], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        output
    };
    let log = table("log.csv", 0.0);
    let found = lines(&call("dynamics", &log, &["--json"]));
    let (last, parameters) = found.split_last().unwrap();
    let values: Vec<f64> = parameters.iter().map(|parameter| parameter["value"].as_f64().unwrap()).collect();
    assert!((values[0] - 7.0).abs() < 1e-9 && (values[1] - 0.3).abs() < 1e-9, "{found:?}");
    assert!(parameters.iter().all(|parameter| parameter["inside"] == true), "{found:?}");
    assert_eq!(last["units"], serde_json::json!(["N", "N*m"]));
    let text = String::from_utf8_lossy(&call("dynamics", &log, &[]).stdout).into_owned();
    let rows: Vec<&str> = text.lines().rev().take(2).map(str::trim_end).collect();
    assert!(rows[1].ends_with(" N") && rows[0].ends_with(" N*m"), "{text}");
    // Something pushes in both directions, so that the motor drives in both.
    let log = table("pushed.csv", 200.0);
    for result in lines(&call("friction", &log, &["--motor", "m{}", "--json"])) {
        let coulomb = result["coulomb"]["value"].as_f64().unwrap();
        assert!((coulomb - 3.0 / 0.8).abs() < 1e-9, "{result}");
    }
    let text = String::from_utf8_lossy(&call("friction", &log, &["--motor", "m{}"]).stdout).into_owned();
    let heads: Vec<&str> = text.lines().filter(|line| line.starts_with("Axis")).collect();
    assert!(heads[0].ends_with(" N") && heads[1].ends_with(" N*m"), "{text}");
}
