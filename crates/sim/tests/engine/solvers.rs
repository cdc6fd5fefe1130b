//! Accuracy and work of the methods through the engine.

use blocksim_block::schedule::OutputTimes::{Every, Steps};
use blocksim_block::schedule::{Solver, VariableMethod};
use blocksim_sim::{Counts, Simulation};

use crate::toys::*;

fn variable(method: VariableMethod) -> Solver {
    Solver::Variable { method, rtol: 1e-6, atol: Some(1e-9), max_step: f64::INFINITY }
}

/// A stiff lag driven by t, recorded at its end.
fn lag(method: VariableMethod, rate: f64) -> (f64, Counts) {
    let toy = Toy::new().with("t", Time, &[]).with("lag", Lag(rate), &["t"]);
    let mut sim = Simulation::new(toy.schedule(&["lag"], 1.0, variable(method), Every(1.0))).unwrap();
    let mut tape = Tape::default();
    sim.run(&mut tape).unwrap();
    (tape.at(1.0, 0), sim.counts())
}

#[test]
fn every_method_follows_a_lag() {
    for rate in [3.0_f64, 1e4] {
        let expected = 1.0 - (1.0 - (-rate).exp()) / rate;
        for method in METHODS {
            let (value, _) = lag(method, rate);
            assert!((value - expected).abs() < 1e-5, "{method:?}, rate {rate}: {value} and not {expected}");
        }
    }
}

#[test]
fn implicit_blocks_spare_stiff_methods_most_of_the_steps() {
    let (explicit, implicit) = (lag(VariableMethod::Ode45, 1e4).1, lag(VariableMethod::RosW3, 1e4).1);
    assert!(implicit.accepted * 10 < explicit.accepted, "{implicit:?} {explicit:?}");
}

#[test]
fn a_controller_costs_about_one_step_for_each_hit() {
    let toy = Toy::new().with("x", Integrator(1.0), &["minus"]);
    let toy = toy.with("hold", Hold(1e-3), &["x"]).with("minus", Gain(-1.0), &["hold"]);
    let mut sim = Simulation::new(toy.schedule(&["x"], 1.0, ode45(), Every(0.1))).unwrap();
    let mut tape = Tape::default();
    sim.run(&mut tape).unwrap();
    let expected = 0.999_f64.powi(1000);
    assert!((tape.at(1.0, 0) - expected).abs() < 1e-12);
    assert_eq!(
        sim.counts(),
        Counts {
            major: 1001,
            accepted: 1000,
            rejected: 0,
            evaluations: 7001,
            events: 0,
            hits: 1001,
            limited: 0,
            share: None
        }
    );
}

#[test]
fn without_events_or_samples_there_are_no_major_steps_in_between() {
    let toy = Toy::new().with("v", Integrator(0.0), &["force"]).with("x", Integrator(1.0), &["v"]);
    let schedule = toy.with("force", Gain(-1.0), &["x"]).schedule(&["x"], 10.0, ode45(), Every(0.1));
    let mut sim = Simulation::new(schedule).unwrap();
    sim.run(&mut Tape::default()).unwrap();
    assert_eq!(sim.counts().major, 2);
    let schedule = Toy::new().with("t", Time, &[]).with("x", Integrator(0.0), &["t"]).schedule(
        &["x"],
        1.0,
        ode4(0.1),
        Steps,
    );
    let mut sim = Simulation::new(schedule).unwrap();
    sim.run(&mut Tape::default()).unwrap();
    assert_eq!(sim.counts(), Counts { major: 11, accepted: 10, evaluations: 40, ..Counts::default() });
}
