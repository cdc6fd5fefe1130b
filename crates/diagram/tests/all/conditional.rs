//! Conditional subsystems against closed forms over their switching times, and against a hand-written reference.

use crate::texts::{Run, checked, compiled, run};

/// A subsystem `sub` with the input `u`, time, and the output `y`, enabled by a sine of 1 Hz above 0.5: from 1/12 s to 5/12 s of each
/// second.
fn in_sine(solver: &str, parameters: &str, inside: &str, more: &str) -> Run {
    let model = format!(
        r#"Diagram(
            simulation: (stop_time: "2.25 s", solver: {solver}),
            blocks: {{
                "sine": Sine(amplitude: 1, frequency: "1 Hz"), "high": Compare(operator: Greater, constant: 0.5),
                "time": Clock, "sub": Subsystem(file: "sub.ron", {parameters}), "show": Scope(inputs: ["y"]),
            }},
            connections: ["sine.y -> high.u", "time.y -> sub.u", "sub.y -> show.y", {more}],
        )"#
    );
    run(&[("model.ron", &model), ("sub.ron", inside)])
}

const ENABLE: &str = "\"high.y -> sub.enable\"";
pub const INTEGRAL: &str = r#"Diagram(inputs: { "u": () }, outputs: { "y": "x.y" },
    blocks: { "x": Integrator(x0: 0) }, connections: ["in.u -> x.u"])"#;
pub const GAIN: &str = r#"Diagram(inputs: { "u": () }, outputs: { "y": "g.y" },
    blocks: { "g": Gain(k: 2) }, connections: ["in.u -> g.u"])"#;

const ON: f64 = 1.0 / 12.0;
const OFF: f64 = 5.0 / 12.0;

/// When the subsystem is enabled, up to a time: begin and end.
fn windows(t: f64) -> Vec<(f64, f64)> {
    (0..3).map(|k| (f64::from(k) + ON, (f64::from(k) + OFF).min(t))).filter(|(on, _)| *on < t).collect()
}

#[test]
fn states_stand_still_while_disabled_whatever_the_method() {
    let expected = |t: f64| -> f64 { windows(t).iter().map(|(on, off)| 0.5 * (off * off - on * on)).sum() };
    for solver in ["Auto", "Ode45", "Ode23", "Ode15s", "Radau5", "Rodas4", "Ode4(step: \"0.5 ms\")"] {
        let run = in_sine(solver, "enable: Held", INTEGRAL, ENABLE);
        let fixed = solver.contains("step");
        let slack = if fixed { 5e-3 } else { 2e-5 };
        for (t, y) in run.column("show.y") {
            assert!((y - expected(t)).abs() < slack, "{solver}: {y} at {t} s instead of {}", expected(t));
        }
        let enabled = run.times("sub is enabled");
        let slack = if fixed { 6e-4 } else { 1e-9 };
        assert_eq!(enabled.len(), 3, "{solver}: {:?}", run.events);
        enabled
            .iter()
            .enumerate()
            .for_each(|(k, t)| assert!((t - k as f64 - ON).abs() < slack, "{solver}: {t}"));
        assert_eq!(run.times("sub is disabled").len(), 2, "{solver}");
    }
}

#[test]
fn states_that_are_reset_begin_anew_and_outputs_hold_meanwhile() {
    let run = in_sine("Ode45", "enable: Reset", INTEGRAL, ENABLE);
    let of = |t: f64| {
        let (on, off) = *windows(t).last()?;
        Some(0.5 * (off * off - on * on))
    };
    for (t, y) in run.column("show.y") {
        // Behind an instant, or just before it.
        let near = [t - 1e-9, t + 1e-9].map(|t| of(t).unwrap_or(0.0));
        assert!(near.iter().any(|expected| (y - expected).abs() < 2e-6), "{y} at {t} s instead of {near:?}");
    }
}

/// A counter that each edge resets which it would count stands at 0 always, and so does what is triggered and reset at once at its initial
/// value: what is reset by an edge of such a signal is never reset.
#[test]
fn nothing_acts_on_what_was_there_before_a_reset() {
    let count = r#"Diagram(inputs: { "u": () }, outputs: { "y": "c.count" }, blocks: { "c": Counter }, connections: ["in.u -> c.u"])"#;
    let delay = r#"Diagram(inputs: { "u": () }, outputs: { "y": "d.y" },
        blocks: { "d": UnitDelay(ts: "1 s", x0: -2) }, connections: ["in.u -> d.u"])"#;
    let cases = [
        (count, "reset: Rising", r#""on.y -> sub.u, sub.reset""#, 0.0),
        (
            delay,
            "trigger: Rising, reset: Rising",
            r#""two.y -> sub.u", "on.y -> sub.trigger, sub.reset""#,
            -2.0,
        ),
    ];
    for (inside, parameters, connections, stays) in cases {
        let model = format!(
            r#"Diagram(
                simulation: (stop_time: "4.5 s"),
                blocks: {{
                    "pulse": Pulse(period: "1 s", width: 0.5, delay: "1 s"), "on": Compare(operator: Greater, constant: 0.5),
                    "one": Constant(value: 1), "two": Constant(value: 2), "sub": Subsystem(file: "sub.ron", {parameters}),
                    "integral": Subsystem(file: "integral.ron", reset: Rising), "plain": Integrator(reset: Rising),
                    "show": Scope(inputs: ["y", "integral", "plain"]),
                }},
                connections: [
                    "pulse.y -> on.u", "sub.y -> integral.reset, plain.reset, show.y", "one.y -> integral.u, plain.u",
                    "integral.y -> show.integral", "plain.y -> show.plain", {connections},
                ],
            )"#
        );
        let run = run(&[("model.ron", &model), ("sub.ron", inside), ("integral.ron", INTEGRAL)]);
        assert!(run.column("show.y").iter().all(|(_, y)| *y == stays));
        for integral in ["show.integral", "show.plain"] {
            assert!((run.last(integral) - 4.5).abs() < 1e-9, "{integral}: {}", run.last(integral));
        }
        assert!(run.times("integral is reset").is_empty(), "{:?}", run.events);
    }
}

/// Both conditions of a subsystem change at one instant: from outside, or because other blocks are reset then. A reset while it is disabled
/// does not count.
#[test]
fn what_is_reset_changes_all_at_once() {
    let inner = r#"Diagram(inputs: { "u": () }, outputs: { "y": "relay.y" },
        blocks: { "relay": Relay(on_at: 1, off_at: -1, on: 2, off: -1) }, connections: ["in.u -> relay.u"])"#;
    let outer = r#"Diagram(inputs: { "u": (), "no": () }, outputs: { "count": "count.count", "on": "inner.y" },
        blocks: { "count": Counter, "inner": Subsystem(file: "inner.ron", reset: Rising) },
        connections: ["in.u -> count.u", "count.count -> inner.u", "in.no -> inner.reset"])"#;
    let model = r#"Diagram(
        simulation: (stop_time: "5 s"),
        blocks: {
            "late": Step(time: "3.5 s"), "pulse": Pulse(period: "1 s", width: 0.5, delay: "1 s"), "no": Constant(value: false),
            "one": Constant(value: 1), "outer": Subsystem(file: "outer.ron", reset: Rising),
            "sub": Subsystem(file: "integral.ron", enable: Held, reset: Falling), "show": Scope(inputs: ["y"]),
        },
        connections: [
            "late.y -> outer.reset", "pulse.y -> outer.u", "no.y -> outer.no", "outer.count -> sub.reset", "outer.on -> sub.enable",
            "one.y -> sub.u", "sub.y -> show.y",
        ],
    )"#;
    let files =
        [("model.ron", model), ("outer.ron", outer), ("inner.ron", inner), ("integral.ron", INTEGRAL)];
    let run = run(&files);
    // Enabled from the first pulse at 1 s to the reset at 3.5 s, and from the pulse at 4 s.
    assert!((run.last("show.y") - 3.5).abs() < 1e-9, "{}", run.last("show.y"));
    assert!(run.times("sub is reset").is_empty(), "{:?}", run.events);
}

/// What has no direct feedthrough closes a loop also where its subsystem may pause or be reset.
#[test]
fn a_loop_through_a_state_is_no_algebraic_loop_in_a_conditional_subsystem() {
    for block in [
        r#"UnitDelay(ts: "0.1 s", x0: 1)"#,
        r#"FirstOrderHold(ts: "0.1 s", x0: 1)"#,
        r#"Delay(ts: "0.1 s", steps: 70, x0: 1)"#,
        "Memory(x0: 1)",
        "LowPass(tau: \"1 s\", y0: 1)",
    ] {
        for (parameters, gates) in [
            ("enable: Held", "enable"),
            ("reset: Rising", "reset"),
            ("enable: Reset, reset: Rising", "enable, sub.reset"),
        ] {
            let inside = format!(
                r#"Diagram(inputs: {{ "u": () }}, outputs: {{ "y": "state.y" }}, blocks: {{ "state": {block} }}, connections: ["in.u -> state.u"])"#
            );
            let model = format!(
                r#"Diagram(
                    simulation: (stop_time: "1 s", algebraic_loops: Refuse),
                    blocks: {{
                        "sub": Subsystem(file: "sub.ron", {parameters}), "back": Gain(k: -0.5), "on": Constant(value: true),
                        "show": Scope(inputs: ["y"]),
                    }},
                    connections: ["on.y -> sub.{gates}", "sub.y -> back.u, show.y", "back.y -> sub.u"],
                )"#
            );
            let run = run(&[("model.ron", &model), ("sub.ron", &inside)]);
            assert_eq!(run.column("show.y")[0].1, 1.0, "{block}, {parameters}");
        }
    }
}

/// Its input is true from 1 s to 1.3 s, and from 3.5 s; it sees 0.2 s of the first time, is disabled until 4 s, and sees the second from
/// there.
#[test]
fn what_waits_stops_with_its_subsystem() {
    let inside = r#"Diagram(inputs: { "u": () }, outputs: { "y": "late.y" },
        blocks: { "late": OnOffDelay(on: "1 s") }, connections: ["in.u -> late.u"])"#;
    let model = r#"Diagram(
        simulation: (stop_time: "6 s"),
        blocks: {
            "u": SignalBuilder(points: [(0, 0), ("1 s", 1), ("1.3 s", 0), ("3.5 s", 1)], interpolation: Hold),
            "on": Compare(operator: Greater, constant: 0.5), "show": Scope(inputs: ["y"]),
            "enable": SignalBuilder(points: [(0, 1), ("1.2 s", 0), ("4 s", 1)], interpolation: Hold),
            "sub": Subsystem(file: "sub.ron", enable: Held),
        },
        connections: ["u.y -> on.u", "on.y -> sub.u", "enable.y -> sub.enable", "sub.y -> show.y"],
    )"#;
    let run = run(&[("model.ron", model), ("sub.ron", inside)]);
    let times = run.times("sub/late switches on");
    assert!(times.len() == 1 && (times[0] - 4.8).abs() < 1e-9, "{:?}", run.events);
    for (t, y) in run.column("show.y") {
        assert!((t - 4.8).abs() < 1e-9 || y == f64::from(t > 4.8), "{y} at {t} s");
    }
}

/// A line from 0 to 0.25 begins at 0.25 s, stands from 5/12 s to 13/12 s, and ends at 7/6 s; the next one begins at 1.25 s.
#[test]
fn a_line_between_samples_stops_with_its_subsystem() {
    let inside = r#"Diagram(inputs: { "u": () }, outputs: { "y": "hold.y" },
        blocks: { "hold": FirstOrderHold(ts: "0.25 s") }, connections: ["in.u -> hold.u"])"#;
    for solver in ["Ode45", "Auto", "Ode4(step: \"1 ms\")"] {
        let run = in_sine(solver, "enable: Held", inside, ENABLE);
        for (t, y) in run.column("show.y") {
            let ran: f64 = windows(t).iter().map(|(on, off)| off - on).sum::<f64>() - (0.25 - ON);
            let expected = match t {
                ..1.25 => ran.clamp(0.0, 0.25),
                ..1.5 => 0.25 + ((t - 1.25) / 0.25).min((OFF - 0.25) / 0.25),
                _ => continue,
            };
            assert!((y - expected).abs() < 5e-3, "{solver}: {y} at {t} s instead of {expected}");
        }
    }
}

#[test]
fn an_output_holds_what_it_was_at_the_very_time_of_disabling() {
    for (solver, slack) in [("Ode45", 1e-9), ("Ode4(step: \"1 ms\")", 2.1e-3)] {
        let run = in_sine(solver, "enable: Held", GAIN, ENABLE);
        for (t, y) in run.column("show.y") {
            let phase = t.fract();
            if !(ON - 2e-3..=OFF + 2e-3).contains(&phase) {
                let held = if t < ON { 0.0 } else { 2.0 * (windows(t).len() as f64 - 1.0 + OFF) };
                assert!((y - held).abs() < slack, "{solver}: {y} at {t} s instead of {held}");
            } else if phase > ON + 2e-3 && phase < OFF - 2e-3 {
                assert!((y - 2.0 * t).abs() < 1e-12, "{solver}: {y} at {t} s");
            }
        }
    }
}

#[test]
fn an_output_has_its_own_value_while_disabled() {
    let passing = r#"Diagram(inputs: { "u": () }, outputs: { "y": "in.u" }, blocks: { }, connections: [])"#;
    for inside in [GAIN, passing] {
        let factor = if inside == GAIN { 2.0 } else { 1.0 };
        let run = in_sine("Ode45", "enable: Held, when_disabled: { \"y\": -7 }", inside, ENABLE);
        for (t, y) in run.column("show.y") {
            let phase = t.fract();
            let expected = if (ON..OFF).contains(&phase) { factor * t } else { -7.0 };
            let edge = (phase - ON).abs() < 1e-9 || (phase - OFF).abs() < 1e-9;
            assert!(edge || (y - expected).abs() < 1e-12, "{y} at {t} s instead of {expected}");
        }
        // What leads through is held as well.
        let held = in_sine("Ode45", "enable: Held", inside, ENABLE);
        let (_, y) = held.column("show.y").into_iter().rfind(|(t, _)| *t < 2.0).expect("a row");
        assert!((y - factor * (1.0 + OFF)).abs() < 1e-9, "{y}");
    }
}

#[test]
fn a_real_signal_enables_where_it_is_positive() {
    let run = in_sine("Ode45", "enable: Held", INTEGRAL, "\"sine.y -> sub.enable\"");
    // Above zero for the first half of each second.
    let expected = 0.5 * (0.25 + (2.25 - 1.0) + (2.25_f64.powi(2) - 4.0));
    assert!((run.last("show.y") - expected).abs() < 1e-6, "{} instead of {expected}", run.last("show.y"));
}

/// Counts the sample hits inside, and sums its input, by hand.
#[test]
fn a_sample_hit_at_the_time_of_enabling_counts_and_one_at_disabling_does_not() {
    let inside = r#"Diagram(inputs: { "u": () }, outputs: { "y": "z.y", "s": "s.y" },
        blocks: { "z": UnitDelay(ts: "0.1 s"), "s": Sum(signs: "++"), "one": Constant(value: 1) },
        connections: ["z.y -> s.u1", "one.y -> s.u2", "s.y -> z.u"])"#;
    for solver in ["Ode45", "Ode4(step: \"50 ms\")"] {
        for (states, kept) in [("Held", true), ("Reset", false)] {
            let model = format!(
                r#"Diagram(
                    simulation: (stop_time: "2 s", solver: {solver}),
                    blocks: {{ "on": Pulse(period: "1 s", width: 0.5, delay: "0.2 s"), "half": Constant(value: 0.5),
                        "sub": Subsystem(file: "sub.ron", enable: {states}), "show": Scope(inputs: ["y", "s"]),
                        "u": Constant(value: 0) }},
                    connections: ["on.y -> sub.enable", "u.y -> sub.u", "sub.y -> show.y", "sub.s -> show.s"],
                )"#
            )
            .replace("\"half\": Constant(value: 0.5),", "");
            let run = run(&[("model.ron", &model), ("sub.ron", inside)]);
            // Enabled from 0.2 s to 0.7 s and from 1.2 s to 1.7 s: hits 2 to 6 and 12 to 16.
            let (mut state, mut shown, mut was) = (0.0, 0.0, false);
            let mut expected = Vec::new();
            for k in 0..=20 {
                let enabled = (2..7).contains(&k) || (12..17).contains(&k);
                if was && !enabled && !kept {
                    state = 0.0;
                }
                if enabled {
                    shown = state;
                    state += 1.0;
                }
                was = enabled;
                expected.push(shown);
            }
            for (k, expected) in expected.into_iter().enumerate() {
                let t = k as f64 * 0.1;
                let rows = run.column("show.y");
                let (_, y) = rows.iter().rfind(|(time, _)| *time <= t + 1e-9).expect("a row");
                assert_eq!(*y, expected, "{solver} {states} at {t} s: {rows:?}");
            }
        }
    }
}

#[test]
fn a_triggered_subsystem_runs_at_edges_alone() {
    let inside = r#"Diagram(inputs: { "u": () }, outputs: { "y": "g.y", "n": "n.y" },
        blocks: { "g": Gain(k: 1), "n": UnitDelay(ts: "1 s", x0: 1), "more": Sum(signs: "++"), "one": Constant(value: 1) },
        connections: ["in.u -> g.u", "n.y -> more.u1", "one.y -> more.u2", "more.y -> n.u"])"#;
    for (edge, times) in [
        ("Rising", vec![ON, 1.0 + ON, 2.0 + ON]),
        ("Falling", vec![OFF, 1.0 + OFF]),
        ("Either", vec![ON, OFF, 1.0 + ON, 1.0 + OFF, 2.0 + ON]),
    ] {
        let more = "\"high.y -> sub.trigger\", \"sub.n -> count.u\"";
        let model = format!(
            r#"Diagram(
                simulation: (stop_time: "2.25 s", solver: Ode45),
                blocks: {{
                    "sine": Sine(amplitude: 1, frequency: "1 Hz"), "high": Compare(operator: Greater, constant: 0.5),
                    "time": Clock, "sub": Subsystem(file: "sub.ron", trigger: {edge}), "show": Scope(inputs: ["y", "n"]),
                }},
                connections: ["sine.y -> high.u", "time.y -> sub.u", "sub.y -> show.y", "sub.n -> show.n", {more}],
            )"#
        )
        .replace(", \"sub.n -> count.u\"", "");
        let run = run(&[("model.ron", &model), ("sub.ron", inside)]);
        let n = times.len();
        assert!((run.last("show.y") - times[n - 1]).abs() < 1e-9, "{edge}: {}", run.last("show.y"));
        assert_eq!(run.last("show.n"), n as f64, "{edge}");
        assert_eq!(run.times("sub is triggered").len(), n, "{edge}: {:?}", run.events);
        for (t, y) in run.column("show.y") {
            let before = times.iter().rfind(|time| **time < t - 1e-9).copied().unwrap_or(0.0);
            let at = times.iter().find(|time| (**time - t).abs() <= 1e-9).copied().unwrap_or(before);
            assert!((y - before).abs() < 1e-9 || (y - at).abs() < 1e-9, "{edge}: {y} at {t} s");
        }
    }
}

#[test]
fn what_a_triggered_block_gives_stands_still_from_the_very_time_of_the_trigger() {
    // The trigger comes from a signal of time, so that the derivative is evaluated anew right behind it.
    let inside = r#"Diagram(inputs: { "u": () }, outputs: { "y": "sum.y" },
        blocks: { "sum": DiscreteIntegrator(ts: "1 s", x0: 1) }, connections: ["in.u -> sum.u"])"#;
    for (solver, slack) in [("Ode45", 1e-12), ("Ode4(step: \"0.05 s\")", 1e-12), ("Ode15s", 1e-9)] {
        let model = format!(
            r#"Diagram(
                simulation: (stop_time: "2 s", solver: {solver}),
                blocks: {{
                    "edges": SignalBuilder(points: [(0, 0), ("0.5 s", 1), ("0.75 s", 0), ("1.5 s", 1)], interpolation: Hold),
                    "one": Constant(value: 1), "sub": Subsystem(file: "sub.ron", trigger: Rising),
                    "x": Integrator, "show": Scope(inputs: ["x"]),
                }},
                connections: ["edges.y -> sub.trigger", "one.y -> sub.u", "sub.y -> x.u", "x.y -> show.x"],
            )"#
        );
        let run = run(&[("model.ron", &model), ("sub.ron", inside)]);
        // It is 1 up to the second trigger, at which it becomes 2.
        let (x, expected) = (run.last("show.x"), 1.5 + 2.0 * 0.5);
        assert!((x - expected).abs() < slack, "{solver}: {x} instead of {expected}");
    }
}

#[test]
fn numbers_without_units_are_no_obstacle_to_a_block_inside() {
    // A proportional and an integral part have units that differ, unless the gains are left open.
    let inside = r#"Diagram(inputs: { "e": () }, outputs: { "u": "u.y", "most": "most.y" },
        blocks: { "kp": Gain(k: 2), "ki": Gain(k: 3), "i": Integrator, "u": Sum(signs: "++"), "most": MinMax(function: Max) },
        connections: ["in.e -> kp.u, ki.u", "ki.y -> i.u", "kp.y -> u.u1, most.u1", "i.y -> u.u2, most.u2"])"#;
    for (parameters, input) in
        [("enable: Held", "enable"), ("enable: Reset", "enable"), ("reset: Rising", "reset")]
    {
        let model = format!(
            r#"Diagram(
                simulation: (stop_time: "1 s"),
                blocks: {{
                    "e": Constant(value: 1), "on": Constant(value: true), "pi": Subsystem(file: "pi.ron", {parameters}),
                    "show": Scope(inputs: ["u", "most"]),
                }},
                connections: ["e.y -> pi.e", "on.y -> pi.{input}", "pi.u -> show.u", "pi.most -> show.most"],
            )"#
        );
        let run = run(&[("model.ron", &model), ("pi.ron", inside)]);
        for (name, of) in
            [("show.u", (|t| 2.0 + 3.0 * t) as fn(f64) -> f64), ("show.most", |t| (3.0 * t).max(2.0))]
        {
            for (t, y) in run.column(name) {
                assert!(
                    (y - of(t)).abs() < 1e-9,
                    "{parameters}: {name} is {y} at {t} s instead of {}",
                    of(t)
                );
            }
        }
    }
}

#[test]
fn states_are_reset_at_an_edge() {
    let run = in_sine("Ode45", "reset: Falling", INTEGRAL, "\"high.y -> sub.reset\"");
    let expected = |t: f64| {
        let from = [0.0, OFF, 1.0 + OFF].into_iter().rfind(|from| *from <= t).unwrap_or(0.0);
        0.5 * (t * t - from * from)
    };
    for (t, y) in run.column("show.y") {
        let near = [expected(t - 1e-9), expected(t + 1e-9)];
        assert!(near.iter().any(|expected| (y - expected).abs() < 2e-6), "{y} at {t} s instead of {near:?}");
    }
    assert_eq!(run.times("sub is reset").len(), 2, "{:?}", run.events);
}

#[test]
fn what_is_within_a_disabled_subsystem_is_disabled_with_it() {
    let outer = r#"Diagram(inputs: { "u": (), "fine": () }, outputs: { "y": "deep.y" },
        blocks: { "deep": Subsystem(file: "sub.ron", enable: Held) },
        connections: ["in.u -> deep.u", "in.fine -> deep.enable"])"#;
    let model = r#"Diagram(
        simulation: (stop_time: "4 s", solver: Ode45),
        blocks: {
            "one": Constant(value: 1), "slow": Pulse(period: "2 s", width: 0.5), "fast": Pulse(period: "0.4 s", width: 0.5, delay: "0.1 s"),
            "sub": Subsystem(file: "outer.ron", enable: Held), "show": Scope(inputs: ["y"]),
        },
        connections: ["one.y -> sub.u", "slow.y -> sub.enable", "fast.y -> sub.fine", "sub.y -> show.y"],
    )"#;
    let run = run(&[("model.ron", model), ("outer.ron", outer), ("sub.ron", INTEGRAL)]);
    // Both are on within the first and the third second; the fast one from 0.1 s, 0.5 s ... on for 0.2 s.
    let expected = |t: f64| -> f64 {
        let ons = (0..10).map(|k| 0.1 + 0.4 * f64::from(k));
        let share = |from: f64, to: f64, (a, b): (f64, f64)| (to.min(b).min(t) - from.max(a)).max(0.0);
        ons.map(|on| share(on, on + 0.2, (0.0, 1.0)) + share(on, on + 0.2, (2.0, 3.0))).sum()
    };
    for (t, y) in run.column("show.y") {
        assert!((y - expected(t)).abs() < 1e-9, "{y} at {t} s instead of {}", expected(t));
    }
}

/// The output of a state needs not know whether the subsystem is enabled, so this is no algebraic loop.
#[test]
fn a_state_may_end_what_it_runs_in() {
    let model = r#"Diagram(
        simulation: (stop_time: "3 s", solver: Ode45),
        blocks: { "one": Constant(value: 1), "below": Compare(operator: Less, constant: 0.75),
            "sub": Subsystem(file: "sub.ron", enable: Held), "show": Scope(inputs: ["y"]) },
        connections: ["one.y -> sub.u", "sub.y -> below.u, show.y", "below.y -> sub.enable"],
    )"#;
    let run = run(&[("model.ron", model), ("sub.ron", INTEGRAL)]);
    assert!((run.last("show.y") - 0.75).abs() < 1e-9, "{}", run.last("show.y"));
    assert!((run.times("sub is disabled")[0] - 0.75).abs() < 1e-9);
}

/// Nothing of a subsystem that never runs is evaluated, its events do not happen, and its outputs are those of the start.
#[test]
fn a_subsystem_that_never_runs_shows_what_it_begins_with() {
    let inside = r#"Diagram(inputs: { "u": () }, outputs: { "y": "x.y", "q": "d.y", "n": "z.y" },
        blocks: { "x": Integrator(x0: 3), "d": Divide, "zero": Constant(value: 0),
            "z": UnitDelay(ts: "0.1 s", x0: 5), "end": Assertion(message: "never"), "above": Compare(operator: Greater, constant: 10) },
        connections: ["in.u -> x.u, d.u1, above.u, z.u", "zero.y -> d.u2", "above.y -> end.ok"])"#;
    let model = r#"Diagram(
        simulation: (stop_time: "1 s", solver: Ode45),
        blocks: { "one": Constant(value: 1), "never": Constant(value: 0),
            "sub": Subsystem(file: "sub.ron", enable: STATES), "show": Scope(inputs: ["y", "q", "n"]) },
        connections: ["one.y -> sub.u", "never.y -> sub.enable", "sub.y -> show.y", "sub.q -> show.q", "sub.n -> show.n"],
    )"#;
    for states in ["Held", "Reset"] {
        let run = run(&[("model.ron", &model.replace("STATES", states)), ("sub.ron", inside)]);
        assert!(run.events.is_empty(), "{:?}", run.events);
        for (column, expected) in [("show.y", 3.0), ("show.q", 0.0), ("show.n", 5.0)] {
            assert!(run.column(column).iter().all(|(_, value)| *value == expected), "{states}: {column}");
        }
    }
}

/// Modes, memories, limits, time events, sampled and vector blocks are what they are without a condition, if that always holds.
#[test]
fn a_condition_that_always_holds_changes_nothing() {
    let inside = r#"Diagram(inputs: { "u": () }, outputs: { "y": "all.y" },
        blocks: {
            "pid": Pid(kp: 2, ki: 3, kd: 0.1, n: 50, lower: -0.8, upper: 0.8), "limited": RateLimiter(rising: 2, falling: -2),
            "play": Backlash(width: 0.3), "relay": Relay(on_at: 0.4, off_at: -0.4), "pulse": Pulse(period: "0.37 s", width: 0.4),
            "step": Step(time: "1.1 s", after: 0.5), "hits": HitCrossing(at: 0.2), "count": Gain(k: 1),
            "sampled": DiscreteIntegrator(ts: "0.05 s"), "held": ZeroOrderHold(ts: "0.03 s"),
            "reset": Integrator(x0: 0.1, reset: Rising), "sine": Sine(frequency: "1.3 Hz"), "error": Sum(signs: "+-"),
            "some": Mux(inputs: 2), "twice": Gain(k: 2), "lag": LowPass(tau: "0.2 s"), "rate": Gain(k: 1),
            "off": HitCrossing(at: 0.5, direction: Falling),
            "all": Mux(inputs: 9),
        },
        connections: [
            "in.u -> error.u1, limited.u, play.u, relay.u, hits.u, held.u, sampled.u, off.u", "lag.y -> error.u2", "error.y -> pid.e",
            "pid.u -> lag.u, all.u1", "limited.y -> all.u2", "play.y -> all.u3", "relay.y -> all.u4",
            "hits.count -> count.u", "count.y -> all.u5", "sampled.y -> all.u6", "held.y -> all.u7",
            "pulse.y -> reset.reset", "step.y -> rate.u", "rate.y -> reset.u", "reset.y -> all.u8",
            "sine.y -> some.u1", "in.u -> some.u2", "some.y -> twice.u", "twice.y -> pick.u", "pick.y -> all.u9",
        ],
    )"#
    .replace("\"twice\": Gain", "\"pick\": Selector(indices: [0]), \"twice\": Gain");
    for solver in ["Ode45", "Ode15s", "Ode4(step: \"5 ms\")"] {
        let with = |parameters: &str| {
            let more = if parameters.is_empty() { "" } else { ", \"yes.y -> sub.enable\"" };
            let model = format!(
                r#"Diagram(
                    simulation: (stop_time: "3 s", solver: {solver}),
                    blocks: {{ "u": Sine(frequency: "0.7 Hz"), "yes": Constant(value: 1), "end": Terminator,
                        "sub": Subsystem(file: "sub.ron" {parameters}), "show": Scope(inputs: ["y"]) }},
                    connections: ["u.y -> sub.u", "sub.y -> show.y", "yes.y -> end.u" {more}],
                )"#
            );
            run(&[("model.ron", &model), ("sub.ron", &inside)])
        };
        let plain = with("");
        for parameters in [", enable: Held", ", enable: Reset"] {
            let run = with(parameters);
            assert_eq!(
                plain.events.len(),
                run.events.len(),
                "{solver}{parameters}: {:?}\n{:?}",
                plain.events,
                run.events
            );
            for (i, (end, other)) in
                plain.rows.last().expect("rows").1.iter().zip(&run.rows.last().expect("rows").1).enumerate()
            {
                assert!(
                    (end - other).abs() < 2e-4,
                    "{solver}{parameters}: element {i} is {other} instead of {end}"
                );
            }
        }
    }
}

/// A limiter of the rate has not moved while it was disabled, and begins anew where it is reset: what has passed meanwhile does not count.
#[test]
fn a_rate_limiter_does_not_catch_up() {
    let inside = r#"Diagram(inputs: { "u": () }, outputs: { "y": "r.y" },
        blocks: { "r": RateLimiter(rising: 1, falling: -1) }, connections: ["in.u -> r.u"])"#;
    for solver in ["Ode45", "Ode4(step: \"10 ms\")"] {
        for (parameters, input, expected) in [
            ("enable: Held", "enable", [0.5, 0.5, 0.75, 1.0, 1.25]),
            ("enable: Reset", "enable", [0.5, 0.5, 0.25, 0.5, 0.25]),
            ("reset: Rising", "reset", [0.5, 1.0, 0.25, 1.0, 0.25]),
        ] {
            // On from 0 s to 0.5 s, from 1 s to 1.5 s, and from 2 s.
            let model = format!(
                r#"Diagram(
                    simulation: (stop_time: "2.25 s", solver: {solver}),
                    blocks: {{ "u": Constant(value: 9), "on": Pulse(period: "1 s", width: 0.5),
                        "sub": Subsystem(file: "sub.ron", {parameters}), "show": Scope(inputs: ["y"]) }},
                    connections: ["u.y -> sub.u", "on.y -> sub.{input}", "sub.y -> show.y"],
                )"#
            );
            let run = run(&[("model.ron", &model), ("sub.ron", inside)]);
            let rows = run.column("show.y");
            for (t, expected) in [0.5, 1.0 - 1e-9, 1.25, 2.0 - 1e-9, 2.25].into_iter().zip(expected) {
                let after = rows.partition_point(|(time, _)| *time < t).min(rows.len() - 1);
                let [(t0, y0), (t1, y1)] = [rows[after - 1], rows[after]];
                let y = if t1 > t0 { y0 + (y1 - y0) * (t - t0) / (t1 - t0) } else { y1 };
                assert!(
                    (y - expected).abs() < 1e-6,
                    "{solver} {parameters}: {y} at {t} s instead of {expected}"
                );
            }
        }
    }
}

/// The subsystem within runs at the triggers of its own that come while the one around is enabled.
#[test]
fn a_trigger_counts_while_the_subsystem_around_is_enabled() {
    let inner = r#"Diagram(inputs: { "u": () }, outputs: { "n": "n.y" },
        blocks: { "n": UnitDelay(ts: "1 s", x0: 1), "more": Sum(signs: "++"), "one": Constant(value: 1), "e": Terminator },
        connections: ["in.u -> e.u", "n.y -> more.u1", "one.y -> more.u2", "more.y -> n.u"])"#;
    let outer = r#"Diagram(inputs: { "u": (), "edge": () }, outputs: { "n": "deep.n", "set": "deep.n" },
        blocks: { "deep": Subsystem(file: "inner.ron", trigger: Rising) },
        connections: ["in.u -> deep.u", "in.edge -> deep.trigger"])"#;
    for (states, counted) in [("Held", [4.0, 8.0]), ("Reset", [4.0, 4.0])] {
        // On from 0 s to 1.05 s and from 2 s to 3.05 s; edges at 0.1 s, 0.35 s, 0.6 s ...
        let model = format!(
            r#"Diagram(
                simulation: (stop_time: "4 s", solver: Ode45),
                blocks: {{ "u": Clock, "on": Pulse(period: "2 s", width: 0.525),
                    "edge": Pulse(period: "0.25 s", width: 0.5, delay: "0.1 s"),
                    "sub": Subsystem(file: "outer.ron", enable: {states}, when_disabled: {{ "set": -1 }}),
                    "show": Scope(inputs: ["n", "set"]) }},
                connections: ["u.y -> sub.u", "on.y -> sub.enable", "edge.y -> sub.edge", "sub.n -> show.n", "sub.set -> show.set"],
            )"#
        );
        let run = run(&[("model.ron", &model), ("outer.ron", outer), ("inner.ron", inner)]);
        let value =
            |name: &str, t: f64| run.column(name).into_iter().rfind(|(time, _)| *time <= t).expect("a row").1;
        assert_eq!([value("show.n", 1.9), value("show.n", 3.9)], counted, "{states}");
        assert_eq!([value("show.set", 1.9), value("show.set", 3.9)], [-1.0; 2], "{states}");
        assert_eq!(value("show.set", 0.99), 4.0, "{states}");
    }
}

/// An output that leads at the same instant to whether it is computed has no value; that is said, and not guessed.
#[test]
fn an_output_that_decides_whether_it_is_computed_is_an_algebraic_loop() {
    let model = r#"Diagram(
        simulation: (stop_time: "1 s"),
        blocks: { "u": Clock, "below": Compare(operator: Less, constant: 0.75),
            "sub": Subsystem(file: "sub.ron", enable: Held), "show": Scope(inputs: ["y"]) },
        connections: ["u.y -> sub.u", "sub.y -> below.u, show.y", "below.y -> sub.enable"],
    )"#;
    let problems = checked(&[("model.ron", model), ("sub.ron", GAIN)]).problems;
    assert!(problems.iter().any(|problem| problem.code == "algebraic_loop"), "{problems:?}");
}

#[test]
fn what_cannot_stand_still_is_refused_with_a_remedy() {
    let model = |parameters: &str, more: &str| {
        format!(
            r#"Diagram(simulation: (stop_time: "1 s"),
                blocks: {{ "u": Constant(value: 1), "sub": Subsystem(file: "sub.ron", {parameters}), "end": Terminator }},
                connections: ["u.y -> sub.u", "sub.y -> end.u", {more}])"#
        )
    };
    let refused = |parameters: &str, more: &str, inside: &str| {
        let model = model(parameters, more);
        match compiled(&[("model.ron", &model), ("sub.ron", inside)]) {
            Ok(_) => panic!("{parameters} with {inside} is compiled"),
            Err(problems) => problems,
        }
    };
    let (enabled, triggered) = ("\"u.y -> sub.enable\"", "\"u.y -> sub.trigger\"");
    let delay = r#"Diagram(inputs: { "u": () }, outputs: { "y": "d.y" },
        blocks: { "d": TransportDelay(delay: "0.1 s") }, connections: ["in.u -> d.u"])"#;
    let circuit = r#"Diagram(inputs: { "u": (unit: "V") }, outputs: { "y": "i.i" },
        blocks: { "s": ControlledVoltageSource, "r": Resistor(r: "1 ohm"), "i": CurrentSensor, "g": ElectricalReference },
        connections: ["in.u -> s.v", "s.p <-> i.p", "i.n <-> r.p", "r.n <-> s.n <-> g.p"])"#;
    let bus = r#"Diagram(inputs: { "u": () }, outputs: { "y": "b.y" },
        blocks: { "b": BusCreator(elements: ["a"]) }, connections: ["in.u -> b.a"])"#;
    let declared = r#"Diagram(inputs: { "u": (), "enable": () }, outputs: { "y": "in.u" }, blocks: { }, connections: [])"#;
    for (parameters, more, inside, expected) in [
        ("enable: Held", enabled, delay, "conditional: in `sub/d`: it remembers a signal over time"),
        ("enable: Held", enabled, circuit, "belongs to a physical network"),
        (
            "trigger: Rising",
            triggered,
            INTEGRAL,
            "has continuous states, which do not change at the instants of a trigger",
        ),
        ("enable: Held", enabled, bus, "element `a` of output `y` comes from outside"),
        ("enable: Held", enabled, declared, "two inputs `enable`"),
        ("enable: Hold", enabled, GAIN, "did you mean `Held`?"),
        ("enable: 3", enabled, GAIN, "`enable` is one of"),
        ("enable: Held", "", GAIN, "`sub.enable` is not connected"),
        ("when_disabled: { \"y\": 0 }", "", GAIN, "needs `enable`"),
        ("enable: Held, when_disabled: { \"z\": 0 }", enabled, GAIN, "no output `z`"),
        (
            "enable: Held, when_disabled: { \"y\": \"1 V\" }",
            enabled,
            r#"Diagram(inputs: { "u": () }, outputs: { "y": "g.y" },
            blocks: { "g": Constant(value: "2 A") , "e": Terminator }, connections: ["in.u -> e.u"])"#,
            "unit_mismatch",
        ),
    ] {
        let problems = refused(parameters, more, inside);
        assert!(problems.contains(expected), "{parameters}: {problems}");
    }
}
