//! Tests of the integrator, apart because it has many modes.

use super::super::units::testing::{interface_with, output_unit, vector};
use super::*;
use blocksim_block::testing::Bench;

fn plain() -> Integrator {
    Integrator { x0: None, lower: None, upper: None, reset: Reset::None, external: false, wrap: None }
}

#[test]
fn a_constant_input_gives_a_ramp() {
    let mut bench = Bench::new(Integrator { x0: Some((-1.0).into()), ..plain() });
    bench.set(0, &[2.0]).integrate(3.0, 7);
    assert!((bench.minor()[0] - 5.0).abs() < 1e-14);
}

#[test]
fn vectors_are_integrated_element_by_element() {
    let mut bench = Bench::with_inputs(plain(), vector("u", 3));
    bench.set(0, &[1.0, -2.0, 0.5]).integrate(2.0, 4);
    assert_eq!(bench.minor(), [2.0, -4.0, 1.0]);
}

#[test]
fn a_plain_integrator_carries_no_ballast() {
    let interface = Bench::new(plain()).interface;
    assert!(interface.discrete.is_empty() && interface.guards.is_empty() && !interface.jumps);
    assert!(!interface.reads(0, 0));
}

#[test]
fn the_state_lands_on_the_limit_stays_and_leaves_when_the_input_turns() {
    let block = Integrator { lower: Some(-1.0), upper: Some(1.0), ..plain() };
    let mut bench = Bench::new(block);
    bench.set(0, &[3.0]).integrate(1.0, 10);
    assert_eq!(bench.x, [1.0]);
    assert_eq!(bench.guards()[0], 3.0);
    assert_eq!(bench.derivatives(), [0.0]);
    bench.set(0, &[-0.5]);
    assert_eq!(bench.derivatives(), [-0.5]);
    bench.major();
    assert_eq!(bench.guards(), [0.0, 2.0]);
    bench.integrate(1.0, 10);
    assert!((bench.x[0] - 0.5).abs() < 1e-15);
    bench.set(0, &[-3.0]).integrate(1.0, 10);
    assert_eq!(bench.x, [-1.0]);
    assert_eq!(bench.derivatives(), [0.0]);
}

#[test]
fn only_given_limits_have_guards() {
    let block = Integrator { upper: Some(1.0), ..plain() };
    let guards = block.interface(&Given::nothing()).unwrap().guards;
    assert_eq!(guards.iter().map(|guard| guard.name.as_str()).collect::<Vec<_>>(), ["upper"]);
}

#[test]
fn an_input_of_zero_keeps_the_state_on_the_limit_and_any_later_input_counts_inwards_alone() {
    let mut bench = Bench::new(Integrator { x0: Some(1.0.into()), upper: Some(1.0), ..plain() });
    bench.major();
    bench.set(0, &[5.0]);
    assert_eq!(bench.derivatives(), [0.0]);
    bench.set(0, &[-5.0]);
    assert_eq!(bench.derivatives(), [-5.0]);
}

#[test]
fn an_angle_wraps_by_its_span() {
    let wrap = Some(Wrap { lower: -180.0, upper: 180.0 });
    let mut bench = Bench::new(Integrator { x0: Some(170.0.into()), wrap, ..plain() });
    bench.set(0, &[10.0]).integrate(2.0, 4);
    assert_eq!(bench.x, [-170.0]);
    bench.set(0, &[-10.0]).integrate(2.0, 4);
    assert_eq!(bench.x, [170.0]);
}

#[test]
fn a_wrapped_value_is_never_the_excluded_end() {
    use std::f64::consts::PI;
    assert_eq!(wrapped(PI, -PI, PI), -PI);
    let x = wrapped((-PI).next_down(), -PI, PI);
    assert!(x < PI && x > PI - 1e-9, "{x}");
    assert_eq!(wrapped(x, -PI, PI), x);
    assert!((wrapped(7.0 * PI, -PI, PI) + PI).abs() < 1e-14);
}

#[test]
fn a_rising_edge_sets_the_state_back_once() {
    let mut bench = Bench::new(Integrator { x0: Some(2.0.into()), reset: Reset::Rising, ..plain() });
    bench.set(0, &[1.0]).set(1, &[-1.0]).integrate(1.0, 1);
    assert_eq!(bench.x, [3.0]);
    bench.set(1, &[0.5]).major();
    assert_eq!(bench.x, [2.0]);
    bench.integrate(1.0, 1);
    assert_eq!(bench.x, [3.0]);
    assert_eq!(bench.guards(), [0.5]);
}

#[test]
fn a_level_holds_the_state() {
    let mut bench = Bench::new(Integrator { x0: Some(2.0.into()), reset: Reset::Level, ..plain() });
    bench.set(0, &[1.0]).set(1, &[1.0]);
    bench.major();
    bench.integrate(1.0, 4);
    assert_eq!(bench.x, [2.0]);
    bench.set(1, &[0.0]).major();
    bench.integrate(1.0, 4);
    assert_eq!(bench.x, [3.0]);
}

#[test]
fn an_external_value_is_used_at_the_start_and_at_a_reset() {
    let mut bench = Bench::new(Integrator { reset: Reset::Falling, external: true, ..plain() });
    bench.set(1, &[1.0]).set(2, &[7.0]);
    assert_eq!(bench.major(), [7.0]);
    bench.set(2, &[9.0]);
    assert_eq!(bench.major(), [7.0]);
    bench.set(1, &[-1.0]);
    assert_eq!(bench.major(), [9.0]);
}

#[test]
fn a_given_start_stands_before_the_external_value() {
    let mut bench =
        Bench::new(Integrator { x0: Some(5.0.into()), reset: Reset::Rising, external: true, ..plain() });
    bench.set(1, &[-1.0]).set(2, &[7.0]);
    assert_eq!(bench.major(), [5.0]);
    bench.set(1, &[1.0]);
    assert_eq!(bench.major(), [7.0]);
}

#[test]
fn a_value_that_is_no_number_is_set_once() {
    let mut bench = Bench::new(Integrator { external: true, ..plain() });
    bench.set(1, &[f64::NAN]);
    assert!(bench.major()[0].is_nan());
}

#[test]
fn a_bouncing_ball_turns_its_velocity_without_an_algebraic_loop() {
    let velocity = Integrator { x0: Some(0.0.into()), reset: Reset::Falling, external: true, ..plain() };
    let mut bench = Bench::new(velocity);
    assert!((0..3).all(|input| !bench.interface.reads(0, input)));
    bench.set(0, &[-9.81]).set(1, &[1.0]).set(2, &[0.0]);
    bench.major();
    bench.integrate(1.0, 10);
    let v = bench.minor()[0];
    bench.set(1, &[-1e-9]).set(2, &[-0.8 * v]).major();
    assert!((bench.x[0] - 0.8 * 9.81).abs() < 1e-12);
    // At the same instant the input follows the new velocity; that is no second bounce.
    let v = bench.x[0];
    bench.set(2, &[-0.8 * v]).major();
    assert_eq!(bench.x[0], v);
}

#[test]
fn a_reset_beyond_a_limit_ends_on_it() {
    let block = Integrator { upper: Some(1.0), external: true, ..plain() };
    let mut bench = Bench::new(block);
    bench.set(0, &[1.0]).set(1, &[5.0]);
    assert_eq!(bench.major(), [1.0]);
}

#[test]
fn a_bool_trigger_needs_no_guard() {
    let block = Integrator { reset: Reset::Rising, ..plain() };
    let given =
        Given::new(vec![("reset".to_owned(), PortType::boolean())], blocksim_block::ParamUnits::default());
    assert!(block.interface(&given).unwrap().guards.is_empty());
    let guards = block.interface(&Given::nothing()).unwrap().guards;
    assert_eq!((guards[0].name.as_str(), guards[0].crossing), ("reset", Crossing::Rising));
}

#[test]
fn the_unit_is_that_of_the_input_times_seconds() {
    assert_eq!(output_unit(&plain(), &[("u", "m/s")], &[]), "m");
    assert_eq!(output_unit(&plain(), &[("u", "m/s")], &[("x0", "km")]), "m");
    assert_eq!(plain().interface(&Given::nothing()).unwrap().outputs[0].port_type.dimension, None);
    let external = Integrator { external: true, ..plain() };
    assert_eq!(output_unit(&external, &[("x0", "V")], &[]), "V");
    let error = interface_with(&plain(), &[("u", "m/s")], &[("upper", "kg")]).unwrap_err();
    assert_eq!(output_unit(&plain(), &[], &[("x0", "V")]), "V");
    assert_eq!(error.code, "unit_mismatch");
    assert!(error.message.contains("`upper` is in kg"), "{}", error.message);
}

#[test]
fn parameters_that_contradict_each_other_are_refused() {
    let wrap = Some(Wrap { lower: 0.0, upper: 1.0 });
    let refused = [
        (Integrator { x0: Some(f64::NAN.into()), ..plain() }, "x0"),
        (Integrator { lower: Some(1.0), upper: Some(-1.0), ..plain() }, "upper"),
        (Integrator { x0: Some(3.0.into()), upper: Some(1.0), ..plain() }, "x0"),
        (Integrator { upper: Some(1.0), wrap, ..plain() }, "wrap"),
        (Integrator { wrap: Some(Wrap { lower: 1.0, upper: 1.0 }), ..plain() }, "wrap.upper"),
    ];
    for (block, param) in refused {
        assert_eq!(block.errors()[0].param, param);
    }
}

#[test]
fn each_element_of_a_vector_starts_at_its_own_value() {
    let x0 = Entries::try_from(vec![1.0, -2.0, 3.0]).unwrap();
    let block = Integrator { x0: Some(x0.clone()), reset: Reset::Rising, ..plain() };
    // One input integrates into three states.
    let scalar = vec![("u".to_owned(), PortType::scalar()), ("reset".to_owned(), PortType::scalar())];
    let mut bench = Bench::with_inputs(block.clone(), scalar);
    bench.set(0, &[2.0]).set(1, &[-1.0]).major();
    assert_eq!(bench.integrate(0.5, 1).major(), [2.0, -1.0, 4.0]);
    assert_eq!(bench.set(1, &[1.0]).major(), [1.0, -2.0, 3.0]);
    let error = block.interface(&Given::new(vector("u", 2), Default::default())).unwrap_err();
    assert_eq!(error.message, "`u` is a vector of 2, but the parameters ask for a vector of 3");
    let limited = Integrator { x0: Some(x0), upper: Some(2.0), ..plain() };
    assert_eq!(limited.errors()[0].message, "`x0[2]` is 3, but must be at most `upper`, which is 2");
}
