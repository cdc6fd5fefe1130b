//! Changes of conditions that hide each other, and those at the very end of a run.

use blocksim_tests::{METHODS, compile_text, run_audited, run_text};

/// A limited rate that catches up in the step in which a play touches its flank without leaving it. Its crossing was passed over five
/// times, and the output ran past its input.
#[test]
fn a_rate_catches_up_while_a_play_touches_its_flank() {
    let text = r#"Diagram(
        simulation: (stop_time: "5 s"),
        blocks: {
            "swing": Sine(amplitude: 0.946, frequency: "6.05 Hz", phase: "2.91 rad", bias: 0.284),
            "other": Sine(amplitude: 0.679, frequency: "7.61 Hz", phase: "2.04 rad", bias: 0.204),
            "pulse": Pulse(amplitude: 2.43, period: "0.236 s", width: 0.523),
            "least": MinMax(function: Min),
            "limit": RateLimiter(rising: 14.7, falling: -15.2),
            "rate": Gain(k: "1 1/s"),
            "sum": Integrator(x0: 0.729),
            "switch": Switch,
            "high": Compare(operator: Greater, constant: -0.106),
            "play": Backlash(width: 1.37),
            "show": Scope(inputs: ["u", "y"]),
        },
        connections: [
            "pulse.y -> least.u1", "swing.y -> least.u2", "least.y -> rate.u", "rate.y -> sum.u", "least.y -> limit.u",
            "sum.y -> high.u", "other.y -> switch.u1", "high.y -> switch.control", "limit.y -> switch.u3",
            "switch.y -> play.u", "least.y -> show.u", "limit.y -> show.y",
        ],
    )"#;
    let (compiled, problems) = compile_text(text);
    let (run, findings) = run_audited(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    assert_eq!(run.error, None);
    let findings = findings.expect("an audit");
    assert!(findings.looks > 10_000 && findings.missed.is_empty(), "{:?}", findings.missed);
    // Tiny steps that follow the input as far as the rates allow.
    let input = |t: f64| {
        let low = (t / 0.236).fract() >= 0.523;
        let swing = 0.284 + 0.946 * (std::f64::consts::TAU * 6.05 * t + 2.91).sin();
        if low { swing.min(0.0) } else { swing.min(2.43) }
    };
    let (mut y, mut t, h) = (0.0_f64, 0.0, 1e-6);
    let (mut row, mut worst) = (0, 0.0_f64);
    let (times, outputs) = (&run.time, run.column("show.y"));
    while t < 5.0 {
        t += h;
        y = input(t).clamp(y - 15.2 * h, y + 14.7 * h);
        while row < times.len() && times[row] <= t {
            worst = worst.max((outputs[row] - y).abs());
            row += 1;
        }
    }
    assert!(worst < 1e-4, "{worst}");
}

/// 3 * 1.1 is a little more than 3.3: the last edge of the pulse belongs to the run all the same, and to the sample at its end.
#[test]
fn an_edge_at_the_end_of_a_run_belongs_to_it() {
    let run = run_text(
        r#"Diagram(
            simulation: (stop_time: "3.3 s"),
            blocks: {
                "pulse": Pulse(amplitude: 2, period: "1.1 s", width: 0.5),
                "hold": ZeroOrderHold(ts: "20 ms"),
                "rate": Gain(k: "1 1/s"),
                "sum": Integrator,
                "show": Scope(inputs: ["pulse", "hold", "sum"]),
            },
            connections: [
                "pulse.y -> hold.u", "pulse.y -> rate.u", "rate.y -> sum.u",
                "pulse.y -> show.pulse", "hold.y -> show.hold", "sum.y -> show.sum",
            ],
        )"#,
    );
    assert_eq!([run.last("show.pulse"), run.last("show.hold")], [2.0, 2.0]);
    assert!((run.last("show.sum") - 3.3).abs() < 1e-12, "{}", run.last("show.sum"));
    assert!((run.time[run.time.len() - 1] - 3.3).abs() < 1e-15);
}

/// A signal that crosses zero the other way within a step and then jumps back has been on the far side: whoever waits for the jump's direction
/// sees it, wherever steps end.
#[test]
fn a_jump_back_is_seen_by_who_waits_for_its_direction() {
    for (sign, edge) in [(1.0, "Falling"), (-1.0, "Rising")] {
        for solver in METHODS {
            for late in [1e-6, 1e-3, 0.02, 0.2] {
                for stop in ["Step", "Pulse", "hit"] {
                    let down = match stop {
                        "Step" => {
                            format!(r#""down": Step(time: "{} s", after: {})"#, 1.0 + late, -5.0 * sign)
                        }
                        "Pulse" => format!(
                            r#""down": Pulse(period: "100 s", width: 0.5, delay: "{} s", amplitude: {})"#,
                            1.0 + late,
                            -5.0 * sign
                        ),
                        _ => format!(
                            r#""now": Step(time: "0.5 s", after: {}), "down": ZeroOrderHold(ts: "{} s")"#,
                            -5.0 * sign,
                            1.0 + late
                        ),
                    };
                    let hold = if stop == "hit" { r#""now.y -> down.u","# } else { "" };
                    let text = format!(
                        r#"Diagram(simulation: (stop_time: "2 s", solver: {solver}), blocks: {{
                            "up": Ramp(slope: {sign}, initial: {}), {down}, "u": Sum(signs: "++"), "one": Constant(value: 1),
                            "hits": HitCrossing(direction: {edge}), "counter": Counter(edge: {edge}), "x": Integrator(reset: {edge}),
                            "s": Scope(inputs: ["hits", "counter", "x"]) }},
                          connections: [{hold} "up.y -> u.u1", "down.y -> u.u2", "u.y -> hits.u, counter.u, x.reset", "one.y -> x.u",
                            "hits.count -> s.hits", "counter.count -> s.counter", "x.y -> s.x"])"#,
                        -sign
                    );
                    let run = run_text(&text);
                    let last = |name: &str| run.column(name).last().copied().unwrap_or(f64::NAN);
                    assert_eq!((last("s.hits"), last("s.counter")), (1.0, 1.0), "{solver} {text}");
                    assert!((last("s.x") - (1.0 - late)).abs() < 1e-9, "{solver}: {} {text}", last("s.x"));
                }
            }
        }
    }
}

/// The same where the jump back is set off by a state, at a time that nobody knows before.
#[test]
fn a_jump_back_that_a_state_sets_off_is_seen_as_well() {
    for solver in METHODS {
        for late in [1e-4, 0.02, 0.1, 0.7] {
            for (sign, edge) in [(1.0, "Rising"), (-1.0, "Falling")] {
                let run = run_text(&format!(
                    r#"Diagram(simulation: (stop_time: "30 s", solver: {solver}), blocks: {{
                        "one": Constant(value: 1), "rate": Constant(value: {}), "z": Integrator, "x": Integrator(x0: {}, reset: Rising),
                        "back": Compare(operator: GreaterEqual, constant: {}),
                        "counter": Counter(edge: {edge}), "hits": HitCrossing(direction: {edge}), "s": Scope(inputs: ["counter", "hits", "x"]) }},
                      connections: ["one.y -> z.u", "rate.y -> x.u", "z.y -> back.u", "back.y -> x.reset", "x.y -> counter.u, hits.u, s.x",
                        "counter.count -> s.counter", "hits.count -> s.hits"])"#,
                    -sign,
                    20.0 * sign,
                    20.0 + late,
                ));
                let last = |name: &str| run.column(name).last().copied().unwrap_or(f64::NAN);
                assert_eq!((last("s.counter"), last("s.hits")), (1.0, 1.0), "{solver} {late} {edge}");
                assert!(
                    (last("s.x") - sign * (10.0 + late)).abs() < 1e-6,
                    "{solver} {late}: {}",
                    last("s.x")
                );
            }
        }
    }
}

/// Again and again, wherever the edges lie in the steps: x falls to -0.02 and is set back to 1 by what has gone round, 98 times.
#[test]
fn no_edge_of_a_signal_that_is_set_back_again_and_again_is_lost() {
    for solver in METHODS {
        for (sign, edge) in [(1.0, "Rising"), (-1.0, "Falling")] {
            let run = run_text(&format!(
                r#"Diagram(simulation: (stop_time: "100 s", solver: {solver}), blocks: {{
                    "one": Constant(value: 1), "rate": Constant(value: {}), "z": Integrator(reset: Rising),
                    "back": Compare(operator: GreaterEqual, constant: 1.02), "x": Integrator(x0: {sign}, reset: Rising),
                    "counter": Counter(edge: {edge}), "hits": HitCrossing(direction: {edge}), "s": Scope(inputs: ["counter", "hits"]) }},
                  connections: ["one.y -> z.u", "rate.y -> x.u", "z.y -> back.u", "back.y -> x.reset, z.reset",
                    "x.y -> counter.u, hits.u", "counter.count -> s.counter", "hits.count -> s.hits"])"#,
                -sign
            ));
            let last = |name: &str| run.column(name).last().copied().unwrap_or(f64::NAN);
            assert_eq!((last("s.counter"), last("s.hits")), (98.0, 98.0), "{solver} {edge}");
        }
    }
}
