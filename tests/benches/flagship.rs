//! How much faster than real time the robot runs, and what one evaluation costs compared with its dynamics alone.
//!
//! `cargo bench -p blocksim-tests --bench flagship`; words behind ` -- ` choose cases: `-- dc shipped`.

use std::collections::BTreeMap;
use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

use blocksim_block::schedule::Solver;
use blocksim_sim::{Observer, Simulation};
use blocksim_tests::compile_file;

/// Runs of each case; the fastest counts, because the others were disturbed.
const RUNS: usize = 7;

/// Takes the rows and forgets them.
struct Forget;

impl Observer for Forget {
    fn row(&mut self, _t: f64, values: &[f64]) {
        black_box(values);
    }
}

/// A drive of the robot, and how exactly it is integrated.
const CASES: [(&str, &str, Option<f64>); 7] = [
    ("dc, tolerance shipped", "dc", None),
    ("dc, tolerance 1e-6", "dc", Some(1e-6)),
    ("asm, tolerance shipped", "asm", None),
    ("asm, tolerance 1e-6", "asm", Some(1e-6)),
    ("torque, tolerance shipped", "torque", None),
    ("torque, tolerance 1e-6", "torque", Some(1e-6)),
    ("asm, every edge at 8 kHz", "asm_switched", None),
];

#[expect(clippy::print_stdout, reason = "a benchmark shows its figures")]
fn main() {
    // Cargo adds an option of its own.
    let wanted: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    println!(
        "{:<34} {:>12} {:>12} {:>14}",
        "ABB IRB 2600, demo move", "x real time", "evaluations", "ns/evaluation"
    );
    let mut factors = BTreeMap::new();
    for (name, drive, tolerance) in CASES {
        if !wanted.iter().all(|word| name.contains(word)) {
            continue;
        }
        let (compiled, problems) = compile_file("diagrams/irb2600/irb2600.ron", &[&format!("drive={drive}")]);
        let Some(mut schedule) = compiled.schedule else { panic!("{problems}") };
        if let (Some(tolerance), Solver::Variable { rtol, atol, .. }) =
            (tolerance, &mut schedule.settings.solver)
        {
            (*rtol, *atol) = (tolerance, Some(tolerance));
        }
        let stop = schedule.settings.stop_time;
        let (wall, evaluations) = best(&Arc::new(schedule));
        let factor = stop / wall.as_secs_f64();
        let each = wall.as_nanos() as f64 / evaluations as f64;
        println!("{name:<34} {factor:>12.1} {evaluations:>12} {each:>14.0}");
        let one_word: String = name.chars().map(|c| if c == ' ' { '_' } else { c }).collect();
        println!("time flagship/{one_word} {:.4e} s", wall.as_secs_f64());
        factors.insert(name, factor);
    }
    for (what, of, over) in [
        ("asm averaged / asm with every edge", CASES[2].0, CASES[6].0),
        ("asm / dc, shipped tolerance", CASES[2].0, CASES[0].0),
    ] {
        if let (Some(of), Some(over)) = (factors.get(of), factors.get(over)) {
            println!("{what}: {:.2}", of / over);
        }
    }
}

fn best(schedule: &Arc<blocksim_block::schedule::Schedule>) -> (Duration, u64) {
    let mut best = (Duration::MAX, 1);
    for _ in 0..RUNS {
        let mut simulation = Simulation::new(schedule.clone()).expect("a schedule that runs");
        let start = Instant::now();
        simulation.run(&mut Forget).expect("a run without failure");
        let wall = start.elapsed();
        if wall < best.0 {
            best = (wall, simulation.counts().evaluations);
        }
    }
    best
}
