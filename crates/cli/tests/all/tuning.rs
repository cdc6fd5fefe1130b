//! `run --change` as users call it.

use std::io::{BufRead, BufReader, Write};
use std::process::Stdio;
use std::time::Duration;

use serde_json::{Value, json};

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
    assert!(untouched.err.contains("at 3 s, after the end of the run at 2 s"), "{}", untouched.err);
    assert!((last(&desk, "plain") - (-2.0_f64).exp()).abs() < 1e-8, "a change after the end has no effect");
    let untouched = desk.call(&["run", "decay.ron", "--quiet", "--out", "end", "--change", "2s:k.k=5"]);
    assert!(untouched.err.contains("at 2 s, at the end of the run at 2 s"), "{}", untouched.err);
}

/// A step at 0.8 s or 0.3 s comes out when the delay that holds then says so, even where that is at once or a second time.
#[test]
fn a_delay_changes_with_what_has_come_out_of_it() {
    let text = |time: &str| {
        format!(
            r#"Diagram(
                simulation: (stop_time: "3 s"),
                blocks: {{ "u": Step(time: "{time}"), "b": TransportDelay(delay: "0.5 s"), "i": Integrator, "s": Scope(inputs: ["y"]) }},
                connections: ["u.y -> b.u", "b.y -> i.u", "i.y -> s.y"],
            )"#
        )
    };
    let desk = Desk::with(&[("late.ron", &text("0.8 s")), ("early.ron", &text("0.3 s"))]);
    for (file, delay, integral) in
        [("late", "0.1", 2.0), ("late", "0.25", 1.95), ("late", "1.5", 0.7), ("early", "1.5", 0.2 + 1.2)]
    {
        let run = format!("{file}{delay}");
        let change = format!("1s:b.delay={delay} s");
        let answer =
            desk.call(&["run", &format!("{file}.ron"), "--quiet", "--out", &run, "--change", &change]);
        assert_eq!(answer.code, Some(0), "{run}: {}", answer.err);
        let found = last(&desk, &run);
        assert!((found - integral).abs() < 1e-9, "{run}: {found} and {integral}");
    }
}

#[test]
fn what_cannot_change_is_refused_with_the_reason_before_the_run_or_ends_it_and_keeps_what_there_is() {
    let four_bar = include_str!("../../../../diagrams/four_bar.ron");
    let desk = Desk::with(&[("decay.ron", DECAY), ("four_bar.ron", four_bar)]);
    for (change, told) in [
        ("1s:k.q=2", "`k.q=2` cannot be set at 1 s"),
        ("1s:k.k=2 kg", "`k.k=2 kg` cannot be set at 1 s"),
        ("1s:simulation.stop_time=nothing", "cannot be set at 1 s"),
    ] {
        let answer = desk.call(&["run", "decay.ron", "--change", change, "--no-plot"]);
        assert_eq!(answer.code, Some(1), "{}", answer.err);
        assert!(answer.err.contains(told) && answer.err.contains("error[tuning]"), "{}", answer.err);
        assert!(answer.err.contains("nothing was run") && !desk.0.join("runs").exists(), "{}", answer.err);
    }
    // Where the bodies are then is not known before.
    let longer = "0.1s:coupler_length=0.46";
    let answer = desk.call(&["run", "four_bar.ron", "--change", longer, "--no-plot", "--out", "open"]);
    assert_eq!(answer.code, Some(1), "{}", answer.err);
    assert!(answer.err.contains("a closed loop would be open by 0.01 (m or rad)"), "{}", answer.err);
    let rows = desk.read("open/signals.csv");
    assert!(rows.lines().last().is_some_and(|row| row.starts_with("0.1,")), "{rows}");
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

#[test]
fn a_change_after_a_time_waits_for_the_end_of_its_step() {
    let desk = Desk::with(&[("decay.ron", DECAY)]);
    let times = |folder: &str| -> Vec<f64> {
        let table = desk.read(&format!("{folder}/signals.csv"));
        table.lines().skip(1).filter_map(|line| line.split(',').next()?.parse().ok()).collect()
    };
    let plain = desk.call(&["run", "decay.ron", "--quiet", "--out", "plain"]);
    assert_eq!(plain.code, Some(0), "{}", plain.err);
    let after =
        desk.call(&["run", "decay.ron", "--quiet", "--out", "after", "--change", "after 0.7 s:k.k=-3"]);
    assert_eq!(after.code, Some(0), "{}", after.err);
    let events = desk.read("after/events.csv");
    let at: f64 =
        events.lines().nth(1).and_then(|line| line.split(',').next()?.parse().ok()).expect("an event");
    // A step of the untouched run ends there, and all before it are the same.
    let (untouched, changed) = (times("plain"), times("after"));
    let first = untouched.iter().find(|t| **t >= 0.7).expect("a row");
    assert_eq!(at, *first);
    let before = |all: &[f64]| all.iter().copied().filter(|t| *t < at).collect::<Vec<_>>();
    assert_eq!(before(&untouched), before(&changed));
    // Several at one time come in their order.
    let twice = desk.call(&[
        "run",
        "decay.ron",
        "--quiet",
        "--out",
        "twice",
        "--change",
        "after 0.7s:k.k=-9",
        "--change",
        "after 0.7s:k.k=-3",
    ]);
    assert_eq!(twice.code, Some(0), "{}", twice.err);
    let end = |folder: &str| desk.read(&format!("{folder}/signals.csv")).lines().last().map(str::to_owned);
    assert_eq!(end("twice"), end("after"));
    for wrong in ["after :k.k=1", "after -1s:k.k=1", "afterwards 1s:k.k=1"] {
        assert_eq!(desk.call(&["run", "decay.ron", "--change", wrong]).code, Some(2), "{wrong}");
    }
}

#[test]
fn further_signals_are_recorded_as_if_the_diagram_said_so() {
    let desk = Desk::with(&[("decay.ron", DECAY)]);
    let asked = desk.call(&["run", "decay.ron", "--quiet", "--out", "asked", "--record", "k.*"]);
    assert_eq!(asked.code, Some(0), "{}", asked.err);
    let written = DECAY.replacen("Diagram(", "Diagram(record: [\"k.*\"], ", 1);
    std::fs::write(desk.0.join("written.ron"), written).expect("a file");
    let said = desk.call(&["run", "written.ron", "--quiet", "--out", "said"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let [one, other] = ["asked", "said"].map(|folder| desk.read(&format!("{folder}/signals.csv")));
    assert!(one == other && one.lines().next().is_some_and(|head| head.contains("k.y")));
    // Parameters can change all the same.
    let tuned = desk.call(&[
        "run",
        "decay.ron",
        "--quiet",
        "--out",
        "tuned",
        "--record",
        "k.y",
        "--change",
        "1s:k.k=-3",
    ]);
    assert_eq!(tuned.code, Some(0), "{}", tuned.err);
    let wrong = desk.call(&["run", "decay.ron", "--record", "q.y"]);
    assert_eq!(wrong.code, Some(3), "{}", wrong.err);
    assert!(wrong.err.contains("no signal matches `q.y`") && wrong.err.contains("--record"), "{}", wrong.err);
}

#[test]
fn check_tries_how_far_a_panel_can_go() {
    let text = r#"Diagram(
    parameters: { "idle": 1 },
    simulation: (stop_time: "1 s"),
    panel: [Slider("lag.tau", "0 .. 2 s"), Slider("k.k", "-9 .. 9"), Slider("hold.ts", "1 .. 5 ms"), Switch("k.k", 0, -1)],
    blocks: { "k": Gain(k: -1), "lag": LowPass(tau: "1 s"), "hold": ZeroOrderHold(ts: "2 ms"), "s": Scope(inputs: ["x"]) },
    connections: ["k.y -> lag.u", "lag.y -> k.u, hold.u", "hold.y -> s.x"],
)
"#;
    let desk = Desk::with(&[("model.ron", text)]);
    let answer = desk.call(&["check", "model.ron"]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    let told = answer.err;
    // What nothing reads is no reason.
    assert!(told.contains("nothing reads the parameter `idle`"), "{told}");
    assert!(told.contains("warning[panel]: the Slider cannot set `lag.tau=0 s`: `tau`"), "{told}");
    for value in ["1", "5"] {
        assert!(
            told.contains(&format!("the Slider cannot set `hold.ts={value} ms`: it makes another model")),
            "{told}"
        );
    }
    assert_eq!(told.matches("warning[panel]").count(), 3, "{told}");
}

#[test]
fn a_run_goes_back_behind_what_was_set_where_a_snapshot_was_taken() {
    let desk = Desk::with(&[("decay.ron", &DECAY.replace("\"2 s\"", "\"100 s\""))]);
    let mut command = desk.command(&["run", "decay.ron", "--json", "--live", "1", "--out", "run"]);
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("a run");
    let mut to = child.stdin.take().expect("a pipe");
    let mut tell = |what: Value| writeln!(to, "{what}").expect("it listens");
    let lines = BufReader::new(child.stdout.take().expect("a pipe")).lines();
    let mut events = lines.map(|line| serde_json::from_str::<Value>(&line.expect("a line")).expect("JSON"));
    let mut until = |kind: &str| {
        let found = events.find(|event| {
            assert!(event["severity"] != "error", "{event}");
            event["type"] == kind
        });
        found.unwrap_or_else(|| panic!("no {kind}"))
    };
    until("rows");
    tell(json!({ "do": "pause" }));
    // Somebody thinks for a while: as the next step ends a snapshot is due, and the value is set there.
    std::thread::sleep(Duration::from_millis(500));
    tell(json!({ "do": "set", "set": "k.k=-2 1/s" }));
    let set = until("tuned")["t"].as_f64().expect("a time");
    tell(json!({ "do": "speed", "speed": 0 }));
    tell(json!({ "do": "go" }));
    assert_eq!(until("done")["ended"], "complete");
    tell(json!({ "do": "back", "t": set + 0.05 }));
    let back = until("back");
    assert!(back["refused"].is_null() && back["set"] == json!(["k.k=-2 1/s"]), "{back}");
    tell(json!({ "do": "go" }));
    assert_eq!(until("done")["ended"], "complete");
    drop(to);
    assert_eq!(child.wait().expect("an end").code(), Some(0));
    // Nothing else was set: both futures are one.
    let runs: Vec<String> = desk.names(".").into_iter().filter(|name| name.starts_with("run")).collect();
    let [one, other] = &runs[..] else { panic!("{runs:?}") };
    assert!(desk.read(&format!("{one}/signals.csv")) == desk.read(&format!("{other}/signals.csv")));
}
