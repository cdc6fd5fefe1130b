use super::super::units::testing::output_unit;
use super::*;
use blocksim_block::testing::Bench;

fn block() -> VariableTransportDelay {
    VariableTransportDelay { min_delay: 0.1, max_delay: 1.0, y0: -1.0, buffer: 64 }
}

/// A bench whose history is `u` from 0 to 1, with an input delay of `delay` at its end.
fn after_a_second(u: impl Fn(f64) -> f64, delay: f64) -> Bench {
    let mut bench = Bench::new(block());
    for step in 1..=20 {
        bench.remember(f64::from(step) / 20.0, step == 1, |t| vec![u(t), delay]);
        bench.reach();
    }
    bench
}

#[test]
fn the_delay_is_that_of_the_input_within_its_bounds() {
    let mut bench = after_a_second(|t| t * t, 0.5);
    for (delay, used) in [(0.5, 0.5), (0.37, 0.37), (0.0, 0.1), (-3.0, 0.1), (0.999, 0.999), (7.0, 1.0)] {
        let y = bench.set(1, &[delay]).minor()[0];
        let s: f64 = 1.0 - used;
        assert!((y - s * s).abs() < 1e-12, "{delay}: {y}");
    }
    bench.t = 0.3;
    assert_eq!(after_a_second(|_| 5.0, 0.5).set(1, &[0.5]).minor(), [5.0]);
    let mut early = Bench::new(block());
    early.remember(0.05, true, |_| vec![5.0, 1.0]);
    assert_eq!(early.set(1, &[1.0]).minor(), [-1.0]);
}

#[test]
fn a_jump_is_passed_at_a_crossing_and_stays_on_its_side_until_then() {
    let mut bench = Bench::new(block());
    for step in 1..=20 {
        let end = f64::from(step) / 20.0;
        bench
            .remember(end, step == 1 || step == 11, |t| vec![if step <= 10 { 0.0 } else { 1.0 }, t.min(0.6)]);
        bench.reach();
    }
    // Read at 0.4, before the jump at 0.5; steps end where the crossing is.
    assert_eq!(bench.set(1, &[0.6]).minor(), [0.0]);
    let g = bench.guards();
    assert!((g[0] - 0.1).abs() < 1e-12 && (g[1] - 0.4).abs() < 1e-9, "{g:?}");
    bench.t = 1.05;
    assert_eq!(bench.set(1, &[0.4]).minor(), [0.0], "beyond the break it is still the old side");
    assert!(bench.guards()[0] < 0.0);
    bench.t = 1.0;
    bench.remember(1.1, false, |_| vec![1.0, 0.6]);
    bench.reach();
    assert_eq!(bench.set(1, &[0.6]).minor(), [1.0]);
    assert!(bench.guards()[1] > 0.0 && bench.guards()[1] < 1e-10);
}

#[test]
fn the_unit_is_that_of_the_input_and_bounds_must_make_sense() {
    assert_eq!(output_unit(&block(), &[("u", "V"), ("delay", "s")], &[("y0", "mV")]), "V");
    let wrong = |min_delay, max_delay| VariableTransportDelay { min_delay, max_delay, ..block() }.errors();
    assert_eq!(wrong(0.0, 1.0)[0].param, "min_delay");
    assert_eq!(wrong(2.0, 1.0)[0].param, "max_delay");
}
