//! Shafts of many discs: the cost grows in proportion to their number.

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

/// Seconds to compile and to run, and the speed at the driven end.
fn cost(n: usize) -> ([f64; 2], f64) {
    let text = shaft(n);
    let start = Instant::now();
    let (compiled, problems) = compile_text(&text);
    let schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    let compiled_in = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let run = run(schedule);
    assert!(run.error.is_none(), "{:?}", run.error);
    ([compiled_in, start.elapsed().as_secs_f64()], run.last("scope.w"))
}

#[test]
fn ten_times_as_many_discs_cost_about_ten_times_as_much() {
    let (_, _) = cost(100);
    let (few, end_of_few) = cost(100);
    let (many, end_of_many) = cost(1000);
    println!("100 discs: {few:?} s; 1000 discs: {many:?} s; {end_of_few} {end_of_many}");
    // The wave has not come back from the far end of either.
    assert!((end_of_few - end_of_many).abs() < 1e-3, "{end_of_few} {end_of_many}");
    assert!(many[1] < 20.0 * few[1], "{few:?} {many:?}");
}
