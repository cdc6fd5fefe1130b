//! What blocks and connections say of which derivatives a state acts on holds: each state is varied, and no other derivative changes.

use std::sync::Arc;

use blocksim_block::schedule::Schedule;
use blocksim_sim::{Observer, Simulation};
use blocksim_tests::random::{Circuit, Mechanisms, Puzzle, Sampled, Shafts, Signals, Variant};
use blocksim_tests::{compile_file, compile_text, diagrams_below, root};

struct Nobody;

impl Observer for Nobody {
    fn row(&mut self, _t: f64, _values: &[f64]) {}
}

/// Runs are looked at up to this time, s; the robot alone makes thousands of steps in a second.
const LONGEST: f64 = 0.5;

/// What is found at the start and at two times of a run, and how many states were varied.
fn look(name: &str, schedule: Schedule, wrong: &mut Vec<String>) -> usize {
    let end = schedule.settings.stop_time.min(LONGEST);
    // What cannot begin, or fails on the way, is somebody else's subject.
    let Ok(mut simulation) = Simulation::new(Arc::new(schedule)) else { return 0 };
    let mut varied = 0;
    for part in [0.0, 0.31, 0.77] {
        if simulation.run_until(part * end, &mut Nobody).is_err() {
            break;
        }
        let Ok(found) = simulation.undeclared() else { break };
        varied += simulation.states().len();
        wrong.extend(found.iter().map(|pair| {
            format!("{name}, {} s: d/dt {} depends on {}", part * end, pair.derivative, pair.state)
        }));
    }
    varied
}

#[test]
fn no_derivative_of_a_shipped_diagram_depends_on_more_than_it_says() {
    let paths = [diagrams_below("diagrams"), diagrams_below("docs/blocks")].concat();
    let (mut varied, mut wrong) = (0, Vec::new());
    for path in &paths {
        let name = path.strip_prefix(root()).expect("below the root").display().to_string();
        // Parts of models and files of moves are no runs.
        let Some(schedule) = compile_file(&name, &[]).0.schedule else { continue };
        varied += look(&name, schedule, &mut wrong);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(varied > 1000, "only {varied} states were varied");
}

fn random<P: Puzzle>(class: &str, wrong: &mut Vec<String>) -> usize {
    let of_seed = |seed: u64| {
        let (compiled, problems) = compile_text(&P::of(seed).text(&Variant::plain()));
        compiled.schedule.unwrap_or_else(|| panic!("{class} {seed}: {problems}"))
    };
    (1..61).map(|seed| look(&format!("{class} {seed}"), of_seed(seed), wrong)).sum()
}

#[test]
fn no_derivative_of_a_random_model_depends_on_more_than_it_says() {
    let mut wrong = Vec::new();
    let varied = random::<Signals>("signals", &mut wrong)
        + random::<Sampled>("sampled", &mut wrong)
        + random::<Circuit>("circuits", &mut wrong)
        + random::<Shafts>("shafts", &mut wrong)
        + random::<Mechanisms>("mechanisms", &mut wrong);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(varied > 1000, "only {varied} states were varied");
}
