//! How far a run is from a more exact one.

use std::sync::Arc;

use blocksim_block::schedule::OutputTimes::{Every, Steps};
use blocksim_block::schedule::{Schedule, Solver, StateTolerance, VariableMethod};
use blocksim_signal::Dimension;
use blocksim_sim::{Control, Simulation, Verification, verify};

use crate::toys::*;

fn loose(rtol: f64) -> Solver {
    Solver::Variable { method: VariableMethod::Ode45, rtol, atol: None, max_step: f64::INFINITY }
}

/// x'' = -x from x = 1.
fn oscillator() -> Toy {
    let toy = Toy::new().with("v", Integrator(0.0), &["force"]).with("x", Integrator(1.0), &["v"]);
    toy.with("force", Gain(-1.0), &["x"])
}

fn verified(schedule: &Schedule) -> Verification {
    verify(schedule, &mut || Control::Go).unwrap().unwrap()
}

#[test]
fn what_a_more_exact_run_differs_by_is_the_error() {
    for (solver, worst) in [(loose(1e-3), 0.3), (loose(1e-6), 1e-4), (ode4(0.2), 0.1)] {
        let schedule = oscillator().schedule(&["x"], 100.0, solver, Steps);
        let found = verified(&schedule);
        // The same run on a grid of which many points are near those compared.
        let mut tape = Tape::default();
        let grid = oscillator().schedule(&["x"], 100.0, solver, Every(0.01));
        Simulation::new(grid).unwrap().run(&mut tape).unwrap();
        let error = tape.rows.iter().map(|(t, row)| (row[0] - t.cos()).abs()).fold(0.0, f64::max);
        let [difference] = &found.differences[..] else { panic!("{found:?}") };
        // A step half as long leaves a sixteenth of the error.
        assert!((difference.amount / error - 1.0).abs() < 0.08, "{solver:?}: {error} {difference:?}");
        assert!(
            (difference.share - difference.amount / 2.0).abs() < 0.06 * difference.share,
            "{difference:?}"
        );
        assert!(difference.share < worst && difference.t > 50.0, "{difference:?}");
        assert!(found.points > 1000 && found.events == (0, 0));
    }
}

#[test]
fn a_jump_that_comes_a_moment_later_is_no_difference() {
    let toy = || oscillator().with("sign", Sign, &["x"]).with("sum", Integrator(0.0), &["sign"]);
    let found = verified(&toy().schedule(&["sign", "sum"], 100.0, loose(1e-3), Steps));
    assert_eq!(found.events, (32, 32));
    // The integral tells what the moments add up to; the sign itself differs nowhere.
    assert_eq!(found.differences.iter().map(|found| found.recorded).collect::<Vec<_>>(), [1], "{found:?}");
}

#[test]
fn rounding_of_what_is_zero_beside_others_is_no_difference() {
    let toy = oscillator().with("zero", Function2(|x, force| x + force), &["x", "force"]);
    let toy = toy.with("tiny", Gain(1e-13), &["x"]);
    let found = verified(&toy.schedule(&["x", "zero", "tiny"], 10.0, loose(1e-9), Steps));
    assert!(found.differences.iter().all(|found| found.share < 1e-6), "{found:?}");
}

#[test]
fn a_tolerance_of_states_that_hides_them_does_not_hide_them_from_the_other_run() {
    let blind = |output| {
        let mut schedule = (*oscillator().schedule(&["x"], 100.0, loose(1e-6), output)).clone();
        let tolerance = |state: usize| StateTolerance {
            name: state.to_string(),
            value: 0.01,
            dimension: Dimension::NONE,
            states: vec![state],
        };
        schedule.settings.atol = vec![tolerance(0), tolerance(1)];
        schedule
    };
    let found = verified(&blind(Steps));
    let mut tape = Tape::default();
    Simulation::new(Arc::new(blind(Every(0.01)))).unwrap().run(&mut tape).unwrap();
    let error = tape.rows.iter().map(|(t, row)| (row[0] - t.cos()).abs()).fold(0.0, f64::max);
    assert!(error > 1e-2 && (found.differences[0].amount / error - 1.0).abs() < 0.1, "{error}: {found:?}");
}

#[test]
fn beside_the_tightest_tolerance_nothing_is_more_exact() {
    let schedule = oscillator().schedule(&["x"], 1.0, loose(1e-13), Steps);
    let refused = verify(&schedule, &mut || Control::Go).unwrap_err();
    assert!(refused.message.contains("no room") && refused.help.is_some(), "{refused:?}");
}

#[test]
fn who_is_asked_may_say_that_it_is_enough() {
    let schedule = oscillator().schedule(&["x"], 1e4, ode4(0.01), Steps);
    let mut asked = 0;
    let stopped = verify(&schedule, &mut || {
        asked += 1;
        if asked < 3 { Control::Go } else { Control::Stop }
    });
    assert_eq!((stopped, asked), (Ok(None), 3));
}
