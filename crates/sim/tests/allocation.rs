//! A simulation that runs takes no memory: the benchmark that counts allocations must count none.

use divan::{AllocProfiler, Bencher};

#[path = "engine/toys/mod.rs"]
mod toys;

use blocksim_block::schedule::OutputTimes::Every;
use blocksim_block::schedule::{Solver, VariableMethod};
use blocksim_sim::{Observer, Simulation};
use toys::*;

#[global_allocator]
static ALLOCATIONS: AllocProfiler = AllocProfiler::system();

/// Set in the process that counts.
const COUNTS: &str = "BLOCKSIM_COUNTS_ALLOCATIONS";

/// The profiler only tells what it counted in the table that it prints, so that another process has to print it.
fn main() {
    if std::env::var_os(COUNTS).is_some() {
        divan::Divan::default().sample_count(1).sample_size(1).run_benches();
        return;
    }
    let program = std::env::current_exe().expect("this program");
    let output =
        std::process::Command::new(program).env(COUNTS, "1").output().expect("a run of this program");
    let table = String::from_utf8(output.stdout).expect("text");
    assert!(table.contains("fixed_step") && table.contains("RosW3"), "{table}");
    let (counted, rest) = table.split_once("takes_memory").expect("the last of the table");
    assert!(!counted.contains("alloc:"), "{table}");
    assert!(rest.contains("alloc:"), "the counting works\n{table}");
}

struct Sum(f64);

impl Observer for Sum {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.0 += t + values.iter().sum::<f64>();
    }
}

/// Hits, jumps, zero crossings, time events, memories, implicit blocks and a grid of rows.
fn everything(solver: Solver) -> Simulation {
    let toy = Toy::new().with("t", Time, &[]).with("ball", Ball { height: 1.0, restitution: 0.9 }, &[]);
    let toy =
        toy.with("x", Integrator(0.0), &["minus"]).with("relay", Relay { low: -0.1, high: 0.1 }, &["x"]);
    let toy = toy.with("minus", Gain(-1.0), &["relay"]).with("step", StepAt(0.3), &[]);
    let toy = toy.with("hold", Hold(0.01), &["x"]).with("n", Counter(0.05), &[]).with("last", Memory, &["t"]);
    let toy = toy.with("sum", Function2(|a, b| a + b), &["hold", "step"]).with("lag", Lag(100.0), &["sum"]);
    let recorded = ["ball", "x", "lag", "n", "last"];
    Simulation::new(toy.schedule(&recorded, 2.0, solver, Every(0.003))).expect("a sound diagram")
}

#[divan::bench]
fn takes_memory() -> Vec<f64> {
    vec![0.5; 100]
}

#[divan::bench]
fn fixed_step(bencher: Bencher) {
    let diagram = || everything(ode4(0.001));
    bencher.with_inputs(diagram).bench_refs(|sim| sim.run(&mut Sum(0.0)).is_ok());
}

#[divan::bench(args = METHODS)]
fn every_method(bencher: Bencher, method: VariableMethod) {
    let solver = Solver::Variable { method, rtol: 1e-6, atol: Some(1e-9), max_step: 0.1 };
    bencher.with_inputs(|| everything(solver)).bench_refs(|sim| sim.run(&mut Sum(0.0)).is_ok());
}
