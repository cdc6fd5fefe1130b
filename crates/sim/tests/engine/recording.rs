//! Rows, interruptions, snapshots.

use std::sync::Arc;

use blocksim_block::schedule::OutputTimes::{self, Every, Steps};
use blocksim_block::schedule::{Schedule, Solver};
use blocksim_sim::{Ended, Simulation};

use crate::toys::*;

/// x'' = -x, sampled and fed back a little.
fn oscillator(solver: Solver, output: OutputTimes) -> Arc<Schedule> {
    let toy = Toy::new().with("v", Integrator(0.0), &["force"]).with("x", Integrator(1.0), &["v"]);
    let toy = toy.with("held", Hold(0.1), &["v"]).with("delay", UnitDelay(0.2), &["held"]);
    let toy = toy.with("force", Function2(|x, held| -x - 0.1 * held), &["x", "delay"]);
    toy.schedule(&["x", "v", "delay"], 4.0, solver, output)
}

fn cosine(output: OutputTimes) -> Tape {
    let toy = Toy::new().with("v", Integrator(0.0), &["force"]).with("x", Integrator(1.0), &["v"]);
    let schedule = toy.with("force", Gain(-1.0), &["x"]).schedule(&["x", "force"], 10.0, ode45(), output);
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    tape
}

#[test]
fn rows_of_a_grid_come_from_within_the_steps() {
    let tape = cosine(Every(0.01));
    assert_eq!(tape.times(), (0..=1000).map(|k| f64::from(k) / 100.0).collect::<Vec<_>>());
    for (t, row) in &tape.rows {
        assert!((row[0] - t.cos()).abs() < 1e-6, "x({t}) = {}", row[0]);
        assert_eq!(row[1], -row[0]);
    }
}

#[test]
fn steps_have_rows_within_them_until_straight_lines_are_near_enough() {
    let tape = cosine(Steps);
    let worst = tape.rows.windows(2).map(|pair| {
        let ((t0, a), (t1, b)) = (&pair[0], &pair[1]);
        // Over the stretch the line errs most near its middle.
        ((t0 + t1) / 2.0, (a[0] + b[0]) / 2.0)
    });
    let worst = worst.map(|(t, x)| (x - t.cos()).abs()).fold(0.0, f64::max);
    // A thousandth of the range, once the signal has had it.
    assert!(worst < 1.1e-3, "{worst}");
    assert!(tape.rows.len() < 600, "{} rows", tape.rows.len());
}

#[test]
fn a_grid_does_not_change_the_solution() {
    assert_eq!(cosine(Every(0.01)).rows.last(), cosine(Steps).rows.last());
}

#[test]
fn the_end_is_recorded_off_the_grid() {
    assert_eq!(cosine(Every(3.0)).times(), [0.0, 3.0, 6.0, 9.0, 10.0]);
}

#[test]
fn a_run_gives_the_same_bits_twice() {
    for solver in [ode4(0.05), ode45()] {
        let run = || {
            let mut tape = Tape::default();
            Simulation::new(oscillator(solver, Every(0.03))).unwrap().run(&mut tape).unwrap();
            tape.bits()
        };
        assert_eq!(run(), run());
    }
}

fn solvers() -> impl Iterator<Item = Solver> {
    let variable = |(method, atol)| Solver::Variable { method, rtol: 1e-6, atol, max_step: f64::INFINITY };
    let methods = METHODS.into_iter().flat_map(|method| [(method, Some(1e-9)), (method, None)]);
    methods.map(variable).chain([ode4(0.05)])
}

#[test]
fn a_run_from_a_snapshot_gives_the_bits_of_the_run_that_it_was_taken_of() {
    for solver in solvers() {
        for output in [Steps, Every(0.03)] {
            let schedule = oscillator(solver, output);
            let mut first = Simulation::new(Arc::clone(&schedule)).unwrap();
            assert_eq!(first.run_until(1.53, &mut Tape::default()), Ok(Ended::Finished));
            let snapshot = first.snapshot();
            let mut straight = Tape::default();
            first.run(&mut straight).unwrap();

            let mut tape = Tape::default();
            let mut second = Simulation::new(schedule).unwrap();
            second.run(&mut Tape::default()).unwrap();
            second.restore(&snapshot).unwrap();
            assert_eq!(second.time(), 1.53);
            second.run(&mut tape).unwrap();
            assert_eq!(tape.bits(), straight.bits(), "{solver:?}");
            assert_eq!(second.snapshot(), first.snapshot(), "{solver:?}");
        }
    }
}

#[test]
fn a_run_from_a_snapshot_at_an_interruption_gives_the_bits_of_one_that_never_stopped() {
    for solver in solvers() {
        // Guards that turn, jumps, and so many steps that the observer is asked.
        let toy = Toy::new().with("v", Integrator(0.0), &["force"]).with("x", Integrator(1.0), &["v"]);
        let toy =
            toy.with("force", Gain(-1e4), &["x"]).with("ball", Ball { height: 1.0, restitution: 0.9 }, &[]);
        let schedule = toy.with("sign", Sign, &["x"]).schedule(&["x", "ball.h"], 4.0, solver, Every(0.01));
        let mut straight = Tape::default();
        Simulation::new(Arc::clone(&schedule)).unwrap().run(&mut straight).unwrap();

        let mut tape = Tape { patience: Some(1), ..Tape::default() };
        let mut first = Simulation::new(Arc::clone(&schedule)).unwrap();
        if first.run(&mut tape).unwrap() == Ended::Interrupted {
            let mut second = Simulation::new(schedule).unwrap();
            second.restore(&first.snapshot()).unwrap();
            second.run(&mut tape).unwrap();
        } else {
            assert!(matches!(solver, Solver::Fixed { .. }), "{solver:?} was never asked");
        }
        assert_eq!(tape.bits(), straight.bits(), "{solver:?}");
        assert_eq!(tape.asked, straight.asked, "{solver:?}");
    }
}

#[test]
fn a_snapshot_of_another_diagram_is_refused() {
    let snapshot = Simulation::new(oscillator(ode45(), Steps)).unwrap().snapshot();
    let other = Toy::new().with("t", Time, &[]).schedule(&["t"], 1.0, ode45(), Steps);
    assert_eq!(Simulation::new(other).unwrap().restore(&snapshot).unwrap_err().code, "settings");
}

#[test]
fn an_interrupted_run_goes_on() {
    let schedule = oscillator(ode4(0.001), Steps);
    let mut straight = Tape::default();
    Simulation::new(Arc::clone(&schedule)).unwrap().run(&mut straight).unwrap();
    assert_eq!(straight.asked.len(), 4000 / 257);

    let mut tape = Tape { patience: Some(3), ..Tape::default() };
    let mut sim = Simulation::new(schedule).unwrap();
    assert_eq!(sim.run(&mut tape), Ok(Ended::Interrupted));
    assert!(sim.time() < 1.0);
    assert_eq!(sim.run(&mut tape), Ok(Ended::Finished));
    assert_eq!(tape.bits(), straight.bits());
}

#[test]
fn signals_are_found_by_path() {
    let mut sim = Simulation::new(oscillator(ode4(0.1), Steps)).unwrap();
    sim.run(&mut Tape::default()).unwrap();
    assert_eq!(sim.signal("x.y"), Some(&sim.states()[1..2]));
    assert_eq!(sim.signal("x.z"), None);
}

#[test]
fn a_simulation_can_be_sent_to_another_thread() {
    let mut sim = Simulation::new(oscillator(ode45(), Every(0.1))).unwrap();
    let mut here = Tape::default();
    let mut twin = Simulation::new(oscillator(ode45(), Every(0.1))).unwrap();
    twin.run(&mut here).unwrap();
    let there = std::thread::spawn(move || {
        let mut tape = Tape::default();
        sim.run(&mut tape).map(|_| tape)
    });
    assert_eq!(there.join().unwrap().unwrap().bits(), here.bits());
}

#[test]
fn rows_are_the_same_whatever_else_is_recorded() {
    // What is not recorded is not evaluated for rows within steps.
    let diagram = |recorded: &[&str], output| {
        let toy = Toy::new().with("v", Integrator(0.0), &["force"]).with("x", Integrator(1.0), &["v"]);
        let toy = toy.with("force", Gain(-1.0), &["x"]).with("twice", Gain(2.0), &["force"]);
        let toy = toy.with("four", Gain(2.0), &["twice"]).with("eight", Gain(2.0), &["four"]);
        let schedule = toy.schedule(recorded, 10.0, ode45(), output);
        let mut tape = Tape::default();
        Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
        tape
    };
    let (few, many) = (diagram(&["twice"], Steps), diagram(&["twice", "x", "force", "eight"], Steps));
    assert!(few.rows.len() > 50);
    for (t, row) in &few.rows {
        assert!((row[0] + 2.0 * t.cos()).abs() < 1e-6, "{t}: {}", row[0]);
    }
    let (few, many) = (few.rows.iter(), many.rows.iter().map(|(t, row)| (t, row[0])).collect::<Vec<_>>());
    for (t, row) in few {
        let same = many.iter().find(|(time, _)| *time == t);
        assert!(same.is_none_or(|(_, value)| *value == row[0]), "{t}");
    }
    let (few, many) = (diagram(&["twice"], Every(0.1)), diagram(&["twice", "x", "eight"], Every(0.1)));
    assert_eq!(few.column(0), many.column(0));
}
