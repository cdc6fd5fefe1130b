//! `run --native`: the same bits by machine code, and what is said where there is none.

use std::fs;
use std::path::Path;

use crate::desk::{Answer, Desk};

const MODEL: &str = r#"Diagram(
    simulation: (stop_time: "2 s"),
    blocks: {
        "x": Integrator(x0: 1), "v": Integrator, "k": Gain(k: -9), "f": Function(function: Sin), "s": Saturation(lower: -0.5, upper: 0.5),
        "show": Scope(inputs: ["x", "s"]),
    },
    connections: ["v.y -> x.u", "x.y -> f.u, s.u, show.x", "f.y -> k.u", "k.y -> v.u", "s.y -> show.s"],
)"#;

/// A run into `out`, with a compiler and a folder of settings.
fn run(desk: &Desk, out: &str, options: &[&str], compiler: &str, home: &Path) -> Answer {
    let words = [&["run", "m.ron", "--no-plot", "--out", out], options].concat();
    Answer::from(desk.command(&words).env("CC", compiler).env("BLOCKSIM_HOME", home).output().unwrap())
}

#[test]
fn machine_code_gives_the_same_file_and_is_kept_until_it_is_damaged() {
    let desk = Desk::with(&[("m.ron", MODEL)]);
    let home = desk.0.join("home");
    assert_eq!(run(&desk, "plain", &[], "cc", &home).code, Some(0));
    let plain = desk.read("plain/signals.csv");
    let native = |out: &str, is_compiled: bool| {
        let answer = run(&desk, out, &["--native"], "cc", &home);
        assert_eq!(answer.code, Some(0), "{}", answer.text());
        assert!(!answer.err.contains("warning"), "{}", answer.err);
        assert_eq!(answer.err.contains("instructions to machine code in"), is_compiled, "{}", answer.err);
        assert_eq!(desk.read(&format!("{out}/signals.csv")), plain);
    };
    native("first", true);
    native("second", false);
    for (ending, damage) in [("so", "no library"), ("stamp", ""), ("c", "int other;")] {
        let mut files = fs::read_dir(home.join("native")).unwrap().map(|entry| entry.unwrap().path());
        let file = files.find(|file| file.extension().is_some_and(|found| found == ending)).unwrap();
        fs::write(file, damage).unwrap();
        native(&format!("{ending}_damaged"), true);
        native(&format!("{ending}_anew"), false);
    }
    // Nothing but the three files is left of all that.
    assert_eq!(desk.names("home/native").len(), 3);
}

#[test]
fn without_machine_code_the_interpreter_runs_and_the_reason_is_told() {
    let desk = Desk::with(&[("m.ron", MODEL), ("file", "")]);
    let home = desk.0.join("home");
    assert_eq!(run(&desk, "plain", &[], "cc", &home).code, Some(0));
    let plain = desk.read("plain/signals.csv");
    let told = |out: &str, compiler: &str, home: &Path, expected: &str| {
        let answer = run(&desk, out, &["--native"], compiler, home);
        assert_eq!(answer.code, Some(0), "{}", answer.text());
        assert!(answer.err.contains(expected), "{}", answer.err);
        assert_eq!(desk.read(&format!("{out}/signals.csv")), plain);
    };
    told(
        "none",
        "no_such_compiler",
        &home,
        "warning: machine code needs a C compiler, and `no_such_compiler`",
    );
    told(
        "fails",
        "false",
        &home,
        "warning: `false` does not compile the model to machine code: exit status: 1",
    );
    // It says that all is well and writes nothing.
    told("silent", "true", &home, "warning: machine code cannot be loaded: ");
    told("unkept", "cc", &desk.0.join("file"), "warning: the machine code is not kept for the next run: `");
    let answer = run(&desk, "quiet", &["--native", "--quiet"], "cc", &home);
    assert_eq!(answer.err, "");
}

#[test]
fn a_model_of_which_nothing_is_data_says_so() {
    let text = r#"Diagram(
        simulation: (stop_time: "1 s"),
        blocks: { "d": Delay(steps: 100, ts: "0.1 s"), "s": Scope(inputs: ["d"]) },
        connections: ["d.y -> d.u, s.d"],
    )"#;
    let desk = Desk::with(&[("m.ron", text)]);
    let answer = run(&desk, "out", &["--native"], "cc", &desk.0.join("home"));
    assert_eq!(answer.code, Some(0), "{}", answer.text());
    assert!(answer.err.contains("warning: --native makes nothing faster here"), "{}", answer.err);
}
