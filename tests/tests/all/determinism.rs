//! A run gives the same bits whenever, wherever and in whatever order it is written.

use std::sync::Arc;

use blocksim_block::methods::{METHODS, Method, MethodInfo};
use blocksim_block::schedule::{OutputTimes, Schedule, Solver};
use blocksim_sim::{Observer, Simulation};
use blocksim_tests::{Desk, SMALL_DIAGRAMS, compile_with, root, schedule};

/// Time and values of all rows, as bits.
#[derive(Default)]
struct Bits(Vec<u64>);

impl Observer for Bits {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.0.push(t.to_bits());
        self.0.extend(values.iter().map(|value| value.to_bits()));
    }
}

fn bits(schedule: &Arc<Schedule>) -> Vec<u64> {
    let mut bits = Bits::default();
    let mut simulation = Simulation::new(schedule.clone()).expect("a sound diagram");
    simulation.run(&mut bits).expect("a run");
    assert!(bits.0.len() > 40, "hardly anything was recorded");
    bits.0
}

#[test]
fn a_diagram_that_is_compiled_and_run_twice_gives_the_same_bits() {
    for path in SMALL_DIAGRAMS {
        assert!(bits(&schedule(path, &[]).into()) == bits(&schedule(path, &[]).into()), "{path}");
    }
}

#[test]
fn simulations_in_two_threads_share_one_schedule_and_give_the_bits_of_one() {
    for path in SMALL_DIAGRAMS {
        let schedule = Arc::new(schedule(path, &[]));
        // The threads come first: constants that are worked out when they are first used are worked out under both.
        let threads: Vec<Vec<u64>> = std::thread::scope(|scope| {
            let threads = [0, 1].map(|_| scope.spawn(|| bits(&schedule)));
            threads.map(|thread| thread.join().expect("a run")).into()
        });
        let alone = bits(&schedule);
        assert!(threads.iter().all(|bits| *bits == alone), "{path}");
    }
}

/// Turns the order of the blocks and of the connections of a diagram round; each stands on lines of its own.
fn turned_round(text: &str) -> String {
    let (head, rest) = text.split_once("    blocks: {\n").expect("blocks");
    let (blocks, rest) = rest.split_once("\n    },\n").expect("their end");
    let (between, rest) = rest.split_once("connections: [\n").expect("connections");
    let (connections, tail) = rest.split_once("\n    ],\n").expect("their end");
    let mut entries: Vec<String> = Vec::new();
    for line in blocks.lines() {
        // Lines of an entry that goes on are further in, or close it.
        match entries.last_mut() {
            Some(entry) if !line.starts_with("        \"") => entry.push_str(&format!("\n{line}")),
            _ => entries.push(line.to_owned()),
        }
    }
    entries.reverse();
    let connections: Vec<&str> = connections.lines().rev().collect();
    format!(
        "{head}    blocks: {{\n{}\n    }},\n{between}connections: [\n{}\n    ],\n{tail}",
        entries.join("\n"),
        connections.join("\n")
    )
}

#[test]
fn the_order_in_which_a_diagram_is_written_does_not_show() {
    for path in SMALL_DIAGRAMS {
        let text = std::fs::read_to_string(root().join(path)).expect("a diagram");
        let turned = turned_round(&text);
        assert_ne!(turned, text, "{path}");
        let file = root().join(path).with_file_name("turned_round.ron");
        let desk = Desk::new().with(&file.display().to_string(), &turned);
        let (compiled, problems) = compile_with(&desk, &file, &[]);
        let turned: Arc<Schedule> = compiled.schedule.unwrap_or_else(|| panic!("{path}:\n{problems}")).into();
        let written: Arc<Schedule> = schedule(path, &[]).into();
        let names = |schedule: &Schedule| {
            schedule.recorded.iter().map(|recorded| recorded.path.clone()).collect::<Vec<_>>()
        };
        assert_eq!(names(&turned), names(&written), "{path}");
        assert!(bits(&turned) == bits(&written), "{path}");
    }
}

/// Rows behind `at`, of a run that goes on there and of another one from its snapshot; and whether both end alike.
fn resumed(schedule: &Arc<Schedule>, at: f64) -> [Vec<u64>; 2] {
    let mut simulation = Simulation::new(schedule.clone()).expect("a sound diagram");
    simulation.run_until(at, &mut Bits::default()).expect("a run");
    let mut other = Simulation::new(schedule.clone()).expect("a sound diagram");
    other.restore(&simulation.snapshot()).expect("the same diagram");
    [simulation, other].map(|mut simulation| {
        let mut bits = Bits::default();
        simulation.run(&mut bits).expect("a run");
        assert!(!bits.0.is_empty(), "nothing is left at {at} s");
        bits.0
    })
}

#[test]
fn a_run_that_is_saved_and_restored_in_the_middle_gives_the_same_bits() {
    let mut fixed = schedule("diagrams/servo.ron", &[]);
    fixed.settings.solver = blocksim_block::schedule::Solver::Fixed {
        method: blocksim_block::schedule::FixedMethod::Ode4,
        step: 1e-3,
    };
    let fixed = Arc::new(fixed);
    let [straight, restored] = resumed(&fixed, 0.7);
    assert!(restored == straight);
    // A stop at the end of a step of fixed size changes nothing at all.
    assert!(bits(&fixed).ends_with(&straight));
    for path in SMALL_DIAGRAMS {
        let schedule = Arc::new(schedule(path, &[]));
        for part in [0.21, 0.57] {
            let [straight, restored] = resumed(&schedule, part * schedule.settings.stop_time);
            assert!(restored == straight, "{path}");
        }
    }
    // A circuit that is integrated apart, in the middle of a coupling step that is divided.
    let servo = crate::inverters::light_servo("Ode45(rtol: 1e-5)");
    let divided = Arc::new(blocksim_tests::compile_text(&servo).0.schedule.expect("a sound diagram"));
    assert!(bits(&divided) == bits(&divided));
    for at in [5.1e-3, 7.25e-3, 8e-3] {
        let [straight, restored] = resumed(&divided, at);
        assert!(restored == straight, "{at} s");
    }
    // An algebraic loop begins with its solution of the last step, which is kept.
    let text = r#"Diagram(simulation: (stop_time: "2 s"), blocks: { "t": Ramp(slope: "1 1/s"), "cos": Function(function: Cos),
        "p": Product(inputs: 2), "sum": Integrator, "show": Scope(inputs: ["y", "sum"]) },
        connections: [ "t.y -> p.u1", "cos.y -> p.u2", "p.y -> cos.u, show.y, sum.u", "sum.y -> show.sum" ])"#;
    let looped = Arc::new(blocksim_tests::compile_text(text).0.schedule.expect("a sound diagram"));
    let [straight, restored] = resumed(&looped, 0.7);
    assert!(restored == straight);
    // The robot, with gears whose losses are found by Newton's method, which must not begin where it ended last.
    for drive in ["drive=asm", "drive=asm_switched"] {
        let [straight, restored] =
            resumed(&Arc::new(schedule("diagrams/irb2600/irb2600.ron", &[drive])), 0.0317);
        assert!(restored == straight, "{drive}");
    }
}

/// A schedule with another method, and not longer than half a second.
fn by(info: &MethodInfo, mut schedule: Schedule) -> Arc<Schedule> {
    let settings = &mut schedule.settings;
    settings.stop_time = settings.stop_time.min(0.5);
    settings.solver = match info.method {
        Method::Fixed(method) => Solver::Fixed { method, step: 1e-4 },
        Method::Variable(method) => {
            Solver::Variable { method, rtol: 1e-4, atol: None, max_step: f64::INFINITY }
        }
    };
    schedule.into()
}

#[test]
fn every_method_gives_the_same_bits_again_in_any_order_in_threads_and_from_a_snapshot() {
    for path in SMALL_DIAGRAMS {
        let text = std::fs::read_to_string(root().join(path)).expect("a diagram");
        let file = root().join(path).with_file_name("turned_round.ron");
        let desk = Desk::new().with(&file.display().to_string(), &turned_round(&text));
        for info in &METHODS {
            let written = by(info, schedule(path, &[]));
            let once = bits(&written);
            let turned = compile_with(&desk, &file, &[]).0.schedule.expect("a sound diagram");
            assert!(bits(&by(info, turned)) == once, "{path}, {}: in another order", info.name);
            let [beside, again] = std::thread::scope(|scope| {
                [0, 1].map(|_| scope.spawn(|| bits(&written))).map(|thread| thread.join().expect("a run"))
            });
            assert!(beside == once && again == once, "{path}, {}: in threads", info.name);
            let [straight, restored] = resumed(&written, 0.43 * written.settings.stop_time);
            assert!(restored == straight, "{path}, {}: resumed", info.name);
        }
    }
}

#[test]
fn a_long_run_records_what_was_asked_for_and_no_more() {
    let mut schedule = schedule("diagrams/servo.ron", &[]);
    schedule.settings.stop_time = 2000.0;
    schedule.settings.output = OutputTimes::Every(100.0);
    let columns = schedule.recorded.len();
    let states = (schedule.states, schedule.discrete);
    let schedule = Arc::new(schedule);
    let mut simulation = Simulation::new(schedule.clone()).expect("a sound diagram");
    let mut rows = Bits::default();
    simulation.run(&mut rows).expect("a run");
    let grid: Vec<f64> = (0..=20).map(|k| 100.0 * f64::from(k)).collect();
    let times: Vec<f64> = rows.0.chunks(columns + 1).map(|row| f64::from_bits(row[0])).collect();
    assert!(grid.iter().all(|t| times.contains(t)), "{times:?}");
    // Between the times of the grid there are the two rows of the step and one or two for each event, of which clamping
    // has some hundred while the error passes zero to and fro within the tolerance.
    let counts = simulation.counts();
    let most = grid.len() + 2 + 2 * usize::try_from(counts.events).expect("a number");
    assert!(times.len() <= most, "{} rows and {} events: {times:?}", times.len(), counts.events);
    assert!(counts.major > 100_000 && times.len() < 1000, "{} rows of {} steps", times.len(), counts.major);
    assert_eq!((simulation.states().len(), schedule.discrete), states);
}
