//! Slopes that follow from laws agree with differences, in all shipped diagrams, all examples and random models.

use std::sync::Arc;

use blocksim_block::schedule::{Schedule, Start};
use blocksim_sim::{Observer, Simulation};
use blocksim_tests::random::{Puzzle, Signals, Variant};
use blocksim_tests::{compile_file, compile_text, diagrams_below, root};

struct Nobody;

impl Observer for Nobody {
    fn row(&mut self, _t: f64, _values: &[f64]) {}
}

/// Runs are looked at up to this time, s.
const LONGEST: f64 = 0.5;
/// Difference of an exact slope and one by differences, as a part of both and of the largest slope of the model.
const CLOSE: (f64, f64) = (1e-7, 1e-10);
/// Difference of slopes over two distances, as a part of the slope, above which there is a kink between.
const KINKED: f64 = 1e-3;

/// Slopes that do not agree, how many were compared, and how many have a kink nearby.
fn compare(name: &str, mut schedule: Schedule, wrong: &mut Vec<String>, kinked: &mut usize) -> usize {
    schedule.settings.start = Start::Given;
    let end = schedule.settings.stop_time.min(LONGEST);
    let Ok(mut simulation) = Simulation::new(Arc::new(schedule)) else { return 0 };
    let mut compared = 0;
    for part in [0.31, 0.77] {
        if simulation.run_until(part * end, &mut Nobody).is_err() {
            break;
        }
        let Ok(Some(slopes)) = simulation.slopes() else { break };
        let largest = slopes.iter().map(|slope| slope.exact.abs()).fold(0.0, f64::max);
        compared += slopes.len();
        for slope in slopes {
            let (a, b) = (slope.exact, slope.difference);
            let agrees = (a - b).abs() <= CLOSE.0 * a.abs().max(b.abs()) + CLOSE.1 * largest;
            if slope.spread > KINKED * a.abs().max(b.abs()) {
                *kinked += 1;
            } else if !agrees {
                wrong.push(format!(
                    "{name}, {} s: d {} / d {}: {a}, but {b}",
                    part * end,
                    slope.derivative,
                    slope.state
                ));
            }
        }
    }
    compared
}

#[test]
fn slopes_of_laws_are_those_of_differences() {
    let paths = [diagrams_below("diagrams"), diagrams_below("docs/blocks")].concat();
    let (mut compared, mut wrong, mut kinked) = (0, Vec::new(), 0);
    for path in &paths {
        let name = path.strip_prefix(root()).expect("below the root").display().to_string();
        let Some(schedule) = compile_file(&name, &[]).0.schedule else { continue };
        compared += compare(&name, schedule, &mut wrong, &mut kinked);
    }
    for seed in 1..201 {
        let (compiled, problems) = compile_text(&Signals::of(seed).text(&Variant::plain()));
        let schedule = compiled.schedule.unwrap_or_else(|| panic!("signals {seed}: {problems}"));
        compared += compare(&format!("signals {seed}"), schedule, &mut wrong, &mut kinked);
    }
    assert!(wrong.is_empty(), "{} of {compared}:\n{}", wrong.len(), wrong.join("\n"));
    assert!(kinked < compared / 10, "{kinked} of {compared} have a kink nearby");
    assert!(compared > 300, "only {compared} slopes were compared");
}
