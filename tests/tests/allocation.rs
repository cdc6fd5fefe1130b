//! A run takes no memory as it goes on. A program of its own, because all that it does goes through an allocator that counts.

use std::process::Command;
use std::sync::Arc;

use blocksim_block::schedule::Schedule;
use blocksim_sim::{Observer, Simulation};
use blocksim_tests::{Desk, SMALL_DIAGRAMS, compile_with, root, schedule};
use divan::{AllocProfiler, Bencher};

#[global_allocator]
static ALLOCATIONS: AllocProfiler = AllocProfiler::system();

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
        counted.contains("loops")
            && counted.contains("small")
            && counted.contains("robot")
            && counted.contains("robotics"),
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

#[divan::bench(args = SMALL_DIAGRAMS)]
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

/// Two algebraic loops, one with branches.
#[divan::bench]
fn loops(bencher: Bencher) {
    let text = r#"Diagram(
        simulation: (stop_time: "2 s"),
        blocks: {
            "t": Ramp(slope: "3 1/s"), "e": Sum(signs: "+-"), "limit": Saturation(lower: -1, upper: 1), "k": Gain(k: 4),
            "cos": Function(function: Cos), "p": Product(inputs: 2), "x": Integrator, "show": Scope(inputs: ["x"]),
        },
        connections: [
            "t.y -> e.u1, p.u1", "e.y -> limit.u", "limit.y -> k.u", "k.y -> e.u2", "cos.y -> p.u2", "p.y -> cos.u, x.u", "x.y -> show.x",
        ],
    )"#;
    let schedule = || blocksim_tests::compile_text(text).0.schedule.expect("a sound diagram");
    bencher.with_inputs(|| started(schedule())).bench_refs(|sim| sim.run(&mut Last(0.0)).is_ok());
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
