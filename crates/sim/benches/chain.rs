//! What the engine adds to the calls of the blocks.
//!
//! `cargo bench -p blocksim-sim`. A thousand gains between an integrator and its input, evaluated by the engine and by
//! loops written by hand: over the same blocks, and over trait objects that only map a number to a number, the least
//! that dynamic dispatch can cost. Goal: at most twice the time of the loop over blocks. The rows of allocation
//! counts, if there are any, mean that a running simulation takes memory, which it must not.

#[path = "../tests/engine/toys/mod.rs"]
mod toys;

use std::sync::Arc;
use std::time::{Duration, Instant};

use blocksim_block::schedule::OutputTimes::{Every, Steps};
use blocksim_block::{Block, Context, Fault, Scratch};
use blocksim_sim::{Observer, Simulation};
use divan::{AllocProfiler, Bencher, black_box};
use toys::{Ball, Counter, Function2, Gain, Hold, Integrator, Memory, Relay, StepAt, Time, Toy, ode4, ode45};

#[global_allocator]
static ALLOCATIONS: AllocProfiler = AllocProfiler::system();

const GAINS: usize = 1000;
const STEPS: usize = 100;

fn main() {
    print_ratios();
    divan::main();
}

/// Forgets everything.
struct Nobody;

impl Observer for Nobody {
    fn row(&mut self, _t: f64, values: &[f64]) {
        black_box(values);
    }
}

fn chain() -> Simulation {
    let mut toy = Toy::new();
    for i in 0..GAINS {
        let from = if i == 0 { "x".to_owned() } else { format!("k{:04}", i - 1) };
        toy = toy.with(&format!("k{i:04}"), Gain(0.9999), &[&from]);
    }
    let toy = toy.with("x", Integrator(1.0), &[&format!("k{:04}", GAINS - 1)]);
    let step = 1e-3;
    let schedule = toy.schedule(&["x"], step * STEPS as f64, ode4(step), Every(1.0));
    Simulation::new(schedule).expect("a sound diagram")
}

/// The least that dynamic dispatch can cost.
trait Node {
    fn output(&self, u: f64) -> f64;
}

struct Factor(f64);

impl Node for Factor {
    fn output(&self, u: f64) -> f64 {
        self.0 * u
    }
}

/// The chain and its integration with the classical Runge-Kutta method, written by hand.
fn by_hand(nodes: &[Box<dyn Node>], signals: &mut [f64], steps: usize) -> f64 {
    let mut derivative = |x: f64| {
        signals[0] = x;
        for (i, node) in nodes.iter().enumerate() {
            signals[i + 1] = node.output(signals[i]);
        }
        signals[nodes.len()]
    };
    integrate(&mut derivative, steps)
}

/// The same through the contract of blocks: what is left is the work of the engine itself.
fn by_contract(blocks: &[Arc<dyn Block>], signals: &mut [f64], steps: usize) -> f64 {
    let (fault, ports, mut evaluation) = (Fault::default(), [(0, 1)], 0);
    let mut scratch: Vec<Scratch> = blocks.iter().map(|block| block.scratch()).collect();
    let mut derivative = |x: f64| {
        signals[0] = x;
        evaluation += 1;
        for (i, (block, w)) in blocks.iter().zip(&mut scratch).enumerate() {
            let (before, y) = signals.split_at_mut(i + 1);
            let (x, d, u) = (&[], &[], &before[i..]);
            let c = Context {
                t: 0.0,
                x,
                d,
                u,
                inputs: &ports,
                outputs: &ports,
                evaluation,
                resolution: blocksim_block::Resolution::default(),
                seed: 0,
                fault: &fault,
            };
            block.outputs(0, &c, w, &mut y[..1]);
        }
        signals[blocks.len()]
    };
    integrate(&mut derivative, steps)
}

fn integrate(derivative: &mut dyn FnMut(f64) -> f64, steps: usize) -> f64 {
    let (h, mut x) = (1e-3, 1.0);
    for _ in 0..steps {
        let k1 = derivative(x);
        let k2 = derivative(x + 0.5 * h * k1);
        let k3 = derivative(x + 0.5 * h * k2);
        let k4 = derivative(x + h * k3);
        x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    x
}

fn blocks() -> (Vec<Arc<dyn Block>>, Vec<f64>) {
    ((0..GAINS).map(|_| Arc::new(Gain(0.9999)) as Arc<dyn Block>).collect(), vec![0.0; GAINS + 1])
}

fn nodes() -> (Vec<Box<dyn Node>>, Vec<f64>) {
    ((0..GAINS).map(|_| Box::new(Factor(0.9999)) as Box<dyn Node>).collect(), vec![0.0; GAINS + 1])
}

#[expect(clippy::print_stdout, reason = "the ratios are what this benchmark is for")]
fn print_ratios() {
    let fastest = |run: &mut dyn FnMut() -> Duration| (0..20).map(|_| run()).min().unwrap_or_default();
    let engine = fastest(&mut || {
        let mut sim = chain();
        let start = Instant::now();
        sim.run(&mut Nobody).expect("a run");
        start.elapsed()
    });
    let (nodes, mut signals) = nodes();
    let hand = fastest(&mut || {
        let start = Instant::now();
        black_box(by_hand(black_box(&nodes), &mut signals, STEPS));
        start.elapsed()
    });
    let (blocks, mut signals) = blocks();
    let contract = fastest(&mut || {
        let start = Instant::now();
        black_box(by_contract(black_box(&blocks), &mut signals, STEPS));
        start.elapsed()
    });
    let calls = (4 * STEPS * GAINS) as f64;
    let per_call = |time: Duration| time.as_secs_f64() / calls * 1e9;
    let ratio = |time: Duration| engine.as_secs_f64() / time.as_secs_f64();
    println!("engine: {:.2} ns per block", per_call(engine));
    println!("loop over blocks: {:.2} ns, ratio {:.2}", per_call(contract), ratio(contract));
    println!("loop over u -> y: {:.2} ns, ratio {:.2}", per_call(hand), ratio(hand));
}

#[divan::bench]
fn chain_by_engine(bencher: Bencher) {
    bencher.with_inputs(chain).bench_refs(|sim| sim.run(&mut Nobody).is_ok());
}

#[divan::bench]
fn chain_by_hand(bencher: Bencher) {
    let (nodes, mut signals) = nodes();
    bencher.bench_local(|| by_hand(black_box(&nodes), &mut signals, STEPS));
}

/// Everything at once: hits, jumps, zero crossings, time events, memories, a grid of rows.
#[divan::bench]
fn all_kinds_of_blocks(bencher: Bencher) {
    let diagram = || {
        let toy = Toy::new().with("t", Time, &[]).with("ball", Ball { height: 1.0, restitution: 0.9 }, &[]);
        let toy =
            toy.with("x", Integrator(0.0), &["minus"]).with("relay", Relay { low: -0.1, high: 0.1 }, &["x"]);
        let toy = toy.with("minus", Gain(-1.0), &["relay"]).with("step", StepAt(0.3), &[]);
        let toy =
            toy.with("hold", Hold(0.01), &["x"]).with("n", Counter(0.05), &[]).with("last", Memory, &["t"]);
        let toy = toy.with("sum", Function2(|a, b| a + b), &["hold", "step"]);
        let recorded = ["ball", "x", "sum", "n", "last"];
        Simulation::new(toy.schedule(&recorded, 2.0, ode45(), Every(0.003))).expect("a sound diagram")
    };
    bencher.with_inputs(diagram).bench_refs(|sim| sim.run(&mut Nobody).is_ok());
}

/// A controller of 1 kHz and a second order plant, 1 s.
#[divan::bench]
fn controller_of_a_kilohertz(bencher: Bencher) {
    let diagram = || {
        let toy = Toy::new().with("x", Integrator(1.0), &["v"]).with("v", Integrator(0.0), &["force"]);
        let toy = toy.with("hold", Hold(1e-3), &["x"]).with("force", Gain(-1.0), &["hold"]);
        Simulation::new(toy.schedule(&["x"], 1.0, ode45(), Steps)).expect("a sound diagram")
    };
    bencher.with_inputs(diagram).bench_refs(|sim| sim.run(&mut Nobody).is_ok());
}
