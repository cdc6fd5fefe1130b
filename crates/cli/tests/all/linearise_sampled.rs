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
    let desk = Desk::new("refused");
    for (model, words, expected) in [
        (&late, &["--sampled"][..], "`late` answers from memory"),
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
