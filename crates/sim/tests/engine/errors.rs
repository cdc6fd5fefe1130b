//! What is said when a simulation cannot go on.

use std::sync::Arc;

use blocksim_block::schedule::OutputTimes::Steps;
use blocksim_block::schedule::Schedule;
use blocksim_sim::Simulation;
use expect_test::{Expect, expect};

use crate::toys::*;

fn check(schedule: Arc<Schedule>, expected: Expect) {
    let mut tape = Tape::default();
    let error = Simulation::new(schedule).and_then(|mut sim| sim.run(&mut tape)).unwrap_err();
    let path = error.path.as_deref().unwrap_or("-");
    expected.assert_eq(&format!("{error}\nblock: {path}, rows: {}\n", tape.rows.len()));
}

#[test]
fn a_value_that_is_no_number_names_its_source_and_its_inputs() {
    let toy = Toy::new().with("t", Time, &[]).with("minus", Gain(-1.0), &["t"]);
    let toy = toy.with("root", Function2(|a, b| (a + b).sqrt()), &["minus", "minus"]).with(
        "k",
        Gain(3.0),
        &["root"],
    );
    check(
        toy.schedule(&["k"], 1.0, ode4(0.25), Steps),
        expect![[r#"
            error[not_finite] at t = 0.25 s: `root.y` is NaN
            help: its inputs: `u1` = -0.25, `u2` = -0.25
            block: root, rows: 1
        "#]],
    );
}

/// x' = 1000 x from 1 with fixed steps of 0.1 s and a lag behind it.
fn explosion(path: &str) -> Arc<Schedule> {
    let toy = Toy::new().with(path, Integrator(1.0), &["fast"]).with("fast", Gain(1000.0), &[path]);
    toy.with("lag", Lag(1.0), &[path]).schedule(&["lag"], 100.0, ode4(0.1), Steps)
}

#[test]
fn a_state_that_explodes_is_named_with_the_remedy() {
    let error = |path| Simulation::new(explosion(path)).unwrap().run(&mut Tape::default()).unwrap_err();
    let found = error("arm/tip");
    assert_eq!((found.code, found.path.as_deref()), ("step_size", Some("arm/tip")));
    assert!(found.message.contains(" for the state `arm/tip.x`; dx/dt = "), "{found}");
    let help = found.help.unwrap();
    assert!(help.starts_with("its inputs: `u` = ") && help.ends_with(REMEDY), "{help}");
    // States of a network have the paths of its members already.
    assert!(error("network(arm)").message.contains(" for the state `x`; "));
}

#[test]
fn a_state_that_is_not_finite_at_a_step_is_named_with_the_remedy() {
    let toy = Toy::new().with("x", Integrator(1e308), &["much"]).with("much", Constant(0.9e308), &[]);
    check(
        toy.schedule(&["x"], 10.0, ode4(1.0), Steps),
        expect![[r#"
        error[not_finite] at t = 1 s: `x.x` is inf
        help: its inputs: `u` = 9e307; use a smaller step or a method of variable step
        block: x, rows: 1
    "#]],
    );
}

const REMEDY: &str = "; use a smaller step or a method of variable step";

#[test]
fn of_many_inputs_only_the_suspicious_ones_are_told() {
    let toy = Toy::new().with("one", Constant(1.0), &[]).with("much", Constant(1e200), &[]);
    let names = ["one", "much", "one", "much", "one", "much", "one", "much", "one", "much"];
    check(
        toy.with("product", Product(10), &names).schedule(&["product"], 1.0, ode45(), Steps),
        expect![[r#"
            error[not_finite] at t = 0 s: `product.y` is inf
            help: its inputs: `u2` = 1e200, `u4` = 1e200, `u6` = 1e200, `u8` = 1e200 and 1 more
            block: product, rows: 0
        "#]],
    );
}

#[test]
fn a_block_that_gives_up_says_why() {
    let toy = Toy::new().with("one", Constant(1.0), &[]).with("x", Integrator(0.0), &["one"]);
    let toy = toy.with("fuse", Fuse(0.5), &["x"]);
    check(
        toy.schedule(&["fuse"], 1.0, ode4(0.125), Steps),
        expect![[r#"
            error[block_failed] at t = 0.5 s: `fuse` cannot go on: the fuse of 0.5 has blown
            block: fuse, rows: 4
        "#]],
    );
}

#[test]
fn switching_without_hysteresis_is_chatter() {
    let toy = Toy::new().with("x", Integrator(0.5), &["minus"]).with(
        "relay",
        Relay { low: 0.0, high: 0.0 },
        &["x"],
    );
    let schedule = toy.with("minus", Gain(-1.0), &["relay"]).schedule(&[], 1.0, ode45(), Steps);
    let error = Simulation::new(schedule).unwrap().run(&mut Tape::default()).unwrap_err();
    assert!((error.t - 0.5).abs() < 1e-8);
    let error = blocksim_sim::SimError { t: 0.5, ..error };
    expect![[r#"
        error[chatter] at t = 0.5 s: `relay` is chattering: it crosses zero at its guard `switch` again and again
        help: give the switching a hysteresis, or use a method of fixed step"#]]
    .assert_eq(&error.to_string());
}

#[test]
fn jumping_without_end_is_chatter() {
    check(
        Toy::new().with("restless", Restless, &[]).schedule(&[], 1.0, ode45(), Steps),
        expect![[r#"
            error[chatter] at t = 0 s: `restless` jumps without end
            help: it has jumped 1000 times at one instant; a jump must end its own cause
            block: restless, rows: 0
        "#]],
    );
}

#[test]
fn a_time_event_in_the_past_is_refused() {
    check(
        Toy::new().with("stubborn", Stubborn(0.5), &[]).schedule(&[], 1.0, ode45(), Steps),
        expect![[r#"
            error[time_event] at t = 0.5 s: `stubborn` gives 0.5 s as the time of its next event
            help: a time event must lie after the present time
            block: stubborn, rows: 2
        "#]],
    );
}

#[test]
fn a_pole_ends_with_the_name_of_the_state() {
    // x' = x^2, x(0) = 1 has a pole at t = 1.
    let toy = Toy::new().with("x", Integrator(1.0), &["square"]).with(
        "square",
        Function2(|a, b| a * b),
        &["x", "x"],
    );
    let schedule = toy.schedule(&[], 2.0, ode45(), Steps);
    let error = Simulation::new(schedule).unwrap().run(&mut Tape::default()).unwrap_err();
    assert_eq!((error.code, error.path.as_deref()), ("step_size", Some("x")));
    assert!((error.t - 1.0).abs() < 1e-6, "{}", error.t);
    assert!(error.message.contains("too long for the state `x.x`; dx/dt = "), "{}", error.message);
}

#[test]
fn settings_that_make_no_sense_are_refused() {
    check(
        Toy::new().with("t", Time, &[]).schedule(&[], 1.0, ode4(-0.1), Steps),
        expect![[r#"
            error[settings] at t = 0 s: the fixed step is -0.1
            help: the fixed step must be a number of seconds above zero
            block: -, rows: 0
        "#]],
    );
    check(
        Toy::new().with("t", Time, &[]).schedule(&[], f64::NAN, ode45(), Steps),
        expect![[r#"
            error[settings] at t = 0 s: the stop time is NaN
            help: the stop time must be a number of seconds, zero or more
            block: -, rows: 0
        "#]],
    );
}
