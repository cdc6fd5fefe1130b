//! Guards that leave zero flatly: what is integrated several times from rest begins as a high power of time, far below any
//! tolerance, and must leave zero on the right side all the same.

use std::f64::consts::TAU;

use blocksim_tests::{Run, compile_text, run, run_text};

const FREQUENCY: f64 = 0.2;

/// A sine of an amplitude through `n` integrators, the last one from `x0`, and the block `hit` behind them.
fn behind_integrators(method: &str, n: usize, amplitude: f64, x0: f64, hit: &str) -> Run {
    let (mut blocks, mut wires, mut last) = (String::new(), String::new(), "source.y".to_owned());
    for k in 1..=n {
        let start = if k == n { x0 } else { 0.0 };
        blocks += &format!(r#""rate{k}": Gain(k: "1 1/s"), "x{k}": Integrator(x0: {start:?}), "#);
        wires += &format!(r#""{last} -> rate{k}.u", "rate{k}.y -> x{k}.u", "#);
        last = format!("x{k}.y");
    }
    run_text(&format!(
        r#"Diagram(
            simulation: (stop_time: "2 s", solver: {method}),
            blocks: {{
                "source": Sine(amplitude: {amplitude:?}, frequency: "{FREQUENCY} Hz"), {blocks}
                "hit": {hit}, "show": Scope(inputs: ["x", "count"]),
            }},
            connections: [{wires} "{last} -> hit.u, show.x", "hit.count -> show.count"],
        )"#
    ))
}

/// The sine of the angular frequency `w` integrated `n` times from rest, by its power series.
fn integrated(n: i32, t: f64) -> f64 {
    let w = TAU * FREQUENCY;
    let term = |k: i32| {
        let power = 2 * k + 1 + n;
        let factorial: f64 = (1..=power).map(f64::from).product();
        (-1.0_f64).powi(k) * w.powi(2 * k + 1) * t.powi(power) / factorial
    };
    (0..12).map(term).sum()
}

/// Up to the eighth power of time by methods that err by less than that in a short step, up to the fourth by one that does not.
#[test]
fn what_leaves_zero_as_a_power_of_time_does_not_cross_it() {
    let methods =
        [("Auto", 7), ("Ode45", 7), ("Ode23", 7), ("Dop853", 7), ("Radau5", 7), ("Rodas4", 7), ("RosW3", 3)];
    for (method, most) in methods {
        for n in 1..=most {
            for (amplitude, direction) in
                [(1.0, "Falling"), (-1.0, "Rising"), (1.0, "Either"), (-1.0, "Either")]
            {
                let hit = format!("HitCrossing(direction: {direction})");
                let run = behind_integrators(method, n, amplitude, 0.0, &hit);
                let what = format!("{method}, {amplitude} t^{}, {direction}", n + 1);
                assert_eq!((run.last("show.count"), run.events.len()), (0.0, 0), "{what}: {:?}", run.events);
                let expected = amplitude * integrated(n as i32, 2.0);
                let found = run.last("show.x");
                assert!((found - expected).abs() < 2e-5 * expected.abs(), "{what}: {found}, not {expected}");
            }
        }
    }
}

/// The same at a value that is not zero, where what is left of the first moves is rounding.
#[test]
fn what_leaves_another_value_as_a_power_of_time_does_not_cross_it() {
    for method in ["Auto", "Ode45", "Ode23", "Dop853", "Radau5", "Rodas4"] {
        for n in 1..=5 {
            for amplitude in [1.0, -1.0] {
                let run = behind_integrators(method, n, amplitude, 1.0, "HitCrossing(at: 1.0)");
                assert_eq!(
                    run.last("show.count"),
                    0.0,
                    "{method}, {amplitude} t^{}: {:?}",
                    n + 1,
                    run.events
                );
            }
        }
    }
}

/// A crossing that follows soon is not missed for it: `x = t^3 (a - t)` is zero again at `a`, within the first steps.
#[test]
fn a_crossing_soon_after_a_flat_start_is_found_once() {
    for a in [1e-1, 1e-2, 1e-3] {
        // The fourth derivative is -24, the third one 6 a at the start.
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "1 s"),
                blocks: {{
                    "x4": Constant(value: "-24 1/s^4"), "x3": Integrator(x0: "{} 1/s^3"), "x2": Integrator(x0: "0 1/s^2"),
                    "x1": Integrator(x0: "0 1/s"), "x": Integrator,
                    "hit": HitCrossing(direction: Falling), "show": Scope(inputs: ["time", "count"]),
                }},
                connections: [
                    "x4.y -> x3.u", "x3.y -> x2.u", "x2.y -> x1.u", "x1.y -> x.u", "x.y -> hit.u",
                    "hit.time -> show.time", "hit.count -> show.count",
                ],
            )"#,
            6.0 * a
        ));
        assert_eq!(run.last("show.count"), 1.0, "{a}: {:?}", run.events);
        let time = run.last("show.time");
        assert!((time - a).abs() < 1e-6 * a, "{time}, not {a}");
    }
}

/// A stiff method makes steps that are millions of time constants long, and short explicit steps from there may be thousands of them.
/// What leaves 1 as a power of time is found all the same, or as the dense output has it, and the fast state stays where it is.
#[test]
fn short_steps_that_are_too_long_for_what_is_fast_lead_nowhere() {
    for method in ["Auto", "Ode15s", "Radau5", "Rodas4", "Ode23tb"] {
        for tau in ["1e-5 s", "1e-7 s"] {
            let run = run_text(&format!(
                r#"Diagram(
                    simulation: (stop_time: "4 s", solver: {method}),
                    blocks: {{
                        "start": Step(time: "1 s", after: 1.0), "rate1": Gain(k: "1 1/s"), "x1": Integrator, "rate2": Gain(k: "1 1/s"),
                        "x2": Integrator(x0: 1.0), "hit": HitCrossing(at: 1.0, direction: Falling),
                        "source": Sine(amplitude: 1.0, frequency: "0.1 Hz"), "fast": LowPass(tau: "{tau}"),
                        "show": Scope(inputs: ["count", "x2", "set", "fast"]),
                    }},
                    connections: [
                        "start.y -> rate1.u", "rate1.y -> x1.u", "x1.y -> rate2.u", "rate2.y -> x2.u", "x2.y -> hit.u, show.x2",
                        "hit.count -> show.count", "source.y -> fast.u, show.set", "fast.y -> show.fast",
                    ],
                )"#
            ));
            assert_eq!(run.last("show.count"), 0.0, "{method}, {tau}: {:?}", run.events);
            assert!((run.last("show.x2") - 5.5).abs() < 1e-5, "{method}, {tau}: {}", run.last("show.x2"));
            for (set, fast) in run.column("show.set").iter().zip(run.column("show.fast")) {
                assert!((set - fast).abs() < 2e-5, "{method}, {tau}: {fast}, not {set}");
            }
        }
    }
}

/// What is right at the threshold is wrong behind it: the branch changes where the guard leaves zero, and there the rows must stand,
/// however far apart those of the grid are.
#[test]
fn a_jump_where_a_guard_leaves_zero_has_rows_on_both_sides() {
    for method in ["Auto", "Ode45", "Ode15s"] {
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "1 s", solver: {method}, output: Every("1 s")),
                blocks: {{
                    "falls": Ramp(slope: -1, initial: 1), "one": Constant(value: 1), "two": Constant(value: 2),
                    "switch": Switch(threshold: 0.5), "half": Constant(value: 0.5), "above": Compare(operator: GreaterEqual),
                    "show": Scope(inputs: ["switch", "above"]),
                }},
                connections: [
                    "one.y -> switch.u1", "falls.y -> switch.control, above.u1", "two.y -> switch.u3", "half.y -> above.u2",
                    "switch.y -> show.switch", "above.y -> show.above",
                ],
            )"#
        ));
        for (name, from, to) in [("show.switch", 1.0, 2.0), ("show.above", 1.0, 0.0)] {
            let (times, values) = (&run.time, run.column(name));
            let after = values.iter().position(|y| *y == to).expect("it changes");
            assert_eq!(values[after - 1], from, "{method}, {name}");
            assert_eq!(times[after - 1], times[after], "{method}, {name}: {times:?} {values:?}");
            assert!((times[after] - 0.5).abs() < 1e-9, "{method}, {name}: {times:?}");
        }
    }
}

/// A constant `a` from `t0` on through two integrators that were at zero: `a (t - t0)` and `a (t - t0)^2 / 2`. The second one begins with
/// an error of all of its value by a method of first order, and where all was zero nothing says how small that is. With `beside` a fast
/// lag behind them has `Auto` take to `Ode15s`.
#[test]
fn what_was_at_zero_is_kicked_late_and_hard() {
    for (method, beside) in [("Ode15s", false), ("Ode15s", true), ("Auto", true)] {
        for (t0, a) in [(5.3, 1e12), (50.3, 1e9), (500.3, 1e6), (500.3, 1e12), (50000.3, 1e3), (50000.3, 1e9)]
        {
            let (lag, into) = match beside {
                true => (r#""w": Integrator, "lag": LowPass(tau: "1e-5 s"),"#, r#", w.u", "w.y -> lag.u"#),
                false => ("", ""),
            };
            let stop = 2.0 * t0;
            let run = run_text(&format!(
                r#"Diagram(
                    simulation: (stop_time: "{stop} s", solver: {method}),
                    blocks: {{
                        "a": Step(time: "{t0} s", after: {a:?}), "v": Integrator, "x": Integrator, {lag}
                        "show": Scope(inputs: ["v", "x"]),
                    }},
                    connections: ["a.y -> v.u", "v.y -> x.u, show.v", "x.y -> show.x{into}"],
                )"#
            ));
            let what = format!("{method}, {a} from {t0} s, lag {beside}");
            assert!(run.error.is_none(), "{what}: {:?}", run.error);
            for (name, expected) in [("show.v", a * t0), ("show.x", 0.5 * a * t0 * t0)] {
                let off = run.last(name) / expected - 1.0;
                assert!(off.abs() < 1e-5, "{what}: {name} is off by {off:e}");
            }
        }
    }
}

/// A pole right behind the kick is no first move: `tan(a (t - t0))`.
#[test]
fn a_pole_at_once_is_not_taken_for_a_departure() {
    let (compiled, problems) = compile_text(
        r#"Diagram(
            simulation: (stop_time: "100 s", solver: Ode15s),
            blocks: {
                "a": Step(time: "50.3 s", after: 1e12), "v": Integrator,
                "pole": OdeSystem(law: "x' = a*(1 + x^2)"), "show": Scope(inputs: ["v", "x"]),
            },
            connections: ["a.y -> v.u, pole.a", "v.y -> show.v", "pole.x -> show.x"],
        )"#,
    );
    let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    assert_eq!(run.error.expect("no value behind the pole").code, "step_size");
}
