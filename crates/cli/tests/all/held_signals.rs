//! Numbers and pictures of sampled signals: what is held between samples is no ramp.

use serde_json::Value;

use crate::desk::Desk;

/// A ramp of 0.5 1/s, held every 0.5 s: 0, 1/4, 1/2, 3/4 for half a second each. `left` is what a ramp has beyond that.
const HELD: &str = r#"Diagram(
    simulation: (stop_time: "2 s"),
    blocks: {
        "ramp": Ramp(slope: "0.5 1/s"),
        "hold": ZeroOrderHold(ts: "0.5 s"),
        "one": Constant(value: 1.0),
        "left": Sum(signs: "+-"),
        "held": Scope(inputs: ["set", "actual"]),
        "mixed": Scope(inputs: ["set", "actual"]),
    },
    connections: [
        "ramp.y -> hold.u, left.u1",
        "hold.y -> held.actual, left.u2",
        "left.y -> mixed.actual",
        "one.y -> held.set, mixed.set",
    ],
)
"#;

/// IAE of 1 less what is held: (1 + 3/4 + 1/2 + 1/4) / 2.
const OF_HELD: f64 = 1.25;
/// IAE of 1 less the ramp plus what is held: 2 less four triangles of 1/4 by 1/2.
const OF_MIXED: f64 = 2.0 - 4.0 * 0.25 * 0.5 / 2.0;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
}

fn run(desk: &Desk, more: &[&str]) {
    let answer = desk.call(&[&["run", "held.ron", "--quiet", "--out", "kept"], more].concat());
    assert_eq!(answer.code, Some(0), "{answer:?}");
}

#[test]
fn integrals_of_held_signals_are_those_of_stairs() {
    let desk = Desk::with(&[("held.ron", HELD)]);
    run(&desk, &[]);
    let data = desk.call(&["plot", "kept", "--json"]);
    let data: Value = serde_json::from_str(&data.out).unwrap();
    let iae = |signal: &str| {
        let rows = data["tracking"].as_array().unwrap();
        number(&rows.iter().find(|row| row["signal"] == signal).unwrap()["iae"])
    };
    near(iae("held.actual"), OF_HELD);
    near(iae("mixed.actual"), OF_MIXED);
    let swept =
        desk.call(&["sweep", "held.ron", "--over", "one.value=1", "--metric=iae,mean:held.actual", "--json"]);
    let swept: Value = serde_json::from_str(&swept.out).unwrap_or_else(|_| panic!("{swept:?}"));
    let values: Vec<f64> =
        swept["runs"][0]["metrics"].as_array().unwrap().iter().map(|m| number(&m["value"])).collect();
    near(values[0], OF_HELD);
    near(values[1], OF_MIXED);
    near(values[2], 0.375);
}

#[test]
fn tables_have_stairs_and_agree_with_the_run() {
    let desk = Desk::with(&[("held.ron", HELD)]);
    run(&desk, &[]);
    let csv = desk.read("kept/signals.csv");
    let rows: Vec<Vec<f64>> =
        csv.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    let names: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let column = names.iter().position(|name| name.starts_with("held.actual")).unwrap();
    // Straight from row to row the area is that of the stairs.
    let area: f64 = rows.windows(2).map(|w| (w[1][0] - w[0][0]) * (w[0][column] + w[1][column]) / 2.0).sum();
    near(area, 0.75);
    let grid =
        desk.call(&["export", "kept", "--csv", "grid.csv", "--every", "0.2s", "--signals", "held.actual"]);
    assert_eq!(grid.code, Some(0), "{grid:?}");
    let values: Vec<f64> = desk
        .read("grid.csv")
        .lines()
        .skip(1)
        .map(|line| line.split_once(',').unwrap().1.parse().unwrap())
        .collect();
    assert_eq!(values, [0.0, 0.0, 0.0, 0.25, 0.25, 0.5, 0.5, 0.5, 0.75, 0.75, 1.0]);
    let same = desk.call(&["compare", "kept", "kept/signals.csv"]);
    assert!(same.code == Some(0) && same.err.is_empty(), "{same:?}");
}

#[test]
fn stairs_are_drawn_as_stairs() {
    let desk = Desk::with(&[("held.ron", HELD)]);
    run(&desk, &[]);
    let answer = desk.call(&["plot", "kept", "held.actual", "--svg", "held.svg"]);
    assert_eq!(answer.code, Some(0), "{answer:?}");
    let drawing = desk.read("held.svg");
    let line = drawing
        .lines()
        .find(|line| line.contains("<path d=\"M") && line.contains('L') && line.contains("\"round\""));
    let points: Vec<(f64, f64)> = line
        .and_then(|line| line.split('"').nth(1))
        .unwrap()
        .split(['M', 'L'])
        .filter(|point| !point.is_empty())
        .map(|point| {
            let (x, y) = point.split_once(' ').unwrap();
            (x.parse().unwrap(), y.parse().unwrap())
        })
        .collect();
    // Across or upright, never aslant.
    let aslant = |w: &[(f64, f64)]| w[0].0 != w[1].0 && w[0].1 != w[1].1;
    assert!(points.len() >= 8 && !points.windows(2).any(aslant), "{points:?}");
}

/// A truth value that is true for 39 of 100 steps has the mean 0.39 and its root as the root mean square, which no ramp has.
#[test]
fn truth_values_are_held_with_a_fixed_step() {
    const TRUTH: &str = r#"Diagram(
        simulation: (stop_time: "1 s", solver: Ode4(step: "10 ms")),
        blocks: {
            "wave": Sine(amplitude: 1, frequency: 1), "is": Compare(operator: Greater, constant: 0.31),
            "x": Integrator, "s": Scope(inputs: ["y"]), "states": Scope(inputs: ["x"]),
        },
        connections: ["wave.y -> is.u, x.u", "is.y -> s.y", "x.y -> states.x"],
    )"#;
    let desk = Desk::with(&[("truth.ron", TRUTH)]);
    let swept = desk.call(&[
        "sweep",
        "truth.ron",
        "--over",
        "wave.amplitude=1",
        "--metric=mean:s.y,rms:s.y",
        "--json",
    ]);
    let swept: Value = serde_json::from_str(&swept.out).unwrap_or_else(|_| panic!("{swept:?}"));
    let values: Vec<f64> =
        swept["runs"][0]["metrics"].as_array().unwrap().iter().map(|m| number(&m["value"])).collect();
    near(values[0], 0.39);
    near(values[1], 0.39_f64.sqrt());
}
