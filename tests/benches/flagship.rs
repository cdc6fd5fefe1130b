//! How much faster than real time the robot runs, and what one evaluation costs compared with its dynamics alone.
//!
//! `cargo bench -p blocksim-tests --bench flagship`

use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

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

#[expect(clippy::print_stdout, reason = "a benchmark shows its figures")]
fn main() {
    println!(
        "{:<34} {:>12} {:>12} {:>14}",
        "ABB IRB 2600, demo move", "x real time", "evaluations", "ns/evaluation"
    );
    let mut fastest = Vec::new();
    for drive in ["dc", "asm", "torque"] {
        for rtol in ["shipped", "1e-6"] {
            let over = format!("drive={drive}");
            let (compiled, problems) = compile_file("diagrams/irb2600/irb2600.ron", &[&over]);
            let Some(mut schedule) = compiled.schedule else { panic!("{problems}") };
            if rtol != "shipped"
                && let blocksim_block::schedule::Solver::Variable { rtol, atol, .. } =
                    &mut schedule.settings.solver
            {
                (*rtol, *atol) = (1e-6, 1e-6);
            }
            let (wall, evaluations) = best(&Arc::new(schedule.clone()));
            let factor = schedule.settings.stop_time / wall.as_secs_f64();
            let each = wall.as_nanos() as f64 / evaluations as f64;
            println!(
                "{:<34} {factor:>12.1} {evaluations:>12} {each:>14.0}",
                format!("{drive}, tolerance {rtol}")
            );
            fastest.push((drive, factor));
        }
    }
    let over = "drive=asm_switched";
    let (compiled, problems) = compile_file("diagrams/irb2600/irb2600.ron", &[over]);
    let Some(schedule) = compiled.schedule else { panic!("{problems}") };
    let (wall, evaluations) = best(&Arc::new(schedule.clone()));
    let switched = schedule.settings.stop_time / wall.as_secs_f64();
    let each = wall.as_nanos() as f64 / evaluations as f64;
    println!("{:<34} {switched:>12.1} {evaluations:>12} {each:>14.0}", "asm, every edge at 8 kHz");
    println!("asm averaged / asm with every edge: {:.1}", fastest[2].1 / switched);
    let dc = fastest[0].1;
    println!("asm / dc, shipped tolerance: {:.2}", fastest[2].1 / dc);
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
