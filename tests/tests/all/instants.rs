//! Steps that end at events, against closed forms: an instant takes its states from within a step.

use std::f64::consts::{PI, TAU};

use blocksim_tests::{compile_text, run, run_text};

/// A sine whose levels are events, sixty in a second, is integrated meanwhile between limits: the integral touches the upper
/// one once a period, where nothing is lost. A step that is cut at an event must be as exact as one that is not, or
/// all of them add up.
#[test]
fn many_events_cost_an_integral_no_digits() {
    let (amplitude, f) = (3.27, 4.07);
    let a = amplitude / (TAU * f);
    let expected = 0.347 - a - a * f64::cos(TAU * f * 2.0);
    for solver in ["Auto", "Ode45", "Ode23", "Rodas4", "RosW3", "Radau5", "Ode15s"] {
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "2 s", solver: {solver}),
                blocks: {{
                    "u": Sine(amplitude: {amplitude:?}, frequency: "{f} Hz"), "levels": Quantizer(interval: 0.971),
                    "below": Compare(operator: Less), "rate": Gain(k: "1 1/s"),
                    "sum": Integrator(x0: 0.104, lower: -0.347, upper: 0.347),
                    "number": Switch, "one": Constant(value: 1), "zero": Constant(value: 0), "per_s": Gain(k: "1 1/s"),
                    "share": Integrator, "show": Scope(inputs: ["sum", "share"]),
                }},
                connections: [
                    "u.y -> levels.u", "u.y -> below.u1", "levels.y -> below.u2", "u.y -> rate.u", "rate.y -> sum.u",
                    "one.y -> number.u1", "below.y -> number.control", "zero.y -> number.u3", "number.y -> per_s.u",
                    "per_s.y -> share.u", "sum.y -> show.sum", "share.y -> show.share",
                ],
            )"#
        ));
        let found = run.last("show.sum");
        assert!((found - expected).abs() < 3e-5, "{solver}: {found} instead of {expected}");
        let default = matches!(solver, "Auto" | "Ode45");
        assert!(!default || (found - expected).abs() < 3e-6, "{solver}: {found} instead of {expected}");
    }
}

/// A pendulum without gravity between two events of its speed, both from states: the time between them is exact to the
/// tolerance though both steps are cut.
#[test]
fn events_of_states_are_where_the_solution_has_them() {
    for solver in ["Auto", "Ode45", "Ode23", "Rodas4", "RosW3", "Radau5", "Ode15s"] {
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "20 s", solver: {solver}),
                blocks: {{
                    "v": Integrator(x0: 0), "x": Integrator(x0: 1), "k": Gain(k: "-1 1/s^2"), "one": Gain(k: 1),
                    "above": Compare(operator: Greater, constant: 0.3), "number": Switch, "yes": Constant(value: 1),
                    "no": Constant(value: 0), "rate": Gain(k: "1 1/s"), "share": Integrator,
                    "show": Scope(inputs: ["share", "x"]),
                }},
                connections: [
                    "x.y -> k.u", "k.y -> v.u", "v.y -> one.u", "one.y -> x.u", "x.y -> above.u", "yes.y -> number.u1",
                    "above.y -> number.control", "no.y -> number.u3", "number.y -> rate.u", "rate.y -> share.u",
                    "share.y -> show.share", "x.y -> show.x",
                ],
            )"#
        ));
        // cos t is above 0.3 for 2 acos(0.3) of each turn; 20 s are three turns and 1.15 s, which is before it falls.
        let rest = 20.0 - 3.0 * TAU;
        assert!(rest < f64::acos(0.3));
        let expected = 6.0 * f64::acos(0.3) + rest;
        let found = run.last("show.share");
        let slack = if solver == "Ode15s" { 2e-3 } else { 1e-4 };
        assert!((found - expected).abs() < slack, "{solver}: {found} instead of {expected}");
        assert!((run.last("show.x") - f64::cos(20.0)).abs() < slack, "{solver}");
        assert!(rest < PI);
    }
}

/// A mass that bounces for ever lower never falls through the floor, whatever the method: hops that are lower than the
/// tolerance are still seen, up to where their accumulation is an error.
#[test]
fn hops_that_are_lower_than_the_tolerance_are_not_lost() {
    for (solver, drag) in ["Auto", "Ode45", "Ode23", "Rodas4", "RosW3", "Radau5", "Ode15s"]
        .into_iter()
        .flat_map(|s| [(s, 0.0), (s, 0.3)])
    {
        let (compiled, problems) = compile_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "14 s", solver: {solver}),
                blocks: {{
                    "gravity": Constant(value: "-9.80665 m/s^2"), "drag": Gain(k: "{drag} 1/s"), "force": Sum(signs: "+-"),
                    "velocity": Integrator(reset: Falling, external: true), "height": Integrator(x0: "10 m"),
                    "impact": Gain(k: -0.8), "show": Scope(inputs: ["h"]),
                }},
                connections: [
                    "velocity.y -> drag.u", "gravity.y -> force.u1", "drag.y -> force.u2", "force.y -> velocity.u",
                    "velocity.y -> height.u, impact.u", "impact.y -> velocity.x0", "height.y -> velocity.reset, show.h",
                ],
            )"#
        ));
        let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
        let error = run
            .error
            .as_ref()
            .unwrap_or_else(|| panic!("{solver}, drag {drag}: ended at {} m", run.last("show.h")));
        assert_eq!(error.code, "endless_events", "{solver}, drag {drag}: {}", error.message);
        let least = run.column("show.h").iter().fold(0.0_f64, |least, h| least.min(*h));
        assert!(least > -1e-8, "{solver}, drag {drag}: {least} m");
    }
}

/// A diagram with hits, edges, a relay, a delay and rows of its own grid is the same in units of a second, a nanosecond and a picosecond: no
/// time counts as the same for being closer than a fixed part of a second.
#[test]
fn runs_of_any_length_tell_their_instants_apart() {
    let of = |unit: f64| {
        run_text(&format!(
            r#"Diagram(
                parameters: {{ "T": {unit:e} }},
                simulation: (stop_time: "T", output: Every("T/20")),
                blocks: {{
                    "step": Step(time: "0.3137*T"), "lag": LowPass(tau: "0.1*T"), "hold": ZeroOrderHold(ts: "T/10"),
                    "relay": Relay(on_at: 0.5, off_at: 0.2, on: 1, off: 0), "pulse": Pulse(period: "0.0771*T", width: 0.3),
                    "per_time": Gain(k: "1/T"), "sum": Integrator, "late": TransportDelay(delay: "0.2*T"),
                    "show": Scope(inputs: ["lag", "hold", "relay", "sum", "late"]),
                }},
                connections: [
                    "step.y -> lag.u", "lag.y -> hold.u, relay.u, late.u, show.lag", "hold.y -> show.hold", "relay.y -> show.relay",
                    "pulse.y -> per_time.u", "per_time.y -> sum.u", "sum.y -> show.sum", "late.y -> show.late",
                ],
            )"#
        ))
    };
    let signals = ["lag", "hold", "relay", "sum", "late"].map(|name| format!("show.{name}"));
    let long = of(1.0);
    // Twelve pulses, and what is left of the thirteenth.
    assert!((long.last("show.sum") - (12.0 * 0.3 * 0.0771 + 0.3 * 0.0771)).abs() < 1e-12);
    for unit in [1e-3, 1e-9, 1e-12] {
        let short = of(unit);
        assert_eq!(short.time.len(), long.time.len(), "rows in units of {unit} s");
        for (row, (t, of_long)) in short.time.iter().zip(&long.time).enumerate() {
            assert!((t / unit - of_long).abs() < 1e-9, "{t} s in units of {unit} s instead of {of_long}");
            for signal in &signals {
                let (a, b) = (short.column(signal)[row], long.column(signal)[row]);
                assert!((a - b).abs() < 1e-8, "{signal} at {t} s in units of {unit} s: {a} instead of {b}");
            }
        }
    }
}
