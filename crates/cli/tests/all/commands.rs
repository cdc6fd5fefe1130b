//! The program as users call it: exit codes, what goes where, what is left on the disk.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicU32, Ordering};

use crate::support::program;

const LAG: &str = r#"Diagram(
    title: "First order lag",
    parameters: { "lag": "0.2 s" },
    simulation: (stop_time: "1 s", output: Every("0.01 s")),
    blocks: {
        "demand": Step(time: "0.1 s", after: "90 deg"),
        "lag_block": LowPass(tau: "lag"),
        "scope": Scope(inputs: ["set", "actual"], display: "deg"),
    },
    connections: [
        "demand.y -> lag_block.u, scope.set",
        "lag_block.y -> scope.actual",
    ],
)
"#;

const BROKEN: &str = r#"Diagram(
    blocks: { "demand": Step(time: "0.1 s", after: 1.0), "gain": Gian(k: 2.0) },
    connections: ["demand.y -> nowhere.u"],
)
"#;

/// x' = x^2 from 1 has a pole at 1 s, so no step is small enough there.
const POLE: &str = r#"Diagram(
    simulation: (stop_time: "2 s", solver: Ode45(rtol: 1e-6)),
    blocks: { "x": Integrator(x0: 1.0), "square": Product(inputs: 2), "scope": Scope(inputs: ["x"]) },
    connections: ["x.y -> square.u1, square.u2, scope.x", "square.y -> x.u"],
)
"#;

/// Long enough to be interrupted.
const LONG: &str = r#"Diagram(
    simulation: (stop_time: "1e7 s", solver: Ode4(step: "1 ms"), output: Every("1000 s")),
    blocks: { "wave": Sine(amplitude: 1.0, frequency: "1 Hz"), "x": Integrator, "scope": Scope(inputs: ["x"]) },
    connections: ["wave.y -> x.u", "x.y -> scope.x"],
)
"#;

/// A folder of its own for each test, removed at the end.
struct Desk(PathBuf);

impl Desk {
    fn with(files: &[(&str, &str)]) -> Desk {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let n = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("blocksim-cli-{}-{n}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        files.iter().for_each(|(name, text)| fs::write(path.join(name), text).unwrap());
        Desk(path)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = program();
        command.current_dir(&self.0).args(arguments).env_remove("CLICOLOR_FORCE").env_remove("COLUMNS");
        command
    }

    fn call(&self, arguments: &[&str]) -> Answer {
        Answer::from(self.command(arguments).output().unwrap())
    }

    fn read(&self, path: &str) -> String {
        fs::read_to_string(self.0.join(path)).unwrap()
    }

    /// Names below `runs`.
    fn runs(&self) -> Vec<String> {
        names(&self.0.join("runs"))
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[derive(Debug)]
struct Answer {
    code: Option<i32>,
    out: String,
    err: String,
}

impl From<Output> for Answer {
    fn from(output: Output) -> Answer {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Answer { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
    }
}

#[test]
fn a_run_is_told_and_kept() {
    let desk = Desk::with(&[("lag.ron", LAG)]);
    let answer = desk.call(&["run", "lag.ron"]);
    assert_eq!(answer.code, Some(0), "{answer:?}");
    assert_eq!(answer.err, "");
    for part in [
        "First order lag\nsimulated  1.000 s in ",
        "solver     Auto",
        "method     Ode45: nothing was stiff",
        "tracking [deg]  maximum error",
        "┤",
    ] {
        assert!(answer.out.contains(part), "{part} is missing in\n{}", answer.out);
    }
    let runs = desk.runs();
    assert_eq!(runs.len(), 1);
    assert!(runs[0].ends_with("_lag") && answer.out.contains(&format!("runs/{}", runs[0])), "{runs:?}");
    let run = format!("runs/{}", runs[0]);
    let files = ["events.csv", "log.txt", "manifest.json", "model.json", "signals.csv", "signals.rec"];
    assert_eq!(names(&desk.0.join(&run)), files);
    let manifest = desk.read(&format!("{run}/manifest.json"));
    for part in ["\"how\": \"complete\"", "\"path\": \"lag.ron\"", "\"hash\": \"fnv1a64:", "\"files\": []"] {
        assert!(manifest.contains(part), "{part} is missing in\n{manifest}");
    }
    let signals = desk.read(&format!("{run}/signals.csv"));
    assert_eq!(signals.lines().next(), Some("time [s],scope.set [rad],scope.actual [rad]"));
    // y = (pi / 2) (1 - e^(-(t - 0.1) / 0.2)) at the end, within the tolerance of the solver.
    let last: f64 = signals.lines().last().unwrap().rsplit(',').next().unwrap().parse().unwrap();
    let expected = std::f64::consts::FRAC_PI_2 * (1.0 - (-0.9_f64 / 0.2).exp());
    assert!((last - expected).abs() < 1e-5, "{last} is not {expected}");
    assert!(desk.read(&format!("{run}/log.txt")).starts_with("First order lag\n"));
}

#[test]
fn parameters_and_settings_are_changed_from_the_command_line() {
    let desk = Desk::with(&[("lag.ron", LAG)]);
    let options =
        ["--set", "lag=50ms", "--until", "500 ms", "--solver", "ode4", "--step", "1ms", "--out", "new"];
    let answer = desk.call(&[&["run", "lag.ron", "--no-plot"], &options[..]].concat());
    assert_eq!(answer.code, Some(0), "{answer:?}");
    assert!(answer.out.contains("Ode4, step 0.001 s") && !answer.out.contains('┤'), "{}", answer.out);
    let manifest = desk.read("new/manifest.json");
    assert!(manifest.contains("\"path\": \"lag\",\n      \"value\": \"50ms\""), "{manifest}");
    let signals = desk.read("new/signals.csv");
    let last: Vec<f64> = signals.lines().last().unwrap().split(',').map(|x| x.parse().unwrap()).collect();
    let expected = std::f64::consts::FRAC_PI_2 * (1.0 - (-0.4_f64 / 0.05).exp());
    assert!(last[0] == 0.5 && (last[2] - expected).abs() < 1e-6, "{last:?} is not {expected}");
}

#[test]
fn nothing_is_overwritten() {
    let desk = Desk::with(&[("lag.ron", LAG)]);
    fs::create_dir(desk.0.join("old")).unwrap();
    fs::write(desk.0.join("old/signals.csv"), "precious").unwrap();
    let answer = desk.call(&["run", "lag.ron", "--out", "old"]);
    assert_eq!(answer.code, Some(4));
    assert!(
        answer.err.contains("`old`: it already holds files") && answer.err.contains("--out"),
        "{answer:?}"
    );
    assert_eq!(desk.read("old/signals.csv"), "precious");
    for _ in 0..2 {
        assert_eq!(desk.call(&["run", "lag.ron", "--quiet"]).code, Some(0));
    }
    assert_eq!(desk.runs().len(), 2);
}

#[test]
fn a_place_that_cannot_be_written_is_refused_before_the_run() {
    let desk = Desk::with(&[("long.ron", LONG), ("runs", "a file in the way")]);
    for options in [&["run", "long.ron"][..], &["run", "long.ron", "--out", "runs/here"]] {
        let answer = desk.call(options);
        assert_eq!(answer.code, Some(4), "{answer:?}");
        assert!(answer.err.contains("= help: choose another place with --out"), "{answer:?}");
    }
    assert_eq!(names(&desk.0), ["long.ron", "runs"]);
}

#[test]
fn a_model_with_errors_is_not_run() {
    let desk = Desk::with(&[("broken.ron", BROKEN)]);
    let answer = desk.call(&["run", "broken.ron"]);
    assert_eq!((answer.code, answer.out.as_str()), (Some(3), ""));
    assert!(
        answer.err.contains(" --> broken.ron:2:") && answer.err.contains("did you mean `Gain`"),
        "{answer:?}"
    );
    assert!(
        answer.err.ends_with("2 errors; nothing was run\n") && !answer.err.contains('\x1b'),
        "{answer:?}"
    );
    assert!(desk.runs().is_empty());
    assert!(desk.call(&["run", "broken.ron", "--color", "always"]).err.contains('\x1b'));
}

#[test]
fn check_tells_problems_in_three_ways() {
    let desk = Desk::with(&[("broken.ron", BROKEN), ("lag.ron", LAG)]);
    let short = desk.call(&["check", "broken.ron", "--output-format", "short"]);
    assert_eq!(short.code, Some(3));
    assert_eq!(short.err.lines().filter(|line| line.contains(": error[")).count(), 2, "{short:?}");
    let json = desk.call(&["check", "broken.ron", "--output-format", "json"]);
    assert_eq!((json.code, json.out.lines().count(), json.err.as_str()), (Some(3), 2, ""));
    let first: serde_json::Value = serde_json::from_str(json.out.lines().next().unwrap()).unwrap();
    assert_eq!((&first["type"], &first["labels"][0]["line"]), (&"diagnostic".into(), &2.into()));
    let good = desk.call(&["check", "lag.ron"]);
    assert_eq!((good.code, good.err.as_str()), (Some(0), ""));
    assert!(good.out.starts_with("lag.ron: no problems; 3 blocks, "), "{good:?}");
    let wrong = desk.call(&["check", "lag.ron", "--set", "leg=1s"]);
    assert!(wrong.code == Some(3) && wrong.err.contains("did you mean `lag`"), "{wrong:?}");
}

#[test]
fn a_failure_keeps_what_was_recorded() {
    let desk = Desk::with(&[("pole.ron", POLE)]);
    let answer = desk.call(&["run", "pole.ron", "--out", "pole"]);
    assert_eq!(answer.code, Some(1), "{answer:?}");
    assert!(answer.err.starts_with("error[") && answer.err.contains(" at t = "), "{answer:?}");
    assert!(answer.out.contains("\nfailed     "), "{answer:?}");
    assert!(desk.read("pole/manifest.json").contains("\"how\": \"failed\""));
    // x = 1 / (1 - t) is recorded up to close before its pole.
    assert!(desk.read("pole/signals.csv").lines().any(|line| line.starts_with("0.99")));
}

#[test]
fn json_is_a_line_for_each_event() {
    let desk = Desk::with(&[("lag.ron", LAG), ("pole.ron", POLE)]);
    let values = |answer: &Answer| -> Vec<serde_json::Value> {
        answer.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    };
    let good = values(&desk.call(&["run", "lag.ron", "--json"]));
    let done = good.last().unwrap();
    assert_eq!((&done["type"], &done["ended"]), (&"done".into(), &"complete".into()));
    assert_eq!(done["tracking"][0]["unit"], "deg");
    let failed = values(&desk.call(&["run", "pole.ron", "--json"]));
    assert_eq!(failed[0]["type"], "diagnostic");
    assert_eq!(failed.last().unwrap()["ended"], "failed");
}

#[test]
fn mistakes_on_the_command_line_are_usage() {
    let desk = Desk::with(&[("lag.ron", LAG)]);
    for arguments in [
        &["run"][..],
        &["walk"],
        &["run", "lag.ron", "--until", "soon"],
        &["run", "lag.ron", "--set", "lag"],
        &["run", "lag.ron", "--solver", "ode46"],
        &["blocks", "Gian"],
        &["explain", "no_such_code_at_all"],
        &["emit", "soup", "lag.ron"],
    ] {
        let answer = desk.call(arguments);
        assert!(answer.code == Some(2) && answer.err.starts_with("error"), "{arguments:?} {answer:?}");
    }
    assert!(desk.call(&["blocks", "Gian"]).err.contains("did you mean `Gain`?"));
    assert!(desk.runs().is_empty());
}

#[test]
fn whoever_asks_for_data_gets_failures_as_data() {
    let desk = Desk::with(&[("lag.ron", LAG), ("broken.ron", BROKEN), ("pole.ron", POLE)]);
    for (line, code, word) in [
        ("run", 2, "usage"),
        ("run leg.ron", 4, "unreadable"),
        ("run broken.ron", 3, "unknown_block"),
        ("run lag.ron --solver ode46", 2, "usage"),
        ("run pole.ron", 1, "step_size"),
        ("plot nothing", 4, "unreadable"),
        ("compare a b", 4, "unreadable"),
        ("collisions nothing", 4, "unreadable"),
        ("sweep lag.ron --over leg=1..2/2", 3, "unknown_override"),
        ("linearise lag.ron --from demand.y --to nowhere", 2, "usage"),
        ("blocks Gian", 2, "usage"),
        ("graph lag.ron --path inside", 2, "usage"),
        ("graph lag.ron --loop 1", 2, "usage"),
        ("params list lag.ron leg", 2, "usage"),
        ("params get lag.ron leg", 2, "usage"),
        ("plan joint --robot nowhere.ron --to 1", 4, "unreadable"),
        ("identify friction lag.ron", 3, "identify"),
        ("plugin show nowhere", 4, "plugin_missing"),
    ] {
        let arguments: Vec<&str> = line.split(' ').chain(["--json"]).collect();
        let answer = desk.call(&arguments);
        assert_eq!(answer.code, Some(code), "{line}: {answer:?}");
        let told = answer.out.lines().find_map(|line| {
            let data: serde_json::Value = serde_json::from_str(line).ok()?;
            (data["type"] == "diagnostic" && data["severity"] == "error").then_some(data)
        });
        let told = told.unwrap_or_else(|| panic!("{line}: no diagnostic in {answer:?}"));
        assert_eq!((told["code"].as_str(), told["exit"].as_i64()), (Some(word), Some(code.into())), "{line}");
        assert!(
            !answer.err.contains("error[") && !answer.err.contains("error:"),
            "{line}: told twice: {}",
            answer.err
        );
    }
}

#[cfg(unix)]
#[test]
fn words_that_are_no_unicode_are_usage_and_no_bug() {
    use std::os::unix::ffi::OsStrExt;
    let desk = Desk::with(&[]);
    let word = std::ffi::OsStr::from_bytes(b"\xff");
    for arguments in [&[][..], &["check", "--output-format"]] {
        let output = desk.command(arguments).arg(word).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{output:?}");
    }
    let output = desk.command(&["check"]).arg(word).output().unwrap();
    assert_eq!(output.status.code(), Some(4), "{output:?}");
}

#[test]
fn a_missing_model_is_a_matter_of_files() {
    let desk = Desk::with(&[("lag.ron", LAG)]);
    for verb in ["run", "check"] {
        let answer = desk.call(&[verb, "leg.ron"]);
        assert_eq!(answer.code, Some(4), "{answer:?}");
        assert!(answer.err.contains("did you mean `lag.ron`?"), "{answer:?}");
    }
}

#[test]
fn all_steps_of_the_compiler_can_be_printed() {
    let desk = Desk::with(&[("lag.ron", LAG), ("broken.ron", BROKEN)]);
    for stage in ["ast", "model", "flat", "types", "schedule"] {
        let answer = desk.call(&["emit", stage, "lag.ron"]);
        assert!(answer.code == Some(0) && answer.out.contains("lag"), "{stage} {answer:?}");
    }
    assert_eq!(desk.call(&["emit", "schedule", "broken.ron"]).code, Some(3));
}

#[test]
fn chosen_signals_are_plotted_and_lost_ones_are_named() {
    let desk = Desk::with(&[("lag.ron", LAG)]);
    let plotted = desk.call(&["run", "lag.ron", "--plot", "*.set"]);
    assert!(plotted.out.contains("  scope.set") && plotted.err.is_empty(), "{plotted:?}");
    let lost = desk.call(&["run", "lag.ron", "--plot", "q1"]);
    assert_eq!(lost.code, Some(0));
    assert!(lost.err.contains("no recorded signal fits `q1`"), "{lost:?}");
}

#[test]
fn the_program_alone_says_what_it_can_do() {
    let desk = Desk::with(&[]);
    let alone = desk.call(&[]);
    assert!(alone.code == Some(0) && alone.out.contains("blocksim run MODEL.ron"), "{alone:?}");
    let version = desk.call(&["--version"]);
    assert_eq!(version.out, format!("blocksim {}\n", env!("CARGO_PKG_VERSION")));
    let page = desk.call(&["blocks", "LowPass"]);
    assert!(
        page.code == Some(0) && page.out.contains("  u     input ") && page.out.contains("tau"),
        "{page:?}"
    );
}

#[test]
fn runs_are_listed_and_exported_at_the_rates_that_were_asked_for() {
    let desk = Desk::with(&[("lag.ron", LAG)]);
    let signals = "*.set,*.actual@100ms";
    let answer = desk.call(&["run", "lag.ron", "--quiet", "--signals", signals]);
    assert_eq!(answer.code, Some(0), "{answer:?}");
    let run = answer.out.trim();
    let files = [
        "events.csv",
        "log.txt",
        "manifest.json",
        "model.json",
        "signals-100ms.csv",
        "signals.csv",
        "signals.rec",
    ];
    assert_eq!(names(&desk.0.join(run)), files);
    assert!(desk.read(&format!("{run}/signals.csv")).starts_with("time [s],scope.set [rad]\n"));
    // The start, ten multiples of 100 ms, of which the last is the end.
    assert_eq!(desk.read(&format!("{run}/signals-100ms.csv")).lines().count(), 12);

    let listed = desk.call(&["runs"]);
    assert_eq!(listed.code, Some(0));
    assert!(listed.out.contains("_lag") && listed.out.contains("complete"), "{listed:?}");
    let data = desk.call(&["runs", "--json"]);
    assert!(data.out.contains("\"model\":\"lag.ron\"") && data.out.lines().count() == 1, "{data:?}");

    let both = desk.call(&["export", "latest", "--csv", "lag.csv"]);
    assert_eq!((both.code, both.out.as_str()), (Some(0), "lag.csv\nlag-2.csv\n"), "{both:?}");
    assert_eq!(desk.read("lag.csv"), desk.read(&format!("{run}/signals.csv")));
    let grid = desk.call(&["export", "lag", "--csv", "grid.csv", "--every", "250ms", "--from", "0.4"]);
    assert_eq!(grid.code, Some(0), "{grid:?}");
    let grid = desk.read("grid.csv");
    let mut lines = grid.lines();
    assert_eq!(lines.next(), Some("time [s],scope.set [rad],scope.actual [rad]"));
    assert_eq!(lines.map(|line| line.split(',').next().unwrap()).collect::<Vec<_>>(), ["0.5", "0.75", "1"]);
    assert_eq!(desk.call(&["export", "lag", "--mat", "lag.mat"]).code, Some(0));

    let again = desk.call(&["export", "lag", "--csv", "lag.csv"]);
    assert!(
        again.code == Some(4) && again.err.contains("`lag.csv`: a file of this name is in the way"),
        "{again:?}"
    );
    let lost = desk.call(&["export", "lag", "--csv", "x.csv", "--signals", "q1"]);
    assert!(lost.code == Some(2) && lost.err.contains("fits `q1`"), "{lost:?}");
    let none = desk.call(&["export", "arm", "--csv", "x.csv"]);
    assert!(none.code == Some(4) && none.err.contains("run in `runs` has this name"), "{none:?}");
    assert_eq!(desk.call(&["export", "lag"]).code, Some(2));
    let wrong = desk.call(&["run", "lag.ron", "--signals", "leg"]);
    assert!(wrong.code == Some(2) && wrong.err.contains("no recorded signal fits `leg`"), "{wrong:?}");
    assert_eq!(desk.call(&["run", "lag.ron", "--signals", "*@fast"]).code, Some(2));
    let bare = desk.call(&["run", "lag.ron", "--quiet", "--no-csv", "--out", "bare"]);
    assert_eq!(bare.code, Some(0));
    assert_eq!(
        names(&desk.0.join("bare")),
        ["events.csv", "log.txt", "manifest.json", "model.json", "signals.rec"]
    );
    assert_eq!(desk.call(&["runs", "none"]).code, Some(0));
}

const PENDULUM: &str = r#"<robot name="pendulum">
  <link name="stand"/>
  <joint name="hinge" type="continuous">
    <parent link="stand"/><child link="rod"/><axis xyz="0 1 0"/>
  </joint>
  <link name="rod">
    <inertial>
      <origin xyz="0 0 -0.5"/><mass value="2"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.01"/>
    </inertial>
  </link>
</robot>
"#;

#[test]
fn importing_again_brings_numbers_up_to_date_and_leaves_the_diagram_alone() {
    let desk = Desk::with(&[("pendulum.urdf", PENDULUM)]);
    let first = desk.call(&["import", "pendulum.urdf", "--out", "p"]);
    assert_eq!(
        (first.code, names(&desk.0.join("p"))),
        (Some(0), vec!["pendulum.ron".into(), "pendulum_parameters.ron".into(), "pendulum_robot.ron".into()]),
        "{}",
        first.err
    );
    assert_eq!(desk.call(&["check", "p/pendulum.ron"]).code, Some(0));
    let mine = desk.read("p/pendulum.ron").replace("// ", "// mine: ");
    fs::write(desk.0.join("p/pendulum.ron"), &mine).unwrap();

    let changed = PENDULUM.replace("value=\"2\"", "value=\"3\"").replace("name=\"hinge\"", "name=\"pin\"");
    fs::write(desk.0.join("pendulum.urdf"), changed).unwrap();
    let again = desk.call(&["import", "pendulum.urdf", "--out", "p"]);
    assert_eq!(again.code, Some(0), "{}", again.err);
    assert!(again.out.contains("1 changed"), "{}", again.out);
    assert!(again.out.contains("new: joints.pin"), "{}", again.out);
    assert!(again.out.contains("gone: joints.hinge; pendulum.ron still names it, line "), "{}", again.out);
    assert_eq!(desk.read("p/pendulum.ron"), mine);
    assert!(desk.read("p/pendulum_parameters.ron").contains("mass: \"3 kg\""));
}

#[test]
fn an_import_never_overwrites_what_somebody_has_changed() {
    let desk = Desk::with(&[("pendulum.urdf", PENDULUM)]);
    desk.call(&["import", "pendulum.urdf", "--out", "p"]);
    let mine = desk.read("p/pendulum_parameters.ron").replace("2 kg", "5 kg");
    fs::write(desk.0.join("p/pendulum_parameters.ron"), &mine).unwrap();
    let refused = desk.call(&["import", "pendulum.urdf", "--out", "p"]);
    assert_eq!(refused.code, Some(4));
    assert!(refused.err.contains("--yes"), "{}", refused.err);
    assert_eq!(desk.read("p/pendulum_parameters.ron"), mine);
    assert_eq!(desk.call(&["import", "pendulum.urdf", "--out", "p", "--yes"]).code, Some(0));
    assert!(desk.read("p/pendulum_parameters.ron").contains("2 kg"));
}

#[test]
fn an_import_of_a_faulty_file_writes_nothing_and_tells_all_faults() {
    let faulty = PENDULUM.replace("value=\"2\"", "value=\"-2\"").replace("link=\"stand\"", "link=\"stnad\"");
    let desk = Desk::with(&[("pendulum.urdf", faulty.as_str())]);
    let refused = desk.call(&["import", "pendulum.urdf", "--out", "p"]);
    assert_eq!(refused.code, Some(3));
    assert!(refused.err.contains("pendulum.urdf:4: <parent> names the link `stnad`"), "{}", refused.err);
    assert!(refused.err.contains("pendulum.urdf:8: the mass of `rod` is -2 kg"), "{}", refused.err);
    assert!(!desk.0.join("p").exists());
}

#[test]
fn a_data_file_gives_parameters_alone_and_refuses_units_that_are_not_known() {
    let data = "smiData.Solid(1).mass = 5;  % kg\nsmiData.Solid(1).CoM = [1 2 3];  % mm\nsmiData.Solid(1).MoI = [9 8 7];  % kg*mm^2\nsmiData.Solid(1).PoI = [0 0 0];  % kg*mm^2\nsmiData.Solid(1).ID = 'tool';\n";
    let desk = Desk::with(&[("robot.m", data), ("wrong.m", &data.replace("% kg\n", "% stone\n"))]);
    assert_eq!(desk.call(&["import", "robot.m", "--out", "p"]).code, Some(0));
    assert_eq!(names(&desk.0.join("p")), ["robot.ron"]);
    assert!(desk.read("p/robot.ron").contains("com: [\"0.001 m\", \"0.002 m\", \"0.003 m\"]"));
    let refused = desk.call(&["import", "wrong.m", "--out", "q"]);
    assert_eq!(refused.code, Some(3));
    assert!(
        refused.err.starts_with("error[import]: wrong.m:1: `mass` has the unit `stone`"),
        "{}",
        refused.err
    );
}
