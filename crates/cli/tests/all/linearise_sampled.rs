//! `blocksim linearise --sampled`, against formulas and long simulations.

use serde_json::Value;

use crate::linearise::{Desk, near, number, said};

fn desk(name: &str, model: &str) -> Desk {
    let desk = Desk::new(name);
    std::fs::write(desk.0.join("m.ron"), model).expect("a model");
    desk
}

/// A double integrator behind a hold of 0.1 s, with u = 21 e[k] - 19 e[k-1].
const DOUBLE: &str = r#"Diagram(
    simulation: (stop_time: "20 s"),
    blocks: {
        "demand": Constant(value: 0), "error": Sum(signs: "+-"),
        "pd": DiscreteTransferFunction(ts: "0.1 s", num: [21, -19], den: [1, 0]),
        "v": Integrator, "x": Integrator(x0: 1), "scope": Scope,
    },
    connections: [
        "demand.y -> error.u1", "error.y -> pd.u", "pd.y -> v.u", "v.y -> x.u", "x.y -> error.u2, scope.u",
    ],
)
"#;

fn poles(found: &Value) -> Vec<(f64, f64)> {
    let poles = found["poles"].as_array().expect("poles");
    poles.iter().map(|pole| (number(&pole["pole"][0]), number(&pole["pole"][1]))).collect()
}

/// The value of a polynomial, highest power first, at a complex number.
fn polynomial(coefficients: &[f64], (re, im): (f64, f64)) -> f64 {
    let value = coefficients.iter().fold((0.0, 0.0), |(a, b), c| (a * re - b * im + c, a * im + b * re));
    value.0.hypot(value.1)
}

#[test]
fn a_double_integrator_with_a_sampled_controller_has_the_poles_and_margins_of_the_books() {
    let desk = desk("double", DOUBLE);
    let found = desk.json(&["m.ron", "--sampled"]);
    near(&found["period"], 0.1);
    // Held: x / u = T^2 / 2 (z + 1) / (z - 1)^2; C = (21 z - 19) / z.
    let closed = [1.0, -2.0 + 0.005 * 21.0, 1.0 + 0.005 * 2.0, -0.005 * 19.0];
    let all = poles(&found);
    assert_eq!(all.len(), 3);
    assert!(all.iter().all(|pole| polynomial(&closed, *pole) < 1e-9), "{all:?}");
    let pair = &found["poles"][1];
    let z = (number(&pair["pole"][0]), number(&pair["pole"][1]));
    let (re, im) = (z.0.hypot(z.1).ln() / 0.1, z.1.atan2(z.0) / 0.1);
    near(&pair["frequency"], re.hypot(im));
    near(&pair["damping"], -re / re.hypot(im));
    for cut in ["pd.y", "error.y", "x.y"] {
        let found = desk.json(&["m.ron", "--sampled", "--open", cut]);
        let margins = &found["ways"][0]["margins"];
        assert_eq!(margins["stable"], true, "{cut}");
        // The closed loop with the gain margin has a pole on the unit circle, at the frequency of the margin.
        let (gain, w) = (number(&margins["gain"][0]["value"]), number(&margins["gain"][0]["frequency"]));
        let border = [1.0, -2.0 + 0.105 * gain, 1.0 + 0.01 * gain, -0.095 * gain];
        assert!(polynomial(&border, ((0.1 * w).cos(), (0.1 * w).sin())) < 1e-6, "{cut}: {gain} at {w}");
        // At the crossover |L| = 1: L = 0.005 (z + 1) (21 z - 19) / (z (z - 1)^2).
        let w = number(&margins["phase"][0]["frequency"]);
        let z = ((0.1 * w).cos(), (0.1 * w).sin());
        let l = 0.005 * polynomial(&[21.0, 2.0, -19.0], z) / polynomial(&[1.0, -2.0, 1.0], z);
        assert!((l - 1.0).abs() < 1e-6, "{cut}: {l}");
    }
    let way = desk.json(&["m.ron", "--sampled", "--from", "demand.y", "--to", "x.y"]);
    near(&way["ways"][0]["static_gain"], 1.0);
}

#[test]
fn a_pid_of_the_library_on_a_lag_has_the_poles_of_its_difference_equations() {
    let model = r#"Diagram(
        simulation: (stop_time: "20 s", solver: Ode4(step: "0.01 s")),
        blocks: {
            "demand": Constant(value: 1), "error": Sum(signs: "+-"),
            "pid": DiscretePid(ts: "0.2 s", kp: 2.0, ki: 1.5, integrator: Trapezoidal, lower: -10, upper: 10),
            "plant": LowPass(tau: "1 s"), "scope": Scope,
        },
        connections: ["demand.y -> error.u1", "error.y -> pid.e", "pid.u -> plant.u", "plant.y -> error.u2, scope.u"],
    )"#;
    let desk = desk("pid", model);
    let found = desk.json(&["m.ron", "--sampled", "--at", "15s"]);
    let (t, kp, ki) = (0.2_f64, 2.0, 1.5);
    let a = (-t).exp();
    // x+ = a x + (1 - a) (s - (kp + ki T / 2) x), s+ = s - ki T x.
    let (x, s) = (a - (1.0 - a) * (kp + ki * t / 2.0), 1.0 - a);
    let closed = [1.0, -(x + 1.0), x + s * ki * t];
    // The filter of the derivative is not used.
    let all: Vec<(f64, f64)> = poles(&found).into_iter().filter(|pole| pole.0 != 0.0).collect();
    assert!(all.len() == 2 && all.iter().all(|pole| polynomial(&closed, *pole) < 1e-9), "{all:?}");
    assert!((number(&found["states"][0]["value"]) - 1.0).abs() < 1e-4);
}

/// A cascade whose outer loop samples three times as slowly.
const CASCADE: &str = r#"Diagram(
    parameters: { "kp": 0.8 },
    simulation: (stop_time: "30 s", solver: Dop853(rtol: 1e-10)),
    blocks: {
        "demand": Constant(value: 0), "outer": Sum(signs: "+-"), "slow": ZeroOrderHold(ts: "0.3 s"), "p": Gain(k: "kp"),
        "inner": Sum(signs: "+-"), "pi": DiscretePid(ts: "0.1 s", kp: 3.0, ki: 4.0),
        "v": LowPass(tau: "0.5 s"), "x": Integrator(x0: 1), "scope": Scope,
        "shown": ZeroOrderHold(ts: "0.7 s"), "screen": Scope,
    },
    connections: [
        "demand.y -> outer.u1", "outer.y -> slow.u", "slow.y -> p.u", "p.y -> inner.u1", "inner.y -> pi.e", "pi.u -> v.u",
        "v.y -> x.u, inner.u2", "x.y -> outer.u2, scope.u, shown.u", "shown.y -> screen.u",
    ],
)
"#;

fn matrix(found: &Value) -> Vec<Vec<f64>> {
    let rows = found["a"].as_array().expect("rows");
    rows.iter().map(|row| row.as_array().expect("a row").iter().map(number).collect()).collect()
}

fn states(found: &Value) -> Vec<(String, f64)> {
    let states = found["states"].as_array().expect("states");
    states.iter().map(|s| (s["name"].as_str().expect("a name").to_owned(), number(&s["value"]))).collect()
}

#[test]
fn a_loop_of_two_rates_decays_in_a_long_simulation_as_its_matrix_says() {
    let desk = desk("cascade", CASCADE);
    // What is only shown samples at its own rate, which does not take part.
    let words = ["m.ron", "--sampled", "--from", "demand.y", "--to", "x.y"];
    let start = desk.json(&words);
    near(&start["period"], 0.3);
    let a = matrix(&start);
    let mut x: Vec<f64> = states(&start).into_iter().map(|state| state.1).collect();
    for _ in 0..20 {
        x = a.iter().map(|row| row.iter().zip(&x).map(|(a, x)| a * x).sum()).collect();
    }
    let later = desk.json(&[&words[..], &["--at", "6s"]].concat());
    near(&later["t"], 6.0);
    for ((name, simulated), expected) in states(&later).into_iter().zip(&x) {
        assert!((simulated - expected).abs() < 1e-7, "{name}: {simulated}, not {expected}");
    }
    // The outer loop is passed once a period, the inner one is not.
    let outer = desk.json(&["m.ron", "--sampled", "--open", "slow.y"]);
    let gain = number(&outer["ways"][0]["margins"]["gain"][0]["value"]);
    for (share, stable) in [(0.999, true), (1.001, false)] {
        let kp = format!("kp={}", 0.8 * gain * share);
        let closed = desk.json(&["m.ron", "--sampled", "--from", "demand.y", "--to", "x.y", "--set", &kp]);
        let mut poles = closed["ways"][0]["poles"].as_array().unwrap().iter();
        let is_inside = |pole: &Value| number(&pole["pole"][0]).hypot(number(&pole["pole"][1])) < 1.0;
        assert_eq!(poles.all(is_inside), stable, "{kp}");
    }
    let inner = desk.linearise(&["m.ron", "--sampled", "--open", "pi.u"]);
    assert_eq!(inner.status.code(), Some(1));
    assert!(said(&inner).contains("is not passed once in the period of 0.3 s"), "{}", said(&inner));
}

#[test]
fn a_delay_of_samples_is_a_chain_wherever_its_ring_begins() {
    let model = r#"Diagram(
        simulation: (stop_time: "20 s"),
        blocks: {
            "late": Delay(ts: "0.5 s", steps: 3), "back": Gain(k: -0.6), "x": Integrator(x0: 1), "scope": Scope,
        },
        connections: ["x.y -> late.u, scope.u", "late.y -> back.u", "back.y -> x.u"],
    )"#;
    let desk = desk("ring", model);
    // x+ = x - 0.3 x[k-3]: z^4 - z^3 + 0.3 = 0.
    for at in ["0s", "0.5s", "1s", "4.2s"] {
        let all = poles(&desk.json(&["m.ron", "--sampled", "--at", at]));
        assert_eq!(all.len(), 4);
        let law = [1.0, -1.0, 0.0, 0.0, 0.3];
        assert!(all.iter().all(|pole| polynomial(&law, *pole) < 1e-9), "{at}: {all:?}");
    }
}

#[test]
fn a_continuous_model_is_sampled_with_a_period_that_is_named() {
    let model = r#"Diagram(
        simulation: (stop_time: "2 s"),
        blocks: { "u": Constant(value: 1), "lag": LowPass(tau: "0.5 s"), "sum": Integrator, "scope": Scope },
        connections: ["u.y -> lag.u", "lag.y -> sum.u", "sum.y -> scope.u"],
    )"#;
    let desk = desk("held", model);
    let found = desk.json(&["m.ron", "--sampled=0.2s", "--from", "u.y", "--to", "lag.y,sum.y"]);
    let a = (-0.4_f64).exp();
    let way = &found["ways"][0];
    assert!((number(&way["poles"][0]["pole"][0]) - a).abs() < 1e-10);
    near(&way["static_gain"], 1.0);
    // With a hold: b = 1 - a, and for the integral T - tau (1 - a).
    assert!((number(&found["b"][0][0]) - (1.0 - a)).abs() < 1e-10, "{}", found["b"]);
    assert!((number(&found["b"][1][0]) - (0.2 - 0.5 * (1.0 - a))).abs() < 1e-10, "{}", found["b"]);
    assert!(found["ways"][1]["static_gain"].is_null());
}

#[test]
fn what_cannot_be_sampled_is_refused_with_cause_and_remedy() {
    let loop_of = |blocks: &str, last: &str| {
        format!(
            r#"Diagram(simulation: (stop_time: "20 s"), blocks: {{ {blocks}, "hold": ZeroOrderHold(ts: "0.3 s"), "back": Gain(k: -1),
            "x": Integrator(x0: 1), "scope": Scope }}, connections: ["x.y -> hold.u, scope.u", "hold.y -> back.u", {last}])"#
        )
    };
    let late = loop_of(r#""late": TransportDelay(delay: "0.2 s")"#, r#""back.y -> late.u", "late.y -> x.u""#);
    let limited = loop_of(
        r#""limit": RateLimiter(rising: 1, falling: -1)"#,
        r#""back.y -> limit.u", "limit.y -> x.u""#,
    );
    let relay = loop_of(
        r#""relay": Relay(on_at: 0.1, off_at: -0.1, on: -5, off: 5), "both": Sum(signs: "++")"#,
        r#""x.y -> relay.u", "relay.y -> both.u1", "back.y -> both.u2", "both.y -> x.u""#,
    );
    let odd = loop_of(
        r#""other": ZeroOrderHold(ts: "0.1000001 s"), "both": Sum(signs: "++")"#,
        r#""x.y -> other.u", "other.y -> both.u1", "back.y -> both.u2", "both.y -> x.u""#,
    );
    let triggered = loop_of(
        r#""clock": Pulse(period: "0.3 s", width: 0.5), "part": Subsystem(file: "part.ron", trigger: Rising)"#,
        r#""clock.y -> part.trigger", "back.y -> part.u", "part.y -> x.u""#,
    );
    let desk = Desk::new("refused");
    let part = r#"Diagram(inputs: { "u": () }, outputs: { "y": "i.y" },
        blocks: { "i": DiscreteIntegrator(ts: "0.3 s") }, connections: ["in.u -> i.u"])"#;
    std::fs::write(desk.0.join("part.ron"), part).unwrap();
    for (model, words, expected) in [
        (&late, &["--sampled"][..], "`late` answers from memory"),
        (&triggered, &["--sampled"], "`part/i` is updated at times of its own within the period"),
        (&limited, &["--sampled"], "`limit` answers from memory"),
        (&relay, &["--sampled", "--at", "3s"], "something happens that is not smooth: `relay` switches"),
        (&odd, &["--sampled"], "have no common period of fewer than"),
        (
            &late,
            &["--sampled=0.2s", "--from", "back.y", "--to", "hold.y"],
            "is not a multiple of that of the sample times 0.3 s",
        ),
    ] {
        std::fs::write(desk.0.join("m.ron"), model).unwrap();
        let output = desk.linearise(&[&["m.ron"], words].concat());
        assert_eq!(output.status.code(), Some(1), "{words:?}: {}", said(&output));
        assert!(
            said(&output).contains(expected) && said(&output).contains("help:"),
            "{words:?}: {}",
            said(&output)
        );
        assert!(output.stdout.is_empty());
    }
    let smooth = desk.linearise(&[
        "lags.ron",
        "--sampled",
        "--from",
        "gain.y",
        "--to",
        "b.y",
        "--open",
        "scope.actual",
    ]);
    assert!(said(&smooth).contains("name the period, as in `--sampled=1ms`"), "{}", said(&smooth));
    for wrong in ["--sampled=0s", "--sampled=fast"] {
        assert_eq!(desk.linearise(&["lags.ron", wrong]).status.code(), Some(2), "{wrong}");
    }
}

/// The second line of the output, on where slopes come from.
fn way(desk: &Desk, words: &[&str]) -> String {
    let output = desk.linearise(&[words, &["--no-plot"]].concat());
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    text.lines().nth(1).unwrap_or_else(|| panic!("{}", said(&output))).to_owned()
}

const EXACT: &str = "slopes are exact, from the laws of the blocks";

/// An oscillator behind a hold, with a sampled PI controller, against the closed form of its transition matrix.
#[test]
fn a_plant_of_second_order_behind_a_hold_has_its_closed_form() {
    let model = r#"Diagram(
        simulation: (stop_time: "20 s"),
        blocks: {
            "demand": Constant(value: 1), "error": Sum(signs: "+-"),
            "pi": DiscretePid(ts: "0.2 s", kp: 0.4, ki: 1.5, integrator: Trapezoidal),
            "stiffness": Gain(k: 9), "damping": Gain(k: 1.2), "sum": Sum(signs: "+--"), "gain": Gain(k: 9),
            "v": Integrator, "x": Integrator(x0: 0.3), "scope": Scope,
        },
        connections: [
            "demand.y -> error.u1", "error.y -> pi.e", "pi.u -> gain.u", "gain.y -> sum.u1", "damping.y -> sum.u2",
            "stiffness.y -> sum.u3", "sum.y -> v.u", "v.y -> x.u, damping.u", "x.y -> stiffness.u, error.u2, scope.u",
        ],
    )"#;
    let desk = desk("second", model);
    let words = ["m.ron", "--sampled", "--at", "3s", "--from", "demand.y", "--to", "x.y"];
    assert_eq!(way(&desk, &words), EXACT);
    let found = desk.json(&words);
    assert_eq!(found["differences"]["because"], Value::Null);
    // x'' + 2 s x' + w^2 x = w^2 u with s = 0.6, w = 3, d = sqrt(w^2 - s^2); of the two states v and x.
    let (t, kp, ki, s, w) = (0.2_f64, 0.4, 1.5, 0.6_f64, 3.0_f64);
    let d = (w * w - s * s).sqrt();
    let (e, c, n) = ((-s * t).exp(), (d * t).cos(), (d * t).sin());
    let phi = [[e * (c - s / d * n), -e * w * w / d * n], [e * n / d, e * (c + s / d * n)]];
    // A constant u keeps x = u at rest.
    let gamma = [-phi[0][1], 1.0 - phi[1][1]];
    // u = (kp + ki T / 2) (r - x) + i, i+ = i + ki T (r - x).
    let k = kp + ki * t / 2.0;
    let expected = |row: &str, column: &str| match (row, column) {
        ("v.x", "v.x") => phi[0][0],
        ("v.x", "x.x") => phi[0][1] - gamma[0] * k,
        ("v.x", "i") => gamma[0],
        ("v.x", "r") => gamma[0] * k,
        ("x.x", "v.x") => phi[1][0],
        ("x.x", "x.x") => phi[1][1] - gamma[1] * k,
        ("x.x", "i") => gamma[1],
        ("x.x", "r") => gamma[1] * k,
        ("i", "x.x") => -ki * t,
        ("i", "i") => 1.0,
        ("i", "r") => ki * t,
        _ => 0.0,
    };
    let names: Vec<String> = states(&found).into_iter().map(|state| state.0).collect();
    let short = |name: &str| if name == "pi.integral" { "i".to_owned() } else { name.to_owned() };
    let a = matrix(&found);
    for (i, row) in names.iter().enumerate() {
        for (j, column) in names.iter().enumerate() {
            let exact = expected(&short(row), &short(column));
            assert!((a[i][j] - exact).abs() < 1e-13, "{row} by {column}: {} {exact}", a[i][j]);
        }
        let (b, exact) = (number(&found["b"][i][0]), expected(&short(row), "r"));
        assert!((b - exact).abs() < 1e-13, "{row} by the demand: {b} {exact}");
    }
}

/// The cascade of two rates, against the product of the closed forms of its three short periods.
#[test]
fn two_rates_have_the_product_of_their_closed_forms() {
    let desk = desk("product", CASCADE);
    let words = ["m.ron", "--sampled", "--from", "demand.y", "--to", "x.y"];
    assert_eq!(way(&desk, &words), EXACT);
    let found = desk.json(&words);
    // v' = (u - v) / 0.5, x' = v; u = 3 (0.8 (r - X) - v) + i, i+ = i + 0.4 (0.8 (r - X) - v), X that of the first hit.
    let (t, tau) = (0.1_f64, 0.5);
    let e = (-t / tau).exp();
    let period = |start: [f64; 3], r: f64| {
        let [mut v, mut x, mut i] = start;
        let first = x;
        for _ in 0..3 {
            let error = 0.8 * (r - first) - v;
            let u = 3.0 * error + i;
            x += tau * (1.0 - e) * v + (t - tau * (1.0 - e)) * u;
            v = e * v + (1.0 - e) * u;
            i += 0.4 * error;
        }
        [v, x, i]
    };
    let names: Vec<String> = states(&found).into_iter().map(|state| state.0).collect();
    let place = |name: &str| ["v.x", "x.x", "pi.integral"].iter().position(|own| *own == name);
    let a = matrix(&found);
    for (row, i) in names.iter().enumerate().filter_map(|(row, name)| Some((row, place(name)?))) {
        for (column, j) in names.iter().enumerate().filter_map(|(row, name)| Some((row, place(name)?))) {
            let mut unit = [0.0; 3];
            unit[j] = 1.0;
            let exact = period(unit, 0.0)[i];
            assert!((a[row][column] - exact).abs() < 1e-13, "{row} {column}: {} {exact}", a[row][column]);
        }
        assert!((number(&found["b"][row][0]) - period([0.0; 3], 1.0)[i]).abs() < 1e-13);
    }
}

/// Along a way that is no straight line, with a source that jumps on it, at rest and moving.
#[test]
fn slopes_along_a_curved_way_have_their_closed_forms() {
    let model = |law: &str, more: &str, wires: &str| {
        format!(
            r#"Diagram(simulation: (stop_time: "20 s"), blocks: {{ "law": Expression(law: "{law}"), "x": Integrator(x0: 0.8),
            "scope": Scope, {more} }}, connections: ["law.y -> x.u", "x.y -> scope.u, law.u1", {wires}])"#
        )
    };
    let desk = Desk::new("curved");
    let slope = |text: &str, words: &[&str]| {
        std::fs::write(desk.0.join("m.ron"), text).unwrap();
        let words = [&["m.ron"], words].concat();
        assert_eq!(way(&desk, &words), EXACT, "{text}");
        let found = desk.json(&words);
        (states(&found)[0].1, matrix(&found)[0][0])
    };
    // x' = -x^3: x(T) = x / sqrt(1 + 2 x^2 T).
    let cubic = model("-u1^3", "", "");
    let (x, found) = slope(&cubic, &["--sampled=0.5s"]);
    let exact = (1.0 + 2.0 * x * x * 0.5).powf(-1.5);
    assert!(x == 0.8 && (found - exact).abs() < 1e-9, "{found} {exact}");
    // x' = u x with u = -2 x at the hit: x(T) = x exp(-2 x T).
    let held = r#""hold": ZeroOrderHold(ts: "0.25 s"), "k": Gain(k: -2)"#;
    let product = model("u1*u2", held, r#""x.y -> hold.u", "hold.y -> k.u", "k.y -> law.u2""#);
    for at in ["0s", "1.1s"] {
        let (x, found) = slope(&product, &["--sampled", "--at", at]);
        let exact = (1.0 - 0.5 * x) * (-0.5 * x).exp();
        assert!((found - exact).abs() < 1e-10, "{at}: {found} {exact}");
    }
    // x' = -x r(t), where r jumps from 1 to 3 within the period: exp(-0.05 - 3 * 0.15).
    let step = r#""r": Step(time: "0.05 s", before: 1, after: 3)"#;
    let (_, found) = slope(&model("-u1*u2", step, r#""r.y -> law.u2""#), &["--sampled=0.2s"]);
    assert!((found - (-0.5_f64).exp()).abs() < 1e-12, "{found}");
}

/// Where slopes do not follow from laws they are differences, and the output tells why.
#[test]
fn what_is_not_followed_is_differenced_and_named() {
    let model = |block: &str, wires: &str| {
        format!(
            r#"Diagram(simulation: (stop_time: "20 s"), blocks: {{ {block}, "hold": ZeroOrderHold(ts: "0.5 s"), "back": Gain(k: -0.8),
            "x": Integrator(x0: 1), "scope": Scope }}, connections: ["x.y -> hold.u, scope.u", "hold.y -> back.u", {wires}])"#
        )
    };
    let desk = Desk::new("differenced");
    let text = |text: &str, words: &[&str]| {
        std::fs::write(desk.0.join("m.ron"), text).unwrap();
        let words = [&["m.ron", "--sampled"], words].concat();
        (way(&desk, &words), matrix(&desk.json(&words)))
    };
    // A table is no law; its slope is 2 where it is used.
    let table = model(
        r#""table": LookupTable1D(breakpoints: [-10, 0, 10], table: [-20, 0, 10])"#,
        r#""back.y -> table.u", "table.y -> x.u""#,
    );
    let (words, a) = text(&table, &[]);
    assert!(words == EXACT || words.ends_with("differences in `table`"), "{words}");
    assert!((a[0][0] - 0.2).abs() < 1e-9, "{a:?}");
    // At the edge of a limit: both sides count.
    let edge =
        model(r#""limit": Saturation(lower: -0.8, upper: 5)"#, r#""back.y -> limit.u", "limit.y -> x.u""#);
    let (words, a) = text(&edge, &[]);
    assert!(words.contains("differences of the whole model, as `limit` has a kink there"), "{words}");
    assert!((a[0][0] - 0.8).abs() < 1e-6, "{a:?}");
    let (words, a) = text(&edge, &["--at", "0.5s"]);
    assert_eq!(words, EXACT);
    assert!((a[0][0] - 0.6).abs() < 1e-12);
    // Beyond it nothing comes back.
    let beyond = edge.replace("-0.8, upper", "-0.2, upper");
    let (words, a) = text(&beyond, &[]);
    assert!(words == EXACT && a[0][0] == 1.0, "{words}, {a:?}");
}

#[test]
fn a_run_that_holds_samples_says_how_they_are_taken_as_they_are() {
    let desk = desk("hint", DOUBLE);
    let output = desk.linearise(&["m.ron", "--open", "pd.y", "--no-plot"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("--sampled takes the samples as they are"), "{text}");
    let text = desk.linearise(&["m.ron", "--sampled", "--no-plot"]);
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    assert!(text.contains("from hit to hit of 0.1 s: poles") && text.ends_with("stable\n"), "{text}");
}

/// Lines of a hold lead to samples wherever it is, also where all are equal: at rest.
#[test]
fn a_first_order_hold_in_a_loop_has_the_poles_of_its_difference_equation_at_rest_and_under_way() {
    for (at, start) in [("0s", 0.0), ("0s", 1.0), ("0.35s", 1.0), ("0.62s", -3.0)] {
        let model = format!(
            r#"Diagram(
                simulation: (stop_time: "1 s"),
                blocks: {{
                    "demand": Constant(value: 0), "error": Sum(signs: "+-"), "k": Gain(k: "5 1/s"),
                    "hold": FirstOrderHold(ts: "0.1 s"), "x": Integrator(x0: {start}), "scope": Scope,
                }},
                connections: [
                    "demand.y -> error.u1", "error.y -> k.u", "k.y -> hold.u", "hold.y -> x.u", "x.y -> error.u2, scope.u",
                ],
            )"#
        );
        let desk = desk("first_order_hold", &model);
        let found = desk.json(&["m.ron", "--sampled", "--at", at]);
        // x+ = x + T (w - K x) / 2, w+ = -K x.
        let closed = [1.0, 5.0 * 0.1 / 2.0 - 1.0, 5.0 * 0.1 / 2.0];
        let all: Vec<(f64, f64)> =
            poles(&found).into_iter().filter(|(re, im)| re.hypot(*im) > 1e-6).collect();
        assert!(all.len() == 2 && all.iter().all(|pole| polynomial(&closed, *pole) < 1e-8), "{at}: {all:?}");
    }
}
