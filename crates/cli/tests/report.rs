//! `blocksim report` as a user calls it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const MODEL: &str = r#"Diagram(
    title: "servo",
    simulation: (stop_time: "1 s", solver: Ode4(step: "1 ms")),
    blocks: {
        "demand": Step(time: "0.1 s", after: "90 deg"),
        "plant": LowPass(tau: "50 ms"),
        "angle": Scope(inputs: ["set", "actual"], display: "deg"),
    },
    connections: ["demand.y -> plant.u, angle.set", "plant.y -> angle.actual"],
)
"#;

fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("blocksim-report-cli-{}-{name}", std::process::id()));
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    fs::write(path.join("servo.ron"), MODEL).unwrap();
    path
}

fn call(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_blocksim")).current_dir(folder).args(arguments).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_run_becomes_a_page_in_its_folder_with_its_scopes_and_numbers() {
    let folder = folder("page");
    let run = call(&folder, &["run", "servo.ron", "--out", "r", "--quiet"]);
    assert!(run.status.success(), "{}", said(&run));
    fs::write(folder.join("m.csv"), "time [s];angle [deg]\n0;0\n0,5;88,5\n").unwrap();
    let report = call(&folder, &["report", "r", "--overlay", "m.csv"]);
    assert!(report.status.success(), "{}", said(&report));
    let page = fs::read_to_string(folder.join("r/report.html")).unwrap();
    for part in ["<h1>servo</h1>", "\"title\":\"angle\"", "\"unit\":\"°\"", "Following", "m.csv", "servo.ron"]
    {
        assert!(page.contains(part), "{part}");
    }
    assert!(page.len() < 200_000, "{}", page.len());
    assert!(!page.contains("space-view\""), "no shapes, no view in space");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn what_is_wrong_is_said_and_nothing_is_overwritten() {
    let folder = folder("wrong");
    assert!(call(&folder, &["run", "servo.ron", "--out", "r", "--quiet"]).status.success());
    fs::write(folder.join("mine.html"), "mine").unwrap();
    let there = call(&folder, &["report", "r", "-o", "mine.html"]);
    assert_eq!(there.status.code(), Some(4));
    assert!(said(&there).contains("it is there already"), "{}", said(&there));
    assert_eq!(fs::read_to_string(folder.join("mine.html")).unwrap(), "mine");
    for (arguments, part) in [
        (&["report", "nothing"][..], "nothing"),
        (&["report", "r", "-o", "no/where.html"], "there is no such folder"),
        (&["report", "r", "--overlay", "servo.ron"], "servo.ron"),
    ] {
        let output = call(&folder, arguments);
        assert_eq!(output.status.code(), Some(4), "{arguments:?}");
        assert!(said(&output).contains(part) && said(&output).contains("= help"), "{}", said(&output));
    }
    assert!(!folder.join("r/report.html").exists());
    fs::remove_dir_all(folder).unwrap();
}
