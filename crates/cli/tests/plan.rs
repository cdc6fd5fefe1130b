//! `blocksim plan` as users call it.

use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Exit code, standard output and standard error.
fn plan(arguments: &[&str]) -> (i32, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_blocksim"));
    command.current_dir(root()).arg("plan").args(arguments).env_remove("CLICOLOR_FORCE");
    let output = command.output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    (output.status.code().unwrap(), out, err)
}

/// A file that goes away.
struct Fresh(PathBuf);

impl Fresh {
    fn named(name: &str) -> Fresh {
        let path = std::env::temp_dir().join(format!("blocksim-plan-{}-{name}", std::process::id()));
        let _ = std::fs::remove_file(&path);
        Fresh(path)
    }

    fn path(&self) -> &str {
        self.0.to_str().unwrap()
    }
}

impl Drop for Fresh {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

const TARGET: &str = "60 deg, 30 deg, -20 deg, 45 deg, 60 deg, 90 deg";

#[test]
fn a_joint_move_tells_duration_and_margins() {
    let (code, out, err) = plan(&["joint", "--to", TARGET]);
    assert_eq!((code, err.as_str()), (0, ""));
    // T_end of the demo move: 0.36735 s + 0.85714 s.
    assert!(out.starts_with("move       1.22449 s"), "{out}");
    assert!(out.contains("   1        0.00      60.00           120.00    40 %          83 %"), "{out}");
}

#[test]
fn a_line_is_written_once_and_planned_again_from_its_file() {
    let file = Fresh::named("line.ron");
    let asked = ["linear", "--from-point", "1 m, 100 mm, 1.3 m", "--to", "1.2 m, -300 mm, 900 mm", "--out"];
    let asked: Vec<&str> = asked.into_iter().chain([file.path()]).collect();
    let (code, out, _) = plan(&asked);
    assert_eq!(code, 0, "{out}");
    let text = std::fs::read_to_string(file.path()).unwrap();
    assert!(text.contains(r#"target: ["1.2 m", "-300 mm", "900 mm"]"#), "as it was typed: {text}");
    assert!(text.contains("result: (planner:"), "{text}");

    let (code, _, err) = plan(&asked);
    assert!(code == 4 && err.contains("is there already"), "{code}: {err}");
    assert_eq!(std::fs::read_to_string(file.path()).unwrap(), text, "and it is left as it was");

    let (code, again, err) = plan(&["sequence", file.path()]);
    assert_eq!(code, 0, "{err}");
    assert_eq!(again.lines().next(), out.lines().next(), "the same duration");
}

#[test]
fn what_is_exceeded_is_told_with_place_and_remedy_and_nothing_is_written() {
    let file = Fresh::named("fast.ron");
    let start = "25 deg, 20 deg, 5 deg, 0 deg, 40 deg, 0 deg";
    let slow = "robot.axis1.limits.acceleration=0.5 rad/s^2";
    let (code, out, err) = plan(&[
        "linear",
        "--from",
        start,
        "--to",
        "1300 mm, -100 mm, 900 mm",
        "--set",
        slow,
        "--out",
        file.path(),
    ]);
    assert_eq!(code, 1, "{out}{err}");
    assert!(out.contains("exceeded   at ") && out.contains("% of the path (s = "), "{out}");
    assert!(out.contains("(links[") && out.contains("= help: lower the acceleration to"), "{out}");
    assert!(err.contains("nothing was written") && !file.0.exists());
}

#[test]
fn wrong_requests_are_refused_before_anything_is_solved() {
    for (arguments, code, reason) in [
        (&["joint", "--to", "60, 30 deg"][..], 2, "`60` of --to has no unit"),
        (&["joint", "--to", "60 deg, 30 deg"], 3, "6 axes"),
        (&["joint", "--to", "200 deg, 0, 0, 0, 0, 0"], 3, "180"),
        (&["joint", "--to", TARGET, "--velocity", "40 mm/s"], 3, "expected a value in 1"),
        (&["joint", "--to", TARGET, "--velocity", "1,5"], 3, "1,5"),
        (&["linear", "--to", "1 s, 0 m, 1 m"], 3, "expected a value in m"),
        (&["linear", "--to", "1 m, 0 m"], 3, "three numbers"),
        (&["linear", "--to", "5 m, 0 m, 1 m"], 3, "error: "),
        (&["linear", "--to", "1.2 m, 0 m, 1 m", "--profile", "fast"], 3, "choose sin2, trapezoid"),
        (&["sequence", "no-such-file.ron"], 4, "no-such-file.ron"),
        (&["joint", "--to", TARGET, "--robot", "diagrams/servo.ron"], 3, "no parameter `manipulator`"),
    ] {
        let (found, out, err) = plan(arguments);
        assert!(found == code && err.contains(reason), "{arguments:?}: {found} {out} {err}");
    }
}

#[test]
fn programs_get_json() {
    let (code, out, _) = plan(&["joint", "--to", TARGET, "--json"]);
    let data: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!((code, data["v"].as_i64()), (0, Some(1)));
    assert!((data["duration"].as_f64().unwrap() - 1.2244897959).abs() < 1e-9);
    assert_eq!(data["axes"].as_array().unwrap().len(), 6);
}
