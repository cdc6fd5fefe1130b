//! Runs that begin in a steady state, as users call them.

use serde_json::Value;

use crate::desk::Desk;

/// A tank whose level is to be 2.25: 0.2 sqrt(2.25) = 0.3 flows in.
const TANK: &str = r#"Diagram(
    title: "Tank",
    parameters: { "half": 1.125 },
    simulation: (stop_time: "1 s", start: Steady(hold: {"level.y": "2 s * half"}, free: ["inflow.value"])),
    blocks: {
        "inflow": Constant(value: 1.0),
        "net": Sum(signs: "+-"),
        "level": Integrator(x0: "1 s"),
        "per_second": Gain(k: "1 1/s"),
        "root": Function(function: Sqrt),
        "valve": Gain(k: 0.2),
        "show": Scope(inputs: ["level"]),
    },
    connections: [
        "inflow.y -> net.u1",
        "net.y -> level.u",
        "level.y -> per_second.u, show.level",
        "per_second.y -> root.u",
        "root.y -> valve.u",
        "valve.y -> net.u2",
    ],
)
"#;

/// All numbers in data.
fn numbers(data: &Value, into: &mut Vec<f64>) {
    match data {
        Value::Array(items) => items.iter().for_each(|item| numbers(item, into)),
        Value::Object(members) => {
            members.iter().filter(|(name, _)| *name != "parameters").for_each(|(_, item)| numbers(item, into))
        }
        other => into.extend(other.as_f64()),
    }
}

#[test]
fn a_trim_is_told_by_run_sweep_and_emit_and_heeds_set() {
    let desk = Desk::with(&[("tank.ron", TANK)]);
    let answer = desk.call(&["run", "tank.ron", "--no-plot"]);
    assert_eq!(answer.code, Some(0), "{answer:?}");
    assert!(answer.out.contains("start      in a steady state; `inflow.value` = 0.3\n"), "{}", answer.out);
    let data = desk.call(&["run", "tank.ron", "--json", "--set", "half=4.5"]);
    let last = data.out.lines().last().expect("a line");
    let done: Value = serde_json::from_str(last).unwrap_or_else(|_| panic!("{data:?}"));
    let found = &done["steady_start"]["found"][0];
    assert_eq!(found["name"], "inflow.value");
    assert!((found["value"].as_f64().unwrap() - 0.6).abs() < 1e-9, "{found}");
    let swept = desk.call(&["sweep", "tank.ron", "--over", "half=1,4", "--metric=mean:show.level", "--json"]);
    let swept: Value = serde_json::from_str(&swept.out).unwrap_or_else(|_| panic!("{swept:?}"));
    // Each begins, and stays, at its own level.
    let mut means = Vec::new();
    numbers(&swept, &mut means);
    assert!([2.0, 8.0].iter().all(|level| means.iter().any(|mean| (mean - level).abs() < 1e-9)), "{swept}");
    let schedule = desk.call(&["emit", "schedule", "tank.ron"]);
    assert!(
        schedule.out.contains("steady start, `level.y` held at 2.25, `inflow.value` free"),
        "{schedule:?}"
    );
}

#[test]
fn without_a_steady_state_nothing_is_run_and_the_block_is_shown() {
    let broken =
        TANK.replace("Gain(k: 0.2)", "Gain(k: 0.0)").replace("Steady(hold", "Steady(drift: [], hold");
    let broken = broken.replace("free: [\"inflow.value\"]", "free: []");
    let desk = Desk::with(&[("tank.ron", &broken)]);
    let answer = desk.call(&["run", "tank.ron", "--no-plot"]);
    assert_eq!(answer.code, Some(1), "{answer:?}");
    for part in [
        "error[no_steady_state]: no steady state was found; what keeps moving: `level.x` by 1 a second",
        "this is `level`",
        "compare `hold` and `free`",
        "nothing was run",
    ] {
        assert!(answer.err.contains(part), "{part} in {}", answer.err);
    }
}
