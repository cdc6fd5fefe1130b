//! Shafts of many discs: the cost of an evaluation grows in proportion to their number.

use std::fmt::Write;
use std::time::Instant;

use blocksim_tests::{compile_text, run};

/// Discs in a row, joined by springs and dampers, driven at one end.
fn shaft(n: usize) -> String {
    let (mut blocks, mut wires) = (String::new(), String::new());
    write!(
        blocks,
        r#""push": IdealTorqueSource, "swing": Sine(amplitude: "1 N*m", frequency: "2 Hz"), "frame": RotationalReference,
           "sensor": MotionSensor, "scope": Scope(inputs: ["w"])"#
    )
    .unwrap();
    write!(
        wires,
        r#""swing.y -> push.tau", "push.r <-> disc0.r <-> sensor.r", "push.c <-> sensor.c <-> frame.r", "sensor.w -> scope.w""#
    )
    .unwrap();
    for i in 0..n {
        write!(blocks, r#", "disc{i}": Inertia(j: 0.01)"#).unwrap();
        if i > 0 {
            let before = i - 1;
            write!(blocks, r#", "spring{i}": RotationalSpringDamper(k: 100.0, d: 0.01)"#).unwrap();
            write!(wires, r#", "disc{before}.r <-> spring{i}.r", "spring{i}.c <-> disc{i}.r""#).unwrap();
        }
    }
    format!(
        "Diagram(simulation: (stop_time: \"0.5 s\", solver: Ode45), blocks: {{ {blocks} }}, connections: [ {wires} ])"
    )
}

#[test]
fn a_thousand_discs_run_in_a_moment() {
    let run_of = |n: usize| {
        let (compiled, problems) = compile_text(&shaft(n));
        let schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
        let start = Instant::now();
        let run = run(schedule);
        assert!(run.error.is_none(), "{:?}", run.error);
        (run.last("scope.w"), run.counts.evaluations, start.elapsed())
    };
    let (few, many) = (run_of(100), run_of(1000));
    // The wave has not come back from the far end of either.
    assert!((few.0 - many.0).abs() < 1e-3, "{few:?} {many:?}");
    assert!(many.1 < 2 * few.1, "{few:?} {many:?}");
    // Measured are 0.15 s without optimisation; with full matrices it takes minutes.
    assert!(many.2.as_secs_f64() < 5.0, "{few:?} {many:?}");
}
