//! `run --verify`: how far a run is from a more exact one.

use serde_json::Value;

use crate::desk::Desk;

/// x'' = -x over 50 turns; Heun's method with steps of 0.1 s adds 1.3e-4 of the swing in each.
const SWING: &str = r#"Diagram(
    simulation: (stop_time: "314 s"),
    blocks: {
        "x": Integrator(x0: 1.0),
        "v": Integrator,
        "back": Gain(k: -1),
        "s": Scope(inputs: ["x"]),
    },
    connections: ["v.y -> x.u", "x.y -> back.u, s.x", "back.y -> v.u"],
)
"#;

#[test]
fn a_run_that_is_exact_is_said_to_be() {
    let desk = Desk::with(&[("swing.ron", SWING)]);
    let answer = desk.call(&["run", "swing.ron", "--quiet", "--verify", "--out", "kept"]);
    assert_eq!(answer.code, Some(0), "{answer:?}");
    assert!(answer.err.starts_with("note: verified by a run at rtol 1e-8 at 1002 times"), "{}", answer.err);
}

#[test]
fn a_run_that_is_off_names_signals_times_and_what_to_do() {
    let desk = Desk::with(&[("swing.ron", SWING)]);
    let coarse = ["run", "swing.ron", "--solver", "ode2", "--step", "100ms", "--verify", "--out"];
    let answer = desk.call(&[&coarse[..], &["kept", "--quiet"]].concat());
    assert_eq!(answer.code, Some(1), "{answer:?}");
    let lines: Vec<&str> = answer.err.lines().collect();
    let [first, signal, help] = lines[..] else { panic!("{}", answer.err) };
    assert_eq!(
        first,
        "error: a run with steps of 0.05 s differs by more than 0.10 % of the range of a signal"
    );
    assert!(
        signal.starts_with("  = note: `s.x` by ") && signal.contains(" of its range, at t = "),
        "{signal}"
    );
    assert!(help.starts_with("  = help: run it with `--step 0.05`"), "{help}");
    // The results are there all the same.
    assert!(desk.0.join("kept/signals.csv").exists());

    let answer = desk.call(&[&coarse[..], &["data", "--json"]].concat());
    let data: Vec<Value> = answer.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let verified = data.iter().find(|line| line["type"] == "verified").unwrap();
    assert_eq!(
        (&verified["against"]["step"], &verified["events"]),
        (&Value::from(0.05), &Value::from([0, 0]))
    );
    let worst = &verified["differences"][0];
    assert_eq!(worst["signal"], "s.x");
    // The phase falls behind by h^2 / 6 of the time: by 0.52 rad, with half the step by 0.13 rad. That is 0.39 of the amplitude, and half
    // of that of the range, which has grown by 4 %.
    let share = worst["share"].as_f64().unwrap();
    assert!((0.18..0.20).contains(&share), "{share}");
    assert_eq!(data.last().unwrap()["type"], "done");
}
