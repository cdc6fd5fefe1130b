//! `run --change` as users call it.

use crate::desk::Desk;

const DECAY: &str = r#"Diagram(
    simulation: (stop_time: "2 s", solver: Ode4(step: "10 ms")),
    blocks: { "k": Gain(k: "-1 1/s"), "x": Integrator(x0: 1), "s": Scope(inputs: ["x"]) },
    connections: ["x.y -> k.u, s.x", "k.y -> x.u"],
)
"#;

/// The last value of the first signal of a run.
fn last(desk: &Desk, run: &str) -> f64 {
    let signals = desk.read(&format!("{run}/signals.csv"));
    let line = signals.lines().last().expect("a row");
    line.split(',').nth(1).and_then(|value| value.parse().ok()).expect("a number")
}

#[test]
fn parameters_change_at_their_times_and_are_events() {
    let desk = Desk::with(&[("decay.ron", DECAY)]);
    let call = [
        "run",
        "decay.ron",
        "--quiet",
        "--out",
        "run",
        "--change",
        "1.5s:k.k=-2 1/s",
        "--change",
        "1 s: k.k = -3",
    ];
    let answer = desk.call(&call);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    let expected = (-1.0_f64 - 0.5 * 3.0 - 0.5 * 2.0).exp();
    assert!((last(&desk, "run") - expected).abs() < 1e-8, "{} and {expected}", last(&desk, "run"));
    let events = desk.read("run/events.csv");
    // A bare number has the unit of the one that it replaces.
    assert_eq!(
        events.lines().skip(1).collect::<Vec<_>>(),
        ["1,k.k,is set to -3", "1.5,k.k,is set to -2 1/s"]
    );
    let start = desk.call(&["run", "decay.ron", "--quiet", "--out", "start", "--change", "1s:x.x0=7"]);
    assert_eq!(start.code, Some(0), "{}", start.err);
    assert!(
        desk.read("start/events.csv")
            .contains("is set to 7 (values at the start of x have no effect any more)")
    );
    let untouched = desk.call(&["run", "decay.ron", "--quiet", "--out", "plain", "--change", "3s:k.k=5"]);
    assert_eq!(untouched.code, Some(0));
    assert!((last(&desk, "plain") - (-2.0_f64).exp()).abs() < 1e-8, "a change after the end has no effect");
}

#[test]
fn what_cannot_change_ends_the_run_with_the_reason_and_keeps_what_there_is() {
    let desk = Desk::with(&[("decay.ron", DECAY)]);
    for (change, told) in [
        ("1s:k.q=2", "`k.q=2` cannot be set at 1 s"),
        ("1s:k.k=2 kg", "`k.k=2 kg` cannot be set at 1 s"),
        ("1s:simulation.stop_time=nothing", "cannot be set at 1 s"),
    ] {
        let answer = desk.call(&["run", "decay.ron", "--change", change, "--no-plot"]);
        assert_eq!(answer.code, Some(1), "{}", answer.err);
        assert!(answer.err.contains(told) && answer.err.contains("error[tuning]"), "{}", answer.err);
    }
    let runs = desk.names("runs");
    assert_eq!(runs.len(), 3);
    assert!((last(&desk, &format!("runs/{}", runs[0])) - (-1.0_f64).exp()).abs() < 0.05, "up to about there");
    // Both would judge a run without the changes.
    for other in ["--audit", "--verify"] {
        let answer = desk.call(&["run", "decay.ron", "--change", "1s:k.k=-2", other]);
        assert_eq!(answer.code, Some(2), "{other}: {}", answer.err);
    }
    for wrong in ["k.k=2", "soon:k.k=2", "-1s:k.k=2", "1s:k.k"] {
        let answer = desk.call(&["run", "decay.ron", "--change", wrong]);
        assert_eq!(answer.code, Some(2), "{wrong}: {}", answer.err);
    }
}
