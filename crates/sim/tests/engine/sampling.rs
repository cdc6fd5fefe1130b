//! Sample hits, holds, and blocks that live at major steps.

use blocksim_block::schedule::OutputTimes::{Every, Steps};
use blocksim_sim::{Ended, Simulation};

use crate::toys::*;

#[test]
fn a_million_hits_are_counted_at_their_exact_times() {
    let schedule = Toy::new().with("n", Counter(1e-3), &[]).schedule(&["n"], 1000.0, ode45(), Steps);
    let mut tape = Tape::default();
    let mut sim = Simulation::new(schedule).unwrap();
    assert_eq!(sim.run(&mut tape), Ok(Ended::Finished));
    assert_eq!(tape.rows.len(), 1_000_001);
    for (k, (t, row)) in tape.rows.iter().enumerate() {
        assert_eq!((*t, row[0]), (k as f64 / 1000.0, k as f64));
    }
    assert_eq!(sim.counts().hits, 1_000_001);
    assert_eq!(sim.counts().major, 1_000_001);
}

#[test]
fn a_held_value_stays_between_hits() {
    let toy = Toy::new().with("t", Time, &[]).with("hold", Hold(0.25), &["t"]);
    let schedule = toy.schedule(&["t", "hold"], 1.0, ode45(), Every(0.1));
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    // The hits that the grid has no point for have rows of their own, as they are further apart than its points.
    let times = [0.0, 0.1, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.9, 1.0];
    assert_eq!(tape.times(), times);
    assert_eq!(tape.column(0), tape.times());
    assert_eq!(tape.column(1), times.map(|t| (4.0 * t + 1e-9).floor() / 4.0));
}

#[test]
fn what_goes_on_and_jumps_at_hits_has_rows_on_both_sides_of_them() {
    let rows = |output, recorded: &[&str]| {
        let toy = Toy::new().with("x", Time, &[]).with("hold", Hold(0.25), &["x"]);
        let toy = toy.with("mixed", Function2(|x, held| x - held), &["x", "hold"]);
        let schedule = toy.schedule(recorded, 1.0, ode45(), output);
        let mut tape = Tape::default();
        Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
        tape
    };
    let tape = rows(Every(0.1), &["hold", "mixed"]);
    let jumps: Vec<(f64, f64)> = tape.rows.iter().map(|(t, row)| (*t, row[1])).collect();
    for hit in [0.25, 0.5, 0.75, 1.0] {
        let sides: Vec<f64> = jumps.iter().filter(|(t, _)| *t == hit).map(|(_, y)| *y).collect();
        assert!(matches!(sides[..], [a, b] if (a - 0.25).abs() < 1e-9 && b.abs() < 1e-9), "{hit}: {sides:?}");
    }
    // What is held needs one row for each jump, and a grid as fine as the hits has no rows beside its points.
    let held = rows(Steps, &["hold"]);
    assert!(held.times().windows(2).all(|pair| pair[0] < pair[1]), "{:?}", held.times());
    assert_eq!(rows(Every(0.25), &["hold", "mixed"]).times(), [0.0, 0.25, 0.5, 0.75, 1.0]);
}

#[test]
fn two_rates_meet() {
    let toy = Toy::new().with("fast", Counter(1e-3), &[]).with("slow", Counter(5e-3), &[]);
    let toy = toy.with("delay", UnitDelay(5e-3), &["fast"]);
    let schedule = toy.schedule(&["fast", "slow", "delay"], 0.1, ode45(), Steps);
    let mut tape = Tape::default();
    let mut sim = Simulation::new(schedule).unwrap();
    sim.run(&mut tape).unwrap();
    assert_eq!(tape.rows.len(), 101);
    for (k, (t, row)) in tape.rows.iter().enumerate() {
        let slow = (k / 5) as f64;
        // The delay saw the fast counter as it was at the slow hit before.
        assert_eq!(
            (*t, row[0], row[1], row[2]),
            (k as f64 / 1000.0, k as f64, slow, 5.0 * (slow - 1.0).max(0.0))
        );
    }
    assert_eq!(sim.counts().hits, 101 + 21);
}

#[test]
fn a_chain_of_delays_shifts_whatever_the_order_of_blocks() {
    for names in [["a", "b", "c"], ["c", "b", "a"]] {
        let mut toy = Toy::new().with("n", Counter(0.1), &[]);
        for name in names {
            let from = match name {
                "a" => "n",
                "b" => "a",
                _ => "b",
            };
            toy = toy.with(name, UnitDelay(0.1), &[from]);
        }
        let mut tape = Tape::default();
        Simulation::new(toy.schedule(&["n", "c"], 1.0, ode45(), Steps)).unwrap().run(&mut tape).unwrap();
        assert_eq!(tape.column(1), [0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    }
}

#[test]
fn a_block_of_major_steps_changes_only_there() {
    let toy = Toy::new().with("t", Time, &[]).with("k", Gain(1.0), &["t"]).major("k");
    let toy = toy.with("x", Integrator(0.0), &["k"]);
    let schedule = toy.schedule(&["x"], 1.0, ode4(0.1), Steps);
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    // The integral of a staircase of ten steps.
    assert!((tape.at(1.0, 0) - 0.45).abs() < 1e-15, "{}", tape.at(1.0, 0));
}

#[test]
fn a_memory_gives_the_value_of_the_last_accepted_step() {
    let toy =
        Toy::new().with("t", Time, &[]).with("last", Memory, &["t"]).with("x", Integrator(0.0), &["last"]);
    let schedule = toy.schedule(&["t", "last", "x"], 1.0, ode4(0.25), Steps);
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    assert_eq!(tape.column(1), [0.0, 0.25, 0.5, 0.75, 1.0]);
    for (x, expected) in tape.column(2).iter().zip([0.0, 0.0, 0.0625, 0.1875, 0.375]) {
        assert!((x - expected).abs() < 1e-15, "{x} and not {expected}");
    }
}
