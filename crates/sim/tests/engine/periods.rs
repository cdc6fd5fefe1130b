//! The map from one sample hit to another.

use std::sync::Arc;

use blocksim_block::schedule::{OutputTimes::Steps, Schedule};
use blocksim_linear::{DMatrix, jacobian};
use blocksim_sim::{Period, PeriodMap, PeriodSlopes, Tap};

use crate::toys::*;

fn all(schedule: &Schedule) -> Vec<usize> {
    (0..schedule.blocks.len()).collect()
}

fn map(schedule: &Arc<Schedule>, t: f64, taps: Vec<Tap>) -> PeriodMap {
    let involved = all(schedule);
    let period = Period::of(schedule, &involved, t, None).unwrap();
    let made = PeriodMap::new(schedule, (&involved, period), taps, false, &mut Tape::default());
    made.unwrap().unwrap().0
}

fn matrix(map: &mut PeriodMap) -> DMatrix<f64> {
    let (point, n) = (map.states().to_vec(), map.states().len());
    let taps = vec![0.0; 1];
    jacobian(&point, n, |z, next| map.evaluate(z, &taps, next)).unwrap().value
}

/// A double integrator behind a hold of 0.25 s, with its place through a delay of a slower rate.
fn two_rates() -> Toy {
    Toy::new()
        .with("x", Integrator(1.0), &["v"])
        .with("v", Integrator(0.3), &["force"])
        .with("sum", Function2(|late, v| -0.4 * late - 0.9 * v), &["late", "v"])
        .with("late", UnitDelay(0.75), &["x"])
        .with("force", Hold(0.25), &["sum"])
}

/// Slopes call by call, with all taps as inputs.
fn slopes(map: &mut PeriodMap, taps: usize) -> PeriodSlopes {
    map.slopes(taps, &[], false, &mut || true).unwrap_or_else(|reason| panic!("{reason}"))
}

#[test]
fn slopes_from_hit_to_hit_are_those_of_the_whole() {
    let schedule = two_rates().schedule(&["x"], 60.0, ode45(), Steps);
    for t in [0.0, 0.3, 29.5] {
        let mut map = map(&schedule, t, vec![Tap { cell: 0, open: false }]);
        let (whole, found) = (matrix(&mut map), slopes(&mut map, 1));
        let n = map.states().len();
        let apart = (found.next.columns(0, n) - &whole).amax();
        assert!(apart < 1e-9, "{apart} at {t} s: {} {whole}", found.next);
        assert!(found.by_differences.iter().any(|path| path == "late"), "{:?}", found.by_differences);
        // The change of `x` comes to the delay alone, whose value is that of the period before.
        let point = map.states().to_vec();
        let mut sides = [vec![0.0; n], vec![0.0; n]];
        for (side, by) in sides.iter_mut().zip([0.5, -0.5]) {
            map.evaluate(&point, &[by], side).unwrap();
        }
        let [above, below] = sides;
        for (slope, (above, below)) in found.next.column(n).iter().zip(above.iter().zip(&below)) {
            assert!((slope - (above - below)).abs() < 1e-9);
        }
    }
}

/// Where a value is held over the beginning of the period, and where a tap is cut.
#[test]
fn slopes_by_held_values_and_behind_cuts_are_known() {
    let schedule = Toy::new()
        .with("x", Integrator(1.0), &["sum"])
        .with("sum", Function2(|a, b| -a - b * b), &["even", "odd"])
        .with("even", Hold(0.5), &["x"])
        .with("odd", Late(0.5), &["x"])
        .with("aside", Hold(0.25), &["x"])
        .schedule(&["x"], 10.0, ode45(), Steps);
    let cell = |name: &str| schedule.signals.iter().find(|s| s.path.starts_with(name)).unwrap().offset;
    for open in [false, true] {
        let involved = [0, 1, 2, 3];
        let period = Period::of(&schedule, &involved, 1.0, None).unwrap();
        let taps = vec![Tap { cell: cell("even"), open }];
        let made = PeriodMap::new(&schedule, (&involved, period), taps, false, &mut Tape::default());
        let mut map = made.unwrap().unwrap().0;
        assert_eq!(map.names(), ["x.x", "odd.y"]);
        let found = map.slopes(1, &[cell("even")], false, &mut || true).unwrap();
        assert_eq!(map.names(), ["x.x", "odd.y"]);
        assert!((matrix(&mut map) - found.next.columns(0, 2)).amax() < 1e-9, "{}", found.next);
        let seen = (found.signal(cell("even"), 0), found.signal(cell("even"), 2), found.given(0, 0));
        assert_eq!(seen, (f64::from(!open), 1.0, 1.0), "{open}");
        // The change acts over the whole period: first by itself, then through `odd` in its second half.
        let x = map.states()[0] - 0.25 * (map.signal(cell("even")) + map.states()[1].powi(2));
        let by = -0.25 - 0.25 * (1.0 - 2.0 * x * 0.25);
        assert!((found.next[(0, 2)] - by).abs() < 1e-9, "{} {by}", found.next);
    }
}

/// Of a linear loop the power of the matrix is the long simulation.
#[test]
fn many_periods_are_the_power_of_the_matrix_of_one() {
    let schedule = two_rates().schedule(&["x"], 60.0, ode45(), Steps);
    let mut first = map(&schedule, 0.0, vec![Tap { cell: 0, open: false }]);
    assert_eq!(first.period(), Period { begin: 0.0, end: 0.75, length: 0.75 });
    assert_eq!(first.names().len(), 3);
    let a = matrix(&mut first);
    let later = map(&schedule, 29.5, Vec::new());
    assert!((later.period().begin - 30.0).abs() < 1e-12);
    let power = (0..40).fold(DMatrix::identity(3, 3), |power, _| &a * power);
    let start = DMatrix::from_column_slice(3, 1, first.states());
    let end = power * start;
    for (found, expected) in later.states().iter().zip(end.iter()) {
        assert!((found - expected).abs() < 1e-7, "{found} {expected}");
    }
}

/// What is not due at the beginning holds a value, which is a state.
#[test]
fn a_signal_that_is_held_over_the_beginning_is_a_state() {
    let schedule = Toy::new()
        .with("x", Integrator(1.0), &["sum"])
        .with("sum", Function2(|a, b| -a - b), &["even", "odd"])
        .with("even", Hold(0.5), &["x"])
        .with("odd", Late(0.5), &["x"])
        .with("aside", Hold(0.25), &["x"])
        .schedule(&["x"], 10.0, ode45(), Steps);
    let involved = [0, 1, 2, 3];
    let period = Period::of(&schedule, &involved, 1.0, None).unwrap();
    assert_eq!(period, Period { begin: 1.0, end: 1.5, length: 0.5 });
    let taps = vec![Tap { cell: 0, open: false }];
    let made = PeriodMap::new(&schedule, (&involved, period), taps, false, &mut Tape::default());
    let mut map = made.unwrap().unwrap().0;
    assert_eq!(map.names(), ["x.x", "odd.y"]);
    // x(1/4) = x - (x + odd) / 4, x(1/2) = x(1/4) - (x + x(1/4)) / 4.
    let expected = DMatrix::from_row_slice(2, 2, &[0.5625 - 0.25, -0.1875, 0.75, -0.25]);
    assert!((matrix(&mut map) - expected).amax() < 1e-9);
}

#[test]
fn a_change_holds_over_the_period_and_a_cut_leaves_what_was_there() {
    let schedule = Toy::new()
        .with("x", Integrator(2.0), &["hold"])
        .with("hold", Hold(0.5), &["gain"])
        .with("gain", Gain(-1.0), &["x"])
        .schedule(&["x"], 10.0, ode45(), Steps);
    let cell = |name: &str| schedule.signals.iter().find(|s| s.path.starts_with(name)).unwrap().offset;
    let hold = cell("hold");
    let mut map = map(&schedule, 0.0, vec![Tap { cell: hold, open: true }]);
    let mut next = [0.0];
    map.evaluate(&[2.0], &[0.0], &mut next).unwrap();
    assert!((next[0] - 1.0).abs() < 1e-11);
    map.evaluate(&[3.0], &[0.5], &mut next).unwrap();
    assert!((next[0] - (3.0 + 0.5 * -1.5)).abs() < 1e-11);
    assert_eq!((map.given(0), map.signal(hold)), (-3.0, -1.5));
    map.open(&[false]);
    map.evaluate(&[3.0], &[0.5], &mut next).unwrap();
    assert!((next[0] - (3.0 + 0.5 * -2.5)).abs() < 1e-11);
}

#[test]
fn rates_without_a_period_and_periods_of_other_rates_are_refused() {
    let schedule = two_rates().schedule(&["x"], 60.0, ode45(), Steps);
    let involved = all(&schedule);
    let of = |given| Period::of(&schedule, &involved, 0.0, given);
    assert_eq!(of(Some(1.5)).unwrap().length, 1.5);
    let wrong = of(Some(0.5)).unwrap_err();
    assert!(wrong.message.contains("not a multiple of that of the sample times 0.25 s, 0.75 s"), "{wrong}");
    assert!(of(Some(1e4 * 0.75)).unwrap_err().message.contains("more than 20000 sample hits"));
    let smooth = Toy::new().with("x", Integrator(1.0), &["x"]).schedule(&["x"], 1.0, ode45(), Steps);
    let none = Period::of(&smooth, &[0], 0.0, None).unwrap_err();
    assert!(none.message.contains("nothing that takes part is sampled") && none.help.is_some());
    assert_eq!(
        Period::of(&smooth, &[0], 0.3, Some(0.1)).unwrap(),
        Period { begin: 0.3, end: 0.4, length: 0.1 }
    );
    let mut odd = Schedule::clone(&schedule);
    odd.clock.rates[0].period = 99_991;
    odd.clock.rates[1].period = 100_003;
    let rare = Period::of(&odd, &involved, 0.0, None).unwrap_err();
    assert!(rare.message.contains("no common period"), "{rare}");
}

#[test]
fn what_happens_within_the_period_is_named() {
    // A relay that swings by itself around an integrator.
    let schedule = Toy::new()
        .with("x", Integrator(0.0), &["sum"])
        .with("sum", Function2(|relay, hold| -10.0 * relay + 0.0 * hold), &["relay", "hold"])
        .with("relay", Relay { low: -0.1, high: 0.1 }, &["x"])
        .with("hold", Hold(0.5), &["x"])
        .schedule(&["x"], 10.0, ode45(), Steps);
    let involved = all(&schedule);
    let period = Period::of(&schedule, &involved, 1.0, None).unwrap();
    let made = PeriodMap::new(&schedule, (&involved, period), Vec::new(), false, &mut Tape::default());
    let error = made.unwrap_err();
    assert!(
        error.code == "linearise" && error.message.contains("something happens that is not smooth"),
        "{error}"
    );
    let remembers = Toy::new()
        .with("x", Integrator(1.0), &["memory"])
        .with("memory", Memory, &["hold"])
        .with("hold", Hold(0.5), &["x"])
        .schedule(&["x"], 10.0, ode45(), Steps);
    let made =
        PeriodMap::new(&remembers, (&all(&remembers), period), Vec::new(), false, &mut Tape::default());
    assert!(made.unwrap_err().message.contains("`memory` answers from memory"));
    let beside = PeriodMap::new(
        &remembers,
        (&[0, 2], period),
        vec![Tap { cell: 99, open: true }],
        false,
        &mut Tape::default(),
    );
    assert_eq!(beside.unwrap_err().code, "settings");
}
