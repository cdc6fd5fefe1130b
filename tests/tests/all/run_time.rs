//! What goes wrong while a diagram runs is said with block, time and remedy, and what was recorded until then is kept.

use blocksim_tests::{Run, compile_text, run};
use expect_test::{Expect, expect};

/// Runs a diagram that must fail; shows the error with the block it blames.
fn fails(simulation: &str, blocks: &str, connections: &str, expected: &Expect) -> Run {
    let text =
        format!("Diagram(simulation: ({simulation}), blocks: {{ {blocks} }}, connections: [{connections}])");
    let (compiled, problems) = compile_text(&text);
    let schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    assert_eq!(problems, "", "the compiler sees nothing");
    let run = run(schedule);
    let error = run.error.as_ref().expect("a failure");
    let block = error.path.as_deref().unwrap_or("no block");
    expected.assert_eq(&format!("{block}: {error}\n"));
    // Rows are in order, end no later than the failure, and hold numbers.
    assert!(run.time.windows(2).all(|pair| pair[0] <= pair[1]), "{:?}", run.time);
    assert!(
        run.time.iter().all(|t| *t <= error.t),
        "rows behind the failure at {} s: {:?}",
        error.t,
        run.time
    );
    assert!(run.columns.iter().all(|column| column.len() == run.time.len()));
    assert!(run.columns.iter().flatten().all(|value| value.is_finite()), "{:?}", run.columns);
    run
}

#[test]
fn a_division_by_zero() {
    let run = fails(
        r#"stop_time: "2 s", solver: Ode4(step: "0.25 s")"#,
        r#""one": Constant(value: 1), "t": Ramp(slope: "-1 1/s", initial: 1), "quotient": Divide, "show": Scope"#,
        r#""one.y -> quotient.u1", "t.y -> quotient.u2", "quotient.y -> show.u""#,
        &expect![[r#"
            quotient: error[block_failed] at t = 1 s: `quotient` cannot go on: division by zero: u1 = 1, u2 = 0: keep `u2` away from zero, as with a Switch before it
        "#]],
    );
    assert_eq!(run.time, [0.0, 0.25, 0.5, 0.75], "every step before the pole");
    assert_eq!(run.column("show.u"), [1.0, 1.0 / 0.75, 2.0, 4.0]);
}

#[test]
fn zero_over_zero() {
    fails(
        r#"stop_time: "2 s""#,
        r#""t": Clock, "quotient": Divide, "show": Scope"#,
        r#""t.y -> quotient.u1, quotient.u2", "quotient.y -> show.u""#,
        &expect![[r#"
            quotient: error[block_failed] at t = 0 s: `quotient` cannot go on: division by zero: u1 = 0, u2 = 0: keep `u2` away from zero, as with a Switch before it
        "#]],
    );
}

#[test]
fn a_function_outside_of_where_it_is_defined() {
    let run = fails(
        r#"stop_time: "2 s", solver: Ode4(step: "0.25 s")"#,
        r#""t": Ramp(slope: "-1 1/s", initial: 1), "root": Function(function: Sqrt), "show": Scope"#,
        r#""t.y -> root.u", "root.y -> show.u""#,
        &expect![[r#"
            root: error[block_failed] at t = 1.25 s: `root` cannot go on: Sqrt has no value at u = -0.25; u must be not negative (MinMax or Saturation can keep it there)
        "#]],
    );
    assert_eq!(run.time, [0.0, 0.25, 0.5, 0.75, 1.0], "the root of zero is still defined");
}

#[test]
fn a_signal_that_becomes_infinite() {
    let run = fails(
        r#"stop_time: "1 s", solver: Ode4(step: "0.125 s")"#,
        r#""t": Ramp(slope: "1000 1/s"), "growth": Function(function: Exp), "show": Scope"#,
        r#""t.y -> growth.u", "growth.y -> show.u""#,
        &expect![[r#"
            growth: error[not_finite] at t = 0.75 s: `growth.y` is inf
            help: its inputs: `u` = 750
        "#]],
    );
    assert_eq!(run.time.last(), Some(&0.625), "exp(625) is a number, exp(750) none");
}

#[test]
fn a_state_that_becomes_infinite_with_a_fixed_step() {
    // x' = x^2 from 1 has a pole at 1 s; steps of fixed length run over it and explode.
    let run = fails(
        r#"stop_time: "3 s", solver: Ode4(step: "0.1 s")"#,
        r#""square": Product, "x": Integrator(x0: 1), "show": Scope"#,
        r#""x.y -> square.u1, square.u2, show.u", "square.y -> x.u""#,
        &expect![[r#"
            x: error[step_size] at t = 1.2 s: no derivative that is finite for the state `x.x`; dx/dt = inf
            help: its inputs: `u` = inf; use a smaller step or a method of variable step
        "#]],
    );
    assert!(run.time.len() > 10, "the rows until then are kept: {:?}", run.time);
}

#[test]
fn infinity_minus_infinity_in_a_loop() {
    fails(
        r#"stop_time: "1 s", solver: Ode4(step: "0.125 s")"#,
        r#""t": Ramp(slope: "1000 1/s"), "a": Function(function: Exp), "b": Function(function: Exp),
           "difference": Sum(signs: "+-"), "show": Scope"#,
        r#""t.y -> a.u, b.u", "a.y -> difference.u1", "b.y -> difference.u2", "difference.y -> show.u""#,
        &expect![[r#"
            a: error[not_finite] at t = 0.75 s: `a.y` is inf
            help: its inputs: `u` = 750
        "#]],
    );
}

#[test]
fn a_step_that_becomes_too_small_at_a_pole() {
    let run = fails(
        r#"stop_time: "2 s", output: Every("0.1 s")"#,
        r#""square": Product, "x": Integrator(x0: 1), "show": Scope"#,
        r#""x.y -> square.u1, square.u2, show.u", "square.y -> x.u""#,
        &expect![[r#"
            x: error[step_size] at t = 1.0000000961986275 s: even a step of 3.552713678800501e-15 s is too long for the state `x.x`; dx/dt = 2.1967309487330838e27
            help: its inputs: `u` = 2.1967309487330838e27; a jump or a pole of the law may be the cause
        "#]],
    );
    let error = run.error.as_ref().expect("a failure");
    // The error of the method moves the pole by some 1e-6 of its distance.
    assert!((error.t - 1.0).abs() < 1e-5, "the pole is at 1 s, the failure at {} s", error.t);
    assert_eq!(
        run.time.iter().filter(|t| **t < 0.95).count(),
        10,
        "rows on the grid until then: {:?}",
        run.time
    );
    for (t, x) in run.time.iter().zip(run.column("show.u")).take(9) {
        assert!((x - 1.0 / (1.0 - t)).abs() < 1e-4 * x, "x = 1 / (1 - t) at {t} s: {x}");
    }
}

#[test]
fn a_relay_without_hysteresis_around_zero() {
    let run = fails(
        r#"stop_time: "2 s""#,
        r#""x": Integrator(x0: "1 s"), "relay": Relay(on_at: "0 s", off_at: "0 s", on: -1, off: 1), "show": Scope"#,
        r#""x.y -> relay.u, show.u", "relay.y -> x.u""#,
        &expect![[r#"
            relay: error[chatter] at t = 1.0000000000004443 s: `relay` is chattering: it switches on and switches off again and again
            help: give the switching a hysteresis, or use a method of fixed step
        "#]],
    );
    let error = run.error.as_ref().expect("a failure");
    assert!((error.t - 1.0).abs() < 1e-6, "it slides from 1 s on; the failure is at {} s", error.t);
}

#[test]
fn an_assertion_that_no_longer_holds() {
    let run = fails(
        r#"stop_time: "2 s", solver: Ode4(step: "0.25 s")"#,
        r#""height": Ramp(slope: "-1 m/s", initial: "1 m"), "floor": Compare(operator: Greater, constant: "0.3 m"),
           "rule": Assertion(message: "the arm touches the floor"), "show": Scope"#,
        r#""height.y -> floor.u, show.u", "floor.y -> rule.ok""#,
        &expect![[r#"
            rule: error[block_failed] at t = 0.75 s: `rule` cannot go on: the arm touches the floor
        "#]],
    );
    assert!(run.time.starts_with(&[0.0, 0.25, 0.5]), "{:?}", run.time);
}

#[test]
fn a_block_inside_of_subsystems_is_named_with_its_path() {
    let desk = blocksim_tests::Desk::new()
        .with("inner.ron", r#"Diagram(inputs: { "u": () }, outputs: { "y": "q.y" }, blocks: { "one": Constant(value: 1), "q": Divide },
            connections: ["one.y -> q.u1", "in.u -> q.u2"])"#)
        .with("outer.ron", r#"Diagram(inputs: { "u": () }, outputs: { "y": "inner.y" }, blocks: { "inner": Subsystem(file: "inner.ron") },
            connections: ["in.u -> inner.u"])"#)
        .with("model.ron", r#"Diagram(blocks: { "zero": Constant(value: 0), "outer": Subsystem(file: "outer.ron"), "show": Scope },
            connections: ["zero.y -> outer.u", "outer.y -> show.u"])"#);
    let (compiled, problems) = blocksim_tests::compile_with(&desk, std::path::Path::new("model.ron"), &[]);
    let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    expect![[r#"
        outer/inner/q: error[block_failed] at t = 0 s: `outer/inner/q` cannot go on: division by zero: u1 = 1, u2 = 0: keep `u2` away from zero, as with a Switch before it
    "#]].assert_eq(&run.error.map_or(String::new(), |error| format!("{}: {error}\n", error.path.as_deref().unwrap_or("no block"))));
}
