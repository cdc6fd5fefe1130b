//! Runs that cannot be: what is wrong is told with block, time, reason and remedy, and the rows so far are kept.

use std::sync::Arc;

use blocksim_block::schedule::{FixedMethod, OutputTimes, Settings, Solver, VariableMethod};
use blocksim_sim::{SimError, Simulation};
use blocksim_tests::{Run, compile_text, run};

/// Runs a diagram to its end or failure.
fn run_of(text: &str) -> Run {
    let (compiled, problems) = compile_text(text);
    run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")))
}

fn failure(run: &Run) -> &SimError {
    run.error.as_ref().expect("a failure")
}

/// How a diagram is refused whose settings the command line has changed.
fn refused(text: &str, change: impl Fn(&mut Settings)) -> SimError {
    let (compiled, problems) = compile_text(text);
    let mut schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    change(&mut schedule.settings);
    Simulation::new(Arc::new(schedule)).expect_err("settings that make no sense")
}

const DECAY: &str = r#"Diagram(
    blocks: { "decay": TransferFunction(num: [1], den: [1, 1]), "one": Constant(value: 1), "hold": ZeroOrderHold(ts: "1 ms"), "show": Scope },
    connections: [ "one.y -> decay.u", "decay.y -> hold.u", "hold.y -> show.u" ],
)"#;

#[test]
fn times_that_cannot_be_told_apart_are_refused_before_the_run() {
    let variable =
        |max_step| Solver::Variable { method: VariableMethod::Ode45, rtol: 1e-6, atol: None, max_step };
    let error = refused(DECAY, |settings| settings.stop_time = 1e300);
    assert_eq!(error.code, "settings");
    assert!(error.message.contains("the stop time of 1e300 s is beyond the clock"), "{error}");
    assert!(error.help.unwrap().contains("choose an earlier stop time"));
    for (solver, what) in [
        (Solver::Fixed { method: FixedMethod::Ode4, step: 1e-19 }, "the fixed step, 1e-19 s,"),
        (variable(1e-18), "the maximum step, 1e-18 s,"),
    ] {
        let error = refused(DECAY, |settings| settings.solver = solver);
        assert!(error.message.starts_with(what), "{error}");
        assert!(error.help.unwrap().contains("take at least 8.9e-15 s"));
    }
    let error = refused(DECAY, |settings| settings.output = OutputTimes::Every(1e-17));
    assert!(error.message.starts_with("the spacing of the output"), "{error}");
    // A sample of 1 ms is lost beyond 1e12 s.
    let error = refused(DECAY, |settings| settings.stop_time = 1e13);
    assert!(error.message.starts_with("the sample time of `hold`, 1e-3 s,"), "{error}");
    assert_eq!(error.path.as_deref(), Some("hold"));
}

#[test]
fn an_improper_transfer_function_is_refused_with_a_remedy() {
    let (compiled, problems) = compile_text(&DECAY.replace("num: [1]", "num: [1, 0, 0]"));
    assert!(compiled.schedule.is_none());
    assert!(
        problems.contains("`num`") && problems.contains("model.ron:2:") && problems.contains("help: "),
        "{problems}"
    );
}

#[test]
fn a_value_that_is_not_a_number_ends_the_run_at_its_block_and_the_rows_before_are_kept() {
    for (block, expected) in [
        ("Function(function: Square)", "`odd.y` is inf"),
        ("Function(function: Cosh)", "`odd.y` is inf"),
        ("Function(function: Asin)", "`odd` cannot go on"),
    ] {
        let run = run_of(&format!(
            r#"Diagram(
                simulation: (stop_time: "2 s", output: Every("0.1 s")),
                blocks: {{ "jump": Step(time: "1 s", before: 1, after: 1e300), "odd": {block}, "sum": Integrator, "show": Scope }},
                connections: [ "jump.y -> odd.u", "odd.y -> sum.u", "sum.y -> show.u" ],
            )"#
        ));
        let error = failure(&run);
        assert_eq!((error.path.as_deref(), error.t), (Some("odd"), 1.0), "{error}");
        assert!(error.message.starts_with(expected), "{error}");
        // With the input that led to it.
        let told = error.to_string();
        assert!(told.contains("1e300") || told.contains("= 1000000000"), "{told}");
        assert!(run.time.len() >= 10 && *run.time.last().unwrap() <= 1.0, "{:?}", run.time);
    }
}

/// A signal that grows without a jump beyond all numbers: not the state that it happens to feed is to blame.
#[test]
fn a_signal_that_overflows_ends_the_run_with_its_block_and_a_root_of_less_than_nothing_with_a_remedy() {
    let run = run_of(
        r#"Diagram(
            simulation: (stop_time: 800),
            blocks: { "t": Ramp(slope: "1 1/s"), "grow": Function(function: Exp), "none": Sum(signs: "+-"), "x": Integrator, "show": Scope },
            connections: [ "t.y -> grow.u", "grow.y -> none.u1, none.u2", "none.y -> x.u", "x.y -> show.u" ],
        )"#,
    );
    let error = failure(&run);
    assert_eq!((error.code, error.path.as_deref()), ("not_finite", Some("grow")), "{error}");
    // exp(t) is the largest number at 709.78 s.
    assert!((error.t - f64::MAX.ln()).abs() < 1e-6 && error.message == "`grow.y` is inf", "{error}");
    assert!(run.time.len() > 40 && error.help.is_some(), "{error}");
    let run = run_of(
        r#"Diagram(
            simulation: (stop_time: 2),
            blocks: { "t": Ramp(slope: "1 1/s"), "one": Constant(value: 1), "left": Sum(signs: "+-"), "root": Function(function: Sqrt),
                      "x": Integrator, "show": Scope },
            connections: [ "one.y -> left.u1", "t.y -> left.u2", "left.y -> root.u", "root.y -> x.u", "x.y -> show.u" ],
        )"#,
    );
    let error = failure(&run);
    assert_eq!((error.code, error.path.as_deref()), ("block_failed", Some("root")), "{error}");
    assert!((error.t - 1.0).abs() < 1e-6 && error.message.contains("MinMax or Saturation"), "{error}");
    assert!((run.last("show.u") - 2.0 / 3.0).abs() < 1e-5, "{}", run.last("show.u"));
}

#[test]
fn what_chatters_by_design_ends_at_its_time_and_the_rows_before_are_kept() {
    let run = run_of(
        r#"Diagram(
            simulation: (stop_time: "2 s", output: Every("0.1 s")),
            blocks: { "down": Constant(value: -1), "up": Constant(value: 1), "x": Integrator(x0: "1 s"),
                      "switch": Switch(threshold: "0 s"), "show": Scope },
            connections: [ "x.y -> switch.control, show.u", "down.y -> switch.u1", "up.y -> switch.u3", "switch.y -> x.u" ],
        )"#,
    );
    let error = failure(&run);
    assert_eq!((error.code, error.path.as_deref()), ("chatter", Some("switch")));
    assert!((error.t - 1.0).abs() < 1e-6 && error.help.as_ref().unwrap().contains("hysteresis"), "{error}");
    assert!(run.time.len() >= 10, "{:?}", run.time);
    assert!(run.time.iter().zip(run.column("show.u")).all(|(t, x)| (x - (1.0 - t)).abs() < 1e-6));
}

#[test]
fn more_events_than_anybody_can_keep_end_the_run_with_their_block_and_number() {
    // Between -h and h to and fro with slope 1: an event every 2 h = 2e-7 s, 5e9 of them until 1000 s.
    let run = run_of(
        r#"Diagram(
            simulation: (stop_time: "1000 s"),
            blocks: { "x": Integrator, "relay": Relay(on_at: "1e-7 s", off_at: "-1e-7 s", on: -1, off: 1), "show": Scope },
            connections: [ "relay.y -> x.u", "x.y -> relay.u, show.u" ],
        )"#,
    );
    let error = failure(&run);
    assert_eq!((error.code, error.path.as_deref()), ("endless_events", Some("relay")));
    assert!((error.t - 0.06).abs() < 0.001, "{error}");
    assert!(error.message.contains("300000 within the last 6.00e-2 s"), "{error}");
    assert!(error.message.contains("until 1000 s there would be 5e9 of them"), "{error}");
    assert!(error.help.as_ref().unwrap().contains("hysteresis"));
    assert!(run.time.len() >= 300_000 && run.column("show.u").iter().all(|x| x.abs() < 1.001e-7));
}

#[test]
fn friction_is_among_the_events_of_a_method_of_fixed_step_as_of_the_others() {
    let text = |solver: &str| {
        format!(
            r#"Diagram(
                simulation: (stop_time: "3 s", solver: {solver}),
                blocks: {{
                    "push": Sine(amplitude: "3 N*m", frequency: "1 Hz"), "torque": IdealTorqueSource, "shaft": Inertia(j: "0.1 kg*m^2"),
                    "bearing": RotationalFriction(breakaway: "2 N*m", breakaway_velocity: "0 rad/s", coulomb: "2 N*m", model: Stiction),
                    "housing": RotationalReference,
                }},
                connections: [
                    "push.y -> torque.tau", "torque.r <-> shaft.r <-> bearing.r", "torque.c <-> bearing.c <-> housing.r",
                ],
            )"#
        )
    };
    let friction = |solver: &str| -> Vec<f64> {
        let run = run_of(&text(solver));
        assert_eq!(run.error, None);
        run.events.iter().filter(|(_, path, _)| path == "bearing").map(|(t, ..)| *t).collect()
    };
    let (located, stepped) = (friction("Ode45"), friction("Ode4(step: \"1 ms\")"));
    assert!(located.len() >= 6, "{located:?}");
    assert_eq!(located.len(), stepped.len(), "{located:?} {stepped:?}");
    assert!(located.iter().zip(&stepped).all(|(a, b)| (a - b).abs() < 5e-3), "{located:?} {stepped:?}");
}
