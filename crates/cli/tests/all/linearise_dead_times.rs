//! Dead times and models without signals in `blocksim linearise`.

use std::f64::consts::PI;

use crate::linearise::{Desk, near, number, said};

/// L = k exp(-0.5 s) / (s + 1), behind a dead time of which nothing is fed back.
const DEAD: &str = r#"Diagram(
    title: "Dead time",
    parameters: { "k": 1.0 },
    simulation: (stop_time: "20 s"),
    blocks: {
        "demand": Constant(value: 0), "first": TransportDelay(delay: "0.3 s"), "error": Sum(signs: "+-"), "gain": Gain(k: "k"),
        "lag": LowPass(tau: "1 s"), "late": TransportDelay(delay: "0.5 s"), "scope": Scope,
    },
    connections: [
        "demand.y -> first.u", "first.y -> error.u1", "error.y -> gain.u", "gain.y -> lag.u", "lag.y -> late.u",
        "late.y -> error.u2, scope.u",
    ],
)
"#;

fn desk(name: &str) -> Desk {
    let desk = Desk::new(name);
    std::fs::write(desk.0.join("dead.ron"), DEAD).expect("a model");
    desk
}

#[test]
fn a_loop_with_a_dead_time_has_its_exact_margins_wherever_it_is_cut() {
    let desk = desk("dead");
    // atan w + w / 2 = pi.
    let (mut low, mut high) = (1.0_f64, 10.0);
    for _ in 0..100 {
        let middle = (low + high) / 2.0;
        if middle.atan() + middle / 2.0 < PI { low = middle } else { high = middle }
    }
    for cut in ["gain.y", "lag.y", "late.y", "error.y"] {
        let found = desk.json(&["dead.ron", "--set", "k=2", "--open", cut]);
        let way = &found["ways"][0];
        let margins = &way["margins"];
        near(&margins["gain"][0]["frequency"], low);
        near(&margins["gain"][0]["value"], low.hypot(1.0) / 2.0);
        let crossover = 3.0_f64.sqrt();
        near(&margins["phase"][0]["frequency"], crossover);
        near(&margins["phase"][0]["value"], PI - crossover.atan() - crossover / 2.0);
        assert_eq!((&margins["stable"], &margins["growing"]), (&true.into(), &0.into()), "{cut}");
        assert_eq!((&way["dead_times"][0], &way["infinitely_many_poles"]), (&0.5.into(), &false.into()));
        near(&way["poles"][0]["pole"][0], -1.0);
    }
    let beyond = desk.json(&["dead.ron", "--set", "k=3.9", "--open", "gain.y"]);
    assert_eq!(beyond["ways"][0]["margins"]["growing"], 2);
    let text = desk.linearise(&["dead.ron", "--set", "k=3.9", "--open", "gain.y", "--no-plot"]);
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    assert!(
        text.contains("dead time 0.500 s, exact in the response") || text.contains("dead time 0.5 s, exact"),
        "{text}"
    );
    assert!(text.contains("not stable: 2 poles grow"), "{text}");
}

#[test]
fn a_closed_loop_around_a_dead_time_has_its_exact_response_and_infinitely_many_poles() {
    let desk = desk("closed");
    let output =
        desk.linearise(&["dead.ron", "--from", "demand.y", "--to", "late.y", "--csv", "t.csv", "--no-plot"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        text.contains("poles are infinitely many, as one of them feeds itself, and none grows"),
        "{text}"
    );
    let table = std::fs::read_to_string(desk.0.join("t.csv")).unwrap();
    assert!(table.lines().count() > 100);
    for line in table.lines().skip(1) {
        let cells: Vec<f64> = line.split(',').skip(1).map(|cell| cell.parse().unwrap()).collect();
        let (w, db) = (cells[0], cells[1]);
        // |e / (1 + j w + e)| with e = exp(-j w / 2); in front of it exp(-0.3 j w) turns alone.
        let (re, im) = (1.0 + (w / 2.0).cos(), w - (w / 2.0).sin());
        assert!((db + 20.0 * re.hypot(im).log10()).abs() < 1e-7, "{line}");
        let angle = -0.8 * w - im.atan2(re);
        let wrong = (angle - cells[2].to_radians()).sin().abs();
        assert!(wrong < 1e-7, "{line}");
    }
    let found = desk.json(&["dead.ron", "--from", "demand.y", "--to", "late.y"]);
    near(&found["ways"][0]["static_gain"], 0.5);
    assert!(found["ways"][0]["zeros"].is_null() && found["ways"][0]["step"].is_null());
}

#[test]
fn a_model_without_signals_has_its_poles_and_with_dead_times_the_number_of_those_that_grow() {
    let desk = desk("model");
    let lags = desk.json(&["lags.ron", "--set", "gain=8"]);
    // (s + 1)^3 = -8, and a lag of 5 s behind the sampled signal.
    let has = |re: f64, im: f64| {
        let poles = lags["poles"].as_array().unwrap();
        poles.iter().any(|p| (number(&p["pole"][0]) - re).hypot(number(&p["pole"][1]) - im) < 1e-6)
    };
    assert!(has(-3.0, 0.0) && has(0.0, 3.0_f64.sqrt()) && has(-0.2, 0.0), "{}", lags["poles"]);
    assert!(lags["from"].is_null() && lags["ways"].as_array().unwrap().is_empty());
    for (gain, last) in [("2", "stable\n"), ("9", "not stable: what has a negative damping grows\n")] {
        let text = desk.linearise(&["lags.ron", "--set", &format!("gain={gain}")]);
        let text = String::from_utf8_lossy(&text.stdout).into_owned();
        assert!(text.ends_with(last), "{text}");
    }
    for (gain, growing) in [("1", 0), ("3.8", 0), ("3.9", 2)] {
        let found = desk.json(&["dead.ron", "--set", &format!("k={gain}")]);
        assert_eq!(found["growing"], growing, "{gain}");
        assert_eq!(found["dead_times"][1]["path"], "late");
    }
    // An integrator that reads the loop stands at the border by itself, and the loop does what it does.
    let behind = DEAD.replace("\"scope\": Scope,", "\"scope\": Scope, \"angle\": Integrator,");
    let behind = behind.replace("\"lag.y -> late.u\"", "\"lag.y -> late.u, angle.u\"");
    std::fs::write(desk.0.join("behind.ron"), &behind).unwrap();
    for (gain, growing) in [("1", 0), ("3.9", 2)] {
        let found = desk.json(&["behind.ron", "--set", &format!("k={gain}")]);
        assert_eq!(
            (&found["growing"], &found["poles"][0]["pole"][0]),
            (&growing.into(), &0.0.into()),
            "{gain}"
        );
    }
    // A loop that is itself at the border: that is told, with all else. L = (pi / 2) exp(-s) / s.
    let border = r#"Diagram(simulation: (stop_time: "1 s"), blocks: { "gain": Gain(k: "-pi / 2 * 1 1/s"), "x": Integrator(x0: 1),
        "late": TransportDelay(delay: "1 s") }, connections: ["gain.y -> x.u", "x.y -> late.u", "late.y -> gain.u"])"#;
    std::fs::write(desk.0.join("border.ron"), border).unwrap();
    let text = desk.linearise(&["border.ron"]);
    let told = "whether any of them grows cannot be decided, as a pole lies on the border of stability";
    assert!(String::from_utf8_lossy(&text.stdout).contains(told), "{text:?}");
    std::fs::write(
        desk.0.join("none.ron"),
        r#"Diagram(simulation: (stop_time: "1 s"), blocks: { "one": Constant(value: 1), "scope": Scope },
            connections: ["one.y -> scope.u"])"#,
    )
    .unwrap();
    let none = desk.linearise(&["none.ron"]);
    assert_eq!(none.status.code(), Some(2));
    assert!(said(&none).contains("the model has no states, and so no poles"), "{}", said(&none));
    // A dead time that nothing leads back to adds no poles, and one that is a loop by itself has no others.
    let beside = r#"Diagram(simulation: (stop_time: "1 s"), blocks: { "lag": LowPass(tau: "1 s"), "late": TransportDelay(delay: "1 s"),
        "show": Scope, "one": Constant(value: 1) }, connections: ["one.y -> lag.u", "lag.y -> late.u", "late.y -> show.u"])"#;
    std::fs::write(desk.0.join("beside.ron"), beside).unwrap();
    let text = desk.linearise(&["beside.ron"]);
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    let told = "no loop leads through a dead time, which adds no poles: `late`";
    assert!(text.contains(told) && text.ends_with("stable\n"), "{text}");
    let alone = r#"Diagram(simulation: (stop_time: "1 s"), blocks: { "gain": Gain(k: -0.5), "late": TransportDelay(delay: "1 s") },
        connections: ["gain.y -> late.u", "late.y -> gain.u"])"#;
    std::fs::write(desk.0.join("alone.ron"), alone).unwrap();
    let text = desk.linearise(&["alone.ron"]);
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    assert!(
        text.ends_with("with dead times, `late`, there are infinitely many poles: none of them grows\n"),
        "{text}"
    );
}

/// `(s - 1) / (s + 1)` before `2 / (s - 1)`: the loop gain is that of a lag, and what it leaves out grows with `e^t`.
#[test]
fn a_pole_that_a_loop_does_not_see_is_named_if_it_grows() {
    let desk = Desk::new("unseen");
    for (c, expected) in [
        (
            "-1.0",
            "stable, but the model is not: a pole at 1.000, which the loop does not reach or does not see",
        ),
        ("3.0", "not stable: a pole at"),
    ] {
        let text = format!(
            r#"Diagram(simulation: (stop_time: "1 s"), blocks: {{ "r": Constant(value: 0.0), "e": Sum(signs: "+-"),
                "c": TransferFunction(num: [1.0, {c}], den: [1.0, 1.0]), "p": TransferFunction(num: [0.2], den: [1.0, -1.0]) }},
                connections: ["r.y -> e.u1", "p.y -> e.u2", "e.y -> c.u", "c.y -> p.u"])"#
        );
        std::fs::write(desk.0.join("unseen.ron"), text).unwrap();
        let found = desk.linearise(&["unseen.ron", "--no-plot", "--open", "e.y"]);
        let found = String::from_utf8_lossy(&found.stdout).into_owned();
        assert!(found.contains(expected), "{found}");
    }
}
