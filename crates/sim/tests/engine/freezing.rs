//! What derivatives and signals would be at one instant.

use blocksim_block::schedule::OutputTimes::Steps;
use blocksim_sim::{Frozen, Simulation, Tap, state_names};

use crate::toys::*;

/// x' = -2 x, with the gain of -2 as a block of its own.
fn around() -> Simulation {
    let toy = Toy::new().with("gain", Gain(-2.0), &["lag"]).with("lag", Integrator(1.5), &["gain"]);
    Simulation::new(toy.schedule(&["gain", "lag"], 1.0, ode45(), Steps)).unwrap()
}

fn cell(simulation: &Simulation, path: &str) -> usize {
    let signals = &simulation.schedule().signals;
    signals.iter().find(|signal| signal.path.starts_with(path)).map(|signal| signal.offset).unwrap()
}

#[test]
fn a_change_at_a_tap_goes_round_the_loop_or_ends_where_it_is_cut() {
    let simulation = around();
    assert_eq!(state_names(simulation.schedule()).len(), 1);
    let (gain, lag) = (cell(&simulation, "gain"), cell(&simulation, "lag"));
    let mut frozen = Frozen::new(simulation, vec![Tap { cell: gain, open: false }]).unwrap();
    let mut dx = [0.0];
    frozen.evaluate(&[1.5], &[0.0], &mut dx).unwrap();
    assert_eq!(dx, [-3.0]);
    frozen.evaluate(&[2.0], &[0.25], &mut dx).unwrap();
    assert_eq!((dx, frozen.given(), frozen.signal(gain)), ([-3.75], &[-4.0][..], -3.75));
    let mut cut = frozen.with_taps(vec![Tap { cell: gain, open: true }]).unwrap();
    // What the gain gives no longer matters: -3 is its value at the instant.
    cut.evaluate(&[2.0], &[0.25], &mut dx).unwrap();
    assert_eq!((dx, cut.given(), cut.signal(gain), cut.signal(lag)), ([-2.75], &[-4.0][..], -2.75, 2.0));
    cut.evaluate(&[1.5], &[0.0], &mut dx).unwrap();
    assert_eq!(dx, [-3.0], "nothing of the last question is left");
}

#[test]
fn a_frozen_run_is_at_the_instant_it_has_come_to() {
    let mut simulation = around();
    simulation.run_until(0.5, &mut Tape::default()).unwrap();
    let state = simulation.states()[0];
    assert!((state - 1.5 * (-1.0_f64).exp()).abs() < 1e-6);
    let mut frozen = Frozen::new(simulation, Vec::new()).unwrap();
    assert_eq!((frozen.states(), frozen.simulation().time()), (&[state][..], 0.5));
    let mut dx = [0.0];
    frozen.evaluate(&[1.0], &[], &mut dx).unwrap();
    assert_eq!((dx, frozen.settle(&[1.0])), ([-2.0], Ok(false)));
    assert!(frozen.with_taps(vec![Tap { cell: 99, open: false }]).is_err());
}

#[test]
fn what_changes_at_hits_alone_can_be_changed_but_does_not_move() {
    let toy = Toy::new().with("x", Integrator(2.0), &["hold"]).with("hold", Hold(0.25), &["x"]);
    let simulation = Simulation::new(toy.schedule(&["x", "hold"], 1.0, ode45(), Steps)).unwrap();
    let hold = cell(&simulation, "hold");
    let mut frozen = Frozen::new(simulation, vec![Tap { cell: hold, open: false }]).unwrap();
    assert!(!frozen.moves(0));
    let mut dx = [0.0];
    for _ in 0..2 {
        frozen.evaluate(&[7.0], &[1.0], &mut dx).unwrap();
        assert_eq!(dx, [3.0]);
    }
}

#[test]
fn a_gain_behind_what_stays_constant_passes_a_change_on() {
    for stays in [true, false] {
        let toy = Toy::new().with("hold", Hold(0.25), &["x"]).with("gain", Gain(3.0), &["hold"]);
        let toy = toy.with("x", Integrator(2.0), &["gain"]);
        let toy = if stays { toy.major("gain") } else { toy };
        let simulation = Simulation::new(toy.schedule(&["x"], 1.0, ode45(), Steps)).unwrap();
        let hold = cell(&simulation, "hold");
        let mut frozen = Frozen::new(simulation, vec![Tap { cell: hold, open: false }]).unwrap();
        let mut dx = [0.0];
        for change in [0.0, 0.5] {
            frozen.evaluate(&[7.0], &[change], &mut dx).unwrap();
            assert_eq!(dx, [3.0 * (2.0 + change)]);
        }
    }
}
