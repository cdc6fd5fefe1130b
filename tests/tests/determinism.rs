//! A run gives the same bits whenever, wherever and in whatever order it is written; and it takes no memory as it goes on.

use std::process::Command;
use std::sync::Arc;

use blocksim_block::schedule::{OutputTimes, Schedule};
use blocksim_sim::{Observer, Simulation};
use blocksim_tests::{Desk, compile_file, compile_with, root};
use divan::{AllocProfiler, Bencher};

#[global_allocator]
static ALLOCATIONS: AllocProfiler = AllocProfiler::system();

/// Time and values of all rows, as bits.
#[derive(Default)]
struct Bits(Vec<u64>);

impl Observer for Bits {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.0.push(t.to_bits());
        self.0.extend(values.iter().map(|value| value.to_bits()));
    }
}

fn schedule(path: &str, overrides: &[&str]) -> Schedule {
    let (compiled, problems) = compile_file(path, overrides);
    compiled.schedule.unwrap_or_else(|| panic!("{problems}"))
}

fn bits(schedule: &Arc<Schedule>) -> Vec<u64> {
    let mut bits = Bits::default();
    let mut simulation = Simulation::new(schedule.clone()).expect("a sound diagram");
    simulation.run(&mut bits).expect("a run");
    assert!(bits.0.len() > 40, "hardly anything was recorded");
    bits.0
}

const DIAGRAMS: [&str; 6] = [
    "diagrams/servo.ron",
    "diagrams/dc_motor_start.ron",
    "diagrams/asm_direct_on_line.ron",
    "diagrams/pendulum.ron",
    "diagrams/bouncing_mass.ron",
    "diagrams/pid_anti_windup.ron",
];

#[test]
fn a_diagram_that_is_compiled_and_run_twice_gives_the_same_bits() {
    for path in DIAGRAMS {
        assert!(bits(&schedule(path, &[]).into()) == bits(&schedule(path, &[]).into()), "{path}");
    }
}

#[test]
fn simulations_in_two_threads_share_one_schedule_and_give_the_bits_of_one() {
    for path in DIAGRAMS {
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
    for path in DIAGRAMS {
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
    for path in DIAGRAMS {
        let schedule = Arc::new(schedule(path, &[]));
        for part in [0.21, 0.57] {
            let [straight, restored] = resumed(&schedule, part * schedule.settings.stop_time);
            assert!(restored == straight, "{path}");
        }
    }
    // The robot, with gears whose losses are found by Newton's method, which must not begin where it ended last.
    for drive in ["drive=asm", "drive=asm_switched"] {
        let [straight, restored] =
            resumed(&Arc::new(schedule("diagrams/irb2600/irb2600.ron", &[drive])), 0.0317);
        assert!(restored == straight, "{drive}");
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

/// Set in the process that counts allocations.
const COUNTS: &str = "BLOCKSIM_COUNTS_ALLOCATIONS";

/// The profiler only tells what it counted in the table that it prints, so another process has to print it.
#[test]
fn diagrams_take_no_memory_while_they_run() {
    if std::env::var_os(COUNTS).is_some() {
        divan::Divan::default().sample_count(1).sample_size(1).run_benches();
        return;
    }
    let program = std::env::current_exe().expect("this program");
    let name = "diagrams_take_no_memory_while_they_run";
    let output = Command::new(program).args(["--exact", name, "--nocapture"]).env(COUNTS, "1").output();
    let table = String::from_utf8(output.expect("a run of this program").stdout).expect("text");
    let (counted, rest) =
        table.split_once("takes_memory").unwrap_or_else(|| panic!("the table is cut off:\n{table}"));
    assert!(
        counted.contains("small") && counted.contains("robot") && counted.contains("robotics"),
        "{table}"
    );
    assert!(!counted.contains("alloc:"), "{table}");
    assert!(rest.contains("alloc:"), "the counting works\n{table}");
}

struct Last(f64);

impl Observer for Last {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.0 += t + values.iter().sum::<f64>();
    }
}

#[divan::bench]
fn takes_memory() -> Vec<f64> {
    vec![0.5; 100]
}

/// All memory is taken here.
fn started(schedule: Schedule) -> Simulation {
    Simulation::new(Arc::new(schedule)).expect("a sound diagram")
}

#[divan::bench(args = DIAGRAMS)]
fn small(bencher: Bencher, path: &str) {
    bencher.with_inputs(|| started(schedule(path, &[]))).bench_refs(|sim| sim.run(&mut Last(0.0)).is_ok());
}

#[divan::bench(args = ["drive=dc", "drive=asm", "drive=torque", "control=central"])]
fn robot(bencher: Bencher, set: &str) {
    let diagram = || {
        let mut schedule = schedule("diagrams/irb2600/irb2600.ron", &[set]);
        schedule.settings.stop_time = 0.1;
        started(schedule)
    };
    bencher.with_inputs(diagram).bench_refs(|sim| sim.run(&mut Last(0.0)).is_ok());
}

/// All blocks of robots on a move, of an arm with a closed form and of one without.
#[divan::bench(args = ["irb2600", "scara"])]
fn robotics(bencher: Bencher, robot: &str) {
    let (parameters, path) = match robot {
        "scara" => ("", "File(\"pick.ron\")"),
        _ => ("\"robot\": File(\"../../params/irb2600.ron\"),", "File(\"moves/demo_linear.ron\")"),
    };
    let text = format!(
        "Diagram(
            parameters: {{ {parameters} \"manipulator\": File(\"manipulator.ron\"), \"move\": {path} }},
            simulation: (stop_time: \"0.3 s\", output: Every(\"10 ms\")),
            record: [\"*.*\"],
            blocks: {{
                \"move\": RobotMove(robot: \"manipulator\", path: \"move\"),
                \"before\": RobotMove(robot: \"manipulator\", path: \"move\", delay: \"20 ms\"),
                \"forward\": ForwardKinematics(robot: \"manipulator\"),
                \"inverse\": InverseKinematics(robot: \"manipulator\"),
                \"jacobian\": Jacobian(robot: \"manipulator\"),
                \"dynamics\": InverseDynamics(robot: \"manipulator\", drives: true),
                \"gravity\": GravityCompensation(robot: \"manipulator\"),
                \"error\": PathError,
            }},
            connections: [
                \"move.q -> forward.q, jacobian.q, dynamics.q, gravity.q\",
                \"before.q -> inverse.near\", \"move.qd -> dynamics.qd\", \"move.qdd -> dynamics.qdd\",
                \"forward.p -> inverse.p, error.actual\", \"forward.zyx -> inverse.zyx\",
                \"move.p -> error.set\", \"move.v -> error.v\",
            ],
        )"
    );
    let path = root().join(format!("diagrams/{robot}/all_blocks.ron"));
    let diagram = || {
        let desk = Desk::new().with(path.to_str().expect("a path"), &text);
        let (compiled, problems) = compile_with(&desk, &path, &[]);
        started(compiled.schedule.unwrap_or_else(|| panic!("{problems}")))
    };
    bencher.with_inputs(diagram).bench_refs(|sim| sim.run(&mut Last(0.0)).is_ok());
}
