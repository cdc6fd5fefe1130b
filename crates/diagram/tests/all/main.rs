//! The examples run, and what they print is right; conditional subsystems; blocks that are written alike.

mod alike;
mod coinciding;
mod conditional;
mod conditional_kinds;
mod merges;
mod texts;

#[allow(dead_code)]
#[path = "../../examples/own_controller.rs"]
mod own_controller;
#[allow(dead_code)]
#[path = "../../examples/run_a_diagram.rs"]
mod run_a_diagram;

/// The step response of two lags in a row: 1 - (T1 exp(-t/T1) - T2 exp(-t/T2)) / (T1 - T2).
#[test]
fn a_diagram_that_rust_builds_gives_the_closed_form() {
    let rows = run_a_diagram::run().expect("it runs");
    assert!(rows.len() > 10, "{rows:?}");
    let (t1, t2) = (0.5, 1.0);
    for (t, y) in rows {
        let expected = 1.0 - (t1 * f64::exp(-t / t1) - t2 * f64::exp(-t / t2)) / (t1 - t2);
        assert!((y - expected).abs() < 1e-5, "at {t} s {y}, and not {expected}");
    }
}

#[test]
fn a_controller_in_rust_takes_out_the_error() {
    let [set, actual] = own_controller::run().expect("it runs");
    assert_eq!(set, 1.0);
    assert!((actual - set).abs() < 0.01, "{actual}");
    assert!((actual - set).abs() > 1e-12, "the plant has not moved by itself");
}
