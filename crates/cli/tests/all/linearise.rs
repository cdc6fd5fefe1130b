//! `blocksim linearise` as users call it.

use std::path::{Path, PathBuf};
use std::process::Output;

use crate::support::{arguments, commands_of, program, root};
use serde_json::Value;

/// A loop of a gain and three equal lags with a time constant of 1 s, L = gain / (s + 1)^3, behind a limit of 10; a sampled
/// copy of its output, which nobody reads but a scope; a vector and a flag.
const LAGS: &str = r#"Diagram(
    title: "Lags",
    parameters: { "gain": 2.0, "after": 0.5 },
    simulation: (stop_time: "20 s", solver: Ode45(rtol: 1e-9), output: Every("0.1 s")),
    blocks: {
        "demand": Step(time: "1 s", after: "after"),
        "error": Sum(signs: "+-"),
        "gain": Gain(k: "gain"),
        "limit": Saturation(lower: -10, upper: 10),
        "a": LowPass(tau: "1 s"), "b": LowPass(tau: "1 s"), "c": LowPass(tau: "1 s"),
        "hold": ZeroOrderHold(ts: "0.1 s"),
        "slow": LowPass(tau: "5 s"),
        "both": Mux(inputs: 2),
        "late": Compare(operator: Greater, constant: 0.3),
        "scope": Scope(inputs: ["set", "actual", "held", "both"]),
        "flag": Scope(inputs: ["late"]),
    },
    connections: [
        "demand.y -> error.u1, scope.set",
        "error.y -> gain.u",
        "gain.y -> limit.u",
        "limit.y -> a.u",
        "a.y -> b.u",
        "b.y -> c.u, both.u1",
        "c.y -> error.u2, hold.u, both.u2, late.u, scope.actual",
        "hold.y -> slow.u",
        "slow.y -> scope.held",
        "both.y -> scope.both",
        "late.y -> flag.late",
    ],
)
"#;

/// A folder with a model that is removed at the end.
pub struct Desk(pub PathBuf);

impl Desk {
    pub fn new(name: &str) -> Desk {
        let path = std::env::temp_dir().join(format!("blocksim-linearise-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        std::fs::write(path.join("lags.ron"), LAGS).expect("a model");
        Desk(path)
    }

    pub fn linearise(&self, words: &[&str]) -> Output {
        linearise(&self.0, words)
    }

    pub fn json(&self, words: &[&str]) -> Value {
        json(&self.linearise(&[words, &["--json"]].concat()))
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

pub fn linearise(folder: &Path, words: &[&str]) -> Output {
    let mut command = program();
    command.current_dir(folder).env("NO_COLOR", "1").env_remove("COLUMNS").arg("linearise").args(words);
    command.output().expect("the program runs")
}

pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

pub fn json(output: &Output) -> Value {
    assert_eq!(output.status.code(), Some(0), "{}", said(output));
    serde_json::from_slice(&output.stdout).expect("data")
}

pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

pub fn near(value: &Value, expected: f64) {
    let value = number(value);
    assert!((value - expected).abs() <= 1e-6 * expected.abs().max(1e-3), "{value} is not {expected}");
}

#[test]
fn the_margins_of_three_lags_are_those_of_the_formula_wherever_the_loop_is_cut() {
    let desk = Desk::new("margins");
    for cut in ["gain.y", "limit.y", "error.y", "b.y", "scope.actual"] {
        let found = desk.json(&["lags.ron", "--open", cut]);
        let way = &found["ways"][0];
        assert_eq!(way["order"], 3, "{cut}");
        let margins = &way["margins"];
        // The phase is -180 deg at sqrt 3, where the gain is 2 / 8.
        near(&margins["gain"][0]["value"], 4.0);
        near(&margins["gain"][0]["frequency"], 3.0_f64.sqrt());
        let crossover = (4.0_f64.cbrt() - 1.0).sqrt();
        near(&margins["phase"][0]["frequency"], crossover);
        near(&margins["phase"][0]["value"], std::f64::consts::PI - 3.0 * crossover.atan());
        assert_eq!(margins["stable"], true);
        near(&way["static_gain"], 2.0);
    }
    let fast = desk.json(&["lags.ron", "--set", "gain=8.1", "--open", "gain.y"]);
    assert_eq!(fast["ways"][0]["margins"]["stable"], false);
}

#[test]
fn a_closed_loop_has_the_poles_of_its_polynomial_and_a_cut_one_those_of_its_parts() {
    let desk = Desk::new("poles");
    let found = desk.json(&["lags.ron", "--from", "demand.y", "--to", "c.y,error.y"]);
    near(&found["ways"][0]["static_gain"], 2.0 / 3.0);
    near(&found["ways"][1]["static_gain"], 1.0 / 3.0);
    // (s + 1)^3 = -2: s = -1 + cbrt 2 times the third roots of -1.
    let root = 2.0_f64.cbrt();
    let poles = found["ways"][0]["poles"].as_array().expect("poles");
    let has = |re: f64, im: f64| {
        poles.iter().any(|p| (number(&p["pole"][0]) - re).hypot(number(&p["pole"][1]) - im) < 1e-6)
    };
    assert!(has(-1.0 - root, 0.0) && has(root / 2.0 - 1.0, root * 0.75_f64.sqrt()), "{poles:?}");
    let cut = desk.json(&["lags.ron", "--from", "demand.y", "--to", "c.y", "--open", "scope.actual"]);
    near(&cut["ways"][0]["static_gain"], 2.0);
    near(&cut["ways"][0]["bandwidth"], (2.0_f64.cbrt() - 1.0).sqrt());
    // A change at a signal that is measured there: the sensitivity.
    let sensitivity = desk.json(&["lags.ron", "--from", "gain.y", "--to", "gain.y"]);
    near(&sensitivity["ways"][0]["static_gain"], 1.0 / 3.0);
    let alias = program()
        .current_dir(&desk.0)
        .args(["linearize", "lags.ron", "--open", "gain.y", "--no-plot"])
        .output()
        .expect("the program runs");
    assert_eq!(alias.status.code(), Some(0));
}

#[test]
fn a_dc_motor_has_its_known_transfer_functions() {
    let words =
        ["diagrams/dc_motor_start.ron", "--from", "switch.y", "--to", "encoder.w,ammeter.i", "--json"];
    let found = json(&linearise(&root(), &words));
    let (r, l, k, j) = (1.5_f64, 2.5e-3_f64, 0.22_f64, 5e-5_f64);
    near(&found["ways"][0]["static_gain"], 1.0 / k);
    near(&found["ways"][1]["static_gain"], 0.0);
    near(&found["ways"][1]["zeros"][0][0], 0.0);
    assert_eq!(found["ways"][0]["zeros"].as_array().map(Vec::len), Some(0));
    // L J s^2 + R J s + k^2.
    let pole = &found["ways"][0]["poles"][0];
    near(&pole["frequency"], k / (l * j).sqrt());
    near(&pole["damping"], r / 2.0 / k * (j / l).sqrt());
}

#[test]
fn a_pendulum_is_found_at_rest_with_its_frequency() {
    let words = [
        "diagrams/pendulum.ron",
        "--from",
        "pivot.q",
        "--to",
        "pivot.w",
        "--at",
        "0.1s",
        "--steady",
        "--json",
    ];
    let found = json(&linearise(&root(), &words));
    let poles = found["poles"].as_array().expect("poles");
    // A rod of length 1 m about its end: (3 g / 2)^1/2. Upwards it would not swing but fall.
    let w = (1.5_f64 * 9.80665).sqrt();
    assert_eq!(poles.len(), 2);
    near(&poles[0]["frequency"], w);
    let q = number(&found["states"][0]["value"]);
    let falls = number(&poles[0]["pole"][0]).abs() > 1.0;
    assert_eq!(falls, q.cos() < 0.0, "{found}");
    assert!(q.sin().abs() < 1e-6);

    let words =
        ["diagrams/dc_motor_start.ron", "--from", "switch.y", "--to", "encoder.w", "--at", "2ms", "--steady"];
    let found = json(&linearise(&root(), &[&words[..], &["--json"]].concat()));
    near(&found["to"][0]["value"], 24.0 / 0.22);
}

#[test]
fn what_keeps_moving_is_named_where_there_is_no_rest() {
    let desk = Desk::new("restless");
    let ramp = r#"Diagram(
        simulation: (stop_time: "1 s"),
        blocks: { "one": Constant(value: 1.0), "sum": Integrator, "lag": LowPass(tau: 1.0), "scope": Scope(inputs: ["y"]) },
        connections: ["one.y -> sum.u", "sum.y -> lag.u, scope.y"],
    )"#;
    std::fs::write(desk.0.join("ramp.ron"), ramp).expect("a model");
    let output = desk.linearise(&["ramp.ron", "--from", "one.y", "--to", "sum.y", "--steady"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("what keeps moving: `sum.x` by 1 a second"), "{}", said(&output));
}

#[test]
fn limits_and_samples_are_told_where_nothing_comes_through() {
    let desk = Desk::new("held");
    let held = desk.linearise(&["lags.ron", "--from", "c.y", "--to", "slow.y", "--no-plot"]);
    let text = String::from_utf8_lossy(&held.stdout).into_owned();
    assert!(
        text.contains("so that no change passes (--sampled takes the samples as they are): `hold` (0.1 s)"),
        "{text}"
    );
    assert!(text.contains("begin or end at its output"), "{text}");
    let from_there = desk.json(&["lags.ron", "--from", "hold.y", "--to", "slow.y"]);
    near(&from_there["ways"][0]["static_gain"], 1.0);
    near(&from_there["ways"][0]["bandwidth"], 0.2);
    let limited =
        desk.linearise(&["lags.ron", "--set", "after=50", "--at", "1.1s", "--open", "gain.y", "--no-plot"]);
    let text = String::from_utf8_lossy(&limited.stdout).into_owned();
    assert!(text.contains("nothing comes through") && text.contains("is at a limit or sticks"), "{text}");
}

#[test]
fn mistakes_are_told_with_a_remedy() {
    let desk = Desk::new("mistakes");
    for (words, code, expected) in [
        (&["--open", "gian.y"][..], 2, "did you mean `gain.y`?"),
        (&["--open", "gain.u"], 2, "name the signal that leads to it, `error.y`"),
        (&["--from", "gain.y", "--to", "both.y"], 2, "name one of them, from `both.y[0]` to `both.y[1]`"),
        (&["--from", "gain.y", "--to", "both.y[2]"], 2, "`both.y` has no element 2"),
        (&["--from", "gain.y", "--to", "late.y"], 2, "has no values in between"),
        (&["--open", "gain.y", "--at", "21s"], 2, "the run is over at 20 s"),
        (&["--open", "gain.y", "--at=-1s"], 2, "begins at 0 s"),
        (&["--from", "gain.y"], 2, "--to"),
        (&["--to", "gain.y"], 2, "--from"),
        (&["--open", "gain.y", "--set", "gain=x"], 3, "x"),
    ] {
        let output = desk.linearise(&[&["lags.ron"], words].concat());
        assert_eq!(output.status.code(), Some(code), "{words:?}: {}", said(&output));
        assert!(said(&output).contains(expected), "{words:?}: {}", said(&output));
    }
    let element = desk.json(&["lags.ron", "--from", "gain.y", "--to", "both.y[0]", "--open", "scope.actual"]);
    near(&element["ways"][0]["static_gain"], 1.0);
    assert_eq!(desk.linearise(&["nothing.ron", "--open", "gain.y"]).status.code(), Some(4));
}

#[test]
fn tables_and_drawings_are_written_whole_and_never_over_others() {
    let desk = Desk::new("files");
    let words = ["lags.ron", "--open", "gain.y", "--csv", "l.csv", "--svg", "l.svg", "--png", "l.png"];
    let output = desk.linearise(&words);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let table = std::fs::read_to_string(desk.0.join("l.csv")).expect("a table");
    assert!(
        table.starts_with("to,frequency [rad/s],magnitude [dB],phase [deg],real,imaginary\ngain.y,"),
        "{table}"
    );
    for line in table.lines().skip(1) {
        let cells: Vec<f64> = line.split(',').skip(1).map(|cell| cell.parse().expect("a number")).collect();
        let (w, db, phase) = (cells[0], cells[1], cells[2]);
        assert!((db - 20.0 * (2.0 / (1.0 + w * w).powf(1.5)).log10()).abs() < 1e-6, "{line}");
        assert!((phase + 3.0 * w.atan().to_degrees()).abs() < 1e-5, "{line}");
    }
    let drawing = std::fs::read_to_string(desk.0.join("l.svg")).expect("a drawing");
    assert!(drawing.contains("frequency [rad/s]") && drawing.contains("phase margin"), "{drawing}");
    assert!(std::fs::read(desk.0.join("l.png")).expect("a picture").starts_with(b"\x89PNG"));
    let again = desk.linearise(&words);
    assert_eq!(again.status.code(), Some(4));
    assert!(said(&again).contains("already exists"), "{}", said(&again));
    assert_eq!(desk.linearise(&[&words[..], &["--yes"]].concat()).status.code(), Some(0));
}

#[test]
fn the_page_shows_what_the_program_says() {
    let shown = commands_of("linear.md");
    assert!(shown.len() >= 3, "{} commands with answers", shown.len());
    for (command, answer) in shown {
        let words = arguments(&command);
        assert_eq!(words[..2], ["blocksim", "linearise"], "{command}");
        let words: Vec<&str> = words[2..].iter().map(String::as_str).collect();
        let output = linearise(&root(), &words);
        assert_eq!(String::from_utf8_lossy(&output.stdout), answer, "{command}: {}", said(&output));
    }
}

/// Sources that are constant or step, through a gain of 3, into a chain of two integrators and a lag of 1 us.
const SOURCES: &str = r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: {
        "step": Step(time: "2 s", after: 1), "constant": Constant(value: 2), "both": Sum(signs: "++"),
        "gain": Gain(k: 3), "fast": LowPass(tau: "1 us"), "speed": Integrator, "place": Integrator,
        "scope": Scope,
    },
    connections: [
        "step.y -> both.u1", "constant.y -> both.u2", "both.y -> gain.u", "gain.y -> fast.u", "fast.y -> speed.u",
        "speed.y -> place.u", "place.y -> scope.u",
    ],
)
"#;

#[test]
fn constants_and_steps_reach_through_gains_and_integrators_are_at_zero_exactly() {
    let desk = Desk::new("sources");
    std::fs::write(desk.0.join("sources.ron"), SOURCES).unwrap();
    for from in ["step.y", "constant.y"] {
        let found = desk.json(&["sources.ron", "--from", from, "--to", "gain.y,fast.y,place.y"]);
        let ways = found["ways"].as_array().unwrap();
        near(&ways[0]["static_gain"], 3.0);
        near(&ways[1]["static_gain"], 3.0);
        near(&ways[1]["step"]["rise"], 1e-6 * 9_f64.ln());
        assert!(ways[2]["static_gain"].is_null() && ways[2]["order"] == 3, "{}", ways[2]);
        let poles: Vec<f64> =
            ways[2]["poles"].as_array().unwrap().iter().map(|p| number(&p["pole"][0])).collect();
        assert!(poles[..2] == [0.0, 0.0] && (poles[2] / -1e6 - 1.0).abs() < 1e-9, "{poles:?}");
    }
}

/// Lags of 1e-9 s and of 100 s in one loop: G = 1 / ((1e-9 s + 1)(100 s + 1) + 1), which is 1/2 at rest.
const APART: &str = r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: {
        "demand": Constant(value: 1), "error": Sum(signs: "+-"), "fast": LowPass(tau: "1 ns"), "slow": LowPass(tau: "100 s"),
        "scope": Scope,
    },
    connections: ["demand.y -> error.u1", "error.y -> fast.u", "fast.y -> slow.u", "slow.y -> error.u2, scope.u"],
)
"#;

#[test]
fn slow_parts_beside_fast_ones_are_not_left_away() {
    let desk = Desk::new("apart");
    std::fs::write(desk.0.join("apart.ron"), APART).unwrap();
    let found = desk.json(&["apart.ron", "--from", "demand.y", "--to", "slow.y"]);
    let way = &found["ways"][0];
    assert_eq!(way["order"], 2, "{way}");
    near(&way["static_gain"], 0.5);
    assert!((number(&way["step"]["rise"]) / (50.0 * 9_f64.ln()) - 1.0).abs() < 1e-5, "{way}");
}

/// Whoever names an output looks at it, whether or not anything in the diagram does: a voltage that nobody can know is refused
/// instead of taken as zero.
#[test]
fn what_is_named_counts_as_looked_at() {
    let coil = |start: &str| {
        format!(
            r#"Diagram(
    simulation: (stop_time: "1 s"{start}),
    blocks: {{
        "amperes": Constant(value: "5 A"), "j": ControlledCurrentSource, "l": Inductor(l: "1 mH"),
        "v": VoltageSensor, "g": ElectricalReference, "s": Scope(inputs: ["i"]),
    }},
    connections: ["amperes.y -> j.i", "j.p <-> l.p <-> v.p", "l.n <-> j.n <-> v.n <-> g.p", "l.i -> s.i"],
)
"#
        )
    };
    let desk = Desk::new("watched");
    std::fs::write(desk.0.join("coil.ron"), coil("")).expect("a model");
    let current = linearise(&desk.0, &["coil.ron", "--from", "amperes.y", "--to", "l.i", "--json"]);
    assert!(current.status.success(), "{current:?}");
    let voltage = linearise(&desk.0, &["coil.ron", "--from", "amperes.y", "--to", "v.v"]);
    let said = String::from_utf8_lossy(&voltage.stderr);
    assert_eq!(voltage.status.code(), Some(3), "{voltage:?}");
    assert!(said.contains("error[unknown_slope]") && said.contains("`v` looks at the voltage"), "{said}");

    let held = r#", start: Steady(hold: {"v.v": "0 V"}, free: ["amperes.value"])"#;
    std::fs::write(desk.0.join("held.ron"), coil(held)).expect("a model");
    let steady = linearise(&desk.0, &["held.ron", "--from", "amperes.y", "--to", "l.i"]);
    let said = String::from_utf8_lossy(&steady.stderr);
    assert!(!steady.status.success() && said.contains("error[unknown_slope]"), "{said}");
}

#[test]
fn curves_are_those_of_the_transfer_function() {
    // x' = -4 x + 4 u: a lag of a quarter of a second.
    let lag = r#"Diagram(simulation: (stop_time: "1 s"), blocks: { "u": Constant(value: 0), "lag": LowPass(tau: "0.25 s"), "t": Terminator },
        connections: ["u.y -> lag.u", "lag.y -> t.u"])"#;
    let desk = crate::desk::Desk::with(&[("lag.ron", lag)]);
    let answer = desk.call(&["linearise", "lag.ron", "--from", "u.y", "--to", "lag.y", "--json", "--curves"]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    let found: serde_json::Value = serde_json::from_str(answer.out.trim()).expect("JSON");
    let curves = &found["ways"][0]["curves"];
    let numbers = |name: &str| -> Vec<f64> {
        curves[name].as_array().expect(name).iter().map(|x| x.as_f64().expect("a number")).collect()
    };
    let (w, magnitude, phase) = (numbers("frequency"), numbers("magnitude"), numbers("phase"));
    assert!(w.len() > 20 && w.len() == magnitude.len() && w.len() == phase.len());
    for ((w, magnitude), phase) in w.iter().zip(&magnitude).zip(&phase) {
        let expected = -10.0 * (1.0 + (w / 4.0).powi(2)).log10();
        assert!((magnitude - expected).abs() < 1e-6, "{w}: {magnitude} and {expected}");
        assert!((phase + (w / 4.0).atan().to_degrees()).abs() < 1e-6, "{w}: {phase}");
    }
    let step = curves["step"].as_array().expect("a course");
    let last = step.last().and_then(|point| point[0].as_f64()).expect("a time");
    assert!(last > 1.0 && last < 4.0, "{last} s are about two settling times");
    for point in step {
        let (t, y) = (point[0].as_f64().expect("t"), point[1].as_f64().expect("y"));
        assert!((y - (1.0 - (-4.0 * t).exp())).abs() < 1e-8, "{t}: {y}");
    }
    // Of a loop the closed one: an integrator with a gain of 8 settles with 8 1/s.
    let looped = r#"Diagram(simulation: (stop_time: "1 s"), blocks: { "k": Gain(k: -8), "x": Integrator }, connections: ["k.y -> x.u", "x.y -> k.u"])"#;
    let desk = crate::desk::Desk::with(&[("loop.ron", looped)]);
    let answer = desk.call(&["linearise", "loop.ron", "--open", "x.y", "--json", "--curves"]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    let found: serde_json::Value = serde_json::from_str(answer.out.trim()).expect("JSON");
    for point in found["ways"][0]["curves"]["step"].as_array().expect("a course") {
        let (t, y) = (point[0].as_f64().expect("t"), point[1].as_f64().expect("y"));
        assert!((y - (1.0 - (-8.0 * t).exp())).abs() < 1e-8, "{t}: {y}");
    }
    assert_eq!(desk.call(&["linearise", "loop.ron", "--open", "x.y", "--curves"]).code, Some(2));
}

/// The poles of a model and the names of the states that follow from others.
fn free(desk: &Desk, model: &str, words: &[&str]) -> (Vec<f64>, Vec<String>) {
    std::fs::write(desk.0.join("m.ron"), model).expect("a model");
    let found = desk.json(&[&["m.ron"], words].concat());
    let poles = found["poles"].as_array().expect("poles").iter();
    let names = found["following"].as_array().expect("names").iter();
    let name = |name: &Value| name.as_str().expect("a name").to_owned();
    (
        poles.map(|pole| number(&pole["pole"][0]).hypot(number(&pole["pole"][1]))).collect(),
        names.map(name).collect(),
    )
}

#[test]
fn states_that_follow_from_others_make_no_poles() {
    let desk = Desk::new("following");
    // A choke before a motor is a part of its inductance: s = -(r (l + j d) ... ) of 15 mH, 1 ohm, 0.1 V s, 1e-3 kg m^2, 0.01 N m s.
    let motor = r#"Diagram(simulation: (stop_time: "1 s"), blocks: {
        "v": VoltageSource(v: 12.0), "choke": Inductor(l: "5 mH"), "m": DcMotor(r: 1.0, l: 0.01, k: 0.1, j: 0.001),
        "f": RotationalReference, "d": RotationalDamper(d: 0.01), "g": ElectricalReference,
    }, connections: [
        "v.p <-> choke.p", "choke.n <-> m.p", "m.n <-> v.n <-> g.p", "m.r <-> d.r", "m.c <-> f.r <-> d.c",
    ])"#;
    let (l, j) = (0.015_f64, 0.001_f64);
    let (sum, product) = (1.0 / l + 0.01 / j, (1.0 * 0.01 + 0.1 * 0.1) / (l * j));
    let root = (sum * sum / 4.0 - product).sqrt();
    for words in [&[][..], &["--steady"], &["--at", "30ms"]] {
        let (mut poles, following) = free(&desk, motor, words);
        poles.retain(|pole| *pole != 0.0);
        assert_eq!((poles.len(), following), (2, vec!["m.i".to_owned()]), "{words:?}");
        for (pole, expected) in poles.iter().zip([sum / 2.0 - root, sum / 2.0 + root]) {
            assert!((pole / expected - 1.0).abs() < 1e-9, "{words:?}: {pole}, not {expected}");
        }
    }
    // From hit to hit the same poles.
    let (poles, following) = free(&desk, motor, &["--sampled=1ms"]);
    assert_eq!(following, ["m.i"]);
    for expected in [sum / 2.0 - root, sum / 2.0 + root] {
        let z = (-1e-3 * expected).exp();
        assert!(poles.iter().any(|pole| (pole - z).abs() < 1e-9), "{poles:?} without {z}");
    }
    // Two capacitances in parallel, 5 mF, behind 2 ohm; one in series with a source of any signal.
    let parallel = r#"Diagram(simulation: (stop_time: "1 s"), blocks: {
        "s": Sine(amplitude: "1 V", frequency: "5 Hz"), "v": ControlledVoltageSource, "c1": Capacitor(c: "5 mF"), "c2": Capacitor(c: "5 mF"),
        "r": Resistor(r: 2.0), "g": ElectricalReference,
    }, connections: ["s.y -> v.v", "v.p <-> c1.p", "c1.n <-> r.p <-> c2.p", "r.n <-> c2.n <-> v.n <-> g.p"])"#;
    let (poles, following) = free(&desk, parallel, &["--at", "20ms"]);
    assert_eq!((poles.len(), following.len()), (1, 1));
    assert!((poles[0] - 50.0).abs() < 1e-8, "{poles:?}");
    // A current that a source decides is no state.
    let cut = r#"Diagram(simulation: (stop_time: "1 s"), blocks: {
        "s": Sine(amplitude: "1 A", frequency: "5 Hz"), "i": ControlledCurrentSource, "l1": Inductor(l: "5 mH"), "l2": Inductor(l: "5 mH"),
        "r": Resistor(r: 2.0), "g": ElectricalReference,
    }, connections: ["s.y -> i.i", "i.p <-> l1.p", "l1.n <-> r.p <-> l2.p", "r.n <-> l2.n <-> i.n <-> g.p"])"#;
    let (poles, following) = free(&desk, cut, &["--at", "20ms"]);
    assert_eq!((poles.len(), following), (1, vec!["l1.i".to_owned()]));
    assert!((poles[0] - 400.0).abs() < 1e-7, "{poles:?}");
}

#[test]
fn a_closed_loop_of_bars_has_the_poles_of_its_one_freedom() {
    let desk = Desk::new("parallelogram");
    // Two cranks of 0.3 m and 0.8 kg hang from a beam, a coupler of 0.5 m and 1.1 kg joins them: a pendulum.
    let model = r#"Diagram(simulation: (stop_time: "1 s"), blocks: {
        "world": World, "ground": Transform(translation: ["0.5 m", "0 m", "0 m"]),
        "a": RevoluteJoint(axis: [0, -1, 0], position: "-90 deg"), "b": RevoluteJoint(axis: [0, -1, 0], position: "90 deg"),
        "c": RevoluteJoint(axis: [0, -1, 0]), "d": RevoluteJoint(axis: [0, -1, 0]),
        "left": Body(mass: "0.8 kg", com: ["0.15 m", "0 m", "0 m"], moi: ["0 kg*m^2", "0.006 kg*m^2", "0.006 kg*m^2"]),
        "left_end": Transform(translation: ["0.3 m", "0 m", "0 m"]),
        "coupler": Body(mass: "1.1 kg", com: ["0.2 m", "0 m", "0 m"], moi: ["0 kg*m^2", "0.01 kg*m^2", "0.01 kg*m^2"]),
        "coupler_end": Transform(translation: ["0.5 m", "0 m", "0 m"]),
        "right": Body(mass: "0.8 kg", com: ["0.15 m", "0 m", "0 m"], moi: ["0 kg*m^2", "0.006 kg*m^2", "0.006 kg*m^2"]),
        "right_end": Transform(translation: ["0.3 m", "0 m", "0 m"]),
    }, connections: [
        "world.frame <-> a.base <-> ground.base", "a.follower <-> left.frame <-> left_end.base", "left_end.follower <-> b.base",
        "b.follower <-> coupler.frame <-> coupler_end.base", "coupler_end.follower <-> c.base", "c.follower <-> right_end.follower",
        "right_end.base <-> right.frame <-> d.follower", "d.base <-> ground.follower",
    ])"#;
    let inertia = 2.0 * (0.006 + 0.8 * 0.15 * 0.15) + 1.1 * 0.3 * 0.3;
    let stiffness = 9.80665 * (2.0 * 0.8 * 0.15 + 1.1 * 0.3);
    let frequency = f64::sqrt(stiffness / inertia);
    for words in [&[][..], &["--steady"], &["--sampled=1ms"]] {
        let (poles, following) = free(&desk, model, words);
        assert_eq!((poles.len(), following.len()), (2, 6), "{words:?}: {poles:?}");
        let expected = if words == ["--sampled=1ms"] { 1.0 } else { frequency };
        assert!(
            poles.iter().all(|pole| (pole / expected - 1.0).abs() < 1e-6),
            "{words:?}: {poles:?}, not {expected}"
        );
    }
}

#[test]
fn a_current_source_whose_slope_is_known_moves_the_states_behind_it() {
    let desk = Desk::new("driven");
    let model = r#"Diagram(simulation: (stop_time: 1), blocks: {
        "r": Resistor(r: 0.8), "l1": Inductor(l: 0.04), "l2": Inductor(l: 0.022), "l3": Inductor(l: 0.01), "r3": Resistor(r: 3),
        "cs": ControlledCurrentSource, "c": Constant(value: "1 A"), "lp": LowPass(tau: 0.1), "g": ElectricalReference, SLOPE
    }, connections: [
        "cs.n <-> l1.p", "l1.n <-> l2.p <-> l3.p", "l2.n <-> r.p", "l3.n <-> r3.p", "r.n <-> r3.n <-> cs.p <-> g.p",
        "c.y -> lp.u", "lp.y -> cs.i", WIRES
    ])"#;
    // i2 / i = (r3 + s l3) / (r + r3 + s (l2 + l3)), behind the lag, whether the slope is told or not.
    for (slope, wires) in [
        ("", ""),
        (
            r#""su": Sum(signs: "+-"), "kd": Gain(k: "10 1/s")"#,
            r#""c.y -> su.u1", "lp.y -> su.u2", "su.y -> kd.u", "kd.y -> cs.di""#,
        ),
    ] {
        std::fs::write(desk.0.join("m.ron"), model.replace("SLOPE", slope).replace("WIRES", wires))
            .expect("a model");
        let found = desk.json(&["m.ron", "--from", "c.y", "--to", "l2.i"]);
        let way = &found["ways"][0];
        near(&way["zeros"][0][0], -300.0);
        let mut poles: Vec<f64> =
            way["poles"].as_array().expect("poles").iter().map(|pole| number(&pole["pole"][0])).collect();
        poles.sort_by(f64::total_cmp);
        for (pole, expected) in poles.iter().zip([-3.8 / 0.032, -10.0]) {
            assert!((pole / expected - 1.0).abs() < 1e-8, "{slope}: {poles:?}");
        }
    }
}

/// Chokes before a machine are a part of its windings: what follows are their currents, and never the angle of its shaft.
#[test]
fn chokes_before_a_machine_follow_from_its_currents_at_every_instant() {
    let desk = Desk::new("chokes");
    let model = |machine: &str, choke: &str, between: &str| {
        format!(
            r#"Diagram(simulation: (stop_time: 2), blocks: {{
        "inv": VectorInverter(vdc: "560 V", modulation: SpaceVector), "vd": Constant(value: "-10 V"), "vq": Constant(value: "60 V"),
        "zm": PermanentMagnetMachine(pole_pairs: 3, {machine}, flux: 0.12), {choke}
        "j": Inertia(j: 0.01), "d": RotationalDamper(d: 0.02), "h": RotationalReference,
    }}, connections: [
        "zm.r <-> j.r <-> d.r", "zm.c <-> d.c <-> h.r", "vd.y -> inv.v_d", "vq.y -> inv.v_q", "zm.theta -> inv.theta", {between}
    ])"#
        )
    };
    let choke = r#""choke": ThreePhaseRlc(r: 0.4, l: 0.003),"#;
    let behind = model(
        "r_s: 0.6, l_d: 0.0014, l_q: 0.0028",
        choke,
        r#""inv.ac <-> choke.ac1", "choke.ac2 <-> zm.ac""#,
    );
    let inside = model("r_s: 1.0, l_d: 0.0044, l_q: 0.0058", "", r#""inv.ac <-> zm.ac""#);
    for at in ["1", "1.5", "1.903", "2"] {
        let (poles, following) = free(&desk, &behind, &["--at", at]);
        assert_eq!(following, ["choke.i_a", "choke.i_b", "choke.i_c"], "{at}");
        let (expected, none) = free(&desk, &inside, &["--at", at]);
        assert_eq!((poles.len(), none.len()), (expected.len(), 0), "{at}");
        for (pole, expected) in poles.iter().zip(&expected) {
            assert!((pole - expected).abs() < 1e-5 * expected + 1e-6, "{at}: {poles:?}, not {expected}");
        }
    }
}

/// A contact that is closed ties capacitances together, one that is open windings: also from hit to hit, where it would take apart what is
/// varied.
#[test]
fn contacts_tie_states_together_from_hit_to_hit() {
    let desk = Desk::new("tied");
    let source = r#""r": Resistor(r: 10), "src": ControlledVoltageSource, "u": Constant(value: "7 V"), "g": ElectricalReference"#;
    for (parts, wires, ts) in [
        (
            r#""c1": Capacitor(c: 1e-3), "c2": Capacitor(c: 2e-3), "sw": IdealSwitch(r_on: 0), "on": Constant(value: true)"#,
            r#""src.p <-> r.p", "r.n <-> c1.p <-> sw.p", "sw.n <-> c2.p", "c1.n <-> c2.n <-> src.n <-> g.p""#,
            "0.01",
        ),
        (
            r#""l1": Inductor(l: 0.01), "l2": Inductor(l: 0.02), "sw": IdealSwitch(r_on: 0.01), "on": Constant(value: false)"#,
            r#""src.p <-> r.p", "r.n <-> l1.p", "l1.n <-> l2.p <-> sw.p", "l2.n <-> sw.n <-> src.n <-> g.p""#,
            "0.001",
        ),
    ] {
        let text = format!(
            r#"Diagram(simulation: (stop_time: 1), blocks: {{ {parts}, {source}, "zoh": ZeroOrderHold(ts: {ts}) }},
                connections: [{wires}, "on.y -> sw.gate", "u.y -> zoh.u", "zoh.y -> src.v"])"#
        );
        for words in [&["--sampled"][..], &["--sampled", "--at", "0.5s"]] {
            let (poles, following) = free(&desk, &text, words);
            assert_eq!((poles.len(), following.len()), (1, 1), "{words:?}");
            assert!((poles[0] - (-1.0_f64 / 3.0).exp()).abs() < 1e-9, "{words:?}: {poles:?}");
        }
    }
}

/// A lag of 0.1 ns into one of 2e5 s that grows or dies out, and an integrator behind it, which is read where `back` is not zero.
const UNREAD: &str = r#"Diagram(
    parameters: { "pole": -1.0, "back": 0.0 },
    simulation: (stop_time: "1 s"),
    blocks: {
        "set": Constant(value: 0), "fast": LowPass(tau: "0.1 ns"),
        "slow": OdeSystem(law: "z' = 5e-6*pole*z + u", start: { "z": 1 }, parameters: { "pole": "pole" }),
        "place": Integrator, "back": Gain(k: "back"), "both": Sum(signs: "++"), "scope": Scope,
    },
    connections: [
        "set.y -> fast.u", "fast.y -> both.u1", "place.y -> back.u, scope.u", "back.y -> both.u2", "both.y -> slow.u", "slow.z -> place.u",
    ],
)
"#;

#[test]
fn what_nothing_reads_does_not_decide_on_stability_nor_what_is_fast_elsewhere() {
    let desk = Desk::new("unread");
    std::fs::write(desk.0.join("apart.ron"), UNREAD).unwrap();
    let words = |set: &[&str]| {
        let words: Vec<&str> =
            ["apart.ron"].into_iter().chain(set.iter().flat_map(|set| ["--set", set])).collect();
        let output = linearise(&desk.0, &words);
        assert!(output.status.success(), "{}", said(&output));
        String::from_utf8(output.stdout).unwrap().lines().last().unwrap().to_owned()
    };
    let unread = "; `place.x` keeps what is added to it, and nothing else reads it";
    assert_eq!(words(&[]), format!("stable{unread}"));
    assert_eq!(words(&["pole=1"]), format!("not stable: what has a negative damping grows{unread}"));
    // Read, it is part of it: s (s + 5e-6) = back.
    assert_eq!(words(&["back=1e-3"]), "not stable: what has a negative damping grows");
    assert_eq!(
        words(&["pole=0"]),
        format!("at the border of stability: what has an infinite time constant stays{unread}")
    );
    assert_eq!(desk.json(&["apart.ron"])["unread"], serde_json::json!(["place.x"]));
}
